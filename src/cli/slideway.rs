//! `patchcord slideway`

use std::path::PathBuf;

use clap::Args;

use super::criteria::advice_on;
use super::failure::Failure;
use super::files::{places, prepare, put, written};
use super::load::setting;
use super::numbers::above_zero;
use super::progress::Bar;
use super::slideway_report::{self as report, criterion_told, number};
use super::times::{FinenessArguments, with_advice};
use super::{say, say_json};
use patchcord::draw::plot::{self, Format, Size};
use patchcord::instruments::parameter_line;
use patchcord::solve::RunError;
use patchcord::thesis::chain::{Chain, ChainError, Input, Inputs, Settings, pictures};
use patchcord::thesis::slideway::ridge::Ridge;
use patchcord::thesis::slideway::units::{CM2, KGF, MM_PER_S, N_PER_MM, POISE, UM};

#[derive(Args)]
pub(super) struct Arguments {
    /// Viscosity of the oil, in poise (1 P = 0.1 Pa s)
    #[arg(long, value_name = "P", allow_hyphen_values = true, value_parser = above_zero)]
    oil: f64,
    /// The oil has a polar additive
    #[arg(long)]
    polar: bool,
    /// Weight of the table, in kgf (what so many kg weigh)
    #[arg(long, value_name = "KGF", allow_hyphen_values = true, value_parser = above_zero)]
    weight: f64,
    /// Stiffness of the drive, in kN/mm (= MN/m)
    #[arg(long, value_name = "KN/MM", allow_hyphen_values = true, value_parser = above_zero)]
    stiffness: f64,
    /// Apparent area of the slides, in cm2
    #[arg(long, value_name = "CM2", default_value = "697", allow_hyphen_values = true, value_parser = above_zero)]
    area: f64,
    /// Width B of the ridges of its ground surfaces, in um
    #[arg(long, value_name = "UM", default_value = "50", allow_hyphen_values = true, value_parser = above_zero)]
    ridge_width: f64,
    /// Height Z of the ridges, in um
    #[arg(long, value_name = "UM", default_value = "2.5", allow_hyphen_values = true, value_parser = above_zero)]
    ridge_height: f64,
    /// Set a parameter of the circuit of Fig 8.16 (M, K, f, Fs, VcL, Tc, v_start, v_rate, v_turn, x_step), in SI units, whatever the chain
    /// gives it; may be given several times
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    set: Vec<(String, f64)>,
    /// By how many percent every advice changes its quantity
    #[arg(long = "by", value_name = "PERCENT", default_value = "10", allow_hyphen_values = true, value_parser = percent)]
    percent: f64,
    /// Velocity counts as oscillating where it swings by more, peak to peak, in mm/s ...
    #[arg(long, value_name = "MM/S", default_value = "0.25", allow_hyphen_values = true, value_parser = above_zero)]
    threshold: f64,
    /// ... within this time, in s (without it: 0.04, or the period of the table on its drive if that is longer)
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = above_zero)]
    window: Option<f64>,
    #[command(flatten)]
    fineness: FinenessArguments,
    /// Draw the velocity profile; SVG or PNG by the name of the file
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Write the circuit as a patch: `patchcord run` makes the same run of it
    #[arg(long, value_name = "FILE.json")]
    out: Option<PathBuf>,
    /// Print one JSON document on standard output, in SI units, and nothing else there
    #[arg(long)]
    json: bool,
}

fn percent(text: &str) -> Result<f64, String> {
    let percent = above_zero(text)?;
    if percent < 100.0 { Ok(percent) } else { Err("less than 100 % is wanted".to_owned()) }
}

/// Two pictures one below the other, each of this size.
const PANEL: Size = Size { width: 900, height: 440 };

pub(super) fn slideway(arguments: &Arguments) -> Result<(), Failure> {
    carry_out(arguments).map_err(|failure| failure.told_as_json(arguments.json))
}

fn carry_out(arguments: &Arguments) -> Result<(), Failure> {
    let format = arguments.plot.as_ref().map(|path| Format::from_path(path)).transpose();
    let format = format.map_err(|error| Failure::usage(error.to_string()))?;
    places(arguments.files())?;
    let settings = arguments.settings();
    let chain = watched(&arguments.inputs(), &settings).map_err(|error| arguments.refused(error))?;
    prepare(None, arguments.files())?;
    arguments.write(&chain, format)?;
    if arguments.json {
        let files = arguments.files().map(|path| path.display().to_string()).collect();
        return say_json(&report::json(&chain, files));
    }
    say(&report::told(&chain))?;
    let files = written(arguments.files());
    say(&if files.is_empty() { files } else { format!("\n{files}") })
}

/// The chain with a bar at a terminal.
fn watched(inputs: &Inputs, settings: &Settings) -> Result<Chain, ChainError> {
    let mut bar = Bar::new("critical velocities");
    Chain::watched(inputs, settings, |done, all| {
        if let Some(bar) = &mut bar {
            bar.done(done, all);
        }
    })
}

impl Arguments {
    fn inputs(&self) -> Inputs {
        Inputs {
            viscosity: self.oil * POISE,
            polar: self.polar,
            weight: self.weight * KGF,
            area: self.area * CM2,
            stiffness: self.stiffness * 1e3 * N_PER_MM,
            ridge: Ridge { width: self.ridge_width * UM, height: self.ridge_height * UM },
        }
    }

    fn settings(&self) -> Settings {
        let FinenessArguments { step, tolerance, every, backend } = self.fineness;
        Settings {
            set: self.set.clone(),
            threshold: self.threshold * MM_PER_S,
            window: self.window,
            step,
            tolerance,
            every,
            backend,
            share: self.percent / 100.0,
            ..Settings::default()
        }
    }

    fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.out.iter().chain(&self.plot)
    }

    fn write(&self, chain: &Chain, format: Option<Format>) -> Result<(), Failure> {
        if let Some(path) = &self.out {
            put(path, chain.simulation.patch().text().as_bytes())?;
        }
        if let Some((path, format)) = self.plot.as_ref().zip(format) {
            let line = parameter_line(&chain.simulation.circuit);
            let criterion = criterion_told(&chain.simulation);
            let bytes = plot::render(&pictures(chain, [&line, &criterion]), format, PANEL);
            put(path, &bytes.map_err(|error| Failure::data(error.to_string()))?)?;
        }
        Ok(())
    }

    /// What the error says, and which option helps.
    fn refused(&self, error: ChainError) -> Failure {
        match error {
            ChainError::Circuit(report) => report.into(),
            ChainError::Overload { .. } | ChainError::Document(_) => Failure::data(error.to_string()),
            ChainError::Run(error) => {
                let message = match error {
                    RunError::TooManySteps { .. } => format!("{error}: give a longer --step"),
                    RunError::TooManyNumbers { .. } => format!("{error}: give a longer --every"),
                    _ => with_advice(&error),
                };
                let is_to_blame = self.fineness.is_to_blame(&error);
                let failure = if is_to_blame { Failure::usage(message) } else { Failure::data(message) };
                failure.with("code", error.code().into())
            }
            error => match self.advice(&error) {
                Some(advice) => Failure::usage(format!("{error}: {advice}")),
                None => Failure::usage(error.to_string()),
            },
        }
    }

    /// The options that put an error right.
    fn advice(&self, error: &ChainError) -> Option<String> {
        let advice = match error {
            ChainError::Input { inputs, .. } => {
                return Some(inputs.iter().map(|input| option(*input)).collect::<Vec<_>>().join(" and "));
            }
            ChainError::BeyondCircuit(beyond) | ChainError::BeyondScales { beyond, .. } => {
                if self.set.iter().any(|(name, _)| *name == beyond.name) {
                    return Some(format!("it is set by --set {}", beyond.name));
                }
                if beyond.name == "K" {
                    let bounds = beyond.bounds.map(|bound| number(bound / (1e3 * N_PER_MM)));
                    return Some(format!("--stiffness takes {} kN/mm", bounds.join(" ... ")));
                }
                origin(&beyond.name)?
            }
            ChainError::NoRise { .. } => "change it with --set",
            ChainError::Unread(error) => return advice_on(error, "a lower v_rate"),
            _ => return None,
        };
        Some(advice.to_owned())
    }
}

/// The option that gives an input.
fn option(input: Input) -> &'static str {
    match input {
        Input::Viscosity => "--oil",
        Input::Weight => "--weight",
        Input::Area => "--area",
        Input::Stiffness => "--stiffness",
        Input::RidgeWidth => "--ridge-width",
        Input::RidgeHeight => "--ridge-height",
    }
}

/// The options that a parameter of the circuit follows from.
fn origin(parameter: &str) -> Option<&'static str> {
    match parameter {
        "M" => Some("it follows from --weight"),
        "Fs" => Some("it follows from --weight, --area, --polar and the ridges"),
        "VcL" => Some("it follows from --oil, --weight, --area and the ridges"),
        "Tc" => Some("it follows from --oil and --weight"),
        _ => None,
    }
}
