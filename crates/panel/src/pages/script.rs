//! Scripts as they are sent: without comments, and without blanks and ends of lines that separate nothing.

/// A script from its lines, which have no indentation and of which none is a comment. Texts and regular expressions stay
/// as they are.
///
/// A line that ends with a brace must be the end of a block, and a statement that is no block must end with a semicolon
/// or at the end of its line.
pub(super) fn shortened(lines: &[&str]) -> String {
    let mut content = String::new();
    for line in lines {
        let continues = line.starts_with(['}', ')', ']', '?', ':', '.', '&', '|']);
        if continues && content.ends_with('\n') {
            content.pop();
        }
        push_line(&mut content, line);
        if !content.ends_with(['{', '}', '(', '[', ',', ';']) {
            content.push('\n');
        }
    }
    content
}

/// Appends a line without comments and without the blanks that separate nothing.
fn push_line(content: &mut String, line: &str) {
    // The open braces. A template whose expression is open is a '`'.
    let mut open = Vec::new();
    let mut rest = line;
    while let Some(first) = rest.chars().next() {
        let before = content.chars().next_back().unwrap_or('\n');
        let next = rest[first.len_utf8()..].chars().next().unwrap_or(' ');
        let skipped = match first {
            ' ' if separates_nothing(before, next) => 1,
            '/' if next == '/' => rest.len(),
            '/' if next == '*' => rest.find("*/").map_or(rest.len(), |end| end + 2),
            _ => 0,
        };
        let kept = if skipped > 0 { 0 } else { token_length(rest, first, next, &mut open) };
        content.push_str(&rest[..kept]);
        rest = &rest[skipped + kept..];
    }
}

/// Whether a blank between these characters of a script has no meaning. "- -" is not "--", and "/ /" is no comment.
fn separates_nothing(before: char, next: char) -> bool {
    let is_punctuation = |character: char| "{}()[],;:?=<>&|!*+-/%'\"`".contains(character);
    (is_punctuation(before) || is_punctuation(next)) && !(before == next && "+-/".contains(before))
}

/// The length of the token with which `rest` begins: a text, a regular expression, a part of a template, or a character.
/// A slash before a blank divides.
fn token_length(rest: &str, first: char, next: char, open: &mut Vec<char>) -> usize {
    if first == '{' {
        open.push(first);
    }
    let ends_expression = first == '}' && open.pop() == Some('`');
    let is_text = ends_expression || "'\"`".contains(first) || (first == '/' && next != ' ');
    if !is_text {
        return first.len_utf8();
    }
    let length = text_length(rest, if ends_expression { '`' } else { first });
    if rest[..length].ends_with("${") {
        open.push('`');
    }
    length
}

/// The length of the text with which `rest` begins, up to its end: a string, a regular expression, or the part of a
/// template before an expression or after it.
fn text_length(rest: &str, end: char) -> usize {
    let mut is_class = false;
    let mut characters = rest.char_indices().skip(1);
    while let Some((at, character)) = characters.next() {
        match character {
            '\\' => {
                characters.next();
            }
            '[' | ']' if end == '/' => is_class = character == '[',
            '$' if end == '`' && rest[at..].starts_with("${") => return at + 2,
            _ if character == end && !is_class => return at + character.len_utf8(),
            _ => {}
        }
    }
    rest.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A script as it is sent.
    fn sent(text: &str) -> String {
        shortened(&text.lines().map(str::trim).collect::<Vec<_>>())
    }

    #[test]
    fn blanks_that_separate_nothing_are_not_sent() {
        let lines = [
            ("if (a) b = { c: [1, 2], d: -e };", "if(a)b={c:[1,2],d:-e};"),
            ("return a + -b - -c + ++d;", "return a+-b- -c+ ++d;"),
            (r#"say('a, b', "c = 'd' ", e );"#, r#"say('a, b',"c = 'd' ",e);"#),
            (r"say('it\'s , so', a);", r"say('it\'s , so',a);"),
            ("const a = `b, ${c ? `d, e` : { f }} `;", "const a=`b, ${c?`d, e`:{f}} `;"),
            ("import { a } from './a b.js';", "import{a}from'./a b.js';"),
            (r"f(a, b / 2, /[/ ] , \/ x/g, d);", r"f(a,b/2,/[/ ] , \/ x/g,d);"),
            ("return c / /d e/;", "return c/ /d e/;"),
            ("say('−', 'https://a, b');", "say('−','https://a, b');"),
        ];
        for (text, short) in lines {
            assert_eq!(sent(text), short);
        }
    }

    #[test]
    fn comments_in_lines_are_not_sent() {
        assert_eq!(sent("f(/** @type {any} */ a); // 'b'"), "f(a);");
        assert_eq!(sent("return a /* b */ in c // d"), "return a in c\n");
    }

    #[test]
    fn ends_of_lines_are_sent_if_they_separate() {
        let text =
            "function f() {\n  return a\n    && g(\n      { b; },\n    );\n}\nf();\nconst c = 1\nf()\n";
        assert_eq!(sent(text), "function f(){return a&&g({b;},);}f();const c=1\nf()\n");
    }
}
