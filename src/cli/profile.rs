//! `patchcord profile`

use std::path::PathBuf;

use clap::Args;

use super::criteria::{advice_on, advice_on_cycles};
use super::failure::Failure;
use super::files::{check_apart, prepare, put, written};
use super::load::{Loaded, PatchArguments, document};
use super::numbers::above_zero;
use super::profile_report::{self, Read};
use super::run::watched;
use super::times::{TimeArguments, refused};
use super::{say, say_json};
use patchcord::circuit::Circuit;
use patchcord::document::suggestion;
use patchcord::draw::plot::{self, Format, Size};
use patchcord::draw::{Drawn, profile_picture};
use patchcord::instruments::{
    Criterion, Display, NoCriticalVelocity, ProfileCriterion, ProfileError, Way, critical_range,
    parameter_line, velocity_profile,
};
use patchcord::solve::RunSettings;
use patchcord::trace::{Trace, Track};

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    #[command(flatten)]
    times: TimeArguments,
    /// The commanded and the actual velocity
    #[arg(long, value_name = "COMMAND,VELOCITY", default_value = "v_i,v_o", value_parser = pair)]
    signals: [String; 2],
    /// It oscillates while the velocity swings by more than this, peak to peak, in the unit of the signals: 0.25e-3 for a patch in m/s
    /// (without it: 0.25 mm/s)
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true, value_parser = above_zero)]
    threshold: Option<f64>,
    /// ... within so many seconds (0.04): half a period and more of the slowest oscillation
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = above_zero)]
    window: Option<f64>,
    /// A velocity up to this is standstill, in the unit of the signals: 0.1e-3 for a patch in m/s (without it: half of the threshold)
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true, value_parser = above_zero)]
    standstill: Option<f64>,
    /// Read the way back, on which the command falls from its largest value
    #[arg(long)]
    falling: bool,
    /// Draw the profile with its points and sections; SVG or PNG by the name of the file
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
}

fn pair(text: &str) -> Result<[String; 2], String> {
    let names: Vec<_> = text.split(',').map(|name| name.trim().to_owned()).collect();
    let two = <[String; 2]>::try_from(names).ok().filter(|names| names.iter().all(|name| !name.is_empty()));
    two.ok_or_else(|| {
        "two names are wanted, the commanded and the actual velocity, such as v_i,v_o".to_owned()
    })
}

pub(super) fn profile(arguments: &Arguments) -> Result<(), Failure> {
    carry_out(arguments).map_err(|failure| failure.told_as_json(arguments.patch.json))
}

fn carry_out(arguments: &Arguments) -> Result<(), Failure> {
    let format = arguments.plot.as_ref().map(|path| Format::from_path(path)).transpose();
    let format = format.map_err(|error| Failure::usage(error.to_string()))?;
    let files = || arguments.plot.iter();
    check_apart(&arguments.patch.patch, files())?;
    let Loaded { circuit, program } = arguments.patch.load()?;
    let settings = arguments.settings(&circuit)?;
    prepare(None, files())?;
    let trace = watched(&program, &settings)
        .map_err(|stopped| refused(&stopped.error, &circuit, arguments.times.is_to_blame(&stopped.error)))?;
    let read = arguments.read(&trace, &settings.record, &circuit)?;
    if let Some((path, format)) = arguments.plot.as_ref().zip(format) {
        let picture = picture(&read, &circuit);
        let bytes = plot::render(&[picture], format, Size::default());
        put(path, &bytes.map_err(|error| Failure::data(error.to_string()))?)?;
    }
    if arguments.patch.json {
        let mut more = profile_report::json(&read);
        more["files"] = files().map(|path| path.display().to_string()).collect();
        return say_json(&document(&circuit, more));
    }
    let head = format!("{}\n{}\n\n", circuit.patch().title, parameter_line(&circuit));
    say(&(head + &profile_report::told(&read)))?;
    let told = written(files());
    say(&if told.is_empty() { told } else { format!("\n{told}") })
}

impl Arguments {
    /// The run of the patch, recording both velocities.
    fn settings(&self, circuit: &Circuit) -> Result<RunSettings, Failure> {
        let settings = self.times.settings(&self.times.plan(circuit.run_plan()), circuit);
        let mut settings =
            settings.map_err(|error| refused(&error, circuit, self.times.is_to_blame(&error)))?;
        let found = self
            .signals
            .iter()
            .map(|name| circuit.recordable(name).map(str::to_owned).ok_or_else(|| missing(name, circuit)));
        settings.record = found.collect::<Result<_, _>>()?;
        settings.sensitivities.clear();
        let checked = settings.check();
        checked.map_err(|error| refused(&error, circuit, self.times.is_to_blame(&error)))?;
        Ok(settings)
    }

    /// The profile of the last run, of the command and the velocity that were recorded.
    fn read(&self, trace: &Trace, recorded: &[String], circuit: &Circuit) -> Result<Read, Failure> {
        let track = |which: usize| recorded.get(which).and_then(|name| trace.track(name));
        let both = track(0).zip(track(1)).ok_or_else(|| Failure::data("nothing was recorded"));
        let (command, velocity) = both?;
        let criterion = self.criterion(command, velocity)?;
        let first = trace.sweeps.last().map_or(0, |sweep| sweep.first);
        let time = &trace.time[first..];
        let [commands, velocities] =
            [command, velocity].map(|track| track.values().skip(first).collect::<Vec<_>>());
        let profile = velocity_profile(time, &commands, &velocities, criterion, self.way());
        let range = critical_range(time, &commands, &velocities, criterion.oscillation);
        let [range, other] = self.way().of([[range.rising, range.falling], [range.falling, range.rising]]);
        let profile = profile.map_err(|error| {
            let advice = self.advice(error, circuit, other.err(), &command.unit);
            let advice = advice.map_or_else(String::new, |advice| format!(": {advice}"));
            Failure::data(format!("no velocity profile: {}{advice}", error.told_in(&command.unit)))
        })?;
        let early = || ends_early(time, &commands, criterion.standstill, &command.unit);
        Ok(Read {
            names: [command.name.clone(), velocity.name.clone()],
            unit: command.unit.clone(),
            range: range.ok(),
            note: self.falling.then(early).flatten(),
            values: [commands, velocities],
            criterion,
            profile,
        })
    }

    fn criterion(&self, command: &Track, velocity: &Track) -> Result<ProfileCriterion, Failure> {
        if command.unit != velocity.unit {
            let told = |track: &Track| format!("{} in {}", track.name, track.unit);
            let message = format!("{} and {} are not in the same unit", told(command), told(velocity));
            return Err(Failure::usage(message));
        }
        let usual = Criterion::usual(&command.unit);
        let threshold = self.threshold.or(usual.map(|usual| usual.threshold)).ok_or_else(|| {
            Failure::usage(format!(
                "{} is in {}, no velocity: give --threshold VALUE",
                command.name, command.unit
            ))
        })?;
        let window = self.window.unwrap_or(Criterion::USUAL.window);
        let usual = ProfileCriterion::usual(Criterion { threshold, window });
        Ok(ProfileCriterion { standstill: self.standstill.unwrap_or(usual.standstill), ..usual })
    }

    fn way(&self) -> Way {
        if self.falling { Way::Falling } else { Way::Rising }
    }

    /// The options that help where there is no profile; `other` is why there is none the other way.
    fn advice(
        &self,
        error: ProfileError,
        circuit: &Circuit,
        other: Option<NoCriticalVelocity>,
        unit: &str,
    ) -> Option<String> {
        use NoCriticalVelocity::{Constant, NeverBack, NoFall, NoRise};
        let turns = circuit.parameters().any(|(name, ..)| name == TURN);
        let is_there_other = !matches!(other, Some(Constant | NeverBack | NoFall | NoRise));
        let advice = match error {
            ProfileError::Unreadable(NoRise) if is_there_other => "--falling reads one that falls",
            ProfileError::Unreadable(NoFall) if is_there_other => "without --falling one is read that rises",
            ProfileError::Unreadable(NeverBack) if turns => {
                "let it turn with --set v_turn=SECONDS, and run for twice as long with --for"
            }
            ProfileError::Unreadable(NeverBack) => "run for longer with --for, or read it without --falling",
            ProfileError::Unreadable(why) => return advice_on(&why, "a slower command"),
            ProfileError::Cycles(why) => return advice_on_cycles(&why),
            ProfileError::StandsStill { .. } => return Some(self.advice_on_standstill(unit)),
            ProfileError::BadStandstill(_) => return None,
        };
        Some(advice.to_owned())
    }

    fn advice_on_standstill(&self, unit: &str) -> String {
        let usual = Criterion::usual(unit).map(ProfileCriterion::usual);
        let (option, usual) = match self.standstill {
            Some(_) => ("--standstill", usual.map(|usual| usual.standstill)),
            None => ("--threshold", usual.map(|usual| usual.oscillation.threshold)),
        };
        let such = usual.map_or_else(String::new, |usual| {
            format!(", such as {option} {}", Display::new("", 1.0).number(usual))
        });
        format!("give a lower one, in {unit}{such}")
    }
}

/// The parameter of the study's circuits that tells when the command turns back.
const TURN: &str = "v_turn";

/// That the run ends before the command has come back to 0, and how long it would have to be.
fn ends_early(time: &[f64], command: &[f64], standstill: f64, unit: &str) -> Option<String> {
    let (&[.., before, end], &[begin, .., earlier, last]) = (command, time) else { return None };
    let largest = command.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let turn = command.iter().position(|value| value.abs() == largest)?;
    if end.abs() <= standstill || command[turn..].iter().any(|value| value * end <= 0.0) {
        return None;
    }
    let left = end / (before - end) * (last - earlier);
    let shown = Display::new(unit, end);
    let told = format!("the run ends at {}, before the command is back at 0", shown.text(end));
    let advice = format!(": give --for {}", Display::new("", 1.0).number(last + left - begin));
    Some(if left.is_finite() && left > 0.0 { told + &advice } else { told })
}

fn picture(read: &Read, circuit: &Circuit) -> plot::Picture {
    let drawn =
        |which: usize| Drawn { name: &read.names[which], unit: &read.unit, values: &read.values[which] };
    let what = read.profile.way.of(["velocity profile", "command falling"]);
    let title = format!("{}: {what}", circuit.patch().title);
    profile_picture(title, drawn(0), drawn(1), &read.profile, Some(parameter_line(circuit)))
}

fn missing(name: &str, circuit: &Circuit) -> Failure {
    let known: Vec<&str> = circuit.signals().iter().map(|point| point.name.as_str()).collect();
    let hint = suggestion(name, &known).unwrap_or_else(|| "it has none".to_owned());
    Failure::usage(format!("the patch has no signal {name}: give --signals COMMAND,VELOCITY; {hint}"))
}
