//! docs/hidden-effects.md: what the search said of all cases.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::judged::{Judged, Judgement, Parameter};

/// What is told of cases whose gap is so large against the noise.
const BANDS: [(&str, f64, f64); 3] =
    [("0.3 ... 1", 0.0, 1.0), ("1 ... 3", 1.0, 3.0), ("above 3", 3.0, f64::INFINITY)];

pub fn page(judged: &[Judged]) -> String {
    let mut text = format!(
        "# Hidden effects\n\n\
         What `patchcord gap` says of {} experiments in which an effect is hidden, or none. The data come from a program that shares no code with\n\
         this one (`benches/hidden`), with other shapes of the same laws; the truth lies apart. `cargo bench --bench gap` makes them and writes this page.\n\n\
         *Gap over noise* is the rms that the best refitted base leaves, over the standard deviation of the noise. *Among two*: the data cannot tell, and one of both is the truth. *An alias*: what is named is another effect, which\n\
         some data cannot tell from the hidden one ([effects.md](effects.md) says which); *wrong name* are all others.\n\n",
        judged.len()
    );
    text += &shares(judged);
    text += &measures(judged);
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
    let kind = |one: &Judged| match one.truth.what.as_str() {
        "none" => "nothing",
        what if what.starts_with("unknown") => "an effect that the library does not have",
        what if what.contains('+') => "two effects",
        _ => "an effect",
    };
    for wanted in ["nothing", "an effect", "two effects", "an effect that the library does not have"] {
        let own: Vec<&Judged> = judged.iter().filter(|one| kind(one) == wanted).collect();
        if wanted == "nothing" {
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

/// How good what is rightly named is, and what it cost.
fn measures(judged: &[Judged]) -> String {
    let of = |is: &dyn Fn(&&Judged) -> bool| judged.iter().filter(|one| is(one)).count();
    let placed = judged.iter().filter_map(Judged::is_in_place);
    let (placed, in_place) = placed.fold((0, 0), |(all, own), is| (all + 1, own + usize::from(is)));
    let large = |one: &&Judged| one.truth.egnr > 3.0 && one.judgement == Judgement::Right;
    let parameters: Vec<&Parameter> = judged.iter().filter(large).flat_map(|one| &one.parameters).collect();
    let near = |within: f64| parameters.iter().filter(|own| own.off <= within).count();
    let covered = parameters.iter().filter(|own| own.is_covered).count();
    let named = |one: &&Judged| one.judgement == Judgement::Right && !one.named.is_empty();
    let clean = |within: f64| of(&|one| named(one) && one.held_out <= within);
    let mut times: Vec<f64> = judged.iter().map(|one| one.seconds).collect();
    times.sort_by(f64::total_cmp);
    let median = times.get(times.len() / 2).copied().unwrap_or_default();
    let longest = times.last().copied().unwrap_or_default();
    let rows = [
        ("named at the right place", format!("{in_place} of {placed}")),
        (
            "parameters of what is rightly named, gap over noise above 3: within 10 %",
            format!("{} of {}", near(0.1), parameters.len()),
        ),
        ("within 3 %", format!("{} of {}", near(0.03), parameters.len())),
        ("the true value in the interval of 95 %", format!("{covered} of {}", parameters.len())),
        (
            "data held back, after naming: within 10 % of the noise",
            format!("{} of {}", clean(1.1), of(&named)),
        ),
        ("within 5 %", format!("{} of {}", clean(1.05), of(&named))),
        ("time of a search on one core, median and longest", format!("{median:.1} s, {longest:.0} s")),
    ];
    let rows: String = rows.iter().map(|(what, told)| format!("| {what} | {told} |\n")).collect();
    format!("\n| measure | |\n|---|---|\n{rows}")
}

/// What was said of every single effect.
fn confusion(judged: &[Judged]) -> String {
    let mut rows: BTreeMap<&str, BTreeMap<String, usize>> = BTreeMap::new();
    for one in judged {
        let said = match one.verdict.as_str() {
            "named" | "ambiguous" => {
                let names: Vec<_> = one.named.iter().map(|(name, _)| name.as_str()).collect();
                names.join(if one.verdict == "named" { " + " } else { " or " })
            }
            verdict => verdict.to_owned(),
        };
        *rows.entry(one.truth.what.as_str()).or_default().entry(said).or_default() += 1;
    }
    let mut text = String::from("\n| hidden | cases | what was said |\n|---|---|---|\n");
    for (truth, said) in rows {
        let mut said: Vec<_> = said.into_iter().collect();
        said.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let all: usize = said.iter().map(|(_, count)| count).sum();
        let told: Vec<_> = said.iter().map(|(said, count)| format!("{said} {count}")).collect();
        let _ = writeln!(text, "| {truth} | {all} | {} |", told.join(", "));
    }
    text
}
