//! The static check of `patchcord check --test`: its options, its tables and its document.

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::numbers::{seed, setting};
use super::table::{Table, decimals};
use patchcord::circuit::Circuit;
use patchcord::document::{TypedNumber, plural, unit_suffix};
use patchcord::equations::{
    Fix, RowSource, StaticCheck, StaticRow, TestError, TestValue, TestValues, static_check, test_unit,
};
use patchcord::expr::format_significant;
use patchcord::ir::Program;

// No doc comment: clap would use it as the description of the command.
#[derive(Args)]
pub(super) struct TestArguments {
    /// Static check: compare every output and derivative with the equations at a test value, such as x=0.5,
    /// "x'=3 mm/s" or A1=20, at random values (random), or at the initial condition (initial). A number without a unit
    /// is in the unit of the signal, and in volts for an element. May be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = test_argument)]
    test: Vec<TestArgument>,
    /// Seed of the random test values (default: 1)
    #[arg(long, value_name = "NUMBER", value_parser = seed, requires = "test", allow_negative_numbers = true)]
    seed: Option<u64>,
}

/// A value of `--test`.
#[derive(Debug, Clone)]
enum TestArgument {
    /// The initial condition.
    Initial,
    /// Random values.
    Random,
    /// The value of a quantity.
    Value(String, TypedNumber),
}

/// Parses a value of `--test`. The unit of a quantity is not known here.
fn test_argument(text: &str) -> Result<TestArgument, String> {
    match text.trim() {
        "initial" => Ok(TestArgument::Initial),
        "random" => Ok(TestArgument::Random),
        value if !value.contains('=') => {
            Err("write NAME=VALUE, such as x=0.5, or random, or initial".to_owned())
        }
        value => setting(value).map(|(name, typed)| TestArgument::Value(name, typed)),
    }
}

impl TestArguments {
    /// The static check that the options request. `None` if they request none.
    ///
    /// # Errors
    /// If a name or a unit is wrong, options contradict each other, or there are no voltages at the values.
    pub(super) fn run(&self, circuit: &Circuit, program: &Program) -> Result<Option<StaticCheck>, Failure> {
        let Some(values) = self.values(circuit)? else { return Ok(None) };
        static_check(circuit, program, &values).map(Some).map_err(|error| match error {
            TestError::NoVoltages(_) => Failure::data(format!("--test: {error}")),
            error => Failure::usage(format!("--test: {error}")),
        })
    }

    /// The test values in SI. `None` without `--test`.
    ///
    /// # Errors
    /// If a unit is wrong, or options contradict each other.
    fn values(&self, circuit: &Circuit) -> Result<Option<TestValues>, Failure> {
        let is_random = matches!(self.test.as_slice(), [TestArgument::Random]);
        if self.seed.is_some() && !is_random {
            return Err(Failure::usage("--seed applies to --test random only"));
        }
        match self.test.as_slice() {
            [] => Ok(None),
            [TestArgument::Initial] => Ok(Some(TestValues::Initial)),
            [TestArgument::Random] => Ok(Some(TestValues::Random(self.seed.unwrap_or(1)))),
            several => {
                let values = several.iter().map(|argument| given_value(circuit, argument));
                Ok(Some(TestValues::Given(values.collect::<Result<_, _>>()?)))
            }
        }
    }
}

/// A test value with its name, in SI. A number without a unit is in the unit of the signal.
///
/// # Errors
/// If the unit is wrong, or if the argument must stand alone.
fn given_value(circuit: &Circuit, argument: &TestArgument) -> Result<(String, f64), Failure> {
    let TestArgument::Value(name, typed) = argument else {
        return Err(Failure::usage("--test random and --test initial exclude other values of --test"));
    };
    // The check reports a name that the patch does not have.
    let Some(unit) = test_unit(circuit, name) else { return Ok((name.clone(), typed.number)) };
    let value = typed.in_unit(&unit).map_err(|error| Failure::usage(format!("--test {name}: {error}")))?;
    Ok((name.clone(), unit.to_si(value)))
}

/// A static check with the likeliest correction.
pub(super) struct StaticReport {
    check: StaticCheck,
    /// The correction as a command. `None` if nothing differs.
    correction: Option<String>,
    /// Machine seconds per problem second.
    time_scale: f64,
}

impl StaticReport {
    /// The report of a check of a circuit. `fixes` are the changes that correct the wiring.
    pub(super) fn new(circuit: &Circuit, check: StaticCheck, fixes: &[Fix]) -> Self {
        let correction = check.likely_correction(fixes);
        StaticReport { check, correction, time_scale: circuit.time_scale() }
    }

    /// Number of rows that differ.
    pub(super) fn difference_count(&self) -> usize {
        self.check.differences().count()
    }

    /// The failure if a row differs.
    pub(super) fn failure(&self) -> Option<Failure> {
        let first = self.check.first_difference()?;
        let name = row_name(first);
        Some(Failure::data(format!("at the test values, {name} differs from the equations of the patch")))
    }

    /// The tables with their conclusion.
    pub(super) fn text(&self) -> String {
        let is_output = |row: &&StaticRow| row.order == 0;
        let outputs = table("output", self.check.rows.iter().filter(is_output));
        let derivatives = table("derivative", self.check.rows.iter().filter(|row| row.order > 0));
        let between = if derivatives.is_empty() { String::new() } else { self.derivative_heading() };
        let heading = format!("static check at {}:\n", self.values_text());
        format!("{heading}{outputs}{between}{derivatives}{}", self.conclusion())
    }

    /// The heading of the derivatives. It relates the two times, because quantities are in problem time.
    fn derivative_heading(&self) -> String {
        let factor = format_significant(self.time_scale, DIGITS);
        let times = match self.time_scale == 1.0 {
            true => String::new(),
            false => format!(" ({factor} machine seconds per problem second)"),
        };
        format!("\nderivatives in V/s of machine time{times}:\n")
    }

    /// The test values: "x = 0.5 mm, v = 3 mm/s".
    fn values_text(&self) -> String {
        if self.check.values.is_empty() {
            return "the initial condition".to_owned();
        }
        let value = |value: &TestValue| {
            let number = format_significant(value.value, DIGITS);
            format!("{} = {number}{}", value.name, unit_suffix(&value.unit))
        };
        self.check.values.iter().map(value).collect::<Vec<_>>().join(", ")
    }

    /// What follows from the tables.
    fn conclusion(&self) -> String {
        let mut text = format!("\n{}", self.overload_text());
        if !self.check.has_equations {
            return text + "the patch states no equations, so there are no expected values\n";
        }
        let skipped = self.check.rows.iter().filter(|row| row.not_compared.is_some()).count();
        if skipped > 0 {
            text += &format!("{} not compared\n", plural(skipped as u64, "row"));
        }
        let others = if skipped > 0 { " in the other rows" } else { "" };
        let Some(first) = self.check.first_difference() else {
            return text + &format!("no difference{others}\n");
        };
        let count = plural(self.difference_count() as u64, "difference");
        text += &format!("{count}, the first at {}", row_name(first));
        let note = short_note(&first.note);
        text += &if note.is_empty() { "\n".to_owned() } else { format!(" ({note})\n") };
        if let Some(correction) = &self.correction {
            text += &format!("most likely correction: {correction}\n");
        }
        text
    }

    /// The line about overloads, with advice; empty if there are none.
    fn overload_text(&self) -> &'static str {
        let is_overloaded = self.check.rows.iter().any(|row| row.is_overloaded);
        match (is_overloaded, self.check.is_random) {
            (false, _) => "",
            (true, false) => "overload at these values: use smaller test values\n",
            (true, true) => {
                "overload at these values: all random values within 0.1 V of 0 V or of the initial condition \
                 overload an amplifier; give values with --test NAME=VALUE\n"
            }
        }
    }

    /// The document.
    pub(super) fn document(&self) -> StaticDocument<'_> {
        let value = |value: &TestValue| ValueDocument {
            quantity: value.name.clone(),
            value: value.value,
            unit: value.unit.clone(),
        };
        StaticDocument {
            values: self.check.values.iter().map(value).collect(),
            has_equations: self.check.has_equations,
            differences: self.difference_count(),
            first_difference: self.check.first_difference().map(row_name),
            correction: self.correction.as_deref(),
            rows: self.check.rows.iter().map(RowDocument::of).collect(),
        }
    }
}

/// Significant digits of a quantity.
const DIGITS: usize = 6;

/// The longest note in a table, in characters. Longer ones would make the table wider than most terminals.
const NOTE_LENGTH: usize = 40;

/// The first clause of a note, which usually states what the output computes. If it is too long, its end is left out.
fn short_note(note: &str) -> String {
    let clause = note.split_once("; ").map_or(note, |(clause, _)| clause);
    if clause.chars().count() <= NOTE_LENGTH {
        return clause.to_owned();
    }
    let start: String = clause.chars().take(NOTE_LENGTH - 1).collect();
    start.trim_end().to_owned() + "…"
}

/// The name of a row: that of its element, with a prime for each derivative.
fn row_name(row: &StaticRow) -> String {
    row.element.clone() + &"'".repeat(row.order)
}

/// A table of rows; empty if there are none. `heading` is that of the first column.
fn table<'a>(heading: &str, rows: impl Iterator<Item = &'a StaticRow>) -> String {
    let mut table =
        Table::new([heading, "expected", "wired", "quantity", "expected", "wired", "unit", "remark", "note"]);
    for row in rows {
        let (volts, quantity) = (|volts: f64| decimals(volts, 4), row.quantity.as_ref());
        let in_unit = |value: f64| format_significant(value, DIGITS);
        table.row([
            row_name(row),
            row.expected.map(volts).unwrap_or_default(),
            volts(row.wired),
            quantity.map(|quantity| quantity.name.clone()).unwrap_or_default(),
            quantity.and_then(|quantity| quantity.expected).map(in_unit).unwrap_or_default(),
            quantity.map(|quantity| in_unit(quantity.wired)).unwrap_or_default(),
            quantity.map(|quantity| quantity.unit.clone()).unwrap_or_default(),
            remark(row),
            short_note(&row.note),
        ]);
    }
    table.text()
}

/// The remark on a row: a difference, an overload, why it is not compared, and where the expected value comes from.
fn remark(row: &StaticRow) -> String {
    let difference = row.differs.then_some("DIFFERENT");
    let overload = row.is_overloaded.then_some("overload");
    // An overload of the row itself is stated already.
    let is_own = |reason: &&String| row.is_overloaded && **reason == format!("{} is overloaded", row.element);
    let reason = row.not_compared.as_ref().filter(|reason| !is_own(reason));
    let not_compared = reason.map(|reason| format!("not compared: {reason}"));
    let parts = [difference, overload, not_compared.as_deref(), source(row.source)];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Where an expected value comes from. `None` if the equations give it, or if there is none.
fn source(source: RowSource) -> Option<&'static str> {
    match source {
        RowSource::TestValue => Some("test value"),
        RowSource::Inputs => Some("from its inputs"),
        RowSource::Held => Some("held by a brake, a stop or a reset"),
        _ => None,
    }
}

/// A static check as JSON. `first_difference` is the name of an element, with a prime if its derivative differs.
#[derive(Serialize)]
pub(super) struct StaticDocument<'a> {
    values: Vec<ValueDocument>,
    has_equations: bool,
    differences: usize,
    first_difference: Option<String>,
    correction: Option<&'a str>,
    rows: Vec<RowDocument<'a>>,
}

/// A test value.
#[derive(Serialize)]
struct ValueDocument {
    quantity: String,
    value: f64,
    unit: String,
}

/// A row. `expected` and `wired` are in `unit`: V, or V/s of machine time.
#[derive(Serialize)]
struct RowDocument<'a> {
    element: &'a str,
    kind: &'static str,
    note: &'a str,
    unit: String,
    expected: Option<f64>,
    wired: f64,
    quantity: Option<QuantityDocument<'a>>,
    source: &'static str,
    differs: bool,
    not_compared: Option<&'a str>,
    overload: bool,
}

/// The quantity of a row, with its values in its own unit.
#[derive(Serialize)]
struct QuantityDocument<'a> {
    name: &'a str,
    unit: &'a str,
    expected: Option<f64>,
    wired: f64,
}

impl<'a> RowDocument<'a> {
    /// The document of a row.
    fn of(row: &'a StaticRow) -> Self {
        let unit = match row.order {
            0 => "V".to_owned(),
            1 => "V/s".to_owned(),
            order => format!("V/s{order}"),
        };
        let quantity = row.quantity.as_ref().map(|quantity| QuantityDocument {
            name: &quantity.name,
            unit: &quantity.unit,
            expected: quantity.expected,
            wired: quantity.wired,
        });
        RowDocument {
            element: &row.element,
            kind: row.kind,
            note: &row.note,
            unit,
            expected: row.expected,
            wired: row.wired,
            quantity,
            source: source_key(row.source),
            differs: row.differs,
            not_compared: row.not_compared.as_deref(),
            overload: row.is_overloaded,
        }
    }
}

/// The source of an expected value in documents.
fn source_key(source: RowSource) -> &'static str {
    match source {
        RowSource::TestValue => "test value",
        RowSource::Equations => "equations",
        RowSource::Inputs => "inputs",
        RowSource::Held => "held",
        _ => "none",
    }
}
