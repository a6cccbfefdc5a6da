//! Blocks of steps of native code, and their test afterwards.
//!
//! Native code takes a block of steps without any comparison. It writes the tested voltages of every step into a row.
//! Afterwards the rows are tested in vector registers: the steps before the first hit are accepted, with the extremes
//! of their voltages. The rest of the block is discarded.
//!
//! A row has, in this order: voltages at the end of the step, voltages at its first stage, what is computed of the
//! followed voltages, padding to a whole vector, rates, sampled values, and the values of the tables of time. Native code writes all of them except the last, which it
//! reads.

mod survey;

use std::collections::HashMap;
use std::ops::Range;

use super::code::Slot;
use super::frame::{Extremes, Frame};
use super::lane::{Lane, Lanes, dispatch};
use super::{Checks, Kernel, SafeInterval, Steps};
use survey::{Search, Survey};

/// Number of values that are tested together.
const VECTOR_LENGTH: usize = 16;
/// A part of a row that is tested at once.
type Vector = Lanes<VECTOR_LENGTH>;

/// Number of steps in the first block after a hit. Every following block has twice as many.
const MIN_BLOCK: u64 = 16;
/// Maximum number of steps in a block. Longer ones would be discarded too often.
const MAX_BLOCK: u64 = 64;
/// Maximum number of values in the rows of a block. They take 32 kB, which fit into the processor's first cache.
const MAX_ROW_NUMBERS: usize = 4096;

/// The columns of a row, and what each contains.
#[derive(Debug, Clone)]
pub(super) struct RowLayout {
    /// Slots whose values at the end of a step are written: the voltages with safe intervals, and the tracked ones.
    pub ends: Vec<Slot>,
    /// Slots whose values at the first stage are written, in the columns after `ends`.
    pub firsts: Vec<Slot>,
    /// The columns of the followed voltages. Those that have no interval are tested to be at least 0.
    pub followed: Range<usize>,
    /// Columns with a safe interval, and the index of the interval.
    safe_intervals: Vec<(usize, usize)>,
    /// The first of the followed columns that has no interval.
    turning: usize,
    /// The safe interval of time, if there is one. The ends of steps are known without rows.
    of_time: Option<usize>,
    /// The columns of the states, in their order.
    pub states: Vec<usize>,
    /// The columns of the tracked voltages, in the order of the kernel.
    tracked: Vec<usize>,
    /// The first column of the rates. Columns before it are tested.
    pub rates: usize,
    /// The first column of the sampled values.
    pub sampled: usize,
    /// The first column of the tables of time: first all in the middle of the step, then all at its end.
    pub scheduled: usize,
    /// The slots of the sampled values.
    sampled_slots: Range<usize>,
    /// Number of values in a row: a multiple of the vector length.
    pub width: usize,
}

/// The rows of a block, with the bounds of every column.
#[derive(Debug, Default)]
pub(super) struct Rows {
    /// The rows. The first one is the beginning of the block.
    numbers: Vec<Vector>,
    /// Lower bound of every tested column.
    lows: Vec<Vector>,
    /// Upper bound of every tested column.
    highs: Vec<Vector>,
    /// Whether the bounds are those of the frame's present safe intervals.
    are_intervals_current: bool,
    /// The least value of every tested column in the last test.
    least: Vec<Vector>,
    /// The largest value of every tested column in the last test.
    most: Vec<Vector>,
    /// Number of steps that the next block may have.
    next: u64,
}

/// A clone has no rows. They are not needed from one block to the next, and a frame allocates them when it needs them.
impl Clone for Rows {
    fn clone(&self) -> Self {
        Rows::default()
    }
}

impl RowLayout {
    /// The layout for a kernel. States and tracked voltages get a column even if no interval tests them.
    pub(super) fn of(kernel: &Kernel) -> Self {
        let Checks { within, all, .. } = kernel.quick;
        let is_time = |interval: &SafeInterval| interval.slot as usize == kernel.layout.time;
        let intervals =
            |range: Range<usize>| range.filter(|interval| !is_time(&kernel.safe_intervals[*interval]));
        let slots = |range: Range<usize>| {
            intervals(range).map(|interval| kernel.safe_intervals[interval].slot).collect::<Vec<Slot>>()
        };
        let mut ends = slots(0..all);
        let firsts = slots(0..kernel.first_intervals);
        let mut columns: HashMap<Slot, usize> = ends.iter().copied().zip(0..).collect();
        // The column for the value of a slot at the end of a step, added if there is none.
        let mut column_of = |slot: Slot| {
            *columns.entry(slot).or_insert_with(|| {
                ends.push(slot);
                ends.len() - 1
            })
        };
        let states = kernel.layout.states..kernel.layout.time;
        let states = states.map(|slot| column_of(slot as Slot)).collect();
        let tracked = kernel.tracked.iter().map(|slot| column_of(*slot)).collect();
        let first_followed = ends.len() + firsts.len();
        let followed = first_followed..first_followed + kernel.followed.len();
        let rates = followed.end.next_multiple_of(VECTOR_LENGTH);
        let sampled = rates + kernel.rates.len();
        let sampled_slots = kernel.layout.sampled..kernel.layout.levels;
        let scheduled = sampled + sampled_slots.len();
        RowLayout {
            safe_intervals: (0..)
                .zip(intervals(0..all))
                .chain((ends.len()..).zip(intervals(0..kernel.first_intervals)))
                .chain(followed.clone().zip(kernel.first_intervals..within))
                .collect(),
            turning: followed.start + kernel.curved_intervals,
            of_time: kernel.safe_intervals.iter().position(is_time),
            // Even a kernel without columns needs one row.
            width: (scheduled + 2 * kernel.scheduled.len()).max(1).next_multiple_of(VECTOR_LENGTH),
            ends,
            firsts,
            followed,
            states,
            tracked,
            rates,
            sampled,
            scheduled,
            sampled_slots,
        }
    }

    /// Maximum number of steps in a block of this kernel.
    fn max_steps(&self) -> u64 {
        ((MAX_ROW_NUMBERS / self.width) as u64).clamp(1, MAX_BLOCK)
    }

    /// The tracked voltages of a row.
    fn tracked_of(&self, row: &[Vector]) -> impl Iterator<Item = f64> {
        self.tracked.iter().map(|column| take(row, *column))
    }

    /// The number of vectors of a row that are tested; the first ones of all.
    fn checked_vectors(&self) -> usize {
        self.rates / VECTOR_LENGTH
    }
}

impl Rows {
    /// Allocates the rows of a kernel, unless they are there already.
    pub(super) fn allocate(&mut self, columns: &RowLayout) {
        if self.has_capacity(columns, columns.max_steps()) && self.lows.len() == columns.checked_vectors() {
            return;
        }
        let vectors = |count: usize, value: f64| vec![Vector::splat(value); count];
        let checked_vectors = columns.checked_vectors();
        *self = Rows {
            numbers: vectors(columns.width / VECTOR_LENGTH * (columns.max_steps() as usize + 1), 0.0),
            lows: vectors(checked_vectors, f64::NEG_INFINITY),
            highs: vectors(checked_vectors, f64::INFINITY),
            are_intervals_current: false,
            least: vectors(checked_vectors, 0.0),
            most: vectors(checked_vectors, 0.0),
            next: MIN_BLOCK,
        };
    }

    /// Whether there are rows for this many steps, in addition to the row of the beginning.
    pub(super) fn has_capacity(&self, columns: &RowLayout, steps: u64) -> bool {
        self.numbers.len() * VECTOR_LENGTH >= columns.width * (steps as usize + 1)
    }

    /// The address of the rows, for native code.
    pub(super) fn pointer(&mut self) -> *mut f64 {
        self.numbers.as_mut_ptr().cast()
    }

    /// Notes that the safe intervals of the frame have changed.
    pub(super) fn invalidate_safe_intervals(&mut self) {
        self.are_intervals_current = false;
    }

    /// Copies the bounds of the safe intervals to their columns. Other columns have infinite bounds, so only values
    /// that are not a number are out of bounds there.
    fn update_safe_intervals(&mut self, columns: &RowLayout, lows: &[f64], highs: &[f64]) {
        for (bounds, all) in [(&mut self.lows, lows), (&mut self.highs, highs)] {
            columns.safe_intervals.iter().for_each(|(column, interval)| put(bounds, *column, all[*interval]));
        }
        (columns.turning..columns.followed.end).for_each(|column| put(&mut self.lows, column, 0.0));
        self.are_intervals_current = true;
    }

    /// The number of steps in the next block, of `steps` that remain.
    pub(super) fn next_block(&self, columns: &RowLayout, steps: u64) -> u64 {
        self.next.min(columns.max_steps()).min(steps)
    }

    /// A row by its index: 0 is the beginning of the block, n the end of the nth step.
    fn row(&self, columns: &RowLayout, row: u64) -> &[Vector] {
        let width = columns.width / VECTOR_LENGTH;
        &self.numbers[row as usize * width..][..width]
    }

    /// The number of steps before the first hit. Afterwards `least` and `most` refer to these steps.
    ///
    /// All rows are first tested together. Only if one is out of bounds, it is searched for. The length of the next
    /// block doubles after a quiet block and is the smallest one after a hit.
    fn check(&mut self, columns: &RowLayout, steps: u64) -> u64 {
        if self.survey(columns, steps) {
            self.next = self.next.max(2 * steps).min(MAX_BLOCK);
            return steps;
        }
        self.next = MIN_BLOCK;
        let taken = dispatch(Search { columns, rows: self, steps });
        self.survey(columns, taken);
        taken
    }

    /// Finds the extremes of the columns in some rows. Returns whether all rows are within their bounds.
    fn survey(&mut self, columns: &RowLayout, steps: u64) -> bool {
        dispatch(Survey { columns, rows: self, steps })
    }
}

/// Writes a number into a column.
fn put(row: &mut [Vector], column: usize, number: f64) {
    row[column / VECTOR_LENGTH].set(column % VECTOR_LENGTH, number);
}

/// Reads the number of a column.
fn take(row: &[Vector], column: usize) -> f64 {
    row[column / VECTOR_LENGTH].get(column % VECTOR_LENGTH)
}

impl Frame<f64> {
    /// The same frame with rows, so that steps need not allocate any.
    pub(super) fn with_rows(mut self, columns: &RowLayout) -> Self {
        self.rows.allocate(columns);
        self
    }

    /// Writes the beginning of a block: states, rates and sampled values of the frame into the first row. It also
    /// updates the bounds if the safe intervals have changed.
    pub(super) fn write_start_row(&mut self, columns: &RowLayout) {
        let first = &mut self.rows.numbers;
        columns.states.iter().zip(&self.states).for_each(|(column, state)| put(first, *column, *state));
        (columns.rates..).zip(&self.rates).for_each(|(column, rate)| put(first, column, *rate));
        let sampled = &self.slots[columns.sampled_slots.clone()];
        (columns.sampled..).zip(sampled).for_each(|(column, sampled)| put(first, column, *sampled));
        if !self.rows.are_intervals_current {
            self.rows.update_safe_intervals(columns, &self.lows, &self.highs);
        }
    }

    /// Writes the values of the tables of time for the steps of a block, into the row of the end of each step.
    pub(super) fn write_scheduled_rows(
        &mut self,
        columns: &RowLayout,
        tables: &[Vec<[f64; 2]>],
        steps: &Steps,
    ) {
        if self.schedules.is_empty() {
            return;
        }
        let width = columns.width / VECTOR_LENGTH;
        let mut begin = self.time;
        for step in 0..steps.count {
            let end = steps.end_of(step);
            self.compute_scheduled_values(tables, [begin + 0.5 * (end - begin), end]);
            let row = &mut self.rows.numbers[width * (step as usize + 1)..][..width];
            (columns.scheduled..)
                .zip(&self.scheduled_values)
                .for_each(|(column, value)| put(row, column, *value));
            begin = end;
        }
    }

    /// The number of steps that end before time leaves its safe interval.
    fn steps_before_limit(&self, columns: &RowLayout, steps: &Steps) -> u64 {
        let Some(interval) = columns.of_time else { return steps.count };
        let is_beyond =
            |step: u64| !(self.lows[interval]..=self.highs[interval]).contains(&steps.end_of(step));
        // Time increases, so only the last step must be tested.
        if is_beyond(steps.count - 1) {
            (0..steps.count).find(|step| is_beyond(*step)).unwrap_or(steps.count)
        } else {
            steps.count
        }
    }

    /// Tests the rows of some steps and moves the frame to the last one before a hit. Returns the number of steps
    /// taken.
    pub(super) fn accept_rows(&mut self, columns: &RowLayout, steps: &Steps) -> u64 {
        let steps_before_limit = self.steps_before_limit(columns, steps);
        let taken = self.rows.check(columns, steps_before_limit);
        if taken == 0 {
            return 0;
        }
        self.observe_rows(columns, &Steps { count: taken, ..*steps });
        if self.trail.is_enabled {
            let (rows, trail) = (&self.rows, &mut self.trail.volts);
            (1..=taken).for_each(|row| trail.extend(columns.tracked_of(rows.row(columns, row))));
        }
        let last = self.rows.row(columns, taken);
        self.states.iter_mut().zip(&columns.states).for_each(|(state, column)| *state = take(last, *column));
        self.rates.iter_mut().zip(columns.rates..).for_each(|(rate, column)| *rate = take(last, column));
        let sampled = &mut self.slots[columns.sampled_slots.clone()];
        sampled.iter_mut().zip(columns.sampled..).for_each(|(sampled, column)| *sampled = take(last, column));
        self.time = steps.end_of(taken - 1);
        taken
    }

    /// Updates the extremes of the tracked voltages from accepted rows. The time of an extreme is the end of the first
    /// step that has it.
    fn observe_rows(&mut self, columns: &RowLayout, steps: &Steps) {
        let rows = &self.rows;
        let Extremes { least, least_at, most, most_at } = &mut self.extremes;
        for (index, column) in columns.tracked.iter().enumerate() {
            let first_of = |value: f64| {
                let mut all = 0..steps.count;
                let step = all.find(|step| take(rows.row(columns, step + 1), *column) == value);
                steps.end_of(step.expect("an extreme is in one of the rows"))
            };
            let [low, high] = [&rows.least, &rows.most].map(|all| take(all, *column));
            if low < least[index] {
                (least[index], least_at[index]) = (low, first_of(low));
            }
            if high > most[index] {
                (most[index], most_at[index]) = (high, first_of(high));
            }
        }
    }
}

#[cfg(test)]
mod tests;
