//! One junction: the force over time that closes the gap there, and the curves that it may be.

use crate::data::record::Record;
use crate::effects::sites::{Junction, Reading, Sites};
use crate::fit::estimate::{Fitted, Point};
use crate::fit::fitted_model::{Stage, Version};
use crate::fit::levenberg_marquardt::Task;
use crate::fit::model::{ModelError, Table, begun};
use crate::fit::problem::Problem;
use crate::fit::schedule::Effort;
use crate::fit::validation::validate;
use crate::localise::against::Variable;
use crate::localise::evidence::Solved;
use crate::localise::force::{Curve, Force, Whereabouts};
use crate::localise::recovered::{setting, with_function, with_table};
use crate::localise::unknown_input::{Found, PUSH, Shape, Sought, Start, between};
use patchcord_core::patch::Patch;

/// Over so many knots the force of all records goes, and over more where something is left.
const KNOTS: [usize; 2] = [160, 400];
/// So many knots a curve has, or more where that is likelier.
const CURVE_KNOTS: [usize; 2] = [24, 72];
/// What is left is nothing, in squares over noise.
const NOTHING_LEFT: f64 = 1.1;
/// How near knobs stay to where they were without the force, in shares of their ranges: nearer, where that leads nowhere.
const NEAR: [f64; 3] = [0.1, 0.01, 1e-4];
/// A knot takes so many samples at least.
const LEAST_SAMPLES: usize = 3;

/// A force acts where it comes to so many standard errors,
const STANDS_OUT: f64 = 3.0;
/// and beside that as long as it has one sign and comes to more than one of them, and to such a share of its largest value: less
/// may be what the parameters beside it are off by.
const OF_LARGEST: f64 = 0.2;
/// A curve must close such a share of the gap in the data that were held back,
const LEAST_HELD: f64 = 0.7;
/// or be as likely as a force of time. One that closes less of the gap that it is fitted to is none.
const LEAST_EXPLAINED: f64 = 0.5;
/// A curve that leaves more than so many times the squares when it is wired in is sought again from its outline;
const MUCH: f64 = 1.1;
/// one that leaves more than so many times then, and closes less than this share of the gap, has led astray,
const ASTRAY: f64 = 2.0;
const IN_STEP: f64 = 0.8;
/// and is found through such shares of the records, one after the other.
const GROWN: [f64; 6] = [0.1, 0.2, 0.35, 0.55, 0.75, 1.0];
/// So many curves are wired in at most.
const MOST_CLOSED: usize = 2;
/// A quantity that is asked later, or a curve for each direction, must be better by so much in the logarithm of its likelihood.
const TELLING: f64 = 10.0;

/// A curve, and the point beside it.
struct Drawn {
    curve: Curve,
    beside: Point,
}

/// A curve over a quantity, or one for each direction, as the force over time asks for it.
struct Over {
    /// So many knots were asked for,
    count: usize,
    /// and these they are, with those about 0.
    knots: Vec<f64>,
    solved: Solved,
}

impl Over {
    /// Value, force and standard error of the numbers from a place on.
    fn points(&self, first: usize) -> Vec<[f64; 3]> {
        let number = |(place, knot): (usize, &f64)| {
            let variance = self.solved.covariance[(first + place, first + place)];
            [*knot, self.solved.sought[first + place], variance.max(0.0).sqrt()]
        };
        self.knots.iter().enumerate().map(number).collect()
    }
}

/// A curve wired in.
struct Closed {
    patch: Patch,
    found: Found,
    test: Fitted,
}

/// One junction of a stage.
pub(super) struct At<'a> {
    pub problem: &'a Problem,
    pub stage: &'a Stage,
    pub sites: &'a Sites,
    pub junction: &'a Junction,
}

impl At<'_> {
    /// The force; nothing where none comes to anything.
    pub fn whereabouts(&self) -> Result<Option<Whereabouts>, ModelError> {
        let (patch, drive) = with_table(self.stage.version.patch(), self.junction, &[[0.0, 0.0]])?;
        let version = self.version(patch);
        let model = self.problem.model(&version, &self.problem.train, &self.problem.outputs)?;
        let task = self.problem.task(&model, &self.problem.train, true);
        let table = Table::Drive(&drive);
        let shapes = KNOTS.map(|knots| over_time(&self.problem.train, knots));
        let Some((shape, found)) = self.over_time(task, table, &shapes) else { return Ok(None) };
        let sought = self.sought(task, table, shape);
        let records = 0..self.problem.train.len();
        let forces: Vec<Vec<[f64; 2]>> = records.map(|record| shape.points(record, &found.sought)).collect();
        let variables = self.variables(&version, &drive, &forces, &found.point)?;
        let drawn = variables.iter().filter_map(|variable| self.drawn(&sought, variable, &found, &forces));
        let mut drawn: Vec<Drawn> = drawn.collect();
        let best = self.best(&mut drawn, &variables, &found);
        let recovered = match &best {
            Some((_, Some(closed))) => self.at(&closed.patch, &closed.found)?,
            _ => {
                let (patch, _) = with_table(self.stage.version.patch(), self.junction, &forces[0])?;
                self.at(&patch, &found)?
            }
        };
        Ok(Some(Whereabouts {
            junction: self.junction.integrator.clone(),
            unit: self.junction.sum.unit.text().to_owned(),
            explains: self.explains(found.chi2),
            evidence: found.evidence,
            effective: found.effective,
            likeness: found.likeness,
            forces: self.forces(shape, &found),
            best: best.map(|(best, _)| best),
            curves: drawn.into_iter().map(|drawn| drawn.curve).collect(),
            recovered,
        }))
    }

    /// The force over time, with more knots where few leave something.
    fn over_time<'s>(
        &self,
        task: Task<'_>,
        table: Table<'_>,
        shapes: &'s [Shape],
    ) -> Option<(&'s Shape, Found)> {
        let start = Start { point: &self.stage.train.point, sought: None };
        let mut best: Option<(&Shape, Found)> = None;
        for shape in shapes {
            let found = NEAR
                .into_iter()
                .find_map(|near| Sought { near, ..self.sought(task, table, shape) }.find(&start));
            let is_better = |found: &Found| best.as_ref().is_none_or(|best| found.evidence > best.1.evidence);
            if let Some(found) = found.filter(is_better) {
                best = Some((shape, found));
            }
            if best.as_ref().is_some_and(|best| best.1.chi2 < NOTHING_LEFT * self.stage.train.count as f64) {
                break;
            }
        }
        best
    }

    /// The patch with its parameters as they were found, and as the first record begins.
    fn at(&self, patch: &Patch, found: &Found) -> Result<Patch, ModelError> {
        let at = self.version(patch.clone()).at(patch.file(), &found.point.knobs)?;
        begun(&at, &self.stage.version.free, &found.point.initial[0])
    }

    fn version(&self, patch: Patch) -> Version {
        self.stage.version.with_patch(patch)
    }

    fn sought<'s>(&'s self, task: Task<'s>, table: Table<'s>, shape: &'s Shape) -> Sought<'s> {
        let (home, without) = (&self.stage.train.point, self.stage.train.chi2);
        Sought {
            task,
            table,
            push: PUSH * self.junction.sum.per_volt,
            shape,
            home,
            without,
            acts_back: matches!(table, Table::Curve(_)),
            near: NEAR[0],
        }
    }

    /// The share of the gap that is closed where so much is left.
    fn explains(&self, chi2: f64) -> f64 {
        share(&self.stage.train, chi2)
    }

    fn forces(&self, shape: &Shape, found: &Found) -> Vec<Force> {
        let mut errors = found.errors.iter().zip(&found.errors_alone);
        let records = self.problem.train.iter().enumerate();
        let force = |(place, record): (usize, &Record)| {
            let points = shape.points(place, &found.sought).into_iter().zip(errors.by_ref());
            let points: Vec<[f64; 4]> = points
                .map(|([time, force], (error, alone))| [record.begin + time, force, *error, *alone])
                .collect();
            Force { data: record.name.clone(), windows: windows(&points), points }
        };
        records.map(force).collect()
    }

    /// What a force may go with, in the order in which it is asked.
    fn readings(&self) -> Vec<&Reading> {
        let (own, others) = (&self.junction.own, self.sites.junctions.iter().map(|other| &other.own));
        let all = [own].into_iter().chain(&self.junction.positions).chain(&self.sites.drives).chain(others);
        let mut readings: Vec<&Reading> = Vec::new();
        for reading in all {
            if readings.iter().all(|own| own.signal != reading.signal) {
                readings.push(reading);
            }
        }
        readings
    }

    /// What the patch does with a force.
    fn variables(
        &self,
        version: &Version,
        drive: &str,
        forces: &[Vec<[f64; 2]>],
        point: &Point,
    ) -> Result<Vec<Variable>, ModelError> {
        let readings = self.readings();
        let names: Vec<String> = readings.iter().map(|reading| reading.signal.clone()).collect();
        let model = self.problem.model(version, &self.problem.train, &names)?;
        let mut tracks = vec![Vec::new(); names.len()];
        for (record, force) in forces.iter().enumerate() {
            let course =
                model.run_tabled(record, Table::Drive(drive), &[(point.choice(record), force.clone())]);
            // It has run for the outputs; of what does not run now no curve is drawn.
            let Some(course) = course.into_iter().flatten().next() else { return Ok(Vec::new()) };
            tracks.iter_mut().zip(course).for_each(|(own, track)| own.push(track));
        }
        let variable = |(reading, tracks): (&&Reading, Vec<Vec<f64>>)| Variable {
            name: reading.signal.clone(),
            unit: reading.unit.text().to_owned(),
            reading: Some((*reading).clone()),
            tracks,
            may_jump: reading.signal == self.junction.own.signal,
        };
        let mut all: Vec<Variable> = readings.iter().zip(tracks).map(variable).collect();
        let rest = self.junction.is_motion.then(|| Variable::rest_of(&all[0], &self.intervals())).flatten();
        all.extend(rest);
        Ok(all)
    }

    fn intervals(&self) -> Vec<f64> {
        self.problem.train.iter().map(|record| record.interval).collect()
    }

    /// The force as a curve over a quantity; nothing where that stands still.
    fn drawn(
        &self,
        sought: &Sought<'_>,
        variable: &Variable,
        time: &Found,
        forces: &[Vec<[f64; 2]>],
    ) -> Option<Drawn> {
        let solved = |knots, turns| self.over(sought.shape, variable, time, knots, turns);
        let [few, many] = CURVE_KNOTS;
        let coarse = solved(few, false)?;
        let fine = solved(many, false).filter(|fine| fine.solved.evidence > coarse.solved.evidence + TELLING);
        let one = fine.unwrap_or(coarse);
        let two = solved(one.count, true).filter(|two| two.solved.evidence > one.solved.evidence + TELLING);
        let curve = Curve {
            against: variable.name.clone(),
            unit: variable.unit.clone(),
            points: one.points(0),
            by_direction: two.map(|two| [two.points(0), two.points(two.knots.len())]),
            explains: self.explains(one.solved.left),
            evidence: one.solved.evidence,
            held_out: None,
            scatter: self.scatter(variable, forces),
        };
        Some(Drawn { curve, beside: sought.beside(time, &one.solved) })
    }

    /// A force over time as a curve of about so many knots over a quantity, or as two where it turns.
    fn over(
        &self,
        time: &Shape,
        variable: &Variable,
        found: &Found,
        count: usize,
        turns: bool,
    ) -> Option<Over> {
        let knots = variable.knots(count)?;
        let shares = variable.shares(time, &knots, turns, &self.intervals());
        let groups = vec![knots.len(); shares.ncols() / knots.len()];
        Some(Over { count, solved: found.products.over(&shares, groups).solved()?, knots })
    }

    fn scatter(&self, variable: &Variable, forces: &[Vec<[f64; 2]>]) -> Vec<[f64; 2]> {
        let records = forces.iter().zip(self.intervals()).enumerate();
        let points = records.flat_map(|(record, (points, interval))| {
            points.iter().map(move |[time, force]| [variable.at(record, *time, interval), *force])
        });
        points.collect()
    }

    /// The curve that the force goes with best, wired in where it can be: of the few that are most likely the first that holds for
    /// what was held back, or, where it cannot be wired in, is as likely as a force that goes with time alone.
    fn best(
        &self,
        drawn: &mut [Drawn],
        variables: &[Variable],
        time: &Found,
    ) -> Option<(usize, Option<Closed>)> {
        let mut left: Vec<usize> =
            (0..drawn.len()).filter(|place| drawn[*place].curve.explains > LEAST_EXPLAINED).collect();
        for _ in 0..MOST_CLOSED {
            let likelier = |best: usize, own: usize| {
                let [best_one, own_one] = [best, own].map(|place| drawn[place].curve.evidence);
                if own_one > best_one + TELLING { own } else { best }
            };
            let Some(place) = left.iter().copied().reduce(likelier) else { break };
            left.retain(|own| *own != place);
            let Drawn { curve, beside } = &mut drawn[place];
            let own = variables.iter().find(|own| own.name == curve.against);
            let reading = own.and_then(|own| own.reading.as_ref());
            // A curve with knots beyond what the machine can hold is no function generator.
            let closed = reading.and_then(|reading| self.closed(reading, curve, beside).ok().flatten());
            let Some(closed) = closed else {
                if curve.evidence > time.evidence {
                    return Some((place, None));
                }
                continue;
            };
            let held = share(&self.stage.test, closed.test.chi2);
            curve.held_out = Some(held);
            if held > LEAST_HELD || (held > 0.0 && curve.evidence > time.evidence) {
                // What each direction shows stays as it was found over time.
                curve.explains = self.explains(closed.found.chi2);
                let numbers = closed.found.sought.iter().zip(&closed.found.errors);
                let own = curve.points.iter_mut().zip(numbers);
                own.for_each(|(point, (force, error))| *point = [point[0], *force, *error]);
                return Some((place, Some(closed)));
            }
        }
        None
    }

    /// Whether a curve leaves so many times more when it is wired in than over the force of time.
    fn leaves_more(&self, closed: &Found, open: &Curve, times: f64) -> bool {
        let leaves_something = closed.chi2 > NOTHING_LEFT * self.stage.train.count as f64;
        leaves_something && 1.0 - self.explains(closed.chi2) > times * (1.0 - open.explains)
    }

    /// Whether a curve has fallen out of step where it is wired in: it leaves far more than over the force of time, and much.
    fn is_astray(&self, closed: &Found, open: &Curve) -> bool {
        self.leaves_more(closed, open, ASTRAY) && self.explains(closed.chi2) < IN_STEP
    }

    /// A curve as a function generator, which sees what it does itself.
    fn closed(&self, reading: &Reading, curve: &Curve, beside: &Point) -> Result<Option<Closed>, ModelError> {
        let column = |place: usize| curve.points.iter().map(|point| point[place]).collect::<Vec<f64>>();
        let (knots, numbers) = (column(0), column(1));
        let shape = setting(&knots, self.junction, reading, self.problem.train.len());
        let wired = |numbers: &[f64]| {
            with_function(self.stage.version.patch(), self.junction, reading, &shape.points(0, numbers))
        };
        let (patch, element) = wired(&numbers)?;
        let version = self.version(patch);
        let model = self.problem.model(&version, &self.problem.train, &self.problem.outputs)?;
        let task = self.problem.task(&model, &self.problem.train, true);
        let sought = self.sought(task, Table::Curve(&element), &shape);
        let from_open = Start { point: beside, sought: Some(&numbers) };
        let from_none = Start { point: &self.stage.train.point, sought: None };
        let mut found = sought.find(&from_open);
        let nearer = |a: &Found, b: &Found| a.chi2.total_cmp(&b.chi2);
        if found.as_ref().is_none_or(|own| self.leaves_more(own, curve, MUCH)) {
            let places = outline(&knots);
            let outlined = Sought { shape: &shape.coarser(&places), ..sought }.find(&from_none);
            let outlined = outlined.map(|own| (between(&places, &own.sought, knots.len()), own.point));
            let start = outlined.as_ref().map(|(numbers, point)| Start { point, sought: Some(numbers) });
            found = found.into_iter().chain(sought.find(&start.unwrap_or(from_none))).min_by(nearer);
        }
        if found.as_ref().is_none_or(|own| self.is_astray(own, curve)) {
            found = found.into_iter().chain(sought.grown(&GROWN)).min_by(nearer);
        }
        let Some(found) = found else { return Ok(None) };
        let (patch, _) = wired(&found.sought)?;
        let version = self.version(patch);
        let test = validate(
            self.problem,
            &version,
            &found.point,
            Some(&self.stage.test.point.initial),
            Effort::FULL,
        )?;
        Ok(test.map(|test| Closed { patch: version.patch().clone(), found, test }))
    }
}

/// The places of the few knots between which a curve goes nearly straight: the ends, those about 0, and one between.
fn outline(knots: &[f64]) -> Vec<usize> {
    let last = knots.len() - 1;
    let zero = knots.partition_point(|knot| *knot < 0.0).clamp(1, last);
    let mut places = vec![0, (zero - 1) / 2, zero - 1, zero, (zero + last) / 2, last];
    places.dedup();
    places
}

/// The share of a gap that is closed where so much is left of its squares.
fn share(base: &Fitted, chi2: f64) -> f64 {
    1.0 - base.unexplained_of(chi2) / base.unexplained()
}

/// A number of its own every few samples.
fn over_time(records: &[Record], knots: usize) -> Shape {
    let samples: usize = records.iter().map(Record::len).sum();
    let every = samples.div_ceil(knots).max(LEAST_SAMPLES);
    let mut groups: Vec<usize> = Vec::new();
    let shape = |record: &Record| {
        let count = (record.len() - 1).div_ceil(every) + 1;
        let first: usize = groups.iter().sum();
        groups.push(count);
        let time = |knot: usize| (knot * every) as f64 * record.interval;
        (0..count).map(|knot| (time(knot), vec![(first + knot, 1.0)])).collect()
    };
    let records = records.iter().map(shape).collect();
    Shape { groups, records }
}

/// From when to when a force stands out of its error.
fn windows(points: &[[f64; 4]]) -> Vec<[f64; 2]> {
    let largest = points.iter().fold(0.0, |most: f64, point| most.max(point[1].abs()));
    let mut windows = Vec::new();
    let mut from = 0;
    while from < points.len() {
        // A stretch of one sign that does not sink into its error.
        let sign = points[from][1].signum();
        let goes_on = |[_, force, _, error]: &&[f64; 4]| sign * force > error.max(OF_LARGEST * largest);
        let length = points[from..].iter().take_while(goes_on).count();
        let stretch = &points[from..from + length];
        if stretch.iter().any(|[_, force, _, error]| force.abs() > STANDS_OUT * error) {
            windows.push([stretch[0][0], stretch[length - 1][0]]);
        }
        from += length.max(1);
    }
    windows
}
