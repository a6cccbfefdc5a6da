//! Unit tests of the normal form. Most of them are identities: both sides have the same normal form.

mod arithmetic;
mod derivatives;
mod functions;
mod long;
mod random_trees;

use crate::testing::reading::read_sides;

/// Asserts that both sides of each equation have the same normal form.
fn assert_equal(equations: &[&str]) {
    for equation in equations {
        let [left, right] = read_sides(equation);
        assert_eq!(left, right, "{equation}");
    }
}

/// Asserts that the sides of each equation have different normal forms.
fn assert_different(equations: &[&str]) {
    for equation in equations {
        let [left, right] = read_sides(equation);
        assert_ne!(left, right, "{equation}");
    }
}
