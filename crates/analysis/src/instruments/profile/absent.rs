//! Why a point or a section of a profile is not there.

/// Why a point or a section is not there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Absent {
    /// Nothing moves.
    #[error("it never slides")]
    Sticks,
    /// Rising: it does not stand still first, or breaks away without a jump.
    #[error("the velocity comes up to the command without a jump")]
    NoJump,
    /// Falling: it slides at the end.
    #[error("it does not come to rest")]
    NoRest,
    /// Falling: what comes to rest is as slow as the command.
    #[error("it comes to rest along with the command, without a last slip")]
    NoSlip,
    /// Four windows of oscillation do not come together.
    #[error("it does not oscillate")]
    Quiet,
    /// It oscillates at the end of the ramp, or of the run, for less than four windows.
    #[error("the ramp or the run ends before there are cycles enough to tell")]
    TooShort,
    /// Rising: what swings at breaking away dies away, and nothing follows.
    #[error("it rings as it breaks away, and does not oscillate after that")]
    RingsOnly,
    /// The velocity stays above standstill.
    #[error("no three cycles in a row come down to standstill")]
    NoStickSlip,
    /// It goes on at the end of the ramp.
    #[error("it goes on up to the end of the ramp")]
    NotEnded,
    /// Falling: it began before.
    #[error("it oscillates before the command falls")]
    NotBegun,
    /// Its ends are one point.
    #[error("points {0} and {1} coincide")]
    Coincide(usize, usize),
    /// A point at its end is missing.
    #[error("there is no point {0}")]
    NoPoint(usize),
}
