//! The patch panel with its cords. The real panel's layout is not known: this one is arranged by us, a row of
//! parts after the other.

mod colour;
mod cords;
mod face;
mod floor;
mod network;
mod panel;

use serde_json::{Value, json};

use self::floor::Floor;
use super::describe;
use super::heading::{self, Heading};
use super::layout::Point;
use super::lists::{self, List};
use super::sheet::DrawError;
use super::symbol::{Source, Symbol};
use super::view::{Show, View};
use crate::plot::Drawing;
use patchcord_core::circuit::Circuit;

/// Modules with their jacks, and cords between them, in pixels from the upper left corner.
#[derive(Debug, Clone, PartialEq)]
pub struct Board {
    heading: Heading,
    /// The modules, row by row.
    pub modules: Vec<Module>,
    /// The cords, in the order of the jacks that they go into.
    pub cords: Vec<Cord>,
    /// The links between parts of elements that are wired as the panel shows.
    pub links: Vec<Link>,
    /// Headings of the rows of modules, with their places.
    rows: Vec<(String, Point)>,
    /// Lists below the panel: settings that the modules leave out, drives, signals, notes.
    pub lists: Vec<List>,
    size: (f64, f64),
}

/// A part of the machine, or a source, on the panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Module {
    /// Name of the element that it serves, or of the part; empty where the patch does not use it.
    pub name: String,
    /// The kind of that element, where the row does not say it.
    pub kind: String,
    /// What it is set to, or which element it belongs to.
    pub note: String,
    /// Its upper left and lower right corner.
    pub corners: [Point; 2],
    /// Its input jacks: what stands beside them, and their places.
    pub inputs: Vec<(String, Point)>,
    /// Its output jacks.
    pub outputs: Vec<Point>,
}

impl Module {
    /// The places of its jacks.
    pub fn jacks(&self) -> impl Iterator<Item = Point> {
        self.inputs.iter().map(|(_, at)| *at).chain(self.outputs.iter().copied())
    }

    /// Whether a point lies on it.
    fn holds(&self, (x, y): Point) -> bool {
        let [(left, top), (right, bottom)] = self.corners;
        (left..=right).contains(&x) && (top..=bottom).contains(&y)
    }
}

/// A link between two parts of one element, patched like a cord.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Name of the element.
    pub of: String,
    /// Where it is plugged in, output first.
    pub ends: [Point; 2],
    /// Its way.
    pub points: Vec<Point>,
}

/// A cord between two jacks.
#[derive(Debug, Clone, PartialEq)]
pub struct Cord {
    /// Name of the element, drive or reference that it comes from.
    pub from: String,
    /// Name of the element that it goes to.
    pub to: String,
    /// The input that it goes into.
    pub input: String,
    /// The gain of its jack, where jacks of the input have gains.
    pub gain: Option<f64>,
    /// Where it is plugged in, output first.
    pub ends: [Point; 2],
    /// Its way from plug to plug.
    pub points: Vec<Point>,
    /// Number of its colour: cords from one output have one, those near each other different ones where that is possible.
    pub colour: usize,
}

/// Room around the panel.
const MARGIN: f64 = 28.0;

/// Room below the panel, in which low cords sag, above the lists.
const SAGGING: f64 = 44.0;

/// Said under every panel.
const ARRANGED: &str = "layout of the panel arranged by us: that of the machine is not known";

impl Board {
    /// More cords cannot be followed, and take too long to lay.
    pub const MOST_CORDS: usize = 150;

    /// The board of a circuit; `note` is small print.
    ///
    /// # Errors
    /// When the circuit has more elements and drives than a sheet takes, or more cords than a panel.
    pub fn new(circuit: &Circuit, note: &str) -> Result<Board, DrawError> {
        let symbols = describe::symbols(&View::new(circuit, Show::Elements), &|_| None);
        DrawError::check(symbols.len())?;
        let count = symbols.iter().map(|symbol| symbol.jacks.len()).sum();
        if count > Board::MOST_CORDS {
            return Err(DrawError::TooManyCords { count });
        }
        let title = &circuit.patch().title;
        let machine = format!("{}; {ARRANGED}", describe::machine_line(circuit));
        let width = heading::width(panel::WIDTH, title);
        let heading = Heading::new(title, &[&machine, note], width);
        let mut laid = panel::lay(circuit, &symbols, (MARGIN, MARGIN + heading.height()));
        let (cords, links) = (cords(&symbols, &mut laid), links(&symbols, &mut laid));
        let lists = listed(circuit, &symbols);
        let size = (width, laid.bottom + SAGGING);
        let mut board = Board { heading, modules: laid.modules, cords, links, rows: laid.rows, lists, size };
        board.hang();
        Ok(board)
    }

    /// Lays cords and links past what stands on the empty panel.
    fn hang(&mut self) {
        let mut marks = self.heading.draw((MARGIN, MARGIN));
        face::draw_jacks(&self.modules, &mut marks);
        face::draw_texts(&self.modules, &self.rows, &mut marks);
        let mut floor = Floor::new((self.size.0 + 2.0 * MARGIN, self.size.1), &marks);
        let ends = self.cords.iter().map(|cord| cord.ends).chain(self.links.iter().map(|link| link.ends));
        let mut ways = floor.lay(&ends.collect::<Vec<_>>()).into_iter();
        self.cords.iter_mut().zip(&mut ways).for_each(|(cord, way)| cord.points = way);
        self.links.iter_mut().zip(ways).for_each(|(link, way)| link.points = way);
        colour::colour(&mut self.cords, &self.modules);
    }

    /// The drawing of the board.
    pub fn drawing(&self) -> Drawing {
        let mut marks = self.heading.draw((MARGIN, MARGIN));
        face::draw(&self.modules, &mut marks);
        self.cords.iter().for_each(|cord| cords::draw(cord, &mut marks));
        self.links.iter().for_each(|link| cords::draw_link(&link.points, &mut marks));
        face::draw_jacks(&self.modules, &mut marks);
        self.cords.iter().for_each(|cord| cords::draw_plugs(cord, &mut marks));
        self.links.iter().for_each(|link| cords::draw_pins(link.ends, &mut marks));
        face::draw_texts(&self.modules, &self.rows, &mut marks);
        if !self.links.is_empty() {
            face::draw_legend((MARGIN, self.size.1), &mut marks);
        }
        let (listed, bottom) = lists::draw(&self.lists, (MARGIN, self.size.1 + MARGIN), self.size.0);
        marks.extend(listed);
        Drawing { width: self.size.0 + 2.0 * MARGIN, height: bottom + MARGIN, marks }
    }

    /// Modules with their places, and cords with their ends.
    pub fn to_json(&self) -> Value {
        let module = |module: &Module| {
            let inputs = module.inputs.iter().map(|(name, at)| json!({"jack": name, "at": [at.0, at.1]}));
            json!({
                "name": module.name,
                "kind": module.kind,
                "note": module.note,
                "corners": module.corners.iter().map(|at| json!([at.0, at.1])).collect::<Value>(),
                "inputs": inputs.collect::<Value>(),
                "outputs": module.outputs.iter().map(|at| json!([at.0, at.1])).collect::<Value>(),
            })
        };
        let cord = |cord: &Cord| {
            let ends = cord.ends.iter().map(|at| json!([at.0, at.1])).collect::<Value>();
            json!({
                "from": cord.from,
                "to": cord.to,
                "jack": cord.input,
                "gain": cord.gain,
                "ends": ends,
                "colour": cord.colour,
            })
        };
        let link = |link: &Link| json!({"of": link.of, "ends": link.ends.iter().map(|at| json!([at.0, at.1])).collect::<Value>()});
        json!({
            "modules": self.modules.iter().map(module).collect::<Value>(),
            "cords": self.cords.iter().map(cord).collect::<Value>(),
            "links": self.links.iter().map(link).collect::<Value>(),
        })
    }
}

/// The lists below the panel; potentiometers that are set by what an amplifier does stand among the settings.
fn listed(circuit: &Circuit, symbols: &[Symbol]) -> Vec<List> {
    let named: Vec<_> = symbols.iter().map(|symbol| ("", symbol)).collect();
    let mut lists = describe::lists(circuit, &named, panel::tells);
    let turned = network::turned(circuit, symbols);
    match lists.first_mut().filter(|list| list.heading == "Settings") {
        Some(settings) => settings.rows.extend(turned),
        None if turned.is_empty() => (),
        None => lists.insert(0, List { heading: "Settings", rows: turned }),
    }
    lists
}

/// A cord for every jack that something is plugged into; each takes an output jack of its own.
fn cords(symbols: &[Symbol], laid: &mut panel::Laid) -> Vec<Cord> {
    let mut cords = Vec::new();
    for (reader, symbol) in symbols.iter().enumerate() {
        for (number, jack) in symbol.jacks.iter().enumerate() {
            let (from, module) = match jack.from {
                Source::Output(index, _) => (symbols[index].name.clone(), laid.module_of[index]),
                Source::Reference(name) => (name.to_owned(), laid.reference(name)),
            };
            let ends = [laid.output(module), laid.plugs[&(reader, number)]];
            let (to, input) = (symbol.name.clone(), jack.input.clone());
            cords.push(Cord { from, to, input, gain: jack.gain, ends, points: vec![], colour: 0 });
        }
    }
    cords
}

/// The links between the parts of elements.
fn links(symbols: &[Symbol], laid: &mut panel::Laid) -> Vec<Link> {
    let mut links = Vec::new();
    for (index, symbol) in symbols.iter().enumerate() {
        for [from, to] in network::links(symbol) {
            if let (Some(from), Some(to)) = (laid.jack(index, from), laid.jack(index, to)) {
                links.push(Link { of: symbol.name.clone(), ends: [from, to], points: vec![] });
            }
        }
    }
    links
}
