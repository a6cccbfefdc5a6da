//! Multipliers, diode networks, comparators and delay lines.

use patchcord_core::document::Diagnostic;
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::ElementBuilder;
use serde_json::{Value, json};

use super::super::assembly::Assembly;
use super::super::design::Design;
use super::super::formula::{SettingFormula, json_number};
use super::super::gains::Route;
use super::super::notes::{signed, term_text};
use super::volts;
use crate::graph::{NodeId, Operation, Term};
use crate::symbolic::Fraction;

/// The delays that a delay line can have, in machine seconds.
const DELAYS: (f64, f64) = (1e-9, 1e6);

/// Adds a multiplier.
pub(super) fn add_product(assembly: &mut Assembly<'_>, id: NodeId, [first, second]: [NodeId; 2]) {
    let polarity = assembly.polarity(id);
    let of_first = assembly.polarities.first_factors[id.0 as usize];
    let a = assembly.voltage(first, of_first);
    let b = assembly.voltage(second, polarity * of_first);
    let product = ElementBuilder::new("multiplier").set("mode", "product").cord("a", &a).cord("b", &b);
    assembly.add_output(id, product);
}

/// Adds an absolute value: the higher of a voltage and its negative, or the negative absolute value.
pub(super) fn add_absolute(assembly: &mut Assembly<'_>, id: NodeId, input: NodeId) {
    let inputs = [1, -1].map(|polarity| assembly.voltage(input, polarity));
    let diodes = diode_pair(assembly.polarity(id), &inputs);
    assembly.add_output(id, diodes);
}

/// Adds a diode pair for the higher (`side` 1) or the lower (-1) of two terms. The smaller one has a pot.
pub(super) fn add_selector(assembly: &mut Assembly<'_>, id: NodeId, terms: &[Term; 2], side: i8) {
    let design = assembly.design;
    let polarity = assembly.polarity(id);
    let heavier = design.table.heavier(terms);
    let inputs = [0, 1].map(|index| {
        let term = &terms[index];
        let source = assembly.voltage(term.node, polarity);
        let (setting, value) = share(design, term, id);
        let is_whole = index == heavier || value == 1.0;
        let note = signed(&term_text(design, &term.coefficient, term.node), polarity);
        if is_whole { source } else { assembly.pot(&source, &setting, &note) }
    });
    let diodes = diode_pair(side * polarity, &inputs);
    assembly.add_output(id, diodes);
}

/// The pot that gives a term the scale of a node: its setting and its value.
fn share(design: &Design<'_>, term: &Term, id: NodeId) -> (Value, f64) {
    let expressions = &design.table.expressions;
    let value = design.table.weight(term) / design.table.value(id);
    let product = SettingFormula::one().times(&term.coefficient, expressions);
    let product = product.times(design.table.expression(term.node), expressions);
    let product = Route::POT.setting(product.over(design.table.expression(id), expressions));
    (product.setting(value), value)
}

/// A diode pair for the higher (`side` 1) or the lower (-1) of two voltages.
fn diode_pair(side: i8, inputs: &[String; 2]) -> ElementBuilder {
    let kind = if side > 0 { "diode-upper-of" } else { "diode-lower-of" };
    ElementBuilder::new(kind).set("in", json!(inputs))
}

/// Adds a dead zone: free pots between the input and the width, and diodes.
pub(super) fn add_dead_zone(assembly: &mut Assembly<'_>, id: NodeId, input: NodeId, width: &Term) {
    let design = assembly.design;
    let signal = assembly.voltage(input, assembly.polarity(id));
    let [plus, minus] = [1, -1].map(|polarity| assembly.voltage(width.node, polarity));
    let zone = ElementBuilder::new("diode-dead-zone").cord("in", &signal);
    let zone = zone.cord("bias_plus", &plus).cord("bias_minus", &minus);
    let zone = zone.set("setting", zone_setting(design, input, width));
    assembly.add_output(id, zone);
}

/// The setting W / (W + S) of the free pots, with the scale S of the input and the scale W of the width.
fn zone_setting(design: &Design<'_>, input: NodeId, width: &Term) -> Value {
    let expressions = &design.table.expressions;
    // With the reference as width, W is the width at 100 V over 100.
    let is_reference = *design.input.operation(width.node) == Operation::One;
    let factor = if is_reference { REFERENCE } else { 1.0 };
    let of_width = SettingFormula::one().times_number(factor).times(&width.coefficient, expressions);
    let of_width = of_width.times(design.table.expression(width.node), expressions).factor_text();
    let of_input =
        SettingFormula::one().times_number(factor).times(design.table.expression(input), expressions);
    let (weight, scale) = (design.table.weight(width), design.table.value(input));
    match (of_width, of_input.factor_text()) {
        (Some(width), Some(input)) if weight > 0.0 => format!("{width} / ({width} + {input})").into(),
        _ => json_number(weight / (weight + scale)),
    }
}

/// Adds a comparator. An inverted input is compared from the other side, so that 0 has the same value.
///
/// # Errors
/// If a value is above 100 V.
pub(super) fn add_switch(
    assembly: &mut Assembly<'_>,
    id: NodeId,
    input: NodeId,
    values: [&Fraction; 2],
) -> Result<(), Diagnostic> {
    let (design, polarity) = (assembly.design, assembly.polarity(id));
    let (source, sign) = assembly.any_voltage(input);
    let comparator = ElementBuilder::new("comparator");
    let comparator = if sign > 0 {
        comparator.cord("in", &source)
    } else {
        comparator.cord("in", "ground").cord("against", &source)
    };
    let (high, _) = volts(design, id, values[0], polarity, "a value")?;
    let (low, _) = volts(design, id, values[1], polarity, "a value")?;
    assembly.add_output(id, comparator.set("high", high).set("low", low));
    Ok(())
}

/// Adds a delay line.
///
/// # Errors
/// If the initial value is above 100 V, or no delay line has the delay.
pub(super) fn add_delay(
    assembly: &mut Assembly<'_>,
    id: NodeId,
    input: NodeId,
    time: &Fraction,
    initial: &Fraction,
) -> Result<(), Diagnostic> {
    let (design, polarity) = (assembly.design, assembly.polarity(id));
    let delay = design.table.expressions.value(time) * design.time_scale;
    if !(DELAYS.0..=DELAYS.1).contains(&delay) {
        let name = &design.input.plan.node(id).name;
        let message = format!("the delay in {name} is {delay} machine s");
        let hint =
            format!("a delay is from {} to {} machine s: choose another time scale", DELAYS.0, DELAYS.1);
        return Err(design.input.fault(id, message, &hint));
    }
    let source = assembly.voltage(input, polarity);
    let line =
        ElementBuilder::new("delay").cord("in", &source).set("delay", delay_setting(design, time, delay));
    let line = if initial.is_zero() {
        line
    } else {
        let (setting, _) = volts(design, id, initial, polarity, "the initial value")?;
        line.set("initial", setting)
    };
    assembly.add_output(id, line);
    Ok(())
}

/// The setting of a delay line in machine seconds. A number has no unit, so no formula can express it.
fn delay_setting(design: &Design<'_>, time: &Fraction, delay: f64) -> Value {
    if time.as_rational().is_some() {
        return json_number(delay);
    }
    let product = SettingFormula::one().times(time, &design.table.expressions);
    product.times_time_scale(i32::from(design.time_scale != 1.0)).setting(delay)
}
