//! Ways for cords over the panel: past its texts and jacks, and beside each other.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::plot::{Area, Stroke};
use crate::schematic::layout::Point;

/// Side of the cells that a way goes through.
const CELL: f64 = 6.0;

/// What a pixel of a way costs: on the free panel, over a text or a jack, along another cord, beside one, across one.
const FREE: f32 = 1.0;
const COVERED: f32 = 60.0;
const ALONG: f32 = 40.0;
const BESIDE: f32 = 2.0;
const ACROSS: f32 = 0.5;

/// What a turn by an eighth and by a quarter of a circle costs.
const TURNS: [f32; 3] = [0.0, 10.0, 30.0];

/// Room that is kept around texts and jacks.
const CLEAR: f64 = 3.0;

/// Within this distance from a plug its own jack does not count.
const PLUG: f64 = 10.0;

/// A way stays this near to the rectangle around its plugs.
const REACH: f64 = 180.0;

/// So often all cords are laid anew, past where the others lie by now, where there are no more than so many.
const ROUNDS: [(usize, usize); 2] = [(80, 3), (usize::MAX, 1)];

/// So often the corners of a way are cut.
const CUTS: usize = 3;

/// The directions of a way, in eighths of a circle.
const DIRECTIONS: [(i32, i32); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// What a cell holds.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Ground {
    Free,
    Text,
    Jack,
}

/// A panel with texts, jacks and cords.
pub(super) struct Floor {
    across: i32,
    down: i32,
    grounds: Vec<Ground>,
    /// The cords that go through a cell, each with its direction there.
    lying: Vec<Vec<(usize, usize)>>,
}

/// A cell and the direction in which it was entered.
type Place = usize;

/// A place that may be gone on from; the best comes out of the heap first.
struct Open {
    estimate: f32,
    place: Place,
}

impl Floor {
    /// A panel with texts and jacks.
    pub fn new((width, height): (f64, f64), marks: &[Stroke]) -> Floor {
        let [across, down] = [width, height].map(|side| (side / CELL).ceil() as i32);
        let cells = (across * down) as usize;
        let mut floor =
            Floor { across, down, grounds: vec![Ground::Free; cells], lying: vec![Vec::new(); cells] };
        for mark in marks {
            match mark {
                Stroke::Text(label) => floor.cover(&label.area(), Ground::Text),
                Stroke::Ring { centre: (x, y), radius, .. } => {
                    let area =
                        Area { left: x - radius, top: y - radius, right: x + radius, bottom: y + radius };
                    floor.cover(&area, Ground::Jack);
                }
                _ => (),
            }
        }
        floor
    }

    /// Marks the cells whose middles lie on an area or near it.
    fn cover(&mut self, area: &Area, ground: Ground) {
        let first = cell_of((area.left - CLEAR, area.top - CLEAR));
        let last = cell_of((area.right + CLEAR, area.bottom + CLEAR));
        for row in first.1..=last.1 {
            for column in first.0..=last.0 {
                let (x, y) = middle((column, row));
                let is_on = x > area.left - CLEAR
                    && x < area.right + CLEAR
                    && y > area.top - CLEAR
                    && y < area.bottom + CLEAR;
                if let Some(cell) = self.index((column, row)).filter(|_| is_on) {
                    self.grounds[cell] = ground;
                }
            }
        }
    }

    fn index(&self, (column, row): (i32, i32)) -> Option<usize> {
        let is_inside = (0..self.across).contains(&column) && (0..self.down).contains(&row);
        is_inside.then_some((row * self.across + column) as usize)
    }

    fn place_of(&self, cell: usize) -> (i32, i32) {
        (cell as i32 % self.across, cell as i32 / self.across)
    }

    /// Lays cords, each where it hides least.
    pub fn lay(&mut self, ends: &[[Point; 2]]) -> Vec<Vec<Point>> {
        let rounds = ROUNDS.iter().find(|(most, _)| ends.len() <= *most).map_or(1, |(_, rounds)| *rounds);
        let mut ways: Vec<Vec<Place>> = vec![Vec::new(); ends.len()];
        let mut search = Search::new(self.grounds.len());
        for _ in 0..rounds {
            for (cord, ends) in ends.iter().enumerate() {
                ways[cord].iter().for_each(|place| self.lying[place / 8].retain(|(other, _)| *other != cord));
                ways[cord] = search.shortest(self, *ends);
                ways[cord].iter().for_each(|place| self.lying[place / 8].push((cord, place % 8)));
            }
        }
        ways.iter().zip(ends).map(|(way, ends)| self.drawn(way, *ends)).collect()
    }

    /// What it costs to enter a cell in a direction, for each pixel.
    fn cost(&self, cell: usize, direction: usize, [from, to]: [Point; 2]) -> f32 {
        let at = middle(self.place_of(cell));
        let is_plug = distance(at, from) < PLUG || distance(at, to) < PLUG;
        let ground = match self.grounds[cell] {
            Ground::Free => FREE,
            Ground::Jack if is_plug => FREE,
            Ground::Jack | Ground::Text => COVERED,
        };
        let under = self.lying[cell].iter().map(|(_, other)| match direction.abs_diff(*other) % 4 {
            0 => ALONG,
            1 | 3 => ALONG / 2.0,
            _ => ACROSS,
        });
        let (column, row) = self.place_of(cell);
        let sides = [0, 2, 4, 6].into_iter().filter(|side| side % 4 != direction % 4);
        let sides =
            sides.filter_map(|side| self.index((column + DIRECTIONS[side].0, row + DIRECTIONS[side].1)));
        let beside = sides.flat_map(|side| &self.lying[side]);
        let is_along = beside.filter(|(_, other)| direction.abs_diff(*other) % 4 == 0).count();
        ground + under.fold(0.0, f32::max) + if is_along > 0 { BESIDE } else { 0.0 }
    }

    /// A way from plug to plug with rounded corners.
    fn drawn(&self, way: &[Place], [from, to]: [Point; 2]) -> Vec<Point> {
        let mut corners = vec![from];
        let turns = way.get(1..).unwrap_or_default().windows(2).filter(|pair| pair[0] % 8 != pair[1] % 8);
        corners.extend(turns.map(|pair| middle(self.place_of(pair[0] / 8))));
        corners.push(to);
        (0..CUTS).fold(corners, |corners, _| cut(&corners))
    }
}

/// The shortest ways over a floor, by Dijkstra's method with an estimate of what is left (A*).
struct Search {
    /// What the best way found so far to a place costs, in which search it was found, and the place before.
    costs: Vec<f32>,
    found_in: Vec<u32>,
    before: Vec<u32>,
    number: u32,
}

impl Search {
    fn new(cells: usize) -> Search {
        let places = 8 * cells;
        Search { costs: vec![0.0; places], found_in: vec![0; places], before: vec![0; places], number: 0 }
    }

    fn cost_of(&self, place: Place) -> f32 {
        if self.found_in[place] == self.number { self.costs[place] } else { f32::INFINITY }
    }

    fn find(&mut self, place: Place, cost: f32, before: Place) {
        (self.costs[place], self.found_in[place], self.before[place]) = (cost, self.number, before as u32);
    }

    /// The places of the way between two plugs that costs least; none where there is none.
    fn shortest(&mut self, floor: &Floor, ends: [Point; 2]) -> Vec<Place> {
        self.number += 1;
        let [start, goal] = ends.map(cell_of);
        let (Some(first), Some(last)) = (floor.index(start), floor.index(goal)) else { return Vec::new() };
        let left = |cell: usize| FREE * estimate(floor.place_of(cell), goal);
        let mut open: BinaryHeap<Open> = BinaryHeap::new();
        for direction in 0..8 {
            self.find(8 * first + direction, 0.0, 8 * first + direction);
            open.push(Open { estimate: left(first), place: 8 * first + direction });
        }
        while let Some(Open { estimate: told, place }) = open.pop() {
            if place / 8 == last {
                return self.way_to(place);
            }
            let so_far = self.cost_of(place);
            if told > so_far + left(place / 8) + 1e-3 {
                continue;
            }
            for (next, cost) in steps(floor, place, ends) {
                let cost = so_far + cost;
                if cost < self.cost_of(next) {
                    self.find(next, cost, place);
                    open.push(Open { estimate: cost + left(next / 8), place: next });
                }
            }
        }
        Vec::new()
    }

    fn way_to(&self, mut place: Place) -> Vec<Place> {
        let mut way = vec![place];
        while self.before[place] as usize != place {
            place = self.before[place] as usize;
            way.push(place);
        }
        way.reverse();
        way
    }
}

/// The places that a way can go on to, each with what that costs.
fn steps(floor: &Floor, place: Place, ends: [Point; 2]) -> impl Iterator<Item = (Place, f32)> {
    let (cell, direction) = (place / 8, place % 8);
    let (column, row) = floor.place_of(cell);
    [(0, 0), (1, 1), (7, 1), (2, 2), (6, 2)].into_iter().filter_map(move |(turn, sharpness)| {
        let direction = (direction + turn) % 8;
        let (x, y) = DIRECTIONS[direction];
        let next = floor.index((column + x, row + y)).filter(|next| is_near(floor.place_of(*next), ends))?;
        let length = (CELL * f64::from(x * x + y * y).sqrt()) as f32;
        let cost = length * floor.cost(next, direction, ends) + TURNS[sharpness];
        Some((8 * next + direction, cost))
    })
}

/// Whether a cell lies within reach of the rectangle around two plugs.
fn is_near(cell: (i32, i32), [from, to]: [Point; 2]) -> bool {
    let (x, y) = middle(cell);
    let within = |at: f64, one: f64, other: f64| at > one.min(other) - REACH && at < one.max(other) + REACH;
    within(x, from.0, to.0) && within(y, from.1, to.1)
}

/// Pixels from one cell to another, eight directions being allowed.
fn estimate((column, row): (i32, i32), goal: (i32, i32)) -> f32 {
    let (x, y) = (f64::from((column - goal.0).abs()), f64::from((row - goal.1).abs()));
    (CELL * (x.max(y) + (2.0f64.sqrt() - 1.0) * x.min(y))) as f32
}

fn cell_of((x, y): Point) -> (i32, i32) {
    ((x / CELL).floor() as i32, (y / CELL).floor() as i32)
}

fn middle((column, row): (i32, i32)) -> Point {
    (CELL * (f64::from(column) + 0.5), CELL * (f64::from(row) + 0.5))
}

fn distance(one: Point, other: Point) -> f64 {
    (one.0 - other.0).hypot(one.1 - other.1)
}

/// How much of a piece is cut off at its corners, at most.
const CUT: f64 = 5.0;

/// The line with every corner cut off (Chaikin), so that it is rounder.
fn cut(points: &[Point]) -> Vec<Point> {
    let mut rounder = vec![points[0]];
    for (index, pair) in points.windows(2).enumerate() {
        let share = (CUT / distance(pair[0], pair[1]).max(1e-9)).min(0.25);
        let at = |share: f64| {
            (pair[0].0 + share * (pair[1].0 - pair[0].0), pair[0].1 + share * (pair[1].1 - pair[0].1))
        };
        if index > 0 {
            rounder.push(at(share));
        }
        if index + 2 < points.len() {
            rounder.push(at(1.0 - share));
        }
    }
    rounder.push(points[points.len() - 1]);
    rounder
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        // A heap gives the largest first; among equals the place decides, so that ways are always the same.
        other.estimate.total_cmp(&self.estimate).then(other.place.cmp(&self.place))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}
