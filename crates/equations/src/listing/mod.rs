//! The equations of a patch as a reader sees them: in order, with initial values, drives, modes and tables.

mod document;
mod lister;
mod modes;
mod remarks;
mod tables;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;

use crate::derive::{Options, derive, simplified, without_unnamed_ramps};
use crate::notation::{
    LINE_WIDTH, Notation, WrittenEquation, aligned, latex, rounded, rounded_equation, text,
};
use crate::writing::Writer;
pub use document::{InitialDocument, ListingDocument};
use lister::Lister;
pub use modes::{ModeChange, ModeDescription};
pub use remarks::Remark;
pub use tables::TableDescription;

/// The most significant digits of a number in texts for readers. Further digits are mostly rounding of conversions.
const SHOWN_DIGITS: usize = 12;

/// How much of a patch its equations show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Detail {
    /// Signals, drives and states.
    #[default]
    Signals,
    /// Every element, in volts if it has no signal.
    Elements,
}

/// The equations that the wiring of a patch solves.
///
/// They hold while no amplifier is overloaded. Quantities are physical: an equation is valid in any consistent units.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::Patch;
/// use patchcord_equations::{Detail, EquationListing};
///
/// let patch = Patch::read("../../patches/lessons/van-der-pol.json")?;
/// let circuit = Circuit::new(&patch)?;
/// let listing = EquationListing::new(&circuit, &Program::new(&circuit)?, Detail::Signals);
/// assert_eq!(listing.equations[0].text(), "x' = v");
/// assert_eq!(listing.equations[1].text(), "v' = mu (1 - x^2) v - x");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct EquationListing {
    /// The equations of states and signals, in the order of the signals of the patch.
    pub equations: Vec<WrittenEquation>,
    /// The values of states at t = 0, and of delay lines before the first input arrives.
    pub initial: Vec<InitialValue>,
    /// The drives as functions of time.
    pub drives: Vec<WrittenEquation>,
    /// The modes and the conditions under which they change.
    pub modes: Vec<ModeDescription>,
    /// The tables that the equations name.
    pub tables: Vec<TableDescription>,
    /// What is not an equation: noise, values that are stored from step to step, and other names of quantities.
    pub remarks: Vec<Remark>,
}

/// The value of a quantity at t = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct InitialValue {
    /// The quantity.
    pub quantity: Notation,
    /// Its value.
    pub value: Notation,
}

impl EquationListing {
    /// Derives the equations of a circuit from its program.
    pub fn new(circuit: &Circuit, program: &Program, detail: Detail) -> Self {
        let keeps_elements = detail == Detail::Elements;
        let wiring = derive(
            circuit,
            program,
            Options { keeps_elements, has_ideal_amplifiers: true, stays_in_range: false },
        );
        let patch = circuit.patch();
        let is_known = |name: &str| {
            keeps_elements || patch.signals.contains_key(name) || patch.drives.contains_key(name)
        };
        let system = without_unnamed_ramps(simplified(wiring, &is_known), &is_known);
        let lister = Lister { patch, writer: Writer::new(circuit, &system), system: &system };
        lister.listing()
    }

    /// The equations as plain text, with the sections that apply. Numbers have at most 12 digits.
    pub fn text(&self) -> String {
        let written = |equation: &WrittenEquation| rounded_equation(equation, SHOWN_DIGITS).text();
        let mut sections = vec![lines(self.equations.iter().map(written))];
        if !self.initial.is_empty() {
            let initial = self.initial.iter().map(|initial| initial.rounded().text());
            sections.push(wrapped("at t = 0:", &initial.collect::<Vec<_>>()));
        }
        if !self.drives.is_empty() {
            sections.push(format!("drives:\n{}", lines(self.drives.iter().map(written))));
        }
        sections.extend(self.modes.iter().map(ModeDescription::text));
        sections.extend(self.tables.iter().map(TableDescription::text));
        if !self.remarks.is_empty() {
            sections.push(lines(self.remarks.iter().map(|remark| remark.text.clone())));
        }
        sections.retain(|section| !section.is_empty());
        sections.join("\n")
    }

    /// The equations, initial values and drives in LaTeX, as one `align` environment. Modes, tables and remarks follow it.
    pub fn latex(&self) -> String {
        let sides = |equation: &WrittenEquation| {
            let rounded = rounded_equation(equation, SHOWN_DIGITS);
            (latex(&rounded.left), latex(&rounded.right))
        };
        let initial = self.initial.iter().map(InitialValue::rounded);
        let initial = initial.map(|entry| (format!("{}(0)", latex(&entry.quantity)), latex(&entry.value)));
        let drives = self.drives.iter().map(sides);
        let mut sections = vec![aligned(self.equations.iter().map(sides).chain(initial).chain(drives))];
        sections.extend(self.modes.iter().map(ModeDescription::latex));
        sections.extend(self.tables.iter().map(TableDescription::latex));
        sections.extend(self.remarks.iter().map(|remark| format!("\\noindent {}\n", remark.latex)));
        sections.retain(|section| !section.is_empty());
        sections.join("\n")
    }
}

impl InitialValue {
    /// "quantity = value" as plain text.
    pub fn text(&self) -> String {
        format!("{} = {}", text(&self.quantity), text(&self.value))
    }

    /// The same with rounded numbers.
    fn rounded(&self) -> Self {
        Self { quantity: self.quantity.clone(), value: rounded(&self.value, SHOWN_DIGITS) }
    }
}

/// A list after a heading, in lines of at most [`LINE_WIDTH`] characters.
fn wrapped(heading: &str, items: &[String]) -> String {
    let (mut done, mut line) = (String::new(), heading.to_owned());
    for (index, item) in items.iter().enumerate() {
        let comma = if index + 1 < items.len() { "," } else { "" };
        if line.chars().count() + item.chars().count() + 2 > LINE_WIDTH {
            done += &(line + "\n");
            line = " ".repeat(heading.len());
        }
        line += &format!(" {item}{comma}");
    }
    done + &line + "\n"
}

/// Texts as lines.
fn lines(texts: impl Iterator<Item = String>) -> String {
    texts.map(|text| text + "\n").collect()
}
