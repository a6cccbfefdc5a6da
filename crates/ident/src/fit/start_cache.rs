//! How fits begin from several points: what was found before is not found again.

use crate::fit::estimate::{Point, Reached};
use crate::fit::levenberg_marquardt::Task;

/// What is known of points from which the same records were fitted before.
#[derive(Debug, Clone, Default)]
pub(crate) struct Begun {
    /// The sum of squares at each; infinite where the model cannot be run.
    looks: Vec<(Point, f64)>,
    /// Where one round leads from each.
    led: Vec<(Point, Option<Reached>)>,
}

impl Task<'_> {
    /// So many of several points, those with the least sums of squares first; none that comes to the same as one of others: what
    /// is not felt there has no slope.
    pub(crate) fn nearest<'p>(
        &self,
        points: &'p [Point],
        others: &[Point],
        count: usize,
        begun: &mut Begun,
    ) -> impl Iterator<Item = &'p Point> + use<'p> {
        let known = self.looked_at(others, begun);
        let looks = self.looked_at(points, begun);
        let is_new = |index: &usize| looks[*index].is_finite() && !known.contains(&looks[*index]);
        let mut order: Vec<usize> = (0..points.len()).filter(is_new).collect();
        order.sort_by(|a, b| looks[*a].total_cmp(&looks[*b]));
        order.into_iter().take(count).map(|index| &points[index])
    }

    /// The sums of squares at several points.
    fn looked_at(&self, points: &[Point], begun: &mut Begun) -> Vec<f64> {
        let is_new = |point: &&Point| found(&begun.looks, point).is_none();
        let new: Vec<Point> = points.iter().filter(is_new).cloned().collect();
        let looks = self.look(&new);
        begun.looks.extend(new.into_iter().zip(looks));
        points.iter().filter_map(|point| found(&begun.looks, point)).collect()
    }

    /// Where fits from several points come to in one round, those left out from which the model cannot be run.
    pub(crate) fn led<'p>(&self, points: impl Iterator<Item = &'p Point>, begun: &mut Begun) -> Vec<Reached> {
        let once = Task { most_rounds: 1, ..*self };
        let mut led = Vec::new();
        for point in points {
            let reached = found(&begun.led, point).unwrap_or_else(|| {
                let reached = once.reached(point);
                begun.led.push((point.clone(), reached.clone()));
                reached
            });
            led.extend(reached);
        }
        led
    }
}

/// What stands behind a point.
fn found<T: Clone>(all: &[(Point, T)], point: &Point) -> Option<T> {
    all.iter().find(|(own, _)| own == point).map(|(_, known)| known.clone())
}

/// What is known of points from which records were fitted: whole, in pieces, and a few of many.
#[derive(Debug, Clone, Default)]
pub(crate) struct Seen {
    pub(crate) whole: Begun,
    pub(crate) pieces: Begun,
    pub(crate) few: Begun,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Experiment;
    use crate::fit::base_fit::fit_base;
    use crate::fit::problem::Problem;

    #[test]
    fn what_was_found_before_is_not_found_again() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hidden/nothing/experiment.json");
        let experiment = Experiment::read(path.as_ref()).unwrap_or_else(|error| panic!("{error}"));
        let problem = Problem::of(&experiment).unwrap();
        let stage = fit_base(&problem, &experiment.patch, &experiment.fit, 1).unwrap().unwrap();
        let model = problem.model(&stage.version, &problem.train, &problem.outputs).unwrap();
        let (task, home) = (problem.task(&model, &problem.train, true), &stage.train.point);
        let moved = Point { knobs: home.knobs.iter().map(|knob| 1.01 * knob).collect(), ..home.clone() };
        let points = [home.clone(), moved];
        let told = Reached { point: home.clone(), chi2: -1.0, has_ended: true };
        let mut begun = Begun { looks: vec![(home.clone(), -2.0)], led: vec![(home.clone(), Some(told))] };
        for _ in 0..2 {
            let looks = task.looked_at(&points, &mut begun);
            assert_eq!(looks, [-2.0, task.look(&points)[1]]);
            let led = task.led(points.iter(), &mut begun);
            let own = Task { most_rounds: 1, ..task }.reached(&points[1]).unwrap();
            assert_eq!([led[0].chi2, led[1].chi2], [-1.0, own.chi2]);
            assert!(own.chi2 < looks[1]);
            assert_eq!((begun.looks.len(), begun.led.len()), (2, 2));
        }
    }
}
