//! The plan of a sweep: the values of each parameter and the order of their combinations.

use std::str::FromStr;

use super::error::PlanError;
use patchcord_core::ir::{ParameterValue, Program, SettingError};
use patchcord_core::trace::format_exact;
use patchcord_expr::Function;

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

/// One axis: one or several parameters that change together, in their declared units.
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
    /// `NAME=VALUE,VALUE,...`.
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
    /// assert_eq!(error.to_string(), "k: \"fast\" is not a finite number");
    /// ```
    pub fn parse(text: &str) -> Result<Axis, PlanError> {
        let unreadable = || PlanError::NotAnAxis(text.to_owned());
        let (name, values) = text.split_once('=').ok_or_else(unreadable)?;
        let number = |text: &str| number(name.trim(), values, text);
        let parts: Vec<_> = values.split(':').collect();
        let values = match parts[..] {
            [list] => AxisValues::List(list.split(',').map(number).collect::<Result<_, _>>()?),
            [first, last, count] => {
                let count = count_of(name, count)?;
                AxisValues::Linear { first: number(first)?, last: number(last)?, count }
            }
            [first, last, count, "log"] => {
                let (first, last) = (number(first)?, number(last)?);
                if !(first > 0.0 && last > 0.0) {
                    return Err(PlanError::NotAboveZero(name.trim().to_owned()));
                }
                AxisValues::Logarithmic { first, last, count: count_of(name, count)? }
            }
            _ => return Err(unreadable()),
        };
        Ok(Axis { names: vec![name.trim().to_owned()], values })
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
        let at = |first, last, count, between: fn(f64, f64, f64) -> f64| match index {
            0 => first,
            _ if index + 1 == count => last,
            _ => between(first, last, index as f64 / (count - 1) as f64),
        };
        match &self.values {
            AxisValues::Linear { first, last, count } => at(*first, *last, *count, interpolate_linearly),
            AxisValues::Logarithmic { first, last, count } => at(*first, *last, *count, interpolate_by_ratio),
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

/// Linear interpolation. If the difference of the ends overflows, the ends are weighted separately.
fn interpolate_linearly(first: f64, last: f64, share: f64) -> f64 {
    let difference = last - first;
    if difference.is_finite() { first + share * difference } else { first * (1.0 - share) + last * share }
}

/// Interpolation with equal ratios. If the ratio of the ends overflows, the powers are computed separately.
fn interpolate_by_ratio(first: f64, last: f64, share: f64) -> f64 {
    let (ratio, power) = (last / first, |base, exponent| Function::Power.apply(base, exponent));
    if ratio.is_normal() {
        first * power(ratio, share)
    } else {
        power(first, 1.0 - share) * power(last, share)
    }
}

/// Parses one number of the axis `name`. `values` is the text after the equals sign.
fn number(name: &str, values: &str, text: &str) -> Result<f64, PlanError> {
    if text.trim().is_empty() {
        return Err(PlanError::MissingValue { name: name.to_owned(), values: values.to_owned() });
    }
    let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| PlanError::NotANumber { name: name.to_owned(), text: text.to_owned() })
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
    /// If there is no axis, a parameter is unknown or varied twice, a value is outside its declared range, or there are
    /// too many runs.
    pub fn new(axes: impl IntoIterator<Item = Axis>, program: &Program) -> Result<Plan, PlanError> {
        let axes: Vec<Axis> = axes.into_iter().collect();
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
mod tests {
    use super::*;
    use patchcord_core::circuit::Circuit;
    use patchcord_core::patch::Patch;

    fn plan(axes: &[&str]) -> Result<Plan, String> {
        let patch = Patch::read("../../patches/thesis/fig-8-16.json").unwrap();
        let program = Program::new(&Circuit::new(&patch).unwrap()).unwrap();
        let axes: Result<Vec<_>, _> = axes.iter().map(|text| Axis::parse(text)).collect();
        axes.and_then(|axes: Vec<Axis>| Plan::new(axes, &program)).map_err(|error| error.to_string())
    }

    #[test]
    fn the_last_axis_changes_fastest() {
        let plan = plan(&["VcL=1e-3:3e-3:3", "Tc=0.01,0.02"]).unwrap();
        assert_eq!((plan.runs(), plan.names().collect::<Vec<_>>()), (6, vec!["VcL", "Tc"]));
        let all: Vec<_> = (0..6).map(|run| plan.values(run)).collect();
        let expected = [[1e-3, 0.01], [1e-3, 0.02], [2e-3, 0.01], [2e-3, 0.02], [3e-3, 0.01], [3e-3, 0.02]];
        assert_eq!(all, expected);
    }

    #[test]
    fn ends_are_exact_and_spacing_is_regular() {
        let values = |axis: &str| {
            let plan = plan(&[axis]).unwrap();
            (0..plan.runs()).map(|run| plan.values(run)[0]).collect::<Vec<_>>()
        };
        let even = values("VcL=1.27e-3:25.4e-3:40");
        assert_eq!((even.len(), even[0], even[39]), (40, 1.27e-3, 25.4e-3));
        assert!(even.windows(2).all(|pair| ((pair[1] - pair[0]) / (24.13e-3 / 39.0) - 1.0).abs() < 1e-12));
        let ratios = values("Tc=0.001:1:7:log");
        assert_eq!((ratios[0], ratios[6]), (0.001, 1.0));
        assert!(ratios.windows(2).all(|pair| (pair[1] / pair[0] / 10f64.sqrt() - 1.0).abs() < 1e-12));
        assert_eq!(values("Tc=0.02:0.01:2"), [0.02, 0.01]);
    }

    #[test]
    fn the_range_between_the_ends_may_overflow() {
        let values = |axis: &str| {
            let axis = Axis::parse(axis).unwrap();
            (0..axis.count()).map(|index| axis.value(index, 0)).collect::<Vec<_>>()
        };
        assert_eq!(values("k=-1e308:1e308:3"), [-1e308, 0.0, 1e308]);
        for axis in ["k=1e300:1e-300:3:log", "k=1e-300:1e300:3:log"] {
            assert!((values(axis)[1] - 1.0).abs() < 1e-12, "{axis}: {:?}", values(axis));
        }
        // Decimal steps are exact: not 1.2999999999999998.
        assert_eq!(values("k=1:2:11")[3], 1.3);
    }

    #[test]
    fn bad_plans_return_errors() {
        let cases: [(&[&str], &str); 16] = [
            (&[], "no parameter is varied"),
            (&["VcL"], "\"VcL\" gives no values: write NAME=FIRST:LAST:COUNT"),
            (&["VcL=1:2:3:4"], "\"VcL=1:2:3:4\" gives no values"),
            (&["VcL=1e-3:fast:3"], "VcL: \"fast\" is not a finite number"),
            (&["VcL=1e-3,NaN"], "VcL: \"NaN\" is not a finite number"),
            (
                &["VcL=1e-3,2e-3,"],
                "VcL: a value is missing in \"1e-3,2e-3,\": write a number there, or remove the extra comma",
            ),
            (&["VcL=1e-3::3"], "VcL: a value is missing in \"1e-3::3\": write a number there"),
            (&["VcL="], "VcL: a value is missing in \"\": write a number there"),
            (&["VcL=1e-3:2e-3:1"], "VcL: number of points must be an integer from 2 to 1e9, got \"1\""),
            (&["VcL=1e-3:2e-3:1e12"], "VcL: number of points must be an integer"),
            (&["VcL=1e-3:2e-3:2.5:log"], "VcL: number of points must be an integer"),
            (&["VcL=0:2e-3:5:log"], "VcL: logarithmic spacing needs positive ends"),
            (&["VLc=1e-3:2e-3:5"], "there is no parameter VLc; did you mean \"VcL\"?"),
            (&["VcL=1e-3:1:5"], "VcL = 1 m/s is outside its range 0.000254 ... 0.05 m/s"),
            (&["Tc=1e-2,2e-2", "VcL=1e-3,2e-3", "Tc=3e-2"], "Tc is varied twice"),
            (&["VcL=1e-3:2e-3:100000", "Tc=0.01:0.02:100000"], "the plan has more than 1000000000 runs"),
        ];
        for (axes, expected) in cases {
            let error = plan(axes).unwrap_err();
            assert!(error.starts_with(expected), "{axes:?}: {error}");
        }
    }
}
