//! How cost grows with the number of elements: a chain of damped oscillators, each driven by the one before.

use std::fmt::Write as _;

use crate::clock::{Work, in_turns, three, timed, told};
use crate::own::{BACKENDS, Backend, ran};
use crate::{Outcome, page};
use patchcord::circuit::Circuit;
use patchcord::ir::Program;
use patchcord::patch::Patch;
use patchcord::solve::RunSettings;

/// Elements times steps of one run.
const WORK: f64 = 2e6;
/// The step of the chain, in seconds.
const STEP: f64 = 1e-3;
const ROUNDS: usize = 3;

pub fn table(quick: bool) -> Outcome<String> {
    let counts: &[usize] = if quick { &[100, 10_000] } else { &[12, 100, 1000, 10_000] };
    let rows = counts.iter().map(|count| row(*count)).collect::<Outcome<Vec<_>>>()?;
    let head = ["elements", "read", "resolve and check", "lower"].map(str::to_owned);
    let head = head.into_iter().chain(BACKENDS.map(|(name, _)| format!("first step, {name}")));
    let head = head.chain(BACKENDS.map(|(name, _)| format!("an element and step, {name}")));
    let head: Vec<String> = head.collect();
    Ok(page::table(&head.iter().map(String::as_str).collect::<Vec<_>>(), &rows))
}

/// A chain of so many elements, as text.
fn chain(count: usize) -> String {
    let mut elements = String::new();
    for cell in 0..count / 4 {
        let before = if cell == 0 { "u".to_owned() } else { format!("B{}", cell - 1) };
        let _ = write!(
            elements,
            "{comma}\"P{cell}\": {{\"kind\": \"pot\", \"in\": \"{before}\", \"setting\": 0.5}},\n\
             \"A{cell}\": {{\"kind\": \"integrator\", \"in\": {{\"x10\": [\"P{cell}\", \"B{cell}\"], \"x5\": [\"A{cell}\"]}}}},\n\
             \"S{cell}\": {{\"kind\": \"summer\", \"in\": {{\"x1\": [\"A{cell}\"]}}}},\n\
             \"B{cell}\": {{\"kind\": \"integrator\", \"in\": {{\"x10\": [\"S{cell}\"]}}}}",
            comma = if cell == 0 { "" } else { ",\n" },
        );
    }
    let last = format!("B{}", count / 4 - 1);
    format!(
        "{{\"patchcord\": 1, \"title\": \"Chain\", \"scales\": {{\"volt\": {{\"per_volt\": 1, \"unit\": \"V\"}}}},\n\
         \"drives\": {{\"u\": {{\"kind\": \"sine\", \"scale\": \"volt\", \"amplitude\": 50, \"frequency\": 1}}}},\n\
         \"elements\": {{\n{elements}\n}},\n\
         \"signals\": {{\"last\": {{\"at\": \"{last}\", \"scale\": \"volt\"}}}},\n\
         \"run\": {{\"for\": 1, \"step\": 1e-3}}}}"
    )
}

fn row(count: usize) -> Outcome<Vec<String>> {
    let (phases, circuit) = made(&chain(count))?;
    let (steps, own) = ((WORK / count as f64).round(), RunSettings::of(&circuit)?);
    let settings = |steps: f64, (_, chosen): Backend| {
        let length = steps * STEP;
        chosen(RunSettings { every: length, ..own.clone().lasting(length) })
    };
    let program = Program::new(&circuit)?;
    // Folding and compiling are part of the first step.
    let first = |backend: Backend| -> Work<'_> {
        let (settings, circuit) = (settings(1.0, backend), &circuit);
        Box::new(move || Ok(ran(&Program::new(circuit)?, &settings)?.0))
    };
    let long = |backend: Backend| -> Work<'_> {
        let (settings, program) = (settings(steps, backend), &program);
        Box::new(move || Ok(ran(program, &settings)?.0))
    };
    let first = in_turns(ROUNDS, BACKENDS.map(first).into())?;
    let long = in_turns(ROUNDS, BACKENDS.map(long).into())?;
    let told_long = long.iter().map(|seconds| format!("{} ns", three(seconds / steps / count as f64 * 1e9)));
    let told_phases = phases.into_iter().chain(first).map(told);
    Ok([count.to_string()].into_iter().chain(told_phases).chain(told_long).collect())
}

/// The shortest seconds of reading, resolving and lowering, and the circuit.
fn made(text: &str) -> Outcome<([f64; 3], Circuit)> {
    let mut least = [f64::INFINITY; 3];
    let mut made = None;
    for _ in 0..ROUNDS {
        let (read, patch) = timed(|| Patch::parse("chain.json", text));
        let patch = patch?;
        let (resolved, circuit) = timed(|| Circuit::new(&patch, &[]));
        let circuit = circuit?;
        let (lowered, program) = timed(|| Program::new(&circuit));
        program?;
        made = Some(circuit);
        least = std::array::from_fn(|phase| least[phase].min([read, resolved, lowered][phase]));
    }
    Ok((least, made.ok_or("nothing was made")?))
}
