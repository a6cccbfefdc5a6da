//! `patchcord sweep`

use std::path::{Path, PathBuf};
use std::{io, thread};

use clap::Args;
use serde_json::{Value, json};

use super::failure::{Failure, plural};
use super::files::{check_apart, prepare, written};
use super::load::{Loaded, PatchArguments, document};
use super::numbers::threads;
use super::progress::Bar;
use super::times::{TimeArguments, refused, times_json};
use super::{say, say_json, tell};
use patchcord::circuit::Circuit;
use patchcord::instruments::{Column, Measure, measures};
use patchcord::ir::Program;
use patchcord::output::destination;
use patchcord::sweep::{Axis, JournalError, Plan, PlanError, Sweep, SweepError, Tally};

#[derive(Args)]
#[command(after_help = measures_told())]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    /// Vary a parameter, in the unit that the patch declares: NAME=FIRST:LAST:COUNT, the same with :log behind it, or
    /// NAME=VALUE,VALUE,...; of several every combination is run, the last changing from run to run
    #[arg(long, value_name = "NAME=VALUES")]
    vary: Vec<String>,
    /// Take settings row by row from a CSV file with the names of parameters in its first line
    #[arg(long, value_name = "FILE.csv")]
    rows: Option<PathBuf>,
    /// Measure this of every run; may be given several times
    #[arg(long, value_name = "MEASURE")]
    measure: Vec<String>,
    #[command(flatten)]
    times: TimeArguments,
    /// How many runs are made at the same time; as many as there are cores where it is not given
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true, value_parser = threads)]
    threads: Option<usize>,
    /// Append the rows to this CSV file; a sweep that was killed goes on where it was
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

fn measures_told() -> String {
    let told = measures().map(|(written, meaning)| format!("  {written}\n      {meaning}\n"));
    format!("Measures:\n{}", told.collect::<String>())
}

pub(super) fn sweep(arguments: &Arguments) -> Result<(), Failure> {
    carry_out(arguments).map_err(|failure| failure.told_as_json(arguments.patch.json))
}

fn carry_out(arguments: &Arguments) -> Result<(), Failure> {
    arguments.check_files()?;
    let axes = arguments.vary.iter().map(|text| Axis::parse(text)).collect::<Result<Vec<_>, _>>();
    let axes = axes.map_err(unplanned)?;
    let Loaded { circuit, program } = arguments.patch.load()?;
    let sweep = arguments.sweep(axes, &circuit, program)?;
    let (mut progress, runs) = (Bar::new("runs"), sweep.plan().runs());
    let mut progress = |done| {
        if let Some(progress) = &mut progress {
            progress.done(done, runs);
        }
    };
    let Some(out) = &arguments.out else {
        return told_on_output(sweep.write(&mut io::stdout().lock(), arguments.threads(), &mut progress));
    };
    prepare(None, [out].into_iter())?;
    let tally = sweep.append_to(out, arguments.threads(), &mut progress).map_err(not_gone_on)?;
    if arguments.patch.json {
        return say_json(&arguments.document(&circuit, &sweep, tally, out));
    }
    say(&format!("{}{}", tally_told(tally), written([out].into_iter())))
}

impl Arguments {
    fn check_files(&self) -> Result<(), Failure> {
        let Some(out) = &self.out else {
            let message = "with --json the rows need a file of their own: give --out FILE";
            return if self.patch.json { Err(Failure::usage(message)) } else { Ok(()) };
        };
        check_apart(&self.patch.patch, [out].into_iter())?;
        let is_out =
            |rows: &PathBuf| destination(rows).ok().zip(destination(out).ok()).is_some_and(|(a, b)| a == b);
        if self.rows.as_ref().is_some_and(is_out) {
            return Err(Failure::usage(format!("{} holds the settings to run", out.display())));
        }
        Ok(())
    }

    fn sweep(&self, axes: Vec<Axis>, circuit: &Circuit, program: Program) -> Result<Sweep, Failure> {
        let rows = self.rows.iter().map(|path| Axis::read(path, &program)).collect::<Result<Vec<_>, _>>();
        // Rows of a file change most slowly.
        let axes = rows.map_err(unplanned)?.into_iter().chain(axes).collect();
        let plan = Plan::new(axes, &program).map_err(unplanned)?;
        if let Some((name, _)) = self.patch.set.iter().find(|(set, _)| plan.names().any(|name| name == set)) {
            return Err(Failure::usage(format!("{name} is set and varied: leave out --set {name}=...")));
        }
        let measures = self.measure.iter().map(|text| Measure::parse(text, program.signals()));
        let measures = measures.collect::<Result<Vec<_>, _>>();
        let measures = measures.map_err(|error| Failure::usage(error.to_string()))?;
        let settings = self.times.settings(&self.times.plan(circuit.run_plan()), circuit);
        let settings = settings.map_err(|error| refused(&error, circuit, self.times.is_to_blame(&error)))?;
        Sweep::new(circuit.patch(), program, settings, plan, measures)
            .map_err(|error| self.unmade(error, circuit))
    }

    fn unmade(&self, error: SweepError, circuit: &Circuit) -> Failure {
        match error {
            SweepError::Run(error) => refused(&error, circuit, self.times.is_to_blame(&error)),
            SweepError::NoMeasure => {
                Failure::usage(format!("{error}: give --measure MEASURE\n\n{}", measures_told().trim_end()))
            }
            SweepError::Phases(_) => Failure::usage(format!(
                "{error}: measure voltmeter, peak, least or most, or give --for to run without phases"
            )),
            SweepError::SameColumn(_) => Failure::usage(error.to_string()),
        }
    }

    fn document(&self, circuit: &Circuit, sweep: &Sweep, tally: Tally, out: &Path) -> Value {
        let column = |column: Column| json!({"name": column.name, "unit": column.unit});
        let more = json!({
            "run": times_json(sweep.settings()),
            "sweep": {
                "vary": sweep.plan().texts(),
                "columns": sweep.columns().into_iter().map(column).collect::<Value>(),
                "runs": sweep.plan().runs(),
                "threads": self.threads(),
                "kept": tally.kept,
                "written": tally.written,
                "failed": tally.failed,
                "noted": tally.noted,
            },
            "files": [out.display().to_string()],
        });
        document(circuit, more)
    }

    fn threads(&self) -> usize {
        self.threads.unwrap_or_else(|| thread::available_parallelism().map_or(1, usize::from))
    }
}

/// A file of rows is data, everything else stands on the command line.
fn unplanned(error: PlanError) -> Failure {
    match error {
        PlanError::Rows { .. } | PlanError::Unread { .. } => Failure::data(error.to_string()),
        PlanError::Nothing => {
            Failure::usage("nothing is varied: give --vary NAME=FIRST:LAST:COUNT or --rows FILE.csv")
        }
        error => Failure::usage(error.to_string()),
    }
}

fn not_gone_on(error: JournalError) -> Failure {
    Failure::data(error.to_string())
}

/// Rows on standard output are followed by nothing there. A reader that has gone away is no error of ours.
fn told_on_output(outcome: io::Result<Tally>) -> Result<(), Failure> {
    match outcome {
        Ok(tally) if tally.failed > 0 => tell(tally_told(tally).trim_end()),
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            return Err(Failure::data(format!("cannot write to standard output: {error}")));
        }
        _ => (),
    }
    Ok(())
}

fn tally_told(tally: Tally) -> String {
    let of_which = match tally.kept {
        0 => ":".to_owned(),
        kept => format!(", {kept} more were there; of all"),
    };
    let Tally { failed, noted, .. } = tally;
    format!("{}{of_which} {failed} failed, {noted} with a note\n", plural(tally.written, "run"))
}
