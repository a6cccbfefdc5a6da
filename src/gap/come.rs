//! How far a search has come: its rounds, what they took, and the patch with that.

use super::candidate::Candidate;
use super::round::{Round, Trial};
use super::stage::Stage;

/// Two effects are sought at once only where so much is left, in sigmas rms: of many pairs one follows what little is left by chance.
const HOPED_FROM: f64 = 1.0;

/// How far a search has come.
#[derive(Clone)]
pub(super) struct Come {
    /// What was tried, one effect after the other.
    pub rounds: Vec<Round>,
    /// What was taken in the first of these rounds,
    pub effects: Vec<Candidate>,
    /// and the patch with it.
    pub stage: Stage,
}

impl Come {
    /// The same with a round that took nothing.
    pub fn and(&self, round: &Round) -> Come {
        let mut come = self.clone();
        come.rounds.push(round.clone());
        come
    }

    /// What came of a promise: what was there before, unless more effects hold together.
    pub fn or(self, before: Come) -> Come {
        if self.effects.len() > before.effects.len() && self.all_hold() { self } else { before }
    }

    /// Whether all its effects were taken, each beside the others.
    pub fn all_hold(&self) -> bool {
        self.rounds.iter().take(self.effects.len()).all(|round| round.taken)
    }

    /// Where the only round took nothing and more than noise is left: as if each of the trials that it may have hidden had been taken.
    pub fn hopes(&self) -> impl Iterator<Item = Come> + '_ {
        let is_open =
            self.effects.is_empty() && self.stage.leaves_structure() && self.stage.gap() > HOPED_FROM;
        let only = if is_open && self.rounds.len() == 1 { self.rounds.first() } else { None };
        only.into_iter().flat_map(|round| {
            round.hopes().into_iter().map(|place| {
                let Trial { candidate, stage, .. } = round.trials[place].clone();
                Come { rounds: vec![round.clone()], effects: vec![candidate], stage }
            })
        })
    }

    /// Whether to go on with a round: it is one more, and its best is taken, or may be beside what is still missing.
    pub fn goes_on_with(&mut self, round: Round) -> bool {
        let best = round.is_gone_on_from().then(|| round.trials[0].clone());
        self.rounds.push(round);
        let is_taken = best.is_some();
        if let Some(best) = best {
            self.effects.push(best.candidate);
            self.stage = best.stage;
        }
        is_taken
    }

    /// Whether to go on from here with a better fit of the patch: not where its last effect would not have been taken then.
    pub fn is_bettered_by(&mut self, better: Stage) -> bool {
        let Some(last) = self.rounds.last_mut() else {
            self.stage = better;
            return true;
        };
        let Some(best) = last.refit(better) else { return false };
        self.effects.pop();
        self.effects.push(best.candidate);
        self.stage = best.stage;
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
        (self.effects, self.stage) = (others, without);
    }

    /// Another round in a place, found beside the others.
    pub fn replace(&mut self, place: usize, others: Vec<Candidate>, round: Round) {
        let best = round.trials[0].clone();
        self.effects = others;
        self.effects.insert(place, best.candidate);
        self.stage = best.stage;
        self.rounds[place] = round;
    }
}
