//! Quiet steps gone blindly, and judged afterwards.
//!
//! While native code makes a block of steps it compares nothing: what has to be looked at is written down, a row for each step.
//! Then the rows are looked at in vectors: how many steps, the first, met nothing, and what was seen in them. The others
//! are forgotten.

use std::ops::Range;

use pulp::{Arch, NullaryFnOnce};

use super::code::Slot;
use super::frame::{Extremes, Frame};
use super::lane::{Abreast, Lane};
use super::step::Steps;
use super::{Checks, Fence, Kernel};

/// So many numbers are looked at together.
const TOGETHER: usize = 16;
type Vector = Abreast<TOGETHER>;

/// After something was met so few steps are made blindly, and twice as many in every block after it.
const SHORTEST: u64 = 16;
/// Longer blocks would be thrown away too often.
const LONGEST: u64 = 64;
/// Nor do rows fill more than so many numbers, 32 kB, which are near the processor.
const ROOM: usize = 4096;

/// Where everything stands in a row.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    /// What is written down at the end of a step: the voltages at the fences, and those that are followed beside them. These
    /// are numbers as long as the states are.
    pub ends: Vec<Slot>,
    /// After these, what is written down in its middle: the voltages at the first fences.
    pub middles: Vec<Slot>,
    /// Columns of ends and middles, and the fence of each.
    fences: Vec<(usize, usize)>,
    /// The fence of time, if there is one. When a step ends is known without rows.
    of_time: Option<usize>,
    /// Where every state stands, and every voltage that is followed.
    pub states: Vec<usize>,
    followed: Vec<usize>,
    /// Where the rates begin, and the kept values.
    pub rates: usize,
    pub kept: usize,
    /// Where what tables of time give begins: all in the middle of the step, then all at its end.
    pub scheduled: usize,
    /// The slots of the kept values.
    kept_slots: Range<usize>,
    /// So many numbers has a row.
    pub width: usize,
}

/// The rows of a block, and between which numbers they must stay.
#[derive(Debug, Default)]
pub(super) struct Rows {
    /// The first row is where the block begins.
    numbers: Vec<Vector>,
    lows: Vec<Vector>,
    highs: Vec<Vector>,
    /// Whether the frame's fences stand in these.
    are_fenced: bool,
    /// The least and the largest of every column.
    least: Vec<Vector>,
    most: Vec<Vector>,
    /// So many steps may be made in the next block.
    next: u64,
}

// Nothing in them is needed from block to block.
impl Clone for Rows {
    fn clone(&self) -> Self {
        Rows::default()
    }
}

impl Columns {
    pub fn of(kernel: &Kernel) -> Self {
        let Checks { in_middle, all, .. } = kernel.quick;
        let is_time = |fence: &Fence| fence.slot as usize == kernel.layout.time;
        let fences = |count: usize| (0..count).filter(|fence| !is_time(&kernel.fences[*fence]));
        let slots = |count: usize| fences(count).map(|fence| kernel.fences[fence].slot).collect();
        let (mut ends, middles): (Vec<Slot>, Vec<Slot>) = (slots(all), slots(in_middle));
        let states = kernel.layout.states..kernel.layout.time;
        let states = states.map(|slot| column_of(slot as Slot, &mut ends)).collect();
        let followed = kernel.followed.iter().map(|slot| column_of(*slot, &mut ends)).collect();
        let rates = (ends.len() + middles.len()).next_multiple_of(TOGETHER);
        let kept = rates + kernel.rates.len();
        let kept_slots = kernel.layout.kept..kernel.layout.levels;
        let scheduled = kept + kept_slots.len();
        Columns {
            fences: (0..).zip(fences(all)).chain((ends.len()..).zip(fences(in_middle))).collect(),
            of_time: kernel.fences.iter().position(is_time),
            // A row stands there even of a kernel that has nothing to write down.
            width: (scheduled + 2 * kernel.scheduled.len()).max(1).next_multiple_of(TOGETHER),
            ends,
            middles,
            states,
            followed,
            rates,
            kept,
            scheduled,
            kept_slots,
        }
    }

    /// How many steps a block may have.
    fn most_steps(&self) -> u64 {
        ((ROOM / self.width) as u64).clamp(1, LONGEST)
    }

    /// The voltages that are followed, in a row.
    fn followed_of(&self, row: &[Vector]) -> impl Iterator<Item = f64> {
        self.followed.iter().map(|column| take(row, *column))
    }

    /// How many vectors of a row are looked at, the first.
    fn judged(&self) -> usize {
        self.rates / TOGETHER
    }
}

/// The column in which the voltage of a slot is written down at the end of a step.
fn column_of(slot: Slot, ends: &mut Vec<Slot>) -> usize {
    ends.iter().position(|known| *known == slot).unwrap_or_else(|| {
        ends.push(slot);
        ends.len() - 1
    })
}

impl Rows {
    /// Room for the rows of a kernel; nothing is done where it is there.
    pub fn make_room(&mut self, columns: &Columns) {
        if self.hold(columns, columns.most_steps()) && self.lows.len() == columns.judged() {
            return;
        }
        let vectors = |count: usize, value: f64| vec![Vector::splat(value); count];
        let judged = columns.judged();
        *self = Rows {
            numbers: vectors(columns.width / TOGETHER * (columns.most_steps() as usize + 1), 0.0),
            lows: vectors(judged, f64::NEG_INFINITY),
            highs: vectors(judged, f64::INFINITY),
            are_fenced: false,
            least: vectors(judged, 0.0),
            most: vectors(judged, 0.0),
            next: SHORTEST,
        };
    }

    /// Whether there is room for so many steps.
    pub fn hold(&self, columns: &Columns, steps: u64) -> bool {
        self.numbers.len() * TOGETHER >= columns.width * (steps as usize + 1)
    }

    /// Where the rows stand.
    pub fn pointer(&mut self) -> *mut f64 {
        self.numbers.as_mut_ptr().cast()
    }

    /// The fences are no longer where they were.
    pub fn forget_fences(&mut self) {
        self.are_fenced = false;
    }

    fn put_fences(&mut self, columns: &Columns, lows: &[f64], highs: &[f64]) {
        for (own, all) in [(&mut self.lows, lows), (&mut self.highs, highs)] {
            columns.fences.iter().for_each(|(column, fence)| put(own, *column, all[*fence]));
        }
        self.are_fenced = true;
    }

    /// How many of so many steps the next block takes.
    pub fn next_of(&self, columns: &Columns, steps: u64) -> u64 {
        self.next.min(columns.most_steps()).min(steps)
    }

    /// A row: that of a step after so many others, or 0 where the block begins.
    fn row(&self, columns: &Columns, row: u64) -> &[Vector] {
        let width = columns.width / TOGETHER;
        &self.numbers[row as usize * width..][..width]
    }

    /// How many steps, the first of some, stayed within all fences. What was seen in these is known then.
    fn judge(&mut self, columns: &Columns, steps: u64) -> u64 {
        if self.survey(columns, steps) {
            self.next = self.next.max(2 * steps).min(LONGEST);
            return steps;
        }
        self.next = SHORTEST;
        let gone = Arch::new().dispatch(Search { columns, rows: self, steps });
        self.survey(columns, gone);
        gone
    }

    fn survey(&mut self, columns: &Columns, steps: u64) -> bool {
        Arch::new().dispatch(Survey { columns, rows: self, steps })
    }
}

fn put(row: &mut [Vector], column: usize, number: f64) {
    row[column / TOGETHER].set(column % TOGETHER, number);
}

fn take(row: &[Vector], column: usize) -> f64 {
    row[column / TOGETHER].get(column % TOGETHER)
}

impl Frame<f64> {
    /// Room for blocks of steps, so that none has to be made while they are gone.
    pub(super) fn with_rows(mut self, columns: &Columns) -> Self {
        self.rows.make_room(columns);
        self
    }

    /// Writes down where a block begins.
    pub(super) fn begin_rows(&mut self, columns: &Columns) {
        let first = &mut self.rows.numbers;
        columns.states.iter().zip(&self.states).for_each(|(column, state)| put(first, *column, *state));
        (columns.rates..).zip(&self.rates).for_each(|(column, rate)| put(first, column, *rate));
        let kept = &self.slots[columns.kept_slots.clone()];
        (columns.kept..).zip(kept).for_each(|(column, kept)| put(first, column, *kept));
        if !self.rows.are_fenced {
            self.rows.put_fences(columns, &self.lows, &self.highs);
        }
    }

    /// Writes down what tables of time give in the steps of a block.
    pub(super) fn put_scheduled_rows(&mut self, columns: &Columns, tables: &[Vec<[f64; 2]>], steps: &Steps) {
        if self.schedules.is_empty() {
            return;
        }
        let width = columns.width / TOGETHER;
        let mut begin = self.time;
        for step in 0..steps.count {
            let end = steps.end_of(step);
            self.put_ahead(tables, [begin + 0.5 * (end - begin), end]);
            let row = &mut self.rows.numbers[width * (step as usize + 1)..][..width];
            (columns.scheduled..).zip(&self.ahead).for_each(|(column, value)| put(row, column, *value));
            begin = end;
        }
    }

    /// How many steps, the first of some, end before time is beyond its fence.
    fn timely(&self, columns: &Columns, steps: &Steps) -> u64 {
        let Some(fence) = columns.of_time else { return steps.count };
        let is_beyond = |step: u64| !(self.lows[fence]..=self.highs[fence]).contains(&steps.end_of(step));
        // It goes on from within the fence: where it is not beyond at last, it never was.
        if is_beyond(steps.count - 1) {
            (0..steps.count).find(|step| is_beyond(*step)).unwrap_or(steps.count)
        } else {
            steps.count
        }
    }

    /// Looks at the rows of some steps, and goes on to the last before something is met: how many were gone.
    pub(super) fn judge_rows(&mut self, columns: &Columns, steps: &Steps) -> u64 {
        let timely = self.timely(columns, steps);
        let gone = self.rows.judge(columns, timely);
        if gone == 0 {
            return 0;
        }
        self.see_rows(columns, &Steps { count: gone, ..*steps });
        if self.trail.is_kept {
            let (rows, trail) = (&self.rows, &mut self.trail.volts);
            (1..=gone).for_each(|row| trail.extend(columns.followed_of(rows.row(columns, row))));
        }
        let last = self.rows.row(columns, gone);
        self.states.iter_mut().zip(&columns.states).for_each(|(state, column)| *state = take(last, *column));
        self.rates.iter_mut().zip(columns.rates..).for_each(|(rate, column)| *rate = take(last, column));
        let kept = &mut self.slots[columns.kept_slots.clone()];
        kept.iter_mut().zip(columns.kept..).for_each(|(kept, column)| *kept = take(last, column));
        self.time = steps.end_of(gone - 1);
        gone
    }

    /// Sees the voltages that are followed in the rows of quiet steps.
    fn see_rows(&mut self, columns: &Columns, steps: &Steps) {
        let rows = &self.rows;
        let Extremes { least, least_at, most, most_at } = &mut self.extremes;
        for (index, column) in columns.followed.iter().enumerate() {
            let first_of = |value: f64| {
                let mut all = 0..steps.count;
                let step = all.find(|step| take(rows.row(columns, step + 1), *column) == value);
                steps.end_of(step.expect("an extreme stands in a row"))
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

/// Looks for the least and the largest of every column in the rows of some steps, and tells whether all stayed within their
/// fences.
struct Survey<'a> {
    columns: &'a Columns,
    rows: &'a mut Rows,
    steps: u64,
}

impl NullaryFnOnce for Survey<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let Survey { columns, rows: Rows { numbers, lows, highs, least, most, .. }, steps } = self;
        let width = columns.width / TOGETHER;
        let rows = &numbers[width..][..width * steps as usize];
        let mut is_quiet = true;
        for at in 0..columns.judged() {
            let [mut low, mut high, mut sum] = [f64::INFINITY, f64::NEG_INFINITY, 0.0].map(Vector::splat);
            for row in rows.chunks_exact(width) {
                let value = row[at];
                low = Vector::select_below(value, low, value, low);
                high = Vector::select_below(high, value, value, high);
                // What is no number does not get lost in a sum.
                sum = sum.add(value);
            }
            let [infinite, none] = [f64::INFINITY, f64::NAN].map(Vector::splat);
            let high_if_all_are = Vector::select_below(sum, infinite, high, none);
            is_quiet &= low.reaches(lows[at]) & highs[at].reaches(high_if_all_are);
            (least[at], most[at]) = (low, high);
        }
        is_quiet
    }
}

/// Tells how many steps, the first of some, stayed within all fences.
struct Search<'a> {
    columns: &'a Columns,
    rows: &'a Rows,
    steps: u64,
}

impl NullaryFnOnce for Search<'_> {
    type Output = u64;

    #[inline(always)]
    fn call(self) -> u64 {
        let Search { columns, rows, steps } = self;
        for step in 0..steps {
            let mut fenced = Vector::TRUE;
            let judged = rows.row(columns, step + 1)[..columns.judged()].iter();
            for ((value, low), high) in judged.zip(&rows.lows).zip(&rows.highs) {
                fenced = value.lies_between(*low, *high, fenced);
            }
            if !fenced.reaches(Vector::TRUE) {
                return step;
            }
        }
        steps
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A fenced voltage, which is looked at in the middle of a step too, and one that is followed.
    fn columns() -> Columns {
        Columns {
            ends: vec![0, 1],
            middles: vec![0],
            fences: vec![(0, 0), (2, 0)],
            of_time: None,
            states: Vec::new(),
            followed: vec![1],
            rates: TOGETHER,
            kept: TOGETHER,
            scheduled: TOGETHER,
            kept_slots: 0..0,
            width: TOGETHER,
        }
    }

    fn number() -> impl Strategy<Value = f64> {
        let rare = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, 1.0f64.next_up(), 1e300];
        let common = [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 5e-324];
        prop_oneof![1 => prop::sample::select(rare.to_vec()), 60 => prop::sample::select(common.to_vec())]
    }

    /// Row by row: how many, the first, have their fenced voltages between -1 and 1 and hold numbers, and least and most of every
    /// column in these, the first of equal ones.
    fn one_by_one(rows: &[[f64; 3]]) -> (u64, [[f64; 2]; 3]) {
        let is_quiet = |[end, followed, middle]: &&[f64; 3]| {
            (-1.0..=1.0).contains(end) && (-1.0..=1.0).contains(middle) && !followed.is_nan()
        };
        let quiet = rows.iter().take_while(is_quiet);
        let mut extremes = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        let mut gone = 0;
        for row in quiet {
            gone += 1;
            for ([least, most], value) in extremes.iter_mut().zip(row) {
                *least = if value < least { *value } else { *least };
                *most = if value > most { *value } else { *most };
            }
        }
        (gone, extremes)
    }

    proptest! {
        #[test]
        fn rows_are_judged_as_one_by_one(rows in prop::collection::vec(prop::array::uniform3(number()), 1..60)) {
            let (columns, mut all) = (columns(), Rows::default());
            all.make_room(&columns);
            all.put_fences(&columns, &[-1.0], &[1.0]);
            for (place, row) in rows.iter().enumerate() {
                (0..).zip(row).for_each(|(column, value)| put(&mut all.numbers[place + 1..], column, *value));
            }
            let gone = all.judge(&columns, rows.len() as u64);
            let seen: Vec<_> = (0..3).map(|column| [take(&all.least, column), take(&all.most, column)]).collect();
            let (expected, extremes) = one_by_one(&rows);
            prop_assert_eq!(gone, expected);
            let bits = |all: &[[f64; 2]]| all.as_flattened().iter().map(|one| one.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&seen), bits(&extremes));
        }
    }
}
