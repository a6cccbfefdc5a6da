//! What is decided by putting numbers into a formula, written in the row: `is=0.6*HB HB=220`.

use super::super::finding::Finding;
use super::super::given::{Given, GivenError};
use super::{Check, CheckError};
use patchcord_expr::{Dimension, Formula, Scope};

pub(super) const CHECKS: &[Check] = &[
    Check { name: "formula", run: formula },
    Check { name: "same", run: same },
    Check { name: "order", run: order },
];

/// What a formula comes to for the numbers given.
fn formula(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(value(given, "is")?))
}

/// Whether two formulas come to the same for the numbers given, to rounding.
fn same(given: &Given) -> Result<Finding, CheckError> {
    let (one, other) = (value(given, "is")?, value(given, "as")?);
    let holds = (one - other).abs() <= 1e-9 * one.abs();
    Ok(Finding::truth(holds, format!("{one:.5} and {other:.5}")))
}

/// Whether a formula comes to less than another one for the numbers given: an order, where no size is stated.
fn order(given: &Given) -> Result<Finding, CheckError> {
    let (low, high) = (value(given, "low")?, value(given, "high")?);
    Ok(Finding::shape(low < high, format!("{low:.4} and {high:.4}")))
}

/// The value of the formula that an argument is.
fn value(given: &Given, name: &str) -> Result<f64, CheckError> {
    let text = given.need(name)?;
    let wrong = |error: String| CheckError::Formula { text: text.to_owned(), error };
    let formula = Formula::parse(text).map_err(|error| wrong(error.to_string()))?;
    let names = formula.names();
    let numbers = names.iter().map(|name| given.number(name)).collect::<Result<Vec<_>, GivenError>>()?;
    let scope = Numbers { names: &names, numbers: &numbers };
    formula.evaluate(&scope).map_err(|error| wrong(error.to_string()))
}

/// The numbers that stand beside a formula in its row.
struct Numbers<'n> {
    names: &'n [&'n str],
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
        super::super::run(name, &Given::parse(text).unwrap())
    }

    #[test]
    fn a_formula_is_worked_out_with_the_numbers_of_its_row() {
        assert_eq!(found("formula", "is=0.6*HB HB=220"), Ok(Finding::Number(132.0)));
        assert_eq!(found("formula", "is=2*x"), Err(GivenError::Missing("x".into()).into()));
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
