//! The audit of amplitude scaling by the stated equations: computer gain = input scale x block gain / output scale
//! (eq. 4-8).
//!
//! The core lists the linear wiring between scaled signals. Here an equation decides about each: the block gain is the
//! factor of the input signal in the equation that is solved for the output signal, or for its derivative if the wiring
//! has integrators. Wiring about which no equation decides is listed without a required gain.

mod solved_equations;

use std::collections::BTreeSet;

use patchcord_core::circuit::{Circuit, ScalingRow, SignalPoint};
use patchcord_core::ir::Program;
use patchcord_expr::split_primes;

use crate::derive::System;
use crate::graph::ConstantValues;
use crate::notation::{primed, text};
use crate::static_check::stated::{Alias, Stated, aliases};
use crate::symbolic::{Fraction, partial_derivative};
use crate::writing::Writer;
use solved_equations::{Path, Quantity, SolvedEquation, SolvedEquations, solved_for};

/// A gain of the wiring between two scaled signals, and whether it is right.
#[derive(Debug, Clone, PartialEq)]
pub struct AuditedGain {
    /// The wiring.
    pub row: ScalingRow,
    /// What is known about its gain.
    pub decision: GainDecision,
}

/// What is known about a gain.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum GainDecision {
    /// A stated equation requires a gain.
    Equation {
        /// Index of the equation among those of the patch.
        index: usize,
        /// The block gain, such as "-k/m".
        block: String,
        /// The required computer gain, with its sign.
        gain: f64,
    },
    /// The output is the integral of the input, as their units say.
    Integral {
        /// The required computer gain. Its sign is that of the computer gain, because the units say nothing about it.
        gain: f64,
    },
    /// Nothing decides; the text says why.
    Undecided(String),
}

/// Relative deviation of a gain from that of an equation up to which it is right. Settings are often rounded to three
/// digits.
const TOLERANCE: f64 = 1e-3;
/// The same for a signal and its integral, as in the check of every patch.
const INTEGRAL_TOLERANCE: f64 = 1e-2;

impl AuditedGain {
    /// The required computer gain. `None` if nothing decides.
    pub fn required_gain(&self) -> Option<f64> {
        match self.decision {
            GainDecision::Equation { gain, .. } | GainDecision::Integral { gain } => Some(gain),
            GainDecision::Undecided(_) => None,
        }
    }

    /// The relative deviation of the computer gain from the required one. It is -2 if only the sign is wrong. `None` if
    /// nothing decides, or if the required gain is 0.
    pub fn relative_error(&self) -> Option<f64> {
        let required = self.required_gain().filter(|gain| *gain != 0.0)?;
        Some(self.row.computer_gain / required - 1.0)
    }

    /// Whether the gain is wrong.
    pub fn is_wrong(&self) -> bool {
        let tolerance = match self.decision {
            GainDecision::Integral { .. } => INTEGRAL_TOLERANCE,
            GainDecision::Equation { .. } | GainDecision::Undecided(_) => TOLERANCE,
        };
        match (self.required_gain(), self.relative_error()) {
            (Some(_), Some(error)) => error.abs() > tolerance,
            (Some(_), None) => self.row.computer_gain != 0.0,
            _ => false,
        }
    }
}

/// All linear wiring between scaled signals with what the stated equations require of it, in the order of the output
/// signals.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::Patch;
/// use patchcord_equations::{GainDecision, audit_scaling};
///
/// let circuit = Circuit::new(&Patch::read("../../patches/lessons/mass-and-spring.json")?)?;
/// let gains = audit_scaling(&circuit, &Program::new(&circuit)?);
/// let spring = gains.iter().find(|gain| (&gain.row.input[..], &gain.row.output[..]) == ("x", "v"));
/// let spring = spring.expect("the spring accelerates the mass");
/// // -k/m = -40 1/s2, with 1 mm and 10 mm/s per volt.
/// let GainDecision::Equation { block, gain, .. } = &spring.decision else { panic!("m x'' = -k x decides") };
/// assert!(block.contains("k/m"), "{block}");
/// assert!((gain + 4.0).abs() < 1e-12 && !spring.is_wrong());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn audit_scaling(circuit: &Circuit, program: &Program) -> Vec<AuditedGain> {
    let audit = Audit::new(circuit, program);
    let rows = circuit.scaling();
    let decisions: Vec<GainDecision> = rows.iter().map(|row| audit.decision(row, &rows)).collect();
    rows.into_iter().zip(decisions).map(|(row, decision)| AuditedGain { row, decision }).collect()
}

/// The factor of a signal in a solved equation.
enum Factor {
    /// It is constant in a run.
    Constant(Fraction, usize),
    /// It varies.
    Varying,
    /// The equation does not contain the signal.
    Absent,
}

/// The stated equations of a circuit, each solved for a quantity.
struct Audit<'a> {
    /// The circuit.
    circuit: &'a Circuit,
    /// The values of parameters.
    constants: ConstantValues,
    /// The names that equations give to derivatives.
    aliases: Vec<Alias<'a>>,
    /// The solved equations.
    equations: SolvedEquations,
}

impl<'a> Audit<'a> {
    /// Solves the equations of a circuit.
    fn new(circuit: &'a Circuit, program: &Program) -> Self {
        let aliases = aliases(circuit);
        let mut stated = Stated::new(circuit, program);
        let mut solved = Vec::new();
        for (index, residual) in stated.residuals.clone() {
            let renamed = renamed(&mut stated, &aliases, &residual);
            solved.extend(solved_equation(circuit, &mut stated, &aliases, index, &renamed));
        }
        let Stated { symbols, .. } = stated;
        let system = System::without_laws(symbols);
        let constants = ConstantValues::new(&system.symbols, circuit);
        Audit { circuit, constants, aliases, equations: SolvedEquations { system, solved } }
    }

    /// What is known about a row of all rows.
    fn decision(&self, row: &ScalingRow, rows: &[ScalingRow]) -> GainDecision {
        self.by_equation(row, rows).unwrap_or_else(|reason| match row.expected_gain {
            Some(gain) => GainDecision::Integral { gain },
            None => GainDecision::Undecided(reason),
        })
    }

    /// What an equation says about a row of all rows.
    ///
    /// # Errors
    /// The reason if no equation decides.
    fn by_equation(&self, row: &ScalingRow, rows: &[ScalingRow]) -> Result<GainDecision, String> {
        if self.circuit.equations().is_empty() {
            return Err("the patch states no equations".to_owned());
        }
        let output = primed(&row.output, row.integrations);
        let mut reason = format!("no stated equation gives {output} as a function of {}", row.input);
        let inputs = self.inputs(row, rows);
        for (output, input) in self.pairs(row) {
            match self.factor(&output.name, row.integrations, &input.name, &inputs) {
                Factor::Constant(factor, index) => {
                    let decision = self.required(&factor, index, [output, input], row.integrations);
                    return decision.ok_or_else(|| "a scale has no value".to_owned());
                }
                Factor::Varying => {
                    let derivative = primed(&output.name, row.integrations);
                    reason = format!("the factor of {} in {derivative} is not constant", input.name);
                }
                Factor::Absent => {}
            }
        }
        Err(reason)
    }

    /// The signals at both ends of a row: those that it names, and others at the same outputs.
    fn pairs(&self, row: &ScalingRow) -> Vec<(&SignalPoint, &SignalPoint)> {
        let [outputs, inputs] = [&row.output, &row.input].map(|name| self.points_at(name));
        outputs.iter().flat_map(|output| inputs.iter().map(move |input| (*output, *input))).collect()
    }

    /// The names of all signals from which the wiring computes the output of a row.
    fn inputs(&self, row: &ScalingRow, rows: &[ScalingRow]) -> BTreeSet<&str> {
        let same = rows
            .iter()
            .filter(|other| (&other.output, other.integrations) == (&row.output, row.integrations));
        same.flat_map(|other| self.points_at(&other.input)).map(|point| point.name.as_str()).collect()
    }

    /// The scaled signals at the output that a signal reads, this signal first.
    fn points_at(&self, name: &str) -> Vec<&SignalPoint> {
        let points = self.circuit.signals();
        let Some(own) = points.iter().find(|point| point.name == name) else { return Vec::new() };
        let mut found: Vec<&SignalPoint> =
            points.iter().filter(|point| point.element == own.element && point.scale.is_some()).collect();
        found.sort_by_key(|point| point.name != name);
        found
    }

    /// The factor of an input signal in the equation for a derivative of an output signal. If there is none, both may be
    /// differentiated once more: an equation for x' can contain the derivative of a drive.
    fn factor(&self, output: &str, order: usize, input: &str, inputs: &BTreeSet<&str>) -> Factor {
        match self.factor_of((output, order), (input, 0), inputs) {
            Factor::Absent => self.factor_of((output, order + 1), (input, 1), inputs),
            found => found,
        }
    }

    /// The factor of an input signal with this number of derivatives in the equation for a derivative of an output
    /// signal.
    fn factor_of(
        &self,
        (output, order): (&str, usize),
        (input, derivatives): (&str, u8),
        inputs: &BTreeSet<&str>,
    ) -> Factor {
        let canonical = canonical(&self.aliases, output, order);
        let Some(input) = self.equations.system.symbols.find(input, derivatives) else {
            return Factor::Absent;
        };
        let path = self.equations.symbol(&canonical).map(|of| Path { of, input, inputs });
        let same = path.into_iter().flat_map(|path| self.equations.values(path));
        let mut is_varying = false;
        for (value, index) in same.chain(self.alias_value(output, order, &canonical)) {
            let factor = partial_derivative(&value, input);
            match (factor.is_zero(), factor.is_constant()) {
                (true, _) => {}
                (false, true) => return Factor::Constant(factor, index),
                (false, false) => is_varying = true,
            }
        }
        if is_varying { Factor::Varying } else { Factor::Absent }
    }

    /// The name of a derivative as its value, with the index of the equation that gives it: v for x'.
    fn alias_value(&self, output: &str, order: usize, canonical: &Quantity) -> Option<(Fraction, usize)> {
        if *canonical == (output.to_owned(), order) {
            return None;
        }
        let symbol = self.equations.symbol(canonical)?;
        let alias = self.aliases.iter().find(|alias| alias.name == canonical.0)?;
        Some((Fraction::symbol(symbol), alias.index))
    }

    /// The decision of an equation with this factor between two signals. `None` if a scale has no value or is 0.
    fn required(
        &self,
        factor: &Fraction,
        index: usize,
        [output, input]: [&SignalPoint; 2],
        integrations: usize,
    ) -> Option<GainDecision> {
        let [output, input] = [self.per_volt(output)?, self.per_volt(input)?];
        let time = self.circuit.time_scale().powi(i32::try_from(integrations).ok()?);
        let gain = input * self.constants.value(factor) / output / time;
        let writer = Writer::new(self.circuit, &self.equations.system);
        let block = text(&writer.expression(factor, writer.dimension(factor)));
        gain.is_finite().then_some(GainDecision::Equation { index, block, gain })
    }

    /// The value of one volt of a signal in SI, including its factor.
    fn per_volt(&self, point: &SignalPoint) -> Option<f64> {
        let scale = point.scale?;
        let unit = self.circuit.derived_unit(scale);
        Some(unit.to_si(self.circuit.per_volt(scale)?) * point.factor)
    }
}

/// A quantity under the last name that equations give to it: v' for x'' if `v = x'`.
fn canonical(aliases: &[Alias<'_>], name: &str, order: usize) -> Quantity {
    let (mut name, mut order) = (name, order);
    // Every alias applies at most once, so a circle ends.
    for _ in aliases {
        let Some(alias) = aliases.iter().find(|alias| alias.of == name && alias.order <= order) else {
            break;
        };
        (name, order) = (alias.name, order - alias.order);
    }
    (name.to_owned(), order)
}

/// An expression with every quantity under its last name.
fn renamed(stated: &mut Stated<'_>, aliases: &[Alias<'_>], value: &Fraction) -> Fraction {
    value.mapped(&mut |symbol| {
        if !stated.varies(symbol) {
            return Fraction::symbol(symbol);
        }
        let entry = stated.symbols.entry(symbol);
        let (name, order) = canonical(aliases, &entry.name, usize::from(entry.primes));
        Fraction::symbol(stated.symbol(&name, order))
    })
}

/// An equation for the quantity with the most primes on its left, or else on its right. `None` if it is not linear in
/// it. `residual` is the equation as an expression that is 0, with every quantity under its last name.
fn solved_equation(
    circuit: &Circuit,
    stated: &mut Stated<'_>,
    aliases: &[Alias<'_>],
    index: usize,
    residual: &Fraction,
) -> Option<SolvedEquation> {
    let mut names = circuit.equations()[index].value.names();
    names.retain(|name| stated.is_variable(split_primes(name).0));
    names.sort_by_key(|name| std::cmp::Reverse(split_primes(name).1));
    let (base, order) = split_primes(names.first()?);
    let of = canonical(aliases, base, order);
    let symbol = stated.symbol(&of.0, of.1);
    solved_for(residual, symbol)?;
    Some(SolvedEquation { of, residual: residual.clone(), index })
}

#[cfg(test)]
mod tests;
