//! A force that nobody knows: wired to a junction as a table, and found by regularised least squares on what each of its numbers
//! does to the outputs, beside knobs, initial voltages and offsets.

use nalgebra::{DMatrix, DVector};

use crate::fit::estimate::Point;
use crate::fit::levenberg_marquardt::{AT_ONCE, NUDGE, Task, nudged};
use crate::fit::model::{Choice, Course, Table};
use crate::fit::schedule::Beginnings;
use crate::localise::evidence::{Known, Likeness, Products, Solved};
use patchcord_analysis::spare;

/// How the force of every record follows from what is sought.
#[derive(Debug, Clone)]
pub struct Shape {
    /// How many numbers are sought, group by group.
    pub groups: Vec<usize>,
    /// Of every record the points between which the force goes straight.
    pub records: Vec<Vec<Instant>>,
}

/// A time (of a curve, a voltage), and of which numbers the force there is made, and how much of each.
pub type Instant = (f64, Vec<(usize, f64)>);

impl Shape {
    /// The force of a record: points of a table.
    pub fn points(&self, record: usize, sought: &[f64]) -> Vec<[f64; 2]> {
        let force =
            |parts: &Vec<(usize, f64)>| parts.iter().map(|(place, share)| share * sought[*place]).sum();
        self.records[record].iter().map(|(time, parts)| [*time, force(parts)]).collect()
    }

    /// The same of one group, whose numbers follow from those at a few places: straight from one to the next.
    pub fn coarser(&self, places: &[usize]) -> Shape {
        let few =
            |(place, share): &(usize, f64)| nearest(places, *place).map(|(few, near)| (few, share * near));
        let instant = |(time, parts): &Instant| (*time, parts.iter().flat_map(few).collect());
        let records = self.records.iter().map(|own| own.iter().map(instant).collect());
        Shape { groups: vec![places.len()], records: records.collect() }
    }

    /// How many numbers there are.
    pub fn count(&self) -> usize {
        self.groups.iter().sum()
    }

    /// The numbers that matter to a record.
    fn of(&self, record: usize) -> Vec<usize> {
        let mut all: Vec<usize> =
            self.records[record].iter().flat_map(|(_, parts)| parts.iter().map(|part| part.0)).collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// Numbers of which these stand at a few places, straight from one to the next.
pub fn between(places: &[usize], few: &[f64], count: usize) -> Vec<f64> {
    let number = |place| nearest(places, place).iter().map(|(own, near)| near * few[*own]).sum();
    (0..count).map(number).collect()
}

/// The two of a few places beside another, and how near it is to each.
fn nearest(places: &[usize], place: usize) -> [(usize, f64); 2] {
    let next = places.partition_point(|own| *own < place).clamp(1, places.len() - 1);
    let [from, to] = [next - 1, next].map(|own| places[own] as f64);
    let way = (place as f64 - from) / (to - from);
    [(next - 1, 1.0 - way), (next, way)]
}

/// A force that is looked for.
#[derive(Clone, Copy)]
pub struct Sought<'a> {
    /// The patch with a table for it, and what it is held against.
    pub task: Task<'a>,
    /// The table.
    pub table: Table<'a>,
    /// By how much its numbers are moved for derivatives.
    pub push: f64,
    /// What the force is made of.
    pub shape: &'a Shape,
    /// What was fitted without it.
    pub home: &'a Point,
    /// The sum of squares that this leaves.
    pub without: f64,
    /// Whether the force acts back on itself, so that steps may have to be shorter.
    pub acts_back: bool,
    /// Knobs and initial voltages are expected where they were fitted without the force, give or take this share of their ranges.
    pub near: f64,
}

/// From where a force is looked for.
pub struct Start<'a> {
    /// Knobs, initial voltages and offsets.
    pub point: &'a Point,
    /// The numbers; none are 0.
    pub sought: Option<&'a [f64]>,
}

/// A force found.
#[derive(Debug, Clone)]
pub struct Found {
    /// Knobs, initial voltages and offsets beside it.
    pub point: Point,
    /// Its numbers.
    pub sought: Vec<f64>,
    /// Their standard errors,
    pub errors: Vec<f64>,
    /// and if all else were known.
    pub errors_alone: Vec<f64>,
    /// The sum of squares of the residuals.
    pub chi2: f64,
    /// Logarithm of the marginal likelihood, above that of no force.
    pub evidence: f64,
    /// To how many free numbers it comes.
    pub effective: f64,
    /// How its numbers are alike.
    pub likeness: Likeness,
    /// What the data say about its numbers, about these coordinates.
    pub products: Products,
    about: DVector<f64>,
}

/// So often the response is worked out at most.
const MOST_ROUNDS: usize = 5;
/// What is left is as was foreseen, to this share.
const FORESEEN: f64 = 0.03;
/// A force that acts back must not begin with more than so many times the squares that are left without it.
const FAR: f64 = 3.0;
/// Shares of a step that are tried where all of it leads to more than there was.
const SHARES: [f64; 3] = [0.5, 0.2, 0.05];
/// What is known of offsets before, as an inverse variance in sigmas.
const HARDLY: f64 = 1e-6;

/// Where a search for a force stands.
#[derive(Clone)]
struct Standing {
    at: DVector<f64>,
    sought: DVector<f64>,
}

impl Sought<'_> {
    /// Finds it; nothing where the patch cannot be run, or where it comes to nothing better than no force.
    pub fn find(&self, start: &Start<'_>) -> Option<Found> {
        let is_better = |chi2: f64| chi2 < self.without;
        let none = DVector::zeros(self.shape.count());
        let sought = start.sought.map_or(none, DVector::from_column_slice);
        let mut standing = Standing { at: self.task.shares(start.point), sought };
        let mut before =
            self.chi2(&standing).filter(|before| !self.acts_back || *before < FAR * self.without)?;
        for round in 1.. {
            let products = self.products(&standing)?;
            let solved = products.solved()?;
            let Some((next, chi2)) = self.step(&standing, &solved, before) else {
                return is_better(before).then(|| self.found(&standing, &standing, products, solved, before));
            };
            let is_settled = self.acts_back && (before - chi2).abs() < FORESEEN * chi2;
            if is_settled || (chi2 - solved.left).abs() < FORESEEN * solved.left {
                return is_better(chi2).then(|| self.found(&next, &standing, products, solved, chi2));
            }
            if round == MOST_ROUNDS {
                // What is sought alone, beside what came nearest.
                let frozen = Standing { sought: products.frozen().solved()?.sought, at: standing.at.clone() };
                let frozen = self.chi2(&frozen).map(|chi2| (frozen, chi2));
                let nearest = frozen.into_iter().chain([(next, chi2)]).min_by(|a, b| a.1.total_cmp(&b.1));
                let (next, chi2) = nearest.filter(|(_, chi2)| is_better(*chi2))?;
                return Some(self.found(&next, &standing, products, solved, chi2));
            }
            (standing, before) = (next, chi2);
        }
        None
    }

    /// Finds it through ever larger shares of the records, each from where the one before led to: what acts back on itself falls out
    /// of step with the end of a record before it keeps step with the beginning.
    pub fn grown(&self, shares: &[f64]) -> Option<Found> {
        let mut found: Option<Found> = None;
        for share in shares {
            let beginnings = Beginnings::of(&self.task, *share);
            let task = beginnings.as_ref().map_or(self.task, |own| own.task(&self.task));
            let none = Standing { at: task.shares(self.home), sought: DVector::zeros(self.shape.count()) };
            let without = Sought { task, ..*self }.chi2(&none)?;
            let point = found.as_ref().map_or(self.home, |own| &own.point);
            let sought = found.as_ref().map(|own| own.sought.as_slice());
            found = Some(Sought { task, without, ..*self }.find(&Start { point, sought })?);
        }
        found
    }

    /// To what was solved for; where the force acts back and that leads astray, a share of the way on which the sum of squares
    /// falls, if there is one.
    fn step(&self, from: &Standing, solved: &Solved, before: f64) -> Option<(Standing, f64)> {
        let to = |share: f64| {
            let to = self.moved(from, solved, share);
            let chi2 = self.chi2(&to).unwrap_or(f64::INFINITY);
            (to, chi2)
        };
        let all = to(1.0);
        if !self.acts_back || all.1 < before.max(self.without) {
            return Some(all);
        }
        SHARES.into_iter().map(to).find(|(_, chi2)| *chi2 < before)
    }

    /// A share of the way to what was solved for.
    fn moved(&self, from: &Standing, solved: &Solved, share: f64) -> Standing {
        let mut at = from.at.clone();
        for (place, index) in self.free().into_iter().enumerate() {
            let [low, high] = self.task.bounds(index);
            at[index] = (from.at[index] + share * solved.free[place]).clamp(low, high);
        }
        Standing { at, sought: &from.sought + (&solved.sought - &from.sought) * share }
    }

    /// The point beside numbers that were solved for from the same products as another force.
    pub fn beside(&self, other: &Found, solved: &Solved) -> Point {
        let about = Standing { at: other.about.clone(), sought: solved.sought.clone() };
        self.task.point(&self.moved(&about, solved, 1.0).at)
    }

    fn found(
        &self,
        standing: &Standing,
        about: &Standing,
        products: Products,
        solved: Solved,
        chi2: f64,
    ) -> Found {
        let errors = |covariance: &DMatrix<f64>| -> Vec<f64> {
            covariance.diagonal().iter().map(|variance| variance.max(0.0).sqrt()).collect()
        };
        let alone = products.covariance_alone(&solved);
        Found {
            point: self.task.point(&standing.at),
            sought: standing.sought.iter().copied().collect(),
            errors: errors(&solved.covariance),
            errors_alone: errors(alone.as_ref().unwrap_or(&solved.covariance)),
            chi2,
            evidence: solved.evidence,
            effective: solved.effective,
            likeness: solved.likeness,
            products,
            about: about.at.clone(),
        }
    }

    /// The free coordinates.
    fn free(&self) -> Vec<usize> {
        let task = &self.task;
        (0..task.states_of(task.records.len()).start).filter(|index| task.is_free(*index)).collect()
    }

    fn chi2(&self, standing: &Standing) -> Option<f64> {
        let course = |record: usize| {
            let lane = self.lane(record, &standing.at, &standing.sought);
            self.task.model.run_tabled(record, self.table, &[lane]).pop()?
        };
        let courses: Option<Vec<Course>> = spare::each(self.task.records.len(), course).into_iter().collect();
        Some(self.task.chi2(&standing.at, &courses?))
    }

    fn lane(&self, record: usize, at: &DVector<f64>, sought: &DVector<f64>) -> (Choice, Vec<[f64; 2]>) {
        (self.task.choice(at, record), self.shape.points(record, sought.as_slice()))
    }

    /// What every number does to the outputs, and what is left of them.
    fn products(&self, standing: &Standing) -> Option<Products> {
        let (free, home) = (self.free(), self.task.shares(self.home));
        let known = free.iter().map(|index| Known {
            at: home[*index] - standing.at[*index],
            weight: if self.is_offset(*index) { HARDLY } else { 1.0 / (self.near * self.near) },
            range: self.task.bounds(*index).map(|end| end - standing.at[*index]),
        });
        let mut products = Products::new(known.collect(), self.shape.groups.clone(), self.without);
        let mut is_whole = true;
        let columns = |record: usize| self.columns(record, standing, &free);
        spare::each_of(self.task.records.len(), AT_ONCE, columns, |columns| {
            is_whole &= columns.is_some();
            columns.iter().flatten().for_each(|rows| products.add(rows));
        });
        is_whole.then_some(products)
    }

    fn is_offset(&self, index: usize) -> bool {
        (self.task.model.knobs.len()..self.task.common()).contains(&index)
    }

    /// Of every output of a record the derivatives by all that is free or sought, and in the last column what is to be explained.
    fn columns(&self, record: usize, standing: &Standing, free: &[usize]) -> Option<Vec<DMatrix<f64>>> {
        let Standing { at, sought } = standing;
        let mut lanes = vec![self.lane(record, at, sought)];
        // Of each further lane its column, and by how much it was moved.
        let mut moved: Vec<(usize, f64)> = Vec::new();
        for (column, index) in free.iter().enumerate().filter(|(_, index)| self.matters(**index, record)) {
            let nudge = self.task.nudge(at, *index, NUDGE);
            lanes.push(self.lane(record, &nudged(at, *index, nudge), sought));
            moved.push((column, nudge));
        }
        for place in self.shape.of(record) {
            lanes.push(self.lane(record, at, &nudged(sought, place, self.push)));
            moved.push((free.len() + place, self.push));
        }
        let courses = self.task.model.run_tabled(record, self.table, &lanes);
        let here = courses[0].as_ref()?;
        let width = free.len() + self.shape.count() + 1;
        let outputs = (0..self.task.sigma.len()).map(|output| {
            let residual = self.task.residual(at, record, output, here);
            let mut columns = DMatrix::zeros(residual.len(), width);
            for ((column, by), there) in moved.iter().zip(&courses[1..]) {
                // Where a neighbour cannot be run, that number stays.
                let Some(there) = there else { continue };
                let scale = 1.0 / (by * self.task.sigma[output]);
                for (row, (there, here)) in there[output].iter().zip(&here[output]).enumerate() {
                    columns[(row, *column)] = (there - here) * scale;
                }
            }
            let offset = free.iter().position(|index| *index == self.task.model.knobs.len() + output);
            offset.into_iter().for_each(|column| columns.column_mut(column).fill(1.0));
            let made = columns.columns(free.len(), self.shape.count()) * sought;
            columns.set_column(width - 1, &(DVector::from_vec(residual) + made));
            let missing: Vec<usize> =
                (0..columns.nrows()).filter(|row| columns[(*row, width - 1)].is_nan()).collect();
            columns.remove_rows_at(&missing)
        });
        Some(outputs.collect())
    }

    /// Whether a coordinate is one that runs of a record follow.
    fn matters(&self, index: usize, record: usize) -> bool {
        let task = &self.task;
        index < task.model.knobs.len() || task.states_of(record).contains(&index)
    }
}

/// The voltage by which numbers are moved for derivatives.
pub(super) const PUSH: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::fit::fitted_model::Version;
    use crate::fit::step_size::tests::measured;
    use crate::localise::unknown_input::PUSH;
    use patchcord_core::circuit::Circuit;
    use patchcord_core::ir::Program;
    use patchcord_core::patch::Patch;
    use patchcord_core::solve::{self, RunSettings};

    const SAMPLES: usize = 201;
    const INTERVAL: f64 = 0.01;
    const STEPS: u32 = 4;
    const KNOTS: usize = 11;
    /// It swings the mass through its play and far beyond.
    const FORCE: [f64; KNOTS] = [2.0, 30.0, -20.0, 10.0, 40.0, -50.0, 0.0, 25.0, -30.0, 5.0, 1.0];

    fn knot(place: usize) -> f64 {
        place as f64 * (SAMPLES - 1) as f64 * INTERVAL / (KNOTS - 1) as f64
    }

    /// A mass with play in its spring, and friction with the square of speed; as much of a further force that is 1 V at a knot and goes
    /// straight to nothing at those beside it as a pot lets through.
    fn mass(place: usize) -> Patch {
        let table = |height: &dyn Fn(usize) -> f64| {
            let points: Vec<_> = (0..KNOTS).map(|knot_at| [knot(knot_at), height(knot_at)]).collect();
            json!({"kind": "table", "scale": "volt", "points": points})
        };
        let text = json!({
            "patchcord": 1,
            "parameters": {"p": {"value": 0, "unit": "1", "range": [0, 1]}},
            "scales": {"volt": {"unit": "V", "per_volt": 1}},
            "drives": {
                "force": table(&|own| FORCE[own]),
                "further": table(&|own| f64::from(own == place)),
            },
            "elements": {
                "P1": {"kind": "pot", "in": "further", "setting": "p"},
                "Z1": {"kind": "dead-zone", "in": "A2", "lower": -3, "upper": 5},
                "B1": {"kind": "inverter", "in": "Z1"},
                "U1": {"kind": "absolute", "in": "A1"},
                "M1": {"kind": "multiplier", "mode": "product", "a": "A1", "b": "U1"},
                "A1": {"kind": "integrator", "in": {"x10": ["force", "P1", "B1"], "x1": ["M1"]}},
                "A2": {"kind": "integrator", "in": {"x10": ["A1"]}},
            },
            "signals": {"x": {"at": "A2", "scale": "volt"}, "v": {"at": "A1", "scale": "volt"}},
            "run": {"for": 2, "step": 0.0025}
        });
        Patch::parse("mass.json", &text.to_string()).unwrap_or_else(|report| panic!("{report}"))
    }

    /// What the engine tells: the derivatives of x and v by the setting of the pot, sample by sample.
    fn exact(patch: &Patch) -> [Vec<f64>; 2] {
        let circuit = Circuit::new(patch, &[]).unwrap();
        let settings = RunSettings {
            step: INTERVAL / f64::from(STEPS),
            every: INTERVAL,
            record: vec!["x".to_owned(), "v".to_owned()],
            sensitivities: vec!["p".to_owned()],
            ..RunSettings::of(&circuit).unwrap()
        };
        let trace = solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap();
        ["x", "v"].map(|signal| trace.derivative(signal, "p").unwrap().values().collect())
    }

    /// What a force at a knot, and the pot, do to both outputs, by the differences that the search takes.
    fn by_differences(patch: &Patch, place: usize) -> Vec<DMatrix<f64>> {
        let mut problem = measured("x", vec![0.0; SAMPLES], 1.0, STEPS);
        problem.outputs.push("v".to_owned());
        problem.sigma.push(1.0);
        problem.offset.push(false);
        problem.train[0].interval = INTERVAL;
        problem.train[0].outputs.push(vec![0.0; SAMPLES]);
        let fit = vec!["p".to_owned()];
        let version = Version::new(patch.clone(), fit, Vec::new(), STEPS);
        let model = problem.model(&version, &problem.train, &problem.outputs).unwrap();
        let task = problem.task(&model, &problem.train, true);
        let groups = (0..KNOTS).map(|own| (knot(own), vec![(own, 1.0)])).collect();
        let shape = Shape { groups: vec![KNOTS], records: vec![groups] };
        let home = Point { knobs: vec![0.0], initial: vec![vec![0.0; 2]], offsets: vec![0.0; 2] };
        let sought = Sought {
            task,
            table: Table::Drive("force"),
            push: PUSH,
            shape: &shape,
            home: &home,
            without: f64::INFINITY,
            acts_back: false,
            near: 0.1,
        };
        let standing = Standing { at: task.shares(&home), sought: DVector::from_column_slice(&FORCE) };
        let columns = sought.columns(0, &standing, &[0]).unwrap();
        columns.iter().map(|own| own.select_columns(&[0, 1 + place])).collect()
    }

    #[test]
    fn what_a_force_does_is_what_the_engine_tells() {
        for place in [0, 3, 7] {
            let patch = mass(place);
            let exact = exact(&patch);
            for (exact, columns) in exact.iter().zip(by_differences(&patch, place)) {
                let exact = DVector::from_column_slice(exact);
                for column in columns.column_iter() {
                    let apart = (column - &exact).amax() / exact.amax();
                    assert!(apart < 1e-4, "{place}: {apart}");
                }
            }
        }
    }
}
