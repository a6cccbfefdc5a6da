//! `patchcord run`

use clap::Args;
use serde_json::{Value, json};

use super::failure::{Failure, plural};
use super::files::{FileArguments, Files};
use super::load::{Loaded, PatchArguments, document};
use super::overloads::{overload_json, overload_told};
use super::phases::{phase_told, phases_json, phases_told};
use super::progress::Progress;
use super::readings::{readings_json, readings_told, sensitivities_json};
use super::times::{TimeArguments, given, place_told, refused, times_json, with_advice};
use super::{say, say_json};
use patchcord::circuit::Circuit;
use patchcord::document::suggestion;
use patchcord::instruments::parameter_line;
use patchcord::ir::Program;
use patchcord::patch::RunPlan;
use patchcord::solve::{self, RunError, RunSettings, Stopped};
use patchcord::trace::{Trace, Work};

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    #[command(flatten)]
    times: TimeArguments,
    /// Run this many times from initial condition (repetitive operation)
    #[arg(long, value_name = "TIMES", allow_negative_numbers = true, value_parser = times)]
    repeat: Option<u32>,
    /// Go into hold as soon as an overload lamp lights
    #[arg(long)]
    hold_on_overload: bool,
    /// Record these signals, drives or elements instead of those that the patch names
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = name)]
    record: Vec<String>,
    /// Record the derivatives of all these signals by these parameters too, and tell which matters
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = name)]
    sensitivity: Vec<String>,
    #[command(flatten)]
    files: FileArguments,
}

fn times(text: &str) -> Result<u32, String> {
    let times = text.parse().ok().filter(|times| *times > 0);
    times.ok_or_else(|| format!("a whole number from 1 to {} is wanted", u32::MAX))
}

fn name(text: &str) -> Result<String, String> {
    let name = text.trim();
    if name.is_empty() { Err("a name is missing".to_owned()) } else { Ok(name.to_owned()) }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    carry_out(arguments).map_err(|failure| failure.told_as_json(arguments.patch.json))
}

fn carry_out(arguments: &Arguments) -> Result<(), Failure> {
    let files = arguments.files.files(&arguments.patch.patch)?;
    let Loaded { circuit, program } = arguments.patch.load()?;
    let settings = arguments.settings(&circuit)?;
    files.prepare()?;
    let trace = match watched(&program, &settings) {
        Ok(trace) => trace,
        Err(stopped) => return Err(arguments.stopped(*stopped, &files, &circuit)),
    };
    files.write(&trace, &circuit)?;
    if arguments.patch.json {
        return say_json(&run_document(&circuit, &settings, &trace, &files));
    }
    let head = format!("{}\n{}\n\n", circuit.patch().title, parameter_line(&circuit));
    say(&(head + &readings_told(&trace)))?;
    say(&phases_told(&trace))?;
    say(&format!("\n{}{}", work_told(&trace), overloads_told(&trace)))?;
    say(&files.told())
}

/// Runs with a bar at a terminal.
pub(super) fn watched(program: &Program, settings: &RunSettings) -> Result<Trace, Box<Stopped>> {
    let mut progress = Progress::new(settings.whole());
    let outcome = solve::run_watched(program, settings, &mut |time| {
        if let Some(progress) = &mut progress {
            progress.step(time);
        }
    });
    outcome.map_err(Box::new)
}

impl Arguments {
    fn settings(&self, circuit: &Circuit) -> Result<RunSettings, Failure> {
        let plan = self.plan(circuit.run_plan())?;
        let settings = self.times.settings(&plan, circuit);
        let mut settings = settings.map_err(|error| self.refused(&error, circuit))?;
        if !self.record.is_empty() {
            settings.record = self.recorded(circuit)?;
        }
        settings.sensitivities = self.parameters(circuit)?;
        settings.check().map_err(|error| self.refused(&error, circuit))?;
        Ok(settings)
    }

    /// The patch's plan with what the options change in it.
    fn plan(&self, patch: &RunPlan) -> Result<RunPlan, Failure> {
        let mut plan = self.times.plan(patch);
        if self.repeat.is_some() && !plan.phases.is_empty() {
            let message = "the patch's run is a list of phases, which --repeat cannot repeat: write \
                           {\"repeat\": times, \"phases\": [...]} there, or give --for as well to run without them";
            return Err(Failure::usage(message));
        }
        plan.repeat = self.repeat.map(|times| given(f64::from(times))).or(plan.repeat);
        plan.hold_on_overload |= self.hold_on_overload;
        Ok(plan)
    }

    fn refused(&self, error: &RunError, circuit: &Circuit) -> Failure {
        refused(error, circuit, self.is_to_blame(error))
    }

    /// Whether an error comes from options rather than from the patch.
    fn is_to_blame(&self, error: &RunError) -> bool {
        let own = match error {
            RunError::TooManySteps { .. } => self.repeat.is_some(),
            RunError::TooManyNumbers { .. } => {
                self.repeat.is_some() || !self.record.is_empty() || !self.sensitivity.is_empty()
            }
            RunError::NoDerivative { .. } => true,
            _ => false,
        };
        own || self.times.is_to_blame(error)
    }

    /// Writes what was recorded before the run stopped, and tells why it did.
    fn stopped(&self, stopped: Stopped, files: &Files, circuit: &Circuit) -> Failure {
        let Some(last) = stopped.trace.time.last() else { return self.refused(&stopped.error, circuit) };
        let (phase, place) = (phase_told(&stopped.trace), place_told(&stopped.error, circuit));
        let failure = |more: &str| {
            let message = format!("{phase}{}{place}{more}", with_advice(&stopped.error));
            Failure::data(message).with("code", stopped.error.code().into())
        };
        if files.paths().next().is_none() {
            return failure("");
        }
        if let Err(unwritten) = files.write(&stopped.trace, circuit) {
            unwritten.tell();
            return failure("");
        }
        failure(&format!("\nthe files hold the run up to t = {last} s"))
            .with("recorded_until", (*last).into())
            .with("files", files.json())
    }

    /// The signals asked for, and those that the pictures show if they are drawn.
    fn recorded(&self, circuit: &Circuit) -> Result<Vec<String>, Failure> {
        let found =
            |name: &String| circuit.recordable(name).map(str::to_owned).ok_or_else(|| missing(name, circuit));
        let mut record = self.record.iter().map(found).collect::<Result<Vec<_>, _>>()?;
        if self.files.draw() {
            record.extend(circuit.pictured());
        }
        Ok(once(record))
    }

    /// The parameters by which to differentiate, and those of the pictures if they are drawn.
    fn parameters(&self, circuit: &Circuit) -> Result<Vec<String>, Failure> {
        let known: Vec<&str> = circuit.parameters().map(|(name, ..)| name).collect();
        match self.sensitivity.iter().find(|name| !known.contains(&name.as_str())) {
            None => {
                let shown = if self.record.is_empty() || self.files.draw() {
                    circuit.differentiated()
                } else {
                    vec![]
                };
                Ok(once(self.sensitivity.iter().cloned().chain(shown).collect()))
            }
            Some(name) => {
                let hint = suggestion(name, &known).unwrap_or_else(|| "the patch has none".to_owned());
                Err(Failure::usage(format!("there is no parameter {name} to differentiate by; {hint}")))
            }
        }
    }
}

/// Every name once, in the order of their first appearance.
fn once(mut names: Vec<String>) -> Vec<String> {
    let mut seen = std::collections::HashSet::new();
    names.retain(|name| seen.insert(name.clone()));
    names
}

fn missing(name: &str, circuit: &Circuit) -> Failure {
    let known: Vec<&str> = circuit.signals().iter().map(|point| point.name.as_str()).collect();
    let hint = suggestion(name, &known).unwrap_or_else(|| "name a drive or an element".to_owned());
    Failure::usage(format!("there is no signal {name} to record; {hint}"))
}

fn work_told(trace: &Trace) -> String {
    let total = |count: fn(&Work) -> u64| trace.sweeps.iter().map(|sweep| count(&sweep.work)).sum::<u64>();
    let rejected = match total(|work| work.rejections) {
        0 => String::new(),
        rejections => format!(" ({rejections} more tried too long)"),
    };
    let [steps, switchings, kinks, evaluations] = [
        plural(total(|work| work.steps), "step"),
        plural(total(|work| work.changes), "switching"),
        plural(total(|work| work.crossings), "kink"),
        plural(total(|work| work.evaluations), "evaluation"),
    ];
    format!("{steps}{rejected}, {switchings}, {kinks}, {evaluations}\n")
}

fn overloads_told(trace: &Trace) -> String {
    let mut text = String::new();
    for (number, sweep) in trace.sweeps.iter().enumerate() {
        let which = if trace.sweeps.len() > 1 { format!("run {}: ", number + 1) } else { String::new() };
        for (order, overload) in sweep.overloads.iter().enumerate() {
            text += &format!("{which}{}\n", overload_told(order, overload));
        }
        if sweep.held {
            text += &format!("{which}held at t = {:.6} s\n", sweep.end);
        }
    }
    if text.is_empty() { "no overload\n".to_owned() } else { text }
}

fn run_document(circuit: &Circuit, settings: &RunSettings, trace: &Trace, files: &Files) -> Value {
    let mut run = times_json(settings);
    run["repeat"] = trace.sweeps.len().into();
    run["hold_on_overload"] = settings.hold_on_overload.into();
    let more = json!({
        "run": run,
        "samples": trace.len(),
        "readings": readings_json(trace),
        "sensitivities": sensitivities_json(trace),
        "sweeps": trace.sweeps.iter().map(|sweep| json!({
            "end": sweep.end,
            "steps": sweep.work.steps,
            "switchings": sweep.work.changes,
            "kinks": sweep.work.crossings,
            "rejections": sweep.work.rejections,
            "evaluations": sweep.work.evaluations,
            "held": sweep.held,
            "overloads": sweep.overloads.iter().map(overload_json).collect::<Value>(),
        })).collect::<Value>(),
        "phases": phases_json(trace),
        "files": files.json(),
    });
    document(circuit, more)
}
