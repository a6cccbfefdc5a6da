//! The patch: a document, the formulas in it, and what can be said about it with its places.

mod builder;
mod code;
pub(crate) mod csv_rows;
mod decode;
mod decode_curve;
mod decode_entry;
mod decode_run;
mod derivative;
mod diagnostic;
mod document;
mod edit;
pub(crate) mod fields;
mod file;
mod formula;
mod function;
mod kind;
mod macros;
mod misfit;
mod names;
mod phase;
mod places;
mod schema;
mod table_file;
pub(crate) mod tree;
mod units;

pub use builder::{ElementBuilder, MacroBuilder, PatchBuilder};
pub use code::Code;
pub use diagnostic::{Diagnostic, Report, Severity, Span, suggestion};
pub(crate) use document::Lost;
pub use document::{
    Amount, Entry, FORMAT_VERSION, LEAST_TOLERANCE, Parameter, Patch, PictureSpec, Placed, Plug, RunPlan,
    Scale, Signal,
};
pub use edit::{Edit, EditError};
pub use file::PatchError;
pub use formula::{
    Callee, Expression, Formula, FormulaError, Measure as FormulaMeasure, Node, Operator, Scope,
};
pub use function::Function;
pub use macros::{Feed, Inlet, Instance, InstanceSetting, Macro, MacroOutput, MacroSetting};
pub(crate) use phase::Extent;
pub use phase::{Change, Phase, Until};
pub use schema::json_schema;
pub use units::{Dimension, Unit, UnitError, engineering};

pub(crate) use decode::{formula as formula_at, range, unit_of};
pub(crate) use derivative::{derivative_name, derivative_of, derivative_unit};
pub(crate) use diagnostic::{any_error, behind, outside, told};
pub(crate) use file::text_of;
pub(crate) use kind::DocumentKind;
pub(crate) use misfit::{in_formula, misfit};
pub(crate) use names::{TIME_SCALE, outlet_name, quantity_name, same_name};
pub(crate) use table_file::{no_unit, order_hint};
