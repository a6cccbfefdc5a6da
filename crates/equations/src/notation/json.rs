//! Equations in JSON documents.

use serde::Serialize;

use super::{WrittenEquation, equation_latex, text};

/// An equation as a JSON document contains it: plain text for programs and readers, and LaTeX.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct EquationDocument {
    /// The text of the left side.
    pub left: String,
    /// The text of the right side.
    pub right: String,
    /// The text of the equation, on one line.
    pub text: String,
    /// The equation in LaTeX, without the signs that begin a formula in a LaTeX document.
    pub latex: String,
}

impl From<&WrittenEquation> for EquationDocument {
    /// Writes both sides and the whole equation.
    fn from(equation: &WrittenEquation) -> Self {
        let (left, right) = (text(&equation.left), text(&equation.right));
        Self { text: format!("{left} = {right}"), left, right, latex: equation_latex(equation) }
    }
}
