//! Frames of one kernel side by side, a lane each, that go quiet steps together.

use std::mem;

use super::Kernel;
use super::frame::Frame;
use super::lane::{Abreast, Lane};

/// How many lanes there are.
pub const LANES: usize = 16;

/// Lanes of frames that stand at the same instant. What meets something leaves its lane for its own frame, and comes
/// back to it afterwards.
#[derive(Debug, Clone)]
pub(crate) struct Formation {
    pub(super) frame: Frame<Abreast<LANES>>,
}

impl Formation {
    /// One without lanes aboard.
    pub fn of(kernel: &Kernel) -> Self {
        let mut frame = kernel.frame();
        frame.aboard = 0;
        Formation { frame }
    }

    /// A bit for every lane aboard.
    pub fn aboard(&self) -> u64 {
        self.frame.aboard
    }

    /// When it is.
    pub fn time(&self) -> f64 {
        // All stand at the same instant, those that have left with them.
        self.frame.time.get(0)
    }

    /// A bit for every lane that met something in the step before which the others stopped.
    pub fn beyond(&self) -> u64 {
        self.frame.beyond
    }

    /// Puts a frame into its lane; all stand at the same instant.
    pub fn board(&mut self, kernel: &Kernel, lane: usize, one: &mut Frame<f64>) {
        let all = &mut self.frame;
        (all.time, all.aboard) = (Abreast::splat(one.time), all.aboard | 1 << lane);
        mem::swap(&mut all.lines[lane], &mut one.lines[0]);
        let standing = [0..kernel.layout.states, kernel.layout.kept..kernel.layout.results];
        for slots in standing {
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

    /// Takes a frame out of its lane, as it is at the beginning of the step looked at.
    pub fn leave(&mut self, kernel: &Kernel, lane: usize, one: &mut Frame<f64>) {
        let all = &mut self.frame;
        (one.time, all.aboard) = (all.time.get(lane), all.aboard & !(1 << lane));
        mem::swap(&mut all.lines[lane], &mut one.lines[0]);
        let kept = kernel.layout.kept..kernel.layout.levels;
        take(&all.slots[kept.clone()], lane, &mut one.slots[kept]);
        take(&all.states, lane, &mut one.states);
        take(&all.rates, lane, &mut one.rates);
        for (all, one) in all.extremes.parts().into_iter().zip(one.extremes.parts_mut()) {
            take(all, lane, one);
        }
    }

    /// Works everything out where it is.
    pub fn work_out(&mut self, kernel: &Kernel, tables: &[Vec<[f64; 2]>]) {
        kernel.show(&mut self.frame, tables);
    }

    /// Shows a frame when its lane is, and what is recorded as it was worked out last.
    pub fn show(&self, kernel: &Kernel, lane: usize, one: &mut Frame<f64>) {
        one.time = self.frame.time.get(lane);
        for seen in &kernel.seen {
            let slot = seen.slot as usize;
            one.slots[slot] = self.frame.slots[slot].get(lane);
        }
    }

    /// Takes the step in which some met something, or the piece of it; these have left. Tells whether all have come to the
    /// end of the step at a time: others may meet something in the rest of it.
    pub fn go_without(&mut self, kernel: &Kernel, tables: &[Vec<[f64; 2]>], end: f64) -> bool {
        kernel.go_on(&mut self.frame, tables, end)
    }

    /// Sets states that are smaller than something to 0.
    pub fn without_dust(&mut self, smallest: f64) {
        let [zero, smallest] = [0.0, smallest].map(Abreast::splat);
        for state in &mut self.frame.states {
            *state = Abreast::select_below(state.absolute(), smallest, zero, *state);
        }
    }
}

fn put<V: Lane>(all: &mut [V], lane: usize, one: &[f64]) {
    all.iter_mut().zip(one).for_each(|(all, one)| all.set(lane, *one));
}

fn take<V: Lane>(all: &[V], lane: usize, one: &mut [f64]) {
    all.iter().zip(one).for_each(|(all, one)| *one = all.get(lane));
}
