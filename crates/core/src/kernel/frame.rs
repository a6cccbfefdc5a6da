//! The memory on which a kernel runs.
//!
//! A frame has everything that a kernel reads and writes: slots, states, branch, watches, extremes and delay lines. The
//! kernel itself is constant and shared by all frames. `V` is `f64` for one run, and `Lanes` for several.

use super::branch_cache::CachedBranch;
use super::lane::Lane;
use super::rows::Rows;
use super::schedules::Schedule;
use super::{Kernel, Layout};
use crate::delay_line::DelayLine;
use crate::multiply_add::multiply_add;

/// All values of one run of a kernel, or of several in lanes.
#[derive(Debug, Clone)]
pub(crate) struct Frame<V> {
    /// Factors, inputs and results of operations; `Layout` has their order.
    pub(super) slots: Vec<V>,
    /// Time in problem seconds. It differs between lanes only within a step that is cut into pieces.
    pub time: V,
    /// The present states, in volts, in the order of the program.
    pub states: Vec<V>,
    /// The rates of the present states, in volts per problem second.
    pub rates: Vec<V>,
    /// The last step that was accepted for one lane.
    pub(super) last: LastStep<V>,
    /// The rates of the four stages. The last one is also the rate at the end of the step ahead.
    pub(super) stages: [Vec<V>; 4],
    /// The margin of every watch at present: slope x voltage + offset.
    pub(super) present: Vec<V>,
    /// The margin of every watch at the end of the step ahead.
    pub(super) margins: Vec<V>,
    /// Values that depend on the branch: on which side of each corner the voltages are.
    pub(super) branch_values: Vec<f64>,
    /// The data of other branches, for a return to them.
    pub(super) branch_cache: Vec<CachedBranch>,
    /// Registers for the parameter code.
    pub(super) parameter_registers: Vec<f64>,
    /// Slope of every watch: 1 or -1, towards the present side.
    pub(super) slopes: Vec<V>,
    /// Offset of every watch, in volts; infinity if the watch cannot be hit.
    pub(super) offsets: Vec<V>,
    /// The sum of every followed voltage at the first two stages, in volts.
    pub(super) sums: Vec<V>,
    /// At each of the first two stages of a look-ahead: the margins of the watches that are tested within a step, and
    /// the sampled values whose turning points count.
    pub(super) inner: [Vec<f64>; 2],
    /// Lower bound of every safe interval, in volts.
    pub(super) lows: Vec<V>,
    /// Upper bound of every safe interval, in volts.
    pub(super) highs: Vec<V>,
    /// The extremes of the tracked voltages.
    pub(super) extremes: Extremes<V>,
    /// The rows of native code; empty if the backend has none.
    pub(super) rows: Rows,
    /// The tracked voltages of the last steps, if they are recorded.
    pub(super) trail: Trail,
    /// The tables that are looked up at time.
    pub(super) schedules: Vec<Schedule>,
    /// Their values in the middle and at the end of a step ahead, for native code.
    pub(super) scheduled_values: Vec<f64>,
    /// The delay lines of every lane.
    pub lines: Vec<Vec<DelayLine>>,
    /// One bit for every active lane. Hits in other lanes are ignored.
    pub(super) active_lanes: u64,
    /// One bit for every lane in which a watch was hit in the last step.
    pub(super) hit_lanes: u64,
}

/// The last accepted step: its ends, and the states and rates at its beginning.
#[derive(Debug, Clone)]
pub(super) struct LastStep<V> {
    /// Time at which the step began, in problem seconds.
    pub begin: f64,
    /// Time at which the step ended, in problem seconds.
    pub end: f64,
    /// The states at its beginning, in volts.
    pub states: Vec<V>,
    /// The rates at its beginning, in volts per problem second.
    pub rates: Vec<V>,
}

/// The tracked voltages at the ends of consecutive steps.
#[derive(Debug, Clone, Default)]
pub(super) struct Trail {
    /// Whether the steps are recorded.
    pub is_enabled: bool,
    /// The voltages, step by step.
    pub volts: Vec<f64>,
}

/// The least and largest value of each voltage at the ends of steps, and the time of the first occurrence.
#[derive(Debug, Clone)]
pub(super) struct Extremes<V> {
    /// Least voltages; infinity if none was observed.
    pub least: Vec<V>,
    /// Their times, in problem seconds.
    pub least_at: Vec<V>,
    /// Largest voltages; -infinity if none was observed.
    pub most: Vec<V>,
    /// Their times, in problem seconds.
    pub most_at: Vec<V>,
}

impl Kernel {
    /// A frame for this kernel. Its values are not set.
    pub(crate) fn frame<V: Lane>(&self) -> Frame<V> {
        let zeros = |count: usize| vec![V::splat(0.0); count];
        let states = self.rates.len();
        Frame {
            slots: zeros(self.layout.all),
            time: V::splat(0.0),
            states: zeros(states),
            rates: zeros(states),
            last: LastStep { begin: 0.0, end: 0.0, states: zeros(states), rates: zeros(states) },
            stages: std::array::from_fn(|_| zeros(states)),
            present: zeros(self.watches.len()),
            margins: zeros(self.watches.len()),
            branch_values: vec![0.0; self.branch_values],
            branch_cache: Vec::new(),
            parameter_registers: Vec::with_capacity(self.parameter_code.len()),
            slopes: zeros(self.watches.len()),
            offsets: zeros(self.watches.len()),
            sums: zeros(self.followed.len()),
            inner: [(); 2].map(|()| vec![0.0; self.thorough.within + self.turning().len()]),
            lows: zeros(self.safe_intervals.len()),
            highs: zeros(self.safe_intervals.len()),
            extremes: Extremes::of(self.tracked.len()),
            rows: Rows::default(),
            trail: Trail::default(),
            schedules: self.scheduled.iter().copied().map(Schedule::of).collect(),
            scheduled_values: vec![0.0; 2 * self.scheduled.len()],
            lines: vec![Vec::new(); V::COUNT],
            active_lanes: 1,
            hit_lanes: 0,
        }
    }

    /// Evaluates everything at the frame's present states and time.
    pub(crate) fn evaluate_present<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>]) {
        self.set_present_inputs(frame, tables);
        self.evaluate(frame, tables);
    }

    /// Sets the inputs of the next evaluation to the present states and time.
    pub(crate) fn set_present_inputs<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>]) {
        frame.slots[self.layout.states..self.layout.time].copy_from_slice(&frame.states);
        self.set_instant(frame, tables, frame.time, DelayLine::next_right_limit);
    }

    /// Begin and length of the last accepted step, in problem seconds. It ends at the present.
    pub(crate) fn last_step(&self, frame: &Frame<f64>) -> [f64; 2] {
        debug_assert_eq!(frame.last.end, frame.time, "only the last step can be looked back into");
        [frame.last.begin, frame.last.end - frame.last.begin]
    }

    /// Sets the inputs of the next evaluation to an instant within the last step. The states follow the cubic through
    /// states and rates at its ends, whose weights are given.
    pub(crate) fn set_past_inputs(
        &self,
        frame: &mut Frame<f64>,
        tables: &[Vec<[f64; 2]>],
        time: f64,
        [states, rates]: [[f64; 2]; 2],
    ) {
        for index in 0..frame.states.len() {
            let last = &frame.last;
            let begin = last.states[index] * states[0] + last.rates[index] * rates[0];
            let end = frame.states[index] * states[1] + frame.rates[index] * rates[1];
            frame.slots[self.layout.states + index] = begin + end;
        }
        self.set_instant(frame, tables, time, DelayLine::next_left_limit);
    }
}

impl<V: Lane> Extremes<V> {
    /// The extremes of voltages that were not observed yet.
    fn of(count: usize) -> Self {
        let [least, most] = [f64::INFINITY, f64::NEG_INFINITY].map(|value| vec![V::splat(value); count]);
        Extremes { least_at: least.clone(), most_at: least.clone(), least, most }
    }

    /// The four lists, so that lanes can be copied.
    pub(super) fn parts(&self) -> [&[V]; 4] {
        [&self.least, &self.least_at, &self.most, &self.most_at]
    }

    /// The four lists, in the same order, to be written.
    pub(super) fn parts_mut(&mut self) -> [&mut [V]; 4] {
        [&mut self.least, &mut self.least_at, &mut self.most, &mut self.most_at]
    }

    /// Sets all extremes to their initial values.
    fn forget(&mut self) {
        for all in [&mut self.least, &mut self.least_at, &mut self.most_at] {
            all.fill(V::splat(f64::INFINITY));
        }
        self.most.fill(V::splat(f64::NEG_INFINITY));
    }

    /// Sets the times of all extremes to infinity, so that only voltages beyond the extremes get a time.
    fn forget_times(&mut self) {
        [&mut self.least_at, &mut self.most_at]
            .into_iter()
            .for_each(|times| times.fill(V::splat(f64::INFINITY)));
    }
}

impl Frame<f64> {
    /// Sets the inputs that are constant within a step: sampled values and levels.
    pub(crate) fn set_held_inputs(&mut self, kernel: &Kernel, sampled: &[f64], levels: &[f64]) {
        let Layout { sampled: first, levels: second, .. } = kernel.layout;
        for (first, values) in [(first, sampled), (second, levels)] {
            self.slots[first..first + values.len()].copy_from_slice(values);
        }
    }

    /// The sampled values of the program.
    pub(crate) fn sampled(&self, kernel: &Kernel) -> &[f64] {
        &self.slots[kernel.layout.sampled..kernel.layout.begins]
    }

    /// A recorded voltage at the last evaluation.
    pub(crate) fn last_recorded(&self, kernel: &Kernel, index: usize) -> f64 {
        self.slots[kernel.recorded[index].slot as usize]
    }

    /// Clears the trail, and specifies whether the next steps are recorded in it.
    pub(crate) fn record_trail(&mut self, is_enabled: bool) {
        self.trail.is_enabled = is_enabled;
        self.trail.volts.clear();
    }

    /// A recorded voltage at the end of one of the steps in the trail. It has the same bits as the kernel's own
    /// result. It is available only if [`SharedKernel::can_keep_trail`](super::SharedKernel::can_keep_trail).
    pub(crate) fn recorded_after(&self, kernel: &Kernel, step: u64, index: usize) -> f64 {
        let (at, line) = kernel.recorded[index]
            .tracks
            .expect("a trail is recorded only if every recorded voltage tracks a state");
        let volts = self.trail.volts[step as usize * kernel.tracked.len() + at];
        line.map_or(volts, |[constant, factor]| {
            // The kernel adds no constant if there is none, so a product of -0 keeps its sign.
            let is_none = kernel.number(constant) == Some(0.0);
            let addend = if is_none { -0.0 } else { self.slots[constant as usize] };
            multiply_add(self.slots[factor as usize], volts, addend)
        })
    }

    /// The extremes of a recorded voltage as (time, voltage), in order of time. The time is infinite if the extreme was
    /// kept ([`Frame::keep_extremes`]) and not exceeded since. `None` if the voltage is constant or linear in time.
    pub(crate) fn extremes(&self, kernel: &Kernel, index: usize) -> Option<[(f64, f64); 2]> {
        let (at, line) = kernel.recorded[index].tracks?;
        let Extremes { least, least_at, most, most_at } = &self.extremes;
        let [constant, factor] = line.map_or([0.0, 1.0], |line| line.map(|slot| self.slots[slot as usize]));
        let extreme = |times: &[f64], volts: &[f64]| (times[at], multiply_add(factor, volts[at], constant));
        let (first, second) = (extreme(least_at, least), extreme(most_at, most));
        Some(if first.0 <= second.0 { [first, second] } else { [second, first] })
    }

    /// Takes the last evaluation as the present.
    pub(crate) fn accept_present(&mut self) {
        let [.., rates] = &self.stages;
        self.rates.copy_from_slice(rates);
        self.present.copy_from_slice(&self.margins);
    }

    /// Clears the extremes.
    pub(crate) fn reset_extremes(&mut self) {
        self.extremes.forget();
    }

    /// Keeps the extremes, which are recorded. From now on only voltages beyond them get a time.
    pub(crate) fn keep_extremes(&mut self) {
        self.extremes.forget_times();
    }
}
