//! Reasons why a point or a section is missing from a velocity profile.

/// Why a point or a section is missing from a velocity profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MissingPointError {
    /// The velocity never exceeds standstill.
    #[error("the slideway never slides")]
    Sticks,
    /// Rising: the velocity does not start from standstill, or leaves it without a jump.
    #[error("the velocity rises to the command without a jump")]
    NoJump,
    /// Falling: the velocity is above standstill at the end of the run.
    #[error("the slideway does not come to rest")]
    NoRest,
    /// Falling: the velocity is not above the command before the slideway comes to rest.
    #[error("the slideway comes to rest with the command, without a last slip")]
    NoSlip,
    /// The oscillation does not last for four windows.
    #[error("the velocity does not oscillate")]
    NoOscillation,
    /// The ramp or the run ends while the velocity oscillates, after less than four windows.
    #[error("the ramp or the run ends before there are enough cycles to decide")]
    TooShort,
    /// Rising: the oscillation after breaking away decays, and no other oscillation follows.
    #[error("the velocity rings after breaking away and does not oscillate later")]
    RingsOnly,
    /// No three consecutive cycles reach standstill.
    #[error("no three cycles in a row reach standstill")]
    NoStickSlip,
    /// Rising: the velocity still oscillates at the end of the ramp. Falling: at the end of the run.
    #[error("the oscillation continues to the end of the ramp")]
    NotEnded,
    /// Falling: the oscillation starts before the command falls.
    #[error("the velocity oscillates before the command falls")]
    NotBegun,
    /// The section is empty because its two end points, numbered 1 to 5, coincide.
    #[error("points {0} and {1} coincide")]
    Coincide(usize, usize),
    /// The section has no end because this point, 1 to 5, is missing.
    #[error("there is no point {0}")]
    NoPoint(usize),
}
