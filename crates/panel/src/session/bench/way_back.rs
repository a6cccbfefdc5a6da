//! The way to another time of a run: back, and forward again up to its end.
//!
//! The run keeps its checkpoints and the scopes keep their traces until it continues from an earlier time.

use patchcord_core::document::format_number;
use patchcord_core::solve::{LiveState, Phase, RunError};

use super::phases::pass_point;
use super::{Bench, STEPS_BETWEEN_QUESTIONS};
use crate::command::Mode;
use crate::scope::Scope;
use crate::session::live_machine::Live;

impl Bench {
    /// Moves the machine to an earlier time of its run, or forward again, and holds it there. A checkpoint before this time
    /// is restored, and the run is repeated from there. If the host has no time for the whole way, the next advances
    /// continue it.
    ///
    /// # Errors
    /// The message if the time is not within the run, or if the machine waits for a patch without faults.
    pub(in crate::session) fn scrub(
        &mut self,
        time: f64,
        scopes: &mut [Scope],
        must_stop: &mut dyn FnMut() -> bool,
    ) -> Result<(), String> {
        if self.is_blocked {
            return Err("the patch has faults: correct them before the machine goes back".to_owned());
        }
        let goal = self.with_live(|live| Ok(live.return_before(time))).flatten();
        let Some(goal) = goal else {
            let Some(oldest) = self.oldest() else {
                return Err("there is no earlier time to which the machine can be moved back".to_owned());
            };
            let latest = self.latest().unwrap_or(self.clock());
            let [oldest, latest, time] = [oldest, latest, time].map(format_number);
            return Err(format!(
                "the machine can be moved back to {oldest} ... {latest} s of its run, not to {time} s"
            ));
        };
        (self.stopped, self.controls.mode) = (None, Mode::Hold);
        self.way_back = Some(goal);
        self.follow_way_back(scopes, must_stop);
        Ok(())
    }

    /// Follows the way as far as the host gives time.
    pub(super) fn follow_way_back(&mut self, scopes: &mut [Scope], must_stop: &mut dyn FnMut() -> bool) {
        let Some(goal) = self.way_back else { return };
        let further = Phase::operate(self.sweep());
        let arrives = self.with_live(|live| play_up_to(live, goal, &further, must_stop));
        if arrives != Some(false) {
            self.end_way_back(scopes);
        }
    }

    /// Ends the way at the present instant, if the machine is on it. It has the present parameters there, and the scopes
    /// show the screen with this time.
    pub(super) fn end_way_back(&mut self, scopes: &mut [Scope]) {
        if self.way_back.take().is_none() {
            return;
        }
        self.with_live(|live| live.adopt_later_values());
        self.ahead = 0.0;
        let clock = self.clock();
        scopes.iter_mut().for_each(|scope| scope.show(clock));
    }

    /// Forgets what a machine that was moved back did after the present instant, also on the scopes, because its run
    /// continues otherwise.
    pub(super) fn forget_later(&mut self, scopes: &mut [Scope]) {
        self.end_way_back(scopes);
        if self.latest().is_none() {
            return;
        }
        let (clock, watched) = (self.clock(), self.watched.clone());
        self.with_live(|live| {
            let machine = live.run.machine()?;
            let names = watched.iter().flatten();
            let volts: Vec<f64> = names.map(|name| machine.voltage(name).unwrap_or(f64::NAN)).collect();
            pass_point(clock, &volts, &watched, scopes);
            live.forget_later()
        });
        self.last_point = clock;
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
