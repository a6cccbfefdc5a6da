//! Reads an axis from a CSV file: a line of parameter names, then one line of values per run.
//!
//! The reader of `patchcord_core` for CSV tables splits the lines and collects the faults. This module selects the
//! columns and checks units and ranges.

use std::path::Path;

use super::error::PlanError;
use super::plan::{Axis, AxisValues, parameter};
use patchcord_core::document::csv_table::{self, ColumnSelector, CsvFault, CsvTable, UnitComment};
use patchcord_core::ir::{ParameterValue, Program};
use patchcord_core::output::io_reason;
use patchcord_expr::{Conversion, ConversionError, Unit};

/// The largest number of faults that one error lists. Further faults usually have the same cause.
const MAX_FAULTS: usize = 10;

impl Axis {
    /// Reads an axis from a CSV file. The first line has parameter names, each further line the values of one run in
    /// declared units. Lines that start with # are comments. A comment "# NAME: UNIT" before the line of names, or a
    /// name such as "k (N/mm)", gives another unit, which is converted to the declared unit.
    ///
    /// # Errors
    /// If the file cannot be read or is not such a table, a unit does not fit its parameter, or a value is outside the
    /// range of its parameter.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_analysis::sweep::{Axis, Plan};
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::Patch;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = Patch::read("../../patches/lessons/mass-and-spring.json")?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let file = tempfile::NamedTempFile::new()?;
    /// std::fs::write(file.path(), "# k: N/m\nk,m\n20,1\n50,2\n")?;
    ///
    /// let plan = Plan::new([Axis::read(file.path(), &program)?], &program)?;
    /// assert_eq!((plan.runs(), plan.values(1)), (2, vec![50.0, 2.0]));
    /// # Ok(())
    /// # }
    /// ```
    pub fn read(path: impl AsRef<Path>, program: &Program) -> Result<Axis, PlanError> {
        let path = path.as_ref();
        path.metadata()
            .map_err(|error| PlanError::Unread { file: path.to_owned(), why: io_reason(&error) })?;
        let (names, values) = read_rows(path, program).map_err(PlanError::Rows)?;
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Axis { names, values: AxisValues::Rows { file, values }, typed: Vec::new() })
    }
}

/// The names of the parameters and their values row by row, or the faults of the file.
fn read_rows(path: &Path, program: &Program) -> Result<(Vec<String>, Vec<f64>), Vec<String>> {
    // The names decide which columns are selected.
    let columns = csv_table::read_names(path).map_err(texts)?;
    let names: Vec<_> =
        columns.names.iter().map(|column| csv_table::without_unit(column).to_owned()).collect();
    let parameters = parameters(path, &names, columns.line, program)?;
    let selectors: Vec<_> = columns.names.iter().map(|column| ColumnSelector::Named(column)).collect();
    let mut table = csv_table::read(path, &selectors).map_err(texts)?;
    if table.lines.is_empty() {
        let message = "the table needs a line of parameter names, then one line of values per run";
        return Err(vec![format!("{}: {message}", path.display())]);
    }
    check(unit_faults(path, &table, &parameters))?;
    convert(&mut table, &parameters);
    check(range_faults(path, &table, &parameters))?;
    let row = |index: usize| table.columns.iter().map(move |column| column[index]);
    let values = (0..table.lines.len()).flat_map(row).collect();
    Ok((names, values))
}

/// The faults of a file as text.
fn texts(faults: Vec<CsvFault>) -> Vec<String> {
    let mut texts: Vec<_> =
        faults.into_iter().map(|fault| format!("{}; {}", fault.message, fault.hint)).collect();
    // Two columns of the same name are reported for each of them.
    texts.dedup();
    texts
}

/// The parameter of each column, or an error for each name that is not a parameter. `line` has the names.
fn parameters<'p>(
    path: &Path,
    names: &[String],
    line: usize,
    program: &'p Program,
) -> Result<Vec<&'p ParameterValue>, Vec<String>> {
    let found = || names.iter().map(move |name| parameter(program, name));
    let unknown = found().filter_map(Result::err);
    check(unknown.map(|error| format!("line {line} of {}: {error}", path.display())))?;
    Ok(found().filter_map(Result::ok).collect())
}

/// An error with the first [`MAX_FAULTS`] faults, if there are any.
fn check(faults: impl IntoIterator<Item = String>) -> Result<(), Vec<String>> {
    let faults: Vec<_> = faults.into_iter().take(MAX_FAULTS).collect();
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

/// A fault for each column whose unit does not fit the unit that the patch declares.
fn unit_faults(
    path: &Path,
    table: &CsvTable,
    parameters: &[&ParameterValue],
) -> impl Iterator<Item = String> {
    table.units.iter().zip(parameters).filter_map(move |(comment, parameter)| {
        let (comment, declared) = (comment.as_ref()?, &parameter.declared);
        let reason = conversion(comment, &declared.unit).err()?;
        Some(format!(
            "line {} of {}: the unit of {} is \"{}\", but the patch declares {}{reason}",
            comment.line,
            path.display(),
            declared.name,
            comment.text,
            declared.unit
        ))
    })
}

/// The conversion of a column to the declared unit of its parameter. An empty comment is the unit of a pure number.
///
/// # Errors
/// If there is none. The text is the reason, after a semicolon; it is empty if a text is not a unit, or if the units
/// have different dimensions.
fn conversion(comment: &UnitComment, declared: &str) -> Result<Conversion, String> {
    let unit = if comment.text.is_empty() { Unit::parse("").ok() } else { comment.unit() };
    let (Some(unit), Ok(declared)) = (unit, Unit::parse(declared)) else {
        return Err(String::new());
    };
    unit.conversion_to(&declared).map_err(|error| match &error {
        ConversionError::Dimension { .. } => String::new(),
        ConversionError::Angle { hint, .. } => format!("; {error}: {hint}"),
    })
}

/// Converts the columns with a unit to the declared units of their parameters.
fn convert(table: &mut CsvTable, parameters: &[&ParameterValue]) {
    for ((column, unit), parameter) in table.columns.iter_mut().zip(&table.units).zip(parameters) {
        let conversion = unit.as_ref().and_then(|unit| conversion(unit, &parameter.declared.unit).ok());
        if let Some(conversion) = conversion.filter(|conversion| !conversion.is_identity()) {
            column.iter_mut().for_each(|number| *number = conversion.apply(*number));
        }
    }
}

/// A fault for each value outside the range of its parameter, in the order of the lines.
fn range_faults(
    path: &Path,
    table: &CsvTable,
    parameters: &[&ParameterValue],
) -> impl Iterator<Item = String> {
    let columns = move || table.columns.iter().zip(parameters);
    table.lines.iter().enumerate().flat_map(move |(row, line)| {
        let violations = columns().filter_map(move |(column, parameter)| parameter.in_si(column[row]).err());
        violations.map(move |violation| {
            format!("line {line} of {}: {}", path.display(), PlanError::from(violation))
        })
    })
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
        let plan = Axis::read(file.path(), &program).and_then(|axis| Plan::new([axis], &program));
        plan.map_err(|error| error.to_string().replace(&file.path().display().to_string(), "FILE"))
    }

    #[test]
    fn each_line_is_one_run() {
        let plan = plan("\u{feff}# made by hand\n# VcL: m/s\nVcL, Tc\r\n1e-3,0.01\n\n2e-3,0.02\n").unwrap();
        assert_eq!((plan.runs(), plan.values(0), plan.values(1)), (2, vec![1e-3, 0.01], vec![2e-3, 0.02]));
    }

    #[test]
    fn units_are_converted_to_the_declared_units() {
        let plan = plan("# VcL: mm/s\nVcL, Tc (ms)\n2,10\n2.54,20\n").unwrap();
        assert_eq!(plan.values(0), [2e-3, 0.01]);
        assert_eq!(plan.values(1), [2.54e-3, 0.02]);
    }

    #[test]
    fn bad_tables_return_errors_with_the_line() {
        let cases = [
            ("", "FILE is empty; a table is a line of names"),
            ("VcL\n", "FILE: the table needs a line of parameter names"),
            ("# by hand\nVLc\n1\n", "line 2 of FILE: there is no parameter VLc; did you mean \"VcL\"?"),
            ("VcL,Tc\n1e-3\n", "line 2 of FILE has 1 field, but the line of names has 2; write one field"),
            (
                "VcL,Tc\n1e-3,\n",
                "line 2 of FILE has an empty cell instead of a number, in the column Tc; write a number",
            ),
            ("VcL\n1e-3\ninf\n", "line 3 of FILE has \"inf\" instead of a number, in the column VcL"),
            ("VcL\n1e-3\n1\n", "line 3 of FILE: VcL = 1 m/s is outside its range"),
            (
                "VcL;Tc\n1e-3;0.01\n",
                "line 1 of FILE separates its columns by \";\"; separate the columns by commas",
            ),
            (
                "VcL\tTc\n1e-3\t0.01\n",
                "line 1 of FILE separates its columns by tabs; separate the columns by commas",
            ),
            ("VcL,VcL\n1e-3,1e-3\n", "line 1 of FILE has more than one column \"VcL\"; give every column"),
            ("# VcL: mm\nVcL\n1\n", "line 1 of FILE: the unit of VcL is \"mm\", but the patch declares m/s"),
            ("VcL [N]\n1\n", "line 1 of FILE: the unit of VcL is \"N\", but the patch declares m/s"),
            ("VcL (sec)\n1\n", "line 1 of FILE: the unit of VcL is \"sec\", but the patch declares m/s"),
            ("# VcL:\nVcL\n1\n", "line 1 of FILE: the unit of VcL is \"\", but the patch declares m/s"),
            (
                "# VcL: m/s\nVcL (mm/s)\n1\n",
                "line 2 of FILE names a column VcL (mm/s), but line 1 gives its unit as m/s; correct or remove",
            ),
            ("VcL (mm/s),VcL\n1,1e-3\n", "VcL is varied twice"),
            (
                "# by hand\n# VcL: mm/s * 1000\nVcL\n1\n",
                "line 2 of FILE: the unit of VcL is \"mm/s * 1000\", but the patch declares m/s",
            ),
        ];
        for (text, expected) in cases {
            let error = plan(text).unwrap_err();
            assert!(error.starts_with(expected) && error.lines().count() == 1, "{text:?}: {error}");
        }
    }

    #[test]
    fn an_empty_comment_is_the_unit_of_a_pure_number() {
        let comment = UnitComment { text: String::new(), line: 1 };
        assert!(conversion(&comment, "1").unwrap().is_identity());
        assert!(conversion(&comment, "").unwrap().is_identity());
        assert_eq!(conversion(&comment, "%").unwrap().apply(0.5), 50.0);
        assert_eq!(conversion(&comment, "m"), Err(String::new()));
    }

    #[test]
    fn a_rate_without_its_angle_is_not_converted() {
        let comment = |text: &str| UnitComment { text: text.to_owned(), line: 1 };
        assert_eq!(conversion(&comment("1/min"), "rpm").unwrap().apply(150.0), 150.0);
        assert_eq!(conversion(&comment("1/sec"), "rpm").unwrap().apply(2.5), 150.0);
        let reason = conversion(&comment("1/min"), "deg/s").unwrap_err();
        let expected = "; 1/min cannot be converted to deg/s, because 1/min may count radians, degrees or revolutions: \
                        write the unit with its angle, as in \"rad/s\", \"deg/s\" or \"rpm\"";
        assert_eq!(reason, expected);
        assert_eq!(conversion(&comment("kg"), "deg/s"), Err(String::new()));
    }

    #[test]
    fn at_most_ten_faults_are_reported_together() {
        let faults = |text: &str| plan(text).unwrap_err().lines().map(str::to_owned).collect::<Vec<_>>();
        let unknown = faults("VLc,Tcc\n1,2\n");
        assert!(
            unknown.len() == 2 && unknown[1].contains("line 1 of FILE: there is no parameter Tcc"),
            "{unknown:?}"
        );
        let outside = faults(&format!("VcL,Tc\n1e-3,0.01\n{}", "1,5\n".repeat(20)));
        assert_eq!(outside.len(), MAX_FAULTS);
        assert!(outside[1].starts_with("line 3 of FILE: Tc = 5 s is outside its range"), "{outside:?}");
        assert!(outside[9].starts_with("line 7 of FILE: Tc = 5 s"), "{outside:?}");
    }
}
