//! What a kernel runs on.

use super::known::Known;
use super::lane::Lane;
use super::rows::Rows;
use super::schedules::Schedule;
use super::{Kernel, Layout};
use crate::delay_line::DelayLine;

/// The numbers of a kernel that runs.
#[derive(Debug, Clone)]
pub(crate) struct Frame<V> {
    /// Factors, what is given, results.
    pub(super) slots: Vec<V>,
    /// When it is: in all lanes the same but within a step that is gone in pieces.
    pub time: V,
    /// The states of now, and their rates.
    pub states: Vec<V>,
    pub rates: Vec<V>,
    /// The last stretch that was gone alone.
    pub(super) last: Stretch<V>,
    /// The rates of the stages, and at the end of the step looked at.
    pub(super) stages: [Vec<V>; 4],
    /// What is left of every watch, slope x voltage + room, at the present.
    pub(super) present: Vec<V>,
    /// The same at the end of the step looked at.
    pub(super) rests: Vec<V>,
    /// What is given of the corners: on which side voltages are.
    pub(super) given: Vec<f64>,
    /// What followed from the sides on which voltages were before.
    pub(super) known: Vec<Known>,
    /// Room for the operations of the prologue.
    pub(super) early: Vec<f64>,
    /// Slope and room of every watch.
    pub(super) slopes: Vec<V>,
    pub(super) rooms: Vec<V>,
    /// Between which numbers the voltage of every fence must stay.
    pub(super) lows: Vec<V>,
    pub(super) highs: Vec<V>,
    /// What was seen of the voltages that are followed.
    pub(super) extremes: Extremes<V>,
    /// Room for blocks of steps that native code goes blindly; nothing where none does.
    pub(super) rows: Rows,
    /// What was remembered of the steps gone last.
    pub(super) trail: Trail,
    /// The tables that are looked up at time itself.
    pub(super) schedules: Vec<Schedule>,
    /// What they give in the middle of a look of native code, and at its end.
    pub(super) ahead: Vec<f64>,
    /// The delay lines of every lane.
    pub lines: Vec<Vec<DelayLine>>,
    /// A bit for every lane that counts: what is met in others is not looked at.
    pub(super) aboard: u64,
    /// A bit for every lane in which something was met at the end of quiet steps.
    pub(super) beyond: u64,
}

/// The ends of a stretch, and what stood where it began.
#[derive(Debug, Clone)]
pub(super) struct Stretch<V> {
    pub begin: f64,
    pub end: f64,
    pub states: Vec<V>,
    pub rates: Vec<V>,
}

/// The voltages that are followed, at the ends of steps one after the other.
#[derive(Debug, Clone, Default)]
pub(super) struct Trail {
    pub is_kept: bool,
    pub volts: Vec<f64>,
}

/// The least and the largest of voltages, and when each was met first.
#[derive(Debug, Clone)]
pub(super) struct Extremes<V> {
    pub least: Vec<V>,
    pub least_at: Vec<V>,
    pub most: Vec<V>,
    pub most_at: Vec<V>,
}

impl Kernel {
    /// A frame without numbers.
    pub fn frame<V: Lane>(&self) -> Frame<V> {
        let zeros = |count: usize| vec![V::splat(0.0); count];
        let states = self.rates.len();
        Frame {
            slots: zeros(self.layout.all),
            time: V::splat(0.0),
            states: zeros(states),
            rates: zeros(states),
            last: Stretch { begin: 0.0, end: 0.0, states: zeros(states), rates: zeros(states) },
            stages: std::array::from_fn(|_| zeros(states)),
            present: zeros(self.watches.len()),
            rests: zeros(self.watches.len()),
            given: vec![0.0; self.given],
            known: Vec::new(),
            early: Vec::with_capacity(self.early.len()),
            slopes: zeros(self.watches.len()),
            rooms: zeros(self.watches.len()),
            lows: zeros(self.fences.len()),
            highs: zeros(self.fences.len()),
            extremes: Extremes::of(self.followed.len()),
            rows: Rows::default(),
            trail: Trail::default(),
            schedules: self.scheduled.iter().copied().map(Schedule::of).collect(),
            ahead: vec![0.0; 2 * self.scheduled.len()],
            lines: vec![Vec::new(); V::COUNT],
            aboard: 1,
            beyond: 0,
        }
    }

    /// Works everything out where the frame is.
    pub fn show<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>]) {
        self.stay(frame, tables);
        self.work_out(frame, tables);
    }

    /// What is worked out next is worked out where the frame is.
    pub fn stay<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>]) {
        frame.slots[self.layout.states..self.layout.time].copy_from_slice(&frame.states);
        self.put_instant(frame, tables, frame.time, DelayLine::next_from);
    }

    /// When the last stretch that was gone alone began, and how long it was. It ends where the frame is.
    pub fn last_stretch(&self, frame: &Frame<f64>) -> [f64; 2] {
        debug_assert_eq!(frame.last.end, frame.time, "nothing is looked back into but the last stretch");
        [frame.last.begin, frame.last.end - frame.last.begin]
    }

    /// What is worked out next is worked out at an instant within that stretch, on the cubic through states and rates at its
    /// ends, whose shares are given.
    pub fn go_back(
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
        self.put_instant(frame, tables, time, DelayLine::next_until);
    }
}

impl<V: Lane> Extremes<V> {
    /// Of so many voltages that were never seen.
    fn of(count: usize) -> Self {
        let [least, most] = [f64::INFINITY, f64::NEG_INFINITY].map(|value| vec![V::splat(value); count]);
        Extremes { least_at: least.clone(), most_at: least.clone(), least, most }
    }

    pub(super) fn parts(&self) -> [&[V]; 4] {
        [&self.least, &self.least_at, &self.most, &self.most_at]
    }

    pub(super) fn parts_mut(&mut self) -> [&mut [V]; 4] {
        [&mut self.least, &mut self.least_at, &mut self.most, &mut self.most_at]
    }

    fn forget(&mut self) {
        for all in [&mut self.least, &mut self.least_at, &mut self.most_at] {
            all.fill(V::splat(f64::INFINITY));
        }
        self.most.fill(V::splat(f64::NEG_INFINITY));
    }
}

impl Frame<f64> {
    /// Puts in what does not move within a step: kept values and levels.
    pub fn put_standing(&mut self, kernel: &Kernel, kept: &[f64], levels: &[f64]) {
        let Layout { kept: first, levels: second, .. } = kernel.layout;
        for (first, values) in [(first, kept), (second, levels)] {
            self.slots[first..first + values.len()].copy_from_slice(values);
        }
    }

    /// The kept values.
    pub fn kept(&self, kernel: &Kernel) -> &[f64] {
        &self.slots[kernel.layout.kept..kernel.layout.levels]
    }

    /// A voltage that is recorded, as it was worked out last.
    pub fn last_seen(&self, kernel: &Kernel, index: usize) -> f64 {
        self.slots[kernel.seen[index].slot as usize]
    }

    /// What was remembered is forgotten, and the steps to come are, or are not.
    pub fn remember(&mut self, is_kept: bool) {
        self.trail.is_kept = is_kept;
        self.trail.volts.clear();
    }

    /// A voltage that is recorded, at the end of one of the steps that are remembered: what its kernel works out there, where that
    /// [`Folded::remembers`](super::Folded::remembers).
    pub fn seen_after(&self, kernel: &Kernel, step: u64, index: usize) -> f64 {
        let (at, line) = kernel.seen[index].follows.expect("what is remembered follows states");
        let volts = self.trail.volts[step as usize * kernel.followed.len() + at];
        line.map_or(volts, |[constant, factor]| {
            // A kernel adds no constant where there is none: a product of zero keeps its sign.
            let is_none = kernel.number(constant) == Some(0.0);
            let addend = if is_none { -0.0 } else { self.slots[constant as usize] };
            self.slots[factor as usize].mul_add(volts, addend)
        })
    }

    /// The least and the largest of a recorded voltage with their instants, in the order in which they were met; none of
    /// one that cannot turn.
    pub fn extremes(&self, kernel: &Kernel, index: usize) -> Option<[(f64, f64); 2]> {
        let (at, line) = kernel.seen[index].follows?;
        let Extremes { least, least_at, most, most_at } = &self.extremes;
        let [constant, factor] = line.map_or([0.0, 1.0], |line| line.map(|slot| self.slots[slot as usize]));
        let met = |times: &[f64], volts: &[f64]| (times[at], factor.mul_add(volts[at], constant));
        let (first, second) = (met(least_at, least), met(most_at, most));
        Some(if first.0 <= second.0 { [first, second] } else { [second, first] })
    }

    /// Takes what was worked out last, no step away, as the present.
    pub fn stand(&mut self) {
        let [.., rates] = &self.stages;
        self.rates.copy_from_slice(rates);
        self.present.copy_from_slice(&self.rests);
    }

    /// Forgets what was seen.
    pub fn see_anew(&mut self) {
        self.extremes.forget();
    }
}
