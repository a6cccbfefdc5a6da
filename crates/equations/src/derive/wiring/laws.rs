//! The laws of everything that lasts: states, delays, stored values, sources and modes.

use patchcord_core::ir::{Level, Op, PulseTrain};
use patchcord_expr::Function;

use super::super::system::{Law, LawKind, Source, TransitionLaw};
use super::{Derivation, Wiring};
use crate::symbolic::{Fraction, call, step};

impl Derivation<'_> {
    /// Adds the laws of everything that lasts: states, delays, stored values, levels, modes and tables; and the
    /// signals that read an output under another name.
    pub(super) fn finish(mut self) -> Wiring {
        self.other_signals();
        self.states();
        self.delays();
        self.margins();
        self.levels();
        self.transitions();
        self.wiring
    }

    /// Defines the signals whose output has another name.
    fn other_signals(&mut self) {
        for signal in self.program.signals().iter().filter(|signal| signal.is_named) {
            let own = self.wiring.names.get(&signal.register);
            if own.is_some_and(|output| self.wiring.system.symbols.entry(output.symbol).name == signal.name) {
                continue;
            }
            let value = self.value(signal.register).times(&self.per_volt(signal));
            let of = self.wiring.system.symbols.variable(&signal.name, 0, signal.dimension);
            self.wiring.system.laws.push(Law { of, kind: LawKind::Definition(value) });
        }
    }

    /// Adds the laws of the states.
    fn states(&mut self) {
        for state in self.program.state_laws() {
            let output = self.wiring.names[&self.output(state.element).1].clone();
            let in_unit = |volts: Fraction| volts.times(&output.per_volt);
            let [lower, upper] = state.limits.map(|limit| self.value(limit));
            let is_amplifier = |limit: &Fraction, sign: i64| *limit == Fraction::whole(sign * 100);
            let lower = (!is_amplifier(&lower, -1)).then(|| in_unit(lower));
            let upper = (!is_amplifier(&upper, 1)).then(|| in_unit(upper));
            let rate = in_unit(self.value(state.demand));
            let initial = in_unit(self.coefficients[state.initial as usize].clone());
            let kind = LawKind::State { rate, initial, limits: [lower, upper] };
            self.wiring.system.laws.push(Law { of: output.symbol, kind });
        }
    }

    /// Adds the laws of delay lines and stored values.
    fn delays(&mut self) {
        for delay in self.program.delays() {
            let output = self.wiring.names[&self.output(delay.element).1].clone();
            let seconds = Fraction::number(delay.problem_seconds);
            let kind = LawKind::Delay {
                input: self.value(delay.input).times(&output.per_volt),
                time: self.coefficients[delay.time as usize].times(&seconds),
                initial: self.coefficients[delay.initial as usize].times(&output.per_volt),
            };
            self.wiring.system.laws.push(Law { of: output.symbol, kind });
        }
        for (index, sampled) in self.program.sampled_values().iter().enumerate() {
            let next = self.value(sampled.next);
            let initial = self.coefficients[sampled.initial as usize].clone();
            let kind = LawKind::Stored { next, initial };
            self.wiring.system.laws.push(Law { of: self.wiring.sampled[index], kind });
        }
    }

    /// Lists by how much the inputs of squaring networks and logarithms are within their range.
    fn margins(&mut self) {
        for register in &self.ranged {
            if let Op::Maximum(input, least) = self.program.body()[register.index()] {
                let margin = self.value(input).minus(&self.value(least));
                self.wiring.system.margins.push(margin);
            }
        }
    }

    /// Adds the laws of noise, pulses and stepped tables.
    fn levels(&mut self) {
        for (index, level) in self.program.levels().iter().enumerate() {
            let source = match level {
                Level::Noise(_) => Source::Noise,
                Level::Points { table } => Source::Steps(*table),
                Level::Pulses(pulses) => Source::Pulses(self.pulses(pulses.train)),
            };
            let law = Law { of: self.wiring.levels[index], kind: LawKind::Source(source) };
            self.wiring.system.laws.push(law);
        }
    }

    /// Pulses as a law of time: 1 within a pulse, 0 outside.
    fn pulses(&self, train: PulseTrain<u32>) -> Fraction {
        let setting = |index: u32| self.coefficients[index as usize].clone();
        let time = Fraction::symbol(self.wiring.time);
        let fraction = |turns: &Fraction| turns.minus(&call(Function::Floor, turns, turns));
        let one = Fraction::whole(1);
        match train {
            PulseTrain::Wave { frequency, duty, phase } => {
                let turn = Fraction::symbol(self.pi).times(&Fraction::whole(2));
                let turns = setting(frequency).times(&time).plus(&setting(phase).over(&turn));
                one.minus(&step(&fraction(&turns).minus(&setting(duty))))
            }
            PulseTrain::Train { begin, width, period: None } => {
                let since = time.minus(&setting(begin));
                step(&since).minus(&step(&since.minus(&setting(width))))
            }
            PulseTrain::Train { begin, width, period: Some(period) } => {
                let (since, period) = (time.minus(&setting(begin)), setting(period));
                let share = fraction(&since.over(&period)).minus(&setting(width).over(&period));
                step(&since).times(&one.minus(&step(&share)))
            }
        }
    }

    /// Adds the transitions of the modes.
    fn transitions(&mut self) {
        for (index, mode) in self.program.modes().iter().enumerate() {
            let transitions = mode.transitions.iter().map(|transition| TransitionLaw {
                from: transition.from,
                to: transition.to,
                guard: self.value(transition.guard.register),
                is_strict: transition.guard.is_strict,
                reset: transition.reset.map(|reset| {
                    let state = &self.program.state_laws()[reset.state as usize];
                    let output = &self.wiring.names[&self.output(state.element).1];
                    (output.symbol, self.value(reset.to).times(&output.per_volt))
                }),
            });
            let transitions = transitions.collect();
            self.wiring.system.modes[index].transitions = transitions;
        }
    }
}
