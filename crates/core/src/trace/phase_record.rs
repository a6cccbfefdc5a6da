//! Where the phases of a run begin and end in its trace.
//!
//! A run consists of phases: initial condition, operate, hold and changes of parameters. The solver appends one
//! [`PhaseRecord`] for each completed phase. Reports and drawings read from it when a phase began, why it ended and
//! which parameters changed.

use super::Trace;

/// One completed phase of a run.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{Phase, RunSettings, run};
/// use patchcord_core::trace::PhaseKind;
///
/// // dx/dt = -x, from 50 V
/// # let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// # let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let settings = RunSettings::of(&circuit)?.with_phases([Phase::operate(1.0), Phase::Hold { time: 0.5 }]);
/// let trace = run(&program, &settings)?;
/// assert_eq!(trace.phase_records[0].phase, PhaseKind::InitialCondition);
/// let hold = &trace.phase_records[2];
/// assert_eq!(hold.phase, PhaseKind::Hold);
/// assert!((hold.begin - 1.0).abs() < 1e-9 && (hold.end - 1.5).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseRecord {
    /// What the machine did in the phase.
    pub phase: PhaseKind,
    /// Index of the repetition that it belongs to, from 0.
    pub repetition: usize,
    /// Time at which it began, in seconds of the recorder's clock.
    pub begin: f64,
    /// Time at which it ended, in seconds of the recorder's clock.
    pub end: f64,
    /// Problem time at which it began, in seconds. It is smaller than `begin` by the time spent in hold before.
    pub problem_time: f64,
    /// Index of the sample at which it began. Initial condition and a change of parameters take no time: for them it
    /// is the next sample.
    pub sample: usize,
    /// Why it ended.
    pub ended: PhaseEnd,
}

/// What the machine did in a phase.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum PhaseKind {
    /// The integrators were set to their initial conditions.
    InitialCondition,
    /// The integrators integrated.
    Operate {
        /// Name of the relay that should end the phase, and the position that it should reach. A position of `None`
        /// means any change. `None` if only time ends the phase.
        until: Option<(String, Option<String>)>,
    },
    /// The integrators kept their voltages; problem time stopped.
    Hold,
    /// Parameters were changed.
    Set(Vec<NewValue>),
}

/// A changed parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct NewValue {
    /// Name of the parameter.
    pub parameter: String,
    /// The new value, in the declared unit.
    pub value: f64,
    /// The previous value, in the declared unit.
    pub before: f64,
    /// Text of the declared unit.
    pub unit: String,
}

/// Why a phase ended.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum PhaseEnd {
    /// Its duration was over.
    Time,
    /// The relay that it waited for switched to this position.
    Switched(String),
    /// An overload put the machine into hold.
    Overload,
    /// An error ended the run, or the caller did.
    Stopped,
}

impl PhaseKind {
    /// The parameters that the phase changed; empty for every other kind of phase.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::trace::{NewValue, PhaseKind};
    ///
    /// let change = NewValue { parameter: "k".to_owned(), value: 2.0, before: 1.0, unit: "N/m".to_owned() };
    /// assert_eq!(PhaseKind::Set(vec![change.clone()]).new_values(), [change]);
    /// assert!(PhaseKind::Hold.new_values().is_empty());
    /// ```
    pub fn new_values(&self) -> &[NewValue] {
        match self {
            PhaseKind::Set(values) => values,
            _ => &[],
        }
    }
}

impl PhaseRecord {
    /// Whether the phase waited for a relay that did not switch in time.
    pub fn has_timed_out(&self) -> bool {
        matches!(self.phase, PhaseKind::Operate { until: Some(_) }) && self.ended == PhaseEnd::Time
    }
}

impl Trace {
    /// Whether the trace contains anything except plain runs: one initial condition, followed by one operate phase
    /// that only time ends.
    pub fn has_phases(&self) -> bool {
        let is_plain = |pair: &[PhaseRecord]| match pair {
            [first, rest @ ..] => {
                let operates = |record: &PhaseRecord| record.phase == PhaseKind::Operate { until: None };
                first.phase == PhaseKind::InitialCondition && rest.iter().all(operates)
            }
            [] => true,
        };
        !self.phase_records.chunks(2).all(is_plain)
    }

    /// Index of the phase that a sample belongs to, from 0. A sample at the instant at which one phase ends and the
    /// next begins belongs to the next.
    pub fn phase_of(&self, sample: usize) -> usize {
        self.phase_records.partition_point(|record| record.sample <= sample).saturating_sub(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(phases: &[(PhaseKind, usize)]) -> Trace {
        let record = |(phase, sample): &(PhaseKind, usize)| PhaseRecord {
            phase: phase.clone(),
            repetition: 0,
            begin: 0.0,
            end: 0.0,
            problem_time: 0.0,
            sample: *sample,
            ended: PhaseEnd::Time,
        };
        Trace { phase_records: phases.iter().map(record).collect(), ..Trace::default() }
    }

    const OPERATE: PhaseKind = PhaseKind::Operate { until: None };

    #[test]
    fn runs_from_initial_condition_have_no_phases() {
        assert!(!trace(&[]).has_phases());
        let run = [(PhaseKind::InitialCondition, 0), (OPERATE, 0)];
        assert!(!trace(&run).has_phases());
        assert!(!trace(&[run.clone(), run.clone()].concat()).has_phases());
        assert!(trace(&[run.as_slice(), &[(OPERATE, 3)]].concat()).has_phases());
        assert!(trace(&[run.as_slice(), &[(PhaseKind::Hold, 3)]].concat()).has_phases());
        let until = PhaseKind::Operate { until: Some(("K1".to_owned(), None)) };
        assert!(trace(&[(PhaseKind::InitialCondition, 0), (until, 0)]).has_phases());
    }

    #[test]
    fn a_sample_belongs_to_the_latest_phase_that_has_begun() {
        let trace = trace(&[
            (PhaseKind::InitialCondition, 0),
            (OPERATE, 0),
            (PhaseKind::Set(vec![]), 4),
            (OPERATE, 4),
        ]);
        assert_eq!([0, 3, 4, 9].map(|sample| trace.phase_of(sample)), [1, 1, 3, 3]);
    }
}
