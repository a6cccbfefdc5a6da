//! The text of docs/hidden-effects.md: success rates, judgements by kind of case, and verdicts by hidden effect.
//!
//! tests/docs.rs and benches/pysindy read the rows of the first table by their labels.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::case_result::{CaseResult, Judgement, ParameterEstimate};
use patchcord::Library;

/// Bands of gap over noise: label, lower limit, upper limit.
const BANDS: [(&str, f64, f64); 3] =
    [("0.3 ... 1", 0.0, 1.0), ("1 ... 3", 1.0, LARGE_GAP), ("above 3", LARGE_GAP, f64::INFINITY)];
/// Parameters are compared with the truth only if the gap over noise exceeds this limit.
const LARGE_GAP: f64 = 3.0;

/// The page. `cases` is the number of all cases, of which `results` may be a part; `threads` is the number per case.
pub(crate) fn page(results: &[CaseResult], cases: usize, threads: usize) -> String {
    let effects = Library::shipped().iter().count();
    let hours = results.iter().map(|result| result.seconds).sum::<f64>() / 3600.0;
    let searched = match results.len() {
        all if all == cases => cases.to_string(),
        searched => format!("{searched} of {cases}"),
    };
    let mut text = format!(
        "# Hidden effects\n\n\
         This page shows how often `patchcord gap` is right: on {searched} experiments with one or two hidden effects, or\n\
         none. A program that shares no code with patchcord makes the data (`benches/hidden`). It first compares itself\n\
         with closed solutions, and it uses other shapes of the same laws. The search cannot read the truth. `cargo bench\n\
         --bench gap` makes the experiments and writes this page.\n\n\
         [hidden-effects.jsonl](hidden-effects.jsonl) lists every case: the hidden effects, the verdict, the parameters with\n\
         their true values and intervals, and the residual on the validation data.\n\n\
         *Gap over noise* is the rms residual of the best refitted base, over the standard deviation of the noise. *Among\n\
         two*: the verdict is ambiguous, and at every step a hidden effect is among the named ones. *An alias*: the named\n\
         effect is another one, but some data cannot distinguish it from the hidden one ([effects.md](effects.md) says\n\
         which). *Wrong name*: any other effect is named. *The residual of the true laws* on the validation data is that of\n\
         the true laws with their true values, that is the noise in these data. Every case has 2400 training samples, and\n\
         the search tries {effects} effects. All cases together take {hours:.0} hours on one core. A run may be interrupted and\n\
         continued. Then results from before and after a change of the program are on the same page.\n\n"
    );
    text += &measure_table(results, threads);
    text += "\n## Judgements by kind of case\n\n";
    text += &judgement_table(results);
    text += "\n## Verdicts by hidden effect\n\n";
    text += &verdict_table(results);
    text
}

/// The cells of a row: the number of results, and the number of each judgement.
fn count_cells(results: &[&CaseResult]) -> String {
    let count = |judgement| results.iter().filter(|result| result.judgement == judgement).count();
    let all = results.len();
    let cells: Vec<_> = Judgement::ALL.into_iter().map(|judgement| format!("{}", count(judgement))).collect();
    format!("{all} | {}", cells.join(" | "))
}

/// The number of each judgement, by kind of case and gap over noise.
fn judgement_table(results: &[CaseResult]) -> String {
    let columns = Judgement::ALL.map(Judgement::as_str).join(" | ");
    let mut text = format!(
        "| hidden | gap over noise | cases | {columns} |\n|---|---|---{}|\n",
        "|---".repeat(Judgement::ALL.len())
    );
    for wanted in [NOTHING, ONE, TWO, UNKNOWN] {
        let of_kind: Vec<&CaseResult> = results.iter().filter(|result| kind(result) == wanted).collect();
        if wanted == NOTHING {
            let _ = writeln!(text, "| {wanted} | | {} |", count_cells(&of_kind));
            continue;
        }
        for (band, low, high) in BANDS {
            let in_band = |result: &&CaseResult| (low..high).contains(&result.truth.egnr);
            let in_band: Vec<&CaseResult> = of_kind.iter().copied().filter(in_band).collect();
            let _ = writeln!(text, "| {wanted} | {band} | {} |", count_cells(&in_band));
        }
    }
    text
}

/// Kind of a case without a hidden effect. This and the next three are labels of the page.
const NOTHING: &str = "nothing";
const ONE: &str = "an effect";
const TWO: &str = "two effects";
const UNKNOWN: &str = "an effect that the library does not have";

/// The kind of a case.
fn kind(result: &CaseResult) -> &'static str {
    match result.truth.what.as_str() {
        "none" => NOTHING,
        what if what.starts_with("unknown") => UNKNOWN,
        what if what.contains('+') => TWO,
        _ => ONE,
    }
}

/// The first table: rates of right names and places, accuracy of parameters and residuals, and the time of a case.
fn measure_table(results: &[CaseResult], threads: usize) -> String {
    let mut rows = name_rows(results);
    let is_right = |result: &&CaseResult| result.judgement == Judgement::Right && !result.named.is_empty();
    let named = results.iter().filter(is_right);
    let rate = share(results.iter().filter_map(CaseResult::is_in_place), |in_place| *in_place);
    rows.push(("named at the right place".to_owned(), rate));
    rows.extend(parameter_rows(named.clone().filter(|result| result.truth.egnr > LARGE_GAP)));
    for (within, factor) in [("10 %", 1.1), ("5 %", 1.05)] {
        let what = format!("data held back, after naming: within {within} of what the true laws leave");
        let is_near = |result: &&CaseResult| {
            result.validation_residual <= factor * result.truth.true_validation_residual
        };
        rows.push((what, share(named.clone(), is_near)));
    }
    let on = if threads == 1 { "one core".to_owned() } else { format!("{threads} threads") };
    rows.push((format!("time for a case, on {on}"), time_text(results)));
    let rows: String = rows.iter().map(|(label, value)| format!("| {label} | {value} |\n")).collect();
    format!("| measure | |\n|---|---|\n{rows}")
}

/// The rows on names: label and rate.
fn name_rows(results: &[CaseResult]) -> Vec<(String, String)> {
    use Judgement::{Alias, Among, FalseAlarm, Right, Wrong};
    let of = |kinds: &'static [&str]| results.iter().filter(|result| kinds.contains(&kind(result)));
    let is =
        |judgements: &'static [Judgement]| move |result: &&CaseResult| judgements.contains(&result.judgement);
    let mut rows = Vec::new();
    for (band, low, high) in BANDS.into_iter().rev() {
        let in_band = of(&[ONE]).filter(|result| (low..high).contains(&result.truth.egnr));
        rows.push((format!("right name, gap over noise {band}"), share(in_band.clone(), is(&[Right]))));
        rows.push((format!("the same, or the truth among two, {band}"), share(in_band, is(&[Right, Among]))));
    }
    let pairs = of(&[TWO]).filter(|result| result.truth.egnr > LARGE_GAP);
    let others = [
        ("both of a pair named, gap over noise above 3", share(pairs, is(&[Right]))),
        ("wrong name, aliases merged", share(of(&[ONE, TWO]), is(&[Wrong]))),
        ("wrong name, aliases not merged", share(of(&[ONE, TWO]), is(&[Wrong, Alias]))),
        ("false alarm when nothing is missing", share(of(&[NOTHING]), is(&[FalseAlarm]))),
        ("unknown effect called by a library name", share(of(&[UNKNOWN]), is(&[Wrong]))),
    ];
    rows.extend(others.map(|(label, rate)| (label.to_owned(), rate)));
    rows
}

/// The rows on the accuracy of parameters of rightly named effects, separately for shapes that the library has.
fn parameter_rows<'r>(named: impl Iterator<Item = &'r CaseResult>) -> Vec<(String, String)> {
    let with_law = |result: &'r CaseResult, estimate: &'r ParameterEstimate| {
        (estimate, result.truth.has_library_law(&estimate.effect))
    };
    let all: Vec<_> = named
        .flat_map(|result| result.parameters.iter().map(move |estimate| with_law(result, estimate)))
        .collect();
    let select = |laws: &'static [bool]| {
        all.iter().filter(|(_, has_law)| laws.contains(has_law)).map(|(estimate, _)| *estimate)
    };
    let mut errors: Vec<f64> = all.iter().map(|(estimate, _)| estimate.relative_error()).collect();
    errors.sort_by(f64::total_cmp);
    let near = share(errors.iter(), |error| **error <= 0.1);
    let median = 100.0 * quantile(&errors, 0.5);
    let accuracy = format!("{median:.1} % off (median of {}), within 10 % in {near}", errors.len());
    let mut rows = vec![("parameter of the named effect, gap over noise above 3".to_owned(), accuracy)];
    let laws: [(_, &[bool]); 3] = [
        ("the library's law is hidden", &[true]),
        ("its law is hidden in another shape", &[false]),
        ("either is", &[true, false]),
    ];
    for (law, selected) in laws {
        let rates = [
            ("within 10 %", share(select(selected), |estimate| estimate.relative_error() <= 0.1)),
            ("within 3 %", share(select(selected), |estimate| estimate.relative_error() <= 0.03)),
            (
                "the true value in the interval of 95 %",
                share(select(selected), |estimate| estimate.is_covered()),
            ),
        ];
        rows.extend(rates.map(|(what, rate)| (format!("the same where {law}: {what}"), rate)));
    }
    rows
}

/// The share of items for which a condition holds, such as "95.8 % (183 of 191)".
fn share<T>(items: impl Iterator<Item = T>, holds: impl Fn(&T) -> bool) -> String {
    let (all, count) = items.fold((0, 0), |(all, count), item| (all + 1, count + usize::from(holds(&item))));
    format!("{:.1} % ({count} of {all})", 100.0 * count as f64 / f64::from(all.max(1)))
}

/// The page counts the searches that take at most this time, in s.
const QUICK_SECONDS: f64 = 10.0;

/// Median, quick share, 95 % quantile and maximum of the times of all cases.
fn time_text(results: &[CaseResult]) -> String {
    let mut times: Vec<f64> = results.iter().map(|result| result.seconds).collect();
    times.sort_by(f64::total_cmp);
    let [median, most] = [0.5, 0.95].map(|share| quantile(&times, share));
    let longest = times.last().copied().unwrap_or_default();
    let quick = share(times.iter(), |time| **time <= QUICK_SECONDS);
    format!(
        "{median:.1} s (median), {QUICK_SECONDS} s or less in {quick}, {most:.0} s or less in 19 of 20, {longest:.0} s at most"
    )
}

/// A quantile of sorted numbers, such as the median for a share of 0.5. 0 without numbers.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let rank = (sorted.len() as f64 * share).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied().unwrap_or_default()
}

/// The verdicts for every hidden effect or pair, with their counts.
fn verdict_table(results: &[CaseResult]) -> String {
    let mut rows: BTreeMap<&str, BTreeMap<String, usize>> = BTreeMap::new();
    for result in results {
        let answer = match result.verdict.as_str() {
            "named" | "ambiguous" => {
                let mut names: Vec<_> = result.named.iter().map(|(name, _)| name.as_str()).collect();
                names.sort_unstable();
                names.join(if result.verdict == "named" { " + " } else { " or " })
            }
            verdict => verdict.to_owned(),
        };
        *rows.entry(result.truth.what.as_str()).or_default().entry(answer).or_default() += 1;
    }
    let mut text = String::from("| hidden | cases | verdicts |\n|---|---|---|\n");
    for (truth, answers) in rows {
        let mut answers: Vec<_> = answers.into_iter().collect();
        answers.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let all: usize = answers.iter().map(|(_, count)| count).sum();
        let cells: Vec<_> = answers.iter().map(|(answer, count)| format!("{answer} {count}")).collect();
        let _ = writeln!(text, "| {truth} | {all} | {} |", cells.join(", "));
    }
    text
}
