//! Names of scales from the expressions that they belong to: `sin_theta` for sin(theta), `V_minus_E` for V - E.

use patchcord_expr::split_primes;

use super::names::derivative_name;

/// The longest name in bytes. Longer ones would hide the structure of a formula.
const LONGEST: usize = 20;
/// The largest number of operands.
const MOST_OPERANDS: usize = 3;
/// The signs of expressions with their words. Blanks and closing parentheses have none.
const SIGNS: &[(&str, &str)] = &[
    (" + ", "plus"),
    (" - ", "minus"),
    ("-", "minus"),
    ("/", "over"),
    ("^2", "squared"),
    (" ", ""),
    (")", ""),
];

/// A name for the value of an expression. `None` if the expression is too long, or if a name would be ambiguous.
///
/// Operators become words, and functions come first: `one_minus_x`, `x_over_r`, `ln_out_over_u_ref`. The positive part
/// max(x, 0) is `x_positive`, and the negative part max(-x, 0) is `x_negative`.
pub(super) fn short_name(expression: &str) -> Option<String> {
    let inside = expression.strip_prefix("max(").and_then(|rest| rest.strip_suffix(", 0)"));
    let name = match inside.map(|inside| inside.strip_prefix('-').ok_or(inside)) {
        Some(Ok(negative)) => format!("{}_negative", single(negative)?),
        Some(Err(positive)) => format!("{}_positive", single(positive)?),
        None => words(expression)?.join("_"),
    };
    (name.len() <= LONGEST).then_some(name)
}

/// The word of an expression that is only a name. `None` for other expressions.
fn single(expression: &str) -> Option<String> {
    match words(expression)?.as_slice() {
        [only] => Some(only.clone()),
        _ => None,
    }
}

/// The words of an expression. `None` if it has a sum in parentheses, which would be lost, or a part without a word.
fn words(expression: &str) -> Option<Vec<String>> {
    let mut words = Vec::new();
    let (mut rest, mut depth, mut operands) = (expression, 0_usize, 0);
    while !rest.is_empty() {
        let token = first_token(rest)?;
        rest = &rest[token.len()..];
        let (is_name, is_call) = (token.starts_with(is_name_letter), token.ends_with('('));
        if depth > 0 && [" + ", " - "].contains(&token) {
            return None;
        }
        depth = (depth + usize::from(is_call)).checked_sub(usize::from(token == ")"))?;
        operands += usize::from(is_name && !is_call);
        if is_name {
            words.push(name_word(token.trim_end_matches('('), words.is_empty())?);
        } else if let Some((_, word)) = SIGNS.iter().find(|(sign, word)| *sign == token && !word.is_empty()) {
            words.push((*word).to_owned());
        }
    }
    (1..=MOST_OPERANDS).contains(&operands).then_some(words)
}

/// The first part of an expression: a name with its primes, a function with its opening parenthesis, a whole number, or
/// a sign. `None` if the expression begins with something else.
fn first_token(expression: &str) -> Option<&str> {
    let name = length_of(expression, is_name_letter);
    if name > 0 {
        let primes = length_of(&expression[name..], |letter| letter == '\'');
        let call = usize::from(expression[name + primes..].starts_with('('));
        return Some(&expression[..name + primes + call]);
    }
    let (sign, _) = SIGNS.iter().find(|(sign, _)| expression.starts_with(*sign))?;
    let is_longer_number = *sign == "^2" && expression[sign.len()..].starts_with(is_name_letter);
    (!is_longer_number).then(|| &expression[..sign.len()])
}

/// The word of a name or a whole number. A name of a scale cannot begin with a digit.
fn name_word(token: &str, is_first: bool) -> Option<String> {
    let is_number = token.starts_with(|letter: char| letter.is_ascii_digit());
    match (token, split_primes(token)) {
        ("1", _) if is_first => Some("one".to_owned()),
        ("2", _) if is_first => Some("two".to_owned()),
        _ if is_number && is_first => None,
        (_, (_, 0)) => Some(token.to_owned()),
        (_, (name, order)) => Some(derivative_name(name, order)),
    }
}

/// Whether a letter can be in a name.
fn is_name_letter(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || letter == '_'
}

/// The length of the beginning of a text that consists of such letters, in bytes.
fn length_of(text: &str, is_inside: impl Fn(char) -> bool) -> usize {
    text.find(|letter: char| !is_inside(letter)).unwrap_or(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_expressions_have_names() {
        let cases = [
            ("sin(theta1)", "sin_theta1"),
            ("cos(theta')", "cos_theta_dot"),
            ("exp(-x)", "exp_minus_x"),
            ("V - E_ca", "V_minus_E_ca"),
            ("1 - x", "one_minus_x"),
            ("1 + x^2", "one_plus_x_squared"),
            ("x/r", "x_over_r"),
            ("sqrt(2 g h1)", "sqrt_2_g_h1"),
            ("ln(out/u_ref)", "ln_out_over_u_ref"),
            ("phi + beta", "phi_plus_beta"),
            ("sign(sliding)", "sign_sliding"),
            ("max(memory, 0)", "memory_positive"),
            ("max(-x', 0)", "x_dot_negative"),
        ];
        for (expression, expected) in cases {
            assert_eq!(short_name(expression).as_deref(), Some(expected), "{expression}");
        }
    }

    #[test]
    fn long_and_ambiguous_expressions_have_none() {
        let expressions = [
            "sin(theta1) - sin(theta2)",
            "(a + b) c",
            "a (b - c)",
            "sin(a + b)",
            "max(x - width, 0)",
            "max(x, y)",
            "0.5 x",
            "1.5 + x",
            "x - 0.5",
            "x^3",
            "x^25",
            "10 x",
            "a b c d",
            "{1 if x > 0; 0 otherwise}",
            "",
        ];
        for expression in expressions {
            assert_eq!(short_name(expression), None, "{expression}");
        }
    }
}
