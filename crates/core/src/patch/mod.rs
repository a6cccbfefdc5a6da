//! The patch: what a document says, read, edited and built.

mod builder;
mod decode;
mod decode_curve;
mod decode_entry;
mod decode_run;
mod document;
mod edit;
mod file;
mod macros;
mod names;
mod render;
mod schema;
mod source;
mod table_file;

pub use builder::{ElementBuilder, MacroBuilder, ParameterBuilder, PatchBuilder};
pub(crate) use document::Lost;
pub use document::{
    Amount, Entry, FORMAT_VERSION, Parameter, Patch, PictureSpec, Plug, RunPlan, Scale, Signal,
};
pub use edit::{Edit, EditError, PatchEditor};
pub use macros::{Feed, Inlet, Instance, InstanceSetting, Macro, MacroOutput, MacroSetting};
pub use names::{outlet_name, quantity_name, same_name};
pub use schema::json_schema;
pub use table_file::{no_unit, order_hint};
