//! What can only be told once the operations are there: coefficients and loops in initial condition.

use super::evaluate::Scratch;
use super::loops::{LoopFault, Solutions};
use super::{Loop, Program, Sources};
use crate::circuit::Circuit;
use crate::patch::{Code, Diagnostic, Report, told};

/// Modes that have not settled after so many rounds chatter, which the run tells.
const MOST_SETTLING: usize = 1000;

/// Refuses programs whose coefficients or loops cannot be used.
pub(super) fn check(circuit: &Circuit, program: &Program) -> Result<(), Box<Report>> {
    match finding(circuit, program) {
        Some(finding) => Err(Box::new(circuit.report_with(finding))),
        None => Ok(()),
    }
}

fn finding(circuit: &Circuit, program: &Program) -> Option<Diagnostic> {
    let parameters: Vec<f64> = program.parameters.iter().map(|slot| slot.value).collect();
    let coefficients = program.prepare(&parameters);
    if let Some((coefficient, value)) = program.first_bad(&coefficients) {
        let message = format!("{} comes to {value}", coefficient.label);
        let hint = Some("look for a wrong power of ten, here or in a scale".to_owned());
        return Some(Diagnostic { code: Code::NotFinite, span: coefficient.span, message, hint });
    }
    let fault = fault_at_rest(program, &parameters, &coefficients)?;
    Some(diagnostic(circuit, &program.loops[fault.index], fault.solutions))
}

/// The loop that cannot be solved in initial condition, once the modes have settled.
fn fault_at_rest(program: &Program, parameters: &[f64], coefficients: &[f64]) -> Option<LoopFault> {
    let mut states: Vec<f64> =
        program.states.iter().map(|state| coefficients[state.initial as usize]).collect();
    let mut modes: Vec<f64> = program.modes.iter().map(|mode| mode.initial).collect();
    let delayed: Vec<f64> = program.delays.iter().map(|delay| coefficients[delay.initial as usize]).collect();
    let mut registers = vec![0.0; program.body.len()];
    let mut scratch = Scratch::new(program);
    for _ in 0..MOST_SETTLING {
        let from = Sources {
            parameters,
            coefficients,
            states: &states,
            modes: &modes,
            time: 0.0,
            tables: &program.tables,
            delayed: &delayed,
        };
        scratch.fault = None;
        program.evaluate(&from, &mut registers, &mut scratch);
        let mut changed = false;
        program.change_modes(&registers, &mut modes, &mut states, |_| changed = true);
        if !changed {
            break;
        }
    }
    scratch.fault
}

fn diagnostic(circuit: &Circuit, entry: &Loop, solutions: Solutions) -> Diagnostic {
    let opened = entry.members.last().map_or("", String::as_str);
    let members = entry.members.join(", ");
    let (code, hint) = match solutions {
        Solutions::Counted { count: 0, .. } => (
            Code::LoopWithoutSolution,
            "put an integrator or a lag into the loop, or a relay with hysteresis",
        ),
        Solutions::NotStraight | Solutions::NotANumber => {
            (Code::LoopNotPiecewiseLinear, "put an integrator or a lag into the loop")
        }
        Solutions::TooManyPieces => (Code::LoopTooTangled, "put an integrator or a lag into the loop"),
        Solutions::Range => {
            (Code::LoopWithSolutions, "its gain is exactly 1: change it, or put an integrator into the loop")
        }
        _ => (Code::LoopWithSolutions, "the loop latches up: bring its gain under 1, or invert it once more"),
    };
    let message = format!("the loop {members} has no integrator and {}", tell(solutions, opened));
    let span =
        circuit.elements().iter().find(|element| element.name == opened).and_then(|element| element.span);
    Diagnostic { code, span, message, hint: Some(hint.to_owned()) }
}

/// A voltage to the microvolt.
fn told_volts(volts: f64) -> String {
    told((volts * 1e6).round() / 1e6)
}

/// The solutions in words.
pub(crate) fn tell(solutions: Solutions, opened: &str) -> String {
    match solutions {
        Solutions::Counted { count: 0, .. } => "no set of voltages satisfies it".to_owned(),
        Solutions::Counted { count, first } => {
            let told: Vec<_> =
                first.iter().take(count).map(|volts| format!("{} V", told_volts(*volts))).collect();
            let more = if count > told.len() { ", ..." } else { "" };
            format!("{count} solutions: {opened} at {}{more}", told.join(", "))
        }
        Solutions::Range => format!("a whole range of solutions: {opened} follows itself"),
        Solutions::NotStraight => "goes through an element that is not made of straight pieces".to_owned(),
        Solutions::NotANumber => "a voltage in it that is not a number".to_owned(),
        Solutions::TooManyPieces => "is made of more straight pieces than can be walked".to_owned(),
    }
}
