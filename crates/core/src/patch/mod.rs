//! The patch: a document with elements and cords, decoded into fields.
//!
//! `file` reads the text and `decode` fills the fields of a [`Patch`] from its JSON tree. `table_file` adds points from
//! CSV files, as far as `table_access` permits. `macros` replaces instances of macros by their elements. Every fault
//! becomes a diagnostic with a position, and decoding continues, so that a user sees all faults at once.
//!
//! [`PatchBuilder`] makes a patch in Rust. [`PatchEditor`] changes the fields of a patch and its document together;
//! `render` then writes the edits into the text, which otherwise stays as it is. `prune` and `cut` remove parts.
//! `grounded` plugs the open inputs of a patch to ground, so that it can run.
//!
//! A [`Problem`] is the document from which a patch can be made: equations with their quantities.

mod builder;
mod cord_faults;
mod cut;
mod decode;
mod decode_curve;
mod decode_entry;
mod decode_run;
mod document;
mod edit;
mod edited_text;
mod editor;
mod file;
mod grounded;
mod key_synonyms;
mod macros;
mod names;
mod picture_entry;
mod problem;
mod product_hints;
mod prune;
mod render;
mod schema;
mod short_forms;
mod table_access;
mod table_file;
mod time_units;

pub use builder::{
    ElementBuilder, MacroBuilder, ParameterBuilder, PatchBuilder, ScaleBuilder, SignalBuilder,
};
pub(crate) use cord_faults::{
    OpenInput, cord_hint, cord_notation, fixed_voltage_hint, no_cord, open_inputs, outputs_tied,
};
pub(crate) use document::UnreadNames;
pub use document::{
    Amount, ElementEntry, FORMAT_VERSION, Parameter, Patch, PictureSpec, Plug, RunPlan, Scale, Signal,
};
pub use edit::{Edit, EditError};
pub use editor::PatchEditor;
pub use macros::{DrivenJack, Instance, InstanceInput, InstanceSetting, Macro, MacroOutput, MacroSetting};
pub use names::{check_output_name, check_quantity_name, duplicate_name};
pub use picture_entry::PictureEntry;
pub use problem::{Problem, ProblemQuantity, ProblemTable};
pub use schema::json_schema;
pub use table_access::TableAccess;
pub use table_file::{time_order_hint, unreadable_unit};
pub(crate) use time_units::{is_time, is_time_dimensionless};
