//! Settings row by row from a CSV file: a line of parameters' names, and a line of values for every run.

use std::fs::File;
use std::path::Path;

use csv::StringRecord;

use super::error::PlanError;
use super::plan::{Axis, Values, slot};
use patchcord_core::ir::{ParameterSlot, Program};
use patchcord_core::output::refusal;
use patchcord_expr::Unit;

/// Bytes of the largest file that is read.
const LARGEST: u64 = 100_000_000;

impl Axis {
    /// Reads an axis from a CSV file: the names of parameters, and a line of values in their declared units for every
    /// run. Lines that begin with # are comments; "# NAME: UNIT" has to tell the declared unit.
    ///
    /// # Errors
    /// When the file cannot be read, or is no such table.
    pub fn read(path: &Path, program: &Program) -> Result<Axis, PlanError> {
        let text = text_of(path)
            .map_err(|error| PlanError::Unread { file: path.to_owned(), why: refusal(&error) })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let read = check_units(text, program).and_then(|()| rows(text, program));
        let (names, values) = read.map_err(|message| PlanError::Rows { file: path.to_owned(), message })?;
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Axis { names, values: Values::Rows { file, values } })
    }
}

/// The names of parameters, and their values row by row.
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

/// Whether names that stand in one field are separated by something else than commas.
fn check_commas(names: &StringRecord) -> Result<(), String> {
    let others = [(';', "semicolons"), ('\t', "tabs")];
    match others.into_iter().find(|(other, _)| names.iter().any(|name| name.contains(*other))) {
        Some((_, called)) => Err(format!("names and values are separated by commas, not by {called}")),
        None => Ok(()),
    }
}

const EMPTY: &str = "a line of parameters' names is needed, and a line of values for every run";

fn text_of(path: &Path) -> std::io::Result<String> {
    if File::open(path)?.metadata()?.len() > LARGEST {
        return Err(std::io::Error::other(format!("it has more than {} MB", LARGEST / 1_000_000)));
    }
    std::fs::read_to_string(path)
}

/// Whether the units that comments tell are those that the patch declares.
fn check_units(text: &str, program: &Program) -> Result<(), String> {
    for (line, comment) in text.lines().enumerate() {
        let Some((name, told)) = comment.strip_prefix('#').and_then(|comment| comment.split_once(':')) else {
            continue;
        };
        let Ok(slot) = slot(program, name.trim()) else { continue };
        let same = |unit: &Unit| {
            Unit::parse(&slot.unit)
                .is_ok_and(|own| own.dimension() == unit.dimension() && own.factor() == unit.factor())
        };
        if !Unit::parse(told.trim()).is_ok_and(|unit| same(&unit)) {
            let (line, name, told) = (line + 1, &slot.name, told.trim());
            return Err(format!(
                "line {line} tells \"{told}\" as the unit of {name}, and the patch has {}",
                slot.unit
            ));
        }
    }
    Ok(())
}

/// The numbers of a row.
fn numbers(record: &StringRecord, slots: &[&ParameterSlot]) -> Result<Vec<f64>, String> {
    let line = record.position().map_or(0, csv::Position::line);
    if record.len() != slots.len() {
        let fields = if record.len() == 1 { "field" } else { "fields" };
        return Err(format!(
            "line {line} has {} {fields}, and the line of names {}",
            record.len(),
            slots.len()
        ));
    }
    let number = |(field, slot): (&str, &&ParameterSlot)| {
        let number = field.parse().ok().filter(|number: &f64| number.is_finite());
        let number = number.ok_or_else(|| {
            format!("line {line} has \"{field}\" where a finite number is needed, for {}", slot.name)
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
        let patch = Patch::read("../../patches/thesis/fig-8-16.json".as_ref()).unwrap();
        let program = Program::new(&Circuit::new(&patch, &[]).unwrap()).unwrap();
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        let plan = Axis::read(file.path(), &program).and_then(|axis| Plan::new(vec![axis], &program));
        plan.map_err(|error| error.to_string().replace(&file.path().display().to_string(), "FILE"))
    }

    #[test]
    fn rows_are_runs() {
        let plan = plan("\u{feff}# made by hand\n# VcL: mm/s * 1000\n").map(|_| ()).unwrap_err();
        assert!(plan.contains("line 2 tells"), "{plan}");
        let plan = super::tests::plan("# VcL: m/s\nVcL, Tc\r\n1e-3,0.01\n\n2e-3,0.02\n").unwrap();
        assert_eq!((plan.runs(), plan.values(1)), (2, vec![2e-3, 0.02]));
    }

    #[test]
    fn what_is_no_table_is_told_with_its_line() {
        let cases = [
            ("", "FILE: a line of parameters' names is needed"),
            ("VcL\n", "FILE: a line of parameters' names is needed"),
            ("VLc\n1\n", "FILE: there is no parameter VLc; did you mean \"VcL\"?"),
            ("VcL,Tc\n1e-3\n", "FILE: line 2 has 1 field, and the line of names 2"),
            ("VcL,Tc\n1e-3,\n", "FILE: line 2 has \"\" where a finite number is needed, for Tc"),
            ("VcL\n1e-3\ninf\n", "FILE: line 3 has \"inf\" where"),
            ("VcL\n1e-3\n1\n", "FILE: line 3: VcL = 1 m/s is outside its range"),
            ("VcL;Tc\n1e-3;0.01\n", "FILE: names and values are separated by commas, not by semicolons"),
            ("VcL\tTc\n1e-3\t0.01\n", "FILE: names and values are separated by commas, not by tabs"),
            ("VcL,VcL\n1e-3,1e-3\n", "VcL is varied twice"),
            (
                "# VcL: mm/s\nVcL\n1\n",
                "FILE: line 1 tells \"mm/s\" as the unit of VcL, and the patch has m/s",
            ),
        ];
        for (text, expected) in cases {
            let error = plan(text).unwrap_err();
            assert!(error.starts_with(expected), "{text:?}: {error}");
        }
    }
}
