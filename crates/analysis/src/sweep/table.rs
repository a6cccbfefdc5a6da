//! Reads an axis from a CSV file: a header line with parameter names, then one line of values per run.

use std::fs::File;
use std::path::Path;

use csv::StringRecord;

use super::error::PlanError;
use super::plan::{Axis, AxisValues, slot};
use patchcord_core::ir::{ParameterSlot, Program};
use patchcord_core::output::io_reason;
use patchcord_expr::Unit;

/// The largest file that is read, in bytes.
const MAX_BYTES: u64 = 100_000_000;

impl Axis {
    /// Reads an axis from a CSV file. The first line has parameter names, each further line the values of one run in
    /// declared units. Lines that start with # are comments. A comment "# NAME: UNIT" must have the declared unit.
    ///
    /// # Errors
    /// If the file cannot be read or is not such a table.
    pub fn read(path: &Path, program: &Program) -> Result<Axis, PlanError> {
        let text = text_of(path)
            .map_err(|error| PlanError::Unread { file: path.to_owned(), why: io_reason(&error) })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let read = check_units(text, program).and_then(|()| rows(text, program));
        let (names, values) = read.map_err(|message| PlanError::Rows { file: path.to_owned(), message })?;
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Axis { names, values: AxisValues::Rows { file, values } })
    }
}

/// The names of the parameters, and their values row by row.
fn rows(text: &str, program: &Program) -> Result<(Vec<String>, Vec<f64>), String> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut records = reader.records().map(|record| record.map_err(|error| error.to_string()));
    let names = records.next().ok_or(EMPTY)??;
    check_commas(&names)?;
    let slots = names.iter().map(|name| slot(program, name)).collect::<Result<Vec<_>, _>>();
    let slots = slots.map_err(|error| error.to_string())?;
    let mut values = Vec::new();
    for record in records {
        values.extend(numbers(&record?, &slots)?);
    }
    if values.is_empty() {
        return Err(EMPTY.to_owned());
    }
    Ok((names.iter().map(str::to_owned).collect(), values))
}

/// An error if the names are separated by semicolons or tabs.
fn check_commas(names: &StringRecord) -> Result<(), String> {
    let others = [(';', "semicolons"), ('\t', "tabs")];
    match others.into_iter().find(|(other, _)| names.iter().any(|name| name.contains(*other))) {
        Some((_, other)) => Err(format!("names and values must be separated by commas, found {other}")),
        None => Ok(()),
    }
}

/// The message for a table without names or without rows.
const EMPTY: &str = "the table needs a line of parameter names, then one line of values per run";

/// The text of a file of at most [`MAX_BYTES`].
fn text_of(path: &Path) -> std::io::Result<String> {
    if File::open(path)?.metadata()?.len() > MAX_BYTES {
        return Err(std::io::Error::other(format!("the file exceeds {} MB", MAX_BYTES / 1_000_000)));
    }
    std::fs::read_to_string(path)
}

/// An error if a comment "# NAME: UNIT" has another unit than the patch declares.
fn check_units(text: &str, program: &Program) -> Result<(), String> {
    for (line, comment) in text.lines().enumerate() {
        let Some((name, unit)) = comment.strip_prefix('#').and_then(|comment| comment.split_once(':')) else {
            continue;
        };
        let Ok(slot) = slot(program, name.trim()) else { continue };
        let is_declared = |unit: &Unit| {
            Unit::parse(&slot.declared.unit)
                .is_ok_and(|own| own.dimension() == unit.dimension() && own.factor() == unit.factor())
        };
        if !Unit::parse(unit.trim()).is_ok_and(|unit| is_declared(&unit)) {
            let (line, name, unit) = (line + 1, &slot.declared.name, unit.trim());
            return Err(format!(
                "line {line}: the unit of {name} is \"{unit}\", but the patch declares {}",
                slot.declared.unit
            ));
        }
    }
    Ok(())
}

/// The numbers of a row, checked against the ranges of the parameters.
fn numbers(record: &StringRecord, slots: &[&ParameterSlot]) -> Result<Vec<f64>, String> {
    let line = record.position().map_or(0, csv::Position::line);
    if record.len() != slots.len() {
        let fields = if record.len() == 1 { "field" } else { "fields" };
        return Err(format!(
            "line {line} has {} {fields}, but the line of names has {}",
            record.len(),
            slots.len()
        ));
    }
    let number = |(field, slot): (&str, &&ParameterSlot)| {
        let number = field.parse().ok().filter(|number: &f64| number.is_finite());
        let number = number.ok_or_else(|| {
            format!("line {line}: \"{field}\" is not a finite number, for {}", slot.declared.name)
        })?;
        match slot.in_si(number) {
            Ok(_) => Ok(number),
            Err(violation) => Err(format!("line {line}: {}", PlanError::from(violation))),
        }
    };
    record.iter().zip(slots).map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Plan;
    use patchcord_core::circuit::Circuit;
    use patchcord_core::patch::Patch;

    fn plan(text: &str) -> Result<Plan, String> {
        let patch = Patch::read("../../patches/thesis/fig-8-16.json").unwrap();
        let program = Program::new(&Circuit::new(&patch).unwrap()).unwrap();
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        let plan = Axis::read(file.path(), &program).and_then(|axis| Plan::new(vec![axis], &program));
        plan.map_err(|error| error.to_string().replace(&file.path().display().to_string(), "FILE"))
    }

    #[test]
    fn each_line_is_one_run() {
        let plan = plan("\u{feff}# made by hand\n# VcL: mm/s * 1000\n").map(|_| ()).unwrap_err();
        assert!(plan.contains("line 2: the unit of VcL is"), "{plan}");
        let plan = super::tests::plan("# VcL: m/s\nVcL, Tc\r\n1e-3,0.01\n\n2e-3,0.02\n").unwrap();
        assert_eq!((plan.runs(), plan.values(1)), (2, vec![2e-3, 0.02]));
    }

    #[test]
    fn bad_tables_return_errors_with_the_line() {
        let cases = [
            ("", "FILE: the table needs a line of parameter names"),
            ("VcL\n", "FILE: the table needs a line of parameter names"),
            ("VLc\n1\n", "FILE: there is no parameter VLc; did you mean \"VcL\"?"),
            ("VcL,Tc\n1e-3\n", "FILE: line 2 has 1 field, but the line of names has 2"),
            ("VcL,Tc\n1e-3,\n", "FILE: line 2: \"\" is not a finite number, for Tc"),
            ("VcL\n1e-3\ninf\n", "FILE: line 3: \"inf\" is not a finite number"),
            ("VcL\n1e-3\n1\n", "FILE: line 3: VcL = 1 m/s is outside its range"),
            ("VcL;Tc\n1e-3;0.01\n", "FILE: names and values must be separated by commas, found semicolons"),
            ("VcL\tTc\n1e-3\t0.01\n", "FILE: names and values must be separated by commas, found tabs"),
            ("VcL,VcL\n1e-3,1e-3\n", "VcL is varied twice"),
            (
                "# VcL: mm/s\nVcL\n1\n",
                "FILE: line 1: the unit of VcL is \"mm/s\", but the patch declares m/s",
            ),
        ];
        for (text, expected) in cases {
            let error = plan(text).unwrap_err();
            assert!(error.starts_with(expected), "{text:?}: {error}");
        }
    }
}
