//! The schematic as data and as a drawing.
//!
//! The main diagram is at the top, followed by each macro and then by the lists.

use indexmap::IndexMap;

use super::board::Board;
use super::diagram::{Diagram, Plan};
use super::heading::{self, Heading};
use super::layout::Point;
use super::lists::{self, List};
use super::symbol::ElementState;
use super::view::{View, ViewScope};
use super::{describe, shapes};
use crate::plot::{Drawing, Ink, Primitive};
use patchcord_core::circuit::Circuit;

/// A schematic: symbols with positions and nets with lines.
///
/// Positions are in pixels from the upper left corner of the sheet.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_draw::schematic::Schematic;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let patch = PatchBuilder::new("Decay")
///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50))
///     .element("P1", ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.5))
///     .run(1.0, 1e-3)
///     .build()?;
///
/// // Without voltages
/// let schematic = Schematic::new(&Circuit::new(&patch)?, "a note", "", &|_| None)?;
/// let symbols = &schematic.main.symbols;
/// assert_eq!((symbols[0].symbol.name.as_str(), symbols[1].symbol.name.as_str()), ("A1", "P1"));
/// assert_eq!(schematic.main.nets.len(), 2);
/// assert!(schematic.macros.is_empty() && schematic.drawing().width > 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Schematic {
    /// The title, the source, the machine and the notes above the diagram.
    heading: Heading,
    /// The circuit, with macro instances as boxes or expanded.
    pub main: Diagram,
    /// Every macro of the circuit, opened once.
    pub macros: Vec<OpenedMacro>,
    /// The lists below the drawing.
    pub lists: Vec<List>,
    /// The width of the drawing without margins.
    width: f64,
    /// The lower edge of the last diagram.
    bottom: f64,
}

/// The inside of a macro, shown for one of its instances.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenedMacro {
    /// The name of the macro, its note and its other instances.
    heading: Heading,
    /// The name of the macro.
    pub of: String,
    /// The instance whose settings, signals and voltages are shown.
    pub instance: String,
    /// The ports, elements and cords, with their names in the macro.
    pub diagram: Diagram,
    /// The position of the heading.
    at: Point,
}

/// The reasons why a schematic or patch panel cannot be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DrawError {
    /// The sheet would have more than [`Schematic::MAX_SYMBOLS`] symbols.
    #[error("{count} symbols are too many for one sheet; the maximum is {max}", max = Schematic::MAX_SYMBOLS)]
    TooManySymbols {
        /// The number of symbols.
        count: usize,
    },
    /// The panel would have more than [`Board::MAX_CORDS`] cords.
    #[error("{count} cords are too many for one panel; the maximum is {max}", max = Board::MAX_CORDS)]
    TooManyCords {
        /// The number of cords.
        count: usize,
    },
    /// The sheet would be higher than [`Drawing::MAX_SIDE`].
    #[error(
        "the drawing would be at least {height} pixels high: a side has at most {max} pixels",
        height = height.ceil(), max = Drawing::MAX_SIDE
    )]
    TooTall {
        /// A lower bound of the height, in pixels.
        height: f64,
    },
}

impl DrawError {
    /// Returns an error if there are more symbols than a sheet may have.
    pub(super) fn check(count: usize) -> Result<(), DrawError> {
        if count > Schematic::MAX_SYMBOLS { Err(DrawError::TooManySymbols { count }) } else { Ok(()) }
    }
}

/// The margin around the sheet.
const MARGIN: f64 = 28.0;

/// The gap above a rule across the sheet.
const ABOVE_RULE: f64 = 14.0;
/// The gap below a rule.
const BELOW_RULE: f64 = 20.0;

impl Schematic {
    /// The maximum number of symbols on a sheet; more are not readable.
    pub const MAX_SYMBOLS: usize = 1000;

    /// Returns the schematic of a circuit: macro instances as boxes, and below it every macro once.
    ///
    /// `note` and `instant` are printed below the title. `state` returns the voltage and the switching
    /// position of an element for the drawing, or `None` to draw no voltages; `instant` is the text
    /// for the time of these voltages. Sheets with and without voltages have the same layout.
    ///
    /// # Errors
    ///
    /// If there are more than [`Schematic::MAX_SYMBOLS`] symbols, or the sheet would be higher than
    /// [`Drawing::MAX_SIDE`].
    ///
    /// # Examples
    ///
    /// With the voltages of all elements at an instant:
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_draw::schematic::{ElementState, Schematic};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("Decay")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50))
    ///     .element("P1", ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.5))
    ///     .run(1.0, 1e-3)
    ///     .build()?;
    ///
    /// let volts = |name: &str| if name == "A1" { 50.0 } else { 25.0 };
    /// let state = |name: &str| Some(ElementState { volts: volts(name), position: None });
    /// let schematic = Schematic::new(&Circuit::new(&patch)?, "", "voltages at t = 0", &state)?;
    /// assert_eq!(schematic.main.symbols[0].symbol.outputs[0].volts, Some(50.0));
    /// # Ok(())
    /// # }
    /// ```
    pub fn new(
        circuit: &Circuit,
        note: &str,
        instant: &str,
        state: &dyn Fn(&str) -> Option<ElementState>,
    ) -> Result<Schematic, DrawError> {
        let first = macros_in_use(circuit).into_values().map(|instances| ViewScope::Inside(instances[0]));
        let scopes: Vec<ViewScope<'_>> = std::iter::once(ViewScope::Boxes).chain(first).collect();
        Schematic::of(circuit, &scopes, note, instant, state)
    }

    /// Returns the schematic of a circuit with every macro instance replaced by its elements.
    ///
    /// # Errors
    ///
    /// As for [`Schematic::new`].
    pub fn expanded(
        circuit: &Circuit,
        note: &str,
        instant: &str,
        state: &dyn Fn(&str) -> Option<ElementState>,
    ) -> Result<Schematic, DrawError> {
        Schematic::of(circuit, &[ViewScope::Elements], note, instant, state)
    }

    /// Returns the schematic with one diagram for each scope, one below the other.
    ///
    /// All symbols are laid out before the first is placed, because the widest diagram sets the width of the sheet. The
    /// number of symbols is checked before that, since the layout takes most of the time.
    fn of(
        circuit: &Circuit,
        scopes: &[ViewScope<'_>],
        note: &str,
        instant: &str,
        state: &dyn Fn(&str) -> Option<ElementState>,
    ) -> Result<Schematic, DrawError> {
        let views: Vec<View<'_>> = scopes.iter().map(|scope| View::new(circuit, *scope)).collect();
        DrawError::check(views.iter().map(|view| view.items.len()).sum())?;
        let plans = views.iter().map(|view| Plan::new(describe::symbols(view, state)));
        let plans: Vec<Plan> = plans.collect::<Result<_, _>>()?;
        let named = views.iter().zip(&plans);
        let named =
            named.flat_map(|(view, plan)| plan.symbols().iter().map(|symbol| (&*view.prefix, symbol)));
        let lists = describe::lists(circuit, &named.collect::<Vec<_>>(), shapes::shows_setting);
        let patch = circuit.patch();
        let width = heading::width(plans.iter().map(|plan| plan.size().0).fold(0.0, f64::max), &patch.title);
        let machine = describe::machine_line(circuit);
        let notes = [patch.source.as_str(), &machine, note];
        let heading = Heading::new(&patch.title, &notes, width).with_suffix(instant, width);
        let bottom = MARGIN + heading.height();
        let (main, macros) = (Diagram::default(), Vec::new());
        let mut schematic = Schematic { heading, main, macros, lists, width, bottom };
        scopes.iter().zip(plans).for_each(|(scope, plan)| schematic.add(circuit, *scope, plan));
        Ok(schematic)
    }

    /// Adds a diagram below the last one.
    fn add(&mut self, circuit: &Circuit, scope: ViewScope<'_>, plan: Plan) {
        let height = plan.size().1;
        let ViewScope::Inside(instance) = scope else {
            self.main = plan.placed((MARGIN, self.bottom));
            self.bottom += height;
            return;
        };
        let patch = circuit.patch();
        let of = &patch.instances[instance].macro_name;
        let others = macros_in_use(circuit)[of.as_str()][1..].join(", ");
        let others = if others.is_empty() { others } else { format!("also: {others}") };
        let notes = [patch.macros[of].note.as_str(), others.as_str()];
        let heading = Heading::new(&format!("Macro {of}, as in {instance}"), &notes, self.width);
        let at = (MARGIN, self.bottom + ABOVE_RULE + BELOW_RULE);
        let top = at.1 + heading.height();
        let diagram = plan.placed((MARGIN, top));
        self.macros.push(OpenedMacro { heading, of: of.clone(), instance: instance.to_owned(), diagram, at });
        self.bottom = top + height;
    }

    /// Returns the drawing of the schematic with the lists below it.
    pub fn drawing(&self) -> Drawing {
        let mut primitives = self.heading.draw((MARGIN, MARGIN));
        self.main.draw(&mut primitives);
        for opened in &self.macros {
            primitives.push(self.rule(opened.at.1 - BELOW_RULE));
            primitives.extend(opened.heading.draw(opened.at));
            opened.diagram.draw(&mut primitives);
        }
        let rule = self.bottom + ABOVE_RULE;
        let (list_primitives, bottom) = lists::draw(&self.lists, (MARGIN, rule + BELOW_RULE), self.width);
        if !list_primitives.is_empty() {
            primitives.push(self.rule(rule));
        }
        primitives.extend(list_primitives);
        Drawing { width: self.width + 2.0 * MARGIN, height: bottom + MARGIN / 2.0, primitives }
    }

    /// Returns a rule across the sheet.
    fn rule(&self, y: f64) -> Primitive {
        Primitive::Line { points: vec![(MARGIN, y), (MARGIN + self.width, y)], width: 1.0, ink: Ink::Faint }
    }
}

/// Returns the macros in use with the names of their instances.
fn macros_in_use(circuit: &Circuit) -> IndexMap<&str, Vec<&str>> {
    let mut macros: IndexMap<&str, Vec<&str>> = IndexMap::new();
    for (name, instance) in &circuit.patch().instances {
        macros.entry(&instance.macro_name).or_default().push(name);
    }
    macros
}
