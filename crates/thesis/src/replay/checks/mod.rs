//! The checks that decide claims, by name. Those of a subject stand in a file, one row each in its table.

mod describing;
mod design;
mod drive;
mod falling;
mod formula;
mod history;
mod limits;
mod others;
mod profiles;
mod recordings;
mod scaling;
mod shipped;
mod sliding;
mod stability;
mod standing;
mod surfaces;
mod swings;
mod wear;

use super::finding::Finding;
use super::given::{Given, GivenError};
use super::recipe::Problem;
use crate::slideway::SlidewayError;

/// A check: what it is called in the ledger, and how it finds what it finds.
struct Check {
    name: &'static str,
    run: fn(&Given) -> Result<Finding, CheckError>,
}

/// The tables of all subjects.
const TABLES: &[&[Check]] = &[
    describing::CHECKS,
    design::CHECKS,
    drive::CHECKS,
    falling::CHECKS,
    formula::CHECKS,
    history::CHECKS,
    limits::CHECKS,
    others::CHECKS,
    profiles::CHECKS,
    recordings::CHECKS,
    scaling::CHECKS,
    shipped::CHECKS,
    sliding::CHECKS,
    stability::CHECKS,
    standing::CHECKS,
    surfaces::CHECKS,
    swings::CHECKS,
    wear::CHECKS,
];

/// Why a check finds nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CheckError {
    /// A name that no check has.
    #[error("there is no check {0}")]
    Unknown(String),
    /// Arguments that are wrong.
    #[error(transparent)]
    Given(#[from] GivenError),
    /// A formula of a row that cannot be worked out.
    #[error("{text}: {error}")]
    Formula {
        /// The formula.
        text: String,
        /// What is wrong with it.
        error: String,
    },
    /// A law that does not hold for what it is given.
    #[error(transparent)]
    Slideway(#[from] SlidewayError),
    /// A run that cannot be made, or shows nothing.
    #[error("{0}")]
    Run(String),
}

impl From<Problem> for CheckError {
    fn from(problem: Problem) -> Self {
        CheckError::Run(problem.to_string())
    }
}

/// Runs a check by name. It has to ask for every argument: one that it does not know would say something that is not so.
pub(super) fn run(name: &str, given: &Given) -> Result<Finding, CheckError> {
    let mut all = TABLES.iter().copied().flatten();
    let check = all.find(|check| check.name == name).ok_or_else(|| CheckError::Unknown(name.to_owned()))?;
    let finding = (check.run)(given)?;
    given.all_asked()?;
    Ok(finding)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::replay::ledger;

    #[test]
    fn every_check_has_a_name_of_its_own() {
        let mut seen = HashSet::new();
        assert!(TABLES.iter().copied().flatten().all(|check| seen.insert(check.name)));
    }

    #[test]
    fn every_check_decides_a_claim() {
        let asked: HashSet<String> = ledger().unwrap().into_iter().filter_map(|claim| claim.check).collect();
        let checks = TABLES.iter().copied().flatten().map(|check| check.name);
        let unused: Vec<_> = checks.filter(|name| !asked.contains(*name)).collect();
        assert!(unused.is_empty(), "{unused:?}");
    }

    #[test]
    fn arguments_that_a_check_does_not_take_are_refused() {
        let given = Given::parse("B=50e-6 X=1").unwrap();
        assert_eq!(run("ridge-radius", &given).unwrap_err().to_string(), "the check takes no X");
        assert_eq!(run("no-such", &given).unwrap_err().to_string(), "there is no check no-such");
    }
}
