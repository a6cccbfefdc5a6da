//! The plan of a sweep: which parameters take which values, in which order.

use super::error::PlanError;
use patchcord_core::ir::{ParameterSlot, Program, SettingError};
use patchcord_core::trace::number;
use patchcord_expr::Function;

/// Every combination of the values of its axes. The last axis changes from run to run, the first most slowly.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    axes: Vec<Axis>,
    runs: u64,
}

/// Parameters that take values together, in their declared units.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    pub(super) names: Vec<String>,
    pub(super) values: Values,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    /// Evenly spaced, both ends among them.
    Linear { first: f64, last: f64, count: u64 },
    /// With an even ratio from one to the next, both ends among them.
    Logarithmic { first: f64, last: f64, count: u64 },
    /// One after the other.
    List(Vec<f64>),
    /// Those of all parameters of the axis, row by row, from a file of this name.
    Rows { file: String, values: Vec<f64> },
}

/// More runs than this are a slip of the pen.
const MOST_RUNS: u64 = 1_000_000_000;

impl Axis {
    /// Reads `NAME=FIRST:LAST:COUNT` (evenly spaced), `NAME=FIRST:LAST:COUNT:log` (by an even ratio) or
    /// `NAME=VALUE,VALUE,...`.
    ///
    /// # Errors
    /// When it is none of these, a number is not finite, or there are no two points to space.
    pub fn parse(text: &str) -> Result<Axis, PlanError> {
        let unreadable = || PlanError::NotAnAxis(text.to_owned());
        let (name, values) = text.split_once('=').ok_or_else(unreadable)?;
        let number = |text: &str| {
            let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
            number
                .ok_or_else(|| PlanError::NotANumber { name: name.trim().to_owned(), text: text.to_owned() })
        };
        let parts: Vec<_> = values.split(':').collect();
        let values = match parts[..] {
            [list] => Values::List(list.split(',').map(number).collect::<Result<_, _>>()?),
            [first, last, count] => {
                let count = count_of(name, count)?;
                Values::Linear { first: number(first)?, last: number(last)?, count }
            }
            [first, last, count, "log"] => {
                let (first, last) = (number(first)?, number(last)?);
                if !(first > 0.0 && last > 0.0) {
                    return Err(PlanError::NotAboveZero(name.trim().to_owned()));
                }
                Values::Logarithmic { first, last, count: count_of(name, count)? }
            }
            _ => return Err(unreadable()),
        };
        Ok(Axis { names: vec![name.trim().to_owned()], values })
    }

    /// How many points it has.
    fn count(&self) -> u64 {
        match &self.values {
            Values::Linear { count, .. } | Values::Logarithmic { count, .. } => *count,
            Values::List(values) => values.len() as u64,
            Values::Rows { values, .. } => (values.len() / self.names.len()) as u64,
        }
    }

    /// The value of one of its parameters at a point.
    fn value(&self, index: u64, parameter: usize) -> f64 {
        let at = |first, last, count, between: fn(f64, f64, f64) -> f64| match index {
            0 => first,
            _ if index + 1 == count => last,
            _ => between(first, last, index as f64 / (count - 1) as f64),
        };
        match &self.values {
            Values::Linear { first, last, count } => at(*first, *last, *count, evenly),
            Values::Logarithmic { first, last, count } => at(*first, *last, *count, by_ratio),
            Values::List(values) => values[index as usize],
            Values::Rows { values, .. } => values[index as usize * self.names.len() + parameter],
        }
    }

    /// What was asked for, numbers read back to the same bits.
    pub(super) fn text(&self) -> String {
        let name = self.names.join(",");
        match &self.values {
            Values::Linear { first, last, count } => {
                format!("{name}={}:{}:{count}", number(*first), number(*last))
            }
            Values::Logarithmic { first, last, count } => {
                format!("{name}={}:{}:{count}:log", number(*first), number(*last))
            }
            Values::List(values) => {
                let told: Vec<_> = values.iter().map(|value| number(*value)).collect();
                format!("{name}={}", told.join(","))
            }
            Values::Rows { file, .. } => format!("{name} from {} rows of {file}", self.count()),
        }
    }

    /// Whether every value is one that its parameter may take. What lies between two ends needs no look.
    fn check(&self, program: &Program) -> Result<(), PlanError> {
        let slots: Result<Vec<_>, _> = self.names.iter().map(|name| slot(program, name)).collect();
        let ends = [0, self.count() - 1];
        let points = match self.values {
            Values::Linear { .. } | Values::Logarithmic { .. } => ends.to_vec(),
            _ => (0..self.count()).collect(),
        };
        let slots = slots?;
        let mut all = points.iter().flat_map(|point| {
            slots.iter().enumerate().map(move |(parameter, slot)| (slot, self.value(*point, parameter)))
        });
        all.try_for_each(|(slot, value)| slot.in_si(value).map(drop).map_err(PlanError::from))
    }
}

/// The value at this share of the way; ends so far apart that their difference is no number are weighed one by one.
fn evenly(first: f64, last: f64, share: f64) -> f64 {
    let way = last - first;
    if way.is_finite() { first + share * way } else { first * (1.0 - share) + last * share }
}

/// The same by ratios: ends of which the ratio is too large or too small for a number take their roots one by one.
fn by_ratio(first: f64, last: f64, share: f64) -> f64 {
    let (ratio, power) = (last / first, |base, exponent| Function::Power.apply(base, exponent));
    if ratio.is_normal() {
        first * power(ratio, share)
    } else {
        power(first, 1.0 - share) * power(last, share)
    }
}

fn count_of(name: &str, text: &str) -> Result<u64, PlanError> {
    let count = text.trim().parse().ok().filter(|count| (2..=MOST_RUNS).contains(count));
    count.ok_or_else(|| PlanError::BadCount {
        name: name.trim().to_owned(),
        text: text.to_owned(),
        most: MOST_RUNS,
    })
}

/// The parameter of a program that has this name.
pub(super) fn slot<'p>(program: &'p Program, name: &str) -> Result<&'p ParameterSlot, SettingError> {
    Ok(&program.parameters()[program.parameter_index(name)?])
}

impl Plan {
    /// The plan of these axes, for a program whose parameters they vary.
    ///
    /// # Errors
    /// When there is no axis, a parameter is not known or varied twice, a value is outside the range that the patch
    /// declares, or there are too many runs.
    pub fn new(axes: Vec<Axis>, program: &Program) -> Result<Plan, PlanError> {
        if axes.is_empty() {
            return Err(PlanError::Nothing);
        }
        axes.iter().try_for_each(|axis| axis.check(program))?;
        let names: Vec<_> = axes.iter().flat_map(|axis| &axis.names).collect();
        if let Some((_, twice)) = names.iter().enumerate().find(|(at, name)| names[..*at].contains(name)) {
            return Err(PlanError::Twice((*twice).clone()));
        }
        let runs = axes.iter().try_fold(1u64, |runs, axis| runs.checked_mul(axis.count()));
        let runs = runs.filter(|runs| *runs <= MOST_RUNS).ok_or(PlanError::TooMany { most: MOST_RUNS })?;
        Ok(Plan { axes, runs })
    }

    /// How many runs there are.
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// The names of the parameters that are varied.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.axes.iter().flat_map(|axis| axis.names.iter().map(String::as_str))
    }

    /// The axes as they were asked for.
    pub fn texts(&self) -> Vec<String> {
        self.axes.iter().map(Axis::text).collect()
    }

    /// The values of its axes that stand in files.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.axes.iter().filter_map(|axis| match &axis.values {
            Values::Rows { values, .. } => Some(values.as_slice()),
            _ => None,
        })
    }

    /// The values of a run, counted from 0, in the order of the names and in declared units.
    pub fn values(&self, run: u64) -> Vec<f64> {
        let mut points = vec![0; self.axes.len()];
        let mut rest = run;
        for (point, axis) in points.iter_mut().zip(&self.axes).rev() {
            (*point, rest) = (rest % axis.count(), rest / axis.count());
        }
        let of_axis = |(axis, point): (&Axis, u64)| {
            (0..axis.names.len()).map(|parameter| axis.value(point, parameter)).collect::<Vec<_>>()
        };
        self.axes.iter().zip(points).flat_map(of_axis).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::circuit::Circuit;
    use patchcord_core::patch::Patch;

    fn plan(axes: &[&str]) -> Result<Plan, String> {
        let patch = Patch::read("../../patches/thesis/fig-8-16.json".as_ref()).unwrap();
        let program = Program::new(&Circuit::new(&patch, &[]).unwrap()).unwrap();
        let axes: Result<Vec<_>, _> = axes.iter().map(|text| Axis::parse(text)).collect();
        axes.and_then(|axes| Plan::new(axes, &program)).map_err(|error| error.to_string())
    }

    #[test]
    fn the_last_axis_changes_from_run_to_run() {
        let plan = plan(&["VcL=1e-3:3e-3:3", "Tc=0.01,0.02"]).unwrap();
        assert_eq!((plan.runs(), plan.names().collect::<Vec<_>>()), (6, vec!["VcL", "Tc"]));
        let all: Vec<_> = (0..6).map(|run| plan.values(run)).collect();
        let expected = [[1e-3, 0.01], [1e-3, 0.02], [2e-3, 0.01], [2e-3, 0.02], [3e-3, 0.01], [3e-3, 0.02]];
        assert_eq!(all, expected);
    }

    #[test]
    fn both_ends_are_met_exactly_and_logarithms_have_an_even_ratio() {
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
    fn ends_may_be_as_far_apart_as_numbers_are() {
        let values = |axis: &str| {
            let axis = Axis::parse(axis).unwrap();
            (0..axis.count()).map(|index| axis.value(index, 0)).collect::<Vec<_>>()
        };
        assert_eq!(values("k=-1e308:1e308:3"), [-1e308, 0.0, 1e308]);
        for axis in ["k=1e300:1e-300:3:log", "k=1e-300:1e300:3:log"] {
            assert!((values(axis)[1] - 1.0).abs() < 1e-12, "{axis}: {:?}", values(axis));
        }
        // As exact as the decimals are: not 1.2999999999999998.
        assert_eq!(values("k=1:2:11")[3], 1.3);
    }

    #[test]
    fn what_makes_no_plan_is_told() {
        let cases: [(&[&str], &str); 13] = [
            (&[], "nothing is varied"),
            (&["VcL"], "\"VcL\" gives no values: write NAME=FIRST:LAST:COUNT"),
            (&["VcL=1:2:3:4"], "\"VcL=1:2:3:4\" gives no values"),
            (&["VcL=1e-3:fast:3"], "\"fast\" is not a finite number, for VcL"),
            (&["VcL=1e-3,NaN"], "\"NaN\" is not a finite number"),
            (
                &["VcL=1e-3:2e-3:1"],
                "\"1\" points cannot be spaced for VcL: write a whole number from 2 to 1e9",
            ),
            (&["VcL=1e-3:2e-3:1e12"], "\"1e12\" points cannot be spaced"),
            (&["VcL=1e-3:2e-3:2.5:log"], "\"2.5\" points cannot be spaced"),
            (&["VcL=0:2e-3:5:log"], "VcL has a logarithm above 0 only"),
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
