//! System identification for patches: which effect is missing in a patch, according to measured data.
//!
//! The work has four steps: an [`Experiment`] is read, its [`Problem`] is set up, a [`search()`] tries the effects of a
//! [`Library`], and a [`Report`] describes the [`Outcome`]. This page shows them on the patch of a mass on a
//! spring and the measured motion of a spring that is also damped.
//!
//! # 1. Read an experiment
//!
//! An experiment is a JSON file that names the patch, the data files, the columns and the parameters to fit.
//! `docs/gap.md` describes it. [`Experiment::read`] reads all of these files and reports all faults together. The data
//! become training and validation [records](Record) in the units of the patch.
//!
//! ```
//! use patchcord_ident::{Experiment, record_columns};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
//! assert_eq!(experiment.fit, ["k"]);
//!
//! let position = &record_columns(&experiment, &experiment.train[0])[0];
//! assert_eq!((position.name, position.unit, position.statistics.missing), ("x", "mm", 0));
//! # Ok(())
//! # }
//! ```
//!
//! # 2. Set up the problem and fit the patch
//!
//! [`Problem::of`] estimates the noise and chooses the steps of the solver. [`fit_base()`] fits the patch as it is. If
//! its residual is not white noise, the patch lacks something.
//!
//! ```
//! use patchcord_ident::{Experiment, Problem, fit_base};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
//! let problem = Problem::of(&experiment)?;
//! let fitted = fit_base(&problem, &experiment.patch, &experiment.fit, 1)?;
//! let fitted = fitted.ok_or("the patch cannot be run from any start")?;
//! assert!(fitted.residuals_are_coloured());
//! # Ok(())
//! # }
//! ```
//!
//! # 3. Search for the missing effect
//!
//! [`search()`] begins with the same fit. It wires every effect of the library into the patch, at every suitable site,
//! fits each extended patch, and compares the results on all data. [`Outcome::verdict`] is its answer. A search takes
//! some seconds, so this example is only compiled:
//!
//! ```no_run
//! use patchcord_ident::{Experiment, Library, Problem, SearchSettings, search};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
//! # let problem = Problem::of(&experiment)?;
//! let library = Library::shipped();
//! let settings = SearchSettings::new(&library).with_seed(1);
//! let outcome = search(&experiment, &problem, &settings, |progress| println!("{progress:?}"))?;
//! let outcome = outcome.ok_or("the patch cannot be run from any start")?;
//! assert_eq!(outcome.verdict.as_str(), "named");
//! # Ok(())
//! # }
//! ```
//!
//! # 4. Report the outcome
//!
//! A [`Report`] makes the sentences, the JSON document, the HTML page and the patches with fitted values. No other
//! module makes texts about results.
//!
//! ```no_run
//! use patchcord_ident::{Experiment, Library, Outcome, Problem, Report};
//!
//! # fn describe(experiment: &Experiment, problem: &Problem, library: &Library, outcome: &Outcome)
//! #     -> Result<(), Box<dyn std::error::Error>> {
//! let report = Report::new(experiment, problem, outcome);
//! assert_eq!(report.sentence(), "viscous-friction at A1 is missing");
//! assert!(report.doubts().is_empty());
//! std::fs::write("report.html", report.page(library)?)?;
//! std::fs::write("report.json", report.json().to_string())?;
//! # Ok(())
//! # }
//! ```
//!
//! # Further questions
//!
//! * What can the data show at all? [`detectable_effects()`] computes the smallest effect of each kind that they would
//!   show, without a search.
//! * Where and when is a force missing, if no effect of the library explains the residual? [`localise()`] estimates it.
//! * Which effects are tried where? [`EffectSites`] lists them.
//! * What does the patch do along the records with other values of its parameters? A [`Simulation`] runs it without a
//!   fit.
//!
//! A program without files, such as a web page, lists the columns of a data file with [`data_columns()`] and reads the
//! experiment with [`Experiment::parse_given`]. A fit or a search can be cancelled: [`Problem::with_cancel`].
//!
//! # Modules
//!
//! The names above are all that most programs need. The modules have the parts of which they are made, in the order of
//! the work:
//!
//! 1. [`fit`] adjusts the parameters of the patch until its outputs follow the training records.
//! 2. [`residuals`] analyses the residual: is it only noise, or are a sign, a unit or the time scale wrong?
//! 3. [`effects`] has the library. It finds the sites at which each effect can act, and wires it in there.
//! 4. [`search`](mod@search) adds the best effect. It repeats this until the residual is noise or no effect is better
//!    by more than chance.
//! 5. [`localise`](mod@localise) estimates the unknown input that would explain the residual.
//! 6. [`design`] computes what the data can decide, and an experiment that distinguishes two effects.
//! 7. [`report`] writes texts, pages and JSON documents.
//!
//! [`statistics`] has the tests and comparisons that these steps share.

#![forbid(unsafe_code)]

mod data;
pub mod design;
pub mod effects;
pub mod fit;
pub mod localise;
pub mod report;
pub mod residuals;
pub mod search;
pub mod statistics;

pub use data::codes;
pub use data::columns::{RecordColumn, record_columns};
pub use data::data_columns::{DataColumn, data_columns};
pub use data::examine::{ColumnStatistics, Noise, NoiseKind, POWER_FRACTIONS, examine};
pub use data::experiment::{Experiment, MeasuredDrive, MeasuredOutput};
pub use data::experiment_document::Hold;
pub use data::experiment_file::ExperimentError;
pub use data::file_source::GivenFiles;
pub use data::record::{MIN_RECORD_SAMPLES, Record};
pub use design::detectability::{Detectability, DetectionLimit, detectable_effects};
pub use effects::effect_sites::EffectSites;
pub use effects::{Effect, EffectError, Library, PlacedEffect};
pub use fit::base_fit::fit_base;
pub use fit::fitted_model::FittedModel;
pub use fit::model::{ModelError, SimulatedRecord};
pub use fit::problem::Problem;
pub use fit::simulation::Simulation;
pub use localise::{Localisation, localise};
pub use report::Report;
pub use search::progress::{Progress, SearchPhase, TrialResult};
pub use search::{Outcome, SearchSettings, Verdict, search};
