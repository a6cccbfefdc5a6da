//! What the shipped circuits hold, and what their parts read where a velocity stands still.
//!
//! Arguments are the circuit and its parameters in their units.

use serde_json::json;

use super::super::finding::Finding;
use super::super::given::Given;
use super::super::recipe::{Problem, Recipe};
use super::recordings::{range, steady};
use super::{Check, CheckError};
use crate::slideway::falling::FallingFriction;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::Code;
use patchcord_core::patch::Amount;
use patchcord_expr::Formula;

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

/// The circuits that may be named.
const CIRCUITS: [&str; 7] =
    ["fig-8-04", "fig-8-07", "fig-8-09", "fig-8-11", "fig-8-14", "fig-8-15", "fig-8-16"];

/// What the machine may be off by (8.1), as a share.
pub(super) const ACCURACY: f64 = 0.02;

/// A shipped circuit with the parameters that are given.
pub(super) fn shipped(given: &Given) -> Result<Recipe, CheckError> {
    let mut recipe = Recipe::of(given.word("circuit", &CIRCUITS.map(|name| (name, name)))?);
    for name in recipe.patch("shipped", "")?.parameters.keys() {
        if given.text(name).is_some() {
            recipe = recipe.set(name, given.number(name)?);
        }
    }
    Ok(recipe)
}

/// A formula of a circuit's parameters and scales, in SI units.
fn circuit_holds(given: &Given) -> Result<Finding, CheckError> {
    let text = given.need("is")?;
    let wrong = |error: String| CheckError::Formula { text: text.to_owned(), error };
    let formula = Formula::parse(text).map_err(|error| wrong(error.to_string()))?;
    let circuit = shipped(given)?.circuit("holds", "")?;
    let value = formula.evaluate(circuit.quantities()).map_err(|error| wrong(error.to_string()))?;
    Ok(Finding::Number(value))
}

/// How a potentiometer of a circuit is set.
pub(super) fn setting(circuit: &Circuit, pot: &str) -> Result<f64, CheckError> {
    let missing = || CheckError::Run(format!("there is no potentiometer {pot}"));
    let element = circuit.elements().into_iter().find(|element| element.name == pot).ok_or_else(missing)?;
    let row = element.kind.settings.iter().position(|row| row.name == "setting").ok_or_else(missing)?;
    let Some(Amount::Formula(formula)) = element.settings[row].as_ref().map(|given| &given.value) else {
        return Err(missing());
    };
    formula.evaluate(circuit.quantities()).map_err(|error| CheckError::Run(error.to_string()))
}

fn pot_setting(given: &Given) -> Result<Finding, CheckError> {
    let circuit = shipped(given)?.circuit("pot", "")?;
    Ok(Finding::Number(setting(&circuit, given.need("of")?)?))
}

/// Whether one potentiometer could serve in two places: they want the same setting.
fn one_pot_for_both(given: &Given) -> Result<Finding, CheckError> {
    let circuit = shipped(given)?.circuit("pots", "")?;
    let (one, other) = (setting(&circuit, given.need("one")?)?, setting(&circuit, given.need("other")?)?);
    Ok(Finding::truth((one / other - 1.0).abs() < ACCURACY, format!("set to {one:.4} and to {other:.4}")))
}

/// Whether an element may be made of a part of that name: no other has it.
fn part_is_free(given: &Given) -> Result<Finding, CheckError> {
    let (element, kind, part) = (given.need("element")?, given.need("kind")?, given.need("part")?);
    let recipe = shipped(given)?.edit(&format!("elements/{element}/uses/{kind}"), json!([part]));
    match Circuit::new(&recipe.patch("part", "")?, &[]) {
        Ok(_) => Ok(Finding::truth(true, format!("{part} is free"))),
        Err(report) => {
            let twice = report.findings.iter().find(|finding| finding.code == Code::PartTwice);
            let twice = twice.ok_or_else(|| CheckError::Run(report.to_string()))?;
            Ok(Finding::truth(false, twice.message.clone()))
        }
    }
}

/// What a signal reads after a time in s.
fn read(recipe: Recipe, signal: &str, after: f64) -> Result<f64, Problem> {
    let values = recipe.lasting(after).recording(&[signal]).run("reading", "")?.values(signal)?;
    values.last().copied().ok_or_else(|| format!("{signal} is not recorded").into())
}

/// So long a reading waits, in s, where nothing is said.
const AT_ONCE: f64 = 0.01;

/// What a signal reads after a time, in its unit.
fn reading(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(read(shipped(given)?, given.need("of")?, given.number_or("after", AT_ONCE)?)?))
}

/// How steeply one signal goes with another, while a parameter goes from one value to another. Amplifiers invert: sizes count.
fn gain_between(given: &Given) -> Result<Finding, CheckError> {
    let (recipe, varied) = (shipped(given)?, given.need("vary")?);
    let ends = [given.number("from")?, given.number("till")?];
    let change = |signal: &str| -> Result<f64, Problem> {
        let [from, till] = ends.map(|value| read(recipe.clone().set(varied, value), signal, AT_ONCE));
        Ok((till? - from?).abs())
    };
    Ok(Finding::Number(change(given.need("to")?)? / change(given.need("by")?)?))
}

/// Whether signals all stand below 0.
fn all_below_zero(given: &Given) -> Result<Finding, CheckError> {
    let recipe = shipped(given)?;
    let mut told = Vec::new();
    let mut holds = true;
    for signal in given.need("of")?.split(';') {
        let value = read(recipe.clone(), signal, AT_ONCE)?;
        holds &= value < 0.0;
        told.push(format!("{signal} {value:.2} V"));
    }
    Ok(Finding::truth(holds, told.join(", ")))
}

/// Where the lag comes to, in V, from 0 V and without a velocity.
fn lag_at_rest(_: &Given) -> Result<Finding, CheckError> {
    let recipe = Recipe::of("fig-8-15").set("swing", 0.0).set("mean", 0.0).edit("elements/A1/initial", 0.0);
    Ok(Finding::Number(read(recipe, "out", 0.3)?))
}

/// Whether the lag is the same on the x100 input with 0.01 / Tc as on the x1000 input with 0.001 / Tc.
fn lag_on_either_input(given: &Given) -> Result<Finding, CheckError> {
    let recipe = Recipe::of("fig-8-15").set("Tc", given.number("Tc")?).recording(&["out"]);
    let slower = recipe.clone().edit("elements/PA1/setting", "0.01 / Tc");
    let slower = slower.edit("elements/A1/in", json!({"x100": ["PA1"]}));
    let (fast, slow) = (recipe.run("x1000", "")?.values("out")?, slower.run("x100", "")?.values("out")?);
    let apart = fast.iter().zip(&slow).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
    Ok(Finding::truth(apart < 1e-9, format!("the same to {apart:.1e} V")))
}

/// How far the friction level of the straight-line circuit lies from the straight line at most, in percent of Fs, as velocity goes
/// through the whole of it.
fn straight_level(given: &Given) -> Result<Finding, CheckError> {
    let limit = given.number("VcL")?;
    let recipe = Recipe::of("fig-8-11").set("VcL", limit).set("v_rate", 6e-3).lasting(1.2).every(2e-4);
    let run = recipe.recording(&["v_o", "friction_level"]).run("level", "")?;
    let friction = FallingFriction::simulated(limit);
    let (mut furthest, mut fastest) = (0.0_f64, 0.0_f64);
    for (velocity, level) in run.points(("v_o", 1.0), ("friction_level", 1.0))? {
        furthest = furthest.max((level - friction.solid_straight(velocity.abs())?).abs());
        fastest = fastest.max(velocity.abs());
    }
    if fastest < limit {
        return Err(CheckError::Run(format!("velocity reaches {fastest} m/s only")));
    }
    Ok(Finding::Number(100.0 * furthest / friction.static_friction))
}

/// Whether the straight-line circuit sticks and slips at a steady command with the velocity command in a second input of B3, as it does with
/// the command in the position integrator.
fn command_in_inverter(given: &Given) -> Result<Finding, CheckError> {
    let command = given.number("at")?;
    let swing = |recipe: Recipe| -> Result<f64, CheckError> {
        let (least, most) = range(&steady(recipe, command)?)?;
        Ok(most - least)
    };
    let ours = Recipe::of("fig-8-11");
    let literal = ours.clone().edit("elements/B3/in", json!({"x1": ["A3", "v_i"]}));
    let (literal, ours) = (swing(literal)?, swing(ours)?);
    let found = format!("swings of {literal:.2} mm/s, and of {ours:.2} mm/s with it in the integrator");
    Ok(Finding::truth(literal > 0.5 * ours, found))
}
