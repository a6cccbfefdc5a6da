//! Sums that any chapter does, for rows that are no more than that.

use super::super::finding::{Finding, Printed};
use super::super::given::{Given, GivenError};
use super::{Check, CheckError};

pub(super) const CHECKS: &[Check] = &[
    Check { name: "sum", run: sum },
    Check { name: "product", run: product },
    Check { name: "quotient", run: quotient },
    Check { name: "product-of-digits", run: product_of_digits },
];

/// The sum of numbers.
fn sum(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(given.numbers("of")?.iter().sum()))
}

/// The product of numbers.
fn product(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(given.numbers("of")?.iter().product()))
}

/// A number by another.
fn quotient(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(given.number("of")? / given.number("by")?))
}

/// Whether a printed number is the product of two others, as far as their last digits tell: each may be off by half of one.
fn product_of_digits(given: &Given) -> Result<Finding, CheckError> {
    let [first, second, product] = ["a", "b", "is"].map(|name| printed(given, name));
    let (first, second, product) = (first?, second?, product?);
    let half = |number: &Printed| 0.5 * number.last_digit();
    let slack = half(&first) * second.number.abs() + half(&second) * first.number.abs() + half(&product);
    let got = first.number * second.number;
    let found = format!("{} x {} = {:.5}", first.text, second.text, got);
    Ok(Finding::truth((got - product.number).abs() <= slack, found))
}

fn printed(given: &Given, name: &str) -> Result<Printed, GivenError> {
    let text = given.need(name)?;
    Printed::parse(text)
        .ok_or_else(|| GivenError::NotANumber { name: name.to_owned(), text: text.to_owned() })
}
