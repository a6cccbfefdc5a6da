//! Writes the laws of a system.

use patchcord_core::patch::Patch;
use patchcord_expr::{Dimension, Unit, round_significant};

use super::modes::joined;
use super::{EquationListing, InitialValue, ModeChange, ModeDescription, SHOWN_DIGITS, TableDescription};
use crate::derive::{Law, LawKind, ModeLaw, System, TransitionLaw};
use crate::notation::{
    Comparison, Condition, Notation, Relation, WrittenEquation, conditions_latex, conditions_text,
    equation_latex, rounded_condition, rounded_equation, text,
};
use crate::symbolic::{Fraction, Symbol};
use crate::writing::Writer;

/// Writes the laws of a system.
pub(super) struct Lister<'a> {
    /// The patch from which the system was derived.
    pub patch: &'a Patch,
    /// The system.
    pub system: &'a System,
    /// Its writer.
    pub writer: Writer<'a>,
}

impl Lister<'_> {
    /// The laws in the order in which the patch names their quantities.
    pub(super) fn listing(&self) -> EquationListing {
        let mut laws: Vec<&Law> = self.system.laws.iter().collect();
        laws.sort_by_cached_key(|law| self.place(law.of));
        let (mut equations, mut drives, mut remarks) = (Vec::new(), Vec::new(), Vec::new());
        for law in &laws {
            match &law.kind {
                LawKind::Drive(value) => drives.push(self.definition(law.of, value)),
                LawKind::Source(source) => remarks.push(self.source(law.of, source)),
                LawKind::Stored { next, .. } => remarks.push(self.stored(law.of, next)),
                kind => equations.extend(self.equation(law.of, kind)),
            }
        }
        remarks.extend(self.other_names());
        // The law of a brake is complete without its mode.
        let modes = self.system.modes.iter().filter(|mode| mode.brake().is_none());
        EquationListing {
            equations,
            initial: laws.iter().filter_map(|law| self.initial(law)).collect(),
            drives,
            modes: modes.map(|mode| self.mode(mode)).collect(),
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
            LawKind::Implicit(residual) => Some(self.writer.implicit(of, residual)),
            LawKind::Delay { input, time, .. } => Some(self.delay(of, input, time)),
            LawKind::Stored { .. } | LawKind::Drive(_) | LawKind::Source(_) => None,
        }
    }

    /// The equation for the derivative of a state, with cases if it has limits.
    fn rate(&self, of: Symbol, rate: &Fraction, limits: &[Option<Fraction>; 2]) -> Option<WrittenEquation> {
        let entry = self.system.symbols.entry(of);
        let name = self.writer.written_name(of).to_owned();
        let left = Notation::Name { name, primes: entry.primes + 1 };
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

    /// The equation of a delay line.
    fn delay(&self, of: Symbol, input: &Fraction, time: &Fraction) -> WrittenEquation {
        let dimension = self.system.symbols.entry(of).dimension;
        let arguments = vec![
            self.writer.expression(input, Some(dimension)),
            self.writer.expression(time, Some(Dimension::TIME)),
        ];
        WrittenEquation { left: self.writer.name(of), right: Notation::Call("delay".to_owned(), arguments) }
    }

    /// The initial value of a law. A number is in the unit of the quantity.
    fn initial(&self, law: &Law) -> Option<InitialValue> {
        let (LawKind::State { initial, .. } | LawKind::Delay { initial, .. }) = &law.kind else {
            return None;
        };
        let dimension = self.system.symbols.entry(law.of).dimension;
        let value = self.writer.expression(initial, Some(dimension));
        let value = match self.unit(law.of) {
            Some(unit) => in_unit(value, &unit),
            None => value,
        };
        Some(InitialValue { quantity: self.writer.name(law.of), value })
    }

    /// The unit of a quantity in the patch. `None` if its signal has no scale.
    fn unit(&self, of: Symbol) -> Option<Unit> {
        let entry = self.system.symbols.entry(of);
        let scale = self.patch.signals.get(&entry.name)?.scale.as_ref()?;
        let unit = self.patch.scales.get(&scale.value)?.unit.clone();
        Some((0..entry.primes).fold(unit, |unit, _| unit.per_second()))
    }

    /// A mode with its changes.
    fn mode(&self, mode: &ModeLaw) -> ModeDescription {
        let name = |value: f64| {
            let known = mode.values.iter().find(|(number, _)| *number == value);
            known.map_or_else(|| value.to_string(), |(_, name)| (*name).to_owned())
        };
        let change = |transition: &TransitionLaw| {
            let condition = self.writer.condition(&transition.guard, transition.is_strict);
            let condition = rounded_condition(&condition, SHOWN_DIGITS);
            let reset = transition.reset.as_ref();
            let reset = reset.map(|(of, to)| rounded_equation(&self.definition(*of, to), SHOWN_DIGITS));
            ModeChange {
                from: name(transition.from),
                to: name(transition.to),
                when: conditions_text(&condition),
                when_latex: conditions_latex(&condition),
                sets: reset.as_ref().map_or_else(String::new, on_one_line),
                sets_latex: reset.as_ref().map_or_else(String::new, equation_latex),
            }
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

/// A number in SI units as a number in this unit. Other expressions stay, and numbers in units of another dimension.
fn in_unit(value: Notation, unit: &Unit) -> Notation {
    if let Notation::Negative(inner) = value {
        return Notation::Negative(Box::new(in_unit(*inner, unit)));
    }
    let number = number_with_unit(&value).filter(|(_, si)| is_in(si, unit)).map(|(number, _)| number);
    match number {
        Some(number) => Notation::Number {
            value: round_significant(unit.out_of_si(number), SHOWN_DIGITS),
            unit: Some(unit.text().to_owned()),
        },
        None => value,
    }
}

/// The value of a number with a unit, also of one over a pure number, and the unit. `None` for other expressions.
fn number_with_unit(value: &Notation) -> Option<(f64, &str)> {
    match value {
        Notation::Number { value, unit } => Some((*value, unit.as_deref()?)),
        Notation::Quotient(top, bottom) => {
            let Notation::Number { value: divisor, unit: None } = &**bottom else { return None };
            number_with_unit(top).map(|(number, unit)| (number / divisor, unit))
        }
        _ => None,
    }
}

/// Whether the text of a unit has the dimension of another unit.
fn is_in(text: &str, unit: &Unit) -> bool {
    Unit::parse(text).is_ok_and(|parsed| parsed.dimension() == unit.dimension())
}

/// An equation as text on one line.
fn on_one_line(equation: &WrittenEquation) -> String {
    format!("{} = {}", text(&equation.left), text(&equation.right))
}
