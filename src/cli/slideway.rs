//! `patchcord slideway`
//!
//! The options are in the units of a workshop: poise, kgf, kN/mm, cm2, µm. They are converted to SI units once, in
//! `inputs` and `settings`.

use std::path::PathBuf;

use clap::Args;

use super::criteria::advice_on;
use super::failure::Failure;
use super::files::{OutputOption, PLOT, path_texts, picture_format, write_pictures, written_paragraph};
use super::numbers::{in_declared_units, positive_in, setting};
use super::outputs::Outputs;
use super::progress::ProgressBar;
use super::slideway_document::Document;
use super::slideway_report::{self as report, criterion_text};
use super::times::{StepArguments, StepChoice, message_with_advice};
use super::{print, print_json};
use patchcord::document::TypedNumber;
use patchcord::draw::plot::{Format, Size};
use patchcord::format::format_pure_number;
use patchcord::instruments::parameter_line;
use patchcord::solve::RunError;
use patchcord::thesis::chain::{Chain, ChainError, Input, Inputs, Settings, pictures, template};
use patchcord::thesis::slideway::ridge::Ridge;
use patchcord::thesis::slideway::units::{CM2, KGF, MM_PER_S, N_PER_MM, POISE, UM};

#[derive(Args)]
pub(super) struct Arguments {
    /// Viscosity of the oil, in poise (1 P = 0.1 Pa s)
    #[arg(long, value_name = "P", allow_hyphen_values = true, value_parser = positive_in("P"))]
    oil: f64,
    /// The oil has a polar additive
    #[arg(long)]
    polar: bool,
    /// Weight of the table, in kgf (numerically its mass in kg)
    #[arg(long, value_name = "KGF", allow_hyphen_values = true, value_parser = positive_in("kgf"))]
    weight: f64,
    /// Stiffness of the drive, in kN/mm (= MN/m)
    #[arg(long, value_name = "KN/MM", allow_hyphen_values = true, value_parser = positive_in("kN/mm"))]
    stiffness: f64,
    /// Apparent area of the slides, in cm2
    #[arg(long, value_name = "CM2", default_value = "697", allow_hyphen_values = true, value_parser = positive_in("cm2"))]
    area: f64,
    /// Width B of the ridges of the ground surfaces, in micrometres
    #[arg(long, value_name = "MICROMETRES", default_value = "50", allow_hyphen_values = true, value_parser = positive_in("µm"))]
    ridge_width: f64,
    /// Height Z of the ridges, in micrometres
    #[arg(long, value_name = "MICROMETRES", default_value = "2.5", allow_hyphen_values = true, value_parser = positive_in("µm"))]
    ridge_height: f64,
    /// Set a parameter of the circuit of Fig 8.16 in place of its computed value: M, K, f, Fs, VcL, Tc, v_start,
    /// v_rate, v_turn or x_step. A number without a unit is in SI units. May be given several times
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    set: Vec<(String, TypedNumber)>,
    /// Change that each piece of advice makes to its quantity, in percent
    #[arg(long = "by", value_name = "PERCENT", default_value = "10", allow_hyphen_values = true, value_parser = percent)]
    percent: f64,
    /// Largest change of the velocity within a window, in mm/s peak to peak, that does not count as oscillation
    #[arg(long, value_name = "MM/S", default_value = "0.25", allow_hyphen_values = true, value_parser = positive_in("mm/s"))]
    threshold: f64,
    /// Length of the window, in seconds (default: 0.04, or the period of the table on its drive if that is longer)
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = positive_in("s"))]
    window: Option<f64>,
    #[command(flatten)]
    steps: StepArguments,
    /// Draw the velocity profile into this file; the ending of its name selects SVG or PNG
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Write the circuit as a patch; `patchcord run` with it repeats the simulation
    #[arg(long, value_name = "FILE.json")]
    out: Option<PathBuf>,
    /// Print one JSON document in SI units on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

/// Parses a percentage between 0 and 100.
fn percent(text: &str) -> Result<f64, String> {
    let percent = positive_in("%")(text)?;
    if percent < 100.0 { Ok(percent) } else { Err("must be less than 100 %".to_owned()) }
}

/// The option for the patch.
const PATCH_OPTION: OutputOption =
    OutputOption { option: "--out", content: "patch", ending: "json", drawing: PLOT };

/// Size of each of the two pictures, in pixels.
const PANEL: Size = Size { width: 900, height: 440 };

/// The chain takes eight runs: the slideway as it is, and one for each piece of advice.
pub(super) fn slideway(arguments: &Arguments) -> Result<(), Failure> {
    let format = arguments.plot.as_deref().map(picture_format).transpose()?;
    PATCH_OPTION.check(arguments.out.as_deref())?;
    if arguments.steps.step == Some(StepChoice::Automatic) {
        return Err(Failure::usage("--step auto is not possible here: give seconds, or --tol"));
    }
    let outputs = Outputs::default();
    outputs.prepare(None, arguments.files())?;
    let settings = arguments.settings()?;
    let chain = run_chain(&arguments.inputs(), &settings).map_err(|error| arguments.failure(error))?;
    arguments.write(&outputs, &chain, format)?;
    if arguments.json {
        return print_json(&Document::new(&chain, path_texts(arguments.files())));
    }
    print(&report::text(&chain))?;
    print(&written_paragraph(arguments.files()))
}

/// Runs the chain with a progress bar.
///
/// The bar counts finished runs.
fn run_chain(inputs: &Inputs, settings: &Settings) -> Result<Chain, ChainError> {
    let bar = ProgressBar::new("slideway", "critical velocities");
    Chain::with_progress(inputs, settings, |done, all| bar.done(done, all))
}

impl Arguments {
    /// The inputs in SI units.
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

    /// The settings of the simulation in SI units.
    ///
    /// # Errors
    /// If a parameter is set in a unit of another dimension.
    fn settings(&self) -> Result<Settings, Failure> {
        let StepArguments { step, tolerance, every, backend } = self.steps;
        let step = step.and_then(StepChoice::seconds);
        Ok(Settings {
            set: in_declared_units(&self.set, template())?,
            threshold: self.threshold * MM_PER_S,
            window: self.window,
            step,
            tolerance,
            every,
            backend,
            share: self.percent / 100.0,
            ..Settings::default()
        })
    }

    /// The files to write.
    fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.out.iter().chain(&self.plot)
    }

    /// Writes the patch and the picture.
    fn write(&self, outputs: &Outputs, chain: &Chain, format: Option<Format>) -> Result<(), Failure> {
        if let Some(path) = &self.out {
            outputs.write(path, chain.simulation.patch().text().as_bytes())?;
        }
        if let Some((path, format)) = self.plot.as_ref().zip(format) {
            let line = parameter_line(&chain.simulation.circuit);
            let criterion = criterion_text(&chain.simulation);
            write_pictures(outputs, path, &pictures(chain, [&line, &criterion]), format, PANEL)?;
        }
        Ok(())
    }

    /// The failure for an error of the chain, with the option that helps.
    fn failure(&self, error: ChainError) -> Failure {
        match error {
            ChainError::Circuit(report) => report.into(),
            ChainError::Overload { .. } | ChainError::Document(_) => Failure::data(error.to_string()),
            ChainError::Run(error) => {
                let message = match error {
                    RunError::TooManySteps { .. } => format!("{error}: give a longer --step"),
                    RunError::TooManyNumbers { .. } => format!("{error}: give a longer --every"),
                    _ => message_with_advice(&error),
                };
                let is_usage = self.steps.is_cause_of(&error);
                let failure = if is_usage { Failure::usage(message) } else { Failure::data(message) };
                failure.with_detail("code", error.code().into())
            }
            error => match self.advice(&error) {
                Some(advice) => Failure::usage(format!("{error}: {advice}")),
                None => Failure::usage(error.to_string()),
            },
        }
    }

    /// The option that helps against an error; None if there is none.
    fn advice(&self, error: &ChainError) -> Option<String> {
        let advice = match error {
            ChainError::Input { inputs, .. } => {
                let options: Vec<_> = inputs.iter().map(|input| option(*input)).collect();
                format!("change {}", options.join(" or "))
            }
            ChainError::OutsideCircuitRange(violation) | ChainError::OutsideScaleRange { violation, .. } => {
                if self.set.iter().any(|(name, _)| *name == violation.name) {
                    return Some(format!("it is set by --set {}", violation.name));
                }
                advice_on_parameter(&violation.name, violation.bounds)?
            }
            ChainError::NoRise { .. } => "change it with --set".to_owned(),
            ChainError::Unread(error) => return advice_on(error, "a lower v_rate"),
            _ => return None,
        };
        Some(advice)
    }
}

/// The option for an input.
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

/// The option for a parameter of the circuit that is outside its bounds. `bounds` are in SI units.
///
/// If only one option determines the parameter, the advice has the range of the option. None for a parameter that only
/// `--set` changes.
fn advice_on_parameter(name: &str, bounds: [f64; 2]) -> Option<String> {
    let range = |unit: f64| bounds.map(|bound| format_pure_number(bound / unit)).join(" ... ");
    match name {
        // The mass of a table in kg is its weight in kgf.
        "M" => Some(format!("--weight takes {} kgf", range(1.0))),
        "K" => Some(format!("--stiffness takes {} kN/mm", range(1e3 * N_PER_MM))),
        "Fs" => Some("it follows from --weight, --area, --polar and the ridges".to_owned()),
        "VcL" => Some("it follows from --oil, --weight, --area and the ridges".to_owned()),
        "Tc" => Some("it follows from --oil and --weight".to_owned()),
        _ => None,
    }
}
