//! What is left although nothing is missing, and is not white: a finding of the residual analysis, which a fitted model keeps.

/// What is left although nothing is missing: of the output of which that is most.
#[derive(Debug, Clone, PartialEq)]
pub struct NotWhite {
    /// The output.
    pub output: String,
    /// What is left of it, rms over its noise.
    pub left: f64,
    /// What brings it.
    pub cause: Cause,
}

/// What brings residuals that are not white although nothing is missing.
#[derive(Debug, Clone, PartialEq)]
pub enum Cause {
    /// Noise of the output itself.
    Own,
    /// Noise of these drives, which brings so much on average, rms over the noise of the output.
    Drives(Vec<String>, f64),
    /// The patch runs away: noise of these drives grows to more than the output moves, as does what is left.
    Runaway(Vec<String>),
    /// Straight lines between the samples of these drives: where they go on smoothly so much is left, rms over the noise.
    Between(Vec<String>, f64),
}

impl NotWhite {
    /// Whether it is how drives were measured that brings it, or what the patch makes of that, rather than less than the noise of the output.
    pub fn is_of_drives(&self) -> bool {
        self.cause != Cause::Own
    }
}
