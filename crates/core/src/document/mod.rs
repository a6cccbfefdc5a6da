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
mod foreign_text;
mod formula_error;
mod input_file;
mod json_value;
pub(crate) mod key_synonyms;
mod kind;
mod line_index;
mod named_variant;
mod parameter_range;
mod phase;
mod printable;
mod quantity;
mod report;
mod request;
pub mod tree;
mod typed_number;
mod values;
mod wording;

pub use code::{Code, CodeEntry};
pub use derivative::{derivative_name, derivative_of, derivative_unit};
pub use diagnostic::{Diagnostic, Severity, Span, any_error};
pub use file::{DocumentError, read_text, read_text_from};
pub(crate) use formula_error::{ADVICE_WITHOUT_SCALES, check_cycles, dimension_diagnostic, unit_advice};
pub use formula_error::{formula_diagnostic, unit_mismatch};
pub use input_file::InputFile;
pub use json_value::json_value;
pub use kind::DocumentKind;
pub use named_variant::read_variant;
pub use parameter_range::{ParameterRangeError, parameter_in_si};
pub(crate) use phase::RunExtent;
pub use phase::{ParameterChange, Phase, SwitchCondition};
pub use printable::{escape_controls, printable};
pub(crate) use quantity::possible_product;
pub use report::{DiagnosticDocument, Report};
pub use request::{MAX_VALUES, Request, RequestCommand, read_request};
pub use typed_number::{TypedNumber, TypedNumberError};
pub use values::{equation, formula, parse_unit, range};
pub(crate) use values::{equation_with_tables, formula_in};
pub(crate) use wording::MAX_SUGGESTIONS;
pub use wording::{
    format_distinct, format_number, format_outside, plural, range_violation, suggestion, unit_suffix,
};

/// A value that was read from a document, with its position in the text.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed<T> {
    /// The value.
    pub value: T,
    /// Its position. A value that a program made, rather than a document, has the empty span at 0.
    pub span: Span,
}

/// The largest number of characters of a name in a document or a table. Tables and pictures print names in full.
pub const MAX_NAME_CHARACTERS: usize = 200;

/// Whether a name has more than [`MAX_NAME_CHARACTERS`] characters.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::is_name_too_long;
///
/// assert!(!is_name_too_long(&"a".repeat(200)));
/// assert!(is_name_too_long(&"a".repeat(201)));
/// ```
pub fn is_name_too_long(name: &str) -> bool {
    name.chars().nth(MAX_NAME_CHARACTERS).is_some()
}

/// Name under which formulas can use the time scale, in machine seconds per problem second.
pub const TIME_SCALE: &str = "time_scale";

/// Largest time scale and largest input gain. The smallest ones are 1 / `MAX_FACTOR`. Every real machine is within
/// both.
const MAX_FACTOR: f64 = 1e12;

/// Whether a time scale or an input gain is within its limits.
pub(crate) fn is_allowed_factor(factor: f64) -> bool {
    (1.0 / MAX_FACTOR..=MAX_FACTOR).contains(&factor)
}

/// The diagnostic for a time scale or an input gain outside its limits. `what` is the subject of the message.
pub(crate) fn factor_violation(what: &str, factor: Placed<f64>) -> Option<Diagnostic> {
    let value = format_outside(factor.value, (1.0 / MAX_FACTOR, MAX_FACTOR));
    let message = format!("{what} must be from 1e-12 to 1e12, not {value}");
    (!is_allowed_factor(factor.value)).then(|| Diagnostic::at(Code::BAD_NUMBER, factor.span, message))
}

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
