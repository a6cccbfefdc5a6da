//! Names for the outputs and the stored values of a program.

use patchcord_core::elements::Family;
use patchcord_core::ir::{Level, Op, Register, SignalInfo};
use patchcord_expr::Dimension;

use super::super::system::ModeLaw;
use super::{Derivation, Output};
use crate::symbolic::{Fraction, Symbol, SymbolEntry, SymbolKind};

impl Derivation<'_> {
    /// Gives names to outputs: drives first, then signals in the order of the patch, then states and stored values.
    pub(super) fn name_outputs(&mut self) {
        let program = self.program;
        let drives: Vec<_> =
            program.element_outputs().iter().filter(|output| self.is_drive(output.register)).collect();
        for output in drives {
            if let Some(signal) = program.signals().iter().find(|signal| signal.name == output.name) {
                self.name_signal(signal);
            }
        }
        for signal in program.signals().iter().filter(|signal| signal.is_named) {
            self.name_signal(signal);
        }
        if self.options.keeps_elements {
            for output in self.element_outputs() {
                self.name_element(&output.0, output.1);
            }
        }
        for state in program.state_laws() {
            let (name, register) = self.output(state.element);
            self.name_element(&name, register);
            self.wiring.states.push(self.wiring.names[&register].symbol);
        }
    }

    /// Name and register of every output that an element of the patch computes.
    fn element_outputs(&self) -> Vec<(String, Register)> {
        let elements = self.circuit.elements();
        let outputs = self.program.element_outputs().iter().zip(elements);
        let computed = outputs.filter(|(_, element)| element.kind.family == Family::Computing);
        computed.map(|(output, _)| (output.name.clone(), output.register)).collect()
    }

    /// Gives a signal's name to its output, unless the output has one. A constant has no name.
    fn name_signal(&mut self, signal: &SignalInfo) {
        let per_volt = self.per_volt(signal);
        let is_constant = matches!(self.program.body()[signal.register.index()], Op::Constant(_));
        if per_volt.is_zero() || is_constant || self.wiring.names.contains_key(&signal.register) {
            return;
        }
        let symbol = self.wiring.system.symbols.variable(&signal.name, 0, signal.dimension);
        self.wiring.names.insert(signal.register, Output { symbol, per_volt });
    }

    /// Gives an element's name to its output, in volts, unless the output has a name.
    fn name_element(&mut self, name: &str, register: Register) {
        let is_constant = matches!(self.program.body()[register.index()], Op::Constant(_));
        if !is_constant && !self.wiring.names.contains_key(&register) {
            let symbol = self.wiring.system.symbols.variable(name, 0, Dimension::VOLTAGE);
            self.wiring.names.insert(register, Output { symbol, per_volt: Fraction::whole(1) });
        }
    }

    /// Adds a quantity that is constant within a step.
    fn held(&mut self, name: String, dimension: Dimension) -> Symbol {
        let entry = SymbolEntry { name, primes: 0, kind: SymbolKind::Held, dimension };
        self.wiring.system.symbols.add(entry, false)
    }

    /// Adds the symbols of delay lines, sampled values, levels and modes.
    pub(super) fn name_sources(&mut self) {
        let program = self.program;
        for delay in program.delays() {
            let (name, register) = self.output(delay.element);
            self.name_element(&name, register);
            let symbol = self.wiring.names[&register].symbol;
            self.wiring.delayed.push(symbol);
        }
        for sampled in program.sampled_values() {
            let name = format!("{}.before", self.output(sampled.element).0);
            let entry =
                SymbolEntry { name, primes: 0, kind: SymbolKind::Held, dimension: Dimension::VOLTAGE };
            let symbol = self.wiring.system.symbols.add(entry, false);
            self.wiring.sampled.push(symbol);
        }
        for level in program.levels() {
            let (element, noun) = self.level_name(level);
            let dimension = match level {
                Level::Points { table } => {
                    self.wiring.system.tables[*table].unit.as_ref().map(|unit| unit.dimension)
                }
                Level::Noise(_) | Level::Pulses(_) => None,
            };
            let symbol = self.held(format!("{element}.{noun}"), dimension.unwrap_or(Dimension::NONE));
            self.wiring.levels.push(symbol);
        }
        for mode in program.modes() {
            let element = self.output(mode.element).0;
            let symbol = self.held(format!("{element}.{}", mode.names.mode), Dimension::NONE);
            self.wiring.system.modes.push(ModeLaw {
                symbol,
                element,
                noun: mode.names.mode,
                values: mode.names.values,
                initial: mode.initial,
                transitions: Vec::new(),
            });
        }
    }

    /// Name of a level's element, and a noun.
    fn level_name(&self, level: &Level) -> (String, &'static str) {
        let (element, noun) = match level {
            Level::Noise(noise) => (noise.element, "noise"),
            Level::Pulses(pulses) => (pulses.element, "pulses"),
            Level::Points { table } => {
                let drive = (0..self.program.element_outputs().len())
                    .find(|element| self.program.drive_table(*element) == Some(*table));
                (drive.unwrap_or_default(), "steps")
            }
        };
        (self.output(element).0, noun)
    }
}
