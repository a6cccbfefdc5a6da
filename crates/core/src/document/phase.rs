//! The phases of a run: what the machine does, for how long, and what is changed in between.

use super::Placed;
use super::diagnostic::Span;
use patchcord_expr::{Formula, FormulaError};

/// A part of a run. Times are in problem seconds.
///
/// ```
/// use patchcord_core::document::Phase;
///
/// // A family of curves: five runs, the spring twice as stiff with each.
/// let family = Phase::Repeat {
///     times: 5,
///     phases: vec![Phase::InitialCondition, Phase::set_by("k", "2 * k")?, Phase::operate(2.0)],
/// };
/// // Runs at most 10 s, to the instant at which the relay K1 pulls in.
/// let impact = Phase::operate_until(10.0, "K1", Some("pulled-in"));
/// # assert_ne!(family, impact);
/// # Ok::<(), patchcord_expr::FormulaError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Phase {
    /// Puts integrators at their initial conditions, time at 0 and the lamps out; begins a run of its own in
    /// the record.
    InitialCondition,
    /// Integrates.
    Operate {
        /// How long, above 0 s; with `until`, at most.
        time: f64,
        /// What ends it earlier, at the very instant.
        until: Option<Until>,
    },
    /// Keeps every integrator and problem time where they are, while the recorder runs on.
    Hold {
        /// How long by the recorder's clock, above 0 s.
        time: f64,
    },
    /// Sets parameters, all at one instant; they stay so until they are set again or the run ends.
    Set {
        /// The parameters and what they are set to. Formulas see everything as it was before.
        changes: Vec<Change>,
    },
    /// Does the same several times.
    Repeat {
        /// How many times.
        times: u64,
        /// What.
        phases: Vec<Phase>,
    },
}

/// The switching of a relay that ends a phase.
#[derive(Debug, Clone, PartialEq)]
pub struct Until {
    /// Name of the relay.
    pub relay: Placed<String>,
    /// The position that it must go to ("pulled-in"); without one, either.
    pub becomes: Option<Placed<String>>,
}

/// A parameter set anew.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Name of the parameter.
    pub parameter: Placed<String>,
    /// A number in its unit, or a formula of parameters, scales and signals.
    pub to: Placed<Formula>,
}

impl Phase {
    /// Operating for a time.
    pub fn operate(time: f64) -> Self {
        Phase::Operate { time, until: None }
    }

    /// Operating until a relay switches, to this position if one is named, and at most for a time.
    pub fn operate_until(time: f64, relay: &str, becomes: Option<&str>) -> Self {
        let until =
            Until { relay: unplaced(relay.to_owned()), becomes: becomes.map(|to| unplaced(to.to_owned())) };
        Phase::Operate { time, until: Some(until) }
    }

    /// Setting one parameter to a value in its unit.
    pub fn set(parameter: &str, value: f64) -> Self {
        Phase::Set { changes: vec![Change::new(parameter, Formula::constant(value))] }
    }

    /// Setting one parameter by a formula.
    ///
    /// # Errors
    /// When the text is not a formula.
    pub fn set_by(parameter: &str, formula: &str) -> Result<Self, FormulaError> {
        Ok(Phase::Set { changes: vec![Change::new(parameter, Formula::parse(formula)?)] })
    }

    /// Calls `each` for this phase, or for those that it repeats, each once.
    pub fn for_each<'p>(&'p self, each: &mut impl FnMut(&'p Phase)) {
        match self {
            Phase::Repeat { phases, .. } => phases.iter().for_each(|phase| phase.for_each(each)),
            _ => each(self),
        }
    }
}

impl Change {
    /// A change that stands in no document.
    pub fn new(parameter: &str, to: Formula) -> Self {
        Change { parameter: unplaced(parameter.to_owned()), to: unplaced(to) }
    }
}

fn unplaced<T>(value: T) -> Placed<T> {
    Placed { value, span: Span::default() }
}

/// How far phases reach when every one takes all of its time, found without going through repetitions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Extent {
    /// Seconds of operating.
    pub operated: f64,
    /// Seconds of the recorder's clock.
    pub recorded: f64,
    /// Phases gone through.
    pub phases: f64,
    /// Parameters set.
    pub changes: f64,
    /// Seconds of the longest stretch between initial conditions.
    pub longest: f64,
    /// Seconds before the first initial condition.
    head: f64,
    /// Seconds after the last initial condition; the same as `head` where there is none.
    tail: f64,
    resets: bool,
}

impl Extent {
    pub fn of(phases: &[Phase]) -> Self {
        phases.iter().map(Extent::of_one).fold(Extent::default(), Extent::then)
    }

    fn of_one(phase: &Phase) -> Self {
        match phase {
            Phase::InitialCondition => Extent { phases: 1.0, resets: true, ..Extent::default() },
            Phase::Set { changes } => {
                Extent { phases: 1.0, changes: changes.len() as f64, ..Extent::default() }
            }
            Phase::Operate { time, .. } => Extent { operated: *time, ..Extent::lasting(*time) },
            Phase::Hold { time } => Extent::lasting(*time),
            Phase::Repeat { times, phases } => Extent::of(phases).repeated(*times as f64),
        }
    }

    fn lasting(time: f64) -> Self {
        Extent { recorded: time, phases: 1.0, longest: time, head: time, tail: time, ..Extent::default() }
    }

    fn then(self, next: Extent) -> Self {
        let between = self.tail + next.head;
        Extent {
            operated: self.operated + next.operated,
            recorded: self.recorded + next.recorded,
            phases: self.phases + next.phases,
            changes: self.changes + next.changes,
            longest: self.longest.max(next.longest).max(between),
            head: if self.resets { self.head } else { between },
            tail: if next.resets { next.tail } else { between },
            resets: self.resets || next.resets,
        }
    }

    fn repeated(self, times: f64) -> Self {
        // Between initial conditions, twice is as long as any number of times; without one everything adds up.
        let shape = if times > 1.0 { self.then(self) } else { self };
        let stretch = |once: f64, shaped: f64| if self.resets { shaped } else { once * times };
        Extent {
            operated: self.operated * times,
            recorded: self.recorded * times,
            phases: self.phases * times,
            changes: self.changes * times,
            longest: stretch(self.longest, shape.longest),
            head: stretch(self.head, shape.head),
            tail: stretch(self.tail, shape.tail),
            resets: self.resets,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The list with its repetitions written out.
    fn unrolled(phases: &[Phase]) -> Vec<Phase> {
        let each = |phase: &Phase| match phase {
            Phase::Repeat { times, phases } => (0..*times).flat_map(|_| unrolled(phases)).collect(),
            other => vec![other.clone()],
        };
        phases.iter().flat_map(each).collect()
    }

    #[test]
    fn the_extent_of_repetitions_is_that_of_the_list_written_out() {
        let repeat = |times, phases| Phase::Repeat { times, phases };
        let (initial, set) = (Phase::InitialCondition, Phase::set("k", 2.0));
        let (operate, hold) = (Phase::operate(2.0), Phase::Hold { time: 0.5 });
        let within = vec![hold.clone(), initial.clone(), operate.clone(), repeat(3, vec![hold.clone(), set])];
        let lists = [
            vec![initial.clone(), operate.clone()],
            vec![repeat(4, vec![initial, operate.clone()])],
            vec![repeat(5, vec![operate.clone(), hold])],
            vec![operate.clone(), repeat(3, within.clone()), operate],
            vec![repeat(2, vec![repeat(3, within)])],
        ];
        for list in lists {
            assert_eq!(Extent::of(&list), Extent::of(&unrolled(&list)), "{list:?}");
        }
    }

    #[test]
    fn a_billion_repetitions_are_measured_at_once() {
        let list = [Phase::Repeat { times: 1_000_000_000, phases: vec![Phase::operate(0.25)] }];
        let extent = Extent::of(&list);
        assert_eq!((extent.operated, extent.longest, extent.phases), (2.5e8, 2.5e8, 1e9));
    }
}
