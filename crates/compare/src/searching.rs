//! A search with reports of its progress.
//!
//! A search completes some hundred trials, often many per second. Its client gets an event for the changes that it
//! shows, and for each hundredth of a phase. The session has no clock, so the number of trials decides.

use patchcord_expr::round_significant;
use patchcord_ident::report::labels::{effect_label, effect_labels};
use patchcord_ident::report::progress::phase_text;
use patchcord_ident::{Experiment, ModelError, Outcome, Problem, Progress, SearchSettings, search};

use crate::event::{Event, ProgressView, RejectedView};

/// Number of events per phase, apart from those for changes.
const EVENTS_PER_PHASE: u64 = 100;
/// Digits of a residual in units of the noise.
const DIGITS: usize = 5;

/// Searches for missing effects. `report` takes the events of its progress. The result is None if the patch can be run
/// from none of the starts.
///
/// # Errors
/// If the patch cannot be run along the records, or the search is cancelled.
pub(crate) fn run_search(
    experiment: &Experiment,
    problem: &Problem,
    settings: &SearchSettings<'_>,
    report: &mut (dyn FnMut(Event) + Send),
) -> Result<Option<Outcome>, ModelError> {
    let mut log = ProgressLog::default();
    search(experiment, problem, settings, |progress| {
        let trial = progress.trial.as_ref().map(|trial| RejectedView {
            effect: effect_label(&trial.effect),
            rms: trial.residual_rms.map(|rms| round_significant(rms, DIGITS)),
        });
        if let Some(view) = log.take(view_of(&progress), trial) {
            report(Event::Progress(view));
        }
    })
}

/// The progress for a client, without rejected candidates.
fn view_of(progress: &Progress) -> ProgressView {
    ProgressView {
        round: progress.round,
        phase: phase_text(progress.phase, progress.round),
        done: progress.done,
        total: progress.total,
        added: effect_labels(&progress.added),
        best: progress.best.as_ref().map(effect_label),
        rejected: Vec::new(),
    }
}

/// The progress that the client knows, and what happened since.
#[derive(Debug, Default)]
struct ProgressLog {
    /// The last event.
    reported: Option<ProgressView>,
    /// The best trial of the present phase.
    best: Option<RejectedView>,
    /// The candidates that were rejected since the last event.
    rejected: Vec<RejectedView>,
    /// The round and the phase of the last progress.
    place: (usize, String),
}

impl ProgressLog {
    /// Takes note of progress and of the trial that was completed just now. Returns the event that the client should
    /// get now, if any.
    fn take(&mut self, view: ProgressView, trial: Option<RejectedView>) -> Option<ProgressView> {
        self.follow_phase(&view);
        if let Some(trial) = trial {
            self.note_trial(trial, view.best.as_deref());
        }
        if !self.is_due(&view) {
            return None;
        }
        self.reported = Some(view.clone());
        Some(ProgressView { rejected: std::mem::take(&mut self.rejected), ..view })
    }

    /// Begins another phase if there is one. The best candidate of a round is rejected if the round did not add it.
    /// Within a round, the next phase tries it again.
    fn follow_phase(&mut self, view: &ProgressView) {
        if (self.place.0, self.place.1.as_str()) == (view.round, view.phase.as_str()) {
            return;
        }
        let is_other_round = self.place.0 != view.round;
        self.place = (view.round, view.phase.clone());
        let best = self.best.take().filter(|best| is_other_round && !view.added.contains(&best.effect));
        self.rejected.extend(best);
    }

    /// Notes a trial. All candidates but the best one are rejected. An effect can be tried in several forms at a site;
    /// it is rejected only if none of them is the best.
    fn note_trial(&mut self, trial: RejectedView, best: Option<&str>) {
        if best != Some(trial.effect.as_str()) {
            return self.rejected.push(trial);
        }
        let displaced = self.best.replace(trial);
        self.rejected.extend(displaced.filter(|displaced| Some(displaced.effect.as_str()) != best));
    }

    /// Whether the client should get an event: something that it shows has changed, or a hundredth of the phase is
    /// complete.
    fn is_due(&self, view: &ProgressView) -> bool {
        let Some(known) = &self.reported else { return true };
        let step = (view.total / EVENTS_PER_PHASE).max(1);
        let has_progress = view.done >= known.done + step;
        let is_complete = view.done > known.done && view.done == view.total;
        // Everything but the count and the rejected candidates.
        let without_count =
            |view: &ProgressView| ProgressView { done: 0, rejected: Vec::new(), ..view.clone() };
        has_progress || is_complete || without_count(known) != without_count(view)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Progress in round 1: `done` trials of `total` in a phase.
    fn progress(phase: &str, done: u64, total: u64, best: Option<&str>) -> ProgressView {
        ProgressView {
            round: 1,
            phase: phase.to_owned(),
            done,
            total,
            added: Vec::new(),
            best: best.map(str::to_owned),
            rejected: Vec::new(),
        }
    }

    /// A trial of an effect.
    fn trial(effect: &str, rms: f64) -> Option<RejectedView> {
        Some(RejectedView { effect: effect.to_owned(), rms: Some(rms) })
    }

    /// The effects that an event rejects.
    fn rejected(event: Option<ProgressView>) -> Vec<String> {
        event.into_iter().flat_map(|view| view.rejected).map(|view| view.effect).collect()
    }

    #[test]
    fn all_candidates_but_the_best_are_rejected() {
        let mut log = ProgressLog::default();
        assert!(log.take(progress("quick", 0, 4, None), None).is_some());
        assert!(rejected(log.take(progress("quick", 1, 4, Some("a")), trial("a", 3.0))).is_empty());
        assert_eq!(rejected(log.take(progress("quick", 2, 4, Some("a")), trial("b", 5.0))), ["b"]);
        assert_eq!(rejected(log.take(progress("quick", 3, 4, Some("c")), trial("c", 2.0))), ["a"]);
        // Another form of the best effect is worse.
        assert!(rejected(log.take(progress("quick", 4, 4, Some("c")), trial("c", 9.0))).is_empty());
        // The next phase tries the best one again.
        assert!(rejected(log.take(progress("full", 0, 2, None), None)).is_empty());
    }

    #[test]
    fn the_best_candidate_of_a_round_is_rejected_if_it_is_not_added() {
        let next = |added: &[&str]| ProgressView {
            round: 2,
            added: added.iter().map(|name| (*name).to_owned()).collect(),
            ..progress("quick", 0, 4, None)
        };
        for (added, expected) in [(vec!["a"], vec![]), (vec![], vec!["a"])] {
            let mut log = ProgressLog::default();
            log.take(progress("full", 1, 1, Some("a")), trial("a", 3.0));
            assert_eq!(rejected(log.take(next(&added), None)), expected);
        }
    }

    #[test]
    fn a_phase_has_at_most_a_hundred_events_without_changes() {
        let mut log = ProgressLog::default();
        let events = (0..=1234).filter_map(|done| {
            let best = trial(if done % 7 == 0 { "a" } else { "b" }, 2.0).filter(|_| done > 0);
            log.take(progress("quick", done, 1234, Some("a")), best)
        });
        let events: Vec<_> = events.collect();
        assert!((90..=105).contains(&events.len()), "{}", events.len());
        let rejected = events.iter().map(|event| event.rejected.len()).sum::<usize>();
        assert_eq!(rejected, 1234 - 1234 / 7, "no candidate is lost");
        assert_eq!(events.last().map(|event| event.done), Some(1234));
    }
}
