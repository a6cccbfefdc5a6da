//! The patch panel as a JSON value.

use serde::Serialize;
use serde_json::Value;

use super::{Board, Cord, Link, Module};
use crate::schematic::layout::Point;
use patchcord_core::document::json_value;

impl Board {
    /// Returns the modules with their positions and the cords with their ends.
    ///
    /// All positions are `[x, y]` in pixels from the upper left corner.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_draw::schematic::Board;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("Decay")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50))
    ///     .element("P1", ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.5))
    ///     .run(1.0, 1e-3)
    ///     .build()?;
    /// let json = Board::new(&Circuit::new(&patch)?, "")?.to_json();
    /// assert_eq!(json["cords"][0]["from"], "P1");
    /// assert_eq!(json["cords"][0]["to"], "A1");
    /// assert!(json["cords"][1]["gain"].is_null(), "the jack of a pot has no gain");
    /// # Ok(())
    /// # }
    /// ```
    pub fn to_json(&self) -> Value {
        json_value(&BoardSummary {
            modules: self.modules.iter().map(ModuleSummary::new).collect(),
            cords: self.cords.iter().map(CordSummary::new).collect(),
            links: self.links.iter().map(LinkSummary::new).collect(),
        })
    }
}

/// The content of a patch panel.
#[derive(Serialize)]
struct BoardSummary<'a> {
    /// The modules, row by row.
    modules: Vec<ModuleSummary<'a>>,
    /// The cords, in the order of the input jacks.
    cords: Vec<CordSummary<'a>>,
    /// The links between the parts of elements.
    links: Vec<LinkSummary<'a>>,
}

/// A module with its jacks.
#[derive(Serialize)]
struct ModuleSummary<'a> {
    /// The name of the element or of the part; empty if the patch does not use the part.
    name: &'a str,
    /// The kind of the element; empty if the heading of the row already contains it.
    kind: &'a str,
    /// The setting, or the element to which an auxiliary part belongs; may be empty.
    note: &'a str,
    /// The upper left and lower right corners, in pixels.
    corners: [Point; 2],
    /// The input jacks from the top down.
    inputs: Vec<InputSummary<'a>>,
    /// The positions of the output jacks from the top down, in pixels.
    outputs: &'a [Point],
}

/// An input jack of a module.
#[derive(Serialize)]
struct InputSummary<'a> {
    /// The label: a gain such as `10`, or the name of the input.
    jack: &'a str,
    /// The position in pixels.
    at: Point,
}

/// A cord between two jacks.
#[derive(Serialize)]
struct CordSummary<'a> {
    /// The name of the element, drive or reference at its output end.
    from: &'a str,
    /// The name of the element at its input end.
    to: &'a str,
    /// The name of the input.
    jack: &'a str,
    /// The gain of the input jack; `None` if the jacks of the input have no gains.
    gain: Option<f64>,
    /// The positions of the plugs in pixels, output first.
    ends: [Point; 2],
    /// The number of its colour, from 0.
    colour: usize,
}

/// A link between two parts of one element.
#[derive(Serialize)]
struct LinkSummary<'a> {
    /// The name of the element.
    of: &'a str,
    /// The positions of the plugs in pixels, output first.
    ends: [Point; 2],
}

impl<'a> ModuleSummary<'a> {
    /// Returns the summary of a module.
    fn new(module: &'a Module) -> ModuleSummary<'a> {
        ModuleSummary {
            name: &module.name,
            kind: &module.kind,
            note: &module.note,
            corners: module.corners,
            inputs: module.inputs.iter().map(|(jack, at)| InputSummary { jack, at: *at }).collect(),
            outputs: &module.outputs,
        }
    }
}

impl<'a> CordSummary<'a> {
    /// Returns the summary of a cord.
    fn new(cord: &'a Cord) -> CordSummary<'a> {
        CordSummary {
            from: &cord.from,
            to: &cord.to,
            jack: &cord.input,
            gain: cord.gain,
            ends: cord.ends,
            colour: cord.colour,
        }
    }
}

impl<'a> LinkSummary<'a> {
    /// Returns the summary of a link.
    fn new(link: &'a Link) -> LinkSummary<'a> {
        LinkSummary { of: &link.of, ends: link.ends }
    }
}
