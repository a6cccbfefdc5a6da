//! The table of the problems with known solutions: error and time, with equal steps and with a tolerance.

use crate::backends::{BACKENDS, run_timed};
use crate::known_problems::{self, Problem};
use crate::timing::{Work, format_seconds, in_turns};
use crate::whole_run::ROUNDS;
use crate::{Outcome, page};
use patchcord::solve::RunSettings;

/// The tolerance of the last two columns, in machine units.
const TOLERANCE: f64 = 1e-8;

/// The table.
pub(crate) fn table() -> Outcome<String> {
    let rows = known_problems::all().map(row).collect::<Outcome<Vec<_>>>()?;
    let equal = BACKENDS.map(|(name, _)| format!("time, {name}"));
    let head = ["", "over", "step", "error"].into_iter().chain(equal.iter().map(String::as_str));
    let head = head.chain(["error of `--tol 1e-8`", "time"]);
    Ok(page::table(&head.collect::<Vec<_>>(), &rows))
}

/// The row of a problem.
fn row(problem: &Problem) -> Outcome<Vec<String>> {
    let prepared = problem.prepare();
    let equal = &prepared.settings;
    // With a tolerance, every backend uses the reference.
    let adaptive = &equal.clone().with_tolerance(TOLERANCE);
    let work = |settings: RunSettings| -> Work<'_> {
        let program = &prepared.program;
        Box::new(move || Ok(run_timed(program, &settings)?.0))
    };
    let on_backends = BACKENDS.map(|(_, chosen)| work(chosen(equal.clone())));
    let error = |settings: &RunSettings| format!("{:.1e}", prepared.error(settings));
    let mut times = in_turns(ROUNDS, on_backends.into_iter().chain([work(adaptive.clone())]).collect())?;
    let with_tolerance = times.pop().map(format_seconds);
    let mut row = vec![
        problem.name.to_owned(),
        format_seconds(problem.duration),
        format_seconds(equal.step),
        error(equal),
    ];
    row.extend(times.into_iter().map(format_seconds));
    row.push(error(adaptive));
    row.extend(with_tolerance);
    Ok(row)
}
