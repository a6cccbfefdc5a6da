//! The trace: the recorded signals of a run, its phases and its overloads.
//!
//! The recorder in `solve` fills a trace; instruments, drawings and the command line read it. Voltages are stored in
//! volts, with the factor that converts them to the physical unit. The trace knows nothing of how a run is computed.

mod csv;
mod curve;
mod phase_record;
mod track;

pub use self::csv::{CsvError, TableWriter, format_exact, rounded_time};
pub use self::curve::{CurveAxis, SignalCurve};
pub use self::phase_record::{NewValue, PhaseEnd, PhaseKind, PhaseRecord};
pub use self::track::{Derivative, Extremum, SignalExtremes, Track};

/// One recorded run, or several consecutive ones (repetitive operation).
///
/// # Examples
///
/// ```
/// use patchcord_core::trace::{Trace, Track};
///
/// let mut x = Track::new("x", "mm", 2.0);
/// x.record(0, 0.0, 1.5);
/// x.record(0, 0.1, -4.0);
/// let trace = Trace { time: vec![0.0, 0.1], tracks: vec![x], ..Trace::default() };
/// assert_eq!(trace.len(), 2);
/// assert_eq!(trace.values("x"), Some(vec![3.0, -8.0]));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    /// Time of every sample in seconds of the recorder's clock: problem time plus the time spent in hold. The clock
    /// restarts at 0 in every repetition. Every time in a trace refers to this clock.
    pub time: Vec<f64>,
    /// The recorded signals, each with one sample per entry of `time`.
    pub tracks: Vec<Track>,
    /// The runs that make up the trace, in order.
    pub repetitions: Vec<Repetition>,
    /// The phases of all runs, in order.
    pub phase_records: Vec<PhaseRecord>,
    /// Set if the run checked its equal steps and they were too long.
    pub step_warning: Option<StepWarning>,
    /// The largest output of every amplifier and drive, in the order of the circuit. Empty unless
    /// [`RunSettings::finds_amplifier_peaks`](crate::solve::RunSettings::finds_amplifier_peaks) is set.
    pub amplifier_peaks: Vec<AmplifierPeak>,
    /// The curves of signals against each other that [`RunSettings::curves`](crate::solve::RunSettings::curves) names,
    /// in that order. Like extremes, they are those of the whole run, also if samples are passed on in blocks.
    pub curves: Vec<SignalCurve>,
}

/// The largest output of an amplifier in a run.
///
/// It is the largest one at all steps if the output is recorded, or if the run uses no kernel. Otherwise it is the
/// largest one of about a hundred instants or more, spread evenly over the run, and of all instants of events. Then an
/// output that is large for a short time only may have a larger peak.
#[derive(Debug, Clone, PartialEq)]
pub struct AmplifierPeak {
    /// Name of the amplifier, integrator, lag or drive.
    pub element: String,
    /// Its largest output in all repetitions, in volts without sign.
    pub volts: f64,
}

/// One run that starts at initial condition. In repetitive operation a trace has several.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Repetition {
    /// Index of its first sample in the whole record.
    pub first: usize,
    /// Time at which it ended, in seconds of the recorder's clock.
    pub end: f64,
    /// The work that the solver did.
    pub work: WorkCounters,
    /// Whether an overload put the machine into hold.
    pub is_held: bool,
    /// The overload lamps that lit, in order of time.
    pub overloads: Vec<Overload>,
}

/// Why equal steps are too long.
#[derive(Debug, Clone, PartialEq)]
pub enum StepCause {
    /// The method is stable, but its errors are large.
    Inaccurate,
    /// The method is unstable at the amplifier of this name.
    Unstable(String),
    /// The element of this name oscillates by more than a quarter of a period in a step.
    Fast(String),
}

/// Equal steps that are too long for the circuit: with a shorter step, a signal has other values.
#[derive(Debug, Clone, PartialEq)]
pub struct StepWarning {
    /// Name of the signal that differs most, relative to its range.
    pub signal: String,
    /// Largest difference of the signal between runs with `step` and with `compared_step`, in `unit`.
    pub error: f64,
    /// Unit of the signal.
    pub unit: String,
    /// Time by the recorder's clock, in seconds, at which the difference was a thousandth of the range first.
    pub time: f64,
    /// Why the steps are too long.
    pub cause: StepCause,
    /// Length of the steps, in problem seconds.
    pub step: f64,
    /// Length of the steps of the run with which they were compared, in problem seconds.
    pub compared_step: f64,
    /// A step that is short enough as far as the checks show, in problem seconds.
    pub recommended: f64,
}

/// Counts of the solver's work in one run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WorkCounters {
    /// Accepted steps, including those shortened to end at a change of mode or at a kink.
    pub steps: u64,
    /// Changes of mode of elements and drives. The command line prints them as "switchings".
    pub changes: u64,
    /// Kinks at which a step ended. A kink is a corner in the curve of a diode, a limit or a table.
    pub crossings: u64,
    /// Steps that exceeded the tolerance and were repeated with a shorter length.
    pub rejections: u64,
    /// Evaluations of the circuit, without those that only the recorder needed.
    pub evaluations: u64,
}

/// An overload lamp that lit. A lamp stays lit until the next initial condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Overload {
    /// Name of the amplifier.
    pub element: String,
    /// Time at which the demanded output first exceeded 100 V, in seconds of the recorder's clock.
    pub time: f64,
    /// How far the amplifier was driven beyond its limit.
    pub demand: Demand,
    /// Name of the amplifier whose overload caused this one: the earliest overload among the amplifiers with a chain
    /// of cords to this one. `None` if there is no such amplifier.
    pub caused_by: Option<String>,
}

/// How far an overloaded amplifier was driven beyond its limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Demand {
    /// The largest output that the amplifier would reach without its limit, in volts without sign.
    Peak(f64),
    /// How the integrator or lag was driven against its limit. The output without the limit is not known,
    /// because the amplifier reacts on itself through another element with memory, or was only thrown to its limit.
    Driven(LimitDrive),
}

impl Overload {
    /// The largest output that the amplifier would reach without its limit, in volts without sign; `None` if it is not
    /// known.
    pub fn peak(&self) -> Option<f64> {
        match self.demand {
            Demand::Peak(volts) => Some(volts),
            Demand::Driven(_) => None,
        }
    }

    /// How the integrator or lag was driven against its limit; `None` if the output without the limit is known.
    pub fn driven(&self) -> Option<LimitDrive> {
        match self.demand {
            Demand::Peak(_) => None,
            Demand::Driven(drive) => Some(drive),
        }
    }
}

/// How an integrator or a lag was driven against its limit of ±100 V since the last initial condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitDrive {
    /// The limit, 100 or -100, in volts.
    pub limit: f64,
    /// The longest time without interruption for which its inputs drove it against the limit, in problem seconds. It is
    /// 0 if the output reached the limit and returned at once.
    pub seconds: f64,
    /// Whether this time lasted until the end of the record.
    pub is_at_end: bool,
    /// The largest rate at which its inputs drove it against the limit, in volts per problem second without sign.
    pub rate: f64,
}

impl Trace {
    /// The track of the signal with this name.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{RunSettings, run};
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let trace = run(&program, &RunSettings::of(&circuit)?)?;
    /// let track = trace.track("A1").expect("a patch without signals records its elements");
    /// assert_eq!((track.unit.as_str(), track.volts[0]), ("V", 50.0));
    /// assert_eq!(track.volts.len(), trace.len());
    /// assert!(trace.track("x").is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn track(&self, name: &str) -> Option<&Track> {
        self.tracks.iter().find(|track| track.name == name)
    }

    /// The track of the derivative of a signal with respect to a parameter.
    pub fn derivative(&self, signal: &str, parameter: &str) -> Option<&Track> {
        let is_wanted = |of: &Derivative| of.signal == signal && of.parameter == parameter;
        self.tracks.iter().find(|track| track.derivative.as_ref().is_some_and(is_wanted))
    }

    /// The samples of a signal in its physical unit.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::trace::{Trace, Track};
    ///
    /// let mut speed = Track::new("v", "mm/s", 0.5);
    /// speed.record(0, 0.0, 10.0);
    /// let trace = Trace { time: vec![0.0], tracks: vec![speed], ..Trace::default() };
    /// assert_eq!(trace.values("v"), Some(vec![5.0]));
    /// assert_eq!(trace.values("x"), None);
    /// ```
    pub fn values(&self, name: &str) -> Option<Vec<f64>> {
        self.track(name).map(|track| track.values().collect())
    }

    /// The same trace without its recorded signals. Times, repetitions and phases stay.
    pub fn without_tracks(&self) -> Trace {
        let (time, repetitions, phase_records) =
            (self.time.clone(), self.repetitions.clone(), self.phase_records.clone());
        Trace { time, repetitions, phase_records, ..Trace::default() }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// The overloads of all repetitions, in order.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{RunSettings, run};
    ///
    /// // The demand of S1 is -1000 t and exceeds 100 V at t = 0.1 s.
    /// # let ramp = ElementBuilder::new("integrator").cords("x1", ["-100"]);
    /// # let summer = ElementBuilder::new("summer").cords("x10", ["A1"]);
    /// # let patch = PatchBuilder::new("overload").element("A1", ramp).element("S1", summer);
    /// # let patch = patch.run(0.5, 1e-3).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let trace = run(&program, &RunSettings::of(&circuit)?)?;
    /// let lamp = trace.overloads().next().expect("S1 is overloaded");
    /// assert_eq!(lamp.element, "S1");
    /// assert!((lamp.time - 0.1).abs() < 1e-2 && lamp.peak().is_some_and(|volts| volts > 100.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn overloads(&self) -> impl Iterator<Item = &Overload> {
        self.repetitions.iter().flat_map(|repetition| &repetition.overloads)
    }

    /// Index of the repetition that a sample belongs to, from 0.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::trace::{Repetition, Trace};
    ///
    /// let repetitions = [0, 5].map(|first| Repetition { first, ..Repetition::default() });
    /// let trace = Trace { time: vec![0.0; 10], repetitions: repetitions.to_vec(), ..Trace::default() };
    /// assert_eq!([0, 4, 5, 9].map(|sample| trace.repetition_of(sample)), [0, 0, 1, 1]);
    /// ```
    pub fn repetition_of(&self, sample: usize) -> usize {
        self.repetitions.partition_point(|repetition| repetition.first <= sample).saturating_sub(1)
    }
}
