//! The tables of the whole run (8.4667 s in equal steps of 20 us, recorded every 1 ms) and of the cost of recording.

use crate::backends::{BACKENDS, BackendChoice, Fig816, Steps};
use crate::peers::Peers;
use crate::timing::{Work, format_digits, format_seconds, in_turns};
use crate::{Outcome, page};

/// Step of the run in s, that of the patch.
pub(crate) const STEP: f64 = 20e-6;
/// Measurements of each work, in turns.
pub(crate) const ROUNDS: usize = 5;
/// Label of the first run of a program, which includes specialising and compiling.
pub(crate) const FIRST_RUN: &str = "first run";

/// The table of the whole run: C, and patchcord on every backend.
pub(crate) fn table(peers: &Peers, fig: &Fig816) -> Outcome<String> {
    let settings = fig.settings(Steps::Equal(STEP));
    let (length, steps) = (settings.duration(), settings.duration() / STEP);
    let c = |stem: &'static str| -> Work<'_> { Box::new(move || peers.c_seconds(stem, length, STEP)) };
    let mut entries = vec![
        ("C, kinks stepped over".to_owned(), c("fig_8_16")),
        ("C, kinks located".to_owned(), c("fig_8_16_located")),
    ];
    for (name, chosen) in BACKENDS {
        let (settings, first_settings) = (chosen(settings.clone()), chosen(settings.clone()));
        entries.push((format!("patchcord, {name}"), Box::new(move || Ok(fig.run(&settings)?.0))));
        let first_run: Work<'_> = Box::new(move || Ok(fig.run_first(&first_settings)?.0));
        entries.push((format!("patchcord, {name}, {FIRST_RUN}"), first_run));
    }
    let (names, works): (Vec<_>, Vec<_>) = entries.into_iter().unzip();
    let seconds = in_turns(ROUNDS, works)?;
    let row = |(name, duration): (String, &f64)| {
        let per_step = format!("{:.1} ns", duration / steps * 1e9);
        vec![name, format_seconds(*duration), per_step, format_digits(duration / seconds[0])]
    };
    let rows: Vec<_> = names.into_iter().zip(&seconds).map(row).collect();
    Ok(page::table(&["", "whole run", "a step", "times C"], &rows))
}

/// The table of recording: seven signals over 2 s at decreasing intervals, and every 1 ms over increasing lengths.
pub(crate) fn record_table(fig: &Fig816) -> Outcome<String> {
    let finer = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5].map(|every| (2.0, every));
    let longer = [0.5, 1.0, 4.0, 8.0].map(|length| (length, 1e-3));
    let mut rows = Vec::new();
    for (length, every) in finer.into_iter().chain(longer) {
        let settings = fig.settings(Steps::Equal(STEP)).with_duration(length).with_sample_interval(every);
        let work = |(_, chosen): BackendChoice| -> Work<'_> {
            let settings = chosen(settings.clone());
            Box::new(move || Ok(fig.run(&settings)?.0))
        };
        let seconds = in_turns(ROUNDS, BACKENDS.map(work).into())?;
        rows.push(
            [format!("{length} s"), format!("{every:e} s")]
                .into_iter()
                .chain(seconds.into_iter().map(format_seconds))
                .collect(),
        );
    }
    let names: Vec<&str> =
        ["length", "recorded every"].into_iter().chain(BACKENDS.map(|(name, _)| name)).collect();
    Ok(page::table(&names, &rows))
}
