//! The setting of runs whose samples do not stay in memory.

use super::settings::RunSettings;

/// A number of samples for [`RunSettings::with_blocks`] that needs little memory and no additional time.
pub const BLOCK_SAMPLES: usize = 1024;

impl RunSettings {
    /// The same settings with samples that do not stay in the trace, so that the memory of the run does not grow with
    /// their number. [`run_in_blocks`](super::run_in_blocks) passes them on in blocks of this many samples, for example
    /// [`BLOCK_SAMPLES`]. Other functions drop them. Extremes, repetitions and phases stay in the trace.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{BLOCK_SAMPLES, RunSettings, run};
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let trace = run(&program, &RunSettings::of(&circuit)?.with_blocks(BLOCK_SAMPLES))?;
    /// assert!(trace.is_empty());
    /// assert_eq!(trace.tracks[0].extremes[0].most.volts, 50.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_blocks(self, samples: usize) -> Self {
        RunSettings { block_samples: Some(samples), ..self }
    }
}
