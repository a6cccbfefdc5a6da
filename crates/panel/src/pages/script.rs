//! Scripts as they are sent: without what only their readers need.

/// Words for which there is a shorter text with the same meaning in a script that runs without faults.
const SHORTER_WORDS: [(&str, &str); 3] = [("const", "let"), ("true", "!0"), ("false", "!1")];

/// A script from its lines, which have no indentation and of which none is a comment. Texts and regular expressions stay
/// as they are.
///
/// A line that ends with a brace must be the end of a block, and a statement that is no block must end with a semicolon
/// or at the end of its line.
pub(super) fn shortened(lines: &[&str]) -> String {
    let (mut content, mut is_declaration) = (String::new(), false);
    for line in lines {
        is_declaration = push_line(&mut content, line, is_declaration);
    }
    content
}

/// Appends a line, and its end if a statement can end there. A declaration after another one (`continues`) becomes a part
/// of it. Returns whether the line is one complete declaration.
fn push_line(content: &mut String, line: &str, continues: bool) -> bool {
    if content.ends_with('\n') && line.starts_with(['}', ')', ']', '?', ':', '.', '&', '|']) {
        content.pop();
    }
    let declared = ["const ", "let "].iter().find_map(|word| line.strip_prefix(word));
    let statement = match declared {
        Some(declared) if continues => {
            content.pop();
            content.push(',');
            declared
        }
        _ => line,
    };
    let is_complete = push_statement(content, statement);
    if !content.ends_with(['{', '}', '(', '[', ',', ';']) {
        content.push('\n');
    }
    declared.is_some() && is_complete
}

/// Appends a line without comments, the blanks that separate nothing, and a semicolon before a brace that closes. A slash
/// before a blank divides. Returns whether the line is one complete statement.
fn push_statement(content: &mut String, line: &str) -> bool {
    let mut open = Open::default();
    let (mut rest, mut before) = (line, '\n');
    while let Some(first) = rest.chars().next() {
        let next = rest[first.len_utf8()..].chars().next().unwrap_or(' ');
        let skipped = match first {
            ' ' if separates_nothing(before, next) => 1,
            '/' if next == '/' => rest.len(),
            '/' if next == '*' => rest.find("*/").map_or(rest.len(), |end| end + 2),
            _ => 0,
        };
        if skipped > 0 {
            rest = &rest[skipped..];
            continue;
        }
        let (part, length) = shorter(rest, before).unwrap_or_else(|| {
            let length = open.token_length(rest, first, next);
            (&rest[..length], length)
        });
        if first == '}' && content.ends_with(';') {
            content.pop();
        }
        // A parameter without its parentheses after a word, such as `async`.
        if first == '(' && part != "(" && content.ends_with(is_name) {
            content.push(' ');
        }
        content.push_str(part);
        let (taken, others) = rest.split_at(length);
        before = taken.chars().next_back().unwrap_or(before);
        rest = others;
    }
    open.depth == 0 && open.ends == 1 && content.ends_with(';')
}

/// What is open in a line, and how many statements end in it.
#[derive(Default)]
struct Open {
    /// The open braces. A template whose expression is open is a '`'.
    braces: Vec<char>,
    /// The number of open brackets outside of texts.
    depth: i32,
    /// The number of semicolons outside of texts.
    ends: usize,
}

impl Open {
    /// The length of the token with which `rest` begins: a text, a part of a template, or a character.
    fn token_length(&mut self, rest: &str, first: char, next: char) -> usize {
        if first == '{' {
            self.braces.push(first);
        }
        let ends_expression = first == '}' && self.braces.pop() == Some('`');
        let is_text = ends_expression || "'\"`".contains(first) || (first == '/' && next != ' ');
        if !is_text {
            self.depth += i32::from("([{".contains(first)) - i32::from(")]}".contains(first));
            self.ends += usize::from(first == ';');
            return first.len_utf8();
        }
        let length = text_length(rest, if ends_expression { '`' } else { first });
        if rest[..length].ends_with("${") {
            self.braces.push('`');
        }
        length
    }
}

/// A shorter text with the same meaning for the beginning of `rest`, and the length of this beginning.
fn shorter(rest: &str, before: char) -> Option<(&str, usize)> {
    if let Some(name) = only_parameter(rest) {
        return Some((name, name.len() + "()".len()));
    }
    if is_name(before) || before == '.' {
        return None;
    }
    SHORTER_WORDS.iter().find_map(|(word, shorter)| {
        let after = rest.strip_prefix(word)?.chars().next().unwrap_or(' ');
        // A word before a colon is a key.
        (!is_name(after) && after != ':').then_some((*shorter, word.len()))
    })
}

/// The only parameter of a function with an arrow, if `rest` begins with its parentheses.
fn only_parameter(rest: &str) -> Option<&str> {
    let (name, _) = rest.strip_prefix('(')?.split_once(") =>")?;
    (!name.is_empty() && name.chars().all(is_name)).then_some(name)
}

/// Whether a character can be in a name.
fn is_name(character: char) -> bool {
    character.is_alphanumeric() || "_$".contains(character)
}

/// Whether a blank between these characters of a script has no meaning. "- -" is not "--", and "/ /" is no comment.
fn separates_nothing(before: char, next: char) -> bool {
    let is_punctuation = |character: char| "{}()[],;:?=<>&|!*+-/%'\"`".contains(character);
    (is_punctuation(before) || is_punctuation(next)) && !(before == next && "+-/".contains(before))
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
            ("const a = `b, ${c ? `d, e` : { f }} `;", "let a=`b, ${c?`d, e`:{f}} `;"),
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
    fn ends_of_statements_are_sent_if_they_separate() {
        let text =
            "function f() {\n  return a\n    && g(\n      { b; },\n    );\n}\nf();\nconst c = 1\nf()\n";
        assert_eq!(sent(text), "function f(){return a&&g({b},)}f();let c=1\nf()\n");
    }

    #[test]
    fn declarations_that_follow_each_other_are_one() {
        assert_eq!(
            sent("const a = f(';');\nlet [b] = [a];\ng();\nconst c = 3;"),
            "let a=f(';'),[b]=[a];g();let c=3;"
        );
        assert_eq!(sent("const a = 1; f();\nconst b = 2;"), "let a=1;f();let b=2;");
        assert_eq!(sent("const f = () => { g(')');\nconst a = 1;\n};"), "let f=()=>{g(')');let a=1};");
        assert_eq!(sent("const f = () => {\nconst a = 1;\n};\nconst b = 2;"), "let f=()=>{let a=1};let b=2;");
        assert_eq!(sent("export const a = 1;\nconst b = 2;"), "export let a=1;let b=2;");
    }

    #[test]
    fn functions_with_one_parameter_have_no_parentheses() {
        assert_eq!(
            sent("list.map((each) => (other) => each + other);"),
            "list.map(each=>other=>each+other);"
        );
        assert_eq!(
            sent("run(async (name) => f(name), (a, b) => a, () => 1);"),
            "run(async name=>f(name),(a,b)=>a,()=>1);"
        );
        assert_eq!(sent("f(({ a }) => a, (b = 1) => b);"), "f(({a})=>a,(b=1)=>b);");
    }

    #[test]
    fn truth_values_are_short() {
        assert_eq!(sent("return a === true ? false : b.true;"), "return a===!0?!1:b.true;");
        assert_eq!(
            sent("f({ true: 1 }, 'is true', untrue, trueish);"),
            "f({true:1},'is true',untrue,trueish);"
        );
    }
}
