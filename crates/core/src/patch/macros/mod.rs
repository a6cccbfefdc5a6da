//! Macros: groups of elements with named ports, which a patch can use several times.
//!
//! `decode` reads the definitions and the instances. [`expand_macros`] then replaces every instance by its elements,
//! with names such as "L1.A1". It also replaces the names of ports by the names of the elements behind them. Later
//! phases therefore see elements only. Each instance is kept as an [`Instance`], from which drawings show it as one
//! box.
//!
//! The expansion first checks the definitions (`check`), so that a fault in a macro is reported once. `resolve` finds
//! the output that a cord means by a name, and the macros that contain themselves. `size` refuses an expansion that
//! would be too large. `expand` and `instance` do the expansion. `edit` changes instances and elements of a patch that
//! has been read.

mod check;
mod decode;
mod edit;
mod expand;
mod instance;
mod resolve;
mod size;

use std::collections::HashSet;

use indexmap::IndexMap;

pub(super) use decode::decode_macros;
pub(super) use expand::expand_macros;

use super::document::ElementEntry;
use crate::document::Placed;
use crate::document::Span;
use patchcord_expr::Formula;
use patchcord_expr::Unit;

/// The definition of a macro: a group of elements with named ports and settings.
#[derive(Debug, Clone)]
pub struct Macro {
    /// Free text; empty if the document has none.
    pub note: String,
    /// Input ports by name, each with its description. The position is that of the name.
    pub inputs: IndexMap<String, Placed<String>>,
    /// Output ports by name. The name of an instance alone means the first port.
    pub outputs: IndexMap<String, MacroOutput>,
    /// Settings of the instances by name.
    pub settings: IndexMap<String, MacroSetting>,
    /// Position of its name in the document.
    pub span: Span,
    /// The section "elements" of the macro.
    entries: IndexMap<String, SectionEntry>,
    /// Names in the section whose entries could not be read.
    unread: HashSet<String>,
}

/// An output port of a macro.
#[derive(Debug, Clone)]
pub struct MacroOutput {
    /// The element of the macro whose output it is, or the output of an instance inside the macro. `None` if it could
    /// not be read, or if the name of the port is used twice.
    pub element: Option<Placed<String>>,
    /// Position of the port's name in the document.
    pub span: Span,
}

/// A setting that instances of a macro can have.
#[derive(Debug, Clone)]
pub struct MacroSetting {
    /// Unit of plain numbers. `None` if the setting could not be read.
    pub unit: Option<Unit>,
    /// Value if the instance does not specify one. `None` if every instance must specify the setting.
    pub default: Option<Placed<Formula>>,
    /// Description for the reader; empty if the document has none.
    pub description: String,
    /// Position of its name in the document.
    pub span: Span,
}

impl Macro {
    /// The elements and instances inside the macro by name, as written.
    pub(super) fn section(&self) -> &IndexMap<String, SectionEntry> {
        &self.entries
    }

    /// The names of the elements and instances inside the macro, in the order of the document.
    pub fn element_names(&self) -> impl Iterator<Item = &str> {
        self.entries.keys().map(String::as_str)
    }
}

/// An instance of a macro after expansion.
///
/// Its key in [`Patch::instances`](super::Patch::instances) is its name: "L1", or "L1.inner" for an instance inside
/// another one.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::{ElementBuilder, MacroBuilder, PatchBuilder};
///
/// let gain = MacroBuilder::new()
///     .input("in", "voltage")
///     .output("out", "A")
///     .element("A", ElementBuilder::new("inverter").cord("in", "in"));
/// let patch = PatchBuilder::new("gain")
///     .define("gain", gain)
///     .element("G1", ElementBuilder::new("gain").cord("in", "+100"))
///     .build()?;
/// let instance = &patch.instances["G1"];
/// assert_eq!(instance.members, ["G1.A"]);
/// assert_eq!(instance.outputs["out"], "G1.A");
/// assert_eq!(instance.inputs["in"].driver.as_deref(), Some("+100"));
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Instance {
    /// Name of the macro.
    pub macro_name: String,
    /// Name of the instance that contains it. `None` if it is in the patch's own section.
    pub parent: Option<String>,
    /// Free text; empty if the document has none.
    pub note: String,
    /// Input ports by name.
    pub inputs: IndexMap<String, InstanceInput>,
    /// Output ports by name, each with the element whose output it is ("L1.A1").
    pub outputs: IndexMap<String, String>,
    /// Settings by name.
    pub settings: IndexMap<String, InstanceSetting>,
    /// Names of its elements ("L1.A1"), including those of instances inside it.
    pub members: Vec<String>,
    /// Position of its name in the document.
    pub span: Span,
}

/// An input port of an instance: its source and the jacks behind it.
#[derive(Debug, Clone, Default)]
pub struct InstanceInput {
    /// Name of the element, drive or reference that drives the port. `None` if the patch has a fault there.
    pub driver: Option<String>,
    /// The input port of the parent that is plugged into this port. `None` if the cord comes from another source.
    pub outer_port: Option<String>,
    /// The jacks inside the instance that the port drives.
    pub driven_jacks: Vec<DrivenJack>,
}

/// A jack that an input port of an instance drives.
#[derive(Debug, Clone, PartialEq)]
pub struct DrivenJack {
    /// Name of the element ("L1.A2").
    pub element: String,
    /// Name of the jack ("x1", "in").
    pub jack: String,
}

/// A setting of an instance.
#[derive(Debug, Clone)]
pub struct InstanceSetting {
    /// Its value. The formula may contain parameters, scales and settings of the parent ("L1.T").
    pub value: Placed<Formula>,
    /// Unit of a plain number.
    pub unit: Unit,
}

/// An output of an instance, under a name that cords outside the instance use: "L1" or "L1.minus".
#[derive(Debug, Clone)]
pub(crate) struct InstanceOutput {
    /// Name of the element inside the instance ("L1.A1").
    pub element: String,
    /// Position of the instance's name in the document.
    pub span: Span,
}

/// An entry of a section "elements": that of the patch or that of a macro.
#[derive(Debug, Clone)]
pub(super) enum SectionEntry {
    /// An element of a kind.
    Element(ElementEntry),
    /// An instance of a macro.
    Instance(InstanceEntry),
}

/// An instance of a macro in the document, before expansion.
#[derive(Debug, Clone)]
pub(super) struct InstanceEntry {
    /// Name of the macro.
    macro_name: Placed<String>,
    /// The names that are plugged into each input port. A valid instance has one name for each port.
    cords: IndexMap<String, Placed<Vec<Placed<String>>>>,
    /// The settings; `None` if a setting could not be read.
    settings: IndexMap<String, Option<Placed<Formula>>>,
    /// Whether a key or a cord could not be read. If so, a missing cord or setting is not reported, because it may be
    /// that one.
    is_incomplete: bool,
    /// Free text; empty if the document has none.
    note: String,
    /// Position of its name in the document.
    span: Span,
}

/// The macros of a patch.
#[derive(Debug, Default)]
pub(super) struct Macros {
    /// The definitions by name.
    defined: IndexMap<String, Macro>,
    /// Names of macros that cannot be expanded: they have no outputs or no elements, contain themselves, or are nested
    /// too deep.
    unusable: HashSet<String>,
    /// Names whose definitions could not be read.
    unread: HashSet<String>,
    /// Whether the whole section could not be read.
    is_section_unread: bool,
    /// Position of the section in the document.
    span: Span,
}
