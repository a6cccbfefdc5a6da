//! The text of a document as a JSON tree in which every key and value has its position.
//!
//! The parser accepts strict JSON only. Numbers keep their text and objects keep the order of their keys, so an edited
//! document can be written back without other changes.

use jsonc_parser::errors::{ParseError, ParseErrorKind};
use jsonc_parser::{CollectOptions, ParseOptions, ParseStringErrorKind, ast, common::Range, parse_to_ast};
use serde_json::{Number, Value};

use super::code::Code;
use super::diagnostic::{Diagnostic, Span};
use super::foreign_text::{number_with_separators, other_format};

/// A JSON value with its position.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::tree::{self, Content};
///
/// let root = tree::parse(r#"{"run": {"for": 1.50}}"#)?;
/// let duration = root.child("run").and_then(|run| run.child("for")).expect("a duration");
/// assert_eq!(duration.value, Content::Number("1.50".to_owned()));
/// assert_eq!(duration.span.start, 16);
/// assert_eq!(root.key_path(16), ["run", "for"]);
/// # Ok::<(), patchcord_core::document::Diagnostic>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Position of the value. The span of a text includes its quotes.
    pub span: Span,
    /// The value.
    pub value: Content,
}

/// A JSON value.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// null.
    Null,
    /// true or false.
    Flag(bool),
    /// A number, as it is written in the document.
    Number(String),
    /// A text, without its quotes and with its escapes resolved.
    Text(String),
    /// A list.
    List(Vec<Node>),
    /// An object, with its keys in the order of the document. A key may occur twice.
    Object(Vec<KeyValue>),
}

/// A key of an object with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyValue {
    /// The key, without its quotes.
    pub key: String,
    /// Position of the key, with its quotes.
    pub key_span: Span,
    /// The value of the key.
    pub value: Node,
}

impl Content {
    /// The type of the value for messages, with its article.
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

impl KeyValue {
    /// A key with a JSON value that is not in the text. Every part gets a unique span beyond the text.
    pub(crate) fn of(key: &str, value: &Value, next_span: &mut usize) -> KeyValue {
        let key_span = Span::beyond_text(next_span);
        KeyValue { key: key.to_owned(), key_span, value: Node::of(value, next_span) }
    }
}

impl Node {
    /// A JSON value that is not in the text. Every part gets a unique span beyond the text, counted by `next_span`.
    /// Numbers get the text with which they are printed.
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
                let key_value = |(key, value): (&String, &Value)| KeyValue::of(key, value, next_span);
                Content::Object(entries.iter().map(key_value).collect())
            }
        };
        Node { span, value }
    }

    /// The same value without positions. Keys keep their order and numbers keep their text.
    ///
    /// If a key occurs twice, the last value counts, as in other JSON readers.
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

    /// The keys that lead to a byte of the text, the outermost first. Items of lists add no key.
    pub fn key_path(&self, byte: usize) -> Vec<&str> {
        let contains = |span: Span| (span.start..span.end).contains(&byte);
        match &self.value {
            Content::Object(entries) => {
                let entry =
                    entries.iter().find(|entry| contains(entry.key_span) || contains(entry.value.span));
                entry.map_or_else(Vec::new, |entry| {
                    let inner_keys = entry.value.key_path(byte).into_iter();
                    [entry.key.as_str()].into_iter().chain(inner_keys).collect()
                })
            }
            Content::List(items) => items
                .iter()
                .find(|item| contains(item.span))
                .map_or_else(Vec::new, |item| item.key_path(byte)),
            _ => Vec::new(),
        }
    }

    /// The innermost value that contains a byte of the text; this value if no inner one does.
    pub(crate) fn value_at(&self, byte: usize) -> &Node {
        let contains = |node: &&Node| (node.span.start..node.span.end).contains(&byte);
        let inner = match &self.value {
            Content::Object(entries) => entries.iter().map(|entry| &entry.value).find(contains),
            Content::List(items) => items.iter().find(contains),
            _ => None,
        };
        inner.map_or(self, |inner| inner.value_at(byte))
    }

    /// The value of a key, if this is an object with that key.
    pub fn child(&self, key: &str) -> Option<&Node> {
        let Content::Object(entries) = &self.value else { return None };
        entries.iter().find(|entry| entry.key == key).map(|entry| &entry.value)
    }
}

/// Parses strict JSON: no comments, no trailing commas, quoted keys.
///
/// # Errors
/// The first syntax error, with a hint for common mistakes.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{Code, tree};
///
/// assert!(tree::parse("[1.5, true, null]").is_ok());
/// let error = tree::parse("[.5]").unwrap_err();
/// assert_eq!(error.code, Code::SYNTAX);
/// assert_eq!(error.hint.as_deref(), Some("write 0.5, not .5, and 5, not 5."));
/// ```
pub fn parse(text: &str) -> Result<Node, Diagnostic> {
    let parsed = parse_to_ast(text, &CollectOptions::default(), &strict())
        .map_err(|error| other_format(text).unwrap_or_else(|| syntax_error(text, &error)))?;
    match parsed.value {
        Some(value) => Ok(node(value)),
        None => Err(Diagnostic::at(Code::SYNTAX, Span::default(), "the document is empty")
            .hint("a patch begins with {\"patchcord\": 1, ...")),
    }
}

/// The diagnostic for the error of the parser.
fn syntax_error(text: &str, error: &ParseError) -> Diagnostic {
    let error_span = span(error.range());
    let separators = match error.kind() {
        ParseErrorKind::ExpectedStringObjectProperty => Some(",."),
        ParseErrorKind::BareDecimalPointNumbersNotAllowed => Some("."),
        _ => None,
    };
    let finding =
        separators.and_then(|separators| number_with_separators(text, error_span.start, separators));
    if let Some(finding) = finding {
        return finding;
    }
    let rest = text.get(error_span.start..).unwrap_or_default();
    Diagnostic::at(Code::SYNTAX, error_span, format!("not JSON: {}", error.kind()))
        .maybe_hint(syntax_hint(error.kind(), rest).map(str::to_owned))
}

/// The options of the parser for strict JSON. All extensions are refused, because other JSON readers refuse them too.
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

/// The hint for a comment.
const COMMENT_HINT: &str = "JSON has no comments: use a \"note\"";

/// What to write instead. `rest` is the text from the error on.
fn syntax_hint(kind: &ParseErrorKind, rest: &str) -> Option<&'static str> {
    if starts_with_non_finite(rest) {
        return Some("every number must be finite");
    }
    if rest.starts_with('#') {
        return Some(COMMENT_HINT);
    }
    Some(match kind {
        ParseErrorKind::CommentsNotAllowed => COMMENT_HINT,
        ParseErrorKind::TrailingCommasNotAllowed => "remove the last comma",
        ParseErrorKind::BareDecimalPointNumbersNotAllowed => "write 0.5, not .5, and 5, not 5.",
        ParseErrorKind::UnaryPlusNumbersNotAllowed => "remove the +",
        ParseErrorKind::SingleQuotedStringsNotAllowed => "write texts in double quotes",
        ParseErrorKind::ExpectedStringObjectProperty => "write keys in double quotes",
        ParseErrorKind::ExpectedComma if rest.starts_with(|c: char| c.is_ascii_digit()) => {
            "a number must not begin with 0"
        }
        ParseErrorKind::MultipleRootJsonValues => "a file contains one document, which ended before this",
        ParseErrorKind::UnterminatedArray | ParseErrorKind::UnterminatedObject => {
            "it is opened here and not closed: is the file complete?"
        }
        ParseErrorKind::String(ParseStringErrorKind::UnterminatedStringLiteral) => {
            "the text opened here is not closed with a quote on its line"
        }
        ParseErrorKind::String(_) => "in a text, \\ begins an escape such as \\n; write \\\\ for one \\",
        _ => return None,
    })
}

/// Whether a text starts with a word for NaN or infinity, which JSON does not have.
fn starts_with_non_finite(rest: &str) -> bool {
    let word: String = rest.chars().take_while(|c| c.is_alphanumeric() || "-+".contains(*c)).collect();
    let words = ["nan", "-nan", "infinity", "-infinity", "inf", "-inf", "+inf"];
    words.contains(&word.to_lowercase().as_str())
}

/// Converts a range of the parser. Both count bytes from the start of the text.
fn span(range: Range) -> Span {
    Span { start: range.start, end: range.end }
}

/// Copies a value of the parser's tree.
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
            value: Content::Object(object.properties.into_iter().map(key_value).collect()),
        },
    }
}

/// Copies a key and its value from the parser's tree.
fn key_value(property: ast::ObjectProp<'_>) -> KeyValue {
    let key_span = match &property.name {
        ast::ObjectPropName::String(text) => span(text.range),
        ast::ObjectPropName::Word(word) => span(word.range),
    };
    KeyValue { key: property.name.into_string(), key_span, value: node(property.value) }
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
    fn the_innermost_value_around_a_byte_is_found() {
        let text = r#"{"a": [1, {"b": "two"}], "c": true}"#;
        let root = parse(text).unwrap();
        let at = |part: &str| root.value_at(text.find(part).unwrap()).value.clone();
        assert_eq!(at("two"), Content::Text("two".to_owned()));
        assert_eq!(at("1"), Content::Number("1".to_owned()));
        assert_eq!(at("true"), Content::Flag(true));
        assert_eq!(root.value_at(text.find("\"c\"").unwrap()), &root);
        assert_eq!(root.value_at(1000), &root);
    }

    #[test]
    fn text_that_is_not_strict_json_is_refused() {
        for text in ["", "{", "{a: 1}", "{\"a\": 1,}", "[NaN]", "[0x1]", "[+1]", "[.5]", "// c\n1", "['a']"] {
            assert_eq!(parse(text).unwrap_err().code, Code::SYNTAX, "{text}");
        }
    }

    #[test]
    fn the_hint_for_nan_says_that_numbers_must_be_finite() {
        assert!(parse("{\"a\": NaN}").unwrap_err().hint.unwrap().contains("finite"));
    }

    #[test]
    fn deep_nesting_gives_an_error_instead_of_a_crash() {
        assert_eq!(parse(&"[".repeat(100_000)).unwrap_err().code, Code::SYNTAX);
    }
}
