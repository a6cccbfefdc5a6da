//! What all documents have in common: JSON with positions, fields, values, diagnostics, CSV rows.

mod code;
pub mod csv_rows;
mod derivative;
mod diagnostic;
pub mod fields;
pub(crate) mod file;
mod kind;
mod misfit;
mod phase;
mod places;
mod range_violation;
pub mod tree;
mod values;

pub use code::Code;
pub use derivative::{derivative_name, derivative_of, derivative_unit};
pub use diagnostic::{Diagnostic, Report, Severity, Span, any_error, behind, outside, suggestion, told};
pub use file::{DocumentError, text_of};
pub use kind::DocumentKind;
pub use misfit::{in_formula, misfit};
pub(crate) use phase::Extent;
pub use phase::{Change, Phase, Until};
pub use range_violation::{RangeViolation, parameter_in_si};
pub use values::{formula, range, unit_of};

/// Something read from the document, with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed<T> {
    /// What was read.
    pub value: T,
    /// Where it stands.
    pub span: Span,
}

/// Name under which formulas reach the machine seconds per problem second.
pub const TIME_SCALE: &str = "time_scale";

/// The least tolerance of a run. Below it the rounding of numbers is more than what the steps err by: of the problems
/// with known solutions none comes nearer to its solution.
pub const LEAST_TOLERANCE: f64 = 1e-13;
