//! Claims on the circuits of other authors: Nakashima's compared with the final circuit, and Singh's (2.5, 8.3).
//!
//! The drawings of these circuits are lost. The patches `nakashima` and `singh` wire what the text says about them, so
//! counts of parts are those of our wiring. Claims 8-160.a ... h are the points a ... h of 8.3.

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::recipe::Recipe;
use super::{Check, CheckError};
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::MM_PER_S;
use patchcord_core::circuit::{Circuit, Element};
use patchcord_core::ir::Program;
use patchcord_core::machines::Part;
use patchcord_core::patch::Amount;
use patchcord_expr::{Dimension, Unit};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "relays-of-others", run: relays_of_others },
    Check { name: "several-multipliers", run: several_multipliers },
    Check { name: "twice-as-many-amplifiers", run: twice_as_many_amplifiers },
    Check { name: "several-inputs", run: several_inputs },
    Check { name: "rests-under-a-negative-command", run: rests_under_a_negative_command },
    Check { name: "has-no-drive", run: has_no_drive },
    Check { name: "has-no-position", run: has_no_position },
    Check { name: "reads-a-coefficient", run: reads_a_coefficient },
    Check { name: "no-oscillation-lasts", run: no_oscillation_lasts },
];

/// The circuit of a shipped patch.
fn circuit(name: &'static str) -> Result<Circuit, CheckError> {
    Ok(Recipe::new(name).circuit(name, "")?)
}

/// The number of parts of a kind that a circuit uses. A part is an item of the machine, such as a summer.
fn count(circuit: &Circuit, part: Part) -> usize {
    circuit.parts().iter().find(|(taken, _)| *taken == part).map_or(0, |(_, count)| *count)
}

/// The number of relays in Nakashima's circuit.
fn relays_of_others(_: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(count(&circuit("nakashima")?, Part::Relay) as f64))
}

/// Checks whether Nakashima's circuit uses several multipliers and the final circuit one.
///
/// Claim 8-160.b.
fn several_multipliers(_: &CheckArguments) -> Result<Finding, CheckError> {
    let (other, own) =
        (count(&circuit("nakashima")?, Part::Multiplier), count(&circuit("fig-8-16")?, Part::Multiplier));
    Ok(Finding::truth(other > 1 && own == 1, format!("{other} compared with {own}")))
}

/// Checks whether Nakashima's circuit uses at least twice as many summing and integrating amplifiers as the final
/// circuit.
///
/// Amplifiers inside multipliers, relays and function generators do not count. Claim 8-160.a.
fn twice_as_many_amplifiers(_: &CheckArguments) -> Result<Finding, CheckError> {
    let amplifiers = |circuit: &Circuit| count(circuit, Part::Summer) + count(circuit, Part::Integrator);
    let (other, own) = (amplifiers(&circuit("nakashima")?), amplifiers(&circuit("fig-8-16")?));
    Ok(Finding::truth(other >= 2 * own, format!("{other} compared with {own}")))
}

/// Checks whether the output velocity and the viscous coefficient each enter Nakashima's circuit at several places.
///
/// The signals B3 and B4 carry the velocity. An element counts if one of its cords comes from them, or if one of its
/// settings names f. Claim 8-160.d.
fn several_inputs(_: &CheckArguments) -> Result<Finding, CheckError> {
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

/// Checks whether Nakashima's table never moves if the set velocity is negative, and moves if it is positive.
///
/// The pot PV sets the velocity from +100 V or -100 V. Claim 8-160.c.
fn rests_under_a_negative_command(_: &CheckArguments) -> Result<Finding, CheckError> {
    let fastest = |reference: &str| -> Result<f64, CheckError> {
        let run = Recipe::new("nakashima").edit("elements/PV/in", reference).record(&["v_o"]);
        let velocity = run.run("direction", "")?.record.values("v_o")?;
        Ok(velocity.into_iter().fold(0.0_f64, |most, velocity| most.max(velocity.abs())) / MM_PER_S)
    };
    let (forward, backward) = (fastest("+100")?, fastest("-100")?);
    let found = format!("at most {backward:.1e} mm/s backward, and {forward:.1} mm/s forward");
    Ok(Finding::truth(backward < 1e-6 && forward > 1.0, found))
}

/// Checks whether Nakashima's circuit has no drive, such as a ramp.
fn has_no_drive(_: &CheckArguments) -> Result<Finding, CheckError> {
    let drives = circuit("nakashima")?.patch().drives.len();
    Ok(Finding::truth(drives == 0, format!("{drives} drives; the set velocity is a pot")))
}

/// The units of the signals of a circuit. Signals are those of the compiled program, in its order.
fn units(name: &'static str) -> Result<Vec<Unit>, CheckError> {
    let program = Program::new(&circuit(name)?).map_err(|report| CheckError::Run(report.to_string()))?;
    let unit = |text: &str| Unit::parse(text).map_err(|error| CheckError::Run(error.to_string()));
    program.signals().iter().map(|signal| unit(&signal.unit)).collect()
}

/// Checks whether no signal of Nakashima's circuit is a length, while the final circuit has one.
fn has_no_position(_: &CheckArguments) -> Result<Finding, CheckError> {
    let lengths = |name| -> Result<usize, CheckError> {
        Ok(units(name)?.iter().filter(|unit| unit.dimension() == Dimension::LENGTH).count())
    };
    let (other, own) = (lengths("nakashima")?, lengths("fig-8-16")?);
    Ok(Finding::truth(other == 0 && own > 0, format!("{other} signals in metres, compared with {own}")))
}

/// Checks whether the first picture of Nakashima's circuit shows the total coefficient of friction.
///
/// The signal is `mu`. Claim 8-160.e.
fn reads_a_coefficient(_: &CheckArguments) -> Result<Finding, CheckError> {
    let circuit = circuit("nakashima")?;
    let plotted = circuit.patch().pictures.first().and_then(|picture| picture.y.first());
    let plotted = plotted.map(|name| name.value.clone()).unwrap_or_default();
    Ok(Finding::truth(plotted == "mu", format!("its first picture shows {plotted}")))
}

/// Checks whether no oscillation of Singh's circuit keeps its amplitude: all decay below n = f, and all grow above it.
///
/// Argument `shares`: n / f, where n is the slope of falling friction and f the viscous coefficient. The swing of the
/// last third of 0.6 s is compared with that of the first third: below 0.95 is decay, above 1.05 growth. Claim 2-035.
fn no_oscillation_lasts(given: &CheckArguments) -> Result<Finding, CheckError> {
    let mut texts = Vec::new();
    let mut lasts = false;
    for share in given.numbers("shares")? {
        let recipe =
            Recipe::new("singh").set("n", share * SIMULATED_DAMPING).run_time(0.6).record(&["v_i", "v_o"]);
        let run = recipe.run("singh", "")?;
        let swing: Vec<f64> = run
            .record
            .points(("v_i", MM_PER_S), ("v_o", MM_PER_S))?
            .iter()
            .map(|(v_i, v_o)| (v_o - v_i).abs())
            .collect();
        let most = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
        let change = most(&swing[2 * swing.len() / 3..]) / most(&swing[..swing.len() / 3]);
        let dies_or_grows = if share < 1.0 { change < 0.95 } else { change > 1.05 };
        lasts |= !dies_or_grows;
        texts.push(format!("x {change:.2} at n = {share} f"));
    }
    Ok(Finding::truth(
        !lasts,
        format!("swings in the last third relative to the first: {}", texts.join(", ")),
    ))
}
