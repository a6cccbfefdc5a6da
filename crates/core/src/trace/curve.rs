//! The curve of one signal against another one, from all steps of a run.

use super::Trace;
use crate::chords::CurvePoint;

/// The curve of one signal against another one in all repetitions.
///
/// Unlike samples, its points come from every step and from the interpolation within steps, so straight lines between
/// them are close to the curve. Points that these lines do not need are left out.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// // x'' = -x with an amplitude of 80 V. The steps are long, but the curve is round.
/// let patch = PatchBuilder::new("circle")
///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["A2"]).set("initial", 80))
///     .element("A2", ElementBuilder::new("integrator").cords("x1", ["B1"]))
///     .element("B1", ElementBuilder::new("inverter").cord("in", "A1"))
///     .run(6.0, 0.3)
///     .build()?;
/// let circuit = Circuit::new(&patch)?;
/// let settings = RunSettings::of(&circuit)?.with_curves([("A1", "A2")]);
/// let trace = run(&Program::new(&circuit)?, &settings)?;
/// let curve = trace.curve("A1", "A2").ok_or("no curve")?;
/// assert!(trace.len() < 25 && curve.points.len() > 60);
/// assert!(curve.points.iter().all(|point| (point.volts[0].hypot(point.volts[1]) - 80.0).abs() < 0.1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SignalCurve {
    /// The signals along the axes: to the right, and upwards.
    pub axes: [CurveAxis; 2],
    /// The points in order of time. Each repetition begins with a point that [begins](CurvePoint::begins) a curve. Times
    /// are those of the recorder's clock.
    pub points: Vec<CurvePoint>,
}

/// A signal along an axis of a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveAxis {
    /// Name of the signal.
    pub name: String,
    /// Text of its unit; "V" if it has no scale.
    pub unit: String,
    /// Value of one volt in that unit.
    pub per_volt: f64,
}

impl SignalCurve {
    /// The values of the signal along an axis, 0 or 1, in its unit.
    pub fn values(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
        self.points.iter().map(move |point| point.volts[axis] * self.axes[axis].per_volt)
    }

    /// The indices of the points with which the repetitions begin.
    pub fn begins(&self) -> impl Iterator<Item = usize> + '_ {
        self.points.iter().enumerate().filter(|(_, point)| point.begins).map(|(index, _)| index)
    }
}

impl Trace {
    /// The curve of a signal `y` against a signal `x`; `None` if the run did not follow it.
    pub fn curve(&self, x: &str, y: &str) -> Option<&SignalCurve> {
        self.curves.iter().find(|curve| curve.axes[0].name == x && curve.axes[1].name == y)
    }
}
