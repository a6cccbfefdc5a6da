//! The report of `patchcord gap --check`: properties of the data, sites of effects, and detection limits.
//!
//! The check needs no search. It shows what limits a search: noise that is not white, too coarse a sampling, missing
//! sites and effects that the data cannot show. The command line prints the lines and lays out the tables.
//! [`check_document`](super::check_document) has the same facts as a JSON document.

use crate::data::columns::{RecordColumn, record_columns};
use crate::data::examine::{Noise, NoiseKind, POWER_FRACTIONS};
use crate::data::experiment::Experiment;
use crate::data::record::Record;
use crate::design::detectability::{Detectability, DetectionLimit};
use crate::effects::Library;
use crate::effects::effect_sites::EffectSites;
use crate::report::detection_limits::{limit_label, needs_text};
use crate::report::effect_sites::{inapplicable_effects_sentence, site_lines, unscaled_integrator_sentences};
use crate::report::reasons::solver_error_sentence;
use crate::report::rounds::skipped_trial_sentence;
use crate::report::values::{QuantityFormat, format_pure_number, format_quantity, percent_text};
use patchcord_core::document::plural;

/// A note is printed if the specified and the estimated noise differ by more than this factor.
const NOISE_RATIO: f64 = 1.5;
/// A note is printed if a tenth of the power has periods of fewer samples than this, too few for interpolation.
const MIN_SAMPLES_PER_PERIOD: f64 = 10.0;

/// The report on an experiment before any search.
///
/// # Examples
///
/// ```
/// use patchcord_ident::report::check::CheckReport;
/// use patchcord_ident::{EffectSites, Experiment, Library};
///
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let sites = EffectSites::of(&experiment.patch, &experiment.drives, &Library::shipped())?;
/// let report = CheckReport::new(&experiment, &sites);
/// assert!(report.records().next().ok_or("a record")?.heading.starts_with("train: "));
/// assert!(report.site_lines().iter().any(|line| line.starts_with("to be tried at A1: ")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct CheckReport<'a> {
    experiment: &'a Experiment,
    sites: &'a EffectSites,
}

/// A record of a check: a heading, a table with a row for each column, and notes.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct RecordCheck {
    /// For example "train: a.csv, 0 ... 5 s, 251 samples every 20 ms".
    pub heading: String,
    /// The headings of the table.
    pub column_headings: Vec<String>,
    /// The rows of the table, with a cell for each heading.
    pub rows: Vec<Vec<String>>,
    /// Notes on properties that may spoil a fit, a line each.
    pub notes: Vec<String>,
}

/// The detection limits of a check as text. The table between the introduction and the undetectable effects has the
/// rows of [`detection_limit_rows`](super::detection_limits::detection_limit_rows).
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct LimitsCheck {
    /// A warning if the error of the solver exceeds the noise. The limits are then not reliable.
    pub solver_warning: Option<String>,
    /// The effects that cannot be tried at a site, a line each.
    pub skipped: Vec<String>,
    /// What the limits assume. It states how far the residual of the fitted patch is from the assumption.
    pub introduction: String,
    /// The effects that are not detectable at any strength, a sentence each.
    pub undetectable: Vec<String>,
}

impl<'a> CheckReport<'a> {
    /// The report on an experiment. `sites` are those of its patch.
    pub fn new(experiment: &'a Experiment, sites: &'a EffectSites) -> Self {
        CheckReport { experiment, sites }
    }

    /// The verdict of the check, the title if there is one, and the patch with the parameters to fit.
    pub fn summary_lines(&self) -> Vec<String> {
        let Experiment { file, title, patch, fit, warnings, .. } = self.experiment;
        let verdict = format!("{file}: {}", verdict_text(warnings.warning_count()));
        let fitted = if fit.is_empty() { "nothing".to_owned() } else { fit.join(", ") };
        let title = Some(title.clone()).filter(|title| !title.is_empty());
        [verdict].into_iter().chain(title).chain([format!("{}, to fit: {fitted}", patch.file())]).collect()
    }

    /// The records, first those for training.
    pub fn records(&self) -> impl Iterator<Item = RecordCheck> {
        let experiment = self.experiment;
        parts_and_records(experiment).map(move |(part, record)| {
            let columns = record_columns(experiment, record);
            RecordCheck {
                heading: record_heading(part, record),
                column_headings: column_headings(),
                rows: columns.iter().map(column_row).collect(),
                notes: columns.iter().flat_map(column_notes).collect(),
            }
        })
    }

    /// The effects to try at each site, then sentences on effects and integrators without a site.
    pub fn site_lines(&self) -> Vec<String> {
        let sentences = inapplicable_effects_sentence(self.sites)
            .into_iter()
            .chain(unscaled_integrator_sentences(self.sites));
        site_lines(self.sites).into_iter().chain(sentences).collect()
    }

    /// The detection limits as text. `library` has the effects that were tried.
    pub fn limits(&self, detectability: &Detectability, library: &Library) -> LimitsCheck {
        let Detectability { residual_rms, step_refinement, limits, skipped } = detectability;
        let mut undetectable: Vec<&DetectionLimit> =
            limits.iter().filter(|limit| !limit.is_detectable()).collect();
        undetectable.dedup_by(|limit, before| limit.effect == before.effect && limit.site == before.site);
        let undetectable = undetectable.into_iter().map(|limit| {
            let (label, needs) = (limit_label(limit), needs_text(limit, library));
            format!("Not detectable at any strength in its range: {label}{needs}.")
        });
        let solver_warning = step_refinement.exceeds_noise().then(|| {
            format!("warning: a search will be inconclusive: {}", solver_error_sentence(step_refinement))
        });
        LimitsCheck {
            solver_warning,
            skipped: skipped.iter().map(skipped_trial_sentence).collect(),
            introduction: format!(
                "weakest effects that are detectable in addition to the fitted patch, if the residuals were only \
                 noise (now they are {} times the noise{}); each effect at the place \
                 and values where it is easiest to detect",
                format_pure_number(*residual_rms),
                noiseless_text(self.experiment)
            ),
            undetectable: undetectable.collect(),
        }
    }
}

/// All records, each with the word for its purpose: "train" or "test".
pub(super) fn parts_and_records(experiment: &Experiment) -> impl Iterator<Item = (&'static str, &Record)> {
    let training = experiment.train.iter().map(|record| ("train", record));
    training.chain(experiment.validation.iter().map(|record| ("test", record)))
}

/// The verdict of the check: warnings do not prevent a search.
fn verdict_text(warnings: usize) -> String {
    match warnings {
        0 => "nothing wrong".to_owned(),
        count => format!("no errors, {}", plural(count, "warning")),
    }
}

/// The heading of a record: "train: a.csv, 0 ... 5 s, 251 samples every 20 ms".
fn record_heading(part: &str, record: &Record) -> String {
    let missing = match record.missing() {
        0 => String::new(),
        count => format!(", {count} of them missing"),
    };
    format!(
        "{part}: {}, {} ... {} s, {} every {}{missing}",
        record.name,
        format_pure_number(record.begin),
        format_pure_number(record.begin + record.duration()),
        plural(record.len(), "sample"),
        format_quantity(record.interval, "s")
    )
}

/// A share as a percentage with one decimal.
fn rounded_share_text(share: f64) -> String {
    percent_text(0.1 * (1000.0 * share).round())
}

/// The headings of the table of columns: name, meaning, extremes, noise with its kind, quantum, repeated samples, and
/// the frequencies below which most of the power is.
fn column_headings() -> Vec<String> {
    let below = POWER_FRACTIONS.map(|share| format!("{} below", rounded_share_text(share)));
    let headings = ["column", "is", "least", "most", "noise", "", "step", "repeated"].map(str::to_owned);
    headings.into_iter().chain(below).collect()
}

/// The row of one column. The prefix of the unit is that of the largest magnitude of the column.
fn column_row(column: &RecordColumn<'_>) -> Vec<String> {
    let statistics = &column.statistics;
    let largest = statistics.maximum.abs().max(statistics.minimum.abs());
    let format = QuantityFormat::new(column.unit, largest);
    let quantity = |value: f64| format_quantity(value, column.unit);
    let noise = statistics.noise.as_ref();
    let mut cells = vec![
        column.column.to_owned(),
        format!("{} {}", column.noun, column.name),
        format.text(statistics.minimum),
        format.text(statistics.maximum),
        noise.map_or("too few samples".to_owned(), |noise| quantity(noise.sigma)),
        noise.map_or("", |noise| noise.kind.as_str()).to_owned(),
        statistics.quantum.map_or("none".to_owned(), quantity),
        rounded_share_text(statistics.repeated_fraction),
    ];
    let frequencies = statistics.power_frequencies;
    cells.extend((0..POWER_FRACTIONS.len()).map(|index| {
        frequencies.map_or(String::new(), |frequencies| format_quantity(frequencies[index], "Hz"))
    }));
    cells
}

/// Notes on a column whose properties may spoil a fit: the kind of the noise, the difference from the specified noise,
/// and the samples per period.
fn column_notes(column: &RecordColumn<'_>) -> Vec<String> {
    let (name, statistics) = (column.column, &column.statistics);
    let of_noise = statistics.noise.as_ref().and_then(|noise| noise_note(name, noise));
    let of_sigma = statistics.noise.as_ref().zip(column.sigma).and_then(|(noise, sigma)| {
        let is_far = !(sigma / NOISE_RATIO..=sigma * NOISE_RATIO).contains(&noise.sigma);
        let is_white = noise.kind == NoiseKind::White;
        (is_white && is_far).then(|| {
            let [found, specified] = [noise.sigma, sigma].map(|value| format_quantity(value, column.unit));
            format!("{name}: \"sigma\" is {specified}, but the data have {found}")
        })
    });
    let per_period = statistics.samples_per_period(column.interval);
    let of_samples = per_period.filter(|samples| *samples < MIN_SAMPLES_PER_PERIOD).map(|samples| {
        format!(
            "{name}: a tenth of the power has periods of fewer than {} samples",
            format_pure_number(samples)
        )
    });
    [of_noise, of_sigma, of_samples].into_iter().flatten().collect()
}

/// A note on noise that is not white. None for white noise and without noise.
fn noise_note(column: &str, noise: &Noise) -> Option<String> {
    let note = match noise.kind {
        NoiseKind::White | NoiseKind::Absent => return None,
        NoiseKind::Slow => {
            "the noise estimate decreases with the order of differences: the noise is mostly slow, or \
             the sampling is too coarse for the signal"
        }
        NoiseKind::Fast => "the noise is mostly fast, as in a differentiated reading",
        NoiseKind::Rounding => "the only noise is rounding to the step",
    };
    Some(format!("{column}: {note}"))
}

/// The assumption for outputs without noise, as part of a sentence. Empty if there are none.
fn noiseless_text(experiment: &Experiment) -> String {
    let noiseless =
        experiment.outputs.iter().enumerate().filter(|(index, _)| !experiment.has_known_noise(*index));
    let names: Vec<&str> = noiseless.map(|(_, output)| output.signal.as_str()).collect();
    match names.as_slice() {
        [] => String::new(),
        names => {
            format!("; for {}, without noise, a millionth of the range counts as noise", names.join(", "))
        }
    }
}
