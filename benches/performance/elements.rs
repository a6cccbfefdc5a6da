//! The table of cost by number of elements: a chain of damped oscillators, each driven by the one before.

use std::fmt::Write as _;

use crate::backends::{BACKENDS, BackendChoice, run_timed};
use crate::timing::{Work, format_digits, format_seconds, in_turns, timed};
use crate::{Outcome, page};
use patchcord::circuit::Circuit;
use patchcord::ir::Program;
use patchcord::patch::Patch;
use patchcord::solve::RunSettings;

/// Elements times steps of one run, so that runs of all sizes take about equally long.
const ELEMENT_STEPS: f64 = 2e6;
/// Step of the runs in s.
const STEP: f64 = 1e-3;
/// Measurements of each work, in turns.
const ROUNDS: usize = 3;

/// The table.
pub(crate) fn table(quick: bool) -> Outcome<String> {
    let counts: &[usize] = if quick { &[100, 10_000] } else { &[12, 100, 1000, 10_000] };
    let rows = counts.iter().map(|count| row(*count)).collect::<Outcome<Vec<_>>>()?;
    let head = ["elements", "read", "resolve and check", "lower"].map(str::to_owned);
    let head = head.into_iter().chain(BACKENDS.map(|(name, _)| format!("first step, {name}")));
    let head = head.chain(BACKENDS.map(|(name, _)| format!("an element and step, {name}")));
    let head: Vec<String> = head.collect();
    Ok(page::table(&head.iter().map(String::as_str).collect::<Vec<_>>(), &rows))
}

/// The patch of a chain as text. `count` is the number of elements; each oscillator has four.
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

/// The row of a chain with this number of elements.
fn row(count: usize) -> Outcome<Vec<String>> {
    let (phases, circuit) = measured_phases(&chain(count))?;
    let (steps, defaults) = ((ELEMENT_STEPS / count as f64).round(), RunSettings::of(&circuit)?);
    let settings = |steps: f64, (_, chosen): BackendChoice| {
        let length = steps * STEP;
        chosen(defaults.clone().with_duration(length).with_sample_interval(length))
    };
    let program = Program::new(&circuit)?;
    // The first step of a new program includes specialising and compiling.
    let first_step = |backend: BackendChoice| -> Work<'_> {
        let (settings, circuit) = (settings(1.0, backend), &circuit);
        Box::new(move || Ok(run_timed(&Program::new(circuit)?, &settings)?.0))
    };
    let long_run = |backend: BackendChoice| -> Work<'_> {
        let (settings, program) = (settings(steps, backend), &program);
        Box::new(move || Ok(run_timed(program, &settings)?.0))
    };
    let first = in_turns(ROUNDS, BACKENDS.map(first_step).into())?;
    let long = in_turns(ROUNDS, BACKENDS.map(long_run).into())?;
    let per_step =
        long.iter().map(|seconds| format!("{} ns", format_digits(seconds / steps / count as f64 * 1e9)));
    let phases = phases.into_iter().chain(first).map(format_seconds);
    Ok([count.to_string()].into_iter().chain(phases).chain(per_step).collect())
}

/// The shortest durations of reading, resolving and lowering in s, and the circuit.
fn measured_phases(text: &str) -> Outcome<([f64; 3], Circuit)> {
    let mut shortest = [f64::INFINITY; 3];
    let mut last_circuit = None;
    for _ in 0..ROUNDS {
        let (read, patch) = timed(|| Patch::parse("chain.json", text));
        let patch = patch?;
        let (resolved, circuit) = timed(|| Circuit::new(&patch));
        let circuit = circuit?;
        let (lowered, program) = timed(|| Program::new(&circuit));
        program?;
        last_circuit = Some(circuit);
        shortest = std::array::from_fn(|phase| shortest[phase].min([read, resolved, lowered][phase]));
    }
    Ok((shortest, last_circuit.ok_or("no round was measured")?))
}
