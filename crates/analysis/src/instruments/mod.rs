//! Instruments: what can be read from a trace.

mod critical_range;
mod critical_velocity;
mod cut;
mod cycles;
mod first_oscillation;
mod friction_loop;
mod harmonic;
mod log;
mod measure;
mod oscillation;
mod parameters;
mod profile;
mod quantity;
mod ringing;
mod sensitivity;
mod steadiness;
mod steady_friction;
mod stick;
mod voltmeter;
mod window;

pub use critical_range::{CriticalInterval, CriticalRange, critical_range};
pub use critical_velocity::REST;
pub use critical_velocity::{Criterion, CriticalVelocity, NoCriticalVelocity, critical_velocity};
pub use cycles::{Cycle, CyclesError, cycles};
pub use first_oscillation::{FirstOscillation, NoFirstOscillation, first_oscillation};
pub use friction_loop::{FrictionLoop, FrictionLoopError, Turning, friction_loop};
pub use harmonic::{Harmonic, HarmonicError, harmonic};
pub use log::{deed, ending, missed};
pub use measure::{Cell, Column, Measure, MeasureError, measures};
pub use oscillation::{Oscillation, OscillationError, oscillation};
pub use parameters::parameter_line;
pub use profile::{
    Absent, ProfileCriterion, ProfileError, ProfilePoint, Section, VelocityProfile, Way, velocity_profile,
};
pub use quantity::with_unit;
pub use quantity::{Display, number};
pub use ringing::{Ringing, RingingError, ringing};
pub use sensitivity::{Sensitivity, sensitivities};
pub use steady_friction::{SteadyFriction, SteadyFrictionError, steady_friction};
pub use stick::{StickError, stick_end};
pub use voltmeter::{Extreme, Reading, readings};
pub use window::WindowError;

/// Whether there is one finite value for each of the times, which rise.
fn is_signal(time: &[f64], values: &[f64]) -> bool {
    let finite = time.iter().chain(values).all(|number| number.is_finite());
    time.len() == values.len() && finite && time.windows(2).all(|pair| pair[0] < pair[1])
}

/// A signal at so many instants, for tests.
#[cfg(test)]
fn sampled(count: usize, step: f64, signal: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
    let time: Vec<f64> = (0..count).map(|index| index as f64 * step).collect();
    let values = time.iter().map(|t| signal(*t)).collect();
    (time, values)
}
