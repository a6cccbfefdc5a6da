//! What runs of the sweep of Fig 8.16 cost, the more of them are made side by side.

use crate::clock::{Work, in_turns, three, timed};
use crate::own::{COMPARED, Fig816};
use crate::{Outcome, page, throughput};
use patchcord::solve::Backend;
use patchcord::sweep::Sweep;

/// So many runs side by side are tried.
const SIDE_BY_SIDE: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// How every run steps, in seconds.
const STEP: f64 = 1e-3 / 6.0;
/// Every so many-th run is made.
const THINNED: usize = 5;
const ROUNDS: usize = 3;

pub fn table(fig: &Fig816, quick: bool) -> Outcome<String> {
    let thinned = if quick { 4 * THINNED } else { THINNED };
    let backends = [Backend::Lanes, Backend::Automatic];
    let sweeps = backends.map(|backend| throughput::sweep(fig, backend, STEP));
    let sweeps = sweeps.into_iter().collect::<Outcome<Vec<_>>>()?;
    let each = SIDE_BY_SIDE.iter().flat_map(|count| sweeps.iter().map(move |sweep| (sweep, *count)));
    let works =
        each.map(|(sweep, count)| Box::new(move || Ok(run_and_step(sweep, count, thinned))) as Work<'_>);
    let seconds = in_turns(ROUNDS, works.collect())?;
    let rows = SIDE_BY_SIDE.iter().zip(seconds.chunks(backends.len())).map(|(count, own)| {
        let told = own
            .iter()
            .zip(&seconds)
            .flat_map(|(own, alone)| [format!("{} ns", three(own * 1e9)), three(alone / own)]);
        [count.to_string()].into_iter().chain(told).collect::<Vec<_>>()
    });
    let head = backends.map(|backend| [format!("a run and step, {backend}"), "times one by one".to_owned()]);
    let head: Vec<_> =
        ["runs side by side".to_owned()].into_iter().chain(head.into_iter().flatten()).collect();
    let head: Vec<_> = head.iter().map(String::as_str).collect();
    Ok(page::table(&head, &rows.collect::<Vec<_>>()))
}

/// Seconds that a step of a run takes where so many are made at once.
fn run_and_step(sweep: &Sweep, count: usize, thinned: usize) -> f64 {
    let runs: Vec<_> =
        (0..sweep.plan().runs()).step_by(thinned).map(|run| sweep.plan().values(run)).collect();
    let mut bench = sweep.bench();
    let (seconds, ()) = timed(|| runs.chunks(count).for_each(|runs| drop(bench.rows(runs))));
    seconds / runs.len() as f64 * STEP / COMPARED
}
