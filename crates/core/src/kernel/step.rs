//! The steps of a kernel.

use pulp::{Arch, NullaryFnOnce};

use super::frame::{Extremes, Frame};
use super::lane::Lane;
use super::span::Span;
use super::{Checks, Kernel};
use crate::delay_line::DelayLine;
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
        let span = Span::same(frame.time, length, end);
        self.go_to_pieces(frame, tables, span.middle);
        self.to_middle(frame, tables, &span, &self.thorough);
        let within = self.rest(frame, self.thorough.in_middle);
        self.to_end(frame, tables, &span, &self.thorough);
        match (within, self.rest(frame, self.thorough.all)) {
            (_, false) => Look::Ahead,
            (false, true) => Look::Within,
            (true, true) => Look::Quiet,
        }
    }

    /// Works out where half of a stretch leads to, and what is checked there.
    #[inline(always)]
    fn to_middle<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        tables: &[Vec<[f64; 2]>],
        span: &Span<V>,
        checks: &Checks,
    ) {
        self.put_time(frame, span.middle);
        self.put_delayed(frame, span.middle, DelayLine::next_until);
        self.stage(frame, tables, 0, span.half);
        self.stage(frame, tables, 1, span.half);
        checks.middle.run(&mut frame.slots, tables);
    }

    /// Goes on from there to where the whole stretch leads: to states and their rates, and what is checked there.
    #[inline(always)]
    fn to_end<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        tables: &[Vec<[f64; 2]>],
        span: &Span<V>,
        checks: &Checks,
    ) {
        self.put_time(frame, span.end);
        self.put_delayed(frame, span.end, DelayLine::next_until);
        self.stage(frame, tables, 2, span.length);
        let sixth = span.sixth;
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

    /// Makes the stretch looked at the present.
    #[inline(always)]
    fn accept<V: Lane>(&self, frame: &mut Frame<V>, span: &Span<V>) {
        self.store(frame, span);
        self.go(frame, span);
    }

    /// Goes to the end of the stretch looked at.
    #[inline(always)]
    fn go<V: Lane>(&self, frame: &mut Frame<V>, span: &Span<V>) {
        self.see(frame, span);
        let after = &frame.slots[self.layout.states..self.layout.time];
        for (state, after) in frame.states.iter_mut().zip(after) {
            *state = span.gone(*after, *state);
        }
        let [.., end] = &frame.stages;
        for (rate, end) in frame.rates.iter_mut().zip(end) {
            *rate = span.gone(*end, *rate);
        }
        for (index, slot) in self.kept.iter().enumerate() {
            let place = self.layout.kept + index;
            frame.slots[place] = span.gone(frame.slots[*slot as usize], frame.slots[place]);
        }
        frame.time = span.end;
    }

    /// Sees the voltages that are followed at the end of the stretch looked at.
    #[inline(always)]
    fn see<V: Lane>(&self, frame: &mut Frame<V>, span: &Span<V>) {
        let now = span.end;
        let Extremes { least, least_at, most, most_at } = &mut frame.extremes;
        for (index, slot) in self.followed.iter().enumerate() {
            let value = frame.slots[*slot as usize];
            let [low, high] = [span.gone(value, least[index]), span.gone(value, most[index])];
            least_at[index] = V::select_below(low, least[index], now, least_at[index]);
            least[index] = V::select_below(low, least[index], low, least[index]);
            most_at[index] = V::select_below(most[index], high, now, most_at[index]);
            most[index] = V::select_below(most[index], high, high, most[index]);
        }
    }

    /// Goes a piece of a step, unless something is met in any lane aboard.
    #[inline(always)]
    fn go_piece<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], span: &Span<V>) -> bool {
        self.to_middle(frame, tables, span, &self.quick);
        let within = self.beyond_fences(frame, self.quick.in_middle);
        self.to_end(frame, tables, span, &self.quick);
        frame.beyond = (within | self.beyond_fences(frame, self.quick.all)) & frame.aboard & span.moving();
        if frame.beyond != 0 {
            return false;
        }
        self.accept(frame, span);
        true
    }

    /// Goes on to the end of a step at a time, unless something is met in any lane aboard.
    #[inline(always)]
    fn go_step<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], end: f64) -> bool {
        loop {
            let span = self.piece(frame, end);
            if !self.go_piece(frame, tables, &span) {
                return false;
            }
            if !self.has_lines() || frame.time.reaches(V::splat(end)) {
                return true;
            }
        }
    }

    /// Goes so many steps of a grid from one of its instants, as long as nothing is met in any lane aboard: how many were gone.
    #[inline(always)]
    fn all_steps<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], grid: &Steps) -> u64 {
        for step in 0..grid.count {
            let end = grid.end_of(step);
            let begin = frame.time.get(0);
            self.go_to_pieces(frame, tables, begin + 0.5 * (end - begin));
            if !self.go_step(frame, tables, end) {
                return step;
            }
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
        let span = self.remember_stretch(frame, time);
        self.accept(frame, &span);
    }

    /// The same up to an instant at which something jumps: what comes out of delay lines there is not yet heard.
    pub fn take_up_to(&self, frame: &mut Frame<f64>, time: f64) {
        let span = self.remember_stretch(frame, time);
        self.put_stored(frame, time);
        self.go(frame, &span);
    }

    fn remember_stretch(&self, frame: &mut Frame<f64>, time: f64) -> Span<f64> {
        (frame.last.begin, frame.last.end) = (frame.time, time);
        frame.last.states.copy_from_slice(&frame.states);
        frame.last.rates.copy_from_slice(&frame.rates);
        frame.present.copy_from_slice(&frame.rests);
        Span::same(frame.time, time - frame.time, time)
    }

    /// Sees the voltages that are followed where the frame is, as they were worked out last.
    pub fn see_now(&self, frame: &mut Frame<f64>) {
        self.see(frame, &Span::same(frame.time, 0.0, frame.time));
    }

    /// Takes the piece looked at of a step that ends at a time, in which something was met in lanes that are no longer aboard,
    /// and goes on to that end: whether nothing is met.
    pub fn go_on<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], end: f64) -> bool {
        Arch::new().dispatch(OneStep { kernel: self, frame, tables, end })
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

struct OneStep<'a, V> {
    kernel: &'a Kernel,
    frame: &'a mut Frame<V>,
    tables: &'a [Vec<[f64; 2]>],
    end: f64,
}

impl<V: Lane> NullaryFnOnce for OneStep<'_, V> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let OneStep { kernel, frame, tables, end } = self;
        let span = kernel.piece(frame, end);
        kernel.accept(frame, &span);
        frame.time.reaches(Lane::splat(end)) || kernel.go_step(frame, tables, end)
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
