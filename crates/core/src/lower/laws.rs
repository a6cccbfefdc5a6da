//! Implements what element laws read of their element, from the circuit.
//!
//! A law reads its inputs, settings and flags by name through [`Builder`]. This module finds them in the circuit for
//! the element whose law is being emitted (`draft.current`). A name that the element's kind does not have is a mistake
//! in the law, so it panics.

use super::Lowering;
use crate::elements::{Family, SettingDefault, SettingQuantity};
use crate::ir::{Builder, Draft, Op, Register};
use crate::patch::Amount;

/// The circuit's answers to a law. Every method refers to the current element.
impl Builder for Lowering<'_> {
    fn draft(&self) -> &Draft {
        &self.draft
    }

    fn draft_mut(&mut self) -> &mut Draft {
        &mut self.draft
    }

    /// Gain and register of each cord into the input. The order of evaluation ensures that direct inputs already have a
    /// register; memory laws run after all outputs.
    fn driven(&self, name: &str) -> Vec<(f64, Register)> {
        let input = self.input(name);
        let cords =
            self.circuit.cords(self.draft.current).into_iter().filter(|(_, cord)| cord.input == input);
        cords
            .map(|(from, cord)| {
                (cord.gain, self.draft.outputs[from].expect("a step comes after those of its inputs"))
            })
            .collect()
    }

    /// The coefficient of a formula or a default. It is shared by all reads of the setting.
    fn coefficient(&mut self, name: &str) -> Option<u32> {
        self.setting_coefficient(name)
    }

    /// The points as the patch gives them: in volts for a curve, in the unit of the scale for a table of time.
    fn points(&self, name: &str) -> Vec<[f64; 2]> {
        match self.amount(name) {
            Some(Amount::Points(points)) => points.clone(),
            _ => Vec::new(),
        }
    }

    /// The flag of the patch, or the default: any number except 0 is true.
    fn flag(&self, name: &str) -> bool {
        match self.amount(name) {
            Some(Amount::Flag(flag)) => *flag,
            _ => matches!(self.default(name), SettingDefault::Number(number) if number != 0.0),
        }
    }

    /// The word of the patch, or that of the default. Choices are stored as indices into the list of words.
    fn choice(&self, name: &str) -> &'static str {
        let settings = self.circuit.element(self.draft.current).kind.settings;
        let SettingQuantity::Choice(words) = settings[self.setting(name)].quantity else {
            unreachable!("laws read only settings of this kind as a choice")
        };
        let chosen = match (self.amount(name), self.default(name)) {
            (Some(Amount::Choice(index)), _) => *index,
            (_, SettingDefault::Number(index)) => index as usize,
            _ => 0,
        };
        words[chosen]
    }

    /// A coefficient that converts a value in the unit of the scale to volts: size of the unit / value of one volt,
    /// both in SI. It is the constant 1 if the drive has no scale.
    fn volts_per_signal(&mut self) -> Register {
        let element = self.circuit.element(self.draft.current);
        let Some(scale) = element.scale else { return self.builder().constant(1.0) };
        let volt = self.derived(scale);
        let unit = self.emit_prologue(Op::Constant(self.circuit.derived_unit(scale).factor()));
        let register = self.emit_prologue(Op::Divide(unit, volt));
        let index =
            self.push_coefficient(register, format!("{} volts per unit", element.name), (f64::MIN, f64::MAX));
        self.builder().emit(Op::Coefficient(index))
    }

    /// Modes of a drive depend on time only, so they change before those of other elements.
    fn is_drive(&self) -> bool {
        self.circuit.element(self.draft.current).kind.family == Family::Drive
    }
}

impl<'c> Lowering<'c> {
    /// The value that the patch gives to a setting of the current element; `None` if it is omitted.
    pub(super) fn amount(&self, name: &str) -> Option<&'c Amount> {
        let element = self.circuit.element(self.draft.current);
        element.settings[self.setting(name)].as_ref().map(|placed| &placed.value)
    }

    /// The default of a setting of the current element, from its kind.
    fn default(&self, name: &str) -> SettingDefault {
        self.circuit.element(self.draft.current).kind.settings[self.setting(name)].default
    }

    /// Index of an input of the current element, among the inputs of its kind.
    ///
    /// It panics if the kind has no input of this name: the law is wrong then.
    pub(super) fn input(&self, name: &str) -> usize {
        let inputs = self.circuit.element(self.draft.current).kind.inputs;
        inputs.iter().position(|input| input.name == name).expect("laws read only inputs of their kind")
    }

    /// Index of a setting of the current element, among the settings of its kind.
    ///
    /// It panics if the kind has no setting of this name: the law is wrong then.
    pub(super) fn setting(&self, name: &str) -> usize {
        let kind = self.circuit.element(self.draft.current).kind;
        kind.setting(name).expect("laws read only settings of their kind")
    }
}
