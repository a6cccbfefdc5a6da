//! The setting of runs that follow curves of one signal against another one.

use super::settings::RunSettings;

impl RunSettings {
    /// The same settings with these curves: for each, the names of the signals to the right and upwards. The result is
    /// [`Trace::curves`](crate::trace::Trace::curves), with points from the interpolation within steps. A curve has at
    /// most about 20,000 points, and two for every repetition if these are more. Curves change neither steps nor
    /// samples.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{RunSettings, run};
    ///
    /// // dx/dt = -x, from 50 V. The rate is -x, so its curve against x is a straight line.
    /// # let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// # let rate = ElementBuilder::new("inverter").cord("in", "A1");
    /// # let patch = PatchBuilder::new("decay").element("A1", decay).element("rate", rate);
    /// # let patch = patch.run(1.0, 1e-3).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let settings = RunSettings::of(&circuit)?.with_curves([("A1", "rate")]);
    /// let trace = run(&Program::new(&circuit)?, &settings)?;
    /// let curve = trace.curve("A1", "rate").ok_or("no curve")?;
    /// assert_eq!(curve.points[0].volts, [50.0, -50.0]);
    /// assert!(curve.points.iter().all(|point| (point.volts[0] + point.volts[1]).abs() < 1e-9));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_curves<N: Into<String>>(self, curves: impl IntoIterator<Item = (N, N)>) -> Self {
        RunSettings { curves: curves.into_iter().map(|(x, y)| (x.into(), y.into())).collect(), ..self }
    }
}
