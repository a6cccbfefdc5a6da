//! What a kernel runs on, and its steps.

use pulp::{Arch, NullaryFnOnce};

use super::lane::Lane;
use super::{Kernel, Layout, Watched};
use crate::grid::Grid;
use crate::program::{ON_THE_KINK, next_corner};

/// The numbers of a kernel that runs.
#[derive(Debug, Clone)]
pub(crate) struct Frame<V> {
    /// Factors, what is given, results.
    pub(super) slots: Vec<V>,
    pub time: f64,
    /// The states of now, and their rates.
    pub states: Vec<V>,
    pub rates: Vec<V>,
    /// Where the last stretch that was gone alone began.
    last: Stretch<V>,
    /// The rates of the stages, and at the end of the step looked at.
    pub(super) stages: [Vec<V>; 4],
    /// What is left of every watch, slope x voltage + room, at the present.
    present: Vec<V>,
    /// The same at the end of the step looked at.
    pub(super) rests: Vec<V>,
    /// Slope and room of every watch.
    pub(super) slopes: Vec<V>,
    pub(super) rooms: Vec<V>,
    /// What was seen of every voltage that is recorded.
    pub(super) extremes: Extremes<V>,
}

/// The beginning of a stretch.
#[derive(Debug, Clone)]
struct Stretch<V> {
    time: f64,
    states: Vec<V>,
    rates: Vec<V>,
}

/// The least and the largest of every recorded voltage, and when each was met first.
#[derive(Debug, Clone)]
pub(super) struct Extremes<V> {
    pub least: Vec<V>,
    pub least_at: Vec<V>,
    pub most: Vec<V>,
    pub most_at: Vec<V>,
}

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

/// Something met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Met {
    /// Index of the watch.
    watch: usize,
    /// What is left of the watch where it is met.
    rest: f64,
    /// Whether it is a corner, and the kernel still holds beyond it.
    pub is_corner: bool,
}

impl Kernel {
    /// Looks ahead by a step of this length that ends at a time: states, their rates and what is watched at its end.
    #[inline(always)]
    fn look<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], length: f64, end: f64) -> Look {
        let (whole, half) = (V::splat(length), V::splat(0.5 * length));
        let middle = frame.time + 0.5 * length;
        self.stage(frame, tables, 0, half, middle);
        self.stage(frame, tables, 1, half, middle);
        self.middle.run(&mut frame.slots, tables);
        let quiet_within = self.is_quiet(frame, self.watched_in_middle);
        self.stage(frame, tables, 2, whole, end);
        let sixth = V::splat(length / 6.0);
        let two = V::splat(2.0);
        for state in 0..frame.states.len() {
            let [second, third, fourth] = [0, 1, 2].map(|stage| frame.stages[stage][state]);
            let inner = second.add(third);
            let outer = frame.rates[state].add(fourth);
            let rate = inner.multiply_add(two, outer);
            // Rounded before it is added: straight lines stay exact.
            frame.slots[self.layout.states + state] = frame.states[state].add(rate.multiply(sixth));
        }
        self.moving.run(&mut frame.slots, tables);
        self.keep(frame, 3);
        self.middle.run(&mut frame.slots, tables);
        self.ending.run(&mut frame.slots, tables);
        if !self.is_quiet(frame, self.watches.len()) {
            Look::Ahead
        } else if quiet_within {
            Look::Quiet
        } else {
            Look::Within
        }
    }

    #[inline(always)]
    fn stage<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        tables: &[Vec<[f64; 2]>],
        stage: usize,
        length: V,
        time: f64,
    ) {
        let from = if stage == 0 { &frame.rates } else { &frame.stages[stage - 1] };
        let states = &mut frame.slots[self.layout.states..self.layout.time];
        for ((trial, state), rate) in states.iter_mut().zip(&frame.states).zip(from) {
            *trial = rate.multiply_add(length, *state);
        }
        frame.slots[self.layout.time] = V::splat(time);
        self.moving.run(&mut frame.slots, tables);
        self.keep(frame, stage);
    }

    #[inline(always)]
    fn keep<V: Lane>(&self, frame: &mut Frame<V>, stage: usize) {
        for (rate, slot) in frame.stages[stage].iter_mut().zip(&self.rates) {
            *rate = frame.slots[*slot as usize];
        }
    }

    /// Works out what is left of the first watches, and tells whether that is nowhere below 0.
    #[inline(always)]
    fn is_quiet<V: Lane>(&self, frame: &mut Frame<V>, watches: usize) -> bool {
        let lines = frame.slopes.iter().zip(&frame.rooms).zip(&mut frame.rests);
        let all = self.watches[..watches].iter().zip(lines);
        let zero = V::splat(0.0);
        all.fold(true, |quiet, (watch, ((slope, room), rest))| {
            *rest = watch.value(&frame.slots).multiply_add(*slope, *room);
            quiet & rest.reaches(zero)
        })
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

    /// Sees the voltages that are recorded at the step looked at, which ends at a time.
    #[inline(always)]
    fn see<V: Lane>(&self, frame: &mut Frame<V>, time: f64) {
        let now = V::splat(time);
        let Extremes { least, least_at, most, most_at } = &mut frame.extremes;
        for (index, seen) in self.turning.iter().enumerate() {
            let value = frame.slots[self.seen[*seen] as usize];
            least_at[index] = V::select_below(value, least[index], now, least_at[index]);
            least[index] = V::select_below(value, least[index], value, least[index]);
            most_at[index] = V::select_below(most[index], value, now, most_at[index]);
            most[index] = V::select_below(most[index], value, value, most[index]);
        }
    }

    /// Goes so many steps of a grid from one of its instants, as long as nothing is met: how many were gone.
    #[inline(always)]
    fn all_steps<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], grid: &Steps) -> u64 {
        for step in 0..grid.count {
            let end = grid.end_of(step);
            let length = end - frame.time;
            if self.look(frame, tables, length, end) != Look::Quiet {
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

    /// Looks ahead by a step of this length.
    pub fn look_ahead<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], length: f64) -> Look {
        Arch::new().dispatch(OneLook { kernel: self, frame, tables, length })
    }

    /// Makes the step looked at, which ends at a time, the present.
    pub fn take<V: Lane>(&self, frame: &mut Frame<V>, time: f64) {
        frame.last.time = frame.time;
        frame.last.states.copy_from_slice(&frame.states);
        frame.last.rates.copy_from_slice(&frame.rates);
        frame.present.copy_from_slice(&frame.rests);
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

struct OneLook<'a, V> {
    kernel: &'a Kernel,
    frame: &'a mut Frame<V>,
    tables: &'a [Vec<[f64; 2]>],
    length: f64,
}

impl<V: Lane> NullaryFnOnce for OneLook<'_, V> {
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
        (self.grid.steps_in((time - self.begin).max(0.0)) + 1).saturating_sub(self.first).min(self.count)
    }

    /// How many end earlier than a time by some room.
    pub fn before(&self, time: f64, room: f64) -> u64 {
        let some = self.until(time);
        if some > 0 && self.end_of(some - 1) >= time - room { some - 1 } else { some }
    }
}

/// What is done with one lane.
impl Kernel {
    /// A frame without numbers.
    pub fn frame<V: Lane>(&self) -> Frame<V> {
        let zeros = |count: usize| vec![V::splat(0.0); count];
        let states = self.rates.len();
        Frame {
            slots: zeros(self.layout.all),
            time: 0.0,
            states: zeros(states),
            rates: zeros(states),
            last: Stretch { time: 0.0, states: zeros(states), rates: zeros(states) },
            stages: std::array::from_fn(|_| zeros(states)),
            present: zeros(self.watches.len()),
            rests: zeros(self.watches.len()),
            slopes: zeros(self.watches.len()),
            rooms: zeros(self.watches.len()),
            extremes: Extremes::of(self.turning.len()),
        }
    }

    /// Works everything out where the frame is.
    pub fn show<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>]) {
        let states = self.layout.states..self.layout.time;
        frame.slots[states].copy_from_slice(&frame.states);
        self.run_all(frame, tables, frame.time);
    }

    /// When the last stretch that was gone alone began, and how long it was.
    pub fn last_stretch<V: Lane>(&self, frame: &Frame<V>) -> [f64; 2] {
        [frame.last.time, frame.time - frame.last.time]
    }

    /// Works everything out at an instant within that stretch, by the cubic through states and rates at its ends, whose
    /// shares are given.
    pub fn look_back<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        tables: &[Vec<[f64; 2]>],
        time: f64,
        [states, rates]: [[f64; 2]; 2],
    ) {
        let [states, rates] = [states, rates].map(|shares| shares.map(V::splat));
        for index in 0..frame.states.len() {
            let last = &frame.last;
            let begin = last.states[index].multiply(states[0]).add(last.rates[index].multiply(rates[0]));
            let end = frame.states[index].multiply(states[1]).add(frame.rates[index].multiply(rates[1]));
            frame.slots[self.layout.states + index] = begin.add(end);
        }
        self.run_all(frame, tables, time);
    }

    fn run_all<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], time: f64) {
        frame.slots[self.layout.time] = V::splat(time);
        for code in [&self.moving, &self.middle, &self.ending] {
            code.run(&mut frame.slots, tables);
        }
    }

    /// Works out what is watched where the frame is, and binds it: corners keep the side on which they are. Tells
    /// nothing where a bound does not hold, else whether every corner is on one side.
    pub fn bind<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], lane: usize) -> Option<bool> {
        self.show(frame, tables);
        (0..self.watches.len()).try_fold(true, |all, watch| {
            let value = self.watches[watch].value(&frame.slots).get(lane);
            let [slope, room] = match self.watches[watch].what {
                Watched::Corner => side_of_zero(value),
                Watched::Points { table, above } => beside_corner(&tables[table as usize], value, above),
                Watched::Above(slot) => [1.0, -frame.slots[slot as usize].get(lane)],
                Watched::Below(slot) | Watched::Size(slot) => [-1.0, frame.slots[slot as usize].get(lane)],
            };
            frame.slopes[watch].set(lane, slope);
            frame.rooms[watch].set(lane, room);
            (slope * value + room >= 0.0).then_some(all && slope != 0.0)
        })
    }

    /// What was met on the way to what was looked at: a corner last, as at some of them something changes too.
    pub fn met<V: Lane>(&self, frame: &Frame<V>, lane: usize) -> Option<Met> {
        // What is no number holds nothing.
        let holds = |watch: &usize| frame.rests[*watch].get(lane) >= 0.0;
        let mut short = (0..frame.rests.len()).filter(|watch| !holds(watch));
        let first = short.next()?;
        let watch = if self.is_corner(first) {
            short.find(|watch| !self.is_corner(*watch)).unwrap_or(first)
        } else {
            first
        };
        let is_corner = self.is_corner(watch);
        Some(Met { watch, rest: if is_corner { ON_THE_KINK } else { 0.0 }, is_corner })
    }

    fn is_corner(&self, watch: usize) -> bool {
        matches!(self.watches[watch].what, Watched::Corner | Watched::Points { .. })
    }

    /// How far past it what was looked at is; negative before it.
    pub fn excess<V: Lane>(&self, frame: &Frame<V>, lane: usize, met: Met) -> f64 {
        met.rest - frame.rests[met.watch].get(lane)
    }

    /// The same of the present.
    pub fn excess_now<V: Lane>(&self, frame: &Frame<V>, lane: usize, met: Met) -> f64 {
        met.rest - frame.present[met.watch].get(lane)
    }

    /// Goes over to the other side of a corner on which the frame is.
    pub fn cross<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], lane: usize, met: Met) {
        let [slope, room] = [&frame.slopes, &frame.rooms].map(|line| line[met.watch].get(lane));
        let value = (frame.present[met.watch].get(lane) - room) / slope;
        let mut set = |watch: usize, [slope, room]: [f64; 2]| {
            frame.slopes[watch].set(lane, slope);
            frame.rooms[watch].set(lane, room);
            frame.present[watch].set(lane, value.mul_add(slope, room));
        };
        match self.watches[met.watch].what {
            Watched::Points { table, above } => {
                let inside = value - 10.0 * slope * ON_THE_KINK;
                let lower = met.watch - usize::from(above);
                for above in [false, true] {
                    let side = beside_corner(&tables[table as usize], inside, above);
                    set(lower + usize::from(above), side);
                }
            }
            _ => set(met.watch, [-slope, ON_THE_KINK]),
        }
    }
}

/// Slope and room of a voltage that must not pass 0; it may while it is there.
fn side_of_zero(value: f64) -> [f64; 2] {
    if value.abs() > ON_THE_KINK { [value.signum(), ON_THE_KINK] } else { ANYWHERE }
}

/// Slope and room of a place that must not pass the next corner below or above it; it may while it is at one.
fn beside_corner(points: &[[f64; 2]], place: f64, above: bool) -> [f64; 2] {
    let sides = [-2.0, 2.0].map(|side| next_corner(points, place + side * ON_THE_KINK, above));
    match sides {
        [before, after] if before != after => ANYWHERE,
        [Some(corner), _] if above => [-1.0, corner + ON_THE_KINK],
        [Some(corner), _] => [1.0, ON_THE_KINK - corner],
        [None, _] => [1.0, f64::INFINITY],
    }
}

/// Slope and room of what is not watched.
const ANYWHERE: [f64; 2] = [0.0, ON_THE_KINK];

impl super::Watch {
    #[inline(always)]
    fn value<V: Lane>(&self, slots: &[V]) -> V {
        let value = slots[self.slot as usize];
        if matches!(self.what, Watched::Size(_)) { value.absolute() } else { value }
    }
}

impl<V: Lane> Extremes<V> {
    /// Of so many voltages that were never seen.
    fn of(count: usize) -> Self {
        let [least, most] = [f64::INFINITY, f64::NEG_INFINITY].map(|value| vec![V::splat(value); count]);
        Extremes { least_at: least.clone(), most_at: least.clone(), least, most }
    }

    fn forget(&mut self) {
        for all in [&mut self.least, &mut self.least_at, &mut self.most_at] {
            all.fill(V::splat(f64::INFINITY));
        }
        self.most.fill(V::splat(f64::NEG_INFINITY));
    }

    fn in_order(&self, index: usize, lane: usize) -> [(f64, f64); 2] {
        let [least, least_at, most, most_at] =
            [&self.least, &self.least_at, &self.most, &self.most_at].map(|all| all[index].get(lane));
        let (least, most) = ((least_at, least), (most_at, most));
        if least_at <= most_at { [least, most] } else { [most, least] }
    }
}

impl<V: Lane> Frame<V> {
    /// Puts the factors of a lane in.
    pub fn put_factors(&mut self, lane: usize, factors: &[f64]) {
        self.slots.iter_mut().zip(factors).for_each(|(slot, factor)| slot.set(lane, *factor));
    }

    /// Puts in what does not move within a step: kept values and noise.
    pub fn put_standing(&mut self, kernel: &Kernel, lane: usize, kept: &[f64], noise: &[f64]) {
        let Layout { kept: first, noise: second, .. } = kernel.layout;
        for (first, values) in [(first, kept), (second, noise)] {
            let slots = &mut self.slots[first..first + values.len()];
            slots.iter_mut().zip(values).for_each(|(slot, value)| slot.set(lane, *value));
        }
    }

    /// The kept values of a lane.
    pub fn kept(&self, kernel: &Kernel, lane: usize) -> impl Iterator<Item = f64> + '_ {
        self.slots[kernel.layout.kept..kernel.layout.noise].iter().map(move |slot| slot.get(lane))
    }

    /// A voltage that is recorded, as it was at what was looked at last.
    pub fn last_seen(&self, kernel: &Kernel, index: usize, lane: usize) -> f64 {
        self.slots[kernel.seen[index] as usize].get(lane)
    }

    /// The least and the largest of a recorded voltage with their instants, in the order in which they were met; none of
    /// one that did not turn.
    pub fn extremes(&self, kernel: &Kernel, index: usize, lane: usize) -> Option<[(f64, f64); 2]> {
        let place = kernel.turning.iter().position(|turning| *turning == index)?;
        Some(self.extremes.in_order(place, lane))
    }

    /// Takes what was looked at, no step away, as the present.
    pub fn stand(&mut self) {
        self.present.copy_from_slice(&self.rests);
    }

    /// Whether every corner is on one side.
    pub fn is_decided(&self) -> bool {
        self.slopes.iter().all(|slope| slope.get(0) != 0.0)
    }

    /// Forgets what was seen.
    pub fn see_anew(&mut self) {
        self.extremes.forget();
    }
}
