//! docs/hidden-effects.md: what the search said of all cases.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::judged::{Judged, Judgement};

/// What is told of cases whose gap is so large against the noise.
const BANDS: [(&str, f64, f64); 3] =
    [("0.3 ... 1", 0.0, 1.0), ("1 ... 3", 1.0, 3.0), ("above 3", 3.0, f64::INFINITY)];

pub fn page(judged: &[Judged]) -> String {
    let mut text = format!(
        "# Hidden effects\n\n\
         What `patchcord gap` says of {} experiments in which an effect is hidden, or none. The data come from a program that shares no code with\n\
         this one (`benches/hidden`), with other shapes of the same laws; the truth lies apart. `cargo bench --bench gap` makes them and writes this page.\n\n",
        judged.len()
    );
    text += &shares(judged);
    text += &confusion(judged);
    text
}

fn counted(judged: &[&Judged]) -> String {
    let count = |judgement| judged.iter().filter(|one| one.judgement == judgement).count();
    let all = judged.len();
    let cells = [
        Judgement::Right,
        Judgement::Half,
        Judgement::Among,
        Judgement::Refused,
        Judgement::Wrong,
        Judgement::FalseAlarm,
    ];
    let cells: Vec<_> = cells.into_iter().map(|judgement| format!("{}", count(judgement))).collect();
    format!("{all} | {}", cells.join(" | "))
}

fn shares(judged: &[Judged]) -> String {
    let mut text = String::from(
        "| hidden | gap over noise | cases | right | one of two | among two | refused | wrong name | false alarm |\n|---|---|---|---|---|---|---|---|---|\n",
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
    let mut times: Vec<f64> = judged.iter().map(|one| one.seconds).collect();
    times.sort_by(f64::total_cmp);
    if let (Some(median), Some(longest)) = (times.get(times.len() / 2), times.last()) {
        let _ = writeln!(text, "\nA search took {median:.1} s on one core (median), {longest:.0} s at most.");
    }
    text
}

/// What was said of every single effect.
fn confusion(judged: &[Judged]) -> String {
    let mut rows: BTreeMap<&str, BTreeMap<String, usize>> = BTreeMap::new();
    for one in judged {
        let said = match one.verdict {
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
