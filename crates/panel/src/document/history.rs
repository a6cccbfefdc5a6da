//! The history of a document: steps that can be reverted and repeated.
//!
//! A step keeps the whole text and the loose cords of the other side of the change. The history is linear: steps are
//! reverted in the reverse order, and a new step removes those that could be repeated.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Loose;
use crate::command::Mode;

/// Largest number of steps.
pub(super) const MAX_STEPS: usize = 100;
/// Largest size of the texts of all steps, in bytes.
const MAX_BYTES: usize = 4_000_000;

/// Everything of a document that a step can change.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct State {
    /// The text of the patch.
    pub text: Arc<str>,
    /// The cords with a loose end.
    pub loose: Vec<Loose>,
}

/// A step of the history.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Step {
    /// Its name: "turn m".
    pub label: String,
    /// Its kind.
    pub kind: StepKind,
    /// The state to which it leads if it is carried out: before the change for undo, after it for redo.
    pub state: State,
}

/// The kind of a step. It says what the machine has to do, and which steps are merged.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum StepKind {
    /// A change of the parameter with this name.
    Parameter(String),
    /// A change of a setting.
    Setting {
        /// Name of the element or drive.
        element: String,
        /// Name of the setting.
        setting: String,
    },
    /// Another change of the patch.
    Patch,
    /// A change of loose cords only.
    Panel,
    /// A change of the mode.
    Mode {
        /// The mode before.
        before: Mode,
        /// The mode after.
        after: Mode,
    },
}

/// The direction of a step through the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Direction {
    /// Back.
    Undo,
    /// Forth again.
    Redo,
}

impl Direction {
    /// The word for messages.
    pub(super) fn verb(self) -> &'static str {
        match self {
            Direction::Undo => "undo",
            Direction::Redo => "redo",
        }
    }
}

/// The steps of a document.
#[derive(Debug, Default)]
pub(super) struct History {
    /// Steps that can be reverted, the oldest first.
    pub done: Vec<Step>,
    /// Steps that can be repeated. The last one is the next.
    pub undone: Vec<Step>,
    /// Whether the next change may become part of the last step. False after undo and redo.
    may_merge: bool,
}

impl History {
    /// A history with these steps, without the oldest ones if there are too many.
    pub(super) fn with_steps(done: Vec<Step>, undone: Vec<Step>) -> History {
        let mut history = History { done, undone, may_merge: false };
        history.trim();
        history
    }

    /// Adds a step. Consecutive changes of one parameter, or of one setting, are one step.
    pub(super) fn push(&mut self, step: Step) {
        let is_repeated = |last: &Step| match &step.kind {
            StepKind::Parameter(_) | StepKind::Setting { .. } => last.kind == step.kind,
            StepKind::Patch | StepKind::Panel | StepKind::Mode { .. } => false,
        };
        let merges = self.may_merge && self.done.last().is_some_and(is_repeated);
        if !merges {
            self.done.push(step);
        }
        self.undone.clear();
        self.may_merge = true;
        self.trim();
    }

    /// The next step in a direction. `None` if there is none.
    pub(super) fn next(&self, direction: Direction) -> Option<&Step> {
        match direction {
            Direction::Undo => self.done.last(),
            Direction::Redo => self.undone.last(),
        }
    }

    /// Notes that the next step in a direction has been carried out. `before` is the state from which it led.
    pub(super) fn pass(&mut self, direction: Direction, before: State) {
        let (from, to) = match direction {
            Direction::Undo => (&mut self.done, &mut self.undone),
            Direction::Redo => (&mut self.undone, &mut self.done),
        };
        if let Some(step) = from.pop() {
            to.push(Step { state: before, ..step });
        }
        self.may_merge = false;
    }

    /// Removes the oldest steps until the history is within its limits.
    fn trim(&mut self) {
        while self.done.len() + self.undone.len() > MAX_STEPS || self.bytes() > MAX_BYTES {
            let steps = if self.done.is_empty() { &mut self.undone } else { &mut self.done };
            steps.remove(0);
        }
    }

    /// The size of all texts. Neighbouring steps that share a text count once.
    fn bytes(&self) -> usize {
        let texts: Vec<_> = self.done.iter().chain(&self.undone).map(|step| &step.state.text).collect();
        let is_shared = |index: usize| index > 0 && Arc::ptr_eq(texts[index], texts[index - 1]);
        (0..texts.len()).filter(|index| !is_shared(*index)).map(|index| texts[index].len()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step of a kind from a text of this length.
    fn step(kind: StepKind, length: usize) -> Step {
        let state = State { text: Arc::from("x".repeat(length)), loose: Vec::new() };
        Step { label: format!("{kind:?}"), kind, state }
    }

    /// A change of a parameter.
    fn turn(name: &str) -> StepKind {
        StepKind::Parameter(name.to_owned())
    }

    #[test]
    fn consecutive_changes_of_one_parameter_are_one_step() {
        let mut history = History::default();
        for (name, length) in [("m", 1), ("m", 2), ("k", 3), ("m", 4)] {
            history.push(step(turn(name), length));
        }
        let lengths: Vec<_> = history.done.iter().map(|step| step.state.text.len()).collect();
        assert_eq!(lengths, [1, 3, 4]);
        // After undo a change of the same parameter is a step of its own.
        let present = history.done[0].state.clone();
        history.pass(Direction::Undo, present);
        history.push(step(turn("k"), 5));
        assert_eq!((history.done.len(), history.undone.len()), (3, 0));
    }

    #[test]
    fn other_changes_are_not_merged() {
        let mut history = History::default();
        let mode = StepKind::Mode { before: Mode::Hold, after: Mode::Operate };
        for kind in [StepKind::Patch, StepKind::Patch, StepKind::Panel, StepKind::Panel, mode.clone(), mode] {
            history.push(step(kind, 1));
        }
        assert_eq!(history.done.len(), 6);
    }

    #[test]
    fn the_oldest_steps_are_dropped_above_100_steps_and_4_mb() {
        let mut history = History::default();
        for length in 0..130 {
            history.push(step(StepKind::Patch, length));
        }
        assert_eq!((history.done.len(), history.done[0].state.text.len()), (100, 30));
        history.push(step(StepKind::Patch, 2_000_000));
        history.push(step(StepKind::Patch, 2_000_000));
        assert_eq!(history.done.len(), 2);
        history.push(step(StepKind::Patch, MAX_BYTES + 1));
        assert_eq!(history.done.len(), 0);
    }
}
