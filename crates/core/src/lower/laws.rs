//! What element laws read of their element, from the circuit.

use super::Lowering;
use crate::elements::{Default as SettingDefault, Family, Measure};
use crate::ir::{Builder, Draft, Op, Register};
use crate::patch::Amount;

impl Builder for Lowering<'_> {
    fn draft(&self) -> &Draft {
        &self.draft
    }

    fn draft_mut(&mut self) -> &mut Draft {
        &mut self.draft
    }

    fn driven(&self, name: &str) -> Vec<(f64, Register)> {
        let inputs = self.circuit.element(self.draft.current).kind.inputs;
        let input =
            inputs.iter().position(|input| input.name == name).expect("a law names inputs of its kind");
        let cords =
            self.circuit.cords(self.draft.current).into_iter().filter(|(_, cord)| cord.input == input);
        cords
            .map(|(from, cord)| {
                (cord.gain, self.draft.outputs[from].expect("stages put drivers before what they drive"))
            })
            .collect()
    }

    fn coefficient(&mut self, name: &str) -> Option<u32> {
        self.setting_coefficient(name)
    }

    fn points(&self, name: &str) -> Vec<[f64; 2]> {
        match self.amount(name) {
            Some(Amount::Points(points)) => points.clone(),
            _ => Vec::new(),
        }
    }

    fn flag(&self, name: &str) -> bool {
        match self.amount(name) {
            Some(Amount::Flag(flag)) => *flag,
            _ => matches!(self.default(name), SettingDefault::Number(number) if number != 0.0),
        }
    }

    fn choice(&self, name: &str) -> &'static str {
        let settings = self.circuit.element(self.draft.current).kind.settings;
        let Measure::Choice(words) = settings[self.setting(name)].measure else {
            unreachable!("a law asks for a choice where its kind offers words")
        };
        let chosen = match (self.amount(name), self.default(name)) {
            (Some(Amount::Choice(index)), _) => *index,
            (_, SettingDefault::Number(index)) => index as usize,
            _ => 0,
        };
        words[chosen]
    }

    fn volts_per_signal(&mut self) -> Register {
        let element = self.circuit.element(self.draft.current);
        let Some(scale) = element.scale else { return self.builder().constant(1.0) };
        let volt = self.derived(scale);
        let unit = self.early(Op::Constant(self.circuit.derived_unit(scale).factor()));
        let register = self.early(Op::Divide(unit, volt));
        let index =
            self.push_coefficient(register, format!("{} volts per unit", element.name), (f64::MIN, f64::MAX));
        self.builder().emit(Op::Coefficient(index))
    }

    fn is_drive(&self) -> bool {
        self.circuit.element(self.draft.current).kind.family == Family::Drive
    }
}

impl<'c> Lowering<'c> {
    pub(super) fn amount(&self, name: &str) -> Option<&'c Amount> {
        let element = self.circuit.element(self.draft.current);
        element.settings[self.setting(name)].as_ref().map(|placed| &placed.value)
    }

    fn default(&self, name: &str) -> SettingDefault {
        self.circuit.element(self.draft.current).kind.settings[self.setting(name)].default
    }

    /// The index of a setting of the current element.
    pub(super) fn setting(&self, name: &str) -> usize {
        let kind = self.circuit.element(self.draft.current).kind;
        kind.setting(name).expect("a law names settings of its kind")
    }
}
