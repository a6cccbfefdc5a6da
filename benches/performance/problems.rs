//! The problems with known solutions: error and time, with equal steps and with a tolerance.

use crate::clock::{Work, in_turns, told};
use crate::known::{self, Problem};
use crate::own::{BACKENDS, ran};
use crate::whole::ROUNDS;
use crate::{Outcome, page};
use patchcord::solve::RunSettings;

const TOLERANCE: f64 = 1e-8;

pub fn table() -> Outcome<String> {
    let rows = known::all().map(row).collect::<Outcome<Vec<_>>>()?;
    let equal = BACKENDS.map(|(name, _)| format!("time, {name}"));
    let head = ["", "over", "step", "error"].into_iter().chain(equal.iter().map(String::as_str));
    let head = head.chain(["error of `--tol 1e-8`", "time"]);
    Ok(page::table(&head.collect::<Vec<_>>(), &rows))
}

fn row(problem: &Problem) -> Outcome<Vec<String>> {
    let ready = problem.ready();
    let equal = &ready.settings;
    // A tolerance is kept by the reference, whatever the backend.
    let adaptive = &RunSettings { tolerance: Some(TOLERANCE), ..equal.clone() };
    let work = |settings: RunSettings| -> Work<'_> {
        let program = &ready.program;
        Box::new(move || Ok(ran(program, &settings)?.0))
    };
    let on_backends = BACKENDS.map(|(_, chosen)| work(chosen(equal.clone())));
    let error = |settings: &RunSettings| format!("{:.1e}", ready.error(settings));
    let mut times = in_turns(ROUNDS, on_backends.into_iter().chain([work(adaptive.clone())]).collect())?;
    let with_tolerance = times.pop().map(told);
    let mut row = vec![problem.name.to_owned(), told(problem.duration), told(equal.step), error(equal)];
    row.extend(times.into_iter().map(told));
    row.push(error(adaptive));
    row.extend(with_tolerance);
    Ok(row)
}
