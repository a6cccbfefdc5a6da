//! Routes cords over the panel, around its texts and jacks and next to each other.
//!
//! The panel is divided into square cells. Each cord takes the cheapest path between its plugs, found
//! with A* over cells and eight directions. A path costs its length, plus penalties for turns and for
//! cells with texts, jacks or other cords. All cords are routed several times, so that early cords also
//! avoid later ones. With many cords the estimate is weighted (Pohl 1970): the search is faster, and a path
//! costs at most the weight times the minimum. At the end the corners are rounded.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::{ReportProgress, corners};
use crate::plot::{Area, Primitive};
use crate::schematic::layout::Point;

/// The side of a cell in pixels.
const CELL: f64 = 6.0;

/// The cost of a pixel of path on the free panel.
const FREE_COST: f32 = 1.0;
/// The cost of a pixel over a text or a jack.
const COVERED_COST: f32 = 60.0;
/// The additional cost of a pixel on top of a parallel cord; half of it on top of an oblique one.
const OVERLAP_COST: f32 = 40.0;
/// The additional cost of a pixel next to a parallel cord.
const ADJACENT_COST: f32 = 2.0;
/// The additional cost of a pixel that crosses a cord at a right angle.
const CROSSING_COST: f32 = 0.5;

/// The cost of no turn, and of a turn by 45 and by 90 degrees.
const TURN_COSTS: [f32; 3] = [0.0, 10.0, 30.0];

/// The clearance around texts and jacks.
const CLEARANCE: f64 = 3.0;

/// The distance from a plug within which jacks are no obstacle.
const PLUG_RADIUS: f64 = 10.0;

/// The maximum distance of a path from the rectangle around its plugs. It limits the search.
const MAX_DETOUR: f64 = 180.0;

/// The effort for a panel, by its number of cords and links. The first row that fits applies.
const EFFORTS: [Effort; 3] = [
    Effort { max_cords: 80, rounds: 3, weight: 1.0 },
    Effort { max_cords: 200, rounds: 1, weight: 1.0 },
    Effort { max_cords: usize::MAX, rounds: 1, weight: 2.0 },
];

/// How thoroughly the cords of a panel are routed.
#[derive(Debug, Clone, Copy)]
struct Effort {
    /// The maximum number of cords and links for which this effort applies.
    max_cords: usize,
    /// The number of rounds in which all cords are routed.
    rounds: usize,
    /// The factor of the estimate of the remaining cost; with 1 every path is the cheapest.
    weight: f32,
}

/// Returns the effort for a number of cords and links.
fn effort(count: usize) -> Effort {
    EFFORTS.into_iter().find(|effort| count <= effort.max_cords).unwrap_or(EFFORTS[2])
}

/// The directions of a path in steps of 45 degrees, as cells (right, down).
const DIRECTIONS: [(i32, i32); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// The content of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
enum CellContent {
    /// Nothing but cords.
    Free,
    /// A text, which cords avoid.
    Text,
    /// A jack, which only its own cord may cover.
    Jack,
}

/// The cells of a panel with texts, jacks and cords.
pub(super) struct PanelGrid {
    /// The number of columns of cells.
    columns: i32,
    /// The number of rows of cells.
    rows: i32,
    /// The content of each cell, row by row from the top down.
    contents: Vec<CellContent>,
    /// For each cell, the cords through it, each with its direction there.
    cords: Vec<Vec<(usize, usize)>>,
}

/// A cell and the direction in which it was entered: 8 times the cell plus the direction.
type State = usize;

/// A state to be expanded. The heap returns the one with the lowest estimate first.
struct Candidate {
    /// The cost so far plus a lower bound of the remaining cost.
    estimate: f32,
    /// The cell and the direction that this candidate reaches.
    state: State,
}

impl PanelGrid {
    /// Returns a grid with the texts (labels) and jacks (rings) of a drawing, without cords.
    pub(super) fn new((width, height): (f64, f64), primitives: &[Primitive]) -> PanelGrid {
        let [columns, rows] = [width, height].map(|length| (length / CELL).ceil() as i32);
        let cells = (columns * rows) as usize;
        let mut grid = PanelGrid {
            columns,
            rows,
            contents: vec![CellContent::Free; cells],
            cords: vec![Vec::new(); cells],
        };
        for primitive in primitives {
            match primitive {
                Primitive::Text(label) => grid.cover(&label.area(), CellContent::Text),
                Primitive::Ring { centre, radius, .. } => {
                    grid.cover(&Area::around(*centre, *radius), CellContent::Jack);
                }
                _ => (),
            }
        }
        grid
    }

    /// Marks the cells whose centres are within an area or its clearance.
    fn cover(&mut self, area: &Area, content: CellContent) {
        let first = cell_of((area.left - CLEARANCE, area.top - CLEARANCE));
        let last = cell_of((area.right + CLEARANCE, area.bottom + CLEARANCE));
        for row in first.1..=last.1 {
            for column in first.0..=last.0 {
                let (x, y) = centre((column, row));
                let is_covered = x > area.left - CLEARANCE
                    && x < area.right + CLEARANCE
                    && y > area.top - CLEARANCE
                    && y < area.bottom + CLEARANCE;
                if let Some(cell) = self.index((column, row)).filter(|_| is_covered) {
                    self.contents[cell] = content;
                }
            }
        }
    }

    /// Returns the number of a cell at a column and row; `None` outside the panel.
    fn index(&self, (column, row): (i32, i32)) -> Option<usize> {
        let is_inside = (0..self.columns).contains(&column) && (0..self.rows).contains(&row);
        is_inside.then_some((row * self.columns + column) as usize)
    }

    /// Returns the column and row of a cell.
    fn position_of(&self, cell: usize) -> (i32, i32) {
        (cell as i32 % self.columns, cell as i32 / self.columns)
    }

    /// Routes cords between their plugs and returns the points of each path. `progress` receives the number of routed
    /// cords and the number of all, with each cord once per round.
    pub(super) fn route(&mut self, ends: &[[Point; 2]], progress: ReportProgress<'_>) -> Vec<Vec<Point>> {
        let effort = effort(ends.len());
        let all = effort.rounds * ends.len();
        let mut paths: Vec<Vec<State>> = vec![Vec::new(); ends.len()];
        let mut search = Search::new(self.contents.len(), effort.weight);
        for round in 0..effort.rounds {
            for (cord, plugs) in ends.iter().enumerate() {
                progress(round * ends.len() + cord, all);
                let remove = |state: &State| self.cords[state / 8].retain(|(other, _)| *other != cord);
                paths[cord].iter().for_each(remove);
                paths[cord] = search.cheapest(self, *plugs);
                paths[cord].iter().for_each(|state| self.cords[state / 8].push((cord, state % 8)));
            }
        }
        paths.iter().zip(ends).map(|(path, ends)| self.rounded(path, *ends)).collect()
    }

    /// Returns the cost per pixel of entering a cell in a direction.
    fn cost(&self, cell: usize, direction: usize, [from, to]: [Point; 2]) -> f32 {
        let at = centre(self.position_of(cell));
        let is_plug = distance(at, from) < PLUG_RADIUS || distance(at, to) < PLUG_RADIUS;
        let content = match self.contents[cell] {
            CellContent::Free => FREE_COST,
            CellContent::Jack if is_plug => FREE_COST,
            CellContent::Jack | CellContent::Text => COVERED_COST,
        };
        let on_top = self.cords[cell].iter().map(|(_, other)| match direction.abs_diff(*other) % 4 {
            0 => OVERLAP_COST,
            1 | 3 => OVERLAP_COST / 2.0,
            _ => CROSSING_COST,
        });
        let (column, row) = self.position_of(cell);
        let neighbours = [0, 2, 4, 6].into_iter().filter(|neighbour| neighbour % 4 != direction % 4);
        let neighbours = neighbours.filter_map(|neighbour| {
            self.index((column + DIRECTIONS[neighbour].0, row + DIRECTIONS[neighbour].1))
        });
        let adjacent = neighbours.flat_map(|neighbour| &self.cords[neighbour]);
        let parallel = adjacent.filter(|(_, other)| direction.abs_diff(*other) % 4 == 0).count();
        content + on_top.fold(0.0, f32::max) + if parallel > 0 { ADJACENT_COST } else { 0.0 }
    }

    /// Returns the points of a path from plug to plug with rounded corners.
    fn rounded(&self, path: &[State], [from, to]: [Point; 2]) -> Vec<Point> {
        let mut corners = vec![from];
        let turns = path.get(1..).unwrap_or_default().windows(2).filter(|pair| pair[0] % 8 != pair[1] % 8);
        corners.extend(turns.map(|pair| centre(self.position_of(pair[0] / 8))));
        corners.push(to);
        corners::rounded(corners)
    }
}

/// The search for the cheapest path (A*, Hart, Nilsson and Raphael 1968).
struct Search {
    /// For each state, the cost of the best path found so far.
    costs: Vec<f32>,
    /// For each state, the number of the search that found that path. Other entries are out of date.
    found_in: Vec<u32>,
    /// For each state, the state before it on that path.
    before: Vec<u32>,
    /// The number of the current search.
    number: u32,
    /// The factor of the estimate of the remaining cost.
    weight: f32,
}

impl Search {
    /// Returns a search for a panel with this number of cells. It serves all cords, so its lists are allocated once.
    fn new(cells: usize, weight: f32) -> Search {
        let states = 8 * cells;
        let (costs, found_in, before) = (vec![0.0; states], vec![0; states], vec![0; states]);
        Search { costs, found_in, before, number: 0, weight }
    }

    /// Returns the cost of the best path to a state in the current search; infinite if there is none yet.
    fn cost_of(&self, state: State) -> f32 {
        if self.found_in[state] == self.number { self.costs[state] } else { f32::INFINITY }
    }

    /// Records a better path to a state.
    fn record(&mut self, state: State, cost: f32, before: State) {
        (self.costs[state], self.found_in[state], self.before[state]) = (cost, self.number, before as u32);
    }

    /// Returns the states of the cheapest path between two plugs; empty if there is none.
    ///
    /// The search may start in any direction. The estimate without its weight never exceeds the remaining cost. The
    /// first path that reaches the goal therefore costs at most the weight times the minimum.
    fn cheapest(&mut self, grid: &PanelGrid, ends: [Point; 2]) -> Vec<State> {
        self.number += 1;
        let [start, goal] = ends.map(cell_of);
        let (Some(first), Some(last)) = (grid.index(start), grid.index(goal)) else { return Vec::new() };
        let weight = self.weight * FREE_COST;
        let remaining = |cell: usize| weight * estimate(grid.position_of(cell), goal);
        let mut open: BinaryHeap<Candidate> = BinaryHeap::new();
        for direction in 0..8 {
            self.record(8 * first + direction, 0.0, 8 * first + direction);
            open.push(Candidate { estimate: remaining(first), state: 8 * first + direction });
        }
        while let Some(Candidate { estimate: queued, state }) = open.pop() {
            if state / 8 == last {
                return self.path_to(state);
            }
            let so_far = self.cost_of(state);
            if queued > so_far + remaining(state / 8) + 1e-3 {
                continue;
            }
            for (next, cost) in steps(grid, state, ends) {
                let cost = so_far + cost;
                if cost < self.cost_of(next) {
                    self.record(next, cost, state);
                    open.push(Candidate { estimate: cost + remaining(next / 8), state: next });
                }
            }
        }
        Vec::new()
    }

    /// Returns the states of the recorded path to a state, from the start.
    fn path_to(&self, mut state: State) -> Vec<State> {
        let mut path = vec![state];
        while self.before[state] as usize != state {
            state = self.before[state] as usize;
            path.push(state);
        }
        path.reverse();
        path
    }
}

/// Returns the states that can follow a state, each with its cost.
///
/// A path continues straight on or turns by 45 or 90 degrees. It never reverses.
fn steps(grid: &PanelGrid, state: State, ends: [Point; 2]) -> impl Iterator<Item = (State, f32)> {
    let (cell, direction) = (state / 8, state % 8);
    let (column, row) = grid.position_of(cell);
    [(0, 0), (1, 1), (7, 1), (2, 2), (6, 2)].into_iter().filter_map(move |(turn, sharpness)| {
        let direction = (direction + turn) % 8;
        let (x, y) = DIRECTIONS[direction];
        let next = grid.index((column + x, row + y)).filter(|next| is_near(grid.position_of(*next), ends))?;
        let length = (CELL * f64::from(x * x + y * y).sqrt()) as f32;
        let cost = length * grid.cost(next, direction, ends) + TURN_COSTS[sharpness];
        Some((8 * next + direction, cost))
    })
}

/// Whether a cell is within the maximum detour of two plugs.
fn is_near(cell: (i32, i32), [from, to]: [Point; 2]) -> bool {
    let (x, y) = centre(cell);
    let within =
        |at: f64, one: f64, other: f64| at > one.min(other) - MAX_DETOUR && at < one.max(other) + MAX_DETOUR;
    within(x, from.0, to.0) && within(y, from.1, to.1)
}

/// Returns the shortest length from one cell to another in eight directions, in pixels.
fn estimate((column, row): (i32, i32), goal: (i32, i32)) -> f32 {
    let (x, y) = (f64::from((column - goal.0).abs()), f64::from((row - goal.1).abs()));
    (CELL * (x.max(y) + (2.0f64.sqrt() - 1.0) * x.min(y))) as f32
}

/// Returns the column and row of the cell that contains a point.
fn cell_of((x, y): Point) -> (i32, i32) {
    ((x / CELL).floor() as i32, (y / CELL).floor() as i32)
}

/// Returns the centre of the cell at a column and row.
fn centre((column, row): (i32, i32)) -> Point {
    (CELL * (f64::from(column) + 0.5), CELL * (f64::from(row) + 0.5))
}

/// Returns the distance of two points in pixels.
fn distance(one: Point, other: Point) -> f64 {
    (one.0 - other.0).hypot(one.1 - other.1)
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        // The heap returns the largest first, so the order is reversed. The state decides among equal
        // estimates, so that the paths are reproducible.
        other.estimate.total_cmp(&self.estimate).then(other.state.cmp(&self.state))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}
