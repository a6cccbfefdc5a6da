//! The steps of a kernel: the classical Runge-Kutta method of order 4.
//!
//! A quick step only tests whether anything is hit, and is taken if nothing is. Otherwise the solver looks ahead with
//! thorough tests, finds out what is hit and when, and accepts a shorter step.
//!
//! Let x be the states, h the step and f the rates. The stages are k1 = f(x), k2 = f(x + h/2 k1), k3 = f(x + h/2 k2)
//! and k4 = f(x + h k3). Then x moves by h/6 (k1 + 2 k2 + 2 k3 + k4). k1 is known from the end of the step before. The
//! frame stores k2, k3, k4 and the rate at the end as its stages 0 to 3.
//!
//! Delay lines cut a step into pieces, each of which is such a step (`delays`).

use pulp::NullaryFnOnce;

use super::frame::{Extremes, Frame};
use super::lane::{Lane, dispatch};
use super::span::Span;
use super::{Checks, Kernel, Steps};
use crate::delay_line::DelayLine;
use crate::parabola::{LEAST_SLOPES, Parabola};

/// The weight of the first and the last rate of a step. It is a factor because a division takes longer.
pub(super) const SIXTH: f64 = 1.0 / 6.0;

/// The result of a look-ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LookResult {
    /// No watch is hit.
    Quiet,
    /// A watch is hit within the step near this share of it (0 ... 1), but not at its end.
    Inside(f64),
    /// A watch is hit at the end of the step.
    AtEnd,
}

impl Kernel {
    /// Evaluates a step that ends at `end`, without taking it, and tests every watch. The slots, stages and margins are
    /// then those of its end, so that the step can be accepted. Returns whether a watch is hit at the end.
    #[inline(always)]
    fn look(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], length: f64, end: f64) -> bool {
        let span = Span::same(frame.time, length, end);
        self.select_pieces(frame, tables, span.middle);
        self.first_stage(frame, tables, &span);
        self.thorough.first.run(&mut frame.slots, tables);
        self.store_inner(frame, 0);
        self.stage(frame, tables, 1, span.half);
        self.thorough.second.run(&mut frame.slots, tables);
        self.store_inner(frame, 1);
        self.to_end(frame, tables, &span, &self.thorough);
        !self.update_margins(frame, self.thorough.all)
    }

    /// Stores what is tested within a step, from the slots of one of the first two stages.
    #[inline(always)]
    fn store_inner(&self, frame: &mut Frame<f64>, stage: usize) {
        let Frame { slots, slopes, offsets, inner, .. } = frame;
        let (margins, turning) = inner[stage].split_at_mut(self.thorough.within);
        let lines = slopes.iter().zip(offsets.iter());
        for ((margin, watch), (slope, offset)) in margins.iter_mut().zip(&self.watches).zip(lines) {
            *margin = watch.value(slots).multiply_add(*slope, *offset);
        }
        for (value, followed) in turning.iter_mut().zip(self.turning()) {
            *value = slots[followed.slot as usize];
        }
    }

    /// The result of a look-ahead, after it has evaluated a step and tested its end.
    pub(super) fn look_result(&self, frame: &Frame<f64>, is_hit_at_end: bool) -> LookResult {
        if is_hit_at_end {
            return LookResult::AtEnd;
        }
        let dips = (0..self.thorough.within).filter_map(|watch| {
            let [begin, end] = [frame.present[watch], frame.margins[watch]];
            let stages = frame.inner.each_ref().map(|margins| margins[watch]);
            Parabola::of_stages(stages, [begin, end]).dip()
        });
        dips.reduce(f64::min).map_or(LookResult::Quiet, LookResult::Inside)
    }

    /// Whether a sampled value whose turning points count turns within the step ahead.
    pub(crate) fn has_turn(&self, frame: &Frame<f64>) -> bool {
        let first_values = frame.inner.each_ref().map(|stage| &stage[self.thorough.within..]);
        self.turning().iter().enumerate().any(|(index, followed)| {
            let ends = [followed.begin, followed.slot].map(|slot| frame.slots[slot as usize]);
            Parabola::of_stages(first_values.map(|values| values[index]), ends).may_turn()
        })
    }

    /// Computes the first stage of a span, which is in its middle.
    #[inline(always)]
    fn first_stage<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], span: &Span<V>) {
        self.set_time(frame, span.middle);
        self.set_delayed(frame, span.middle, DelayLine::next_left_limit);
        self.stage(frame, tables, 0, span.half);
    }

    /// Computes the first half of a span for a quick step: stages 0 and 1, with the sums of the followed voltages.
    /// Returns one bit for every lane in which a voltage that is tested at the first stage is outside its safe interval.
    #[inline(always)]
    fn to_middle<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], span: &Span<V>) -> u64 {
        self.first_stage(frame, tables, span);
        self.quick.first.run(&mut frame.slots, tables);
        let outside = self.outside_safe_intervals(frame, self.first_intervals);
        for (sum, followed) in frame.sums.iter_mut().zip(&self.followed) {
            *sum = frame.slots[followed.slot as usize];
        }
        self.stage(frame, tables, 1, span.half);
        self.quick.second.run(&mut frame.slots, tables);
        for (sum, followed) in frame.sums.iter_mut().zip(&self.followed) {
            *sum = sum.add(frame.slots[followed.slot as usize]);
        }
        outside
    }

    /// One bit for every lane in which the control point of a followed voltage is outside its safe interval, or in which
    /// a sampled value turns. The control point is that of [`Parabola`].
    #[inline(always)]
    fn outside_parabolas<V: Lane>(&self, frame: &Frame<V>) -> u64 {
        let mut is_inside = V::TRUE;
        let bounds = frame.lows[self.first_intervals..].iter().zip(&frame.highs[self.first_intervals..]);
        for ((followed, sum), (low, high)) in
            self.followed[..self.curved_intervals].iter().zip(&frame.sums).zip(bounds)
        {
            let [begin, end] = [frame.slots[followed.begin as usize], frame.slots[followed.slot as usize]];
            is_inside = control_point(*sum, [begin, end]).is_within(*low, *high, is_inside);
        }
        for (followed, sum) in self.turning().iter().zip(&frame.sums[self.curved_intervals..]) {
            let [begin, end] = [frame.slots[followed.begin as usize], frame.slots[followed.slot as usize]];
            let control = control_point(*sum, [begin, end]);
            let slopes = control.subtract(begin).multiply(end.subtract(control));
            let rise = end.subtract(begin);
            let excess = rise.multiply(rise).multiply_add(V::splat(-LEAST_SLOPES), slopes);
            is_inside = excess.is_within(V::splat(0.0), V::splat(f64::INFINITY), is_inside);
        }
        V::failing(is_inside)
    }

    /// Computes the second half of a span: states and rates at its end, with the tests there.
    #[inline(always)]
    fn to_end<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        tables: &[Vec<[f64; 2]>],
        span: &Span<V>,
        checks: &Checks,
    ) {
        self.set_time(frame, span.end);
        self.set_delayed(frame, span.end, DelayLine::next_left_limit);
        self.stage(frame, tables, 2, span.length);
        let sixth = span.sixth;
        let two = V::splat(2.0);
        for state in 0..frame.states.len() {
            let [second, third, fourth] = [0, 1, 2].map(|stage| frame.stages[stage][state]);
            // The last rate is added last, in one operation, because everything else is ready before it.
            let rates = second.add(third).multiply_add(two, frame.rates[state]);
            let partial = rates.multiply_add(sixth, frame.states[state]);
            frame.slots[self.layout.states + state] = fourth.multiply_add(sixth, partial);
        }
        self.moving.run(&mut frame.slots, tables);
        self.store_rates(frame, 3);
        checks.first.run(&mut frame.slots, tables);
        checks.ending.run(&mut frame.slots, tables);
    }

    /// One stage: the rates at a distance `length` along the rates of the stage before: f(x + length x k). Stage 0
    /// starts from the rates at the beginning of the step.
    #[inline(always)]
    fn stage<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], stage: usize, length: V) {
        let from = if stage == 0 { &frame.rates } else { &frame.stages[stage - 1] };
        let states = &mut frame.slots[self.layout.states..self.layout.time];
        for ((trial, state), rate) in states.iter_mut().zip(&frame.states).zip(from) {
            *trial = rate.multiply_add(length, *state);
        }
        self.moving.run(&mut frame.slots, tables);
        self.store_rates(frame, stage);
    }

    /// Evaluates everything at the states and the time in the slots. The rates become those of the last stage.
    #[inline(always)]
    fn at_slots<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>]) {
        for code in [&self.moving, &self.thorough.first, &self.thorough.ending] {
            code.run(&mut frame.slots, tables);
        }
        self.store_rates(frame, 3);
        self.update_margins(frame, self.watches.len());
    }

    /// Stores the rates of a stage, from the slots of the last evaluation, in the order of the states.
    #[inline(always)]
    fn store_rates<V: Lane>(&self, frame: &mut Frame<V>, stage: usize) {
        for (rate, slot) in frame.stages[stage].iter_mut().zip(&self.rates) {
            *rate = frame.slots[*slot as usize];
        }
    }

    /// Computes the margins of the first watches: slope x voltage + offset. Returns whether none is below 0 or not a
    /// number. With several lanes it refers to all of them.
    #[inline(always)]
    pub(super) fn update_margins<V: Lane>(&self, frame: &mut Frame<V>, watches: usize) -> bool {
        let lines = frame.slopes.iter().zip(&frame.offsets).zip(&mut frame.margins);
        let (zero, mut is_quiet) = (V::splat(0.0), true);
        // A closure would be compiled without wide registers.
        for (watch, ((slope, offset), margin)) in self.watches[..watches].iter().zip(lines) {
            *margin = watch.value(&frame.slots).multiply_add(*slope, *offset);
            is_quiet &= margin.all_at_least(zero);
        }
        is_quiet
    }

    /// One bit for every lane in which a voltage is outside one of the first safe intervals, or is not a number.
    #[inline(always)]
    fn outside_safe_intervals<V: Lane>(&self, frame: &Frame<V>, safe_intervals: usize) -> u64 {
        let ranges = frame.lows.iter().zip(&frame.highs);
        let mut is_inside = V::TRUE;
        // A loop for the same reason.
        for (interval, (low, high)) in self.safe_intervals[..safe_intervals].iter().zip(ranges) {
            is_inside = frame.slots[interval.slot as usize].is_within(*low, *high, is_inside);
        }
        V::failing(is_inside)
    }

    /// Takes the span that was computed, including the inputs of delay lines. They are stored first, at the time and
    /// with the voltages of its end.
    #[inline(always)]
    fn accept<V: Lane>(&self, frame: &mut Frame<V>, span: &Span<V>) {
        self.record_delay_inputs(frame, span);
        self.advance(frame, span);
    }

    /// Moves the frame to the end of the span that was computed: extremes, states, rates, sampled values and time. In
    /// idle lanes, whose span has length 0, everything stays.
    #[inline(always)]
    fn advance<V: Lane>(&self, frame: &mut Frame<V>, span: &Span<V>) {
        self.observe(frame, span);
        let after = &frame.slots[self.layout.states..self.layout.time];
        for (state, after) in frame.states.iter_mut().zip(after) {
            *state = span.select_moving(*after, *state);
        }
        let [.., end] = &frame.stages;
        for (rate, end) in frame.rates.iter_mut().zip(end) {
            *rate = span.select_moving(*end, *rate);
        }
        for (index, slot) in self.sampled.iter().enumerate() {
            let slot_of_sample = self.layout.sampled + index;
            frame.slots[slot_of_sample] =
                span.select_moving(frame.slots[*slot as usize], frame.slots[slot_of_sample]);
        }
        frame.time = span.end;
    }

    /// Updates the extremes of the tracked voltages at the end of the span that was computed.
    #[inline(always)]
    fn observe<V: Lane>(&self, frame: &mut Frame<V>, span: &Span<V>) {
        let now = span.end;
        let Extremes { least, least_at, most, most_at } = &mut frame.extremes;
        for (index, slot) in self.tracked.iter().enumerate() {
            let value = frame.slots[*slot as usize];
            let [low, high] =
                [span.select_moving(value, least[index]), span.select_moving(value, most[index])];
            least_at[index] = V::select_below(low, least[index], now, least_at[index]);
            least[index] = V::select_below(low, least[index], low, least[index]);
            most_at[index] = V::select_below(most[index], high, now, most_at[index]);
            most[index] = V::select_below(most[index], high, high, most[index]);
        }
    }

    /// Takes a piece of a step, unless a watch is hit in an active lane. Returns whether it was taken.
    ///
    /// `hit_lanes` of the frame then has the lanes in which a watch was hit. If the piece is not taken, the states,
    /// rates and time are those before it.
    #[inline(always)]
    fn try_piece<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], span: &Span<V>) -> bool {
        let within = self.to_middle(frame, tables, span);
        self.to_end(frame, tables, span, &self.quick);
        let outside =
            within | self.outside_parabolas(frame) | self.outside_safe_intervals(frame, self.quick.all);
        frame.hit_lanes = outside & frame.active_lanes & span.moving();
        if frame.hit_lanes != 0 {
            return false;
        }
        self.accept(frame, span);
        true
    }

    /// Takes the pieces up to the end of a step, unless a watch is hit in an active lane. Returns whether the end was
    /// reached.
    #[inline(always)]
    fn try_step<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], end: f64) -> bool {
        loop {
            let span = self.next_piece(frame, end);
            if !self.try_piece(frame, tables, &span) {
                return false;
            }
            if !self.has_delay_lines() || frame.time.all_at_least(V::splat(end)) {
                return true;
            }
        }
    }

    /// Takes steps of a grid until a watch is hit in an active lane. Returns how many were taken. The tables of time
    /// are switched once per step, by its middle.
    #[inline(always)]
    fn all_steps<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], grid: &Steps) -> u64 {
        for step in 0..grid.count {
            let end = grid.end_of(step);
            let begin = frame.time.get(0);
            self.select_pieces(frame, tables, begin + 0.5 * (end - begin));
            if !self.try_step(frame, tables, end) {
                return step;
            }
        }
        grid.count
    }
}

/// The control point of a parabola, with the rounding of [`Parabola::of_stages`], from the sum of the voltages at the
/// first two stages and the voltages at both ends.
#[inline(always)]
fn control_point<V: Lane>(sum: V, [begin, end]: [V; 2]) -> V {
    begin.add(end).multiply_add(V::splat(-0.5), sum)
}

/// The same operations, compiled for the widest registers of the processor.
impl Kernel {
    /// Takes steps of a grid until a watch is hit. Returns how many were taken.
    pub(crate) fn steps<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], grid: &Steps) -> u64 {
        dispatch(AllSteps { kernel: self, frame, tables, grid })
    }

    /// Evaluates everything at the states and the time in the slots.
    pub(crate) fn evaluate<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>]) {
        dispatch(AtSlots { kernel: self, frame, tables });
    }

    /// Evaluates a step of this length, without taking it, and tests every watch.
    pub(crate) fn look_ahead(
        &self,
        frame: &mut Frame<f64>,
        tables: &[Vec<[f64; 2]>],
        length: f64,
    ) -> LookResult {
        let is_hit_at_end = dispatch(OneLook { kernel: self, frame, tables, length });
        self.look_result(frame, is_hit_at_end)
    }

    /// Takes the step that was computed. It ends at `time`.
    pub(crate) fn accept_step(&self, frame: &mut Frame<f64>, time: f64) {
        let span = self.remember_step(frame, time);
        self.accept(frame, &span);
    }

    /// Takes the step that was computed up to an instant with a jump. Discontinuities that come out of delay lines
    /// there are not passed on yet.
    pub(crate) fn accept_step_before_jump(&self, frame: &mut Frame<f64>, time: f64) {
        let span = self.remember_step(frame, time);
        self.put_delay_inputs(frame, time);
        self.advance(frame, &span);
    }

    /// Stores the step that ends at `time` as the last one, for `set_past_inputs`.
    fn remember_step(&self, frame: &mut Frame<f64>, time: f64) -> Span<f64> {
        (frame.last.begin, frame.last.end) = (frame.time, time);
        frame.last.states.copy_from_slice(&frame.states);
        frame.last.rates.copy_from_slice(&frame.rates);
        frame.present.copy_from_slice(&frame.margins);
        Span::same(frame.time, time - frame.time, time)
    }

    /// Updates the extremes of the tracked voltages at present, from the last evaluation.
    pub(crate) fn observe_present(&self, frame: &mut Frame<f64>) {
        self.observe(frame, &Span::same(frame.time, 0.0, frame.time));
    }

    /// Takes the piece of a step in which lanes that have left were hit, and continues to the end of the step. Returns
    /// whether the end was reached.
    pub(crate) fn finish_step<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        tables: &[Vec<[f64; 2]>],
        end: f64,
    ) -> bool {
        dispatch(OneStep { kernel: self, frame, tables, end })
    }
}

// Structures instead of closures: the dispatched function must be inlined.

/// The arguments of [`Kernel::steps`].
struct AllSteps<'a, V> {
    kernel: &'a Kernel,
    frame: &'a mut Frame<V>,
    tables: &'a [Vec<[f64; 2]>],
    /// The steps to take.
    grid: &'a Steps,
}

impl<V: Lane> NullaryFnOnce for AllSteps<'_, V> {
    type Output = u64;

    #[inline(always)]
    fn call(self) -> u64 {
        self.kernel.all_steps(self.frame, self.tables, self.grid)
    }
}

/// The arguments of [`Kernel::finish_step`].
struct OneStep<'a, V> {
    kernel: &'a Kernel,
    frame: &'a mut Frame<V>,
    tables: &'a [Vec<[f64; 2]>],
    /// Time at which the step ends, in problem seconds.
    end: f64,
}

impl<V: Lane> NullaryFnOnce for OneStep<'_, V> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let OneStep { kernel, frame, tables, end } = self;
        let span = kernel.next_piece(frame, end);
        kernel.accept(frame, &span);
        frame.time.all_at_least(Lane::splat(end)) || kernel.try_step(frame, tables, end)
    }
}

/// The arguments of [`Kernel::evaluate`].
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

/// The arguments of [`Kernel::look_ahead`].
struct OneLook<'a> {
    kernel: &'a Kernel,
    frame: &'a mut Frame<f64>,
    tables: &'a [Vec<[f64; 2]>],
    /// Length of the step, in problem seconds.
    length: f64,
}

impl NullaryFnOnce for OneLook<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let end = self.frame.time + self.length;
        self.kernel.look(self.frame, self.tables, self.length, end)
    }
}
