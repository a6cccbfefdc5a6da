//! The intermediate representation: a circuit as primitive operations on volts, with states and modes.
//!
//! A [`Program`] has two lists of operations. The *prologue* runs once per run and turns parameters into coefficients.
//! The *body* turns coefficients, states, modes and time into every voltage and every rate. Every backend reads only
//! the program: the interpreter here, the kernels and native code.
//!
//! `lower` makes a program from a circuit: it calls each element's law with a [`Builder`]. Then this module puts the
//! body in order and finds loops, kinks and discontinuities. It also differentiates the program.

mod angles;
mod builder;
mod cache;
mod coefficient;
mod derivatives;
mod element_laws;
mod evaluate;
mod inspect;
mod kinks;
mod level;
mod linearise;
mod loops;
mod modes;
mod noise;
mod number;
mod op;
mod parameters;
mod parts;
mod program;
mod pulses;
mod scope;
mod sections;
mod series;
mod state_space;
mod table_corners;
mod tangent;
mod upstream;

pub use builder::{Builder, Draft};
pub use coefficient::{Coefficient, SettingFault};
pub use derivatives::MAX_DERIVATIVE;
pub use element_laws::{ElementLaw, ElementLaws};
pub use inspect::ProgramPoint;
pub use level::Level;
pub use linearise::Linearisation;
pub use modes::{ChatterRemedy, Guard, Mode, ModeHandle, ModeNames, Reset, Transition};
pub use noise::{Distribution, Noise, box_muller};
pub use op::{Op, Register};
pub use parameters::{ParameterDeclaration, ParameterValue, SettingError};
pub use parts::{Delay, ElementOutput, Lamp, Loop, SampledValue, SignalInfo, State, Tear, TimeConstant};
pub use program::Program;
pub use pulses::{PulseTrain, Pulses};
pub use state_space::{DelayTerm, Port, StateHold, StateSpace, StateTerm};

pub(crate) use angles::Angle;
pub(crate) use coefficient::{InvalidCoefficient, Relation, SettingOrder};
pub(crate) use evaluate::Scratch;
pub(crate) use kinks::{KINK_TOLERANCE, Kink, KinkCrossing};
pub(crate) use level::{held_value, points_passed};
pub(crate) use linearise::OperatingPoint;
pub(crate) use loops::{LoopFault, Solutions, describe_solutions, remedy};
pub(crate) use number::{Number, segment, segment_after};
pub(crate) use op::Sources;
pub(crate) use parameters::ChangedParameters;
pub(crate) use parts::{LAMP_THRESHOLD, Switch};
pub(crate) use program::Tables;
pub(crate) use pulses::pulse_value;
pub(crate) use scope::{RunScope, ScaleFactor};
pub(crate) use table_corners::TableCorners;
pub(crate) use tangent::{RunScopeSlopes, SourceSlopes, TangentBase};

use cache::Cache;
use parts::Timetable;
use sections::Sections;
