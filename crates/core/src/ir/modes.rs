//! Modes: discrete values that are constant within a step, and the transitions between them.
//!
//! A transition is due if its guard is due. The solver locates that instant, ends the step there and calls
//! [`Program::change_modes`].

use super::{Builder, Program, Register};

/// A discrete value of an element, constant within a step. Relays, brakes, limits and drives with corners use modes.
#[derive(Debug, Clone)]
pub struct Mode {
    /// Index of the element.
    pub element: usize,
    /// Its name and those of its values.
    pub names: ModeNames,
    /// Whether the element is a drive: its mode depends on time only.
    pub is_drive: bool,
    /// The value in initial condition.
    pub initial: f64,
    /// The possible changes; of several that are due, the first one happens.
    pub transitions: Vec<Transition>,
    /// What the error message recommends if the mode changes without end.
    pub chatter_remedy: ChatterRemedy,
}

/// The name of a mode and the names of its values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeNames {
    /// A noun, such as "contact".
    pub mode: &'static str,
    /// The values, each with its name, such as 0 with "clear".
    pub values: &'static [(f64, &'static str)],
}

/// The means of an element against endless switching (chatter). Error messages recommend it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ChatterRemedy {
    /// The distance between the thresholds.
    Hysteresis,
    /// Another element with the same purpose and two thresholds. The element has one threshold. If it acts on its own
    /// input, it switches back at once, so a shorter step does not help.
    TwoThresholds,
    /// The speed below which the element stays at rest at a stop. Bounces follow each other ever sooner, so a shorter
    /// step does not help.
    Rest,
    /// The element has no such means; the cause is in its inputs.
    Input,
}

/// A change of a mode from one value to another.
#[derive(Debug, Clone)]
pub struct Transition {
    /// The value of the mode before the change.
    pub from: f64,
    /// The value of the mode after the change.
    pub to: f64,
    /// The condition for the change.
    pub guard: Guard,
    /// The state that the change sets, if any.
    pub reset: Option<Reset>,
    /// Indices of other modes that change at the same time, with their new values.
    pub sets: Vec<(u32, f64)>,
}

/// A mode of the element whose law is being emitted.
#[derive(Debug, Clone, Copy)]
pub struct ModeHandle {
    /// Index of the mode in the program.
    pub(crate) index: u32,
    /// The register with the mode's present value.
    pub value: Register,
}

/// The condition for a transition: the value of a register reaches or passes 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guard {
    /// The register that is compared with 0.
    pub register: Register,
    /// Whether the value must be above 0; otherwise 0 is sufficient.
    pub is_strict: bool,
}

/// A state that a transition sets to a new value.
#[derive(Debug, Clone, Copy)]
pub struct Reset {
    /// Index of the state.
    pub state: u32,
    /// Register with the new value.
    pub to: Register,
}

impl Guard {
    /// A guard that is due if the value is 0 or above.
    pub fn reached(register: Register) -> Self {
        Guard { register, is_strict: false }
    }

    /// A guard that is due if the value is above 0.
    pub fn passed(register: Register) -> Self {
        Guard { register, is_strict: true }
    }

    /// The value that is compared with 0; negative before the transition is due.
    pub(crate) fn value(self, registers: &[f64]) -> f64 {
        registers[self.register.index()]
    }

    /// Whether the transition is due at these voltages.
    pub(crate) fn is_due(self, registers: &[f64]) -> bool {
        let value = self.value(registers);
        if self.is_strict { value > 0.0 } else { value >= 0.0 }
    }
}

impl Transition {
    /// A change from one value of a mode to another.
    pub fn new(from: f64, to: f64, guard: Guard) -> Self {
        Transition { from, to, guard, reset: None, sets: Vec::new() }
    }

    /// The same change, which also sets the element's state to a value.
    pub fn reset(mut self, builder: &dyn Builder, to: Register) -> Self {
        self.reset = Some(Reset { state: builder.own_state(), to });
        self
    }

    /// The same change, which also sets another mode.
    pub fn with_mode(mut self, mode: ModeHandle, value: f64) -> Self {
        self.sets.push((mode.index, value));
        self
    }
}

impl Program {
    /// Makes every change of mode that is due at these voltages, at most one per mode, and passes each to `changed`.
    ///
    /// If modes of drives change, only these change now: the other guards would act on voltages from before the jump.
    /// After a change the caller must evaluate the body again.
    pub(crate) fn change_modes(
        &self,
        registers: &[f64],
        modes: &mut [f64],
        states: &mut [f64],
        mut changed: impl FnMut(usize, &Transition),
    ) {
        let mut has_changed = false;
        for is_drive in [true, false] {
            let modes_of_kind =
                self.lowered.modes.iter().enumerate().filter(|(_, mode)| mode.is_drive == is_drive);
            for (index, mode) in modes_of_kind {
                let value = modes[index];
                let due = |open: &&Transition| open.from == value && open.guard.is_due(registers);
                let Some(transition) = mode.transitions.iter().find(due) else { continue };
                modes[index] = transition.to;
                transition.sets.iter().for_each(|(other, value)| modes[*other as usize] = *value);
                if let Some(reset) = transition.reset {
                    states[reset.state as usize] = registers[reset.to.index()];
                }
                has_changed = true;
                changed(index, transition);
            }
            if has_changed {
                return;
            }
        }
    }
}
