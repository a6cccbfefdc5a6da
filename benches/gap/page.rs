//! docs/hidden-effects.md: what the search said of all cases.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::judged::{Judged, Judgement, Parameter};
use patchcord::ident::effects::Library;

/// What is told of cases whose gap is so large against the noise.
const BANDS: [(&str, f64, f64); 3] =
    [("0.3 ... 1", 0.0, 1.0), ("1 ... 3", 1.0, LARGE), ("above 3", LARGE, f64::INFINITY)];
/// From here on parameters are looked at.
const LARGE: f64 = 3.0;

/// The page, of so many cases or those of them that were searched.
pub fn page(judged: &[Judged], cases: usize, threads: usize) -> String {
    let effects = Library::shipped().iter().count();
    let hours = judged.iter().map(|one| one.seconds).sum::<f64>() / 3600.0;
    let searched = match judged.len() {
        all if all == cases => cases.to_string(),
        some => format!("{some} of {cases}"),
    };
    let mut text = format!(
        "# Hidden effects\n\n\
         What `patchcord gap` says of {searched} experiments in which an effect is hidden, or none. The data come from a program that shares no code with\n\
         this one (`benches/hidden`) and holds itself against closed solutions first, with other shapes of the same laws; the truth lies apart. `cargo bench --bench gap` makes them and writes this page;\n\
         [hidden-effects.jsonl](hidden-effects.jsonl) has every case: what was hidden, what was said, the parameters with their true values and intervals, what was left of the data held back.\n\n\
         *Gap over noise* is the rms that the best refitted base leaves, over the standard deviation of the noise. *Among two*: the data cannot tell, and of what they cannot tell apart something is hidden, at every step. *An alias*: what is named is another effect, which\n\
         some data cannot tell from the hidden one ([effects.md](effects.md) says which); *wrong name* are all others. *What the true laws leave* of the data held back is what they do with their true values, that is, the noise that was drawn for them. Every case has 2400 samples to train on and {effects} effects to try. All of them take {hours:.0} hours on one core:\n\
         a search of them may be broken off and taken up again, and cases found before and after a change of the program then stand beside one another.\n\n"
    );
    text += &measures(judged, threads);
    text += "\n## What was said, by what is hidden\n\n";
    text += &shares(judged);
    text += "\n## What was said of every effect\n\n";
    text += &confusion(judged);
    text
}

fn counted(judged: &[&Judged]) -> String {
    let count = |judgement| judged.iter().filter(|one| one.judgement == judgement).count();
    let all = judged.len();
    let cells: Vec<_> = Judgement::ALL.into_iter().map(|judgement| format!("{}", count(judgement))).collect();
    format!("{all} | {}", cells.join(" | "))
}

fn shares(judged: &[Judged]) -> String {
    let columns = Judgement::ALL.map(Judgement::as_str).join(" | ");
    let mut text = format!(
        "| hidden | gap over noise | cases | {columns} |\n|---|---|---{}|\n",
        "|---".repeat(Judgement::ALL.len())
    );
    for wanted in [NOTHING, ONE, TWO, UNKNOWN] {
        let own: Vec<&Judged> = judged.iter().filter(|one| kind(one) == wanted).collect();
        if wanted == NOTHING {
            let _ = writeln!(text, "| {wanted} | | {} |", counted(&own));
            continue;
        }
        for (band, low, high) in BANDS {
            let those: Vec<&Judged> =
                own.iter().copied().filter(|one| (low..high).contains(&one.truth.egnr)).collect();
            let _ = writeln!(text, "| {wanted} | {band} | {} |", counted(&those));
        }
    }
    text
}

const NOTHING: &str = "nothing";
const ONE: &str = "an effect";
const TWO: &str = "two effects";
const UNKNOWN: &str = "an effect that the library does not have";

/// What is hidden in a case.
fn kind(one: &Judged) -> &'static str {
    match one.truth.what.as_str() {
        "none" => NOTHING,
        what if what.starts_with("unknown") => UNKNOWN,
        what if what.contains('+') => TWO,
        _ => ONE,
    }
}

/// How often what is said is right, how good what is rightly named is, and what it cost.
fn measures(judged: &[Judged], threads: usize) -> String {
    let mut rows = names(judged);
    let right = |one: &&Judged| one.judgement == Judgement::Right && !one.named.is_empty();
    let named = judged.iter().filter(right);
    let place = share(judged.iter().filter_map(Judged::is_in_place), |is| *is);
    rows.push(("named at the right place".to_owned(), place));
    rows.extend(parameters(named.clone().filter(|one| one.truth.egnr > LARGE)));
    for (within, most) in [("10 %", 1.1), ("5 %", 1.05)] {
        let what = format!("data held back, after naming: within {within} of what the true laws leave");
        rows.push((what, share(named.clone(), |one| one.held_out <= most * one.truth.held_out)));
    }
    let on = if threads == 1 { "one core".to_owned() } else { format!("{threads} threads") };
    rows.push((format!("time for a case, on {on}"), times(judged)));
    let rows: String = rows.iter().map(|(what, told)| format!("| {what} | {told} |\n")).collect();
    format!("| measure | |\n|---|---|\n{rows}")
}

fn names(judged: &[Judged]) -> Vec<(String, String)> {
    use Judgement::{Alias, Among, FalseAlarm, Right, Wrong};
    let of = |kinds: &'static [&str]| judged.iter().filter(|one| kinds.contains(&kind(one)));
    let is = |wanted: &'static [Judgement]| move |one: &&Judged| wanted.contains(&one.judgement);
    let mut rows = Vec::new();
    for (band, low, high) in BANDS.into_iter().rev() {
        let those = of(&[ONE]).filter(|one| (low..high).contains(&one.truth.egnr));
        rows.push((format!("right name, gap over noise {band}"), share(those.clone(), is(&[Right]))));
        rows.push((format!("the same, or the truth among two, {band}"), share(those, is(&[Right, Among]))));
    }
    let pairs = of(&[TWO]).filter(|one| one.truth.egnr > LARGE);
    let others = [
        ("both of a pair named, gap over noise above 3", share(pairs, is(&[Right]))),
        ("wrong name, aliases merged", share(of(&[ONE, TWO]), is(&[Wrong]))),
        ("wrong name, aliases not merged", share(of(&[ONE, TWO]), is(&[Wrong, Alias]))),
        ("false alarm when nothing is missing", share(of(&[NOTHING]), is(&[FalseAlarm]))),
        ("unknown effect called by a library name", share(of(&[UNKNOWN]), is(&[Wrong]))),
    ];
    rows.extend(others.map(|(what, told)| (what.to_owned(), told)));
    rows
}

/// How near the parameters of what was rightly named come to the true ones.
fn parameters<'j>(named: impl Iterator<Item = &'j Judged>) -> Vec<(String, String)> {
    let own_law = |one: &'j Judged, own: &'j Parameter| (own, one.truth.has_own_law(&own.effect));
    let all: Vec<_> = named.flat_map(|one| one.parameters.iter().map(move |own| own_law(one, own))).collect();
    let those = |has: &'static [bool]| all.iter().filter(|(_, is)| has.contains(is)).map(|(own, _)| *own);
    let mut off: Vec<f64> = all.iter().map(|(own, _)| own.off()).collect();
    off.sort_by(f64::total_cmp);
    let near = share(off.iter(), |off| **off <= 0.1);
    let off = format!("{:.1} % off (median of {}), within 10 % in {near}", 100.0 * median(&off), off.len());
    let mut rows = vec![("parameter of the named effect, gap over noise above 3".to_owned(), off)];
    let laws: [(_, &[bool]); 3] = [
        ("the library's law is hidden", &[true]),
        ("its law is hidden in another shape", &[false]),
        ("either is", &[true, false]),
    ];
    for (whose, has) in laws {
        let told = [
            ("within 10 %", share(those(has), |own| own.off() <= 0.1)),
            ("within 3 %", share(those(has), |own| own.off() <= 0.03)),
            ("the true value in the interval of 95 %", share(those(has), |own| own.is_covered())),
        ];
        rows.extend(told.map(|(how, told)| (format!("the same where {whose}: {how}"), told)));
    }
    rows
}

fn share<T>(all: impl Iterator<Item = T>, is: impl Fn(&T) -> bool) -> String {
    let (count, own) = all.fold((0, 0), |(all, own), one| (all + 1, own + usize::from(is(&one))));
    format!("{:.1} % ({own} of {count})", 100.0 * own as f64 / f64::from(count.max(1)))
}

/// A search that takes no more seconds is quick.
const QUICK: f64 = 10.0;

fn times(judged: &[Judged]) -> String {
    let mut times: Vec<f64> = judged.iter().map(|one| one.seconds).collect();
    times.sort_by(f64::total_cmp);
    let [half, most] = [0.5, 0.95].map(|share| quantile(&times, share));
    let last = times.last().copied().unwrap_or_default();
    let quick = share(times.iter(), |time| **time <= QUICK);
    format!(
        "{half:.1} s (median), {QUICK} s or less in {quick}, {most:.0} s or less in 19 of 20, {last:.0} s at most"
    )
}

/// The middle of numbers in order.
fn median(sorted: &[f64]) -> f64 {
    quantile(sorted, 0.5)
}

/// A quantile of numbers in order.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = (sorted.len() as f64 * share).ceil() as usize;
    sorted.get(place.saturating_sub(1)).copied().unwrap_or_default()
}

/// What was said of every single effect.
fn confusion(judged: &[Judged]) -> String {
    let mut rows: BTreeMap<&str, BTreeMap<String, usize>> = BTreeMap::new();
    for one in judged {
        let said = match one.verdict.as_str() {
            "named" | "ambiguous" => {
                let mut names: Vec<_> = one.named.iter().map(|(name, _)| name.as_str()).collect();
                names.sort_unstable();
                names.join(if one.verdict == "named" { " + " } else { " or " })
            }
            verdict => verdict.to_owned(),
        };
        *rows.entry(one.truth.what.as_str()).or_default().entry(said).or_default() += 1;
    }
    let mut text = String::from("| hidden | cases | what was said |\n|---|---|---|\n");
    for (truth, said) in rows {
        let mut said: Vec<_> = said.into_iter().collect();
        said.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let all: usize = said.iter().map(|(_, count)| count).sum();
        let told: Vec<_> = said.iter().map(|(said, count)| format!("{said} {count}")).collect();
        let _ = writeln!(text, "| {truth} | {all} | {} |", told.join(", "));
    }
    text
}
