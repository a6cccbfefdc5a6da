//! The way of a search: every change of what stands in the patch beside what it had, and what it left.

use serde_json::{Value, json};

use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::Stage;

/// One of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// What was done, in words.
    pub did: String,
    /// The effects that stood in the patch then, with where they act.
    pub effects: Vec<String>,
    /// What was left then in training and of the data held back, in noise, rms.
    pub left: [f64; 2],
}

impl Change {
    /// What was done, and what came of it.
    pub(crate) fn new(did: impl Into<String>, effects: &[Candidate], stage: &Stage) -> Change {
        let effects = effects.iter().map(Candidate::named).collect();
        let left = [&stage.train, &stage.test].map(|fitted| fitted.over_noise());
        Change { did: did.into(), effects, left }
    }

    /// The same as a JSON document.
    pub fn document(&self) -> Value {
        let [train, test] = self.left;
        json!({"did": self.did, "effects": self.effects, "left": {"train": train, "test": test}})
    }
}
