//! How far what is fitted may be off: standard errors, and between which values it lies.

use nalgebra::DVector;

use crate::data::record::Record;
use crate::fit::estimate::Reached;
use crate::fit::estimation::refit;
use crate::fit::fitted_model::Stage;
use crate::fit::levenberg_marquardt::{NUDGE, Task};
use crate::fit::model::{Course, ModelError};
use crate::fit::normal_equations::{Column, Normal, Spread, product_there};
use crate::fit::problem::Problem;
use crate::fit::uncertainty::Known;
use crate::statistics::block_comparison::{in_blocks, together};
use crate::statistics::descriptive::student_95;
use patchcord_analysis::pool;

/// Derivatives are taken over this share of a range at most,
const MOST_NUDGE: f64 = 0.02;
/// and over less where that changes what was measured by more than twice so much of the noise, rms: several times what the
/// solver errs by, which next to kinks of laws differs from run to run.
const FELT: f64 = 0.5;
/// So often they are taken over less at most.
const MOST_NARROWED: usize = 8;
/// A derivative bends where over a quarter of the move its square is more than so many times larger;
const BENT: f64 = 1.5;
/// so often a move is quartered at most.
const MOST_QUARTERED: usize = 4;
/// An end is moved out where the sum of squares rises, with all else fitted again, by less than this share of what it should,
const LEAST_RISE: f64 = 0.5;
/// to twice as far, so often at most,
const MOST_WIDENED: usize = 8;
/// each time fitted in so many rounds.
const ROUNDS: usize = 6;

/// So often a fit is gone on from what is better at an end of an interval.
const MOST_BETTERED: usize = 2;

/// Where a fit may be off.
struct Around<'a> {
    task: Task<'a>,
    at: DVector<f64>,
    chi2: f64,
    /// Standard errors of all coordinates, were the noise white,
    white: Vec<f64>,
    /// and as wide as it is; infinite where the data do not tell.
    errors: Vec<f64>,
    /// Within how many of these 95 of 100 cases lie, by how many blocks there are.
    within_95: f64,
    spread: Spread,
}

/// A stage with how well all that is fitted is known: as well as what is left, and how long that remembers, lets it be, and no
/// better than parts of the records agree.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub fn with_errors(problem: &Problem, stage: Stage) -> Result<Stage, ModelError> {
    let count = stage.version.fit.len();
    with_intervals(problem, stage, count, 1)
}

/// The same; the intervals of what stands at a place or behind it go on where the sum of squares, all else fitted again, rises
/// by less than it would if all were proportional to all, and a fit goes on from what is better there.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn with_intervals(
    problem: &Problem,
    stage: Stage,
    first: usize,
    threads: usize,
) -> Result<Stage, ModelError> {
    let model = problem.model(&stage.version, &problem.train, &problem.outputs)?;
    let mut stage = stage;
    for left in (0..=MOST_BETTERED).rev() {
        let Some(around) = problem.task(&model, &problem.train, true).around(&stage) else { break };
        let is_told = |place: &usize| around.errors[*place].is_finite();
        let told = (first..model.knobs.len()).filter(is_told);
        let sides: Vec<(usize, usize)> = told.flat_map(|place| [(place, 0), (place, 1)]).collect();
        let ends = pool::each(&sides, threads, |(place, side)| around.end(*place, *side), |_| ());
        stage.known = (0..model.knobs.len()).map(|place| around.known(place)).collect();
        for ((place, side), end) in sides.into_iter().zip(&ends) {
            stage.known[place].interval[side] = model.knobs[place].at(end.share);
        }
        let least = ends.into_iter().map(|end| end.least).min_by(|a, b| a.chi2.total_cmp(&b.chi2));
        let better = least.filter(|least| around.chi2 - least.chi2 > stage.train.reduced() * stage.memory);
        let Some(better) = better.filter(|_| left > 0) else { break };
        let Some(again) = refit(problem, &stage, stage.version.clone(), better.point)? else { break };
        stage = again;
    }
    Ok(stage)
}

impl<'a> Task<'a> {
    /// What lies around where a stage was fitted; nothing where the model cannot be run there.
    fn around(self, stage: &Stage) -> Option<Around<'a>> {
        let at = self.shares(&stage.train.point);
        let courses = self.courses(std::slice::from_ref(&at)).pop()??;
        let far = self.seen(&at, &courses, &self.straight_nudges(&at, &courses));
        // What is not told by next to nothing is not told: over more, curves hide what goes together.
        let near = self.seen(&at, &courses, &self.nudges(&at));
        let is_told: Vec<bool> =
            self.spread(&near.normal).errors().iter().map(|error| error.is_finite()).collect();
        let spread = self.spread(&far.normal);
        let white = spread.errors();
        // A block is bent by its own record's initial voltages, not by those of others.
        let bent = (0..at.len()).filter(|index| self.is_free(*index)).count()
            - (self.records.len() - 1) * self.model.initial.len();
        let by_blocks = spread.errors_by(&far.pulls, bent);
        let wide = (stage.train.reduced().max(1.0) * stage.memory).sqrt();
        let errors = white.iter().zip(by_blocks).zip(is_told).map(|((white, by_blocks), is_told)| {
            if is_told { (white * wide).max(by_blocks) } else { f64::INFINITY }
        });
        let errors = errors.collect();
        let chi2 = self.chi2(&at, &courses);
        let within_95 = student_95(far.pulls.len().saturating_sub(1));
        Some(Around { task: self, at, chi2, white, errors, within_95, spread })
    }
}

/// What moves of each coordinate change.
struct Seen {
    normal: Normal,
    /// How every block of residuals pulls at the coordinates.
    pulls: Vec<DVector<f64>>,
}

impl Task<'_> {
    /// Moves of each coordinate that are felt, and not by far.
    fn wide_nudges(&self, at: &DVector<f64>, courses: &[Course]) -> Vec<f64> {
        let mut nudges: Vec<f64> = (0..at.len()).map(|index| self.nudge(at, index, MOST_NUDGE)).collect();
        let data = courses.iter().flatten().map(Vec::len).sum::<usize>() as f64;
        for _ in 0..MOST_NARROWED {
            let normal = self.seen(at, courses, &nudges).normal;
            let mut is_narrower = false;
            for (index, nudge) in nudges.iter_mut().enumerate() {
                let felt = nudge.abs() * (normal.matrix[(index, index)] / data).sqrt();
                if felt > 2.0 * FELT && nudge.abs() > NUDGE {
                    *nudge = self.nudge(at, index, (nudge.abs() * FELT / felt).max(NUDGE));
                    is_narrower = true;
                }
            }
            if !is_narrower {
                break;
            }
        }
        nudges
    }

    /// The same, less where so far off all has changed its course, as a sine does with its frequency. Next to kinks of laws
    /// derivatives grow on and on: the wide moves stay.
    fn straight_nudges(&self, at: &DVector<f64>, courses: &[Course]) -> Vec<f64> {
        let squares = |nudges: &[f64]| self.seen(at, courses, nudges).normal.matrix.diagonal();
        let mut straight = self.wide_nudges(at, courses);
        let mut moves = straight.clone();
        let mut felt = squares(&moves);
        let mut bent: Vec<usize> = (0..at.len()).collect();
        for round in 0..MOST_QUARTERED {
            let quarters: Vec<f64> = moves.iter().map(|nudge| nudge / 4.0).collect();
            let nearer = squares(&quarters);
            let (bends, settles): (Vec<_>, Vec<_>) =
                bent.into_iter().partition(|index| nearer[*index] > BENT * felt[*index]);
            if round > 0 {
                settles.into_iter().for_each(|index| straight[index] = quarters[index]);
            }
            if bends.is_empty() {
                break;
            }
            (bent, moves, felt) = (bends, quarters, nearer);
        }
        straight
    }

    /// What so large moves of each coordinate change.
    fn seen(&self, at: &DVector<f64>, courses: &[Course], nudges: &[f64]) -> Seen {
        let (mut normal, mut pulls) = (Normal::empty(at.len()), Vec::new());
        for (record, course) in courses.iter().enumerate() {
            let outputs = self.told_by(at, record, course, nudges);
            outputs.iter().for_each(|(columns, residual)| normal.add(columns, residual));
            let each = outputs.iter().map(|(columns, residual)| self.pulls(columns, residual, at.len()));
            pulls.extend(together(each));
        }
        Seen { normal, pulls }
    }

    /// How every block of residuals pulls at the coordinates: its gradient.
    fn pulls(&self, columns: &[Column], residual: &[f64], count: usize) -> Vec<DVector<f64>> {
        let mut first = 0;
        let pull = |part: &[f64]| {
            let mut pull = DVector::zeros(count);
            for (index, column) in columns {
                pull[*index] = product_there(&column[first..], part, part);
            }
            first += part.len();
            pull
        };
        let samples = self.records.iter().map(Record::len).sum();
        in_blocks(residual, samples).map(pull).collect()
    }

    fn spread(&self, normal: &Normal) -> Spread {
        let way = |index: usize| {
            let [least, most] = self.bounds(index);
            (index, most - least)
        };
        let free: Vec<_> = (0..normal.gradient.len()).filter(|index| self.is_free(*index)).map(way).collect();
        Spread::of(normal, &free)
    }
}

/// Where an interval ends.
struct End {
    /// The share of the knob there.
    share: f64,
    /// What left least on the way.
    least: Reached,
}

impl Around<'_> {
    /// How well a knob is known, were all that was measured proportional to it.
    fn known(&self, place: usize) -> Known {
        if self.errors[place].is_infinite() {
            return Known::NOT;
        }
        let knob = &self.task.model.knobs[place];
        let by = self.within_95 * self.errors[place];
        Known {
            error: knob.slope(knob.at(self.at[place])) * self.errors[place],
            interval: [-by, by].map(|by| knob.at(self.at[place] + by)),
        }
    }

    /// The share at which an interval of a knob ends, the lower or the upper.
    fn end(&self, place: usize, side: usize) -> End {
        let most = (self.task.bounds(place)[side] - self.at[place]).abs();
        let sign = [-1.0, 1.0][side];
        let held = Task { held: Some(place), most_rounds: ROUNDS, ..self.task };
        let wanted = (self.within_95 * self.errors[place] / self.white[place]).powi(2);
        let along = self.spread.along(place);
        let mut step = self.within_95 * self.errors[place];
        let (mut from, mut gone, mut risen) = (self.at.clone(), 0.0, 0.0_f64);
        let mut least = Reached { point: self.task.point(&self.at), chi2: self.chi2, has_ended: true };
        for _ in 0..=MOST_WIDENED {
            let next = (gone + step).min(most);
            let mut to = &from + &along * (sign * (next - gone));
            for index in 0..to.len() {
                let [low, high] = self.task.bounds(index);
                to[index] = to[index].clamp(low, high);
            }
            let Some(reached) = held.reached(&self.task.point(&to)) else {
                gone = next;
                break;
            };
            if reached.chi2 < least.chi2 {
                least = reached.clone();
            }
            let rises = (reached.chi2 - self.chi2).max(0.0);
            if rises > LEAST_RISE * wanted {
                let share = ((wanted.sqrt() - risen.sqrt()) / (rises.sqrt() - risen.sqrt())).clamp(0.0, 1.0);
                // The first end is where all is as it should be, or the least that is told.
                gone = if gone == 0.0 { next } else { gone + share * (next - gone) };
                break;
            }
            if next >= most {
                gone = next;
                break;
            }
            (from, step, gone, risen) = (self.task.shares(&reached.point), next, next, rises);
        }
        End { share: self.at[place] + sign * gone, least }
    }
}

#[cfg(test)]
mod tests {
    use crate::fit::base_fit::fit_base;
    use std::f64::consts::PI;

    use super::*;
    use crate::fit::step_size::tests::AMPLITUDE;
    use crate::fit::step_size::tests::RATE;
    use crate::fit::step_size::tests::decay;
    use crate::fit::step_size::tests::measured;
    use patchcord_core::patch::Patch;

    /// What the sum of squares rises by at a rate, the amplitude fitted again, were the noise of 1 V.
    fn rise(rate: f64) -> f64 {
        let course = |rate: f64| (0..20).map(move |sample| (-rate * f64::from(sample)).exp());
        let dot = |one: f64, other: f64| course(one).zip(course(other)).map(|(a, b)| a * b).sum::<f64>();
        AMPLITUDE.powi(2) * (dot(RATE, RATE) - dot(rate, RATE).powi(2) / dot(rate, rate))
    }

    /// How well the rate of a decay is known, and by how much the sum of squares rises to the ends of its interval, in what it
    /// should.
    fn known(sigma: f64) -> (Known, [f64; 2]) {
        let (patch, fit, problem) = decay(sigma, 32);
        let base = fit_base(&problem, &patch, &fit, 1).unwrap().unwrap();
        let known = with_intervals(&problem, base, 0, 1).unwrap().known(0);
        (known, known.interval.map(|rate| rise(rate) / (student_95(19) * sigma).powi(2)))
    }

    #[test]
    fn an_interval_is_proportional_to_a_small_noise() {
        let (known, rises) = known(0.01);
        assert!(rises.iter().all(|rise| (rise - 1.0).abs() < 0.05), "{known:?} {rises:?}");
        let half = student_95(19) * known.error;
        assert!(known.interval.iter().all(|end| ((end - RATE).abs() / half - 1.0).abs() < 0.01), "{known:?}");
    }

    /// Faster decays leave next to nothing after the first sample, whatever their rate.
    #[test]
    fn an_interval_goes_on_where_values_further_off_change_little() {
        let (known, rises) = known(3.5);
        assert!((0.5..1.5).contains(&rises[1]), "{known:?} {rises:?}");
        assert!(known.interval[1] - RATE > 1.5 * student_95(19) * known.error, "{known:?}");
        assert_eq!(self::known(10.0).0.interval[1], 10.0);
    }

    /// A fiftieth of the range is eight turns at the end of what was measured.
    #[test]
    fn a_frequency_is_known_as_well_as_its_sine_tells() {
        let patch = r#"{
  "patchcord": 1,
  "parameters": {"f": {"value": 3.3, "unit": "1/s", "range": [0.1, 20]}},
  "scales": {"volts": {"per_volt": 1, "unit": "V"}},
  "drives": {"D1": {"kind": "sine", "scale": "volts", "amplitude": 5, "frequency": "f"}},
  "elements": {"A1": {"kind": "summer", "in": {"x1": ["D1"]}}}
}"#;
        let patch = Patch::parse("sine.json", patch).unwrap_or_else(|report| panic!("{report}"));
        let (count, sigma) = (200, 10.0);
        let times = (0..count).map(|sample| 0.1 * f64::from(sample));
        let volts = times.clone().map(|time| -5.0 * (2.0 * PI * 3.3 * time).sin()).collect();
        let problem = measured("A1", volts, sigma, 32);
        let base = fit_base(&problem, &patch, &["f".to_owned()], 1).unwrap().unwrap();
        let known = with_errors(&problem, base).unwrap().known(0);
        let felt = times.map(|time| (5.0 * 2.0 * PI * time * (2.0 * PI * 3.3 * time).cos()).powi(2));
        let error = sigma / felt.sum::<f64>().sqrt();
        assert!((known.error / error - 1.0).abs() < 0.05, "{known:?} {error}");
    }
}
