//! The problems with known solutions: error and time, with equal steps and with a tolerance.

use patchcord::solve::RunSettings;

use crate::Outcome;
use crate::clock::{shortest, told};
use crate::library::{PROBLEMS, Problem};
use crate::own::{BACKENDS, ran};
use crate::page;

const TOLERANCE: f64 = 1e-8;
const ROUNDS: usize = 5;

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
        for (_, chosen) in BACKENDS {
            let settings = chosen(settings.clone());
            row.push(told(shortest(ROUNDS, || Ok(ran(&program, &settings)?.0))?));
        }
    }
    Ok(row)
}
