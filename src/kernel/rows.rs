//! Quiet steps gone blindly, and judged afterwards.
//!
//! While a block of steps is made, nothing is compared: what has to be looked at is written down, a row for each step. Then
//! the rows are looked at in vectors: how many steps, the first, met nothing, and what was seen in them.

use pulp::{Arch, NullaryFnOnce};

use super::code::Slot;
use super::frame::{Extremes, Frame};
use super::lane::{Abreast, Lane};
use super::step::Steps;
use super::{Checks, Fence, Kernel};

/// So many numbers are looked at together.
const TOGETHER: usize = 16;
type Together = [f64; TOGETHER];
type Vector = Abreast<TOGETHER>;

/// After something was met so few steps are made blindly, and twice as many in every block after it.
const SHORTEST: u64 = 16;
/// No more than this.
const LONGEST: u64 = 64;
/// Nor more than fill so many numbers, which are near the processor.
const ROOM: usize = 4096;

/// Where everything stands in a row.
#[derive(Debug, Clone, Default)]
pub(super) struct Columns {
    /// What is written down at the end of a step: the voltages at the fences, and those that are followed beside them.
    pub ends: Vec<Slot>,
    /// After these, what is written down in its middle: the voltages at the first fences.
    pub middles: Vec<Slot>,
    /// Columns of these, and by which fence each is bound.
    fences: Vec<(usize, usize)>,
    /// The fence of time, if there is one. That is known without rows.
    of_time: Option<usize>,
    /// Where every state stands, and every voltage that is followed.
    pub states: Vec<usize>,
    followed: Vec<usize>,
    /// Where the rates begin, and the kept values.
    pub rates: usize,
    pub kept: usize,
    /// So many numbers has a row.
    pub width: usize,
}

/// The rows of a block, and between which numbers they must stay.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows {
    /// The first row tells where the block begins; a few numbers may stand before it.
    numbers: Vec<f64>,
    lows: Vec<Together>,
    highs: Vec<Together>,
    /// Whether these are those of the fences.
    are_bound: bool,
    /// The least and the largest of every column.
    least: Vec<Together>,
    most: Vec<Together>,
    /// So many steps may be made in the next block.
    next: u64,
}

impl Columns {
    pub fn of(kernel: &Kernel) -> Self {
        let Checks { in_middle, all, .. } = kernel.quick;
        let is_time = |fence: &Fence| fence.slot as usize == kernel.layout.time;
        let fences = |count: usize| (0..count).filter(|fence| !is_time(&kernel.fences[*fence]));
        let slots = |count: usize| fences(count).map(|fence| kernel.fences[fence].slot).collect();
        let (mut ends, middles): (Vec<Slot>, Vec<Slot>) = (slots(all), slots(in_middle));
        let mut column_of = |slot: Slot| {
            ends.iter().position(|known| *known == slot).unwrap_or_else(|| {
                ends.push(slot);
                ends.len() - 1
            })
        };
        let followed = kernel.followed.iter().map(|slot| column_of(*slot)).collect();
        let states = kernel.layout.states..kernel.layout.time;
        let states = states.map(|slot| column_of(slot as Slot)).collect();
        let bound = (0..).zip(fences(all)).chain((ends.len()..).zip(fences(in_middle))).collect();
        let rates = (ends.len() + middles.len()).next_multiple_of(TOGETHER);
        let kept = rates + kernel.rates.len();
        Columns {
            fences: bound,
            of_time: kernel.fences.iter().position(is_time),
            states,
            followed,
            rates,
            kept,
            width: (kept + kernel.kept.len()).next_multiple_of(TOGETHER),
            ends,
            middles,
        }
    }

    /// How many steps a block may have.
    fn most_steps(&self) -> u64 {
        ((ROOM / self.width) as u64).clamp(1, LONGEST)
    }

    /// How many vectors of a row are looked at, the first.
    fn judged(&self) -> usize {
        self.rates / TOGETHER
    }
}

impl Rows {
    /// Room for the rows of a kernel; nothing is done where it is there.
    pub fn make_room(&mut self, columns: &Columns) {
        let numbers = columns.width * (columns.most_steps() as usize + 1) + TOGETHER;
        if self.numbers.len() == numbers {
            return;
        }
        let anywhere = |value: f64| vec![[value; TOGETHER]; columns.judged()];
        self.numbers = vec![0.0; numbers];
        (self.lows, self.highs) = (anywhere(f64::NEG_INFINITY), anywhere(f64::INFINITY));
        (self.least, self.most) = (anywhere(0.0), anywhere(0.0));
        (self.next, self.are_bound) = (0, false);
    }

    /// The fences are no longer where they were.
    pub fn forget_fences(&mut self) {
        self.are_bound = false;
    }

    fn bind(&mut self, columns: &Columns, lows: &[f64], highs: &[f64]) {
        for (own, all) in [(&mut self.lows, lows), (&mut self.highs, highs)] {
            let own = own.as_flattened_mut();
            columns.fences.iter().for_each(|(column, fence)| own[*column] = all[*fence]);
        }
        self.are_bound = true;
    }

    /// How many of so many steps the next block takes.
    pub fn next_of(&self, columns: &Columns, steps: u64) -> u64 {
        self.next.clamp(SHORTEST, LONGEST).min(columns.most_steps()).min(steps)
    }

    /// The rows, from where vectors of them do not straddle lines of the processor's memory.
    fn numbers(&self) -> &[f64] {
        &self.numbers[straddling(&self.numbers)..]
    }

    pub fn numbers_mut(&mut self) -> &mut [f64] {
        let first = straddling(&self.numbers);
        &mut self.numbers[first..]
    }

    /// How many steps, the first of some, stayed within all fences. Surveys these.
    fn quiet(&mut self, columns: &Columns, steps: u64) -> u64 {
        if self.survey(columns, steps) {
            self.next = 2 * steps;
            return steps;
        }
        self.next = 0;
        let gone = Arch::new().dispatch(Search { columns, rows: self, steps });
        self.survey(columns, gone);
        gone
    }

    fn survey(&mut self, columns: &Columns, steps: u64) -> bool {
        Arch::new().dispatch(Survey { columns, rows: self, steps })
    }
}

/// How many numbers stand before the first at which a line begins.
fn straddling(numbers: &[f64]) -> usize {
    numbers.as_ptr().align_offset(size_of::<Together>()).min(TOGETHER)
}

impl Frame<f64> {
    /// Room for blocks of steps, so that none has to be made while they are gone.
    pub fn with_rows(mut self, kernel: &Kernel) -> Self {
        self.rows.make_room(&kernel.columns);
        self
    }

    /// Writes down where a block begins.
    pub(super) fn begin_rows(&mut self, kernel: &Kernel) {
        let columns = &kernel.columns;
        let first = self.rows.numbers_mut();
        for (column, state) in columns.states.iter().zip(&self.states) {
            first[*column] = *state;
        }
        first[columns.rates..columns.kept].copy_from_slice(&self.rates);
        let kept = kernel.layout.kept..kernel.layout.noise;
        first[columns.kept..columns.kept + kept.len()].copy_from_slice(&self.slots[kept]);
        if !self.rows.are_bound {
            self.rows.bind(columns, &self.lows, &self.highs);
        }
    }

    /// How many steps, the first of some, end before time is beyond its fence.
    fn timely(&self, columns: &Columns, steps: &Steps) -> u64 {
        let Some(fence) = columns.of_time else { return steps.count };
        let is_beyond = |step: u64| !(self.lows[fence]..=self.highs[fence]).contains(&steps.end_of(step));
        // It goes on: where it is not beyond at last, it never was.
        if is_beyond(steps.count - 1) {
            (0..steps.count).find(|step| is_beyond(*step)).unwrap_or(steps.count)
        } else {
            steps.count
        }
    }

    /// Looks at the rows of some steps, and goes on to the last before something is met: how many were gone.
    pub(super) fn judge_rows(&mut self, kernel: &Kernel, steps: &Steps) -> u64 {
        let columns = &kernel.columns;
        let gone = self.rows.quiet(columns, self.timely(columns, steps));
        if gone == 0 {
            return 0;
        }
        self.see_rows(columns, &Steps { count: gone, ..*steps });
        let last = &self.rows.numbers()[gone as usize * columns.width..][..columns.width];
        for (state, column) in self.states.iter_mut().zip(&columns.states) {
            *state = last[*column];
        }
        self.rates.copy_from_slice(&last[columns.rates..columns.kept]);
        let kept = kernel.layout.kept..kernel.layout.noise;
        self.slots[kept.clone()].copy_from_slice(&last[columns.kept..columns.kept + kept.len()]);
        self.time = steps.end_of(gone - 1);
        gone
    }

    /// Sees the voltages that are followed in the rows of quiet steps.
    fn see_rows(&mut self, columns: &Columns, steps: &Steps) {
        let rows = self.rows.numbers();
        let [all_least, all_most] = [&self.rows.least, &self.rows.most].map(|all| all.as_flattened());
        let Extremes { least, least_at, most, most_at } = &mut self.extremes;
        for (index, column) in columns.followed.iter().enumerate() {
            let when = |value: f64| {
                let mut steps = (0..steps.count).zip(rows.chunks_exact(columns.width).skip(1));
                steps.find(|(_, row)| row[*column] == value).map(|(step, _)| step)
            };
            let [low, high] = [all_least, all_most].map(|all| all[*column]);
            if low < least[index]
                && let Some(step) = when(low)
            {
                (least[index], least_at[index]) = (low, steps.end_of(step));
            }
            if high > most[index]
                && let Some(step) = when(high)
            {
                (most[index], most_at[index]) = (high, steps.end_of(step));
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
        let (rows, _) = numbers[straddling(numbers)..].as_chunks();
        let width = columns.width / TOGETHER;
        let rows = &rows[width..][..width * steps as usize];
        let mut quiet = true;
        for at in 0..columns.judged() {
            let [mut low, mut high, mut sum] = [f64::INFINITY, f64::NEG_INFINITY, 0.0].map(Vector::splat);
            for row in rows.chunks_exact(width) {
                let value = Vector::from(row[at]);
                low = Vector::select_below(value, low, value, low);
                high = Vector::select_below(high, value, value, high);
                // What is no number does not get lost in a sum.
                sum = sum.add(value);
            }
            let [lowest, highest] = [lows[at], highs[at]].map(Vector::from);
            let [infinite, none] = [f64::INFINITY, f64::NAN].map(Vector::splat);
            let high_if_all_are = Vector::select_below(sum, infinite, high, none);
            quiet &= low.reaches(lowest) & highest.reaches(high_if_all_are);
            (least[at], most[at]) = (low.numbers(), high.numbers());
        }
        quiet
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
        let Search { columns, rows: rows @ Rows { lows, highs, .. }, steps } = self;
        let (all, _) = rows.numbers().as_chunks();
        let width = columns.width / TOGETHER;
        for step in 0..steps {
            let mut fenced = Vector::TRUE;
            let row = &all[(step as usize + 1) * width..][..columns.judged()];
            for ((value, low), high) in row.iter().zip(lows).zip(highs) {
                fenced = Vector::from(*value).lies_between((*low).into(), (*high).into(), fenced);
            }
            if !fenced.reaches(Vector::TRUE) {
                return step;
            }
        }
        steps
    }
}
