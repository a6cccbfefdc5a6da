//! The equations of a patch as a reader sees them: in order, with initial values, drives, modes and tables.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_expr::Dimension;
use serde::Serialize;

use crate::derive::{Law, LawKind, ModeLaw, Options, Source, System, TransitionLaw, derive, simplified};
use crate::notation::{
    Comparison, Condition, EquationDocument, LINE_WIDTH, Notation, Relation, WrittenEquation, aligned, latex,
    text,
};
use crate::symbolic::{Fraction, Symbol, whole};
use crate::writing::Writer;

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
    /// What is not an equation: noise, and values that are stored from step to step.
    pub remarks: Vec<String>,
}

/// The value of a quantity at t = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct InitialValue {
    /// The quantity.
    pub quantity: Notation,
    /// Its value.
    pub value: Notation,
}

/// A mode: a discrete value of an element, such as the position of a relay.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeDescription {
    /// Name of the element.
    pub element: String,
    /// A noun, such as "position".
    pub mode: String,
    /// Name of the value at the start, before the conditions are examined.
    pub initial: String,
    /// The changes; of several that are due, the first one happens.
    pub changes: Vec<ModeChange>,
}

/// A change of a mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeChange {
    /// Name of the value before the change.
    pub from: String,
    /// Name of the value after it.
    pub to: String,
    /// The condition.
    pub when: String,
    /// What else the change sets, such as "v = -e v"; empty if nothing.
    pub sets: String,
}

/// A table of points: straight lines between them, constant outside.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableDescription {
    /// Its name in the equations.
    pub name: String,
    /// The unit of the ordinates of a table of time, whose abscissas are seconds. `None` if both are volts.
    pub unit: Option<String>,
    /// The points, [abscissa, ordinate].
    pub points: Vec<[f64; 2]>,
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
        let system = simplified(wiring, &is_known);
        let lister = Lister { writer: Writer::new(circuit, &system), system: &system };
        lister.listing()
    }

    /// The equations as plain text, with the sections that apply.
    pub fn text(&self) -> String {
        let mut sections = vec![lines(self.equations.iter().map(WrittenEquation::text))];
        if !self.initial.is_empty() {
            sections
                .push(wrapped("at t = 0:", &self.initial.iter().map(InitialValue::text).collect::<Vec<_>>()));
        }
        if !self.drives.is_empty() {
            sections.push(format!("drives:\n{}", lines(self.drives.iter().map(WrittenEquation::text))));
        }
        sections.extend(self.modes.iter().map(ModeDescription::text));
        sections.extend(self.tables.iter().map(TableDescription::text));
        if !self.remarks.is_empty() {
            sections.push(lines(self.remarks.iter().cloned()));
        }
        sections.retain(|section| !section.is_empty());
        sections.join("\n")
    }

    /// The equations, initial values and drives in LaTeX, as one `align` environment.
    pub fn latex(&self) -> String {
        let sides = |equation: &WrittenEquation| (latex(&equation.left), latex(&equation.right));
        let initial =
            self.initial.iter().map(|entry| (format!("{}(0)", latex(&entry.quantity)), latex(&entry.value)));
        aligned(self.equations.iter().map(sides).chain(initial).chain(self.drives.iter().map(sides)))
    }

    /// The equations as a document for programs.
    pub fn document(&self) -> ListingDocument {
        let documents =
            |equations: &[WrittenEquation]| equations.iter().map(EquationDocument::from).collect();
        let initial = self.initial.iter().map(|entry| InitialDocument {
            quantity: text(&entry.quantity),
            value: text(&entry.value),
            latex: format!("{} = {}", latex(&entry.quantity), latex(&entry.value)),
        });
        ListingDocument {
            equations: documents(&self.equations),
            initial: initial.collect(),
            drives: documents(&self.drives),
            modes: self.modes.clone(),
            tables: self.tables.clone(),
            remarks: self.remarks.clone(),
        }
    }
}

/// The JSON document of a listing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ListingDocument {
    /// The equations of states and signals.
    pub equations: Vec<EquationDocument>,
    /// The values at t = 0.
    pub initial: Vec<InitialDocument>,
    /// The drives as functions of time.
    pub drives: Vec<EquationDocument>,
    /// The modes.
    pub modes: Vec<ModeDescription>,
    /// The tables.
    pub tables: Vec<TableDescription>,
    /// What is not an equation.
    pub remarks: Vec<String>,
}

/// An initial value in a JSON document.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct InitialDocument {
    /// The quantity, such as "x'".
    pub quantity: String,
    /// Its value at t = 0, as an expression.
    pub value: String,
    /// "quantity = value" in LaTeX.
    pub latex: String,
}

impl InitialValue {
    /// "quantity = value" as plain text.
    pub fn text(&self) -> String {
        format!("{} = {}", text(&self.quantity), text(&self.value))
    }
}

impl ModeDescription {
    /// The mode as plain text, one change a line.
    fn text(&self) -> String {
        let change = |change: &ModeChange| {
            let sets = if change.sets.is_empty() { String::new() } else { format!(", then {}", change.sets) };
            format!("  {} -> {} if {}{sets}", change.from, change.to, change.when)
        };
        let head = format!("{} of {}, at first {}:\n", self.mode, self.element, self.initial);
        head + &lines(self.changes.iter().map(change))
    }
}

impl TableDescription {
    /// The table as plain text.
    fn text(&self) -> String {
        let shown = self.points.iter().take(MOST_POINTS).map(|[x, y]| format!("({x}, {y})"));
        let rest = self.points.len().saturating_sub(MOST_POINTS);
        let rest = if rest == 0 { String::new() } else { format!(" and {rest} more") };
        let unit = self.unit.as_deref().map_or_else(|| "V, V".to_owned(), |unit| format!("s, {unit}"));
        format!("{} in ({unit}): {}{rest}\n", self.name, shown.collect::<Vec<_>>().join(" "))
    }
}

/// Points of a table that the text shows.
const MOST_POINTS: usize = 12;

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

/// The changes in order, with those joined that differ in the first value only. Changes from different values do not
/// compete, so their order does not matter.
fn joined(changes: impl Iterator<Item = ModeChange>) -> Vec<ModeChange> {
    let mut kept: Vec<ModeChange> = Vec::new();
    for change in changes {
        let is_equal = |other: &&mut ModeChange| {
            (&other.to, &other.when, &other.sets) == (&change.to, &change.when, &change.sets)
        };
        match kept.iter_mut().find(is_equal) {
            Some(other) if other.from.split(" or ").any(|name| name == change.from) => {}
            Some(other) => other.from += &format!(" or {}", change.from),
            None => kept.push(change),
        }
    }
    kept
}

/// Writes the laws of a system.
struct Lister<'a> {
    system: &'a System,
    writer: Writer<'a>,
}

impl Lister<'_> {
    /// The laws in the order in which the patch names their quantities.
    fn listing(&self) -> EquationListing {
        let mut laws: Vec<&Law> = self.system.laws.iter().collect();
        laws.sort_by_key(|law| self.place(law.of));
        let (mut equations, mut drives, mut remarks) = (Vec::new(), Vec::new(), Vec::new());
        for law in &laws {
            match &law.kind {
                LawKind::Drive(value) => drives.push(self.definition(law.of, value)),
                LawKind::Source(source) => remarks.push(self.source(law.of, source)),
                LawKind::Stored { next, .. } => remarks.push(self.stored(law.of, next)),
                kind => equations.extend(self.equation(law.of, kind)),
            }
        }
        EquationListing {
            equations,
            initial: laws.iter().filter_map(|law| self.initial(law)).collect(),
            drives,
            modes: self.system.modes.iter().map(|mode| self.mode(mode)).collect(),
            tables: self.tables(),
            remarks,
        }
    }

    /// The place of a quantity: that of its name, then by its number of primes.
    fn place(&self, symbol: Symbol) -> (u32, u8) {
        let entry = self.system.symbols.entry(symbol);
        (self.system.symbols.first_of_name(&entry.name).unwrap_or(symbol.index), entry.primes)
    }

    /// The equation of a law. `None` if it only repeats a name, as x' = x'.
    fn equation(&self, of: Symbol, kind: &LawKind) -> Option<WrittenEquation> {
        match kind {
            LawKind::State { rate, limits, .. } => self.rate(of, rate, limits),
            LawKind::Definition(value) => Some(self.definition(of, value)),
            LawKind::Implicit(residual) => Some(self.implicit(of, residual)),
            LawKind::Delay { input, time, .. } => Some(self.delay(of, input, time)),
            LawKind::Stored { .. } | LawKind::Drive(_) | LawKind::Source(_) => None,
        }
    }

    /// The equation for the derivative of a state, with cases if it has limits.
    fn rate(&self, of: Symbol, rate: &Fraction, limits: &[Option<Fraction>; 2]) -> Option<WrittenEquation> {
        let entry = self.system.symbols.entry(of);
        let left = Notation::Name { name: entry.name.clone(), primes: entry.primes + 1 };
        let right = self.writer.expression(rate, Some(entry.dimension.over(Dimension::TIME)));
        if right == left && limits.iter().all(Option::is_none) {
            return None;
        }
        let mut cases = Vec::new();
        for (limit, relation, sign) in
            [(&limits[1], Relation::AtLeast, "above"), (&limits[0], Relation::AtMost, "below")]
        {
            let Some(limit) = limit else { continue };
            let limit = self.writer.expression(limit, Some(entry.dimension));
            let at_limit = Comparison::Compare { left: self.writer.name(of), relation, right: limit };
            let outward = Comparison::Words(format!("{} would be {sign} 0", text(&left)));
            let zero = Notation::Number { value: 0.0, unit: None };
            cases.push((zero, Some(Condition(vec![at_limit, outward]))));
        }
        if cases.is_empty() {
            return Some(WrittenEquation { left, right });
        }
        match right {
            Notation::Cases(inner) => cases.extend(inner),
            right => cases.push((right, None)),
        }
        Some(WrittenEquation { left, right: Notation::Cases(cases) })
    }

    /// The equation of a quantity that follows from others.
    fn definition(&self, of: Symbol, value: &Fraction) -> WrittenEquation {
        let dimension = self.system.symbols.entry(of).dimension;
        WrittenEquation { left: self.writer.name(of), right: self.writer.expression(value, Some(dimension)) }
    }

    /// An equation that cannot be solved for its quantity: the terms with the quantity are on the left.
    fn implicit(&self, of: Symbol, residual: &Fraction) -> WrittenEquation {
        let (_, content, rest) = residual.numerator().clone().into_primitive();
        let unknown = content.only(|atom, _| !atom.is_nonnegative());
        let numerator = Fraction::from(rest.times_term(&unknown, &whole(1)));
        let [left, right] = numerator.split(&mut |product| product.contains(&mut |symbol| symbol == of));
        let dimension = self.writer.dimension(&left);
        let right = right.negated();
        WrittenEquation {
            left: self.writer.expression(&left, dimension),
            right: self.writer.expression(&right, dimension),
        }
    }

    /// The equation of a delay line.
    fn delay(&self, of: Symbol, input: &Fraction, time: &Fraction) -> WrittenEquation {
        let dimension = self.system.symbols.entry(of).dimension;
        let arguments = vec![
            self.writer.expression(input, Some(dimension)),
            self.writer.expression(time, Some(Dimension::TIME)),
        ];
        WrittenEquation { left: self.writer.name(of), right: Notation::Call("delay".to_owned(), arguments) }
    }

    /// The initial value of a law.
    fn initial(&self, law: &Law) -> Option<InitialValue> {
        let (LawKind::State { initial, .. } | LawKind::Delay { initial, .. }) = &law.kind else {
            return None;
        };
        let dimension = self.system.symbols.entry(law.of).dimension;
        let value = self.writer.expression(initial, Some(dimension));
        Some(InitialValue { quantity: self.writer.name(law.of), value })
    }

    /// A remark on a source.
    fn source(&self, of: Symbol, source: &Source) -> String {
        let name = &self.system.symbols.entry(of).name;
        match source {
            Source::Noise => {
                format!("{name}: random numbers with mean 0 and variance 1, each constant for a time")
            }
            Source::Steps(table) => {
                format!("{name}: the last value of {} at or before t", self.writer.table_name(*table as u32))
            }
            Source::Pulses(value) => {
                format!("{name} = {}", text(&self.writer.expression(value, Some(Dimension::NONE))))
            }
        }
    }

    /// A remark on a value that is stored at the end of each step.
    fn stored(&self, of: Symbol, next: &Fraction) -> String {
        let name = &self.system.symbols.entry(of).name;
        let next = self.writer.expression(next, Some(Dimension::VOLTAGE));
        format!("{name}: the value of {} an instant before", text(&next))
    }

    /// A mode with its changes.
    fn mode(&self, mode: &ModeLaw) -> ModeDescription {
        let name = |value: f64| {
            let known = mode.values.iter().find(|(number, _)| *number == value);
            known.map_or_else(|| value.to_string(), |(_, name)| (*name).to_owned())
        };
        let change = |transition: &TransitionLaw| ModeChange {
            from: name(transition.from),
            to: name(transition.to),
            when: self.writer.condition_text(&transition.guard, transition.is_strict),
            sets: transition.reset.as_ref().map_or_else(String::new, |(of, to)| {
                let dimension = self.system.symbols.entry(*of).dimension;
                let to = self.writer.expression(to, Some(dimension));
                format!("{} = {}", text(&self.writer.name(*of)), text(&to))
            }),
        };
        ModeDescription {
            element: mode.element.clone(),
            mode: mode.noun.to_owned(),
            initial: name(mode.initial),
            changes: joined(
                mode.transitions.iter().filter(|transition| transition.is_possible()).map(change),
            ),
        }
    }

    /// The tables in the order of the program.
    fn tables(&self) -> Vec<TableDescription> {
        let tables = self.system.tables.iter().enumerate();
        tables
            .map(|(index, table)| TableDescription {
                name: self.writer.table_name(index as u32),
                unit: table.unit.as_ref().map(|unit| unit.text.clone()),
                points: table.points.clone(),
            })
            .collect()
    }
}
