//! Notes of elements, and the steps of the gain rule for a student.

use patchcord_expr::format_significant;

use super::design::{Branch, Design};
use super::formula::Product;
use super::gains::LEAST_SETTING;
use crate::graph::{NodeId, Operation};
use crate::symbolic::Fraction;

/// Digits of numbers in the text of a step.
const DIGITS: usize = 4;

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
    /// The coefficient of the equation with its sign, as a formula.
    pub coefficient: String,
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
        let sign = if branch.sign < 0 { "-" } else { "" };
        let name = |id: NodeId| design.input.plan.node(id).name.clone();
        let route = branch.route;
        GainStep {
            element: element.to_owned(),
            output: name(id),
            input: name(branch.node),
            coefficient: format!("{sign}{}", coefficient_text(design, &branch.coefficient)),
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

    /// The step as an equation in numbers: `(k / m) x: 40 x 0.001 / 0.01 = 4 = 10 x 0.4`.
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
        let term = if self.input == "1" { self.coefficient.clone() } else { self.term() };
        let gain = number(self.computer_gain);
        let factors = factors.join(" x ");
        format!("{term}: {coefficient} x {input} / {output}{time_scale} = {gain} = {factors}")
    }

    /// The coefficient with the quantity at the input.
    fn term(&self) -> String {
        match self.coefficient.as_str() {
            "1" => self.input.clone(),
            "-1" => negated(&self.input),
            coefficient => format!("{} {}", grouped(coefficient, ' '), grouped_sum(&self.input)),
        }
    }
}

/// The text of a coefficient; its value if it has no text.
fn coefficient_text(design: &Design<'_>, coefficient: &Fraction) -> String {
    let expressions = &design.table.expressions;
    let text = Product::one().times(coefficient, expressions).text();
    text.unwrap_or_else(|| format_significant(expressions.value(coefficient), DIGITS))
}

/// The text of a coefficient times a node, such as `(k / m) x`.
pub(super) fn term_text(design: &Design<'_>, coefficient: &Fraction, node: NodeId) -> String {
    let text = coefficient_text(design, coefficient);
    let name = &design.input.plan.node(node).name;
    if *design.input.operation(node) == Operation::One {
        return text;
    }
    if text == "1" { name.clone() } else { format!("{} {}", grouped(&text, ' '), grouped_sum(name)) }
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
    match text.strip_prefix("- ") {
        Some(positive) if !is_sum(positive) => positive.to_owned(),
        _ => format!("- {}", grouped_sum(text)),
    }
}

/// A text in parentheses if it contains a character.
fn grouped(text: &str, character: char) -> String {
    if text.contains(character) { format!("({text})") } else { text.to_owned() }
}

/// A text in parentheses if it is a sum.
fn grouped_sum(text: &str) -> String {
    if is_sum(text) { format!("({text})") } else { text.to_owned() }
}

/// Whether a text is a sum outside of parentheses.
fn is_sum(text: &str) -> bool {
    let mut depth = 0_i32;
    text.char_indices().any(|(index, letter)| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        depth == 0 && (text[index..].starts_with(" + ") || text[index..].starts_with(" - "))
    })
}
