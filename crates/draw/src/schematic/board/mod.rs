//! The patch panel with its cords.
//!
//! The layout of the original panel is not known. This panel has one row of modules for each kind of
//! part. The modules are placed first, then the cords are routed around texts and jacks, and then they
//! are coloured so that cords that meet or run close together differ.

mod colour;
mod composites;
mod cords;
mod corners;
mod face;
mod json;
mod module_rows;
mod panel;
mod routing;

pub use self::module_rows::jack_label;
use self::routing::PanelGrid;
use super::describe;
use super::heading::{self, Heading};
use super::layout::Point;
use super::lists::{self, List};
use super::sheet::DrawError;
use super::symbol::{CordSource, Symbol};
use super::view::{View, ViewScope};
use crate::plot::Drawing;
use patchcord_core::circuit::Circuit;

/// A patch panel: modules with jacks, and cords between them.
///
/// Positions are in pixels from the upper left corner.
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
/// let board = Board::new(&Circuit::new(&patch)?, "")?;
///
/// let cord = &board.cords[0];
/// assert_eq!((cord.from.as_str(), cord.to.as_str(), cord.gain), ("P1", "A1", Some(1.0)));
/// let cord = &board.cords[1];
/// assert_eq!((cord.from.as_str(), cord.input.as_str(), cord.gain), ("A1", "in", None));
/// assert!(board.links.is_empty() && board.drawing().height > 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Board {
    /// The title, the machine and the note above the panel.
    heading: Heading,
    /// The modules, row by row.
    pub modules: Vec<Module>,
    /// The cords, in the order of the input jacks.
    pub cords: Vec<Cord>,
    /// The links between the parts of elements.
    pub links: Vec<Link>,
    /// The headings of the rows of modules, with their positions.
    rows: Vec<(String, Point)>,
    /// The lists below the panel: settings that the modules do not show, drives, signals, notes.
    pub lists: Vec<List>,
    /// Width and height of the panel with its heading, without the lists.
    size: (f64, f64),
}

/// A module of the panel: a part of the machine, a reference or a drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Module {
    /// The name of the element or of the part; empty if the patch does not use the part.
    pub name: String,
    /// The kind of the element; empty if the heading of the row already contains it.
    pub kind: String,
    /// The setting, or the element to which an auxiliary part belongs.
    pub note: String,
    /// The upper left and lower right corners.
    pub corners: [Point; 2],
    /// The input jacks: labels and positions.
    pub inputs: Vec<(String, Point)>,
    /// The positions of the output jacks.
    pub outputs: Vec<Point>,
}

impl Module {
    /// Returns the positions of all jacks, inputs first.
    pub fn jacks(&self) -> impl Iterator<Item = Point> {
        self.inputs.iter().map(|(_, at)| *at).chain(self.outputs.iter().copied())
    }

    /// Whether a point is on the module.
    fn contains(&self, (x, y): Point) -> bool {
        let [(left, top), (right, bottom)] = self.corners;
        (left..=right).contains(&x) && (top..=bottom).contains(&y)
    }
}

/// A link between two parts of one element. It is plugged in like a cord.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// The name of the element.
    pub of: String,
    /// The positions of the plugs, output first.
    pub ends: [Point; 2],
    /// The points of its path.
    pub points: Vec<Point>,
}

/// A cord between two jacks.
#[derive(Debug, Clone, PartialEq)]
pub struct Cord {
    /// The name of the element, drive or reference at its output end.
    pub from: String,
    /// The name of the element at its input end.
    pub to: String,
    /// The name of the input.
    pub input: String,
    /// The gain of the input jack; `None` if the jacks of the input have no gains.
    pub gain: Option<f64>,
    /// The positions of the plugs, output first.
    pub ends: [Point; 2],
    /// The points of its path from plug to plug.
    pub points: Vec<Point>,
    /// The number of its colour. Cords from one output have the same colour; cords close to each other
    /// have different colours if possible.
    pub colour: usize,
}

/// Receives how much of the work is done, and all of it.
type ReportProgress<'p> = &'p mut dyn FnMut(usize, usize);

/// The margin around the panel.
const MARGIN: f64 = 28.0;

/// The space between the panel and the lists, for cords that run below the panel.
const CORD_SPACE: f64 = 44.0;

/// The note on every panel.
const LAYOUT_NOTE: &str = "layout of the panel arranged by us: that of the machine is not known";

impl Board {
    /// The maximum number of cords. More cords are not readable, and routing them takes too long.
    pub const MAX_CORDS: usize = 1000;

    /// Returns the patch panel of a circuit; `note` is printed below the title.
    ///
    /// # Errors
    ///
    /// If the circuit has more than [`super::Schematic::MAX_SYMBOLS`] elements and drives or more than
    /// [`Board::MAX_CORDS`] cords.
    pub fn new(circuit: &Circuit, note: &str) -> Result<Board, DrawError> {
        Board::with_progress(circuit, note, &mut |_, _| ())
    }

    /// Returns the patch panel of a circuit, like [`Board::new`], and reports progress.
    ///
    /// `progress` receives the number of routed cords and the number of all, in which a cord counts once per round of
    /// routing. Hundreds of cords take minutes.
    ///
    /// # Errors
    ///
    /// As for [`Board::new`].
    pub fn with_progress(
        circuit: &Circuit,
        note: &str,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<Board, DrawError> {
        let symbols = describe::symbols(&View::new(circuit, ViewScope::Elements), &|_| None);
        DrawError::check(symbols.len())?;
        let count = symbols.iter().map(|symbol| symbol.jacks.len()).sum();
        if count > Board::MAX_CORDS {
            return Err(DrawError::TooManyCords { count });
        }
        let title = &circuit.patch().title;
        let machine = format!("{}; {LAYOUT_NOTE}", describe::machine_line(circuit));
        let width = heading::width(panel::WIDTH, title);
        let heading = Heading::new(title, &[&machine, note], width);
        let mut layout = panel::lay_out(circuit, &symbols, (MARGIN, MARGIN + heading.height()));
        let (cords, links) = (cords(&symbols, &mut layout), links(&symbols, &mut layout));
        let lists = lists_below(circuit, &symbols);
        let size = (width, layout.bottom + CORD_SPACE);
        let mut board =
            Board { heading, modules: layout.modules, cords, links, rows: layout.rows, lists, size };
        board.route(progress);
        Ok(board)
    }

    /// Routes cords and links around the texts and jacks of the panel, and colours the cords.
    fn route(&mut self, progress: ReportProgress<'_>) {
        let mut primitives = self.heading.draw((MARGIN, MARGIN));
        face::draw_jacks(&self.modules, &mut primitives);
        face::draw_texts(&self.modules, &self.rows, &mut primitives);
        let mut grid = PanelGrid::new((self.size.0 + 2.0 * MARGIN, self.size.1), &primitives);
        let ends = self.cords.iter().map(|cord| cord.ends).chain(self.links.iter().map(|link| link.ends));
        let mut paths = grid.route(&ends.collect::<Vec<_>>(), progress).into_iter();
        self.cords.iter_mut().zip(&mut paths).for_each(|(cord, path)| cord.points = path);
        self.links.iter_mut().zip(paths).for_each(|(link, path)| link.points = path);
        colour::colour(&mut self.cords, &self.modules);
    }

    /// Returns the drawing of the panel with the lists below it.
    pub fn drawing(&self) -> Drawing {
        let mut primitives = self.heading.draw((MARGIN, MARGIN));
        face::draw(&self.modules, &mut primitives);
        self.cords.iter().for_each(|cord| cords::draw(cord, &mut primitives));
        self.links.iter().for_each(|link| cords::draw_link(&link.points, &mut primitives));
        face::draw_jacks(&self.modules, &mut primitives);
        self.cords.iter().for_each(|cord| cords::draw_plugs(cord, &mut primitives));
        self.links.iter().for_each(|link| cords::draw_pins(link.ends, &mut primitives));
        face::draw_texts(&self.modules, &self.rows, &mut primitives);
        if !self.links.is_empty() {
            face::draw_legend((MARGIN, self.size.1), &mut primitives);
        }
        let (list_primitives, bottom) = lists::draw(&self.lists, (MARGIN, self.size.1 + MARGIN), self.size.0);
        primitives.extend(list_primitives);
        Drawing { width: self.size.0 + 2.0 * MARGIN, height: bottom + MARGIN, primitives }
    }
}

/// Returns the lists below the panel. Potentiometers that are adjusted by observation are among the
/// settings.
fn lists_below(circuit: &Circuit, symbols: &[Symbol]) -> Vec<List> {
    let named: Vec<_> = symbols.iter().map(|symbol| ("", symbol)).collect();
    let mut lists = describe::lists(circuit, &named, module_rows::shows_setting);
    let adjustments = composites::adjustments(circuit, symbols);
    match lists.first_mut().filter(|list| list.heading == "Settings") {
        Some(settings) => settings.rows.extend(adjustments),
        None if adjustments.is_empty() => (),
        None => lists.insert(0, List { heading: "Settings", rows: adjustments }),
    }
    lists
}

/// Returns a cord for each input jack in use. Each cord has a separate output jack.
fn cords(symbols: &[Symbol], layout: &mut panel::PanelLayout) -> Vec<Cord> {
    let mut cords = Vec::new();
    for (reader, symbol) in symbols.iter().enumerate() {
        for (number, jack) in symbol.jacks.iter().enumerate() {
            let (from, module) = match jack.from {
                CordSource::Output(index, _) => (symbols[index].name.clone(), layout.module_of[index]),
                CordSource::Reference(name) => (name.to_owned(), layout.reference(name)),
            };
            let ends = [layout.output(module), layout.plugs[&(reader, number)]];
            let (to, input) = (symbol.name.clone(), jack.input.clone());
            cords.push(Cord { from, to, input, gain: jack.gain, ends, points: vec![], colour: 0 });
        }
    }
    cords
}

/// Returns the links between the parts of elements.
fn links(symbols: &[Symbol], layout: &mut panel::PanelLayout) -> Vec<Link> {
    let mut links = Vec::new();
    for (index, symbol) in symbols.iter().enumerate() {
        for [from, to] in composites::links(symbol) {
            if let (Some(from), Some(to)) = (layout.jack(index, from), layout.jack(index, to)) {
                links.push(Link { of: symbol.name.clone(), ends: [from, to], points: vec![] });
            }
        }
    }
    links
}
