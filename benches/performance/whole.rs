//! The whole run of 8.4667 s with equal steps of 20 us, recorded every 1 ms; and what recording costs.

use patchcord::solve::RunSettings;

use crate::Outcome;
use crate::clock::{in_turns, shortest, three, told};
use crate::own::{BACKENDS, Fig816, Steps};
use crate::page;
use crate::peers::Peers;

pub const STEP: f64 = 20e-6;
const ROUNDS: usize = 5;

pub fn table(peers: &Peers, fig: &Fig816) -> Outcome<String> {
    let settings = fig.settings(Steps::Equal(STEP));
    let (length, mut rows) = (settings.duration(), Vec::new());
    let steps = length / STEP;
    let c = || peers.c_seconds("fig_8_16", length, STEP);
    let mut row = |name: String, [base, own]: [f64; 2]| {
        rows.push(vec![name, told(own), format!("{:.1} ns", own / steps * 1e9), three(own / base)]);
    };
    let both = in_turns(ROUNDS, c, c)?;
    row("C, kinks stepped over".to_owned(), both);
    row(
        "C, kinks located".to_owned(),
        in_turns(ROUNDS, c, || peers.c_seconds("fig_8_16_located", length, STEP))?,
    );
    for (name, chosen) in BACKENDS {
        let settings = chosen(settings.clone());
        row(format!("patchcord, {name}"), in_turns(ROUNDS, c, || Ok(fig.run(&settings)?.0))?);
    }
    Ok(page::table(&["", "whole run", "a step", "times C"], &rows))
}

/// The same with the seven signals recorded more and more finely, over the first 2 s.
pub fn records(fig: &Fig816) -> Outcome<String> {
    let mut rows = Vec::new();
    for every in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
        let mut row = vec![format!("{every:e} s")];
        for (_, chosen) in BACKENDS {
            let own = RunSettings { every, ..fig.settings(Steps::Equal(STEP)).lasting(2.0) };
            let settings = chosen(own.clone());
            row.push(told(shortest(ROUNDS, || Ok(fig.run(&settings)?.0))?));
        }
        rows.push(row);
    }
    let names: Vec<&str> = ["recorded every"].into_iter().chain(BACKENDS.map(|(name, _)| name)).collect();
    Ok(page::table(&names, &rows))
}
