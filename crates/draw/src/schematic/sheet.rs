//! The schematic as data, and as a drawing.

use indexmap::IndexMap;

use super::board::Board;
use super::diagram::{Diagram, Plan};
use super::heading::{self, Heading};
use super::layout::Point;
use super::lists::{self, List};
use super::symbol::Standing;
use super::view::{Show, View};
use super::{describe, shapes};
use crate::plot::{Drawing, Ink, Stroke};
use patchcord_core::circuit::Circuit;

/// Symbols with their places, and nets with their lines, in pixels from the upper left corner of the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Schematic {
    heading: Heading,
    /// The circuit, instances of macros as boxes.
    pub main: Diagram,
    /// The macros in it, opened.
    pub macros: Vec<Opened>,
    /// Lists below the drawing.
    pub lists: Vec<List>,
    /// Width of the drawing, and where it ends above the lists.
    width: f64,
    bottom: f64,
}

/// What is inside of a macro, as one of its instances has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Opened {
    heading: Heading,
    /// The macro.
    pub of: String,
    /// The instance whose settings, signals and voltages are shown.
    pub instance: String,
    /// Its ports, elements and cords, by the names that they have in the macro.
    pub diagram: Diagram,
    /// Where its heading stands.
    at: Point,
}

/// Why there is no schematic.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DrawError {
    /// More symbols than a person could find their way in.
    #[error("{count} symbols are too many for one sheet: {most} can be drawn", most = Schematic::MOST)]
    TooMany {
        /// How many there are.
        count: usize,
    },
    /// More cords than a person could follow on a panel.
    #[error("{count} cords are too many for one panel: {most} can be drawn", most = Board::MOST_CORDS)]
    TooManyCords {
        /// How many there are.
        count: usize,
    },
    /// More in one layer than a sheet has room for.
    #[error(
        "a drawing at least {height:.0} pixels high cannot be drawn: a side has at most {most} pixels",
        most = Drawing::LONGEST
    )]
    TooTall {
        /// How high it would be at least.
        height: f64,
    },
}

impl DrawError {
    /// Refuses more symbols than a sheet takes.
    pub(super) fn check(count: usize) -> Result<(), DrawError> {
        if count > Schematic::MOST { Err(DrawError::TooMany { count }) } else { Ok(()) }
    }
}

/// Room around everything.
const MARGIN: f64 = 28.0;

/// Room above a line across the sheet, and from there to what stands below it.
const RULE: f64 = 14.0;
const ABOVE: f64 = 20.0;

impl Schematic {
    /// The most symbols that are drawn on a sheet.
    pub const MOST: usize = 1000;

    /// The schematic of a circuit: instances of macros as boxes, and below it every macro once, opened. `standing`
    /// tells the voltages to be written at outputs and the positions of what switches, `instant` when they are so, `note` is
    /// small print. Sheets with and without voltages have everything in the same places.
    ///
    /// # Errors
    /// When more than [`Schematic::MOST`] symbols have to be drawn, or the sheet would be higher than [`Drawing::LONGEST`].
    pub fn new(
        circuit: &Circuit,
        note: &str,
        instant: &str,
        standing: &dyn Fn(&str) -> Option<Standing>,
    ) -> Result<Schematic, DrawError> {
        let first = used(circuit).into_values().map(|instances| Show::Inside(instances[0]));
        let shows: Vec<Show<'_>> = std::iter::once(Show::Boxes).chain(first).collect();
        Schematic::of(circuit, &shows, note, instant, standing)
    }

    /// The schematic of a circuit with every instance opened in its place.
    ///
    /// # Errors
    /// As for [`Schematic::new`].
    pub fn opened(
        circuit: &Circuit,
        note: &str,
        instant: &str,
        standing: &dyn Fn(&str) -> Option<Standing>,
    ) -> Result<Schematic, DrawError> {
        Schematic::of(circuit, &[Show::Elements], note, instant, standing)
    }

    fn of(
        circuit: &Circuit,
        shows: &[Show<'_>],
        note: &str,
        instant: &str,
        standing: &dyn Fn(&str) -> Option<Standing>,
    ) -> Result<Schematic, DrawError> {
        let views: Vec<View<'_>> = shows.iter().map(|show| View::new(circuit, *show)).collect();
        DrawError::check(views.iter().map(|view| view.items.len()).sum())?;
        let plans = views.iter().map(|view| Plan::new(describe::symbols(view, standing)));
        let plans: Vec<Plan> = plans.collect::<Result<_, _>>()?;
        let named = views.iter().zip(&plans);
        let named =
            named.flat_map(|(view, plan)| plan.symbols().iter().map(|symbol| (&*view.prefix, symbol)));
        let lists = describe::lists(circuit, &named.collect::<Vec<_>>(), shapes::tells);
        let patch = circuit.patch();
        let width = heading::width(plans.iter().map(|plan| plan.size().0).fold(0.0, f64::max), &patch.title);
        let machine = describe::machine_line(circuit);
        let small = [patch.source.as_str(), &machine, note];
        let heading = Heading::new(&patch.title, &small, width).with(instant, width);
        let bottom = MARGIN + heading.height();
        let (main, macros) = (Diagram::default(), Vec::new());
        let mut schematic = Schematic { heading, main, macros, lists, width, bottom };
        shows.iter().zip(plans).for_each(|(show, plan)| schematic.add(circuit, *show, plan));
        Ok(schematic)
    }

    /// Puts a diagram below what is there.
    fn add(&mut self, circuit: &Circuit, show: Show<'_>, plan: Plan) {
        let height = plan.size().1;
        let Show::Inside(instance) = show else {
            self.main = plan.placed((MARGIN, self.bottom));
            self.bottom += height;
            return;
        };
        let patch = circuit.patch();
        let of = &patch.instances[instance].of;
        let others = used(circuit)[of.as_str()][1..].join(", ");
        let others = if others.is_empty() { others } else { format!("also: {others}") };
        let notes = [patch.macros[of].note.as_str(), others.as_str()];
        let heading = Heading::new(&format!("Macro {of}, as in {instance}"), &notes, self.width);
        let at = (MARGIN, self.bottom + RULE + ABOVE);
        let top = at.1 + heading.height();
        let diagram = plan.placed((MARGIN, top));
        self.macros.push(Opened { heading, of: of.clone(), instance: instance.to_owned(), diagram, at });
        self.bottom = top + height;
    }

    /// The drawing of the schematic.
    pub fn drawing(&self) -> Drawing {
        let mut marks = self.heading.draw((MARGIN, MARGIN));
        self.main.draw(&mut marks);
        for opened in &self.macros {
            marks.push(self.rule(opened.at.1 - ABOVE));
            marks.extend(opened.heading.draw(opened.at));
            opened.diagram.draw(&mut marks);
        }
        let rule = self.bottom + RULE;
        let (listed, bottom) = lists::draw(&self.lists, (MARGIN, rule + ABOVE), self.width);
        if !listed.is_empty() {
            marks.push(self.rule(rule));
        }
        marks.extend(listed);
        Drawing { width: self.width + 2.0 * MARGIN, height: bottom + MARGIN / 2.0, marks }
    }

    /// A line across the sheet.
    fn rule(&self, y: f64) -> Stroke {
        Stroke::Line { points: vec![(MARGIN, y), (MARGIN + self.width, y)], width: 1.0, ink: Ink::Faint }
    }
}

/// The macros that are used, with the names of their instances.
fn used(circuit: &Circuit) -> IndexMap<&str, Vec<&str>> {
    let mut used: IndexMap<&str, Vec<&str>> = IndexMap::new();
    for (name, instance) in &circuit.patch().instances {
        used.entry(&instance.of).or_default().push(name);
    }
    used
}
