//! A step of a kernel that is tried and then accepted up to its first event.
//!
//! Events are located as in the solver ([`first_event`]). A corner ends the step; at a change of mode and at the end of
//! a range the kernel halts.

use super::Halt;
use crate::kernel::{Backend, Frame, LookResult, SharedKernel, WatchHit, WatchKind};
use crate::solve::event_location::{EventFunction, first_event};
use crate::trace::WorkCounters;

/// A tried step of a kernel, in which events are located. Its values are in volts, as those of the machine.
pub(super) struct KernelTrial<'a> {
    /// The kernel.
    pub shared: &'a SharedKernel,
    /// The backend that evaluates the step.
    pub backend: Backend,
    /// The variables of the kernel.
    pub frame: &'a mut Frame<f64>,
    /// The points of all tables of the program.
    pub tables: &'a [Vec<[f64; 2]>],
    /// Counts the evaluations of all tries and the accepted steps.
    pub work: &'a mut WorkCounters,
    /// The result of the step tried last.
    pub last: LookResult,
}

/// How a tried step of a kernel ends.
#[derive(Debug, Clone, Copy)]
pub(super) enum TrialEnd {
    /// The kernel is on this corner, and leaves it on the other side than that of its branch.
    OnCorner(WatchHit),
    /// The kernel halts before the end of the step.
    Halted(Halt),
    /// The step can be accepted.
    At {
        /// The problem time at its end, in seconds.
        time: f64,
        /// The corner at its end, if there is one.
        corner: Option<WatchHit>,
    },
}

impl KernelTrial<'_> {
    /// Tries a step to the end of the present piece, at most to the problem time `end`, and locates the first event in
    /// it.
    #[inline]
    pub(super) fn locate_end(&mut self, end: f64) -> TrialEnd {
        let target = self.shared.kernel.end_of_piece(self.frame, end);
        let length = target - self.frame.time;
        self.evaluate(length);
        if self.shared.kernel.has_turn(self.frame) {
            return TrialEnd::Halted(Halt::Unsupported);
        }
        if let Some(hit) = self.shared.kernel.passed_corner(self.frame) {
            return TrialEnd::OnCorner(hit);
        }
        // The machine takes the step if a range ends.
        if self.event().is_some_and(|hit| hit.kind == WatchKind::Range) {
            return TrialEnd::Halted(Halt::Unsupported);
        }
        let (share, corner) = first_event(self, length, None);
        let time = if share >= 1.0 { target } else { self.frame.time + share * length };
        match corner.map(|hit| hit.kind) {
            Some(WatchKind::Guard) => TrialEnd::Halted(Halt::ModeChange(share * length)),
            Some(WatchKind::Range) => TrialEnd::Halted(Halt::Unsupported),
            _ => TrialEnd::At { time, corner },
        }
    }

    /// Accepts the tried step, which ends at this problem time. `is_at_corner` is whether it ends at a corner.
    #[inline]
    pub(super) fn accept(&mut self, time: f64, is_at_corner: bool) {
        self.work.steps += 1;
        self.shared.kernel.accept_step(self.frame, time);
        if is_at_corner {
            self.shared.kernel.mark_discontinuity(self.frame);
        }
    }

    /// Accepts the tried step up to a jump at this problem time, which the machine handles.
    pub(super) fn accept_up_to(&mut self, time: f64) {
        self.work.steps += 1;
        self.shared.kernel.accept_step_before_jump(self.frame, time);
    }
}

impl EventFunction for KernelTrial<'_> {
    type Event = WatchHit;

    fn evaluate(&mut self, length: f64) {
        self.work.evaluations += 4;
        self.last = self.shared.look(self.frame, self.tables, length, self.backend);
    }

    fn event(&self) -> Option<WatchHit> {
        if self.last == LookResult::AtEnd { self.shared.kernel.first_hit(self.frame) } else { None }
    }

    fn has_hint(&self) -> bool {
        matches!(self.last, LookResult::Inside(_))
    }

    fn hint_share(&self) -> f64 {
        if let LookResult::Inside(share) = self.last { share } else { 1.0 }
    }

    fn present_value(&self, hit: WatchHit) -> f64 {
        self.shared.kernel.value_now(self.frame, hit)
    }

    fn value(&self, hit: WatchHit) -> f64 {
        self.shared.kernel.value(self.frame, hit)
    }

    fn tolerance(&self, hit: WatchHit) -> f64 {
        hit.tolerance()
    }
}
