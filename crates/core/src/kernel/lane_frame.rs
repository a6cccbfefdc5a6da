//! Frames of several runs with the same kernel, one lane each, that step together.

use std::mem;

use super::Kernel;
use super::frame::Frame;
use super::lane::{Lane, Lanes};

/// The number of lanes. Sixteen doubles fill two of the widest vector registers.
///
/// # Examples
///
/// ```
/// use patchcord_core::solve::LANES;
///
/// // The runs of a batch are computed in groups of this size.
/// assert_eq!(40_usize.div_ceil(LANES), 3);
/// ```
pub const LANES: usize = 16;

/// The lanes of several frames at the same instant. A frame in which a watch is hit leaves its lane, and returns to it
/// after the event.
#[derive(Debug, Clone)]
pub(crate) struct LaneFrame {
    /// The frame of all lanes. Values of inactive lanes are computed as well, and ignored.
    pub(super) frame: Frame<Lanes<LANES>>,
}

impl LaneFrame {
    /// A lane frame without active lanes.
    pub(crate) fn of(kernel: &Kernel) -> Self {
        let mut frame = kernel.frame();
        frame.active_lanes = 0;
        LaneFrame { frame }
    }

    /// One bit for every active lane.
    pub(crate) fn active_lanes(&self) -> u64 {
        self.frame.active_lanes
    }

    /// The time of all lanes, in problem seconds.
    pub(crate) fn time(&self) -> f64 {
        // All lanes have the same time, including the inactive ones.
        self.frame.time.get(0)
    }

    /// One bit for every lane in which a watch was hit in the step at which the others stopped.
    pub(crate) fn hit_lanes(&self) -> u64 {
        self.frame.hit_lanes
    }

    /// Copies a frame into a lane. All active lanes must have the same time.
    pub(crate) fn load_lane(&mut self, kernel: &Kernel, lane: usize, one: &mut Frame<f64>) {
        let all = &mut self.frame;
        (all.time, all.active_lanes) = (Lanes::splat(one.time), all.active_lanes | 1 << lane);
        mem::swap(&mut all.lines[lane], &mut one.lines[0]);
        let held_inputs = [0..kernel.layout.states, kernel.layout.sampled..kernel.layout.results];
        for slots in held_inputs {
            put(&mut all.slots[slots.clone()], lane, &one.slots[slots]);
        }
        put(&mut all.states, lane, &one.states);
        put(&mut all.rates, lane, &one.rates);
        put(&mut all.lows, lane, &one.lows);
        put(&mut all.highs, lane, &one.highs);
        for (all, one) in all.extremes.parts_mut().into_iter().zip(one.extremes.parts()) {
            put(all, lane, one);
        }
    }

    /// Copies a lane back into its frame, in its state at the beginning of the step.
    pub(crate) fn unload_lane(&mut self, kernel: &Kernel, lane: usize, one: &mut Frame<f64>) {
        let all = &mut self.frame;
        (one.time, all.active_lanes) = (all.time.get(lane), all.active_lanes & !(1 << lane));
        mem::swap(&mut all.lines[lane], &mut one.lines[0]);
        let sampled = kernel.layout.sampled..kernel.layout.levels;
        take(&all.slots[sampled.clone()], lane, &mut one.slots[sampled]);
        take(&all.states, lane, &mut one.states);
        take(&all.rates, lane, &mut one.rates);
        for (all, one) in all.extremes.parts().into_iter().zip(one.extremes.parts_mut()) {
            take(all, lane, one);
        }
    }

    /// Evaluates everything at the present states and time.
    pub(crate) fn evaluate(&mut self, kernel: &Kernel, tables: &[Vec<[f64; 2]>]) {
        kernel.evaluate_present(&mut self.frame, tables);
    }

    /// Copies the time and the recorded voltages of the last evaluation from a lane into its frame.
    pub(crate) fn export(&self, kernel: &Kernel, lane: usize, one: &mut Frame<f64>) {
        one.time = self.frame.time.get(lane);
        for recorded in &kernel.recorded {
            let slot = recorded.slot as usize;
            one.slots[slot] = self.frame.slots[slot].get(lane);
        }
    }

    /// Completes the step in which a watch was hit, after the affected lanes have left. Returns whether all others
    /// reached its end. If not, further watches are hit in the rest of the step.
    pub(crate) fn finish_step(&mut self, kernel: &Kernel, tables: &[Vec<[f64; 2]>], end: f64) -> bool {
        kernel.finish_step(&mut self.frame, tables, end)
    }

    /// Sets states whose absolute value is below `smallest` to 0. Denormal numbers would slow down every operation.
    pub(crate) fn flush_tiny_states(&mut self, smallest: f64) {
        let [zero, smallest] = [0.0, smallest].map(Lanes::splat);
        for state in &mut self.frame.states {
            *state = Lanes::select_below(state.absolute(), smallest, zero, *state);
        }
    }
}

/// Writes the numbers of one frame into a lane.
fn put<V: Lane>(all: &mut [V], lane: usize, one: &[f64]) {
    all.iter_mut().zip(one).for_each(|(all, one)| all.set(lane, *one));
}

/// Reads the numbers of a lane into one frame.
fn take<V: Lane>(all: &[V], lane: usize, one: &mut [f64]) {
    all.iter().zip(one).for_each(|(all, one)| *one = all.get(lane));
}
