//! The steps of a kernel.

use pulp::{Arch, NullaryFnOnce};

use super::frame::{Extremes, Frame};
use super::lane::Lane;
use super::{Checks, Kernel};
use crate::grid::{Grid, SAME};

/// The share of a step's length for which its first rate counts, and its last. Multiplied by: a quotient takes longer.
pub(super) const SIXTH: f64 = 1.0 / 6.0;

/// What a look ahead met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Look {
    /// Nothing.
    Quiet,
    /// Something that comes and goes within the step.
    Within,
    /// Something.
    Ahead,
}

impl Kernel {
    /// Looks ahead by a step of this length that ends at a time, and at every watch.
    #[inline(always)]
    fn look(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], length: f64, end: f64) -> Look {
        self.to_middle(frame, tables, length, &self.thorough);
        let within = self.rest(frame, self.thorough.in_middle);
        self.to_end(frame, tables, [length, end], &self.thorough);
        match (within, self.rest(frame, self.thorough.all)) {
            (_, false) => Look::Ahead,
            (false, true) => Look::Within,
            (true, true) => Look::Quiet,
        }
    }

    /// Works out where half a step of this length leads to, and what is checked there.
    #[inline(always)]
    fn to_middle<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        tables: &[Vec<[f64; 2]>],
        length: f64,
        checks: &Checks,
    ) {
        let (half, middle) = (V::splat(0.5 * length), frame.time + 0.5 * length);
        self.go_to_pieces(frame, tables, middle);
        self.put_time(frame, middle);
        self.stage(frame, tables, 0, half);
        self.stage(frame, tables, 1, half);
        checks.middle.run(&mut frame.slots, tables);
    }

    /// Goes on from there to where the whole step leads, which ends at a time: to states and their rates, and what is
    /// checked there.
    #[inline(always)]
    fn to_end<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        tables: &[Vec<[f64; 2]>],
        [length, end]: [f64; 2],
        checks: &Checks,
    ) {
        self.put_time(frame, end);
        self.stage(frame, tables, 2, V::splat(length));
        let sixth = V::splat(length * SIXTH);
        let two = V::splat(2.0);
        for state in 0..frame.states.len() {
            let [second, third, fourth] = [0, 1, 2].map(|stage| frame.stages[stage][state]);
            // The last rate is added last, in one operation, as everything waits for it; so a constant rate is rounded twice.
            let rates = second.add(third).multiply_add(two, frame.rates[state]);
            let way = rates.multiply_add(sixth, frame.states[state]);
            frame.slots[self.layout.states + state] = fourth.multiply_add(sixth, way);
        }
        self.moving.run(&mut frame.slots, tables);
        self.keep(frame, 3);
        checks.middle.run(&mut frame.slots, tables);
        checks.ending.run(&mut frame.slots, tables);
    }

    #[inline(always)]
    fn stage<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], stage: usize, length: V) {
        let from = if stage == 0 { &frame.rates } else { &frame.stages[stage - 1] };
        let states = &mut frame.slots[self.layout.states..self.layout.time];
        for ((trial, state), rate) in states.iter_mut().zip(&frame.states).zip(from) {
            *trial = rate.multiply_add(length, *state);
        }
        self.moving.run(&mut frame.slots, tables);
        self.keep(frame, stage);
    }

    /// Works everything out at the states and the time in the slots: rates as those of the last stage.
    #[inline(always)]
    fn at_slots<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>]) {
        for code in [&self.moving, &self.thorough.middle, &self.thorough.ending] {
            code.run(&mut frame.slots, tables);
        }
        self.keep(frame, 3);
        self.rest(frame, self.watches.len());
    }

    #[inline(always)]
    fn keep<V: Lane>(&self, frame: &mut Frame<V>, stage: usize) {
        for (rate, slot) in frame.stages[stage].iter_mut().zip(&self.rates) {
            *rate = frame.slots[*slot as usize];
        }
    }

    /// Works out what is left of the first watches, and tells whether that is nowhere below 0.
    #[inline(always)]
    pub(super) fn rest<V: Lane>(&self, frame: &mut Frame<V>, watches: usize) -> bool {
        let lines = frame.slopes.iter().zip(&frame.rooms).zip(&mut frame.rests);
        let (zero, mut quiet) = (V::splat(0.0), true);
        // A closure would be compiled for any processor.
        for (watch, ((slope, room), rest)) in self.watches[..watches].iter().zip(lines) {
            *rest = watch.value(&frame.slots).multiply_add(*slope, *room);
            quiet &= rest.reaches(zero);
        }
        quiet
    }

    /// The lanes in which something is beyond the first fences.
    #[inline(always)]
    fn beyond_fences<V: Lane>(&self, frame: &Frame<V>, fences: usize) -> u64 {
        let ranges = frame.lows.iter().zip(&frame.highs);
        let mut fenced = V::TRUE;
        // No closure here, either.
        for (fence, (low, high)) in self.fences[..fences].iter().zip(ranges) {
            fenced = frame.slots[fence.slot as usize].lies_between(*low, *high, fenced);
        }
        V::failing(fenced)
    }

    /// Makes the step looked at the present.
    #[inline(always)]
    fn accept<V: Lane>(&self, frame: &mut Frame<V>, time: f64) {
        frame.states.copy_from_slice(&frame.slots[self.layout.states..self.layout.time]);
        let [.., end] = &frame.stages;
        frame.rates.copy_from_slice(end);
        for (index, slot) in self.kept.iter().enumerate() {
            frame.slots[self.layout.kept + index] = frame.slots[*slot as usize];
        }
        frame.time = time;
    }

    /// Sees the voltages that are followed at the step looked at, which ends at a time.
    #[inline(always)]
    pub fn see<V: Lane>(&self, frame: &mut Frame<V>, time: f64) {
        let now = V::splat(time);
        let Extremes { least, least_at, most, most_at } = &mut frame.extremes;
        for (index, slot) in self.followed.iter().enumerate() {
            let value = frame.slots[*slot as usize];
            least_at[index] = V::select_below(value, least[index], now, least_at[index]);
            least[index] = V::select_below(value, least[index], value, least[index]);
            most_at[index] = V::select_below(most[index], value, now, most_at[index]);
            most[index] = V::select_below(most[index], value, value, most[index]);
        }
    }

    /// Goes so many steps of a grid from one of its instants, as long as nothing is met in any lane aboard: how many were gone.
    #[inline(always)]
    fn all_steps<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], grid: &Steps) -> u64 {
        for step in 0..grid.count {
            let end = grid.end_of(step);
            let length = end - frame.time;
            self.to_middle(frame, tables, length, &self.quick);
            let within = self.beyond_fences(frame, self.quick.in_middle);
            self.to_end(frame, tables, [length, end], &self.quick);
            frame.beyond = (within | self.beyond_fences(frame, self.quick.all)) & frame.aboard;
            if frame.beyond != 0 {
                return step;
            }
            self.see(frame, end);
            self.accept(frame, end);
        }
        grid.count
    }
}

/// The same with what the processor offers.
impl Kernel {
    /// Goes so many steps of a grid from one of its instants, as long as nothing is met: how many were gone.
    pub fn steps<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], grid: &Steps) -> u64 {
        Arch::new().dispatch(AllSteps { kernel: self, frame, tables, grid })
    }

    /// Works everything out at the states and the time in the slots.
    pub fn work_out<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>]) {
        Arch::new().dispatch(AtSlots { kernel: self, frame, tables });
    }

    /// Looks ahead by a step of this length.
    pub fn look_ahead(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], length: f64) -> Look {
        Arch::new().dispatch(OneLook { kernel: self, frame, tables, length })
    }

    /// Makes the step looked at, which ends at a time, the present.
    pub fn take(&self, frame: &mut Frame<f64>, time: f64) {
        (frame.last.begin, frame.last.end) = (frame.time, time);
        frame.last.states.copy_from_slice(&frame.states);
        frame.last.rates.copy_from_slice(&frame.rates);
        frame.present.copy_from_slice(&frame.rests);
        self.take_quietly(frame, time);
    }

    /// The same of a step that nobody will look back into.
    pub fn take_quietly<V: Lane>(&self, frame: &mut Frame<V>, time: f64) {
        self.see(frame, time);
        self.accept(frame, time);
    }
}

// Structures where closures would do: what is dispatched must be inlined.

struct AllSteps<'a, V> {
    kernel: &'a Kernel,
    frame: &'a mut Frame<V>,
    tables: &'a [Vec<[f64; 2]>],
    grid: &'a Steps,
}

impl<V: Lane> NullaryFnOnce for AllSteps<'_, V> {
    type Output = u64;

    #[inline(always)]
    fn call(self) -> u64 {
        self.kernel.all_steps(self.frame, self.tables, self.grid)
    }
}

struct AtSlots<'a, V> {
    kernel: &'a Kernel,
    frame: &'a mut Frame<V>,
    tables: &'a [Vec<[f64; 2]>],
}

impl<V: Lane> NullaryFnOnce for AtSlots<'_, V> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.kernel.at_slots(self.frame, self.tables);
    }
}

struct OneLook<'a> {
    kernel: &'a Kernel,
    frame: &'a mut Frame<f64>,
    tables: &'a [Vec<[f64; 2]>],
    length: f64,
}

impl NullaryFnOnce for OneLook<'_> {
    type Output = Look;

    #[inline(always)]
    fn call(self) -> Look {
        let end = self.frame.time + self.length;
        self.kernel.look(self.frame, self.tables, self.length, end)
    }
}

/// Steps of a grid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Steps {
    /// Where the grid begins.
    pub begin: f64,
    pub grid: Grid,
    /// Index of the instant at which the first of them ends.
    pub first: u64,
    pub count: u64,
}

impl Steps {
    /// When a step ends.
    #[inline(always)]
    pub fn end_of(&self, step: u64) -> f64 {
        self.begin + self.grid.time(self.first + step)
    }

    /// Those after some of them.
    pub fn after(self, gone: u64) -> Steps {
        Steps { first: self.first + gone, count: self.count - gone, ..self }
    }

    /// How many are left up to the next whose number is a multiple of something.
    pub fn up_to_multiple_of(&self, number: u64) -> u64 {
        number - (self.first - 1) % number
    }

    /// How many end at a time or before it.
    pub fn until(&self, time: f64) -> u64 {
        if time == f64::INFINITY {
            return self.count;
        }
        let whole = self.grid.steps_in((time - self.begin).max(0.0)) + 1;
        let some = whole.saturating_sub(self.first).min(self.count);
        // A grid forgives more rounding than instants that are told apart.
        if some > 0 && self.end_of(some - 1) * (1.0 - SAME) > time { some - 1 } else { some }
    }

    /// How many end earlier than a time by some room.
    pub fn before(&self, time: f64, room: f64) -> u64 {
        let some = self.until(time);
        if some > 0 && self.end_of(some - 1) >= time - room { some - 1 } else { some }
    }
}
