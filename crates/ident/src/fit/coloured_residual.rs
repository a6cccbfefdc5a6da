//! Coloured residuals without a missing effect: a finding of the residual analysis that a fitted model keeps.

/// Residuals that are not white although no effect is missing. It describes the output with the largest residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct ColouredResidual {
    /// Name of the output.
    pub output: String,
    /// The rms of its residuals, in units of sigma.
    pub normalised_rms: f64,
    /// The source of the residuals.
    pub source: ResidualSource,
}

/// The source of residuals that are not white although no effect is missing.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ResidualSource {
    /// Coloured noise of the output, not larger than sigma.
    OutputNoise,
    /// Noise of these drives. The number is its expected rms in the output, in units of sigma.
    DriveNoise(Vec<String>, f64),
    /// The fit diverges: noise of these drives grows until it exceeds the motion of the output, as the residuals do.
    Divergence(Vec<String>),
    /// Linear interpolation between the samples of these drives. The number is the rms of the residuals with smooth
    /// interpolation, in units of sigma.
    Intersample(Vec<String>, f64),
}

impl ColouredResidual {
    /// Whether the drives are the source, directly or through a fit that diverges. False for noise of the output.
    pub fn is_from_drives(&self) -> bool {
        self.source != ResidualSource::OutputNoise
    }
}
