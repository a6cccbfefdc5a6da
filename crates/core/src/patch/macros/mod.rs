//! Macros: groups of elements with named ports, used several times in one patch.
//!
//! They are written out while the document is read: what comes later sees elements only, named "L1.A1". What
//! belongs together is kept beside, as [`Instance`].

mod check;
mod edit;
mod expand;
mod instance;
mod outline;
mod read;

use std::collections::HashSet;

use indexmap::IndexMap;

pub(super) use expand::write_out;
pub(super) use read::read;

use super::document::Entry;
use crate::document::Placed;
use crate::document::Span;
use patchcord_expr::Formula;
use patchcord_expr::Unit;

/// A group of elements with named ports, as the patch defines it.
#[derive(Debug, Clone)]
pub struct Macro {
    /// Free text.
    pub note: String,
    /// Input ports by name, each with what it is for.
    pub inputs: IndexMap<String, Placed<String>>,
    /// Output ports by name; the first is what the bare name of an instance means.
    pub outputs: IndexMap<String, MacroOutput>,
    /// What can be set on an instance, by name.
    pub settings: IndexMap<String, MacroSetting>,
    /// Where its name stands.
    pub span: Span,
    /// What it is made of.
    items: IndexMap<String, Item>,
    /// Names inside whose entries could not be read.
    lost: HashSet<String>,
}

/// An output port of a macro.
#[derive(Debug, Clone)]
pub struct MacroOutput {
    /// The element inside that it is, or an output of an instance inside; `None` where that could not be read.
    pub at: Option<Placed<String>>,
    /// Where the port's name stands.
    pub span: Span,
}

/// Something that can be set on the instances of a macro.
#[derive(Debug, Clone)]
pub struct MacroSetting {
    /// Its unit: plain numbers stand in it. `None` where the setting could not be read.
    pub unit: Option<Unit>,
    /// What it is where the instance does not say; without one the instance must.
    pub default: Option<Placed<Formula>>,
    /// What it does.
    pub description: String,
    /// Where its name stands.
    pub span: Span,
}

impl Macro {
    /// The names of the elements and instances that it is made of.
    pub fn parts(&self) -> impl Iterator<Item = &str> {
        self.items.keys().map(String::as_str)
    }
}

/// A use of a macro: one box of the patch, written out into elements.
///
/// It stands in [`Patch::instances`](super::Patch::instances) under its name, "L1", or "L1.inner" for an instance
/// inside another.
#[derive(Debug, Clone)]
pub struct Instance {
    /// The name of the macro that it is one of.
    pub of: String,
    /// The name of the instance that it stands inside, if any.
    pub around: Option<String>,
    /// Free text.
    pub note: String,
    /// Input ports by name: what drives them and what they drive.
    pub inputs: IndexMap<String, Inlet>,
    /// Output ports by name, each with the element that it is ("L1.A1").
    pub outputs: IndexMap<String, String>,
    /// Its settings by name.
    pub settings: IndexMap<String, InstanceSetting>,
    /// The names of its elements ("L1.A1"), those of instances inside it among them.
    pub members: Vec<String>,
    /// Where its name stands.
    pub span: Span,
}

/// An input port of an instance.
#[derive(Debug, Clone, Default)]
pub struct Inlet {
    /// The element, drive or reference that drives it; `None` where the patch is wrong.
    pub driver: Option<String>,
    /// The input port of the instance around it that brings it, if one does.
    pub port: Option<String>,
    /// The jacks of elements inside that it drives.
    pub feeds: Vec<Feed>,
}

/// A jack that an input port drives.
#[derive(Debug, Clone, PartialEq)]
pub struct Feed {
    /// The element ("L1.A2").
    pub element: String,
    /// Its jack ("x1", "in").
    pub jack: String,
}

/// A setting of an instance.
#[derive(Debug, Clone)]
pub struct InstanceSetting {
    /// Its value, of parameters, scales, and settings of an instance around it ("L1.T").
    pub value: Placed<Formula>,
    /// Its unit: a plain number stands in it.
    pub unit: Unit,
}

/// A name that cords outside of an instance give to an element inside it.
#[derive(Debug, Clone)]
pub(crate) struct Port {
    /// The element.
    pub at: String,
    /// Where the instance's name stands.
    pub span: Span,
}

/// What stands under a name in a section of elements.
#[derive(Debug, Clone)]
pub(super) enum Item {
    Element(Entry),
    Use(Use),
}

/// An instance of a macro as the document has it.
#[derive(Debug, Clone)]
pub(super) struct Use {
    /// The macro.
    of: Placed<String>,
    /// What is plugged into its ports.
    cords: IndexMap<String, Placed<Vec<Placed<String>>>>,
    /// Its settings; `None` where one could not be read.
    settings: IndexMap<String, Option<Placed<Formula>>>,
    /// Whether a key or a cord of it could not be understood: what seems to be missing may be that.
    doubtful: bool,
    note: String,
    span: Span,
}

/// The macros of a patch.
#[derive(Debug, Default)]
pub(super) struct Macros {
    defined: IndexMap<String, Macro>,
    /// Those that cannot be written out: they lack outputs or elements, hold themselves, or stand too deep inside
    /// each other.
    unusable: HashSet<String>,
    /// Names whose macros could not be read.
    lost: HashSet<String>,
    /// Whether the section could not be read.
    section_lost: bool,
    /// Where the section stands.
    span: Span,
}
