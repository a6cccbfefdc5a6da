//! `patchcord gap --check`: what data are like, and where effects would be tried, in words and as a document.

use indexmap::IndexMap;
use serde_json::{Value, json};

use super::failure::plural;
use super::gap_report::weakest;
use super::table::Table;
use patchcord::ident::design::detectability::{Limit, Visible};
use patchcord::ident::effects::Library;
use patchcord::ident::effects::places::Places;
use patchcord::ident::report::detection_limits::{DetectionLimitDocument, needs_text};
use patchcord::ident::report::places::{nameless_sentences, nowhere_sentence};
use patchcord::ident::report::rounds::{SkippedTrialDocument, skipped_trial_sentence};
use patchcord::ident::{Column, Experiment, Noise, NoiseKind, Record, SHARES, columns};
use patchcord::instruments::{Display, number};

/// What a record is for, and the record.
fn records(experiment: &Experiment) -> impl Iterator<Item = (&'static str, &Record)> {
    let trained = experiment.train.iter().map(|record| ("train", record));
    trained.chain(experiment.test.iter().map(|record| ("test", record)))
}

pub(super) fn told(experiment: &Experiment, places: &Places) -> String {
    let mut text = format!("{}: {}\n", experiment.file, verdict(experiment.warnings.warnings()));
    if !experiment.title.is_empty() {
        text += &format!("{}\n", experiment.title);
    }
    let fit = &experiment.fit;
    let fitted = if fit.is_empty() { "nothing".to_owned() } else { fit.join(", ") };
    text += &format!("{}, to fit: {fitted}\n", experiment.patch.file());
    for (part, record) in records(experiment) {
        let columns = columns(experiment, record);
        text += &format!("\n{}\n\n{}", heading(part, record), table(&columns).text());
        let notes: String = columns.iter().flat_map(notes).map(|note| format!("{note}\n")).collect();
        if !notes.is_empty() {
            text += &format!("\n{notes}");
        }
    }
    text + "\n" + &tried(places)
}

/// From which strength on the data could show effects.
pub(super) fn shows(visible: &Visible, experiment: &Experiment, library: &Library) -> String {
    let Visible { leaves, limits, left_out } = visible;
    let mut text: String = left_out.iter().map(|own| skipped_trial_sentence(own) + "\n").collect();
    if limits.is_empty() {
        return text;
    }
    text += &format!(
        "\nwhat these data could show beside the patch as fitted, if no more than noise were left (now it leaves {} times that{}), every effect where it shows best of all places and values that were tried\n\n{}",
        number(*leaves),
        noiseless(experiment),
        weakest(limits, "weakest that would show")
    );
    let mut blind: Vec<&Limit> = limits.iter().filter(|own| !own.is_seen()).collect();
    blind.dedup_by_key(|own| own.named());
    let blind = blind.into_iter().map(|own| {
        format!("No strength in its range would show of {}{}.\n", own.named(), needs_text(own, library))
    });
    let blind: String = blind.collect();
    if blind.is_empty() { text } else { text + "\n" + &blind }
}

/// What stands for the noise of outputs that show none.
fn noiseless(experiment: &Experiment) -> String {
    let shown = experiment.outputs.iter().enumerate().filter(|(place, _)| !experiment.shows_noise(*place));
    let names: Vec<&str> = shown.map(|(_, output)| output.signal.as_str()).collect();
    match names.as_slice() {
        [] => String::new(),
        names => format!("; of {}, without noise, a millionth of its range counts as such", names.join(", ")),
    }
}

/// Which effects would be tried at which place.
fn tried(places: &Places) -> String {
    let mut at: IndexMap<&str, Vec<&str>> = IndexMap::new();
    for (effect, own) in &places.effects {
        own.iter().for_each(|place| at.entry(place).or_default().push(effect));
    }
    let told =
        |(place, effects): (&str, Vec<&str>)| format!("would be tried at {place}: {}\n", effects.join(", "));
    let mut text: String = at.into_iter().map(told).collect();
    let told = nowhere_sentence(places).into_iter().chain(nameless_sentences(places));
    text.extend(told.map(|own| own + "\n"));
    text
}

fn verdict(warnings: usize) -> String {
    match warnings {
        0 => "nothing wrong".to_owned(),
        some => format!("no errors, {}", plural(some as u64, "warning")),
    }
}

/// "train: a.csv, 0 ... 5 s, 251 samples every 20 ms".
fn heading(part: &str, record: &Record) -> String {
    let number = |value: f64| Display::new("", 1.0).number(value);
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
        with_unit(record.interval, "s")
    )
}

fn with_unit(value: f64, unit: &str) -> String {
    Display::new(unit, value).text(value)
}

fn percent(share: f64) -> String {
    format!("{} %", Display::new("", 1.0).number(0.1 * (1000.0 * share).round()))
}

fn table(columns: &[Column<'_>]) -> Table {
    let below = SHARES.map(|share| format!("{} below", percent(share)));
    let headings = ["column", "is", "least", "most", "noise", "", "step", "repeated"].map(str::to_owned);
    let mut table = Table::with([headings.as_slice(), below.as_slice()].concat());
    for column in columns {
        table.row(row(column));
    }
    table
}

fn row(column: &Column<'_>) -> Vec<String> {
    let is = &column.is;
    let display = Display::new(column.unit, is.most.abs().max(is.least.abs()));
    let own = |value: f64| with_unit(value, column.unit);
    let mut cells = vec![
        column.column.to_owned(),
        format!("{} {}", column.noun, column.name),
        display.text(is.least),
        display.text(is.most),
        is.noise.as_ref().map_or("too few samples".to_owned(), |noise| own(noise.sigma)),
        is.noise.as_ref().map_or("", |noise| noise.kind.as_str()).to_owned(),
        is.quantum.map_or("none".to_owned(), own),
        percent(is.repeats),
    ];
    cells.extend(
        (0..SHARES.len()).map(|place| is.below.map_or(String::new(), |below| with_unit(below[place], "Hz"))),
    );
    cells
}

/// Told noise that is so many times larger or smaller than what was found is worth a word.
const FAR_FROM_TOLD: f64 = 1.5;
/// Fewer samples a period than this leave the curve between them to guesses.
const FEW_A_PERIOD: f64 = 10.0;

/// What the table means for the experiment.
fn notes(column: &Column<'_>) -> Vec<String> {
    let name = column.column;
    let of_noise = column.is.noise.as_ref().and_then(|noise| noise_note(name, noise));
    let of_sigma = column.is.noise.as_ref().zip(column.sigma).and_then(|(noise, sigma)| {
        let is_far = !(sigma / FAR_FROM_TOLD..=sigma * FAR_FROM_TOLD).contains(&noise.sigma);
        let is_white = noise.kind == NoiseKind::White;
        (is_white && is_far).then(|| {
            let [found, told] = [noise.sigma, sigma].map(|value| with_unit(value, column.unit));
            format!("{name}: \"sigma\" is {told}, and {found} is found")
        })
    });
    let a_period = column.is.samples_a_period(column.interval).filter(|samples| *samples < FEW_A_PERIOD);
    let of_samples = a_period.map(|samples| {
        let samples = Display::new("", 1.0).number(samples);
        format!("{name}: a tenth of its power has periods of fewer than {samples} samples")
    });
    [of_noise, of_sigma, of_samples].into_iter().flatten().collect()
}

fn noise_note(column: &str, noise: &Noise) -> Option<String> {
    let told = match noise.kind {
        NoiseKind::White | NoiseKind::None => return None,
        NoiseKind::Slow => {
            "what looks like noise is less with every order of differences: it is mostly slow, or the curve is too fast for its samples"
        }
        NoiseKind::Fast => "its noise is mostly fast, as of a reading that was differentiated",
        NoiseKind::Rounding => "no noise is seen but that of rounding to its step",
    };
    Some(format!("{column}: {told}"))
}

pub(super) fn document(experiment: &Experiment, places: &Places, visible: &Visible) -> Value {
    let effects = places.effects.iter().map(|(name, at)| json!({"name": name, "junctions": at}));
    let limits = visible.limits.iter().map(DetectionLimitDocument::from);
    let left_out = visible.left_out.iter().map(|own| SkippedTrialDocument::of(own, None));
    json!({
        "ok": true,
        "experiment": experiment.file,
        "title": experiment.title,
        "patch": experiment.patch.file(),
        "diagnostics": experiment.warnings.to_json(),
        "fit": experiment.fit,
        "records": records(experiment).map(|(part, record)| record_json(experiment, part, record)).collect::<Value>(),
        "effects": effects.collect::<Value>(),
        "nowhere": places.nowhere(),
        "nameless": places.nameless,
        "leaves": visible.leaves,
        "limits": limits.collect::<Vec<_>>(),
        "left_out": left_out.collect::<Vec<_>>(),
    })
}

fn record_json(experiment: &Experiment, part: &str, record: &Record) -> Value {
    json!({
        "part": part,
        "name": record.name,
        "begin": record.begin,
        "interval": record.interval,
        "samples": record.len(),
        "missing": record.missing(),
        "jitter": record.jitter,
        "columns": columns(experiment, record).iter().map(column_json).collect::<Value>(),
    })
}

fn column_json(column: &Column<'_>) -> Value {
    let is = &column.is;
    let below = |below: [f64; SHARES.len()]| -> Value {
        SHARES
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
        "least": is.least,
        "most": is.most,
        "rms": is.rms,
        "noise": is.noise.as_ref().map(|noise| json!({
            "sigma": noise.sigma, "kind": noise.kind.as_str(), "by_order": noise.by_order,
        })),
        "step": is.quantum,
        "repeated": is.repeats,
        "power_below": is.below.map(below),
        "samples_a_period": is.samples_a_period(column.interval),
    })
}
