//! Pots, summers, limiters and integrators.

use patchcord_core::document::Diagnostic;
use patchcord_core::patch::ElementBuilder;
use serde_json::{Map, Value};

use super::super::assembly::Assembly;
use super::super::design::Branch;
use super::super::needs::summer_sign;
use super::super::notes::{GainStep, pot_note, signed, term_text};
use super::volts;
use crate::graph::{NodeId, Operation};
use crate::symbolic::Fraction;

/// Adds the pot of a sum with one term.
pub(super) fn add_share(assembly: &mut Assembly<'_>, id: NodeId, branch: &Branch) {
    let design = assembly.design;
    let source = assembly.voltage(branch.node, branch.sign * assembly.polarity(id));
    let pot = ElementBuilder::new("pot").cord("in", &source).set("setting", branch.setting.clone());
    let step = GainStep::new(design, assembly.output(id), id, branch, None);
    assembly.steps.push(step);
    assembly.add_output(id, pot);
}

/// Adds a summer, a summer with limits, or an integrator.
///
/// # Errors
/// If an initial value or a limit is above 100 V.
pub(super) fn add_amplifier(
    assembly: &mut Assembly<'_>,
    id: NodeId,
    branches: &[Branch],
) -> Result<(), Diagnostic> {
    let design = assembly.design;
    let polarity = assembly.polarity(id);
    let cords = cords(assembly, branches, &|branch| -branch.sign * polarity);
    let element = match design.input.operation(id) {
        Operation::Integral { initial, .. } => {
            let element = amplifier("integrator", cords);
            if initial.is_zero() {
                element
            } else {
                let (setting, _) = volts(design, id, initial, polarity, "the initial value")?;
                element.set("initial", setting)
            }
        }
        Operation::Limited { lower, upper, .. } => {
            let limits = limits(assembly, id, [lower.as_ref(), upper.as_ref()])?;
            amplifier("summer", cords).set("limit", limits)
        }
        _ => amplifier("summer", cords),
    };
    let is_integral = matches!(design.input.operation(id), Operation::Integral { .. });
    for branch in branches {
        let time_scale = is_integral.then_some(design.time_scale);
        assembly.steps.push(GainStep::new(design, assembly.output(id), id, branch, time_scale));
    }
    assembly.add_output(id, element);
    Ok(())
}

/// The settings of a limiter for the lower and the upper bound of a node. A negative output exchanges them.
fn limits(
    assembly: &Assembly<'_>,
    id: NodeId,
    [lower, upper]: [Option<&Fraction>; 2],
) -> Result<Value, Diagnostic> {
    let (design, polarity) = (assembly.design, assembly.polarity(id));
    let bounds = if polarity > 0 { [lower, upper] } else { [upper, lower] };
    let mut limits = Map::new();
    for (key, bound) in ["lower", "upper"].into_iter().zip(bounds) {
        if let Some(bound) = bound {
            let (setting, _) = volts(design, id, bound, polarity, "a bound")?;
            limits.insert(key.to_owned(), setting);
        }
    }
    Ok(Value::Object(limits))
}

/// The cords into an amplifier: the gain of each, and the output from which it comes. `polarity` gives the polarity that
/// each input needs.
pub(super) fn cords(
    assembly: &mut Assembly<'_>,
    branches: &[Branch],
    polarity: &dyn Fn(&Branch) -> i8,
) -> Vec<(f64, String)> {
    let mut cords = Vec::new();
    for branch in branches {
        let from = cord(assembly, branch, polarity(branch));
        cords.extend((0..branch.route.cords).map(|_| (branch.route.gain, from.clone())));
    }
    cords
}

/// The output from which the cords of an input come: a node, its pot, or the summer after the pot.
fn cord(assembly: &mut Assembly<'_>, branch: &Branch, polarity: i8) -> String {
    let design = assembly.design;
    let before_summer = polarity * summer_sign(branch);
    let source = assembly.voltage(branch.node, before_summer);
    let from = if branch.route.has_pot {
        let note = pot_note(design, branch, before_summer);
        assembly.pot(&source, &branch.setting, &note)
    } else {
        source
    };
    if branch.route.summers == 0 {
        return from;
    }
    let name = assembly.next_name('B');
    let note = signed(&term_text(design, &branch.coefficient, branch.node), polarity);
    assembly.add(name.clone(), ElementBuilder::new("summer").cords("x10", [from]).note(&note));
    name
}

/// An amplifier with these cords, in the order of their gains. Without cords it gets 0 V.
pub(super) fn amplifier(kind: &str, mut cords: Vec<(f64, String)>) -> ElementBuilder {
    if cords.is_empty() {
        cords.push((1.0, "ground".to_owned()));
    }
    cords.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    let element = ElementBuilder::new(kind);
    cords.into_iter().fold(element, |element, (gain, from)| element.cords(&format!("x{gain}"), [from]))
}
