//! Builder methods for what an element stores from step to step: states, modes, delay lines, noise and sampled values.
//!
//! The output law of an element makes these, and its memory law sets their inputs. Each element has at most one state,
//! one delay line and one sampled value.

use super::Builder;
use crate::ir::{
    ChatterRemedy, Delay, Distribution, Guard, Level, Mode, ModeHandle, ModeNames, Noise, Op, PulseTrain,
    Pulses, Register, SampledValue, State, TimeConstant, Transition,
};
use crate::machines::REFERENCE;

/// Mode of an integrator between its limits. At a limit, the mode is the sign of the limit.
const FREE: f64 = 0.0;
/// The mode of an integrator at its limits.
const LIMIT: ModeNames =
    ModeNames { mode: "limit", values: &[(FREE, "free"), (1.0, "at the upper"), (-1.0, "at the lower")] };

impl dyn Builder + '_ {
    /// Adds a state to the current element. A setting is its initial voltage.
    pub fn new_state(&mut self, initial: &str) -> Register {
        let initial = self.required(initial);
        let draft = self.draft_mut();
        let (element, index, unset) = (draft.current, draft.program.lowered.states.len() as u32, Register(0));
        let state = State { element, rate: unset, demand: unset, limits: [unset; 2], initial, lag: None };
        draft.program.lowered_mut().states.push(state);
        draft.own_state.insert(element, index);
        self.emit(Op::State(index))
    }

    /// Index of the current element's state.
    pub(in crate::ir) fn own_state(&self) -> u32 {
        *self.draft().own_state.get(&self.draft().current).expect("the element's output law makes its state")
    }

    /// The output of the current element, for its memory law.
    pub fn own_output(&self) -> Register {
        self.draft().outputs[self.draft().current].expect("the output law comes before the memory law")
    }

    /// A setting that is the time constant of the current element's state. No step may be longer.
    pub fn time_constant(&mut self, name: &str) -> Register {
        let (time, problem_seconds) = (self.required(name), 1.0 / self.draft().program.lowered.time_scale);
        let index = self.own_state() as usize;
        self.draft_mut().program.lowered_mut().states[index].lag =
            Some(TimeConstant { time, problem_seconds });
        self.emit(Op::Coefficient(time))
    }

    /// Sets the rate of the current element's state, in volts per machine second.
    ///
    /// At ±100 V the state is held while its rate points outward. This is a mode of the element, so the solver locates
    /// the instants at which it begins and ends.
    pub fn set_rate(&mut self, rate: Register) {
        self.set_limited_rate(rate, [None, None]);
    }

    /// The same with a lower and an upper limit, which apply if they are within ±100 V.
    pub fn set_limited_rate(&mut self, rate: Register, [lower, upper]: [Option<Register>; 2]) {
        let demand = self.scaled(rate, self.draft().program.lowered.time_scale);
        let (held, zero, half) = (self.new_mode(LIMIT, FREE), self.constant(0.0), self.constant(0.5));
        let (least, most) = (self.constant(-REFERENCE), self.constant(REFERENCE));
        let lower = lower.map_or(least, |lower| self.maximum(lower, least));
        let upper = upper.map_or(most, |upper| self.minimum(upper, most));
        for (sign, limit) in [(1.0, upper), (-1.0, lower)] {
            self.limit(held, sign, limit, demand);
        }
        let size = self.absolute(held.value);
        let rate = self.select(size, half, zero, demand);
        let index = self.own_state() as usize;
        let state = &mut self.draft_mut().program.lowered_mut().states[index];
        (state.rate, state.demand, state.limits) = (rate, demand, [lower, upper]);
    }

    /// One of the two limits, by its sign. It takes effect when the state passes it from inside. It ends when the rate
    /// points inward or when something else sets the state to a value inside.
    fn limit(&mut self, held: ModeHandle, sign: f64, limit: Register, demand: Register) {
        let out = self.own_output();
        let (past, short) = (self.subtract(out, limit), self.subtract(limit, out));
        let (over, inside) = if sign > 0.0 { (past, short) } else { (short, past) };
        let inward = if sign > 0.0 { self.negate(demand) } else { demand };
        // While a limit holds the state and moves inward, the state moves with it.
        for from in [FREE, sign] {
            let meets = Transition::new(from, sign, Guard::passed(over)).reset(self, limit);
            self.transition(held, meets);
        }
        self.transition(held, Transition::new(sign, FREE, Guard::passed(inward)));
        self.transition(held, Transition::new(sign, FREE, Guard::passed(inside)));
    }

    /// Adds a mode to the current element. The names are for the reader of its law.
    pub fn new_mode(&mut self, names: ModeNames, initial: f64) -> ModeHandle {
        let is_drive = self.is_drive();
        let draft = self.draft_mut();
        let (element, index) = (draft.current, draft.program.lowered.modes.len() as u32);
        let (transitions, chatter_remedy) = (Vec::new(), ChatterRemedy::Input);
        draft.program.lowered_mut().modes.push(Mode {
            element,
            names,
            is_drive,
            initial,
            transitions,
            chatter_remedy,
        });
        let mode = ModeHandle { index, value: self.emit(Op::Mode(index)) };
        self.draft_mut().own_mode.entry(element).or_insert(mode);
        mode
    }

    /// Specifies the element's means against chatter of a mode, if it has any.
    pub fn chatter_remedy(&mut self, mode: ModeHandle, remedy: ChatterRemedy) {
        self.draft_mut().program.lowered_mut().modes[mode.index as usize].chatter_remedy = remedy;
    }

    /// The first mode of the current element.
    pub fn own_mode(&self) -> ModeHandle {
        *self.draft().own_mode.get(&self.draft().current).expect("the element's output law makes its mode")
    }

    /// Adds a transition to a mode. Earlier transitions have priority.
    pub fn transition(&mut self, mode: ModeHandle, transition: Transition) {
        self.draft_mut().program.lowered_mut().modes[mode.index as usize].transitions.push(transition);
    }

    /// Adds a delay line to the current element. Settings are its delay and its initial output.
    pub fn new_delay(&mut self, time: &str, initial: &str) -> Register {
        let (time, initial) = (self.required(time), self.required(initial));
        let draft = self.draft_mut();
        let (element, index, input) = (draft.current, draft.program.lowered.delays.len() as u32, Register(0));
        let problem_seconds = 1.0 / draft.program.lowered.time_scale;
        draft.program.lowered_mut().delays.push(Delay {
            element,
            input,
            upstream: Vec::new(),
            time,
            initial,
            problem_seconds,
        });
        draft.own_delay.insert(element, index);
        self.emit(Op::Delayed(index))
    }

    /// Adds a noise source to the current element: random numbers with mean 0 and variance 1, each constant for a
    /// time. Seed, time and distribution are settings.
    pub fn noise(&mut self, seed: &str, every: &str, distribution: &str) -> Register {
        let (seed, every) = (self.required(seed), self.required(every));
        let distribution = match self.choice(distribution) {
            "uniform" => Distribution::Uniform,
            _ => Distribution::Normal,
        };
        let element = self.draft().current;
        self.level(Level::Noise(Noise { element, seed, every, distribution }))
    }

    /// Adds pulses without beginning and end to the current element: 1 within a pulse, 0 outside. Settings are the
    /// frequency, the width of a pulse as a share of its period, and the phase at t = 0.
    pub fn pulse_wave(&mut self, frequency: &str, duty: &str, phase: &str) -> Register {
        let [frequency, duty, phase] = [frequency, duty, phase].map(|name| self.required(name));
        self.pulses(PulseTrain::Wave { frequency, duty, phase })
    }

    /// Adds one pulse to the current element, or pulses that repeat: 1 within a pulse, 0 outside. Settings are the
    /// beginning and the width of the first pulse, and the period. Without a period there is one pulse.
    pub fn pulse_train(&mut self, begin: &str, width: &str, period: &str) -> Register {
        let [begin, width] = [begin, width].map(|name| self.required(name));
        let period = self.coefficient(period);
        self.pulses(PulseTrain::Train { begin, width, period })
    }

    /// Adds a source of pulses to the current element.
    fn pulses(&mut self, train: PulseTrain<u32>) -> Register {
        let element = self.draft().current;
        self.level(Level::Pulses(Pulses { element, train }))
    }

    /// Adds a sampled value to the current element: it is constant within a step. A setting is its value in initial
    /// condition.
    pub fn new_sampled_value(&mut self, initial: &str) -> Register {
        let initial = self.required(initial);
        let draft = self.draft_mut();
        let (element, index) = (draft.current, draft.program.lowered.sampled.len() as u32);
        draft.program.lowered_mut().sampled.push(SampledValue {
            element,
            initial,
            next: Register(0),
            follows: None,
        });
        draft.own_sampled_value.insert(element, index);
        self.emit(Op::Sampled(index))
    }

    /// Specifies what the current element's sampled value becomes at the end of every step, and again after the
    /// changes of mode there.
    ///
    /// Sampling must not change this value: the body is not evaluated again afterwards.
    pub fn set_next_sample(&mut self, next: Register) {
        self.own_sampled_value().next = next;
    }

    /// Specifies the input whose turning points the current element's sampled value must not miss. A step ends at each
    /// turning point at which the sampled value changes.
    pub fn sample_turning_points_of(&mut self, input: Register) {
        self.own_sampled_value().follows = Some(input);
    }

    /// The sampled value of the current element.
    fn own_sampled_value(&mut self) -> &mut SampledValue {
        let index = *self
            .draft()
            .own_sampled_value
            .get(&self.draft().current)
            .expect("the element's output law makes its sampled value");
        &mut self.draft_mut().program.lowered_mut().sampled[index as usize]
    }

    /// Specifies the input of the current element's delay line.
    pub fn set_delay_input(&mut self, input: Register) {
        let index = *self
            .draft()
            .own_delay
            .get(&self.draft().current)
            .expect("the element's output law makes its delay line");
        self.draft_mut().program.lowered_mut().delays[index as usize].input = input;
    }
}
