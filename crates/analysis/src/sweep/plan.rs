//! The plan of a sweep: the values of each parameter and the order of their combinations.

use std::str::FromStr;

use super::error::PlanError;
use super::spacing::{value_by_difference, value_by_ratio};
use patchcord_core::document::{TypedNumber, TypedNumberError};
use patchcord_core::ir::{ParameterValue, Program, SettingError};
use patchcord_core::trace::format_exact;
use patchcord_expr::Unit;

/// All combinations of the values of its axes. The last axis changes fastest, the first slowest.
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
///
/// let plan = Plan::new([Axis::parse("k=20:80:3")?, Axis::parse("m=1,2")?], &program)?;
/// assert_eq!(plan.runs(), 6);
/// assert_eq!(plan.names().collect::<Vec<_>>(), ["k", "m"]);
/// assert_eq!((plan.values(0), plan.values(1), plan.values(2)), (vec![20.0, 1.0], vec![20.0, 2.0], vec![50.0, 1.0]));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The axes, slowest first.
    axes: Vec<Axis>,
    /// The number of combinations.
    runs: u64,
}

/// One axis: one or several parameters that change together, in their declared units. A plan converts values with
/// other units.
///
/// [`Axis::parse`] reads an axis of one parameter from text. [`Axis::read`] reads one or several parameters from a CSV
/// file.
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
/// let values = |axis: Axis| -> Result<Vec<Vec<f64>>, Box<dyn std::error::Error>> {
///     let plan = Plan::new([axis], &program)?;
///     Ok((0..plan.runs()).map(|run| plan.values(run)).collect())
/// };
///
/// // From 20 N/m to 80 N/m in three points, with equal differences and with equal ratios
/// assert_eq!(values("k=20:80:3".parse()?)?, [[20.0], [50.0], [80.0]]);
/// assert_eq!(values("k=20:80:3:log".parse()?)?, [[20.0], [40.0], [80.0]]);
///
/// // Pairs of values from a file
/// let file = tempfile::NamedTempFile::new()?;
/// std::fs::write(file.path(), "k,m\n20,1\n50,2\n")?;
/// assert_eq!(values(Axis::read(file.path(), &program)?)?, [[20.0, 1.0], [50.0, 2.0]]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Names of the parameters of the axis; only an axis from a file has several.
    pub(super) names: Vec<String>,
    /// Their values.
    pub(super) values: AxisValues,
    /// The values as they were typed, if one of them has a unit: the ends or the list. Otherwise empty.
    pub(super) typed: Vec<TypedNumber>,
}

/// The values of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum AxisValues {
    /// `count` values with equal differences, both ends included.
    Linear { first: f64, last: f64, count: u64 },
    /// `count` values with equal ratios, both ends included.
    Logarithmic { first: f64, last: f64, count: u64 },
    /// An explicit list.
    List(Vec<f64>),
    /// Rows of a file with one value per parameter of the axis, row by row.
    Rows { file: String, values: Vec<f64> },
}

/// The largest number of runs. More are assumed to be a typing error.
const MAX_RUNS: u64 = 1_000_000_000;

impl Axis {
    /// Parses `NAME=FIRST:LAST:COUNT` (equal differences), `NAME=FIRST:LAST:COUNT:log` (equal ratios) or
    /// `NAME=VALUE,VALUE,...`. A value is in the declared unit, or has a unit such as `2.54mm/s`.
    ///
    /// # Errors
    /// If the text has none of these forms, a value is missing or not finite, or the count is less than 2.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_analysis::sweep::Axis;
    ///
    /// assert!(Axis::parse("k=20:80:4").is_ok());
    /// assert!(Axis::parse("k=0.001:1:7:log").is_ok());
    /// assert!(Axis::parse("k=1,2,5").is_ok());
    /// let error = Axis::parse("k=1:fast:3").unwrap_err();
    /// assert_eq!(error.to_string(), "k: \"fast\" is not a number");
    /// ```
    pub fn parse(text: &str) -> Result<Axis, PlanError> {
        let unreadable = || PlanError::NotAnAxis(text.to_owned());
        let (name, values) = text.split_once('=').ok_or_else(unreadable)?;
        let mut typed = Vec::new();
        let mut parse = |text: &str| -> Result<f64, PlanError> {
            typed.push(number(name.trim(), values, text)?);
            Ok(typed[typed.len() - 1].number)
        };
        let parts: Vec<_> = values.split(':').collect();
        let values = match parts[..] {
            [list] => AxisValues::List(list.split(',').map(&mut parse).collect::<Result<_, _>>()?),
            [first, last, count] => {
                let count = count_of(name, count)?;
                AxisValues::Linear { first: parse(first)?, last: parse(last)?, count }
            }
            [first, last, count, "log"] => {
                let (first, last) = (parse(first)?, parse(last)?);
                if !(first > 0.0 && last > 0.0) {
                    return Err(PlanError::NotAboveZero(name.trim().to_owned()));
                }
                AxisValues::Logarithmic { first, last, count: count_of(name, count)? }
            }
            _ => return Err(unreadable()),
        };
        if typed.iter().all(|typed| typed.unit.is_none()) {
            typed.clear();
        }
        Ok(Axis { names: vec![name.trim().to_owned()], values, typed })
    }

    /// The same axis with all values in the declared unit of its parameter.
    ///
    /// # Errors
    /// If the program does not have the parameter, or a value has a unit of another dimension.
    fn in_declared_units(mut self, program: &Program) -> Result<Axis, PlanError> {
        let typed = std::mem::take(&mut self.typed);
        if typed.is_empty() {
            return Ok(self);
        }
        let name = &self.names[0];
        let unit = &parameter(program, name)?.declared.unit;
        let failure = |reason| PlanError::NotANumber { name: name.clone(), reason };
        let unit = Unit::parse(unit)
            .map_err(|reason| failure(TypedNumberError::NotAUnit { text: unit.clone(), reason }))?;
        let numbers = typed.iter().map(|typed| typed.in_unit(&unit)).collect::<Result<Vec<_>, _>>();
        let numbers = numbers.map_err(failure)?;
        match &mut self.values {
            AxisValues::Linear { first, last, .. } | AxisValues::Logarithmic { first, last, .. } => {
                (*first, *last) = (numbers[0], numbers[1]);
            }
            AxisValues::List(values) => *values = numbers,
            AxisValues::Rows { .. } => {}
        }
        Ok(self)
    }

    /// The number of points.
    fn count(&self) -> u64 {
        match &self.values {
            AxisValues::Linear { count, .. } | AxisValues::Logarithmic { count, .. } => *count,
            AxisValues::List(values) => values.len() as u64,
            AxisValues::Rows { values, .. } => (values.len() / self.names.len()) as u64,
        }
    }

    /// The value number `index` of a parameter of the axis. `position` is the index of the parameter among the names.
    fn value(&self, index: u64, position: usize) -> f64 {
        match &self.values {
            AxisValues::Linear { first, last, count } => value_by_difference([*first, *last], index, *count),
            AxisValues::Logarithmic { first, last, count } => value_by_ratio([*first, *last], index, *count),
            AxisValues::List(values) => values[index as usize],
            AxisValues::Rows { values, .. } => values[index as usize * self.names.len() + position],
        }
    }

    /// The axis in the form that [`Axis::parse`] reads. Numbers are exact.
    pub(super) fn text(&self) -> String {
        let name = self.names.join(",");
        match &self.values {
            AxisValues::Linear { first, last, count } => {
                format!("{name}={}:{}:{count}", format_exact(*first), format_exact(*last))
            }
            AxisValues::Logarithmic { first, last, count } => {
                format!("{name}={}:{}:{count}:log", format_exact(*first), format_exact(*last))
            }
            AxisValues::List(values) => {
                let values: Vec<_> = values.iter().map(|value| format_exact(*value)).collect();
                format!("{name}={}", values.join(","))
            }
            AxisValues::Rows { file, .. } => format!("{name} from {} rows of {file}", self.count()),
        }
    }

    /// An error if a value is outside the range of its parameter. Only the ends of a spaced axis need a check.
    fn check(&self, program: &Program) -> Result<(), PlanError> {
        let parameters: Result<Vec<_>, _> = self.names.iter().map(|name| parameter(program, name)).collect();
        let ends = [0, self.count() - 1];
        let indices = match self.values {
            AxisValues::Linear { .. } | AxisValues::Logarithmic { .. } => ends.to_vec(),
            _ => (0..self.count()).collect(),
        };
        let parameters = parameters?;
        let mut all = indices.iter().flat_map(|index| {
            let values = parameters.iter().enumerate();
            values.map(move |(position, parameter)| (parameter, self.value(*index, position)))
        });
        all.try_for_each(|(parameter, value)| parameter.in_si(value).map(drop).map_err(PlanError::from))
    }
}

impl FromStr for Axis {
    type Err = PlanError;

    /// Parses an axis, see [`Axis::parse`].
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::parse(text)
    }
}

/// Parses one number of the axis `name`. `values` is the text after the equals sign.
fn number(name: &str, values: &str, text: &str) -> Result<TypedNumber, PlanError> {
    if text.trim().is_empty() {
        return Err(PlanError::MissingValue { name: name.to_owned(), values: values.to_owned() });
    }
    TypedNumber::parse(text).map_err(|reason| PlanError::NotANumber { name: name.to_owned(), reason })
}

/// Parses the number of points of the axis `name`.
fn count_of(name: &str, text: &str) -> Result<u64, PlanError> {
    let count = text.trim().parse().ok().filter(|count| (2..=MAX_RUNS).contains(count));
    count.ok_or_else(|| PlanError::BadCount {
        name: name.trim().to_owned(),
        text: text.to_owned(),
        max: MAX_RUNS,
    })
}

/// The parameter with this name; an error with a similar name if there is none.
pub(super) fn parameter<'p>(program: &'p Program, name: &str) -> Result<&'p ParameterValue, SettingError> {
    Ok(&program.parameters()[program.parameter_index(name)?])
}

impl Plan {
    /// Combines axes. `program` has the parameters that they vary.
    ///
    /// # Errors
    /// If there is no axis, a parameter is unknown or varied twice, a value has a unit of another dimension or is outside
    /// its declared range, or there are too many runs.
    pub fn new(axes: impl IntoIterator<Item = Axis>, program: &Program) -> Result<Plan, PlanError> {
        let axes = axes.into_iter().map(|axis| axis.in_declared_units(program));
        let axes: Vec<Axis> = axes.collect::<Result<_, _>>()?;
        if axes.is_empty() {
            return Err(PlanError::NoAxis);
        }
        axes.iter().try_for_each(|axis| axis.check(program))?;
        let names: Vec<_> = axes.iter().flat_map(|axis| &axis.names).collect();
        let mut numbered = names.iter().enumerate();
        if let Some((_, duplicate)) = numbered.find(|(index, name)| names[..*index].contains(name)) {
            return Err(PlanError::DuplicateParameter((*duplicate).clone()));
        }
        let runs = axes.iter().try_fold(1u64, |runs, axis| runs.checked_mul(axis.count()));
        let runs = runs.filter(|runs| *runs <= MAX_RUNS).ok_or(PlanError::TooManyRuns { max: MAX_RUNS })?;
        Ok(Plan { axes, runs })
    }

    /// The number of runs.
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// The names of the varied parameters, in the order of the axes.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.axes.iter().flat_map(|axis| axis.names.iter().map(String::as_str))
    }

    /// The axes in the form in which they are specified.
    pub fn texts(&self) -> Vec<String> {
        self.axes.iter().map(Axis::text).collect()
    }

    /// The values of the axes that were read from files.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.axes.iter().filter_map(|axis| match &axis.values {
            AxisValues::Rows { values, .. } => Some(values.as_slice()),
            _ => None,
        })
    }

    /// The parameter values of a run, counted from 0. Order of the names, declared units.
    pub fn values(&self, run: u64) -> Vec<f64> {
        let mut indices = vec![0; self.axes.len()];
        let mut rest = run;
        for (index, axis) in indices.iter_mut().zip(&self.axes).rev() {
            (*index, rest) = (rest % axis.count(), rest / axis.count());
        }
        let of_axis = |(axis, index): (&Axis, u64)| {
            (0..axis.names.len()).map(|position| axis.value(index, position)).collect::<Vec<_>>()
        };
        self.axes.iter().zip(indices).flat_map(of_axis).collect()
    }
}

#[cfg(test)]
mod tests;
