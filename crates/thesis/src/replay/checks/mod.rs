//! The checks that decide claims, by name.
//!
//! Every file holds the checks of one subject and a table with one row for each of them. A check receives the
//! arguments of a claim and returns a [`Finding`]: a number, or whether a statement or a shape is as the thesis says.
//! The doc of a check names its arguments and their units.
//!
//! A row of the ledger names its check in the column `check` and its arguments in the column `given`. The row
//! `range-of-ridges,of=contacts N=3` runs `range_of_ridges` of `ridges`. Names of arguments are those of the thesis:
//! M, K, f, Fs, VcL, Tc, Pw. The words `of`, `by`, `with`, `part`, `way` and `it` select a quantity or a direction.
//!
//! A check states a number only in the unit of its claim. The comparison with the printed number and its tolerance is
//! not its work: see [`Claim`](super::claim::Claim).

mod adhesion;
mod describing;
mod design;
mod drive;
mod dry_sliding;
mod falling;
mod formula;
mod joint_at_rest;
mod limit_cycles;
mod lubricated_sliding;
mod measured;
mod other_circuits;
mod profiles;
mod ramps;
mod recordings;
mod rest;
mod ridges;
mod scaling;
mod shipped;
mod slope_laws;
mod stability;
mod stick_slip;
mod swings;
mod wear;

use super::check_arguments::{ArgumentError, CheckArguments};
use super::finding::Finding;
use super::recipe::BoxError;
use crate::slideway::SlidewayError;

/// A check: its name in the ledger and its function.
struct Check {
    /// The name in the ledger, such as "ridge-radius". Unique over all tables.
    name: &'static str,
    /// Computes the finding. It must read every argument of the row, because [`run`] refuses unread ones.
    run: fn(&CheckArguments) -> Result<Finding, CheckError>,
}

/// The tables of all files.
const TABLES: &[&[Check]] = &[
    adhesion::CHECKS,
    describing::CHECKS,
    design::CHECKS,
    drive::CHECKS,
    dry_sliding::CHECKS,
    falling::CHECKS,
    formula::CHECKS,
    joint_at_rest::CHECKS,
    limit_cycles::CHECKS,
    lubricated_sliding::CHECKS,
    measured::CHECKS,
    other_circuits::CHECKS,
    profiles::CHECKS,
    ramps::CHECKS,
    recordings::CHECKS,
    rest::CHECKS,
    ridges::CHECKS,
    scaling::CHECKS,
    shipped::CHECKS,
    slope_laws::CHECKS,
    stability::CHECKS,
    stick_slip::CHECKS,
    swings::CHECKS,
    wear::CHECKS,
];

/// The reason why a check has no finding.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckError {
    /// No check has this name.
    #[error("there is no check {0}")]
    Unknown(String),
    /// An argument is missing, unknown or wrong.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// A formula among the arguments cannot be evaluated.
    #[error("{text}: {error}")]
    Formula {
        /// The formula.
        text: String,
        /// The error in the formula.
        error: String,
    },
    /// A law does not hold for the arguments.
    #[error(transparent)]
    Slideway(#[from] SlidewayError),
    /// A run fails, or its recording does not contain what the check needs.
    #[error("{0}")]
    Run(String),
}

/// Errors of runs become texts, so that a check can use `?` on them. The kind of the error is lost; no caller needs it.
impl From<BoxError> for CheckError {
    fn from(problem: BoxError) -> Self {
        CheckError::Run(problem.to_string())
    }
}

/// Runs a check by name.
///
/// # Errors
/// If no check has the name, the check fails, or it did not read every argument. An argument that is not read would
/// suggest a condition that does not apply.
pub(super) fn run(name: &str, given: &CheckArguments) -> Result<Finding, CheckError> {
    let mut all = TABLES.iter().copied().flatten();
    let check = all.find(|check| check.name == name).ok_or_else(|| CheckError::Unknown(name.to_owned()))?;
    let finding = (check.run)(given)?;
    given.reject_unused()?;
    Ok(finding)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::replay::ledger;

    #[test]
    fn check_names_are_unique() {
        let mut seen = HashSet::new();
        assert!(TABLES.iter().copied().flatten().all(|check| seen.insert(check.name)));
    }

    #[test]
    fn every_check_is_used_by_a_claim() {
        let used: HashSet<String> = ledger().unwrap().into_iter().filter_map(|claim| claim.check).collect();
        let checks = TABLES.iter().copied().flatten().map(|check| check.name);
        let unused: Vec<_> = checks.filter(|name| !used.contains(*name)).collect();
        assert!(unused.is_empty(), "{unused:?}");
    }

    #[test]
    fn unknown_arguments_and_names_are_refused() {
        let given = CheckArguments::parse("B=50e-6 X=1").unwrap();
        assert_eq!(run("ridge-radius", &given).unwrap_err().to_string(), "the check takes no X");
        assert_eq!(run("no-such", &given).unwrap_err().to_string(), "there is no check no-such");
    }
}
