//! The state of a search: its rounds, the effects that they added, and the patch with these effects.
//!
//! A search can return to an earlier state, so states are copied before uncertain steps. The log is never shortened:
//! it also has the steps that were undone.

use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::FittedModel;
use crate::search::round::{Round, Trial};
use crate::search::search_log::{Action, LogEntry};

/// Minimum excess residual for a search of pairs, in rms over the noise. With a smaller excess, one of the many pairs
/// often follows the residual by chance.
const MIN_PAIR_EXCESS: f64 = 1.0;

/// The state of a search.
#[derive(Clone)]
pub(crate) struct SearchState {
    /// The rounds. The last one may have added no effect.
    pub rounds: Vec<Round>,
    /// The effects in the patch. Entry i was added by round i.
    pub effects: Vec<Candidate>,
    /// The patch with these effects, fitted.
    pub model: FittedModel,
    /// All actions that led to this state, in order.
    pub search_log: Vec<LogEntry>,
}

impl SearchState {
    /// The state before the first round.
    pub(crate) fn new(base: FittedModel) -> SearchState {
        let search_log = vec![LogEntry::new(Action::FitPatch, &[], &base)];
        SearchState { rounds: Vec::new(), effects: Vec::new(), model: base, search_log }
    }

    /// Appends an action to the log, with the effects and the residual of this state.
    pub(crate) fn log(&mut self, action: Action) {
        self.search_log.push(LogEntry::new(action, &self.effects, &self.model));
    }

    /// A copy with a round that adds no effect.
    pub(crate) fn with_round(&self, round: &Round) -> SearchState {
        let mut state = self.clone();
        state.rounds.push(round.clone());
        state
    }

    /// This state if it has more effects than `before` and all of them are confirmed. Otherwise `before`, with an
    /// entry in the log.
    pub(crate) fn prefer_longer(self, before: SearchState) -> SearchState {
        if self.effects.len() > before.effects.len() && self.is_jointly_confirmed() {
            return self;
        }
        self.backtrack_to(before, Action::BacktrackFromMore)
    }

    /// The state `before`, with the log of this state and the action that explains the return.
    pub(crate) fn backtrack_to(&self, mut before: SearchState, action: Action) -> SearchState {
        before.search_log = self.search_log.clone();
        before.log(action);
        before
    }

    /// Whether every effect was taken in its round, next to the others.
    pub(crate) fn is_jointly_confirmed(&self) -> bool {
        self.rounds.iter().take(self.effects.len()).all(|round| round.taken)
    }

    /// The trials from which pairs of effects are tried, as indices into the trials of the first round. Empty unless
    /// the only round added no effect and the residual exceeds the noise by far.
    pub(crate) fn tentative_candidates(&self) -> Vec<usize> {
        let is_open = self.effects.is_empty()
            && self.model.residuals_are_coloured()
            && self.model.excess_rms() > MIN_PAIR_EXCESS;
        let only_round = if is_open && self.rounds.len() == 1 { self.rounds.first() } else { None };
        only_round.map(Round::tentative_candidates).unwrap_or_default()
    }

    /// A copy in which a trial of the first round is added, although it was not taken. `trial` is its index.
    pub(crate) fn with_tentative(&self, trial: usize) -> SearchState {
        let Trial { candidate, model, .. } = self.rounds[0].trials[trial].clone();
        let action = Action::TryInPair(candidate.placed_effect());
        let mut state = SearchState { effects: vec![candidate], model, ..self.clone() };
        state.log(action);
        state
    }

    /// Appends a round, and adds its best effect if that is taken or tentative. Returns whether an effect was added.
    pub(crate) fn add_round(&mut self, round: Round) -> bool {
        let best = round.has_accepted_effect().then(|| round.trials[0].clone());
        self.rounds.push(round);
        let is_added = best.is_some();
        if let Some(best) = best {
            let is_confirmed = self.rounds.last().is_some_and(|round| round.taken);
            let action = match is_confirmed {
                true => Action::Take(best.placed_effect()),
                false => Action::ContinueUnconfirmed(best.placed_effect()),
            };
            self.effects.push(best.candidate);
            self.model = best.model;
            self.log(action);
        }
        is_added
    }

    /// Replaces the fit by a better one with the same effects. Returns false, and changes nothing, if the last round
    /// would not accept an effect with the better fit.
    pub(crate) fn adopt_better_fit(&mut self, better: FittedModel) -> bool {
        if let Some(last) = self.rounds.last_mut() {
            let Some(best) = last.rejudge(better) else { return false };
            self.effects.pop();
            self.effects.push(best.candidate);
            self.model = best.model;
        } else {
            self.model = better;
        }
        self.log(Action::RefitFromTrial);
        true
    }

    /// Whether another state has the same effects at the same sites, in the same order.
    pub(crate) fn has_same_effects(&self, other: &SearchState) -> bool {
        let mut pairs = self.effects.iter().zip(&other.effects);
        self.effects.len() == other.effects.len() && pairs.all(|(one, other)| one.is_same(other))
    }

    /// The state without an effect and its round. `others` are the remaining effects as they are wired in `model`,
    /// the patch without the effect.
    pub(crate) fn without(
        mut self,
        effect: usize,
        others: Vec<Candidate>,
        model: FittedModel,
    ) -> SearchState {
        self.rounds.remove(effect);
        let dropped = self.effects[effect].placed_effect();
        (self.effects, self.model) = (others, model);
        self.log(Action::Drop(dropped));
        self
    }

    /// Replaces an effect by the best of a round that ran with the other effects in the patch. It may be the same
    /// effect.
    pub(crate) fn replace_effect(&mut self, effect: usize, others: Vec<Candidate>, round: Round) {
        let best = round.trials[0].clone();
        let action = match best.candidate.is_same(&self.effects[effect]) {
            true => Action::Keep(best.placed_effect()),
            false => {
                Action::Replace { by: best.placed_effect(), replaced: self.effects[effect].placed_effect() }
            }
        };
        self.effects = others;
        self.effects.insert(effect, best.candidate);
        self.model = best.model;
        self.rounds[effect] = round;
        self.log(action);
    }
}
