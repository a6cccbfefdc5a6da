//! `patchcord profile`
//!
//! A profile is read from a run in which the commanded velocity rises, or rises and falls again. Five points and four
//! sections describe it. The points are the start of motion, the lower critical velocity, the commands at which cycles
//! with standstill begin and end, and the upper critical velocity.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::criteria::{advice_on, advice_on_cycles};
use super::doubts::eprint_doubts;
use super::failure::Failure;
use super::files::{path_texts, picture_format, write_pictures, written_paragraph};
use super::load::{LoadedPatch, PatchArguments, PatchDocument, heading, title};
use super::numbers::{positive, positive_in};
use super::profile_report::{self, ProfileDocument, ProfileReading};
use super::recording::run_with_progress;
use super::run_report::overloads_text;
use super::step_warning::{StepWarningDocument, step_warning_text};
use super::times::{TimeArguments, run_failure};
use super::{eprint, errors_in_colour, print, print_json};
use patchcord::circuit::Circuit;
use patchcord::document::suggestion;
use patchcord::draw::plot::{Picture, Size};
use patchcord::draw::{ProfileSignal, profile_picture};
use patchcord::format::{QuantityFormat, format_pure_number, format_quantity};
use patchcord::instruments::{
    Criterion, CriticalVelocityError, ProfileCriterion, ProfileError, RampDirection, critical_range,
    parameter_line, signal_faults, velocity_profile,
};
use patchcord::ir::Program;
use patchcord::solve::RunSettings;
use patchcord::trace::{Trace, Track};

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    #[command(flatten)]
    times: TimeArguments,
    /// Names of the signals with the commanded and the actual velocity
    #[arg(long, value_name = "COMMAND,VELOCITY", default_value = "v_i,v_o", value_parser = pair)]
    signals: [String; 2],
    /// Largest change of the velocity within a window, peak to peak, that does not count as oscillation. It is in the
    /// unit of the signals: 0.25e-3 for a patch in m/s (default: 0.25 mm/s)
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true, value_parser = positive)]
    threshold: Option<f64>,
    /// Length of the window, in seconds: at least half a period of the slowest oscillation (default: 0.04)
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = positive_in("s"))]
    window: Option<f64>,
    /// Largest velocity that counts as standstill. It is in the unit of the signals: 0.1e-3 for a patch in m/s
    /// (default: half the threshold)
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true, value_parser = positive)]
    standstill: Option<f64>,
    /// Read the profile while the command falls from its largest value, not while it rises
    #[arg(long)]
    falling: bool,
    /// Draw the profile with its points and sections into this file; the ending of its name selects SVG or PNG
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
}

/// Parses COMMAND,VELOCITY.
fn pair(text: &str) -> Result<[String; 2], String> {
    let names: Vec<_> = text.split(',').map(|name| name.trim().to_owned()).collect();
    let two = <[String; 2]>::try_from(names).ok().filter(|names| names.iter().all(|name| !name.is_empty()));
    two.ok_or_else(|| "must be two names, the commanded and the actual velocity, such as v_i,v_o".to_owned())
}

/// The keys of the document in addition to those of every command on a patch.
#[derive(Serialize)]
struct Document<'a> {
    profile: ProfileDocument<'a>,
    step_warning: Option<StepWarningDocument<'a>>,
    files: Vec<String>,
}

/// Only the two velocities are recorded. The profile is that of the last run, if the patch repeats it.
pub(super) fn profile(arguments: &Arguments) -> Result<(), Failure> {
    let format = arguments.plot.as_deref().map(picture_format).transpose()?;
    let files = || arguments.plot.iter();
    let loaded = arguments.patch.load_for(|plan| arguments.times.plan(plan))?;
    let LoadedPatch { circuit, program, warnings } = loaded;
    let settings = arguments.settings(&circuit, &program)?;
    let outputs = arguments.patch.outputs(&circuit);
    outputs.prepare(None, files())?;
    let trace = run_with_progress("profile", &program, &settings).map_err(|stopped| {
        eprint_doubts(&stopped.trace, &overloads_text(&stopped.trace, errors_in_colour()));
        run_failure(&stopped.error, &circuit, arguments.times.is_cause_of(&stopped.error))
    })?;
    let step_warning = trace.step_warning.as_ref();
    let reading = arguments.read(&trace, &settings.record, &circuit);
    // The JSON document of a failure does not have the warning.
    if let Some(warning) = step_warning.filter(|_| !arguments.patch.json || reading.is_err()) {
        eprint(step_warning_text(warning).trim_end());
    }
    let reading = reading?;
    if let Some((path, format)) = arguments.plot.as_ref().zip(format) {
        write_pictures(&outputs, path, &[picture(&reading, &circuit, &trace)], format, Size::default())?;
    }
    if arguments.patch.json {
        let document = Document {
            profile: ProfileDocument::of(&reading),
            step_warning: step_warning.map(StepWarningDocument::of),
            files: path_texts(files()),
        };
        return print_json(&PatchDocument::new(&circuit, &warnings, document));
    }
    print(&(heading(&circuit) + &profile_report::text(&reading)))?;
    print(&written_paragraph(files()))
}

impl Arguments {
    /// The run settings of the patch, with both velocities recorded.
    ///
    /// # Errors
    /// If the patch does not have the signals, or the times of the run are wrong.
    fn settings(&self, circuit: &Circuit, program: &Program) -> Result<RunSettings, Failure> {
        let settings = self.times.settings(&self.times.plan(circuit.run_plan()), circuit, program);
        let mut settings =
            settings.map_err(|error| run_failure(&error, circuit, self.times.is_cause_of(&error)))?;
        let found = self.signals.iter().map(|name| {
            circuit.recorded_name(name).map(str::to_owned).ok_or_else(|| unknown_signal(name, circuit))
        });
        settings.record = found.collect::<Result<_, _>>()?;
        settings.sensitivities.clear();
        settings.checks_steps = true;
        let checked = settings.check();
        checked.map_err(|error| run_failure(&error, circuit, self.times.is_cause_of(&error)))?;
        Ok(settings)
    }

    /// Reads the profile of the last run from the two recorded velocities.
    ///
    /// # Errors
    /// If the run has no sample, the velocities have different units, or the command does not rise or fall as required.
    fn read(&self, trace: &Trace, recorded: &[String], circuit: &Circuit) -> Result<ProfileReading, Failure> {
        let track = |which: usize| recorded.get(which).and_then(|name| trace.track(name));
        let both = track(0).zip(track(1)).ok_or_else(|| Failure::data("no sample was recorded"));
        let (command, velocity) = both?;
        let criterion = self.criterion(command, velocity)?;
        let first = trace.repetitions.last().map_or(0, |repetition| repetition.first);
        let time = &trace.time[first..];
        let [commands, velocities] =
            [command, velocity].map(|track| track.values().skip(first).collect::<Vec<_>>());
        let direction = self.direction();
        let profile = velocity_profile(time, &commands, &velocities, criterion, direction);
        let range = critical_range(time, &commands, &velocities, criterion.oscillation);
        let [range, other] = direction.select([[range.rising, range.falling], [range.falling, range.rising]]);
        let profile = profile.map_err(|error| {
            let advice = self.advice(error, circuit, other.err(), &command.unit);
            let advice = advice.map_or_else(String::new, |advice| format!(": {advice}"));
            Failure::data(format!("no velocity profile: {}{advice}", error.message_in(&command.unit)))
        })?;
        let early = || early_end_note(time, &commands, criterion.standstill, &command.unit);
        Ok(ProfileReading {
            names: [command.name.clone(), velocity.name.clone()],
            unit: command.unit.clone(),
            range: range.ok(),
            note: self.falling.then(early).flatten(),
            values: [commands, velocities],
            criterion,
            profile,
        })
    }

    /// The criterion from the options and their defaults.
    ///
    /// The default threshold is 0.25 mm/s. It exists for velocities only, so other units need the option.
    fn criterion(&self, command: &Track, velocity: &Track) -> Result<ProfileCriterion, Failure> {
        if command.unit != velocity.unit {
            let signal = |track: &Track| format!("{} in {}", track.name, track.unit);
            let message = format!("{} and {} do not have the same unit", signal(command), signal(velocity));
            return Err(Failure::usage(message));
        }
        let usual = Criterion::usual(&command.unit);
        let threshold = self.threshold.or(usual.map(|usual| usual.threshold)).ok_or_else(|| {
            Failure::usage(format!(
                "{} in {} is not a velocity: give --threshold VALUE",
                command.name, command.unit
            ))
        })?;
        let window = self.window.unwrap_or(Criterion::USUAL.window);
        let usual = ProfileCriterion::usual(Criterion { threshold, window });
        Ok(ProfileCriterion { standstill: self.standstill.unwrap_or(usual.standstill), ..usual })
    }

    /// The ramp that is read.
    fn direction(&self) -> RampDirection {
        if self.falling { RampDirection::Falling } else { RampDirection::Rising }
    }

    /// The options that help if there is no profile. `other` is why the other ramp has no critical velocity.
    fn advice(
        &self,
        error: ProfileError,
        circuit: &Circuit,
        other: Option<CriticalVelocityError>,
        unit: &str,
    ) -> Option<String> {
        use CriticalVelocityError::{Constant, NeverBack, NoFall, NoRise};
        let has_turn = circuit.parameters().any(|(name, ..)| name == TURN);
        let has_other = !matches!(other, Some(Constant | NeverBack | NoFall | NoRise));
        let advice = match error {
            ProfileError::Unreadable(NoRise) if has_other => "use --falling for a command that falls",
            ProfileError::Unreadable(NoFall) if has_other => "remove --falling for a command that rises",
            ProfileError::Unreadable(NeverBack) if has_turn => {
                "make it turn with --set v_turn=SECONDS, and run twice as long with --for"
            }
            ProfileError::Unreadable(NeverBack) => "give a longer --for, or remove --falling",
            ProfileError::Unreadable(error) => return advice_on(&error, "a slower command"),
            ProfileError::Cycles(error) => return advice_on_cycles(&error),
            ProfileError::Motionless { .. } => return Some(self.advice_on_standstill(unit)),
            _ => return None,
        };
        Some(advice.to_owned())
    }

    /// A lower standstill or threshold.
    ///
    /// The option that the user has given is named, otherwise the threshold, from which the standstill follows.
    fn advice_on_standstill(&self, unit: &str) -> String {
        let usual = Criterion::usual(unit).map(ProfileCriterion::usual);
        let (option, usual) = match self.standstill {
            Some(_) => ("--standstill", usual.map(|usual| usual.standstill)),
            None => ("--threshold", usual.map(|usual| usual.oscillation.threshold)),
        };
        let example = usual
            .map_or_else(String::new, |usual| format!(", such as {option} {}", format_pure_number(usual)));
        format!("give a lower value, in {unit}{example}")
    }
}

/// The parameter of the thesis's circuits that specifies when the command turns back.
const TURN: &str = "v_turn";

/// A note if the run ends before the command has returned to 0, with the length that the run needs. None otherwise.
fn early_end_note(time: &[f64], command: &[f64], standstill: f64, unit: &str) -> Option<String> {
    let (&[.., before, end], &[begin, .., earlier, last]) = (command, time) else { return None };
    let largest = command.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let turn = command.iter().position(|value| value.abs() == largest)?;
    if end.abs() <= standstill || command[turn..].iter().any(|value| value * end <= 0.0) {
        return None;
    }
    let remaining = end / (before - end) * (last - earlier);
    let format = QuantityFormat::new(unit, end);
    let note = format!("the run ends at {}, before the command is back at 0", format.text(end));
    let advice = format!(": give --for {}", format_pure_number(last + remaining - begin));
    Some(if remaining.is_finite() && remaining > 0.0 { note + &advice } else { note })
}

/// The picture of the profile.
///
/// The note has the parameters of the patch, so that the picture is complete by itself. If an overload makes one of the
/// velocities wrong, a warning says from when.
fn picture(reading: &ProfileReading, circuit: &Circuit, trace: &Trace) -> Picture {
    let drawn = |which: usize| ProfileSignal {
        name: &reading.names[which],
        unit: &reading.unit,
        values: &reading.values[which],
    };
    let what = reading.profile.direction.select(["velocity profile", "command falling"]);
    let title = format!("{}: {what}", title(circuit));
    let note = parameter_line(circuit);
    let picture = profile_picture(title, drawn(0), drawn(1), &reading.profile, Some(&note));
    Picture { warning: overload_warning(circuit, trace), ..picture }
}

/// The first overload that makes the recorded signals of the last run wrong. None if there is none.
fn overload_warning(circuit: &Circuit, trace: &Trace) -> Option<String> {
    let last_run = trace.repetitions.len().saturating_sub(1);
    let faults = signal_faults(circuit, trace).into_iter().filter(|fault| fault.repetition == last_run);
    let first = faults.min_by(|one, other| one.time.total_cmp(&other.time))?;
    let time = format_quantity(first.time, "s");
    Some(format!("{} from {time}: the curve is wrong from there on", first.cause))
}

/// The failure for an unknown signal.
fn unknown_signal(name: &str, circuit: &Circuit) -> Failure {
    let known: Vec<&str> = circuit.signals().iter().map(|signal| signal.name.as_str()).collect();
    let hint = suggestion(name, &known).unwrap_or_else(|| "it has none".to_owned());
    Failure::usage(format!("the patch has no signal {name}: give --signals COMMAND,VELOCITY; {hint}"))
}
