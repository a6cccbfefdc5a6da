//! Cords that hang from jack to jack, past the texts and jacks of the panel.

use std::collections::BTreeMap;

use super::Cord;
use crate::plot::{Area, Ink, Stroke};
use crate::schematic::layout::Point;

/// Thickness of a cord and of the gap that sets it off from those behind it.
const CORD: f64 = 2.4;
const GAP: f64 = 4.6;

/// Radius of a plug.
const PLUG: f64 = 4.4;

/// How far a cord sags in its middle: so much, and so much of its length.
const SAG: (f64, f64) = (14.0, 0.13);

/// How far a cord may be pushed aside at a third and at two thirds of it: across and down, in shares of its reach.
const ASIDE: ([f64; 9], [f64; 7]) =
    ([0.0, -0.3, 0.3, -0.6, 0.6, -1.0, 1.0, -1.6, 1.6], [0.0, -0.3, 0.3, -0.6, 0.6, -1.0, 1.0]);
const REACH: (f64, f64) = (20.0, 0.4);

/// What a pixel of the way costs: over a text, over a jack, over another cord, on the free panel, beyond its edge; and a
/// pixel that the cord is pushed aside.
const TEXT: f32 = 60.0;
const JACK: f32 = 6.0;
const OTHER: f32 = 0.5;
const FREE: f32 = 0.1;
const BEYOND: f32 = 12.0;
const PUSHED: f32 = 0.1;

/// Distance of the points at which a way is looked at and of those that are drawn, and side of the panel's cells.
const STEP: f64 = 4.0;
const DRAWN: f64 = 8.0;
const CELL: f64 = 2.0;

/// What a cord would lie on, cell by cell.
pub(super) struct Floor {
    across: usize,
    costs: Vec<f32>,
}

impl Floor {
    /// A panel with texts and jacks.
    pub fn new((width, height): (f64, f64), marks: &[Stroke]) -> Floor {
        let [across, down] = [width, height].map(|side| (side / CELL).ceil() as usize);
        let mut floor = Floor { across, costs: vec![FREE; across * down] };
        for mark in marks {
            match mark {
                Stroke::Text(label) => floor.cover(&label.area(), TEXT),
                Stroke::Ring { centre: (x, y), radius: r, .. } => {
                    floor.cover(&Area { left: x - r, top: y - r, right: x + r, bottom: y + r }, JACK);
                }
                _ => (),
            }
        }
        floor
    }

    /// Makes an area and the room of half a cord around it cost more.
    fn cover(&mut self, area: &Area, cost: f32) {
        let (left, right) = (area.left - CORD / 2.0, area.right + CORD / 2.0);
        let rows = ((area.bottom - area.top + CORD) / CELL).ceil() as usize;
        for row in 0..=rows {
            let y = area.top - CORD / 2.0 + CELL * row as f64;
            let ends = (self.cell((left, y)), self.cell((right, y)));
            if let (Some(first), Some(last)) = ends {
                self.costs[first..=last].iter_mut().for_each(|cell| *cell = cell.max(cost));
            }
        }
    }

    fn cell(&self, (x, y): Point) -> Option<usize> {
        let [column, row] = [x, y].map(|length| (length / CELL).floor());
        let is_inside = column >= 0.0 && row >= 0.0 && column < self.across as f64;
        let cell = row as usize * self.across + column as usize;
        (is_inside && cell < self.costs.len()).then_some(cell)
    }

    /// What a way costs, as far as that is less than `most`.
    fn cost(&self, mut way: impl Iterator<Item = Point>, pushed: f64, most: f32) -> Option<f32> {
        way.try_fold(PUSHED * pushed as f32, |cost, at| {
            let cell = self.cell(at).map_or(BEYOND, |cell| self.costs[cell]);
            Some(cost + cell * STEP as f32).filter(|cost| *cost < most)
        })
    }

    /// Hangs a cord where it hides least, and keeps its place from the next ones.
    pub fn hang(&mut self, ends: [Point; 2]) -> Vec<Point> {
        let curve = self.best(ends);
        for cell in curve.points(STEP).filter_map(|at| self.cell(at)).collect::<Vec<_>>() {
            self.costs[cell] += OTHER;
        }
        curve.points(DRAWN).collect()
    }

    fn best(&self, ends: [Point; 2]) -> Curve {
        let natural = Curve::natural(ends);
        let mut best = (f32::INFINITY, natural);
        for (half, pushed) in natural.pushed(0) {
            for (curve, more) in half.pushed(1) {
                if let Some(cost) = self.cost(curve.points(STEP), pushed + more, best.0) {
                    best = (cost, curve);
                }
            }
        }
        best.1
    }
}

/// A cubic from plug to plug, by its two points between.
#[derive(Clone, Copy)]
struct Curve {
    ends: [Point; 2],
    between: [Point; 2],
    length: f64,
}

impl Curve {
    /// The cord as it hangs when nothing is in its way.
    fn natural(ends: [Point; 2]) -> Curve {
        let [from, to] = ends;
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let sag = (SAG.0 + SAG.1 * length) * 4.0 / 3.0;
        let third = |share: f64| (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1) + sag);
        Curve { ends, between: [third(1.0 / 3.0), third(2.0 / 3.0)], length }
    }

    /// The curves with one of the points between in other places, each with how far that is.
    fn pushed(self, which: usize) -> impl Iterator<Item = (Curve, f64)> {
        let reach = REACH.0 + REACH.1 * self.length;
        let shares = ASIDE.0.iter().flat_map(|across| ASIDE.1.iter().map(move |down| (across, down)));
        shares.map(move |(across, down)| {
            let (x, y) = (across * reach, down * reach);
            let mut curve = self;
            curve.between[which] = (self.between[which].0 + x, self.between[which].1 + y);
            (curve, x.hypot(y))
        })
    }

    /// Points on the curve, at most so far apart.
    fn points(self, step: f64) -> impl Iterator<Item = Point> {
        let ([from, to], [first, second]) = (self.ends, self.between);
        let hull = [from, first, second, to];
        let length: f64 =
            hull.windows(2).map(|pair| (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1)).sum();
        let pieces = (length / step).ceil().max(8.0) as u32;
        (0..=pieces).map(move |piece| {
            let share = f64::from(piece) / f64::from(pieces);
            let rest = 1.0 - share;
            let weights = [
                rest * rest * rest,
                3.0 * rest * rest * share,
                3.0 * rest * share * share,
                share * share * share,
            ];
            let sum = |pick: fn(&Point) -> f64| {
                weights.iter().zip(&hull).map(|(weight, at)| weight * pick(at)).sum()
            };
            (sum(|at| at.0), sum(|at| at.1))
        })
    }
}

/// Side of the cells in which cords count as near each other, and how much more than their ways their ends count.
const NEAR: f64 = 32.0;
const ENDS: f64 = 100.0;

/// Colours cords: those from one output alike, and those near each other differently, the longest first.
pub(super) fn colour(cords: &mut [Cord]) {
    let mut outputs: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (index, cord) in cords.iter().enumerate() {
        outputs.entry(cord.from.clone()).or_default().push(index);
    }
    let mut outputs: Vec<_> = outputs.into_values().map(|own| (room(cords, &own), own)).collect();
    outputs.sort_by_key(|(room, own)| (std::cmp::Reverse(room.len()), own[0]));
    let mut taken: BTreeMap<(i64, i64), [f64; Ink::CORDS]> = BTreeMap::new();
    let mut used = [0; Ink::CORDS];
    for (room, own) in outputs {
        let conflict = |colour: usize| -> f64 {
            room.iter().filter_map(|(cell, weight)| Some(weight * taken.get(cell)?[colour])).sum()
        };
        let colour = (0..Ink::CORDS)
            .min_by(|one, other| {
                conflict(*one).total_cmp(&conflict(*other)).then(used[*one].cmp(&used[*other]))
            })
            .unwrap_or_default();
        used[colour] += 1;
        room.iter().for_each(|(cell, weight)| taken.entry(*cell).or_default()[colour] += weight);
        own.iter().for_each(|index| cords[*index].colour = colour);
    }
}

/// The cells on and beside the cords of an output, each with how much it counts.
fn room(cords: &[Cord], own: &[usize]) -> BTreeMap<(i64, i64), f64> {
    let mut room: BTreeMap<(i64, i64), f64> = BTreeMap::new();
    for cord in own.iter().map(|index| &cords[*index]) {
        let way = cord.points.iter().map(|at| (at, 1.0)).chain(cord.ends.iter().map(|at| (at, ENDS)));
        for ((x, y), weight) in way {
            for (across, down) in [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)] {
                let cell = ((x / NEAR + across).floor() as i64, (y / NEAR + down).floor() as i64);
                let held = room.entry(cell).or_default();
                *held = held.max(weight);
            }
        }
    }
    room
}

/// Draws a cord with its plugs.
pub(super) fn draw(cord: &Cord, marks: &mut Vec<Stroke>) {
    let ink = Ink::Cord(cord.colour);
    marks.push(Stroke::Line { points: cord.points.clone(), width: GAP, ink: Ink::Page });
    marks.push(Stroke::Line { points: cord.points.clone(), width: CORD, ink });
    for centre in cord.ends {
        marks.push(Stroke::Disc { centre, radius: PLUG, ink });
    }
}
