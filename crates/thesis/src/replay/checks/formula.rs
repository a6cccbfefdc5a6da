//! Claims that are decided by a formula in the row of the ledger, such as `is=0.6*HB HB=220`.
//!
//! The formula language is that of patches (`patchcord_expr`). A name in a formula is an argument of the same row. The
//! numbers have no dimension, so a row states its formula in any consistent units, often those of the thesis.

use super::super::check_arguments::{ArgumentError, CheckArguments};
use super::super::finding::Finding;
use super::{Check, CheckError};
use patchcord_expr::{Dimension, Formula, Scope};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "formula", run: formula },
    Check { name: "same", run: same },
    Check { name: "order", run: order },
];

/// The value of the formula `is` for the numbers of the row.
///
/// Example: claim 7-028 computes the pressure at which iron of hardness 220 flows, `is=0.6*HB HB=220`, which is 132
/// kgf/mm2.
fn formula(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(value(given, "is")?))
}

/// Checks whether the formulas `is` and `as` have the same value for the numbers of the row, to rounding.
///
/// "To rounding" is a relative difference of at most 1e-9. Claim 8-140 compares two forms of a derivative in this way.
/// If the thesis misprints a formula, the row holds the printed and the correct form, and the expected verdict is
/// "differs".
fn same(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (one, other) = (value(given, "is")?, value(given, "as")?);
    let holds = (one - other).abs() <= 1e-9 * one.abs();
    Ok(Finding::truth(holds, format!("{one:.5} and {other:.5}")))
}

/// Checks whether the value of `low` is less than that of `high`. This decides an order for which the thesis states no
/// size.
///
/// Example: claim 7-144 compares the exponents 0.018 and 0.165 with which friction falls with load. Equal values do not
/// hold.
fn order(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (low, high) = (value(given, "low")?, value(given, "high")?);
    Ok(Finding::shape(low < high, format!("{low:.4} and {high:.4}")))
}

/// The value of the formula in an argument.
///
/// # Errors
/// If the argument is missing, if its formula cannot be parsed or evaluated, or if a name in it is not an argument with
/// a number. A number that no formula uses is reported later, as an unread argument.
fn value(given: &CheckArguments, name: &str) -> Result<f64, CheckError> {
    let text = given.require(name)?;
    let wrong = |error: String| CheckError::Formula { text: text.to_owned(), error };
    let formula = Formula::parse(text).map_err(|error| wrong(error.to_string()))?;
    let names = formula.names();
    let numbers = names.iter().map(|name| given.number(name)).collect::<Result<Vec<_>, ArgumentError>>()?;
    let scope = Numbers { names: &names, numbers: &numbers };
    formula.evaluate(&scope).map_err(|error| wrong(error.to_string()))
}

/// The numbers in the row of a formula, by name. It is the scope in which the formula is evaluated.
struct Numbers<'n> {
    /// The names in the formula, each once.
    names: &'n [&'n str],
    /// Their values, in the order of the names.
    numbers: &'n [f64],
}

impl Scope for Numbers<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        self.names.iter().position(|known| *known == name).map(|index| self.numbers[index])
    }

    fn dimension(&self, _name: &str) -> Option<Dimension> {
        None
    }

    fn names(&self) -> Vec<&str> {
        self.names.to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(name: &str, text: &str) -> Result<Finding, CheckError> {
        super::super::run(name, &CheckArguments::parse(text).unwrap())
    }

    #[test]
    fn formula_is_evaluated_with_the_numbers_of_its_row() {
        assert_eq!(found("formula", "is=0.6*HB HB=220"), Ok(Finding::Number(132.0)));
        assert_eq!(found("formula", "is=2*x"), Err(ArgumentError::Missing("x".into()).into()));
        assert!(found("formula", "is=2*(").unwrap_err().to_string().starts_with("2*(: "));
        assert!(found("formula", "is=2 x=3").is_err());
    }

    #[test]
    fn formulas_are_compared() {
        assert_eq!(found("same", "is=a*a as=a^2 a=0.3"), Ok(Finding::truth(true, "0.09000 and 0.09000")));
        assert_eq!(found("same", "is=1 as=1.001"), Ok(Finding::truth(false, "1.00000 and 1.00100")));
        assert_eq!(found("order", "low=2 high=1"), Ok(Finding::shape(false, "2.0000 and 1.0000")));
    }
}
