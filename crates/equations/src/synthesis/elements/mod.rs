//! The elements that compute each operation.

mod feedback;
pub(super) mod functions;
mod linear;
mod networks;

use patchcord_core::document::{Diagnostic, format_number, unit_suffix};
use patchcord_core::machines::REFERENCE;
use patchcord_expr::{format_significant, round_significant};
use serde_json::Value;

use super::assembly::Assembly;
use super::design::{Block, Design};
use super::formula::{EXACT_DIGITS, SettingFormula, json_number};
use crate::graph::{NodeId, Operation};
use crate::symbolic::{Fraction, nearest};

/// Rounding of a voltage, as a share of it.
const ROUNDING: f64 = 1e-12;
/// Significant digits of an advised number.
const ADVISED_DIGITS: usize = 3;
/// The factor by which a number grows if rounding to [`ADVISED_DIGITS`] has made it smaller.
const ROUNDED_UP: f64 = 1.005;
/// Share of an advised number that counts as its rounding error.
const NUMBER_TOLERANCE: f64 = 1e-9;

/// Adds the elements of a node.
///
/// # Errors
/// If a setting would be outside the range of its element.
pub(super) fn add(assembly: &mut Assembly<'_>, id: NodeId) -> Result<(), Diagnostic> {
    let blocks = assembly.blocks;
    match &blocks[id.0 as usize] {
        Block::Reference | Block::Ground | Block::Drive | Block::Alias { .. } => Ok(()),
        Block::Share(branch) => {
            linear::add_share(assembly, id, branch);
            Ok(())
        }
        Block::Amplifier { branches, feedback } => {
            let design = assembly.design;
            match design.input.operation(id) {
                Operation::Quotient { divisor, .. } => {
                    feedback::add_quotient(assembly, id, *divisor, branches, *feedback)
                }
                Operation::Root(_) => {
                    feedback::add_root(assembly, id, branches, *feedback);
                    Ok(())
                }
                Operation::Zero(_) => {
                    feedback::add_zero(assembly, id, branches);
                    Ok(())
                }
                _ => linear::add_amplifier(assembly, id, branches),
            }
        }
        Block::Element => add_element(assembly, id),
    }
}

/// Adds an element without gains.
fn add_element(assembly: &mut Assembly<'_>, id: NodeId) -> Result<(), Diagnostic> {
    let design = assembly.design;
    match design.input.operation(id) {
        Operation::Product(factors) => networks::add_product(assembly, id, *factors),
        Operation::Absolute(input) => networks::add_absolute(assembly, id, *input),
        Operation::Lower(terms) => networks::add_selector(assembly, id, terms, -1),
        Operation::Higher(terms) => networks::add_selector(assembly, id, terms, 1),
        Operation::DeadZone { input, width } => networks::add_dead_zone(assembly, id, *input, width),
        Operation::Switch { input, at_least_0, below_0 } => {
            return networks::add_switch(assembly, id, *input, [at_least_0, below_0]);
        }
        Operation::Delay { input, time, initial } => {
            return networks::add_delay(assembly, id, *input, time, initial);
        }
        Operation::Function { kind, argument } => {
            return functions::add_function(assembly, id, *kind, argument);
        }
        Operation::Curve { table, input } => return functions::add_curve(assembly, id, table, input),
        // These have other circuits; see `Design::block`.
        Operation::One
        | Operation::Drive(_)
        | Operation::Integral { .. }
        | Operation::Sum(_)
        | Operation::Limited { .. }
        | Operation::Quotient { .. }
        | Operation::Root(_)
        | Operation::Zero(_) => {}
    }
    Ok(())
}

/// How to give a node a scale in which a constant is at most 100 V.
fn larger_scale(design: &Design<'_>, id: NodeId, constant: &Fraction) -> String {
    let (name, unit) = (&design.input.plan.node(id).name, design.input.unit(id));
    let size = unit.out_of_si(design.table.expressions.value(constant).abs());
    let (key, least) = match design.input.prescribed_scale(id) {
        Some(_) => ("per_volt", size / REFERENCE),
        None => ("maximum", size),
    };
    let rounded = round_significant(least, ADVISED_DIGITS);
    let rounded = if rounded < least * (1.0 - NUMBER_TOLERANCE) {
        round_significant(least * ROUNDED_UP, ADVISED_DIGITS)
    } else {
        rounded
    };
    format!("give {name} a \"{key}\" of at least {}{}", format_number(rounded), unit_suffix(unit.text()))
}

/// A constant as a voltage at the output of a node with this polarity: its setting and its value.
///
/// A number in a unit other than 1 cannot be in a formula, so it is converted to volts.
///
/// # Errors
/// If the voltage is above 100 V. `noun` describes it.
fn volts(
    design: &Design<'_>,
    id: NodeId,
    constant: &Fraction,
    polarity: i8,
    noun: &str,
) -> Result<(Value, f64), Diagnostic> {
    let volts = f64::from(polarity) * design.table.expressions.value(constant) / design.table.value(id);
    // This is false for NaN too.
    let is_possible = volts.abs() <= REFERENCE * (1.0 + ROUNDING);
    if !is_possible {
        let name = &design.input.plan.node(id).name;
        let message = format!("{noun} of {name} is {} V with this scale", format_number(volts));
        let hint = format!("amplifiers have ±100 V: {}", larger_scale(design, id, constant));
        return Err(design.input.fault(id, message, &hint));
    }
    let is_number = constant.as_rational().is_some();
    let has_unit = !design.input.dimension(id).is_dimensionless() || design.input.unit(id).factor() != 1.0;
    if constant.is_zero() || (is_number && has_unit) {
        return Ok((json_number(volts), volts));
    }
    let product = signed_constant(design, constant, polarity);
    let product = product.over(design.table.expression(id), &design.table.expressions);
    Ok((product.setting(volts), volts))
}

/// A constant times a polarity. A number is a decimal: `0.1 / x` and not `1 / x / 10`.
fn signed_constant(design: &Design<'_>, constant: &Fraction, polarity: i8) -> SettingFormula {
    let product = SettingFormula::one().times_number(f64::from(polarity));
    let Some(number) = constant.as_rational() else {
        return product.times(constant, &design.table.expressions);
    };
    let number = nearest(&number);
    let product = product.times_number(1f64.copysign(number));
    product.times_text(&format_significant(number.abs(), EXACT_DIGITS))
}
