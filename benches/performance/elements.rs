//! How cost grows with the number of elements: a chain of damped oscillators, each driven by the one before.

use std::fmt::Write as _;

use patchcord::circuit::Circuit;
use patchcord::patch::Patch;
use patchcord::program::Program;
use patchcord::solve::RunSettings;

use crate::Outcome;
use crate::clock::{shortest, three, timed, told};
use crate::own::{BACKENDS, ran};
use crate::page;

/// Elements times steps of one run.
const WORK: f64 = 2e6;
/// The step of the chain, in seconds.
const STEP: f64 = 1e-3;
const ROUNDS: usize = 3;

pub fn table(quick: bool) -> Outcome<String> {
    let counts: &[usize] = if quick { &[100, 10_000] } else { &[12, 100, 1000, 10_000] };
    let rows = counts.iter().map(|count| row(*count)).collect::<Outcome<Vec<_>>>()?;
    let mut head = vec!["elements", "read", "resolve and check", "lower", "together"];
    let names: Vec<String> =
        BACKENDS.iter().map(|(name, _)| format!("an element and step, {name}")).collect();
    head.extend(names.iter().map(String::as_str));
    Ok(page::table(&head, &rows))
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
    let (phases, program, settings) = made(&chain(count))?;
    let steps = (WORK / count as f64).round();
    let settings = settings.lasting(steps * STEP);
    let mut row = vec![count.to_string()];
    row.extend(phases.map(told));
    row.push(told(phases.iter().sum()));
    for (_, chosen) in BACKENDS {
        let settings = RunSettings { every: steps * STEP, ..chosen(settings.clone()) };
        let seconds = shortest(ROUNDS, || Ok(ran(&program, &settings)?.0))?;
        row.push(format!("{} ns", three(seconds / steps / count as f64 * 1e9)));
    }
    Ok(row)
}

/// The shortest seconds of reading, resolving and lowering, and what they made.
fn made(text: &str) -> Outcome<([f64; 3], Program, RunSettings)> {
    let mut least = [f64::INFINITY; 3];
    let mut made = None;
    for _ in 0..ROUNDS {
        let (read, patch) = timed(|| Patch::parse("chain.json", text));
        let patch = patch?;
        let (resolved, circuit) = timed(|| Circuit::new(&patch, &[]));
        let circuit = circuit?;
        let (lowered, program) = timed(|| Program::new(&circuit));
        made = Some((program?, RunSettings::of(&circuit)?));
        least = std::array::from_fn(|phase| least[phase].min([read, resolved, lowered][phase]));
    }
    let (program, settings) = made.ok_or("nothing was made")?;
    Ok((least, program, settings))
}
