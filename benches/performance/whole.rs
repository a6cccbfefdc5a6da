//! The whole run of 8.4667 s with equal steps of 20 us, recorded every 1 ms; and what recording costs.

use crate::clock::{Work, in_turns, three, told};
use crate::own::{self, BACKENDS, Fig816, Steps};
use crate::peers::Peers;
use crate::{Outcome, page};
use patchcord::solve::RunSettings;

pub const STEP: f64 = 20e-6;
/// How often everything is measured, in turns.
pub const ROUNDS: usize = 5;
/// What is said of a run of which the program has run never before.
pub const FIRST_RUN: &str = "first run";

pub fn table(peers: &Peers, fig: &Fig816) -> Outcome<String> {
    let settings = fig.settings(Steps::Equal(STEP));
    let (length, steps) = (settings.duration(), settings.duration() / STEP);
    let c = |stem: &'static str| -> Work<'_> { Box::new(move || peers.c_seconds(stem, length, STEP)) };
    let mut entries = vec![
        ("C, kinks stepped over".to_owned(), c("fig_8_16")),
        ("C, kinks located".to_owned(), c("fig_8_16_located")),
    ];
    for (name, chosen) in BACKENDS {
        let (settings, again) = (chosen(settings.clone()), chosen(settings.clone()));
        entries.push((format!("patchcord, {name}"), Box::new(move || Ok(fig.run(&settings)?.0))));
        let afresh: Work<'_> = Box::new(move || Ok(fig.run_afresh(&again)?.0));
        entries.push((format!("patchcord, {name}, {FIRST_RUN}"), afresh));
    }
    let (names, works): (Vec<_>, Vec<_>) = entries.into_iter().unzip();
    let seconds = in_turns(ROUNDS, works)?;
    let row = |(name, own): (String, &f64)| {
        vec![name, told(*own), format!("{:.1} ns", own / steps * 1e9), three(own / seconds[0])]
    };
    let rows: Vec<_> = names.into_iter().zip(&seconds).map(row).collect();
    Ok(page::table(&["", "whole run", "a step", "times C"], &rows))
}

/// The same with the seven signals recorded more and more finely over 2 s, and for longer and longer every 1 ms.
pub fn records(fig: &Fig816) -> Outcome<String> {
    let finer = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5].map(|every| (2.0, every));
    let longer = [0.5, 1.0, 4.0, 8.0].map(|length| (length, 1e-3));
    let mut rows = Vec::new();
    for (length, every) in finer.into_iter().chain(longer) {
        let own = RunSettings { every, ..fig.settings(Steps::Equal(STEP)).lasting(length) };
        let work = |(_, chosen): own::Backend| -> Work<'_> {
            let settings = chosen(own.clone());
            Box::new(move || Ok(fig.run(&settings)?.0))
        };
        let seconds = in_turns(ROUNDS, BACKENDS.map(work).into())?;
        rows.push(
            [format!("{length} s"), format!("{every:e} s")]
                .into_iter()
                .chain(seconds.into_iter().map(told))
                .collect(),
        );
    }
    let names: Vec<&str> =
        ["length", "recorded every"].into_iter().chain(BACKENDS.map(|(name, _)| name)).collect();
    Ok(page::table(&names, &rows))
}
