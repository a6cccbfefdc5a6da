//! The way back to an earlier time of a run.

use patchcord_core::document::format_number;
use patchcord_core::solve::{LiveState, Phase, RunError};

use super::phases::pass_point;
use super::{Bench, STEPS_BETWEEN_QUESTIONS};
use crate::command::Mode;
use crate::scope::Scope;
use crate::session::live_machine::Live;

/// The way back to an earlier time. A checkpoint before it was restored, and the run is repeated from there.
pub(super) struct WayBack {
    /// The time by the recorder's clock, in seconds.
    goal: f64,
    /// The parameters that the machine gets there.
    parameters: Vec<(String, f64)>,
}

impl Bench {
    /// Moves the machine back to an earlier time of its run, and holds it there. `parameters` are those that it gets
    /// there. If the host has no time for the whole way, the next advances continue it.
    ///
    /// # Errors
    /// The message if the time is not within the run, or if the machine waits for a patch without faults.
    pub(in crate::session) fn scrub(
        &mut self,
        time: f64,
        parameters: Vec<(String, f64)>,
        scopes: &mut [Scope],
        must_stop: &mut dyn FnMut() -> bool,
    ) -> Result<(), String> {
        if self.is_blocked {
            return Err("the patch has faults: correct them before the machine goes back".to_owned());
        }
        let clock = self.clock();
        let goal = self.with_live(|live| Ok(if time <= clock { live.return_before(time) } else { None }));
        let Some(goal) = goal.flatten() else {
            let [oldest, clock, time] = [self.oldest(), clock, time].map(format_number);
            return Err(format!(
                "the machine can be moved back to {oldest} ... {clock} s of its run, not to {time} s"
            ));
        };
        (self.stopped, self.controls.mode, self.plays) = (None, Mode::Hold, None);
        self.way_back = Some(WayBack { goal, parameters });
        self.follow_way_back(scopes, must_stop);
        Ok(())
    }

    /// Follows the way back as far as the host gives time.
    pub(super) fn follow_way_back(&mut self, scopes: &mut [Scope], must_stop: &mut dyn FnMut() -> bool) {
        let Some(goal) = self.way_back.as_ref().map(|way| way.goal) else { return };
        let further = Phase::operate(self.sweep());
        let arrives = self.with_live(|live| play_up_to(live, goal, &further, must_stop));
        if arrives != Some(false) {
            self.end_way_back(scopes);
        }
    }

    /// Ends the way back at the present instant, if the machine is on one: it gets the present parameters, and the scopes
    /// go back to this point.
    pub(super) fn end_way_back(&mut self, scopes: &mut [Scope]) {
        let (Some(way), Some(machine)) = (self.way_back.take(), &mut self.machine) else { return };
        let watched = &self.watched;
        let outcome = machine.with_dependent_mut(|_, live| {
            live.run.set_parameters(way.parameters.iter().map(|(name, value)| (name, *value)))?;
            if let Some((time, volts)) = live.run.points().iter().last() {
                pass_point(time, volts, watched, scopes);
            }
            live.run.points().clear();
            live.note_change()
        });
        if let Err(error) = outcome {
            self.stopped = Some(error.to_string());
        }
        (self.ahead, self.last_point) = (0.0, self.clock());
    }
}

/// Plays a run up to a time by the recorder's clock, within a step, and keeps the last points only. `further` is the
/// phase that operation without end has after each other one. Returns whether the run arrives there before the host has
/// no more time.
///
/// # Errors
/// If the run has to stop.
fn play_up_to(
    live: &mut Live<'_>,
    clock: f64,
    further: &Phase,
    must_stop: &mut dyn FnMut() -> bool,
) -> Result<bool, RunError> {
    loop {
        let before = live.run.clock();
        if before >= clock || live.run.is_held() {
            return Ok(true);
        }
        if live.run.is_finished() {
            live.run.replace_phases(std::slice::from_ref(further))?;
        }
        live.run.points().clear();
        let state = live.run.advance(clock, STEPS_BETWEEN_QUESTIONS)?;
        if state == LiveState::Operating && live.run.clock() == before {
            return Ok(true);
        }
        if must_stop() {
            return Ok(false);
        }
    }
}
