//! What the circuits of others decide: Nakashima's, point by point beside the final circuit, and Singh's (2.5, 8.3).

use super::super::finding::Finding;
use super::super::given::Given;
use super::super::recipe::Recipe;
use super::{Check, CheckError};
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::MM_PER_S;
use patchcord_core::circuit::{Circuit, Element};
use patchcord_core::ir::Program;
use patchcord_core::machines::Part;
use patchcord_core::patch::Amount;
use patchcord_expr::{Dimension, Unit};

pub(super) const CHECKS: &[Check] = &[
    Check { name: "relays-of-others", run: relays_of_others },
    Check { name: "several-multipliers", run: several_multipliers },
    Check { name: "twice-as-many-amplifiers", run: twice_as_many_amplifiers },
    Check { name: "several-inputs", run: several_inputs },
    Check { name: "stands-under-a-negative-command", run: stands_under_a_negative_command },
    Check { name: "has-no-drive", run: has_no_drive },
    Check { name: "has-no-position", run: has_no_position },
    Check { name: "reads-a-coefficient", run: reads_a_coefficient },
    Check { name: "no-oscillation-lasts", run: no_oscillation_lasts },
];

fn circuit(name: &'static str) -> Result<Circuit, CheckError> {
    Ok(Recipe::of(name).circuit(name, "")?)
}

fn count(circuit: &Circuit, part: Part) -> usize {
    circuit.parts().iter().find(|(taken, _)| *taken == part).map_or(0, |(_, count)| *count)
}

/// How many relays Nakashima's circuit takes.
fn relays_of_others(_: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(count(&circuit("nakashima")?, Part::Relay) as f64))
}

/// Whether Nakashima's circuit takes several multipliers where the final one takes one.
fn several_multipliers(_: &Given) -> Result<Finding, CheckError> {
    let (other, own) =
        (count(&circuit("nakashima")?, Part::Multiplier), count(&circuit("fig-8-16")?, Part::Multiplier));
    Ok(Finding::truth(other > 1 && own == 1, format!("{other} against {own}")))
}

/// Whether Nakashima's circuit takes at least twice as many summing and integrating amplifiers as the final one.
fn twice_as_many_amplifiers(_: &Given) -> Result<Finding, CheckError> {
    let amplifiers = |circuit: &Circuit| count(circuit, Part::Summer) + count(circuit, Part::Integrator);
    let (other, own) = (amplifiers(&circuit("nakashima")?), amplifiers(&circuit("fig-8-16")?));
    Ok(Finding::truth(other >= 2 * own, format!("{other} against {own}")))
}

/// Whether Nakashima's circuit takes the output velocity in at several places, and the viscous coefficient too.
fn several_inputs(_: &Given) -> Result<Finding, CheckError> {
    let circuit = circuit("nakashima")?;
    let elements = circuit.elements();
    let is_velocity = |name: &str| ["B3", "B4"].contains(&name);
    let reads =
        |index: usize| circuit.cords(index).iter().any(|(from, _)| is_velocity(&circuit.element(*from).name));
    let velocity =
        (0..elements.len()).filter(|index| !is_velocity(&elements[*index].name) && reads(*index)).count();
    let is_set = |element: &Element| {
        let mut formulas = element.settings.iter().flatten().filter_map(|setting| match &setting.value {
            Amount::Formula(formula) => Some(formula),
            _ => None,
        });
        formulas.any(|formula| formula.names().contains(&"f"))
    };
    let damping = elements.iter().filter(|element| is_set(element)).count();
    let found = format!("velocity at {velocity} elements, f at {damping}");
    Ok(Finding::truth(velocity > 1 && damping > 1, found))
}

/// Whether Nakashima's table never moves where the set velocity is negative, and does where it is positive.
fn stands_under_a_negative_command(_: &Given) -> Result<Finding, CheckError> {
    let furthest = |reference: &str| -> Result<f64, CheckError> {
        let run = Recipe::of("nakashima").edit("elements/PV/in", reference).recording(&["v_o"]);
        let velocity = run.run("direction", "")?.values("v_o")?;
        Ok(velocity.into_iter().fold(0.0_f64, |most, velocity| most.max(velocity.abs())) / MM_PER_S)
    };
    let (forward, backward) = (furthest("+100")?, furthest("-100")?);
    let found = format!("{backward:.1e} mm/s at most, where it reaches {forward:.1} mm/s forward");
    Ok(Finding::truth(backward < 1e-6 && forward > 1.0, found))
}

/// Whether nothing comes into Nakashima's circuit from outside, such as a ramp.
fn has_no_drive(_: &Given) -> Result<Finding, CheckError> {
    let drives = circuit("nakashima")?.patch().drives.len();
    Ok(Finding::truth(drives == 0, format!("{drives} drives; the set velocity is a pot")))
}

/// The units of a circuit's signals.
fn units(name: &'static str) -> Result<Vec<Unit>, CheckError> {
    let program = Program::new(&circuit(name)?).map_err(|report| CheckError::Run(report.to_string()))?;
    let unit = |text: &str| Unit::parse(text).map_err(|error| CheckError::Run(error.to_string()));
    program.signals().iter().map(|signal| unit(&signal.unit)).collect()
}

/// Whether no signal of Nakashima's circuit is a length, where the final circuit has one.
fn has_no_position(_: &Given) -> Result<Finding, CheckError> {
    let lengths = |name| -> Result<usize, CheckError> {
        Ok(units(name)?.iter().filter(|unit| unit.dimension() == Dimension::LENGTH).count())
    };
    let (other, own) = (lengths("nakashima")?, lengths("fig-8-16")?);
    Ok(Finding::truth(other == 0 && own > 0, format!("{other} signals in metres against {own}")))
}

/// Whether the first picture of Nakashima's circuit is of the total coefficient of friction.
fn reads_a_coefficient(_: &Given) -> Result<Finding, CheckError> {
    let circuit = circuit("nakashima")?;
    let shown = circuit.patch().pictures.first().and_then(|picture| picture.y.first());
    let shown = shown.map(|name| name.value.clone()).unwrap_or_default();
    Ok(Finding::truth(shown == "mu", format!("its first picture is of {shown}")))
}

/// Whether no oscillation of Singh's circuit keeps its size: below n = f all die away, above all grow.
fn no_oscillation_lasts(given: &Given) -> Result<Finding, CheckError> {
    let mut told = Vec::new();
    let mut lasts = false;
    for share in given.numbers("shares")? {
        let recipe =
            Recipe::of("singh").set("n", share * SIMULATED_DAMPING).lasting(0.6).recording(&["v_i", "v_o"]);
        let run = recipe.run("singh", "")?;
        let swing: Vec<f64> = run
            .points(("v_i", MM_PER_S), ("v_o", MM_PER_S))?
            .iter()
            .map(|(v_i, v_o)| (v_o - v_i).abs())
            .collect();
        let most = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
        let change = most(&swing[2 * swing.len() / 3..]) / most(&swing[..swing.len() / 3]);
        let dies_or_grows = if share < 1.0 { change < 0.95 } else { change > 1.05 };
        lasts |= !dies_or_grows;
        told.push(format!("x {change:.2} at n = {share} f"));
    }
    Ok(Finding::truth(!lasts, format!("swings in the last third: {}", told.join(", "))))
}
