//! The circuit of each node: a pot, an amplifier with its inputs, or another element.

use patchcord_core::document::Diagnostic;
use patchcord_core::machines::REFERENCE;
use patchcord_expr::format_significant;
use serde_json::Value;

use super::GOOD_VOLTS;
use super::Scales;
use super::formula::SettingFormula;
use super::gains::{Coefficient, GAIN_OF_SUMMER, Route, route};
use super::input::Input;
use super::names::ScaleNames;
use super::scale_table::ScaleTable;
use crate::derive::System;
use crate::graph::{NodeId, Operation, Sum, Term};
use crate::symbolic::Fraction;

/// The largest gain of an open amplifier for which its feedback is not reduced.
const LARGEST_OPEN_GAIN: f64 = 10.0;

/// A node in the sum of another one, as an input of an amplifier.
#[derive(Debug, Clone)]
pub(super) struct Branch {
    /// The node.
    pub node: NodeId,
    /// The coefficient of the equation without its sign.
    pub coefficient: Fraction,
    /// The sign of the coefficient: 1 or -1.
    pub sign: i8,
    /// The coefficient in volts per volt, and per machine second for an integrator.
    pub gain: f64,
    /// The pot, the gain and the cords.
    pub route: Route,
    /// The setting of the pot as a formula.
    pub setting: Value,
    /// The setting of the pot as a number.
    pub setting_value: f64,
}

/// The circuit of a node.
#[derive(Debug, Clone)]
pub(super) enum Block {
    /// The reference voltage.
    Reference,
    /// A sum without terms: 0 V.
    Ground,
    /// A drive.
    Drive,
    /// The output of another node times a sign: no part is necessary.
    Alias {
        /// The other node.
        node: NodeId,
        /// The sign: 1 or -1.
        sign: i8,
    },
    /// A pot at the output of another node.
    Share(Branch),
    /// An amplifier with its inputs.
    Amplifier {
        /// The inputs.
        branches: Vec<Branch>,
        /// The factor of the feedback of an open amplifier, which multiplies all inputs too.
        feedback: f64,
    },
    /// Another element, which `elements` describes.
    Element,
}

/// The voltage that the inputs of an amplifier add up to.
struct Total {
    /// The value of one volt of it as an expression, per machine second for an integrator.
    expression: Fraction,
    /// The value of one volt in SI units.
    value: f64,
    /// Whether the value depends on parameters.
    is_parametric: bool,
    /// Whether the sum is a rate, so that the time scale divides it.
    is_rate: bool,
    /// The permitted gains.
    gains: &'static [f64],
    /// Whether an additional summer can follow a pot. It cannot in front of an integrator, where pots are rates.
    may_add_summer: bool,
}

/// A plan with scales: everything that determines the circuits of the nodes.
#[derive(Debug)]
pub(super) struct Design<'a> {
    /// The plan and the problem.
    pub input: &'a Input<'a>,
    /// The scales.
    pub table: ScaleTable<'a>,
    /// The names of scales and signals.
    pub names: ScaleNames,
    /// The parameters, for writing coefficients.
    pub system: System,
    /// Machine seconds per problem second.
    pub time_scale: f64,
}

impl<'a> Design<'a> {
    /// The design of a plan with these scales.
    pub(super) fn new(input: &'a Input<'a>, scales: &Scales) -> Self {
        let names = ScaleNames::new(input);
        let table = ScaleTable::new(input, &scales.per_volt, &|id| names.of_node(id));
        let system = System::without_laws(input.plan.symbols.clone());
        Design { input, table, names, system, time_scale: scales.time_scale }
    }

    /// The circuit of a node.
    ///
    /// # Errors
    /// If a coefficient is too large for the gains of the machine.
    pub(super) fn block(&self, id: NodeId) -> Result<Block, Diagnostic> {
        Ok(match self.input.operation(id) {
            Operation::One => Block::Reference,
            Operation::Drive(_) => Block::Drive,
            Operation::Sum(sum) if sum.terms.is_empty() => Block::Ground,
            Operation::Sum(sum) => match self.share(id, sum) {
                Some(share) => share,
                None => self.amplifier(id, sum, &self.total(id), 1.0)?,
            },
            Operation::Limited { sum, .. } => self.amplifier(id, sum, &self.total(id), 1.0)?,
            Operation::Integral { rate, .. } => {
                let gains = self.input.integrator_gains();
                let total = Total { is_rate: true, gains, may_add_summer: false, ..self.total(id) };
                self.amplifier(id, rate, &total, 1.0)?
            }
            Operation::Quotient { dividend, divisor } => {
                self.with_feedback(id, dividend, self.product_total(id, *divisor))?
            }
            Operation::Root(sum) => self.with_feedback(id, sum, self.product_total(id, id))?,
            Operation::Zero(sum) => self.amplifier(id, sum, &self.balance(id, sum), 1.0)?,
            _ => Block::Element,
        })
    }

    /// The total of a summer: the output itself.
    fn total(&self, id: NodeId) -> Total {
        let entry = self.table.entry(id);
        Total {
            expression: entry.expression.clone(),
            value: entry.value,
            is_parametric: entry.is_parametric,
            is_rate: false,
            gains: self.input.summer_gains(),
            may_add_summer: true,
        }
    }

    /// The total of an open amplifier with a multiplier in its feedback: the product of two nodes over 100 V.
    fn product_total(&self, first: NodeId, second: NodeId) -> Total {
        let [one, other] = [first, second].map(|id| self.table.entry(id));
        let product = one.expression.times(&other.expression).times(&Fraction::number(REFERENCE));
        Total {
            expression: product,
            value: REFERENCE * one.value * other.value,
            is_parametric: one.is_parametric || other.is_parametric,
            may_add_summer: false,
            ..self.total(first)
        }
    }

    /// The total of an open amplifier whose inputs cancel: one at which the largest coefficient is the largest gain. So the
    /// inputs that remain, which are those of a finite amplification, are small.
    fn balance(&self, id: NodeId, sum: &Sum) -> Total {
        let weight = |(node, c): (&NodeId, &Fraction)| {
            let term = Term { coefficient: c.clone(), node: *node };
            (self.table.weight(&term), term)
        };
        let weights: Vec<(f64, Term)> = sum.terms.iter().map(weight).collect();
        let largest = weights.iter().max_by(|(one, _), (other, _)| one.total_cmp(other));
        let (value, expression) = match largest {
            Some((weight, term)) if *weight > 0.0 => (*weight, self.table.size_of(term)),
            _ => (1.0, Fraction::whole(1)),
        };
        let total = self.total(id);
        let gain = largest_gain(&total);
        Total {
            expression: expression.over(&Fraction::number(gain)),
            value: value / gain,
            is_parametric: false,
            may_add_summer: false,
            ..total
        }
    }

    /// The circuit of a sum with one term that needs no amplifier. `None` for other sums.
    fn share(&self, id: NodeId, sum: &Sum) -> Option<Block> {
        let (node, coefficient) = sum.terms.first_key_value().filter(|_| sum.terms.len() == 1)?;
        let total = self.total(id);
        let (branch, coefficient) = self.branch(*node, coefficient, &total, &|_| Some(Route::POT)).ok()?;
        if coefficient.is_fixed && coefficient.is(1.0) {
            return Some(Block::Alias { node: *node, sign: branch.sign });
        }
        coefficient.fits_pot().then_some(Block::Share(branch))
    }

    /// An open amplifier with a multiplier in its feedback.
    ///
    /// The feedback and all coefficients can be multiplied by the same factor. If the coefficients are at most 1, it is
    /// the largest gain, because the error of a finite amplification is inversely proportional to the gain of the
    /// feedback. If they are large, it is a negative power of ten.
    fn with_feedback(&self, id: NodeId, sum: &Sum, total: Total) -> Result<Block, Diagnostic> {
        let weight = |(node, c): (&NodeId, &Fraction)| {
            self.table.weight(&Term { coefficient: c.clone(), node: *node }) / total.value
        };
        let largest = sum.terms.iter().map(weight).fold(0.0, f64::max);
        let feedback = if largest > LARGEST_OPEN_GAIN {
            10f64.powi(-((largest / LARGEST_OPEN_GAIN).log10().ceil() as i32))
        } else if largest <= 1.0 {
            largest_gain(&total)
        } else {
            1.0
        };
        let expression = total.expression.over(&Fraction::number(feedback));
        let total = Total { expression, value: total.value / feedback, ..total };
        self.amplifier(id, sum, &total, feedback)
    }

    /// An amplifier with the terms of a sum as inputs.
    fn amplifier(&self, id: NodeId, sum: &Sum, total: &Total, feedback: f64) -> Result<Block, Diagnostic> {
        let mut branches = Vec::new();
        for (node, coefficient) in &sum.terms {
            // The summer after the pot has a tenth of the voltage that the term adds to the output.
            let added = |gain: f64| gain * self.input.peak(*node) / self.table.value(*node) / GAIN_OF_SUMMER;
            let choose = |coefficient: &Coefficient| {
                let may_add_summer = total.may_add_summer && added(coefficient.value) <= GOOD_VOLTS[1];
                route(coefficient, total.gains, may_add_summer)
            };
            match self.branch(*node, coefficient, total, &choose) {
                Ok((branch, _)) => branches.push(branch),
                Err(gain) => return Err(self.too_large(id, *node, gain, total)),
            }
        }
        Ok(Block::Amplifier { branches, feedback })
    }

    /// A term as an input, with its coefficient in volts per volt. `choose` gives the route for the coefficient.
    ///
    /// # Errors
    /// The coefficient in volts per volt if there is no route.
    fn branch(
        &self,
        node: NodeId,
        coefficient: &Fraction,
        total: &Total,
        choose: &dyn Fn(&Coefficient) -> Option<Route>,
    ) -> Result<(Branch, Coefficient), f64> {
        let expressions = &self.table.expressions;
        let entry = self.table.entry(node);
        let (sign, positive) = (expressions.sign(coefficient), expressions.positive(coefficient));
        let time_scale = if total.is_rate { self.time_scale } else { 1.0 };
        let factor = entry.value / total.value / time_scale;
        let ratio = positive.times(&entry.expression).over(&total.expression);
        let is_parametric = entry.is_parametric || total.is_parametric || expressions.has_parameters(&ratio);
        let in_volts = Coefficient {
            value: expressions.value(&positive) * factor,
            // Parameters that the coefficient and the scales have in common cancel.
            most: expressions.largest(&ratio) / time_scale,
            is_fixed: !is_parametric,
            is_unbounded: expressions.has_unbounded_parameters(&ratio),
        };
        let route = choose(&in_volts).ok_or(in_volts.value)?;
        let product = SettingFormula::one()
            .times(&positive, expressions)
            .times(&entry.expression, expressions)
            .over(&total.expression, expressions)
            .times_time_scale(-i32::from(time_scale != 1.0));
        let setting_value = in_volts.value / route.factor();
        let setting = route.setting(product).setting(setting_value);
        let gain = in_volts.value;
        let branch = Branch { node, coefficient: positive, sign, gain, route, setting, setting_value };
        Ok((branch, in_volts))
    }

    /// The diagnostic for a coefficient without a circuit.
    fn too_large(&self, id: NodeId, node: NodeId, gain: f64, total: &Total) -> Diagnostic {
        let plan = &self.input.plan;
        let [output, source] = [id, node].map(|id| plan.node(id).name.as_str());
        if !gain.is_finite() {
            let message =
                format!("the scales of {source} and {output} are too far apart: their gain is no number");
            return self.input.fault(id, message, &format!("give {source} and {output} a \"maximum\""));
        }
        let number = format_significant(gain, 3);
        let most = largest_gain(total);
        let noun = if total.is_rate { "an integrator" } else { "an amplifier" };
        let message =
            format!("{source} has a gain of {number} in {output}, and the largest gain of {noun} is {most}");
        let hint = if total.is_rate {
            format!(
                "give {output} a larger \"maximum\", or choose a larger time scale, which divides the gain"
            )
        } else {
            format!("{output} is a small difference of large quantities: give it a larger \"maximum\"")
        };
        self.input.fault(id, message, &hint)
    }
}

/// The largest gain of an input that adds to a total.
fn largest_gain(total: &Total) -> f64 {
    total.gains.last().copied().unwrap_or(1.0)
}
