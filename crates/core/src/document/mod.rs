//! What all documents have in common: JSON with positions, typed keys, values, diagnostics and CSV tables.
//!
//! Reading a document has three steps. [`read_text`] reads the file. [`tree::parse`] turns the text into a tree in
//! which every value has its position. The decoders of patches, experiments and effects then take the keys with
//! [`fields::Fields`]. They collect a [`Diagnostic`] for every fault, so one [`Report`] shows all faults at once.
//!
//! # Examples
//!
//! ```
//! use patchcord_core::document::{Code, Report};
//! use patchcord_core::patch::Patch;
//!
//! let report: Box<Report> = Patch::parse("p.json", "{\"patchcord\": 1,}").unwrap_err();
//! assert_eq!(report.findings[0].code, Code::SYNTAX);
//! assert_eq!(report.findings[0].hint.as_deref(), Some("remove the last comma"));
//! ```

mod code;
pub mod csv_table;
mod derivative;
mod diagnostic;
pub mod fields;
pub(crate) mod file;
mod formula_error;
mod json_value;
mod kind;
mod line_index;
mod parameter_range;
mod phase;
mod printable;
mod quantity;
mod report;
pub mod tree;
mod values;
mod wording;

pub use code::{Code, CodeEntry};
pub use derivative::{derivative_name, derivative_of, derivative_unit};
pub use diagnostic::{Diagnostic, Severity, Span, any_error};
pub use file::{DocumentError, read_text};
pub use formula_error::{formula_diagnostic, unit_mismatch};
pub use json_value::json_value;
pub use kind::DocumentKind;
pub use parameter_range::{ParameterRangeError, parameter_in_si};
pub(crate) use phase::RunExtent;
pub use phase::{ParameterChange, Phase, SwitchCondition};
pub use printable::{escape_controls, printable};
pub use report::{DiagnosticDocument, Report};
pub use values::{formula, parse_unit, range};
pub(crate) use wording::MAX_SUGGESTIONS;
pub use wording::{format_number, plural, range_violation, suggestion, unit_suffix};

/// A value that was read from a document, with its position in the text.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed<T> {
    /// The value.
    pub value: T,
    /// Its position. A value that a program made, rather than a document, has the empty span at 0.
    pub span: Span,
}

/// Name under which formulas can use the time scale, in machine seconds per problem second.
pub const TIME_SCALE: &str = "time_scale";

/// The smallest tolerance of a run. Below it, rounding errors exceed the errors of the steps: none of the test
/// problems with a known solution becomes more accurate.
pub const MIN_TOLERANCE: f64 = 1e-13;
/// The largest tolerance of a run: an error of 100 V. A larger one would permit any result.
pub const MAX_TOLERANCE: f64 = 1.0;

/// Whether a tolerance of a run, in machine units of 100 V, is between [`MIN_TOLERANCE`] and [`MAX_TOLERANCE`].
///
/// # Examples
///
/// ```
/// use patchcord_core::document::is_tolerance;
///
/// assert!([1e-13, 1e-6, 1.0].into_iter().all(is_tolerance));
/// assert!([0.0, 1e-14, 2.0, f64::INFINITY, f64::NAN].into_iter().all(|value| !is_tolerance(value)));
/// ```
pub fn is_tolerance(value: f64) -> bool {
    (MIN_TOLERANCE..=MAX_TOLERANCE).contains(&value)
}
