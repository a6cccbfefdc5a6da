//! Function generators: sine, cosine, exponential, logarithm and curves of points.

use std::f64::consts::LN_10;

use patchcord_core::document::Diagnostic;
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::ElementBuilder;
use patchcord_expr::{format_significant, round_significant};
use serde_json::{Value, json};

use super::super::assembly::Assembly;
use super::super::design::Design;
use super::super::formula::{SettingFormula, json_number};
use super::super::notes::{signed, term_text};
use crate::graph::{FunctionKind, NodeId, Operation, Term};
use crate::peaks::points_in_si;
use crate::symbolic::Fraction;

/// The output of `exp` and `log` per decade, in volts.
const PER_DECADE: (f64, f64) = (1.0, 100.0);
/// The voltages `reference` and `least` of `exp` and `log`.
const LEVELS: (f64, f64) = (1e-6, 100.0);
/// The voltage `least` of `log` if the patch does not give it.
const USUAL_LEAST: f64 = 1e-3;
/// Gains in front of `exp` above 1. The first one that makes the output per decade at least 1 V is used.
const GAINS: [f64; 3] = [2.0, 5.0, 10.0];
/// The gain of the input of the summer in front of `exp`.
const GAIN_OF_SUMMER: f64 = 10.0;
/// The limit of the summer in front of `exp`. At a limit of -95 V the exponential is below 1e-38 of its reference.
const LIMIT: f64 = 95.0;
/// Digits of a factor in a note.
const FACTOR_DIGITS: usize = 4;
/// Digits of the points of a curve in volts. The rest is rounding.
const DIGITS: usize = 12;
/// The smallest distance between the inputs of two points of a curve, in volts.
const LEAST_DISTANCE: f64 = 2e-6;

/// Adds a function generator.
///
/// # Errors
/// If a setting would be outside the range of the element.
pub(super) fn add_function(
    assembly: &mut Assembly<'_>,
    id: NodeId,
    kind: FunctionKind,
    argument: &Term,
) -> Result<(), Diagnostic> {
    match kind {
        FunctionKind::Sin => add_wave(assembly, id, "sin", argument),
        FunctionKind::Cos => add_wave(assembly, id, "cos", argument),
        FunctionKind::Exp => add_exponential(assembly, id, argument),
        FunctionKind::Ln => add_logarithm(assembly, id, argument),
    }
}

/// Adds a sine or a cosine. The sign of its amplitude takes care of all polarities.
fn add_wave(assembly: &mut Assembly<'_>, id: NodeId, kind: &str, argument: &Term) -> Result<(), Diagnostic> {
    let design = assembly.design;
    let expressions = &design.table.expressions;
    let (input, polarity) = assembly.any_voltage(argument.node);
    // The sine is odd, and the cosine is even.
    let sign_of_input = if kind == "sin" { polarity * expressions.sign(&argument.coefficient) } else { 1 };
    let sign = sign_of_input * assembly.polarity(id);
    let (amplitude, volts) = reciprocal(design, id, sign);
    check(design, id, ("the amplitude", volts.abs()), (0.0, REFERENCE))?;
    let angle = SettingFormula::one().times(&design.table.size_of(argument), expressions);
    let angle = angle.setting(design.table.weight(argument));
    let wave = ElementBuilder::new(kind).cord("in", &input).set("amplitude", amplitude);
    assembly.add_output(id, wave.set("angle_per_volt", angle));
    Ok(())
}

/// The reciprocal of the scale of a node with a sign, as a voltage: its setting and its value.
fn reciprocal(design: &Design<'_>, id: NodeId, sign: i8) -> (Value, f64) {
    let volts = f64::from(sign) / design.table.value(id);
    let product = SettingFormula::one().times_number(f64::from(sign));
    (product.over(design.table.expression(id), &design.table.expressions).setting(volts), volts)
}

/// The factor between the voltage of an argument and the input of `exp` or `log`, which brings a setting of the element
/// into its range: below 1 it is a pot, above 1 a summer.
///
/// # Errors
/// If no factor does.
pub(in crate::synthesis) fn argument_gain(design: &Design<'_>, id: NodeId) -> Result<f64, Diagnostic> {
    let Operation::Function { kind, argument } = design.input.operation(id) else { return Ok(1.0) };
    // The value of the argument per volt.
    let per_volt = design.table.weight(argument);
    let (setting, range, may_amplify) = match kind {
        FunctionKind::Exp => (LN_10 / per_volt, PER_DECADE, true),
        FunctionKind::Ln => (1.0 / per_volt, LEVELS, false),
        FunctionKind::Sin | FunctionKind::Cos => return Ok(1.0),
    };
    if setting > range.1 && setting.is_finite() {
        return Ok(10f64.powi(-((setting / range.1).log10().ceil() as i32)));
    }
    let gain = [1.0].into_iter().chain(GAINS).find(|gain| gain * setting >= range.0);
    match gain {
        Some(gain) if setting.is_finite() && (gain == 1.0 || may_amplify) => Ok(gain),
        _ => {
            let name = &design.input.plan.node(id).name;
            let at_100_volts = format_significant(per_volt * REFERENCE, 3);
            let message =
                format!("the argument of {name} does not fit a function generator: 100 V are {at_100_volts}");
            let hint = "write the function with another argument: exp(a + b) is exp(a) exp(b)";
            Err(design.input.fault(id, message, hint))
        }
    }
}

/// The input of `exp` or `log`: the argument, a share of it, or a multiple of it that is limited to ±95 V. It is positive
/// for a positive argument.
fn conditioned(assembly: &mut Assembly<'_>, argument: &Term, gain: f64) -> String {
    let design = assembly.design;
    let sign = design.table.expressions.sign(&argument.coefficient);
    let text = term_text(design, &Fraction::whole(1), argument.node);
    let pot_note = |factor: f64, sign: i8| {
        let factor = format_significant(factor, FACTOR_DIGITS);
        format!("{factor} times {}, in front of a function", signed(&text, sign))
    };
    if gain <= 1.0 {
        let source = assembly.voltage(argument.node, sign);
        let note = pot_note(gain, sign);
        return if gain < 1.0 { assembly.pot(&source, &json_number(gain), &note) } else { source };
    }
    let source = assembly.voltage(argument.node, -sign);
    let share = gain / GAIN_OF_SUMMER;
    let note = pot_note(share, -sign);
    let from = if share < 1.0 { assembly.pot(&source, &json_number(share), &note) } else { source };
    let name = assembly.next_name('B');
    let limit = json!({"lower": json_number(-LIMIT), "upper": json_number(LIMIT)});
    let note = format!("{gain} times {}, within ±{LIMIT} V", signed(&text, sign));
    let summer = ElementBuilder::new("summer").cords("x10", [from]).set("limit", limit).note(&note);
    assembly.add(name.clone(), summer);
    name
}

/// Adds an exponential.
fn add_exponential(assembly: &mut Assembly<'_>, id: NodeId, argument: &Term) -> Result<(), Diagnostic> {
    let design = assembly.design;
    let gain = argument_gain(design, id)?;
    let per_decade = gain * LN_10 / design.table.weight(argument);
    let offset = design.input.exponent_offset(id);
    let (reference, volts) = level_at(design, id, offset);
    check(design, id, (&format!("the voltage at the argument {offset}"), volts), LEVELS)?;
    let product = SettingFormula::one().times_text("ln(10)").times_number(gain);
    let product = product.over(&design.table.size_of(argument), &design.table.expressions);
    let input = conditioned(assembly, argument, gain);
    let element = ElementBuilder::new("exp").cord("in", &input).set("reference", reference);
    assembly.add_output(id, element.set("per_decade", product.setting(per_decade)));
    Ok(())
}

/// The voltage of an exponential at the offset of its exponent, where its input is 0: its setting and its value.
fn level_at(design: &Design<'_>, id: NodeId, offset: i32) -> (Value, f64) {
    let volts = f64::from(offset).exp() / design.table.value(id);
    let product = SettingFormula::one();
    let product = if offset == 0 { product } else { product.times_text(&format!("exp({offset})")) };
    (product.over(design.table.expression(id), &design.table.expressions).setting(volts), volts)
}

/// Adds a logarithm.
fn add_logarithm(assembly: &mut Assembly<'_>, id: NodeId, argument: &Term) -> Result<(), Diagnostic> {
    let design = assembly.design;
    let expressions = &design.table.expressions;
    let name = &design.input.plan.node(id).name;
    let least_volts = least_argument(design, argument) / design.table.weight(argument);
    if least_volts.is_nan() || least_volts <= 0.0 {
        let message = format!("the argument of the logarithm in {name} is not positive during the whole run");
        let hint = "write the equation without this logarithm, or change the initial values";
        return Err(design.input.fault(id, message, hint));
    }
    let gain = argument_gain(design, id)?;
    let least_volts = least_volts * gain;
    check(design, id, ("the smallest voltage of the argument", least_volts), (LEVELS.0, f64::INFINITY))?;
    let volts = LN_10 / design.table.value(id);
    check(design, id, ("the output per decade", volts), PER_DECADE)?;
    let per_decade =
        SettingFormula::one().times_text("ln(10)").over(design.table.expression(id), expressions);
    let level = gain / design.table.weight(argument);
    let reference =
        SettingFormula::one().times_number(gain).over(&design.table.size_of(argument), expressions);
    let input = conditioned(assembly, argument, gain);
    let element = ElementBuilder::new("log").cord("in", &input).set("reference", reference.setting(level));
    let element = element.set("per_decade", per_decade.setting(volts));
    let is_usual = least_volts >= USUAL_LEAST;
    let element = if is_usual { element } else { element.set("least", json_number(LEVELS.0)) };
    assembly.add_output(id, element);
    Ok(())
}

/// The smallest value of an argument during the run.
fn least_argument(design: &Design<'_>, argument: &Term) -> f64 {
    let coefficient = design.table.expressions.value(&argument.coefficient);
    let ends = design.input.ranges[argument.node.0 as usize].map(|end| coefficient * end);
    ends[0].min(ends[1])
}

/// Checks that a setting is within the range of an element.
///
/// # Errors
/// If it is not. The noun describes the setting.
fn check(
    design: &Design<'_>,
    id: NodeId,
    (noun, volts): (&str, f64),
    (least, most): (f64, f64),
) -> Result<(), Diagnostic> {
    if (least..=most * (1.0 + f64::EPSILON)).contains(&volts) {
        return Ok(());
    }
    let name = &design.input.plan.node(id).name;
    let [volts, least, most_text] = [volts, least, most].map(|volts| format_significant(volts, 4));
    let range =
        if most.is_finite() { format!("{least} to {most_text}") } else { format!("at least {least}") };
    let message = format!("{noun} of {name} is {volts} V, and a function generator has {range} V");
    let hint = format!("give {name} another \"maximum\"");
    Err(design.input.fault(id, message, &hint))
}

/// Adds a curve of points, which are numbers: neither the coefficient of the argument nor the scale of its node depends on
/// parameters.
///
/// # Errors
/// If the problem does not have the table, or only one of its points is within ±100 V.
pub(super) fn add_curve(
    assembly: &mut Assembly<'_>,
    id: NodeId,
    table: &str,
    argument: &Term,
) -> Result<(), Diagnostic> {
    let design = assembly.design;
    let (input, polarity) = assembly.any_voltage(argument.node);
    let coefficient = design.table.expressions.value(&argument.coefficient);
    let in_per_volt = f64::from(polarity) * coefficient * design.table.value(argument.node);
    let out_per_volt = f64::from(assembly.polarity(id)) * design.table.value(id);
    let range = design.input.ranges[argument.node.0 as usize];
    let middle = f64::midpoint(range[0], range[1]) * coefficient / in_per_volt;
    let points = design.input.problem.tables.get(table).map(points_in_si).unwrap_or_default().into_iter();
    let mut points: Vec<[f64; 2]> = points.map(|[x, y]| [x / in_per_volt, y / out_per_volt]).collect();
    points.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let points = within_reference(&points, middle);
    if points.len() < 2 {
        let message = format!(
            "the table {table} has no segment within ±100 V of {table}({})",
            argument_name(design, argument)
        );
        let hint = "give the table points around the values that occur, or state larger maxima";
        return Err(design.input.fault(id, message, hint));
    }
    let points: Vec<Value> =
        points.into_iter().map(|point| json!(point.map(|volts| json_number(rounded(volts))))).collect();
    let element = ElementBuilder::new("function-generator").cord("in", &input);
    assembly.add_output(id, element.set("points", points));
    Ok(())
}

/// The name of the node of an argument.
fn argument_name<'d>(design: &'d Design<'_>, argument: &Term) -> &'d str {
    &design.input.plan.node(argument.node).name
}

/// A voltage without the rounding of its computation.
fn rounded(volts: f64) -> f64 {
    round_significant(volts, DIGITS)
}

/// The part of a curve around an input that is within ±100 V, with a new end where it leaves this range. A function
/// generator continues its outermost segments.
fn within_reference(points: &[[f64; 2]], around: f64) -> Vec<[f64; 2]> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Vec::new() };
    if !around.is_finite() || points.iter().flatten().any(|volts| !volts.is_finite()) {
        return Vec::new();
    }
    let start = around.clamp(first[0], last[0]).clamp(-REFERENCE, REFERENCE);
    let after = points.partition_point(|point| point[0] <= start).clamp(1, points.len().max(2) - 1);
    let (below, above) = points.split_at(after.min(points.len()));
    let (Some(left), Some(right)) = (below.last(), above.first()) else { return Vec::new() };
    let share = (start - left[0]) / (right[0] - left[0]);
    let inside = [start, left[1] + share * (right[1] - left[1])];
    if inside[1].abs() > REFERENCE {
        return Vec::new();
    }
    let mut kept = reachable(inside, below.iter().rev());
    kept.reverse();
    kept.extend(reachable(inside, above.iter()));
    kept.dedup_by(|next, kept| next[0] - kept[0] < LEAST_DISTANCE);
    kept
}

/// The points of a curve from a point inside ±100 V on, up to the place at which it leaves this range.
fn reachable<'p>(inside: [f64; 2], points: impl Iterator<Item = &'p [f64; 2]>) -> Vec<[f64; 2]> {
    let (mut kept, mut previous) = (Vec::new(), inside);
    for point in points {
        let shares = [0, 1].map(|axis| share_inside(previous[axis], point[axis]));
        let share = shares[0].min(shares[1]);
        if share < 1.0 {
            let end = [0, 1].map(|axis| previous[axis] + share * (point[axis] - previous[axis]));
            kept.push(end.map(|volts: f64| volts.clamp(-REFERENCE, REFERENCE)));
            break;
        }
        kept.push(*point);
        previous = *point;
    }
    kept
}

/// The share of the way from a voltage within ±100 V to another one at which the limit is reached; 1 if it is not.
fn share_inside(from: f64, to: f64) -> f64 {
    if to.abs() <= REFERENCE { 1.0 } else { (REFERENCE.copysign(to) - from) / (to - from) }
}
