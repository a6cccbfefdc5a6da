//! How far a search has come: its rounds, what they took, and the patch with that.

use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::Stage;
use crate::search::round::{Round, Trial};
use crate::search::search_log::{Action, Change};

/// Two effects are sought at once only where so much is left, in sigmas rms: of many pairs one follows what little is left by chance.
const HOPED_FROM: f64 = 1.0;

/// How far a search has come.
#[derive(Clone)]
pub(crate) struct Come {
    /// What was tried, one effect after the other.
    pub rounds: Vec<Round>,
    /// What was taken in the first of these rounds,
    pub effects: Vec<Candidate>,
    /// and the patch with it.
    pub stage: Stage,
    /// How it came there.
    pub way: Vec<Change>,
}

impl Come {
    /// Nothing tried yet.
    pub fn begun(base: Stage) -> Come {
        let way = vec![Change::new(Action::FitPatch, &[], &base)];
        Come { rounds: Vec::new(), effects: Vec::new(), stage: base, way }
    }

    /// Notes what was done to come here.
    pub fn did(&mut self, action: Action) {
        self.way.push(Change::new(action, &self.effects, &self.stage));
    }

    /// The same with a round that took nothing.
    pub fn and(&self, round: &Round) -> Come {
        let mut come = self.clone();
        come.rounds.push(round.clone());
        come
    }

    /// What came of a promise: what was there before, unless more effects hold together.
    pub fn or(self, before: Come) -> Come {
        if self.effects.len() > before.effects.len() && self.all_hold() {
            return self;
        }
        before.after(&self, Action::BacktrackFromMore)
    }

    /// Here again from where another way led.
    pub fn after(mut self, other: &Come, action: Action) -> Come {
        self.way = other.way.clone();
        self.did(action);
        self
    }

    /// Whether all its effects were taken, each beside the others.
    pub fn all_hold(&self) -> bool {
        self.rounds.iter().take(self.effects.len()).all(|round| round.taken)
    }

    /// Where the only round took nothing and more than noise is left: the places of the trials that it may have hidden.
    pub fn hopes(&self) -> Vec<usize> {
        let is_open =
            self.effects.is_empty() && self.stage.leaves_structure() && self.stage.gap() > HOPED_FROM;
        let only = if is_open && self.rounds.len() == 1 { self.rounds.first() } else { None };
        only.map(Round::hopes).unwrap_or_default()
    }

    /// The same as if the trial in a place of its first round had been taken.
    pub fn hoping(&self, place: usize) -> Come {
        let Trial { candidate, stage, .. } = self.rounds[0].trials[place].clone();
        let action = Action::TryInPair(candidate.named());
        let mut hope = Come { effects: vec![candidate], stage, ..self.clone() };
        hope.did(action);
        hope
    }

    /// Whether to go on with a round: it is one more, and its best is taken, or may be beside what is still missing.
    pub fn goes_on_with(&mut self, round: Round) -> bool {
        let best = round.is_gone_on_from().then(|| round.trials[0].clone());
        self.rounds.push(round);
        let is_taken = best.is_some();
        if let Some(best) = best {
            let is_sure = self.rounds.last().is_some_and(|round| round.taken);
            let action = match is_sure {
                true => Action::Take(best.named()),
                false => Action::ContinueUnconfirmed(best.named()),
            };
            self.effects.push(best.candidate);
            self.stage = best.stage;
            self.did(action);
        }
        is_taken
    }

    /// Whether to go on from here with a better fit of the patch: not where its last effect would not have been taken then.
    pub fn is_bettered_by(&mut self, better: Stage) -> bool {
        if let Some(last) = self.rounds.last_mut() {
            let Some(best) = last.refit(better) else { return false };
            self.effects.pop();
            self.effects.push(best.candidate);
            self.stage = best.stage;
        } else {
            self.stage = better;
        }
        self.did(Action::RefitFromTrial);
        true
    }

    /// Whether another has the same effects at the same places.
    pub fn has_the_effects_of(&self, other: &Come) -> bool {
        let mut pairs = self.effects.iter().zip(&other.effects);
        self.effects.len() == other.effects.len() && pairs.all(|(one, other)| one.is_same(other))
    }

    /// The same without the effect in a place, with the others as they stand in this stage without it.
    pub fn less(&mut self, place: usize, others: Vec<Candidate>, without: Stage) {
        self.rounds.remove(place);
        let dropped = self.effects[place].named();
        (self.effects, self.stage) = (others, without);
        self.did(Action::Drop(dropped));
    }

    /// Another round in a place, found beside the others.
    pub fn replace(&mut self, place: usize, others: Vec<Candidate>, round: Round) {
        let best = round.trials[0].clone();
        let action = match best.candidate.is_same(&self.effects[place]) {
            true => Action::Keep(best.named()),
            false => Action::Replace { by: best.named(), replaced: self.effects[place].named() },
        };
        self.effects = others;
        self.effects.insert(place, best.candidate);
        self.stage = best.stage;
        self.rounds[place] = round;
        self.did(action);
    }
}
