//! Instruments: each reads one kind of quantity off the samples of a trace.
//!
//! An instrument is a function of plain slices (time, values, settings) in a file of the same name. It returns a struct
//! of numbers or an error that says why the samples do not show the quantity. `measure` gives the instruments short
//! names for sweeps ("peak:v_o"). `log` describes phases for people. `low_peaks` and `overload_remedy` find amplifiers that
//! use too little or too much of their range, and `rescaling` has the changes that correct this.

mod critical_range;
mod critical_velocity;
mod cut;
mod cycles;
mod first_oscillation;
mod friction_loop;
mod harmonic;
mod log;
mod low_peaks;
mod measure;
mod oscillation;
mod overload_demand;
mod overload_remedy;
mod parameters;
mod profile;
mod rescaling;
mod ringing;
mod sensitivity;
mod signal_fault;
mod steadiness;
mod steady_friction;
mod stick;
mod voltmeter;
mod window;

pub use critical_range::{CriticalInterval, CriticalRange, critical_range};
pub use critical_velocity::REST_WINDOWS;
pub use critical_velocity::{Criterion, CriticalVelocity, CriticalVelocityError, critical_velocity};
pub use cycles::{Cycle, CyclesError, cycles};
pub use first_oscillation::{FirstOscillation, FirstOscillationError, first_oscillation};
pub use friction_loop::{FrictionLoop, FrictionLoopError, LoopSense, friction_loop};
pub use harmonic::{Harmonic, HarmonicError, harmonic};
pub use log::{phase_description, phase_end_description, unmet_condition};
pub use low_peaks::{LOW_PEAK, low_peak_remedy, low_peaks};
pub(crate) use measure::ColumnContent;
pub use measure::{Measure, MeasureColumn, MeasureError, MeasureValue, measures};
pub use oscillation::{Oscillation, OscillationError, oscillation};
pub use overload_demand::overload_demand;
pub use overload_remedy::overload_remedy;
pub use parameters::parameter_line;
pub use profile::{
    MissingPointError, ProfileCriterion, ProfileError, ProfilePoint, ProfileSection, RampDirection,
    VelocityProfile, velocity_profile,
};
pub(crate) use rescaling::{
    Rescaling, element_index, inverted_by, scale_change, scaled_signal, smaller_output,
};
pub use ringing::{Ringing, RingingError, ringing};
pub use sensitivity::{Sensitivity, sensitivities};
pub use signal_fault::{SignalFault, signal_faults};
pub use steady_friction::{SteadyFriction, SteadyFrictionError, steady_friction};
pub use stick::{StickError, stick_end};
pub use voltmeter::{Extreme, VoltmeterReading, readings};
pub use window::WindowError;

/// The message of every instrument whose samples do not form a signal, see [`is_signal`].
const NOT_A_SIGNAL: &str = "time must be strictly increasing and every sample finite";

/// Whether the samples form a signal: one value per time, all finite, times strictly increasing.
fn is_signal(time: &[f64], values: &[f64]) -> bool {
    let finite = time.iter().chain(values).all(|number| number.is_finite());
    time.len() == values.len() && finite && time.windows(2).all(|pair| pair[0] < pair[1])
}

/// `count` samples of a signal, `step` seconds apart from t = 0. For tests.
#[cfg(test)]
fn sampled(count: usize, step: f64, signal: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
    let time: Vec<f64> = (0..count).map(|index| index as f64 * step).collect();
    let values = time.iter().map(|t| signal(*t)).collect();
    (time, values)
}
