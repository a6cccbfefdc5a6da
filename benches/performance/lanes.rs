//! The table of cost by number of runs side by side, for the sweep of Fig 8.16.

use crate::backends::{COMPARED, Fig816};
use crate::timing::{Work, format_digits, in_turns, timed};
use crate::{Outcome, page, throughput};
use patchcord::solve::Backend;
use patchcord::sweep::Sweep;

/// The tried numbers of runs side by side.
const SIDE_BY_SIDE: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// Step of every run in s, the longest step of the sweep table.
const STEP: f64 = 1e-3 / 6.0;
/// Only every fifth run of the sweep is made, to save time.
const RUN_INTERVAL: usize = 5;
/// Measurements of each work, in turns.
const ROUNDS: usize = 3;

/// The table. The quick measurement makes every twentieth run.
pub(crate) fn table(fig: &Fig816, quick: bool) -> Outcome<String> {
    let interval = if quick { 4 * RUN_INTERVAL } else { RUN_INTERVAL };
    let backends = [Backend::Lanes, Backend::Automatic];
    let sweeps = backends.map(|backend| throughput::sweep(fig, backend, STEP));
    let sweeps = sweeps.into_iter().collect::<Outcome<Vec<_>>>()?;
    let cases = SIDE_BY_SIDE.iter().flat_map(|count| sweeps.iter().map(move |sweep| (sweep, *count)));
    let works = cases.map(|(sweep, count)| {
        Box::new(move || Ok(seconds_per_run_and_step(sweep, count, interval))) as Work<'_>
    });
    let seconds = in_turns(ROUNDS, works.collect())?;
    let rows = SIDE_BY_SIDE.iter().zip(seconds.chunks(backends.len())).map(|(count, of_count)| {
        let cells = of_count.iter().zip(&seconds).flat_map(|(together, alone)| {
            [format!("{} ns", format_digits(together * 1e9)), format_digits(alone / together)]
        });
        [count.to_string()].into_iter().chain(cells).collect::<Vec<_>>()
    });
    let head = backends.map(|backend| [format!("a run and step, {backend}"), "times one by one".to_owned()]);
    let head: Vec<_> =
        ["runs side by side".to_owned()].into_iter().chain(head.into_iter().flatten()).collect();
    let head: Vec<_> = head.iter().map(String::as_str).collect();
    Ok(page::table(&head, &rows.collect::<Vec<_>>()))
}

/// Duration of a step of one run in s, if `count` runs are made side by side. Every `interval`-th run of the sweep is
/// made.
fn seconds_per_run_and_step(sweep: &Sweep, count: usize, interval: usize) -> f64 {
    let runs: Vec<_> =
        (0..sweep.plan().runs()).step_by(interval).map(|run| sweep.plan().values(run)).collect();
    let mut runner = sweep.runner();
    let (seconds, ()) = timed(|| runs.chunks(count).for_each(|runs| drop(runner.rows(runs))));
    seconds / runs.len() as f64 * STEP / COMPARED
}
