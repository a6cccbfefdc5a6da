//! The error of a linear analysis.

use patchcord_core::document::format_number;

/// Why a linear analysis has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearError {
    /// A derivative is not finite, such as that of a square root at 0.
    #[error("{element} has no finite derivative at this point: linearise at another point")]
    NoDerivative {
        /// The state, delay line or signal with this derivative.
        element: String,
    },
    /// A derivative is too large for the analysis.
    #[error("the derivative of {element} exceeds 1e100 at this point: reduce the gains in front of it")]
    DerivativeTooLarge {
        /// The state, delay line or signal with this derivative.
        element: String,
    },
    /// The linear model is too large.
    #[error(
        "the linear model has {variables} states, delay lines and drives and {entries} derivatives; at most {max_variables} \
         and {max_entries} are allowed"
    )]
    TooLarge {
        /// Number of states, delay lines and drives.
        variables: usize,
        /// Number of derivatives.
        entries: usize,
        /// The largest number of states, delay lines and drives.
        max_variables: usize,
        /// The largest number of derivatives.
        max_entries: usize,
    },
    /// The eigenvalue iteration did not converge.
    #[error("the eigenvalues of {states} cannot be computed: the iteration does not converge")]
    NoEigenvalues {
        /// Names of the states of the block.
        states: String,
    },
    /// The output of a delay line is fed back to its input. The field has the names of these delay lines.
    #[error(
        "the loop through {} has infinitely many characteristic roots, which are not computed; the frequency response \
         treats delays exactly", .0.join(", ")
    )]
    DelayInLoop(Vec<String>),
    /// There is no signal with this name.
    #[error("the patch has no signal {name}; {hint}")]
    UnknownSignal {
        /// The requested name.
        name: String,
        /// A similar name, or all names.
        hint: String,
    },
    /// There is no drive with this name.
    #[error("{name} is not a drive; {hint}")]
    NotADrive {
        /// The requested name.
        name: String,
        /// A similar name, or all names.
        hint: String,
    },
    /// The drive has no influence on the signal at this operating point.
    #[error("{output} does not depend on {input} at this operating point")]
    NoInfluence {
        /// Name of the drive.
        input: String,
        /// Name of the signal.
        output: String,
    },
    /// The frequency band is invalid.
    #[error(
        "a frequency band must rise from a lower to a higher frequency within 1e-100 ... 1e100 Hz, got {} to {} Hz",
        format_number(*low), format_number(*high)
    )]
    BadBand {
        /// Lower limit in Hz.
        low: f64,
        /// Upper limit in Hz.
        high: f64,
    },
    /// The delay lines turn the phase too often within the band.
    #[error(
        "up to {high} Hz the delay lines turn the phase {turns} times, at most {max} turns are possible",
        turns = turns.ceil()
    )]
    TooManyTurns {
        /// Upper limit of the band in Hz.
        high: f64,
        /// Upper limit times the sum of all delays.
        turns: f64,
        /// The largest possible number of turns.
        max: f64,
    },
}
