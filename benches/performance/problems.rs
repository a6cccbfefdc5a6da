//! The problems with known solutions: error and time, with equal steps and with a tolerance.

use patchcord::solve::RunSettings;

use crate::Outcome;
use crate::clock::{Work, in_turns, told};
use crate::library::{PROBLEMS, Problem};
use crate::own::{BACKENDS, Backend, ran};
use crate::page;
use crate::whole::ROUNDS;

const TOLERANCE: f64 = 1e-8;

pub fn table() -> Outcome<String> {
    let rows = PROBLEMS.iter().map(row).collect::<Outcome<Vec<_>>>()?;
    let equal = BACKENDS.map(|(name, _)| format!("time, {name}"));
    let adaptive = BACKENDS.map(|(name, _)| format!("time, {name}"));
    let head = ["", "step", "error"].into_iter().chain(equal.iter().map(String::as_str));
    let head = head.chain(["error of `--tol 1e-8`"]).chain(adaptive.iter().map(String::as_str));
    Ok(page::table(&head.collect::<Vec<_>>(), &rows))
}

fn row(problem: &Problem) -> Outcome<Vec<String>> {
    let (program, equal) = problem.program();
    let adaptive = RunSettings { tolerance: Some(TOLERANCE), ..equal.clone() };
    let mut row = vec![problem.name.to_owned(), told(problem.step)];
    for settings in [equal, adaptive] {
        row.push(format!("{:.1e}", problem.error(&program, &settings)));
        let work = |(_, chosen): Backend| -> Work<'_> {
            let (settings, program) = (chosen(settings.clone()), &program);
            Box::new(move || Ok(ran(program, &settings)?.0))
        };
        row.extend(in_turns(ROUNDS, BACKENDS.map(work).into())?.into_iter().map(told));
    }
    Ok(row)
}
