//! A JSON document whose keys may occur twice and whose numbers keep their text.

use serde_json::Value;

/// A value of a JSON document.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Node {
    /// `null`.
    Null,
    /// `true` or `false`.
    Flag(bool),
    /// The text of a number. It need not be a number of JSON.
    Number(String),
    /// A text, without its quotes.
    Text(String),
    /// The items of a list.
    List(Vec<Node>),
    /// The entries in the order of the text.
    Object(Vec<(String, Node)>),
}

impl Node {
    /// The value of a parsed document.
    pub(crate) fn of(value: &Value) -> Node {
        match value {
            Value::Null => Node::Null,
            Value::Bool(flag) => Node::Flag(*flag),
            Value::Number(number) => Node::Number(number.to_string()),
            Value::String(text) => Node::Text(text.clone()),
            Value::Array(items) => Node::List(items.iter().map(Node::of).collect()),
            Value::Object(entries) => {
                Node::Object(entries.iter().map(|(key, value)| (key.clone(), Node::of(value))).collect())
            }
        }
    }

    /// An object with these entries.
    pub(crate) fn object<const N: usize>(entries: [(&str, Node); N]) -> Node {
        Node::Object(entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
    }

    /// A text value.
    pub(crate) fn text(text: &str) -> Node {
        Node::Text(text.to_owned())
    }

    /// A number. It is finite.
    pub(crate) fn number(number: f64) -> Node {
        Node::Number(format!("{number:?}"))
    }

    /// The JSON text of the value.
    pub(crate) fn json(&self) -> String {
        let mut text = String::new();
        self.write(&mut text);
        text
    }

    /// Appends the JSON text of the value.
    fn write(&self, into: &mut String) {
        match self {
            Node::Null => into.push_str("null"),
            Node::Flag(flag) => into.push_str(if *flag { "true" } else { "false" }),
            Node::Number(text) => into.push_str(text),
            Node::Text(text) => into.push_str(&quoted(text)),
            Node::List(items) => {
                into.push('[');
                for (index, item) in items.iter().enumerate() {
                    into.push_str(if index == 0 { "" } else { ", " });
                    item.write(into);
                }
                into.push(']');
            }
            Node::Object(entries) => {
                into.push('{');
                for (index, (key, value)) in entries.iter().enumerate() {
                    into.push_str(if index == 0 { "" } else { ",\n" });
                    into.push_str(&quoted(key));
                    into.push_str(": ");
                    value.write(into);
                }
                into.push('}');
            }
        }
    }

    /// The entries of an object; none for other values.
    pub(crate) fn entries(&self) -> &[(String, Node)] {
        if let Node::Object(entries) = self { entries } else { &[] }
    }

    /// The first value with this key.
    pub(crate) fn get(&self, key: &str) -> Option<&Node> {
        self.entries().iter().find(|(name, _)| name == key).map(|(_, value)| value)
    }

    /// The names of the entries with this key.
    pub(crate) fn names_in(&self, key: &str) -> Vec<String> {
        let section = self.get(key).map_or(&[][..], Node::entries);
        section.iter().map(|(name, _)| name.clone()).collect()
    }

    /// The value of a number; `None` for other values.
    pub(crate) fn as_number(&self) -> Option<f64> {
        if let Node::Number(text) = self { text.parse().ok() } else { None }
    }

    /// The text of a text value; `None` for other values.
    pub(crate) fn as_text(&self) -> Option<&str> {
        if let Node::Text(text) = self { Some(text) } else { None }
    }

    /// Calls `visit` for this value and all values inside it, each with its key. An item has the key of its list, and
    /// this value has `key`.
    pub(crate) fn visit<'a>(&'a self, key: &'a str, visit: &mut dyn FnMut(&'a str, &'a Node)) {
        visit(key, self);
        match self {
            Node::List(items) => items.iter().for_each(|item| item.visit(key, visit)),
            Node::Object(entries) => entries.iter().for_each(|(key, value)| value.visit(key, visit)),
            _ => (),
        }
    }

    /// The number of values, this value included.
    pub(crate) fn size(&self) -> usize {
        let mut size = 0;
        self.visit("", &mut |_, _| size += 1);
        size
    }

    /// The value with this index in the order of [`Node::visit`], with its key. `None` if there are fewer values.
    pub(crate) fn value_mut(&mut self, index: usize) -> Option<(String, &mut Node)> {
        let mut remaining = index;
        find_value(self, "", &mut remaining)
    }
}

/// The JSON text of a string.
fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

/// The value that follows `remaining` others, with its key. Counts `remaining` down.
fn find_value<'a>(node: &'a mut Node, key: &str, remaining: &mut usize) -> Option<(String, &'a mut Node)> {
    if *remaining == 0 {
        return Some((key.to_owned(), node));
    }
    *remaining -= 1;
    match node {
        Node::List(items) => items.iter_mut().find_map(|item| find_value(item, key, remaining)),
        Node::Object(entries) => {
            entries.iter_mut().find_map(|(key, value)| find_value(value, key, remaining))
        }
        _ => None,
    }
}
