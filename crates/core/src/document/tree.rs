//! The document's text as a tree in which everything knows its place.

use jsonc_parser::errors::ParseErrorKind;
use jsonc_parser::{CollectOptions, ParseOptions, ParseStringErrorKind, ast, common::Range, parse_to_ast};
use serde_json::{Number, Value};

use super::code::Code;
use super::diagnostic::{Diagnostic, Span};

/// A JSON value and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Where it is.
    pub span: Span,
    /// What it is.
    pub value: Content,
}

/// What a JSON value is. Numbers keep their text.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// null.
    Null,
    /// true or false.
    Flag(bool),
    /// A number, as it was written.
    Number(String),
    /// A text, without its quotes.
    Text(String),
    /// A list.
    List(Vec<Node>),
    /// An object, its keys in the order of the document.
    Object(Vec<Entry>),
}

/// One key of an object with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Where the key is.
    pub key_span: Span,
    /// Its value.
    pub value: Node,
}

impl Content {
    /// What the value is called in a message.
    pub fn noun(&self) -> &'static str {
        match self {
            Content::Null => "null",
            Content::Flag(_) => "true or false",
            Content::Number(_) => "a number",
            Content::Text(_) => "a text",
            Content::List(_) => "a list",
            Content::Object(_) => "an object",
        }
    }
}

impl Entry {
    /// A key with a JSON value that is not in the text: every part gets a span beyond the text.
    pub(crate) fn of(key: &str, value: &Value, next_span: &mut usize) -> Entry {
        let key_span = Span::beyond_text(next_span);
        Entry { key: key.to_owned(), key_span, value: Node::of(value, next_span) }
    }
}

impl Node {
    /// A JSON value that is not in the text: every part gets a span beyond the text. Numbers have the text with which the
    /// value is printed.
    pub(crate) fn of(value: &Value, next_span: &mut usize) -> Node {
        let span = Span::beyond_text(next_span);
        let value = match value {
            Value::Null => Content::Null,
            Value::Bool(flag) => Content::Flag(*flag),
            Value::Number(number) => Content::Number(number.to_string()),
            Value::String(text) => Content::Text(text.clone()),
            Value::Array(items) => {
                Content::List(items.iter().map(|item| Node::of(item, next_span)).collect())
            }
            Value::Object(entries) => {
                Content::Object(entries.iter().map(|(key, value)| Entry::of(key, value, next_span)).collect())
            }
        };
        Node { span, value }
    }

    /// The same as a JSON value: keys in their order, numbers with their text. Of a key that stands twice the
    /// last counts, as JSON readers have it.
    pub fn to_value(&self) -> Value {
        match &self.value {
            Content::Null => Value::Null,
            Content::Flag(flag) => Value::Bool(*flag),
            Content::Number(text) => Value::Number(Number::from_string_unchecked(text.clone())),
            Content::Text(text) => Value::String(text.clone()),
            Content::List(items) => items.iter().map(Node::to_value).collect(),
            Content::Object(entries) => {
                entries.iter().map(|entry| (entry.key.clone(), entry.value.to_value())).collect()
            }
        }
    }

    /// The keys under which a byte of the text stands, the outermost first.
    pub fn keys_to(&self, byte: usize) -> Vec<&str> {
        let holds = |span: Span| (span.start..span.end).contains(&byte);
        match &self.value {
            Content::Object(entries) => {
                let own = entries.iter().find(|entry| holds(entry.key_span) || holds(entry.value.span));
                own.map_or_else(Vec::new, |own| {
                    let further = own.value.keys_to(byte).into_iter();
                    [own.key.as_str()].into_iter().chain(further).collect()
                })
            }
            Content::List(items) => {
                items.iter().find(|item| holds(item.span)).map_or_else(Vec::new, |item| item.keys_to(byte))
            }
            _ => Vec::new(),
        }
    }

    /// What an object holds under a key.
    pub fn child(&self, key: &str) -> Option<&Node> {
        let Content::Object(entries) = &self.value else { return None };
        entries.iter().find(|entry| entry.key == key).map(|entry| &entry.value)
    }
}

/// Reads strict JSON.
pub fn parse(text: &str) -> Result<Node, Diagnostic> {
    let parsed = parse_to_ast(text, &CollectOptions::default(), &strict()).map_err(|error| {
        let at = span(error.range());
        let rest = text.get(at.start..).unwrap_or_default();
        Diagnostic::at(Code::Syntax, at, format!("not JSON: {}", error.kind()))
            .maybe_hint(syntax_hint(error.kind(), rest).map(str::to_owned))
    })?;
    match parsed.value {
        Some(value) => Ok(node(value)),
        None => Err(Diagnostic::at(Code::Syntax, Span::default(), "the document is empty")
            .hint("a patch begins with {\"patchcord\": 1, ...")),
    }
}

fn strict() -> ParseOptions {
    ParseOptions {
        allow_comments: false,
        allow_loose_object_property_names: false,
        allow_trailing_commas: false,
        allow_missing_commas: false,
        allow_single_quoted_strings: false,
        allow_hexadecimal_numbers: false,
        allow_unary_plus_numbers: false,
        allow_bare_decimal_point_numbers: false,
        allow_non_finite_numbers: false,
        allow_extended_string_escapes: false,
    }
}

/// What to write instead, from the kind of error and the text at its place.
fn syntax_hint(kind: &ParseErrorKind, rest: &str) -> Option<&'static str> {
    if is_no_number(rest) {
        return Some("every number must be finite");
    }
    Some(match kind {
        ParseErrorKind::CommentsNotAllowed => "JSON has no comments: use a \"note\"",
        ParseErrorKind::TrailingCommasNotAllowed => "take the last comma away",
        ParseErrorKind::BareDecimalPointNumbersNotAllowed => "write 0.5, not .5, and 5, not 5.",
        ParseErrorKind::UnaryPlusNumbersNotAllowed => "take the + away",
        ParseErrorKind::SingleQuotedStringsNotAllowed => "texts stand in double quotes",
        ParseErrorKind::ExpectedStringObjectProperty => "keys stand in double quotes",
        ParseErrorKind::ExpectedComma if rest.starts_with(|c: char| c.is_ascii_digit()) => {
            "numbers do not begin with 0"
        }
        ParseErrorKind::MultipleRootJsonValues => "a file holds one document: it ended before this",
        ParseErrorKind::UnterminatedArray | ParseErrorKind::UnterminatedObject => {
            "it is opened here and never closed: is the file complete?"
        }
        ParseErrorKind::String(ParseStringErrorKind::UnterminatedStringLiteral) => {
            "the text opened here is not closed with a quote on its line"
        }
        ParseErrorKind::String(_) => "in a text, \\ begins an escape such as \\n; write \\\\ for one \\",
        _ => return None,
    })
}

fn is_no_number(rest: &str) -> bool {
    let word: String = rest.chars().take_while(|c| c.is_alphanumeric() || "-+".contains(*c)).collect();
    let known = ["nan", "-nan", "infinity", "-infinity", "inf", "-inf", "+inf"];
    known.contains(&word.to_lowercase().as_str())
}

fn span(range: Range) -> Span {
    Span { start: range.start, end: range.end }
}

fn node(value: ast::Value<'_>) -> Node {
    match value {
        ast::Value::StringLit(text) => {
            Node { span: span(text.range), value: Content::Text(text.value.into_owned()) }
        }
        ast::Value::NumberLit(number) => {
            Node { span: span(number.range), value: Content::Number(number.value.to_owned()) }
        }
        ast::Value::BooleanLit(flag) => Node { span: span(flag.range), value: Content::Flag(flag.value) },
        ast::Value::NullKeyword(null) => Node { span: span(null.range), value: Content::Null },
        ast::Value::Array(list) => Node {
            span: span(list.range),
            value: Content::List(list.elements.into_iter().map(node).collect()),
        },
        ast::Value::Object(object) => Node {
            span: span(object.range),
            value: Content::Object(object.properties.into_iter().map(entry).collect()),
        },
    }
}

fn entry(property: ast::ObjectProp<'_>) -> Entry {
    let key_span = match &property.name {
        ast::ObjectPropName::String(text) => span(text.range),
        ast::ObjectPropName::Word(word) => span(word.range),
    };
    Entry { key: property.name.into_string(), key_span, value: node(property.value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_text() {
        let parsed = parse("[1.50, 45e6]").unwrap();
        let Content::List(items) = parsed.value else { panic!("a list") };
        assert_eq!(items[0].value, Content::Number("1.50".into()));
        assert_eq!(items[1].value, Content::Number("45e6".into()));
    }

    #[test]
    fn json_only() {
        for text in ["", "{", "{a: 1}", "{\"a\": 1,}", "[NaN]", "[0x1]", "[+1]", "[.5]", "// c\n1", "['a']"] {
            assert_eq!(parse(text).unwrap_err().code, Code::Syntax, "{text}");
        }
    }

    #[test]
    fn a_nan_is_told_that_numbers_are_finite() {
        assert!(parse("{\"a\": NaN}").unwrap_err().hint.unwrap().contains("finite"));
    }

    #[test]
    fn deep_nesting_is_an_error_not_a_crash() {
        assert_eq!(parse(&"[".repeat(100_000)).unwrap_err().code, Code::Syntax);
    }
}
