//! Claims on the shipped circuits: their parameters, settings and voltages.
//!
//! The arguments are the circuit and its parameters in their units.

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::recipe::{BoxError, Recipe};
use super::super::series::max_difference;
use super::recordings::{range, steady};
use super::{Check, CheckError};
use crate::slideway::falling::FallingFriction;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::Code;
use patchcord_core::patch::Amount;
use patchcord_expr::Formula;

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "circuit-holds", run: circuit_holds },
    Check { name: "pot-setting", run: pot_setting },
    Check { name: "one-pot-for-both", run: one_pot_for_both },
    Check { name: "part-is-free", run: part_is_free },
    Check { name: "reading", run: reading },
    Check { name: "gain-between", run: gain_between },
    Check { name: "all-below-zero", run: all_below_zero },
    Check { name: "lag-at-rest", run: lag_at_rest },
    Check { name: "lag-on-either-input", run: lag_on_either_input },
    Check { name: "straight-level", run: straight_level },
    Check { name: "command-in-inverter", run: command_in_inverter },
];

/// The permitted circuits.
///
/// The argument `circuit` must be one of these names.
const CIRCUITS: [&str; 7] =
    ["fig-8-04", "fig-8-07", "fig-8-09", "fig-8-11", "fig-8-14", "fig-8-15", "fig-8-16"];

/// Accuracy of the machine (8.1), as a share. The text attributes it to the setting of potentiometers.
pub(super) const ACCURACY: f64 = 0.02;

/// A shipped circuit with the parameters of the claim.
///
/// Every parameter of the patch may be an argument, in the unit that the patch states for it.
pub(super) fn shipped(given: &CheckArguments) -> Result<Recipe, CheckError> {
    let mut recipe = Recipe::new(given.choice("circuit", &CIRCUITS.map(|name| (name, name)))?);
    for name in recipe.patch("shipped", "")?.parameters.keys() {
        if given.text(name).is_some() {
            recipe = recipe.set(name, given.number(name)?);
        }
    }
    Ok(recipe)
}

/// The value of a formula in a circuit's parameters and scales, in SI units.
///
/// Argument `is`, a formula such as `K/1e6`. Claims 3-004, 8-040, 8-042, 8-057, 8-108, 8-110 and 8-112.
fn circuit_holds(given: &CheckArguments) -> Result<Finding, CheckError> {
    let text = given.require("is")?;
    let wrong = |error: String| CheckError::Formula { text: text.to_owned(), error };
    let formula = Formula::parse(text).map_err(|error| wrong(error.to_string()))?;
    let circuit = shipped(given)?.circuit("holds", "")?;
    let value = formula.evaluate(circuit.quantities()).map_err(|error| wrong(error.to_string()))?;
    Ok(Finding::Number(value))
}

/// The setting of a potentiometer of a circuit, 0 ... 1.
///
/// # Errors
/// If the circuit has no such element, if it has no setting, or if the setting is not a formula.
pub(super) fn setting(circuit: &Circuit, pot: &str) -> Result<f64, CheckError> {
    let missing = || CheckError::Run(format!("there is no potentiometer {pot}"));
    let element = circuit.elements().into_iter().find(|element| element.name == pot).ok_or_else(missing)?;
    let row = element.kind.settings.iter().position(|row| row.name == "setting").ok_or_else(missing)?;
    let Some(Amount::Formula(formula)) = element.settings[row].as_ref().map(|setting| &setting.value) else {
        return Err(missing());
    };
    formula.evaluate(circuit.quantities()).map_err(|error| CheckError::Run(error.to_string()))
}

/// The setting of the potentiometer `of`.
///
/// Claim 8-092: PC2 of the square-law circuit.
fn pot_setting(given: &CheckArguments) -> Result<Finding, CheckError> {
    let circuit = shipped(given)?.circuit("pot", "")?;
    Ok(Finding::Number(setting(&circuit, given.require("of")?)?))
}

/// Checks whether one potentiometer could serve for two: both need the same setting.
///
/// Arguments: `one` and `other`, names of pots. Equal means to 2 %. Claim 8-068: PC2 and PC3 of Fig 8.9.
fn one_pot_for_both(given: &CheckArguments) -> Result<Finding, CheckError> {
    let circuit = shipped(given)?.circuit("pots", "")?;
    let (one, other) =
        (setting(&circuit, given.require("one")?)?, setting(&circuit, given.require("other")?)?);
    Ok(Finding::truth((one / other - 1.0).abs() < ACCURACY, format!("settings {one:.4} and {other:.4}")))
}

/// Checks whether no other element uses the part that the text assigns to an element.
///
/// Arguments: `element`, `kind` and `part` of the machine, such as `free_pots` and `PB2`. The checker of patches
/// decides: it reports a part that is used twice. Claim 8-066.
fn part_is_free(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (element, kind, part) = (given.require("element")?, given.require("kind")?, given.require("part")?);
    let recipe = shipped(given)?.edit(&format!("elements/{element}/uses/{kind}"), [part]);
    match Circuit::new(&recipe.patch("part", "")?) {
        Ok(_) => Ok(Finding::truth(true, format!("{part} is free"))),
        Err(report) => {
            let duplicate = report.findings.iter().find(|finding| finding.code == Code::PART_TWICE);
            let duplicate = duplicate.ok_or_else(|| CheckError::Run(report.to_string()))?;
            Ok(Finding::truth(false, duplicate.message.clone()))
        }
    }
}

/// The value of a signal after a time in s.
///
/// The run ends at this time, so the value is the last sample.
fn read(recipe: Recipe, signal: &str, after: f64) -> Result<f64, BoxError> {
    let values = recipe.run_time(after).record(&[signal]).run("reading", "")?.record.values(signal)?;
    values.last().copied().ok_or_else(|| format!("{signal} is not recorded").into())
}

/// Default time of a reading, in s.
const READING_TIME: f64 = 0.01;

/// The value of the signal `of` after a time in s, in the unit of the signal.
///
/// Arguments: the circuit, `of` and `after` (0.01 s). Claims 8-034, 8-063, 8-065 and 8-071.b.
fn reading(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(read(shipped(given)?, given.require("of")?, given.number_or("after", READING_TIME)?)?))
}

/// The ratio of the changes of two signals when a parameter changes from one value to another. Only the magnitude
/// counts, because amplifiers invert.
///
/// Arguments: `by` and `to`, names of signals; `vary`, `from` and `till`. Claim 8-067: 5 from B2 to X1.
fn gain_between(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (recipe, varied) = (shipped(given)?, given.require("vary")?);
    let ends = [given.number("from")?, given.number("till")?];
    let change = |signal: &str| -> Result<f64, BoxError> {
        let [from, till] = ends.map(|value| read(recipe.clone().set(varied, value), signal, READING_TIME));
        Ok((till? - from?).abs())
    };
    Ok(Finding::Number(change(given.require("to")?)? / change(given.require("by")?)?))
}

/// Checks whether all signals are negative.
///
/// Argument `of`: names of signals, separated by semicolons. Claim 8-071.a.
fn all_below_zero(given: &CheckArguments) -> Result<Finding, CheckError> {
    let recipe = shipped(given)?;
    let mut texts = Vec::new();
    let mut holds = true;
    for signal in given.require("of")?.split(';') {
        let value = read(recipe.clone(), signal, READING_TIME)?;
        holds &= value < 0.0;
        texts.push(format!("{signal} {value:.2} V"));
    }
    Ok(Finding::truth(holds, texts.join(", ")))
}

/// The final output of the lag in V, from 0 V and without velocity.
///
/// The circuit of Fig 8.15 runs for 0.3 s, which is thirty time constants. Claim 8-100.
fn lag_at_rest(_: &CheckArguments) -> Result<Finding, CheckError> {
    let recipe = Recipe::new("fig-8-15").set("swing", 0.0).set("mean", 0.0).edit("elements/A1/initial", 0.0);
    Ok(Finding::Number(read(recipe, "out", 0.3)?))
}

/// Checks whether the lag on the x100 input with 0.01 / Tc equals the lag on the x1000 input with 0.001 / Tc.
///
/// The outputs of both runs must agree to 1e-9 V at every sample. Eq 34-8 and 35-8, claim 8-095.a.
fn lag_on_either_input(given: &CheckArguments) -> Result<Finding, CheckError> {
    let recipe = Recipe::new("fig-8-15").set("Tc", given.number("Tc")?).record(&["out"]);
    let slower = recipe.clone().edit("elements/PA1/setting", "0.01 / Tc");
    let slower = slower.cords("A1", "x100", &["PA1"]);
    let (fast, slow) =
        (recipe.run("x1000", "")?.record.values("out")?, slower.run("x100", "")?.record.values("out")?);
    let distance = max_difference(&fast, &slow);
    Ok(Finding::truth(distance < 1e-9, format!("equal to {distance:.1e} V")))
}

/// The largest distance of the friction level of the straight-line circuit from the straight line, in percent of Fs,
/// while velocity covers the whole line.
///
/// Argument `VcL` in m/s. The command rises at 6 mm/s2 for 1.2 s. The line is Fs (1 - v / VcL) (eq 28-8). Fig 8.10,
/// claims 8-076.a ... c.
///
/// # Errors
/// If the velocity does not reach VcL.
fn straight_level(given: &CheckArguments) -> Result<Finding, CheckError> {
    let limit = given.number("VcL")?;
    let recipe =
        Recipe::new("fig-8-11").set("VcL", limit).set("v_rate", 6e-3).run_time(1.2).sample_interval(2e-4);
    let run = recipe.record(&["v_o", "friction_level"]).run("level", "")?;
    let friction = FallingFriction::simulated(limit);
    let (mut largest, mut fastest) = (0.0_f64, 0.0_f64);
    for (velocity, level) in run.record.points(("v_o", 1.0), ("friction_level", 1.0))? {
        largest = largest.max((level - friction.solid_straight(velocity.abs())?).abs());
        fastest = fastest.max(velocity.abs());
    }
    if fastest < limit {
        return Err(CheckError::Run(format!("velocity reaches only {fastest} m/s")));
    }
    Ok(Finding::Number(100.0 * largest / friction.static_friction))
}

/// Checks whether the straight-line circuit sticks and slips at a steady command if the velocity command enters a
/// second input of B3. It does so if the command enters the position integrator.
///
/// Argument `at`: the command in m/s. B3 forms the modulus of velocity. The swing with the printed wiring must be more
/// than half of that with ours. Claim 8-081.
fn command_in_inverter(given: &CheckArguments) -> Result<Finding, CheckError> {
    let command = given.number("at")?;
    let swing = |recipe: Recipe| -> Result<f64, CheckError> {
        let (least, most) = range(&steady(recipe, command)?)?;
        Ok(most - least)
    };
    let ours = Recipe::new("fig-8-11");
    let literal = ours.clone().cords("B3", "x1", &["A3", "v_i"]);
    let (literal, ours) = (swing(literal)?, swing(ours)?);
    let found =
        format!("swings of {literal:.2} mm/s, and of {ours:.2} mm/s with the command in the integrator");
    Ok(Finding::truth(literal > 0.5 * ours, found))
}
