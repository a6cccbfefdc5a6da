//! The positions of the modules of a panel and of their jacks.
//!
//! `module_rows` specifies the rows. Here every module and every jack gets a position: the rows are
//! placed one below the other, and a row that is too long continues in a second line.

use std::collections::BTreeMap;

use super::Module;
use super::composites::LinkEnd;
use super::module_rows::{self, JUNCTION, JackId, ModuleRow, ModuleSpec, PartId};
use crate::schematic::layout::Point;
use crate::schematic::symbol::Symbol;
use patchcord_core::circuit::Circuit;

/// The width of the panel.
pub(super) const WIDTH: f64 = 1080.0;

/// The distance of neighbouring jacks of a module.
const JACK_PITCH: f64 = 21.0;
/// The height above the first jack of a module, for its name and note.
const HEAD_HEIGHT: f64 = 40.0;
/// The distance of the jacks from the edge of their module.
const JACK_INSET: f64 = 11.0;

/// The gap between modules.
const MODULE_GAP: f64 = 6.0;
/// The height of the heading of a row.
const ROW_HEADING: f64 = 18.0;

/// The modules of a panel with their positions.
pub(super) struct PanelLayout {
    /// The modules, row by row.
    pub modules: Vec<Module>,
    /// For each symbol, the module with its output.
    pub module_of: Vec<usize>,
    /// The modules of the parts of elements.
    parts: BTreeMap<PartId, usize>,
    /// The positions of the input jacks in use.
    pub plugs: BTreeMap<JackId, Point>,
    /// The headings of the rows, with their positions.
    pub rows: Vec<(String, Point)>,
    /// The lower edge of the last row.
    pub bottom: f64,
    /// The module of each reference.
    references: Vec<(&'static str, usize)>,
    /// For each module, the number of output jacks in use.
    used_outputs: Vec<usize>,
}

impl PanelLayout {
    /// Returns the module of a reference.
    pub(super) fn reference(&self, name: &str) -> usize {
        self.references.iter().find(|(other, _)| *other == name).map_or(0, |(_, module)| *module)
    }

    /// Returns the next free output jack of a module.
    pub(super) fn output(&mut self, module: usize) -> Point {
        self.used_outputs[module] += 1;
        self.modules[module].outputs[self.used_outputs[module] - 1]
    }

    /// Returns the jack at an end of a link of a symbol; `None` if the module has no such jack.
    pub(super) fn jack(&mut self, symbol: usize, end: LinkEnd) -> Option<Point> {
        let module = match end {
            LinkEnd::Input(part, number, _) | LinkEnd::Output(part, number) => {
                *self.parts.get(&(symbol, part, number))?
            }
            LinkEnd::ElementOutput | LinkEnd::Junction => self.module_of[symbol],
            LinkEnd::Reference(name) => self.reference(name),
        };
        let inputs = &self.modules[module].inputs;
        match end {
            LinkEnd::Input(.., slot) => inputs.get(slot).map(|(_, at)| *at),
            LinkEnd::Junction => inputs.iter().find(|(label, _)| label == JUNCTION).map(|(_, at)| *at),
            _ => Some(self.output(module)),
        }
    }
}

/// Lays out the panel below a corner: sources first, then the parts of the machine, then switches.
pub(super) fn lay_out(circuit: &Circuit, symbols: &[Symbol], corner: Point) -> PanelLayout {
    let mut layout = PanelLayout {
        modules: vec![],
        module_of: vec![0; symbols.len()],
        parts: BTreeMap::new(),
        plugs: BTreeMap::new(),
        rows: vec![],
        bottom: corner.1,
        references: vec![],
        used_outputs: vec![],
    };
    module_rows::of(circuit, symbols).into_iter().for_each(|row| layout.place_row(row, corner.0));
    layout
}

impl PanelLayout {
    /// Adds a row below the last one.
    ///
    /// The modules of a row have equal widths. The modules of a line have the height of the one with the most jacks.
    fn place_row(&mut self, row: ModuleRow, left: f64) {
        self.rows.push((row.heading, (left, self.bottom + ROW_HEADING - 5.0)));
        self.bottom += ROW_HEADING;
        let width = (WIDTH + MODULE_GAP) / row.across as f64 - MODULE_GAP;
        let mut modules = row.modules.into_iter().peekable();
        while modules.peek().is_some() {
            let line: Vec<ModuleSpec> = modules.by_ref().take(row.across).collect();
            let jacks = line.iter().map(|module| module.inputs.len().max(module.outputs)).max().unwrap_or(0);
            let height = HEAD_HEIGHT + JACK_PITCH * jacks as f64;
            for (column, spec) in line.into_iter().enumerate() {
                let corner = (left + column as f64 * (width + MODULE_GAP), self.bottom);
                self.place_module(spec, corner, (width, height));
            }
            self.bottom += height + MODULE_GAP;
        }
        self.bottom += MODULE_GAP;
    }

    /// Adds a module with its upper left corner and its size.
    fn place_module(&mut self, spec: ModuleSpec, (left, top): Point, (width, height): (f64, f64)) {
        if let Some(symbol) = spec.symbol {
            self.module_of[symbol] = self.modules.len();
        }
        self.references.extend(spec.reference.map(|name| (name, self.modules.len())));
        self.parts.extend(spec.part.map(|part| (part, self.modules.len())));
        let jack = |x: f64, number: usize| (x, top + HEAD_HEIGHT + 5.0 + JACK_PITCH * number as f64);
        let plugs = spec.inputs.iter().enumerate();
        let plugs = plugs.filter_map(|(number, (_, plug))| Some(((*plug)?, jack(left + JACK_INSET, number))));
        self.plugs.extend(plugs);
        let inputs = spec.inputs.into_iter().enumerate();
        self.used_outputs.push(0);
        self.modules.push(Module {
            name: spec.name,
            kind: spec.kind,
            note: spec.note,
            corners: [(left, top), (left + width, top + height)],
            inputs: inputs.map(|(number, (name, _))| (name, jack(left + JACK_INSET, number))).collect(),
            outputs: (0..spec.outputs).map(|number| jack(left + width - JACK_INSET, number)).collect(),
        });
    }
}
