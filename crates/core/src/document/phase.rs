//! The phases of a run: what the machine does, for how long, and which parameters change in between.

use super::Placed;
use super::diagnostic::Span;
use patchcord_expr::{Formula, FormulaError};

/// A phase of a run. Times are in problem seconds, except that of [`Phase::Hold`].
///
/// # Examples
///
/// ```
/// use patchcord_core::document::Phase;
///
/// // A family of five curves. Each has twice the spring stiffness of the one before.
/// let family = Phase::Repeat {
///     times: 5,
///     phases: vec![Phase::InitialCondition, Phase::set_by("k", "2 * k")?, Phase::operate(2.0)],
/// };
/// // Runs until the relay K1 pulls in, at most 10 s.
/// let impact = Phase::operate_until(10.0, "K1", Some("pulled-in"));
/// # assert_ne!(family, impact);
/// # Ok::<(), patchcord_expr::FormulaError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Phase {
    /// Sets the integrators to their initial conditions and the time to 0, and resets the overload lamps. A new
    /// repetition of the record begins.
    InitialCondition,
    /// Integrates.
    Operate {
        /// Duration in problem seconds, above 0. With `until` it is the longest duration.
        time: f64,
        /// The relay that ends the phase earlier, at the instant at which it switches.
        until: Option<SwitchCondition>,
    },
    /// Holds every integrator and the problem time. The recorder continues.
    Hold {
        /// Duration in seconds of the recorder's clock, above 0.
        time: f64,
    },
    /// Sets parameters, all at the same instant. They keep the values until they are set again or the run ends.
    Set {
        /// The changes. Their formulas use the values from before the phase.
        changes: Vec<ParameterChange>,
    },
    /// Repeats phases.
    Repeat {
        /// How often the phases are executed.
        times: u64,
        /// The phases, in order.
        phases: Vec<Phase>,
    },
}

/// The switching of a relay that ends a phase.
#[derive(Debug, Clone, PartialEq)]
pub struct SwitchCondition {
    /// Name of the relay.
    pub relay: Placed<String>,
    /// The position to which the relay must switch, such as "pulled-in". `None` if every change of position counts.
    pub becomes: Option<Placed<String>>,
}

/// A parameter with its new value.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterChange {
    /// Name of the parameter.
    pub parameter: Placed<String>,
    /// The new value: a number in the parameter's unit, or a formula of parameters, scales and signals.
    pub to: Placed<Formula>,
}

impl Phase {
    /// Operates for a time in problem seconds.
    pub fn operate(time: f64) -> Self {
        Phase::Operate { time, until: None }
    }

    /// Operates until a relay switches, at most for a time in problem seconds.
    ///
    /// `becomes` is the position to which the relay must switch; `None` if every change of position counts.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::document::Phase;
    ///
    /// let Phase::Operate { time, until: Some(condition) } = Phase::operate_until(10.0, "K1", None) else {
    ///     panic!("the phase waits for a relay");
    /// };
    /// assert_eq!(time, 10.0);
    /// assert_eq!(condition.relay.value, "K1");
    /// ```
    pub fn operate_until(time: f64, relay: &str, becomes: Option<&str>) -> Self {
        let becomes = becomes.map(|position| unplaced(position.to_owned()));
        let condition = SwitchCondition { relay: unplaced(relay.to_owned()), becomes };
        Phase::Operate { time, until: Some(condition) }
    }

    /// Sets one parameter to a value in its declared unit.
    pub fn set(parameter: &str, value: f64) -> Self {
        Phase::Set { changes: vec![ParameterChange::new(parameter, Formula::constant(value))] }
    }

    /// Sets one parameter to the value of a formula, such as "2 * k".
    ///
    /// # Errors
    /// If the text is not a formula. Its names and units are checked when a circuit is made.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::document::Phase;
    ///
    /// let Phase::Set { changes } = Phase::set_by("k", "2 * k")? else { panic!("the phase sets k") };
    /// assert_eq!(changes[0].parameter.value, "k");
    /// assert_eq!(changes[0].to.value.text(), "2 * k");
    /// assert!(Phase::set_by("k", "2 k").is_err());
    /// # Ok::<(), patchcord_expr::FormulaError>(())
    /// ```
    pub fn set_by(parameter: &str, formula: &str) -> Result<Self, FormulaError> {
        Ok(Phase::Set { changes: vec![ParameterChange::new(parameter, Formula::parse(formula)?)] })
    }

    /// Calls `each` for this phase. For a repetition, calls it once for each of the repeated phases instead.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::document::Phase;
    ///
    /// let phases = vec![Phase::InitialCondition, Phase::operate(2.0), Phase::Hold { time: 0.5 }];
    /// let mut seconds = 0.0;
    /// Phase::Repeat { times: 5, phases }.for_each(&mut |phase| match phase {
    ///     Phase::Operate { time, .. } | Phase::Hold { time } => seconds += time,
    ///     _ => {}
    /// });
    /// // The repeated phases are visited once.
    /// assert_eq!(seconds, 2.5);
    /// ```
    pub fn for_each<'p>(&'p self, each: &mut impl FnMut(&'p Phase)) {
        match self {
            Phase::Repeat { phases, .. } => phases.iter().for_each(|phase| phase.for_each(each)),
            _ => each(self),
        }
    }
}

impl ParameterChange {
    /// A change that does not come from a document.
    pub fn new(parameter: &str, to: Formula) -> Self {
        ParameterChange { parameter: unplaced(parameter.to_owned()), to: unplaced(to) }
    }
}

/// A value without a position in a document.
fn unplaced<T>(value: T) -> Placed<T> {
    Placed { value, span: Span::default() }
}

/// The durations and sizes of a list of phases if no relay ends a phase early.
///
/// It is computed without executing repetitions one by one, so a billion of them take no longer than one. Every number
/// is an `f64`: products of nested repetitions can exceed the range of integers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct RunExtent {
    /// Total time in operate, in problem seconds.
    pub operate_time: f64,
    /// Total time of the recorder's clock, in seconds: operate and hold.
    pub record_time: f64,
    /// Number of phases, with every repetition counted.
    pub phase_count: f64,
    /// Number of parameter changes, with every repetition counted.
    pub change_count: f64,
    /// Recorder time of the longest repetition, in seconds. It lasts from one initial condition to the next.
    pub longest_repetition: f64,
    /// Recorder time before the first initial condition, in seconds.
    head: f64,
    /// Recorder time after the last initial condition, in seconds. It equals `head` if there is no initial condition.
    tail: f64,
    /// Whether there is an initial condition.
    resets: bool,
}

impl RunExtent {
    /// The extent of phases that are executed in order.
    pub(crate) fn of(phases: &[Phase]) -> Self {
        phases.iter().map(RunExtent::of_phase).fold(RunExtent::default(), RunExtent::then)
    }

    /// The extent of one phase. A repetition is measured from the extent of its phases.
    fn of_phase(phase: &Phase) -> Self {
        match phase {
            Phase::InitialCondition => RunExtent { phase_count: 1.0, resets: true, ..RunExtent::default() },
            Phase::Set { changes } => {
                RunExtent { phase_count: 1.0, change_count: changes.len() as f64, ..RunExtent::default() }
            }
            Phase::Operate { time, .. } => RunExtent { operate_time: *time, ..RunExtent::lasting(*time) },
            Phase::Hold { time } => RunExtent::lasting(*time),
            Phase::Repeat { times, phases } => RunExtent::of(phases).repeated(*times as f64),
        }
    }

    /// The extent of one phase that records for a time.
    fn lasting(time: f64) -> Self {
        RunExtent {
            record_time: time,
            phase_count: 1.0,
            longest_repetition: time,
            head: time,
            tail: time,
            ..RunExtent::default()
        }
    }

    /// The extent of these phases followed by others. The repetition at the seam lasts from the tail to the next head.
    fn then(self, next: RunExtent) -> Self {
        let between = self.tail + next.head;
        RunExtent {
            operate_time: self.operate_time + next.operate_time,
            record_time: self.record_time + next.record_time,
            phase_count: self.phase_count + next.phase_count,
            change_count: self.change_count + next.change_count,
            longest_repetition: self.longest_repetition.max(next.longest_repetition).max(between),
            head: if self.resets { self.head } else { between },
            tail: if next.resets { next.tail } else { between },
            resets: self.resets || next.resets,
        }
    }

    /// The extent of these phases executed several times.
    fn repeated(self, times: f64) -> Self {
        // With an initial condition, two passes contain every kind of repetition. Without one, all times add up.
        let twice = if times > 1.0 { self.then(self) } else { self };
        let repetition_time = |once: f64, in_two: f64| if self.resets { in_two } else { once * times };
        RunExtent {
            operate_time: self.operate_time * times,
            record_time: self.record_time * times,
            phase_count: self.phase_count * times,
            change_count: self.change_count * times,
            longest_repetition: repetition_time(self.longest_repetition, twice.longest_repetition),
            head: repetition_time(self.head, twice.head),
            tail: repetition_time(self.tail, twice.tail),
            resets: self.resets,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The phases with every repetition written out.
    fn unrolled(phases: &[Phase]) -> Vec<Phase> {
        let each = |phase: &Phase| match phase {
            Phase::Repeat { times, phases } => (0..*times).flat_map(|_| unrolled(phases)).collect(),
            other => vec![other.clone()],
        };
        phases.iter().flat_map(each).collect()
    }

    #[test]
    fn repetitions_have_the_extent_of_the_phases_written_out() {
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
            assert_eq!(RunExtent::of(&list), RunExtent::of(&unrolled(&list)), "{list:?}");
        }
    }

    #[test]
    fn a_billion_repetitions_are_measured_without_a_loop() {
        let list = [Phase::Repeat { times: 1_000_000_000, phases: vec![Phase::operate(0.25)] }];
        let extent = RunExtent::of(&list);
        assert_eq!((extent.operate_time, extent.longest_repetition, extent.phase_count), (2.5e8, 2.5e8, 1e9));
    }
}
