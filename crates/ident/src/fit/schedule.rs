//! How much is done to fit a patch: from how many points, through which heats, and to how much of the records.

use crate::data::record::Record;
use crate::fit::estimate::{Point, Reached};
use crate::fit::levenberg_marquardt::{MOST_ROUNDS, Task};
use crate::fit::model::Model;
use crate::fit::start_cache::Begun;

/// How much is done to fit a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// So many of the points from which fits could begin are gone on from, those without any effect not counted,
    starts: usize,
    /// through heats one after the other.
    heats: &'static [Heat],
    /// How a few of many records are made use of, if they are.
    glance: Option<Glance>,
    /// Whether it is not the first look: what is held back is begun from every point, and fitted to the end, and many records are
    /// not begun from no strength again.
    pub(crate) is_thorough: bool,
}

/// Of many records a few go first:
#[derive(Debug, Clone, Copy, PartialEq)]
struct Glance {
    /// so many of the heats are theirs,
    heats: usize,
    /// and from where these come to, all records go through others.
    then: &'static [Heat],
}

/// A round of fits from several points, of which those that come furthest go on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Heat {
    /// So often the derivatives are worked out for each.
    rounds: usize,
    /// So many go on, beside those ahead of them that have ended.
    ahead: usize,
    /// The share of every record that is fitted, from its beginning.
    until: f64,
}

impl Heat {
    const fn new(rounds: usize, ahead: usize, until: f64) -> Heat {
        Heat { rounds, ahead, until }
    }
}

impl Effort {
    /// Enough to see whether more is worth while.
    pub const QUICK: Effort = Effort {
        starts: 1,
        heats: &[Heat::new(1, 1, 1.0), Heat::new(4, 1, 1.0)],
        glance: Some(Glance { heats: 2, then: &[Heat::new(1, 1, 1.0)] }),
        is_thorough: false,
    };
    /// Enough to be held against others.
    pub const FULL: Effort = Effort {
        starts: 4,
        heats: &[Heat::new(1, 3, 1.0), Heat::new(4, 2, 1.0), Heat::new(MOST_ROUNDS, 1, 1.0)],
        glance: Some(Glance { heats: 2, then: &[Heat::new(2, 1, 1.0), Heat::new(MOST_ROUNDS, 1, 1.0)] }),
        is_thorough: true,
    };
    /// Where motion swings or sticks: what is fitted to all of it at once keeps step with the wrong swing.
    pub const GROWING: Effort = Effort {
        starts: 4,
        heats: &[
            Heat::new(1, 4, 1.0),
            Heat::new(MOST_ROUNDS, 4, 0.35),
            Heat::new(MOST_ROUNDS, 4, 0.65),
            Heat::new(MOST_ROUNDS, 1, 1.0),
        ],
        glance: None,
        is_thorough: true,
    };
    /// Where it is not known how a record begins: the beginning first.
    pub(crate) const FROM_ANYWHERE: Effort = Effort {
        starts: 6,
        heats: &[
            Heat::new(4, 4, 0.1),
            Heat::new(MOST_ROUNDS, 3, 0.35),
            Heat::new(MOST_ROUNDS, 2, 0.65),
            Heat::new(MOST_ROUNDS, 1, 1.0),
        ],
        glance: None,
        is_thorough: true,
    };
}

/// A fit to a part of the records has ended when a round lowers the sum of squares by less than this share.
const NEARLY_SETTLED: f64 = 3e-4;

/// Points from which fits begin.
#[derive(Debug, Clone, Default)]
pub(crate) struct Starts {
    /// From each of them: without any effect, in all its shapes,
    pub sure: Vec<Point>,
    /// from where it came to before,
    pub found: Option<Point>,
    /// and from some of these, those that are nearest to the data.
    pub others: Vec<Point>,
}

impl Effort {
    /// What is done with a few of many records, and then with all; nothing where all are fitted from the beginning.
    pub(crate) fn split(self) -> Option<[Effort; 2]> {
        self.glance.map(|Glance { heats, then }| {
            let few = Effort { heats: &self.heats[..heats], ..self };
            [few, Effort { heats: then, ..self }].map(|own| Effort { glance: None, ..own })
        })
    }

    /// Where a task comes to from the best of several points.
    pub(crate) fn best(self, task: &Task<'_>, starts: &Starts, begun: &mut Begun) -> Option<Point> {
        self.ahead(task, starts, begun).into_iter().next()
    }

    /// Where a task comes to from the points that are ahead after the last heat, the best first; what is known of points from
    /// which it was begun before is kept in `begun`.
    pub(crate) fn ahead(self, task: &Task<'_>, starts: &Starts, begun: &mut Begun) -> Vec<Point> {
        let from = |point: Point| Reached { point, chi2: f64::INFINITY, has_ended: false };
        let first = self.heats.first().and_then(|heat| Beginnings::of(task, heat.until));
        let looked_at = first.as_ref().map_or(*task, |own| own.task(task));
        let sure = starts.sure.iter().chain(&starts.found);
        let nearest = looked_at.nearest(&starts.others, &starts.sure, self.starts, begun);
        let mut ahead: Vec<Reached> = sure.chain(nearest).cloned().map(from).collect();
        let mut seen = 1.0;
        for heat in self.heats {
            let beginnings = Beginnings::of(task, heat.until);
            let part = beginnings.as_ref().map_or(*task, |own| own.task(task));
            let part = Task { most_rounds: heat.rounds, ..part };
            let goes_on = |own: Reached| match own.has_ended && heat.until == seen {
                true => Some(own),
                false => part.reached(&own.point),
            };
            ahead = match heat.rounds == 1 {
                true => part.led(ahead.iter().map(|own| &own.point), begun),
                false => ahead.into_iter().filter_map(goes_on).collect(),
            };
            ahead.sort_by(|a, b| a.chi2.total_cmp(&b.chi2));
            // What has ended keeps nobody back: where an effect is not felt, as a stop that is not met, nothing moves.
            let mut places = heat.ahead;
            ahead.retain(|own| {
                let stays = places > 0;
                places -= usize::from(stays && !own.has_ended);
                stays
            });
            seen = heat.until;
        }
        ahead.into_iter().map(|own| own.point).collect()
    }
}

/// The beginnings of records, and a model that is run beside no more than these.
pub(crate) struct Beginnings {
    model: Model,
    records: Vec<Record>,
}

impl Beginnings {
    /// So large a share of what a task is fitted to; nothing where that is all.
    pub(crate) fn of(task: &Task<'_>, share: f64) -> Option<Beginnings> {
        (share < 1.0).then(|| {
            let records: Vec<Record> = task.records.iter().map(|record| record.beginning(share)).collect();
            Beginnings { model: task.model.beside(&records), records }
        })
    }

    /// The task of coming near to these.
    pub(crate) fn task<'b>(&'b self, whole: &Task<'b>) -> Task<'b> {
        let (model, records) = (&self.model, self.records.as_slice());
        Task { model, records, wanted: f64::INFINITY, settled: NEARLY_SETTLED, ..*whole }
    }
}
