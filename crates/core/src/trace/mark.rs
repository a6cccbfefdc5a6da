//! Where the phases of a run begin and end in its record.

use super::Trace;

/// A phase that was gone through.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// What the machine did.
    pub phase: Deed,
    /// The run that it belongs to, counted from 0.
    pub sweep: usize,
    /// When it began, in seconds of the record.
    pub begin: f64,
    /// When it ended, in seconds of the record.
    pub end: f64,
    /// Problem time at which it began, in seconds; less than `begin` by what was held before.
    pub problem_time: f64,
    /// Index of the sample at which it began; of initial condition and a change of parameters, of the next.
    pub sample: usize,
    /// Why it ended.
    pub ended: Ending,
}

/// What the machine did in a phase.
#[derive(Debug, Clone, PartialEq)]
pub enum Deed {
    /// Stood at its initial conditions.
    InitialCondition,
    /// Integrated.
    Operate {
        /// The relay that was to end it, and the position that it was to go to.
        until: Option<(String, Option<String>)>,
    },
    /// Kept its voltages.
    Hold,
    /// Had parameters set.
    Set(Vec<NewValue>),
}

/// A parameter's new value.
#[derive(Debug, Clone, PartialEq)]
pub struct NewValue {
    /// Name of the parameter.
    pub parameter: String,
    /// In its declared unit.
    pub value: f64,
    /// What it was before.
    pub before: f64,
    /// Text of that unit.
    pub unit: String,
}

/// Why a phase ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ending {
    /// Its time was over.
    Time,
    /// A relay went to a position.
    Switched(String),
    /// An overload put the machine into hold.
    Overload,
    /// The run had to stop.
    Stopped,
}

impl Deed {
    /// The parameters that were set.
    pub fn new_values(&self) -> &[NewValue] {
        match self {
            Deed::Set(values) => values,
            _ => &[],
        }
    }
}

impl Mark {
    /// Whether a relay was to end the phase and did not.
    pub fn waited_in_vain(&self) -> bool {
        matches!(self.phase, Deed::Operate { until: Some(_) }) && self.ended == Ending::Time
    }
}

impl Trace {
    /// Whether there is more in it than runs from initial condition to their end.
    pub fn has_phases(&self) -> bool {
        let is_plain = |pair: &[Mark]| match pair {
            [first, rest @ ..] => {
                let operates = |mark: &Mark| mark.phase == Deed::Operate { until: None };
                first.phase == Deed::InitialCondition && rest.iter().all(operates)
            }
            [] => true,
        };
        !self.marks.chunks(2).all(is_plain)
    }

    /// The phase that a sample belongs to, counted from 0. An instant at which one phase ends and another begins
    /// belongs to the later.
    pub fn phase_of(&self, sample: usize) -> usize {
        self.marks.partition_point(|mark| mark.sample <= sample).saturating_sub(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(phases: &[(Deed, usize)]) -> Trace {
        let mark = |(phase, sample): &(Deed, usize)| Mark {
            phase: phase.clone(),
            sweep: 0,
            begin: 0.0,
            end: 0.0,
            problem_time: 0.0,
            sample: *sample,
            ended: Ending::Time,
        };
        Trace { marks: phases.iter().map(mark).collect(), ..Trace::default() }
    }

    const OPERATE: Deed = Deed::Operate { until: None };

    #[test]
    fn runs_from_initial_condition_have_no_phases() {
        assert!(!trace(&[]).has_phases());
        let run = [(Deed::InitialCondition, 0), (OPERATE, 0)];
        assert!(!trace(&run).has_phases());
        assert!(!trace(&[run.clone(), run.clone()].concat()).has_phases());
        assert!(trace(&[run.as_slice(), &[(OPERATE, 3)]].concat()).has_phases());
        assert!(trace(&[run.as_slice(), &[(Deed::Hold, 3)]].concat()).has_phases());
        let until = Deed::Operate { until: Some(("K1".to_owned(), None)) };
        assert!(trace(&[(Deed::InitialCondition, 0), (until, 0)]).has_phases());
    }

    #[test]
    fn a_sample_belongs_to_the_latest_phase_that_has_begun() {
        let trace = trace(&[(Deed::InitialCondition, 0), (OPERATE, 0), (Deed::Set(vec![]), 4), (OPERATE, 4)]);
        assert_eq!([0, 3, 4, 9].map(|sample| trace.phase_of(sample)), [1, 1, 3, 3]);
    }
}
