//! Notes of elements, and the steps of the gain rule for a student.

use patchcord_expr::format_significant;

use super::design::{Branch, Design};
use super::gains::LEAST_SETTING;
use crate::graph::{NodeId, Operation};
use crate::notation::{Notation, is_one, rounded, text};
use crate::symbolic::Fraction;
use crate::writing::Writer;

/// Digits of numbers in the text of a step.
const DIGITS: usize = 4;
/// Digits of numbers in notes.
const NOTE_DIGITS: usize = 6;

/// The gain rule (eq. 4-8) for one input of an integrator, a summer or a pot:
/// computer gain = coefficient x input scale / output scale, and for an integrator / time scale.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GainStep {
    /// The element whose input it is.
    pub element: String,
    /// What the element computes, such as x'.
    pub output: String,
    /// The quantity at the input.
    pub input: String,
    /// The term of the equation with its sign: the coefficient times the quantity at the input.
    pub term: String,
    /// The value of the coefficient without its sign, in SI units.
    pub coefficient_value: f64,
    /// The value of one volt of the input in SI units.
    pub input_scale: f64,
    /// The value of one volt of the output in SI units.
    pub output_scale: f64,
    /// Machine seconds per problem second for an integrator. `None` for other elements.
    pub time_scale: Option<f64>,
    /// The coefficient in volts per volt, and per machine second for an integrator.
    pub computer_gain: f64,
    /// The setting of the pot. `None` if there is none.
    pub setting: Option<f64>,
    /// The gain of each cord.
    pub gain: f64,
    /// Number of equal cords.
    pub cords: u32,
    /// Number of additional summers with a gain of 10.
    pub summers: u32,
}

impl GainStep {
    /// The step for an input of the node `id`, which the element computes. `time_scale` is given for an integrator.
    pub(super) fn new(
        design: &Design<'_>,
        element: &str,
        id: NodeId,
        branch: &Branch,
        time_scale: Option<f64>,
    ) -> Self {
        let name = |id: NodeId| design.input.plan.node(id).name.clone();
        let route = branch.route;
        GainStep {
            element: element.to_owned(),
            output: name(id),
            input: name(branch.node),
            term: signed(&term_text(design, &branch.coefficient, branch.node), branch.sign),
            coefficient_value: design.table.expressions.value(&branch.coefficient),
            input_scale: design.table.value(branch.node),
            output_scale: design.table.value(id),
            time_scale,
            computer_gain: branch.gain,
            setting: route.has_pot.then_some(branch.setting_value),
            gain: route.gain,
            cords: route.cords,
            summers: route.summers,
        }
    }

    /// The step as an equation in numbers: `A2, - (k/m) x: 40 * 0.001 / 0.01 = 4 = 10 * 0.4`.
    /// The sign of the product is that of formulas, because `x` is a common quantity.
    pub(crate) fn text(&self) -> String {
        let number = |value: f64| format_significant(value, DIGITS);
        let [input, output] = [self.input_scale, self.output_scale].map(number);
        let coefficient = number(self.coefficient_value);
        let time_scale = self.time_scale.filter(|time_scale| *time_scale != 1.0);
        let time_scale = time_scale.map_or(String::new(), |time_scale| format!(" / {}", number(time_scale)));
        let mut factors = vec![number(self.gain)];
        factors.extend((self.cords > 1).then(|| format!("{} cords", self.cords)));
        factors.extend((self.summers > 0).then(|| "10".to_owned()));
        factors.extend(self.setting.map(number));
        let (gain, factors) = (number(self.computer_gain), factors.join(" * "));
        let GainStep { element, term, .. } = self;
        format!("{element}, {term}: {coefficient} * {input} / {output}{time_scale} = {gain} = {factors}")
    }
}

/// The text of a coefficient times a node in the language of equations, such as `(k/m) x`.
pub(super) fn term_text(design: &Design<'_>, coefficient: &Fraction, node: NodeId) -> String {
    let constant = rounded(&Writer::physical(&design.system).expression(coefficient, None), NOTE_DIGITS);
    let name = &design.input.plan.node(node).name;
    match *design.input.operation(node) {
        Operation::One => text(&constant),
        _ if is_one(&constant) => name.clone(),
        _ => text(&multiplied(constant, as_factor(name))),
    }
}

/// A constant times a text. The inverse of a constant is a divisor: `x/T` and not `(1/T) x`.
fn multiplied(constant: Notation, factor: String) -> Notation {
    let own = |name: String| Notation::Name { name, primes: 0 };
    match constant {
        Notation::Negative(size) => Notation::Negative(Box::new(multiplied(*size, factor))),
        Notation::Quotient(top, bottom) if is_one(&top) => Notation::Quotient(Box::new(own(factor)), bottom),
        Notation::Product(factors) => Notation::Product(factors.into_iter().chain([own(factor)]).collect()),
        constant => Notation::Product(vec![constant, own(factor)]),
    }
}

/// The text of the product of two nodes.
pub(super) fn product_text(design: &Design<'_>, first: NodeId, second: NodeId) -> String {
    let [first, second] = [first, second].map(|id| as_factor(&design.input.plan.node(id).name));
    format!("{first} {second}")
}

/// The note of the pot of an input: the term, and a remark if the setting is small.
pub(super) fn pot_note(design: &Design<'_>, branch: &Branch, polarity: i8) -> String {
    let note = signed(&term_text(design, &branch.coefficient, branch.node), polarity);
    let is_small = branch.setting_value < LEAST_SETTING;
    if is_small { format!("{note}; a setting below {LEAST_SETTING}") } else { note }
}

/// A text with the sign of a polarity.
pub(super) fn signed(text: &str, polarity: i8) -> String {
    if polarity < 0 { negated(text) } else { text.to_owned() }
}

/// A text with a minus sign in front. Of a text that has one, it is removed.
fn negated(text: &str) -> String {
    match text.strip_prefix('-').map(str::trim_start) {
        Some(positive) if !contains_outside(positive, &SUMS) => positive.to_owned(),
        _ if contains_outside(text, &SUMS) => format!("- ({text})"),
        _ => format!("- {text}"),
    }
}

/// A text as a factor: in parentheses if it is a sum or a quotient, or negative.
fn as_factor(text: &str) -> String {
    let is_grouped = text.starts_with('-') || contains_outside(text, &SUMS) || contains_outside(text, &["/"]);
    if is_grouped { format!("({text})") } else { text.to_owned() }
}

/// The signs of sums.
const SUMS: [&str; 2] = [" + ", " - "];

/// Whether a text contains one of these signs outside of parentheses.
fn contains_outside(text: &str, signs: &[&str]) -> bool {
    let mut depth = 0_i32;
    text.char_indices().any(|(index, letter)| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        depth == 0 && signs.iter().any(|sign| text[index..].starts_with(sign))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_text_loses_its_sign() {
        let cases = [("x", "- x"), ("-E_k", "E_k"), ("- (k/m) x", "(k/m) x"), ("1 - x", "- (1 - x)")];
        for (text, expected) in
            cases.into_iter().chain([("-a + b", "- (-a + b)"), ("abs(a - b)", "- abs(a - b)")])
        {
            assert_eq!(negated(text), expected);
        }
    }

    #[test]
    fn a_constant_is_in_front_of_a_factor() {
        let name = |name: &str| Notation::Name { name: name.to_owned(), primes: 0 };
        let number = |value| Notation::Number { value, unit: None };
        let quotient = |top, bottom| Notation::Quotient(Box::new(top), Box::new(bottom));
        let term = |constant, node: &str| text(&multiplied(rounded(&constant, NOTE_DIGITS), as_factor(node)));
        assert_eq!(term(quotient(name("k"), name("m")), "x"), "(k/m) x");
        assert_eq!(term(quotient(number(1.0), name("T")), "x y"), "x y/T");
        assert_eq!(term(quotient(number(1.0), name("T")), "a - b"), "(a - b)/T");
        assert_eq!(term(Notation::Product(vec![number(0.5), name("k")]), "x^2"), "0.5 k x^2");
        assert_eq!(term(Notation::Negative(Box::new(name("k"))), "-x"), "-k (-x)");
        assert_eq!(term(number(8.685_889_638), "ln(u)"), "8.68589 ln(u)");
        assert_eq!(term(name("k"), "a/b"), "k (a/b)");
    }
}
