use patchcord_core::document::told;

/// Why a linear analysis has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinearError {
    /// A derivative that is not a number, such as that of a root at 0.
    #[error("{element} has no derivative here: a slope is not a finite number; linearise at another point")]
    NoDerivative {
        /// The state, delay line or signal.
        element: String,
    },
    /// The iteration for the eigenvalues of these states did not end.
    #[error("the eigenvalues of {states} were not found")]
    NoEigenvalues {
        /// Names of the states.
        states: String,
    },
    /// Delay lines whose output comes back to their input.
    #[error(
        "the loop through {} has characteristic roots without end: they are not worked out; a frequency response \
         takes the delay as it is", .0.join(", ")
    )]
    DelayInLoop(Vec<String>),
    /// A signal that does not exist.
    #[error("there is no signal {name} to read; {hint}")]
    UnknownSignal {
        /// What was asked for.
        name: String,
        /// What there is.
        hint: String,
    },
    /// A drive that does not exist.
    #[error("{name} is no drive; {hint}")]
    NotADrive {
        /// What was asked for.
        name: String,
        /// What there is.
        hint: String,
    },
    /// A drive that does nothing to a signal.
    #[error("{output} does not follow {input} here: a small change of {input} does nothing to it")]
    NotMoved {
        /// The drive.
        input: String,
        /// The signal.
        output: String,
    },
    /// Frequencies that are none.
    #[error(
        "frequencies go from one to a higher one, within 1e-100 ... 1e100 Hz, not from {} to {} Hz",
        told(*low), told(*high)
    )]
    NotABand {
        /// Lower end in Hz.
        low: f64,
        /// Upper end in Hz.
        high: f64,
    },
    /// So high a frequency that the phase of the delay lines turns too often.
    #[error(
        "up to {high} Hz the delay lines turn the phase {turns:.0} times; at most {most} turns are drawn"
    )]
    TooManyTurns {
        /// Upper end in Hz.
        high: f64,
        /// Frequency times delays.
        turns: f64,
        /// The limit.
        most: f64,
    },
}
