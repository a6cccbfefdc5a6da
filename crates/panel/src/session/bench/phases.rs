//! The phases that the machine plays in each mode, and the points that it passes on to the scopes.

use patchcord_core::solve::{LiveState, Phase};

use super::{Bench, STEPS_BETWEEN_QUESTIONS};
use crate::command::Mode;
use crate::scope::Scope;

/// Largest number of consecutive phases that take no time in one advance. An overload can end every sweep at its
/// beginning, and a run can have millions of initial conditions.
const MAX_IDLE_PHASES: usize = 1000;

impl Bench {
    /// The phases of one sweep: those of the patch, unless the user has set another length.
    fn sweep_phases(&self) -> Vec<Phase> {
        match (self.controls.sweep, &self.plan) {
            (None, Some(phases)) => phases.clone(),
            _ => vec![Phase::InitialCondition, Phase::operate(self.sweep())],
        }
    }

    /// Begins the mode from initial condition.
    pub(super) fn begin_mode(&mut self, scopes: &mut [Scope]) {
        let phases = match self.controls.mode {
            Mode::Repetitive | Mode::Single => self.sweep_phases(),
            Mode::Operate => vec![Phase::InitialCondition, Phase::operate(self.sweep())],
            Mode::Hold | Mode::PotSet | Mode::ProblemCheck | Mode::InitialCondition => {
                vec![Phase::InitialCondition]
            }
        };
        (self.repetitions, self.ahead, self.last_point) = (0, 0.0, f64::INFINITY);
        self.play_phases(&phases);
        self.with_live(|live| {
            live.forget_checkpoints();
            Ok(())
        });
        self.follow(0.0, scopes, &mut || false);
    }

    /// Replaces the phases that the machine plays, and drops the records of those that it has played.
    pub(super) fn play_phases(&mut self, phases: &[Phase]) {
        let mode = self.controls.mode;
        self.with_live(|live| {
            live.plays = Some(mode);
            live.run.replace_phases(phases)?;
            live.run.take_samples();
            Ok(())
        });
    }

    /// Lets the machine follow the clock by problem seconds, which may be infinite. Returns those that it covered.
    pub(super) fn follow(
        &mut self,
        asked: f64,
        scopes: &mut [Scope],
        must_stop: &mut dyn FnMut() -> bool,
    ) -> f64 {
        let (mut left, mut done, mut idle_phases) = (asked - self.ahead, 0.0, 0);
        while self.stopped.is_none() && self.has_phase_to_play(left) {
            let before = self.clock();
            let outcome = self.with_live(|live| live.run.advance(before + left, STEPS_BETWEEN_QUESTIONS));
            let after = self.clock();
            self.pass_points(scopes);
            if after < before {
                self.begin_repetition();
            } else {
                (left, done) = (left - (after - before), done + (after - before));
                // The time that is left is shorter than a step, or the machine is ahead.
                if left <= 0.0 || outcome == Some(LiveState::Operating) && after == before {
                    break;
                }
            }
            idle_phases = if after == before { idle_phases + 1 } else { 0 };
            if must_stop() || idle_phases == MAX_IDLE_PHASES {
                left = 0.0;
                break;
            }
        }
        self.ahead = if left.is_finite() { -left } else { 0.0 };
        done.min(asked)
    }

    /// Whether the machine has something to play while `left` problem seconds are left: a phase without a duration, or
    /// one in which it operates. Modes without end get new phases. After an overload that holds the machine, the mode is
    /// hold.
    fn has_phase_to_play(&mut self, left: f64) -> bool {
        let position =
            self.with_live(|live| Ok((live.run.is_finished(), live.run.is_operating(), live.run.is_held())));
        let Some((is_finished, is_operating, is_held)) = position else { return false };
        if !is_finished {
            return left > 0.0 || !is_operating;
        }
        let phases = match self.controls.mode {
            Mode::Operate if !is_held => vec![Phase::operate(self.sweep())],
            Mode::Repetitive => self.sweep_phases(),
            Mode::Operate | Mode::Single => {
                self.controls.mode = Mode::Hold;
                return false;
            }
            _ => return false,
        };
        if left > 0.0 {
            self.play_phases(&phases);
        }
        left > 0.0
    }

    /// Notes that the machine was put into initial condition.
    fn begin_repetition(&mut self) {
        if self.controls.mode == Mode::Repetitive {
            self.repetitions = self.repetitions.wrapping_add(1);
        }
        self.with_live(|live| {
            live.forget_checkpoints();
            live.run.take_samples();
            Ok(())
        });
    }

    /// Passes the watched points on to the scopes. A point at an earlier time than the last begins a run. In modes in
    /// which the machine does not move, the points are dropped.
    fn pass_points(&mut self, scopes: &mut [Scope]) {
        let (moves, sweep, mut last) = (self.moves(), self.sweep(), self.last_point);
        let keeps_checkpoints = moves && self.controls.mode != Mode::Repetitive;
        let watched = &self.watched;
        let Some(machine) = &mut self.machine else { return };
        let outcome = machine.with_dependent_mut(|_, live| {
            for (time, volts) in live.run.points().iter().filter(|_| moves) {
                if time < last {
                    scopes.iter_mut().for_each(|scope| scope.begin_run(sweep));
                }
                last = time;
                pass_point(time, volts, watched, scopes);
            }
            live.run.points().clear();
            if keeps_checkpoints { live.keep_checkpoint(false) } else { Ok(()) }
        });
        self.last_point = last;
        if let Err(error) = outcome {
            self.stopped = Some(error.to_string());
        }
    }
}

/// Passes one point on. `watched` has the names at the probes, two for each scope; `volts` has the voltages of those that
/// are connected.
pub(super) fn pass_point(time: f64, volts: &[f64], watched: &[Option<String>], scopes: &mut [Scope]) {
    let mut volts = volts.iter().copied();
    for (scope, probes) in scopes.iter_mut().zip(watched.chunks(2)) {
        let mut channels = [f64::NAN; 2];
        for (channel, probe) in channels.iter_mut().zip(probes) {
            if probe.is_some() {
                *channel = volts.next().unwrap_or(f64::NAN);
            }
        }
        scope.point(time, channels);
    }
}
