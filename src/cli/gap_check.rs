//! `patchcord gap --check`: properties of the data, places for effects, and detection limits, as text and as JSON.
//!
//! The check needs no search. It shows what limits a search: noise that is not white, too coarse a sampling, missing
//! places and effects that the data cannot show. The text has one section per record, then the places, then the
//! detection limits.

use indexmap::IndexMap;
use serde_json::{Value, json};

use super::failure::plural;
use super::gap_report::weakest;
use super::table::Table;
use patchcord::format::{QuantityFormat, format_quantity, number};
use patchcord::ident::design::detectability::{Detectability, DetectionLimit};
use patchcord::ident::effects::Library;
use patchcord::ident::effects::effect_sites::EffectSites;
use patchcord::ident::report::detection_limits::{DetectionLimitDocument, needs_text};
use patchcord::ident::report::places::{nameless_sentences, nowhere_sentence};
use patchcord::ident::report::rounds::{SkippedTrialDocument, skipped_trial_sentence};
use patchcord::ident::{Experiment, Noise, NoiseKind, POWER_FRACTIONS, Record, RecordColumn, record_columns};

/// All records, each with its purpose: "train" or "test".
fn records(experiment: &Experiment) -> impl Iterator<Item = (&'static str, &Record)> {
    let trained = experiment.train.iter().map(|record| ("train", record));
    trained.chain(experiment.test.iter().map(|record| ("test", record)))
}

/// The report on the data and on the places for effects.
///
/// This part is printed at once. The detection limits follow after a fit, which takes longer.
pub(super) fn text(experiment: &Experiment, places: &EffectSites) -> String {
    let mut text = format!("{}: {}\n", experiment.file, verdict(experiment.warnings.warning_count()));
    if !experiment.title.is_empty() {
        text += &format!("{}\n", experiment.title);
    }
    let fit = &experiment.fit;
    let fitted = if fit.is_empty() { "nothing".to_owned() } else { fit.join(", ") };
    text += &format!("{}, to fit: {fitted}\n", experiment.patch.file());
    for (part, record) in records(experiment) {
        let columns = record_columns(experiment, record);
        text += &format!("\n{}\n\n{}", heading(part, record), table(&columns).text());
        let notes: String = columns.iter().flat_map(notes).map(|note| format!("{note}\n")).collect();
        if !notes.is_empty() {
            text += &format!("\n{notes}");
        }
    }
    text + "\n" + &places_text(places)
}

/// The report on the weakest detectable effects.
///
/// Limits assume that the residual of the fitted patch is only noise. The text states how far it is from that.
pub(super) fn limits_text(visible: &Detectability, experiment: &Experiment, library: &Library) -> String {
    let Detectability { residual_rms, limits, skipped } = visible;
    let mut text: String = skipped.iter().map(|own| skipped_trial_sentence(own) + "\n").collect();
    if limits.is_empty() {
        return text;
    }
    text += &format!(
        "\nweakest effects that are detectable in addition to the fitted patch, if the residuals were only \
         noise (now they are {} times the noise{}); each effect at the place \
         and values where it is easiest to detect\n\n{}",
        number(*residual_rms),
        noiseless_text(experiment),
        weakest(limits, "weakest detectable")
    );
    let mut undetectable: Vec<&DetectionLimit> = limits.iter().filter(|own| !own.is_detectable()).collect();
    undetectable.dedup_by_key(|own| own.label());
    let undetectable: String = undetectable
        .into_iter()
        .map(|own| {
            format!(
                "Not detectable at any strength in its range: {}{}.\n",
                own.label(),
                needs_text(own, library)
            )
        })
        .collect();
    if undetectable.is_empty() { text } else { text + "\n" + &undetectable }
}

/// The assumption for outputs without noise, as part of a sentence; empty if there are none.
fn noiseless_text(experiment: &Experiment) -> String {
    let shown =
        experiment.outputs.iter().enumerate().filter(|(place, _)| !experiment.has_known_noise(*place));
    let names: Vec<&str> = shown.map(|(_, output)| output.signal.as_str()).collect();
    match names.as_slice() {
        [] => String::new(),
        names => {
            format!("; for {}, without noise, a millionth of the range counts as noise", names.join(", "))
        }
    }
}

/// The effects to try at each place, and those without a place.
///
/// One line per element, with the effects that are tried there, then sentences about effects and integrators without a
/// place.
fn places_text(places: &EffectSites) -> String {
    let mut at: IndexMap<&str, Vec<&str>> = IndexMap::new();
    for (effect, own) in &places.effects {
        own.iter().for_each(|place| at.entry(place).or_default().push(effect));
    }
    let line =
        |(place, effects): (&str, Vec<&str>)| format!("to be tried at {place}: {}\n", effects.join(", "));
    let mut text: String = at.into_iter().map(line).collect();
    let sentences = nowhere_sentence(places).into_iter().chain(nameless_sentences(places));
    text.extend(sentences.map(|own| own + "\n"));
    text
}

/// The verdict of the check: warnings do not prevent a search.
fn verdict(warnings: usize) -> String {
    match warnings {
        0 => "nothing wrong".to_owned(),
        some => format!("no errors, {}", plural(some as u64, "warning")),
    }
}

/// The heading of a record: "train: a.csv, 0 ... 5 s, 251 samples every 20 ms".
fn heading(part: &str, record: &Record) -> String {
    let number = |value: f64| QuantityFormat::new("", 1.0).number(value);
    let missing = match record.missing() {
        0 => String::new(),
        some => format!(", {some} of them missing"),
    };
    format!(
        "{part}: {}, {} ... {} s, {} every {}{missing}",
        record.name,
        number(record.begin),
        number(record.begin + record.duration()),
        plural(record.len() as u64, "sample"),
        format_quantity(record.interval, "s")
    )
}

/// A share as a percentage with one decimal.
fn percent(share: f64) -> String {
    format!("{} %", QuantityFormat::new("", 1.0).number(0.1 * (1000.0 * share).round()))
}

/// The table of the columns of a record.
///
/// Columns: name, meaning, extremes, noise with its kind, quantum, repeated samples, and the frequencies below which
/// most of the power is.
fn table(columns: &[RecordColumn<'_>]) -> Table {
    let below = POWER_FRACTIONS.map(|share| format!("{} below", percent(share)));
    let headings = ["column", "is", "least", "most", "noise", "", "step", "repeated"].map(str::to_owned);
    let mut table = Table::with([headings.as_slice(), below.as_slice()].concat());
    for column in columns {
        table.row(row(column));
    }
    table
}

/// The row of one column.
///
/// The prefix of the unit is that of the largest magnitude of the column.
fn row(column: &RecordColumn<'_>) -> Vec<String> {
    let is = &column.statistics;
    let display = QuantityFormat::new(column.unit, is.maximum.abs().max(is.minimum.abs()));
    let own = |value: f64| format_quantity(value, column.unit);
    let mut cells = vec![
        column.column.to_owned(),
        format!("{} {}", column.noun, column.name),
        display.text(is.minimum),
        display.text(is.maximum),
        is.noise.as_ref().map_or("too few samples".to_owned(), |noise| own(noise.sigma)),
        is.noise.as_ref().map_or("", |noise| noise.kind.as_str()).to_owned(),
        is.quantum.map_or("none".to_owned(), own),
        percent(is.repeated_fraction),
    ];
    cells.extend((0..POWER_FRACTIONS.len()).map(|place| {
        is.power_frequencies.map_or(String::new(), |below| format_quantity(below[place], "Hz"))
    }));
    cells
}

/// A note is printed if the specified and the estimated noise differ by more than this factor.
const NOISE_RATIO: f64 = 1.5;
/// A note is printed if a tenth of the power has periods of fewer samples than this, too few for interpolation.
const MIN_SAMPLES_PER_PERIOD: f64 = 10.0;

/// Notes on a column whose properties may spoil a fit.
///
/// Three properties are examined: the kind of the noise, the difference from the specified noise, and the samples per
/// period.
fn notes(column: &RecordColumn<'_>) -> Vec<String> {
    let name = column.column;
    let of_noise = column.statistics.noise.as_ref().and_then(|noise| noise_note(name, noise));
    let of_sigma = column.statistics.noise.as_ref().zip(column.sigma).and_then(|(noise, sigma)| {
        let is_far = !(sigma / NOISE_RATIO..=sigma * NOISE_RATIO).contains(&noise.sigma);
        let is_white = noise.kind == NoiseKind::White;
        (is_white && is_far).then(|| {
            let [found, specified] = [noise.sigma, sigma].map(|value| format_quantity(value, column.unit));
            format!("{name}: \"sigma\" is {specified}, but the data have {found}")
        })
    });
    let per_period = column
        .statistics
        .samples_per_period(column.interval)
        .filter(|samples| *samples < MIN_SAMPLES_PER_PERIOD);
    let of_samples = per_period.map(|samples| {
        let samples = QuantityFormat::new("", 1.0).number(samples);
        format!("{name}: a tenth of the power has periods of fewer than {samples} samples")
    });
    [of_noise, of_sigma, of_samples].into_iter().flatten().collect()
}

/// A note on noise that is not white; None for white noise and without noise.
fn noise_note(column: &str, noise: &Noise) -> Option<String> {
    let note = match noise.kind {
        NoiseKind::White | NoiseKind::None => return None,
        NoiseKind::Slow => {
            "the noise estimate decreases with the order of differences: the noise is mostly slow, or \
             the sampling is too coarse for the signal"
        }
        NoiseKind::Fast => "the noise is mostly fast, as in a differentiated reading",
        NoiseKind::Rounding => "the only noise is rounding to the step",
    };
    Some(format!("{column}: {note}"))
}

/// The report as JSON.
///
/// Keys: `ok`, `experiment`, `title`, `patch`, `diagnostics`, `fit`, `records`; `effects`, a list of `name` and
/// `junctions`; `nowhere`, effects without a place; `nameless`, integrators without a scale; `leaves`, the residual of
/// the fitted patch in noise; `limits`; `left_out`, skipped trials.
pub(super) fn document(experiment: &Experiment, places: &EffectSites, visible: &Detectability) -> Value {
    let effects = places.effects.iter().map(|(name, at)| json!({"name": name, "junctions": at}));
    let limits = visible.limits.iter().map(DetectionLimitDocument::from);
    let left_out = visible.skipped.iter().map(|own| SkippedTrialDocument::of(own, None));
    json!({
        "ok": true,
        "experiment": experiment.file,
        "title": experiment.title,
        "patch": experiment.patch.file(),
        "diagnostics": experiment.warnings.to_json(),
        "fit": experiment.fit,
        "records": records(experiment).map(|(part, record)| record_json(experiment, part, record)).collect::<Value>(),
        "effects": effects.collect::<Value>(),
        "nowhere": places.inapplicable_effects(),
        "nameless": places.unscaled_integrators,
        "leaves": visible.residual_rms,
        "limits": limits.collect::<Vec<_>>(),
        "left_out": left_out.collect::<Vec<_>>(),
    })
}

/// `part` is "train" or "test". Times are in seconds, `jitter` is a fraction of the interval.
fn record_json(experiment: &Experiment, part: &str, record: &Record) -> Value {
    json!({
        "part": part,
        "name": record.name,
        "begin": record.begin,
        "interval": record.interval,
        "samples": record.len(),
        "missing": record.missing(),
        "jitter": record.jitter,
        "columns": record_columns(experiment, record).iter().map(column_json).collect::<Value>(),
    })
}

/// The key "drive" or "signal" names what the column belongs to. `sigma` is the specified noise, `noise` the estimated
/// one with the estimates by the order of differences. `power_below` is a list of `share` and `frequency` in Hz. Values
/// are in `unit`.
fn column_json(column: &RecordColumn<'_>) -> Value {
    let is = &column.statistics;
    let below = |below: [f64; POWER_FRACTIONS.len()]| -> Value {
        POWER_FRACTIONS
            .iter()
            .zip(below)
            .map(|(share, frequency)| json!({"share": share, "frequency": frequency}))
            .collect()
    };
    json!({
        "column": column.column,
        column.noun: column.name,
        "unit": column.unit,
        "sigma": column.sigma,
        "least": is.minimum,
        "most": is.maximum,
        "rms": is.rms,
        "noise": is.noise.as_ref().map(|noise| json!({
            "sigma": noise.sigma, "kind": noise.kind.as_str(), "by_order": noise.by_order,
        })),
        "step": is.quantum,
        "repeated": is.repeated_fraction,
        "power_below": is.power_frequencies.map(below),
        "samples_a_period": is.samples_per_period(column.interval),
    })
}
