//! `patchcord run`

use clap::Args;
use serde_json::{Value, json};

use super::failure::Failure;
use super::files::{FileArguments, Files};
use super::load::{Loaded, PatchArguments, parameter_line, parameters_json};
use super::table::Table;
use super::{say, say_json};
use patchcord::circuit::Circuit;
use patchcord::instruments::{self, Display, Reading};
use patchcord::solve::{self, Overload, RunError, RunSettings};
use patchcord::trace::Trace;

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    /// How long to run, in problem seconds
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds)]
    duration: Option<f64>,
    /// Step of the solver, in problem seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    step: Option<f64>,
    /// Time between recorded samples, in problem seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    every: Option<f64>,
    /// Run this many times from initial condition (repetitive operation)
    #[arg(long, value_name = "TIMES", value_parser = clap::value_parser!(u32).range(1..))]
    repeat: Option<u32>,
    /// Go into hold as soon as an overload lamp lights
    #[arg(long)]
    hold_on_overload: bool,
    /// Record these signals, drives or elements instead of those that the patch names
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    record: Vec<String>,
    #[command(flatten)]
    files: FileArguments,
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("\"{text}\" is not a number"))?;
    if seconds > 0.0 && seconds.is_finite() {
        Ok(seconds)
    } else {
        Err("a time above 0 s is wanted".to_owned())
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let json = arguments.patch.json;
    let files =
        arguments.files.files(&arguments.patch.patch).map_err(|failure| failure.told_as_json(json))?;
    let Loaded { circuit, program } = arguments.patch.load()?;
    let settings = arguments.settings(&circuit).map_err(|failure| failure.told_as_json(json))?;
    files.prepare().map_err(|failure| failure.told_as_json(json))?;
    let outcome = solve::run(&program, &settings);
    let trace = match &outcome {
        Err(RunError::NotANumber { trace: Some(trace), .. }) => trace.as_ref(),
        Ok(trace) => trace,
        Err(error) => return Err(Failure::from(error.clone()).told_as_json(json)),
    };
    files.write(trace, &circuit).map_err(|failure| failure.told_as_json(json))?;
    if let Err(error) = &outcome {
        return Err(Failure::from(error.clone()).told_as_json(json));
    }
    if json {
        return say_json(&document(&circuit, &settings, trace, &files));
    }
    say(&readings_table(&circuit, trace))?;
    say(&format!("\n{}{}", work_told(trace), overloads_told(trace)))?;
    say(&files.told())
}

impl Arguments {
    fn settings(&self, circuit: &Circuit) -> Result<RunSettings, Failure> {
        let mut plan = circuit.run_plan().clone();
        let given = |value| patchcord::patch::Placed { value, span: patchcord::patch::Span::default() };
        plan.duration = self.duration.map(given).or(plan.duration);
        plan.step = self.step.map(given).or(plan.step);
        plan.every = self.every.map(given).or(plan.every);
        plan.repeat = self.repeat.map(|times| given(f64::from(times))).or(plan.repeat);
        plan.hold_on_overload |= self.hold_on_overload;
        let mut settings = RunSettings::new(&plan, circuit)?;
        if !self.record.is_empty() {
            settings.record = self.recorded(circuit)?;
        }
        Ok(settings)
    }

    /// The signals asked for, and those that the pictures show if they are drawn.
    fn recorded(&self, circuit: &Circuit) -> Result<Vec<String>, Failure> {
        let known: Vec<&str> = circuit.signals().iter().map(|point| point.name.as_str()).collect();
        for name in &self.record {
            if !known.contains(&name.as_str()) {
                let hint = patchcord::patch::suggestion(name, &known).unwrap_or_default();
                return Err(Failure::usage(format!("there is no signal {name} to record; {hint}")));
            }
        }
        let mut record = self.record.clone();
        if self.files.draw() {
            record.extend(circuit.pictured());
        }
        let mut seen = std::collections::HashSet::new();
        record.retain(|name| seen.insert(name.clone()));
        Ok(record)
    }
}

fn readings_table(circuit: &Circuit, trace: &Trace) -> String {
    let title = &circuit.patch().title;
    let mut table = Table::new(["signal", "unit", "start", "end", "least", "at s", "most", "at s"]);
    for reading in instruments::readings(trace) {
        let shown = Display::new(&reading.unit, reading.largest());
        let seconds = Display::new("", 1.0);
        table.row([
            reading.signal.clone(),
            shown.unit.clone(),
            shown.number(reading.start),
            shown.number(reading.end),
            shown.number(reading.least.value),
            seconds.number(reading.least.time),
            shown.number(reading.most.value),
            seconds.number(reading.most.time),
        ]);
    }
    format!("{title}\n{}\n\n{}", parameter_line(circuit), table.text())
}

fn work_told(trace: &Trace) -> String {
    let steps: u64 = trace.sweeps.iter().map(|sweep| sweep.work.steps).sum();
    let changes: u64 = trace.sweeps.iter().map(|sweep| sweep.work.changes).sum();
    let plural = if changes == 1 { "" } else { "s" };
    format!("{steps} steps, {changes} change{plural} of mode\n")
}

fn overloads_told(trace: &Trace) -> String {
    let mut text = String::new();
    for (number, sweep) in trace.sweeps.iter().enumerate() {
        let which = if trace.sweeps.len() > 1 { format!("run {}: ", number + 1) } else { String::new() };
        for overload in &sweep.overloads {
            text += &format!("{which}{}\n", overload_told(overload));
        }
        if sweep.held {
            text += &format!("{which}held at t = {:.6} s\n", sweep.end);
        }
    }
    if text.is_empty() { "no overload\n".to_owned() } else { text }
}

fn overload_told(overload: &Overload) -> String {
    let Overload { element, time, peak, caused_by } = overload;
    let cause = caused_by.as_ref().map_or("first".to_owned(), |cause| format!("caused by {cause}"));
    format!("overload: {element} at t = {time:.6} s, asked for {peak:.1} V ({cause})")
}

fn document(circuit: &Circuit, settings: &RunSettings, trace: &Trace, files: &Files) -> Value {
    json!({
        "ok": true,
        "patch": circuit.patch().file(),
        "title": circuit.patch().title,
        "diagnostics": circuit.warnings().to_json(),
        "parameters": parameters_json(circuit),
        "run": {
            "for": settings.duration,
            "step": settings.step,
            "every": settings.every,
            "repeat": settings.repeat,
            "hold_on_overload": settings.hold_on_overload,
        },
        "samples": trace.len(),
        "readings": instruments::readings(trace).iter().map(reading_json).collect::<Value>(),
        "sweeps": trace.sweeps.iter().map(|sweep| json!({
            "end": sweep.end,
            "steps": sweep.work.steps,
            "changes": sweep.work.changes,
            "held": sweep.held,
            "overloads": sweep.overloads.iter().map(overload_json).collect::<Value>(),
        })).collect::<Value>(),
        "files": files.paths().map(|path| path.display().to_string()).collect::<Value>(),
    })
}

fn reading_json(reading: &Reading) -> Value {
    json!({
        "signal": reading.signal,
        "unit": reading.unit,
        "start": reading.start,
        "end": reading.end,
        "least": {"value": reading.least.value, "t": reading.least.time},
        "most": {"value": reading.most.value, "t": reading.most.time},
    })
}

fn overload_json(overload: &Overload) -> Value {
    json!({
        "element": overload.element,
        "t": overload.time,
        "peak": overload.peak,
        "caused_by": overload.caused_by,
    })
}
