//! The two ramps of a velocity profile: the command rises to its largest value and may fall back.
//!
//! Points and sections of both ramps are numbered from rest. What happens at a point depends on the ramp:
//! at point 2 oscillation begins while the command rises, and ends while it falls.

use std::ops::Range;

use super::super::critical_velocity::first_largest;

/// One of the two ramps of a velocity profile.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::RampDirection;
///
/// let command = [0.0, 1.0, 2.0, 1.0, 0.0];
/// assert_eq!(RampDirection::Rising.samples(&command), 0..3);
/// assert_eq!(RampDirection::Falling.samples(&command), 2..5);
/// assert_eq!(RampDirection::Falling.point_names()[0], "comes to rest");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RampDirection {
    /// From the first command to the command of largest absolute value.
    Rising,
    /// From the command of largest absolute value back, up to a change of sign.
    Falling,
}

/// The name of a point or a section during the rising and during the falling ramp.
type Names = [&'static str; 2];

/// The names of points 1 to 5.
const POINTS: [Names; 5] = [
    ["breaks away", "comes to rest"],
    ["oscillation begins", "oscillation ends"],
    ["stick-slip begins", "stick-slip ends"],
    ["stick-slip ends", "stick-slip begins"],
    ["oscillation ends", "oscillation begins"],
];

/// The names of sections A to D.
const SECTIONS: [Names; 4] = [
    ["smooth sliding"; 2],
    ["oscillation grows", "oscillation dies away"],
    ["stick-slip"; 2],
    ["oscillation dies away", "oscillation grows"],
];

impl RampDirection {
    /// The names of points 1 to 5.
    pub fn point_names(self) -> [&'static str; 5] {
        POINTS.map(|names| self.select(names))
    }

    /// The names of sections A to D.
    pub fn section_names(self) -> [&'static str; 4] {
        SECTIONS.map(|names| self.select(names))
    }

    /// Selects one of two values: the first for the rising ramp, the second for the falling ramp.
    pub fn select<T>(self, [rising, falling]: [T; 2]) -> T {
        match self {
            RampDirection::Rising => rising,
            RampDirection::Falling => falling,
        }
    }

    /// The samples of this ramp.
    pub fn samples(self, command: &[f64]) -> Range<usize> {
        let turn = first_largest(command);
        let Some(largest) = command.get(turn) else { return 0..0 };
        let forward = command[turn..].iter().take_while(|value| **value * largest.signum() >= 0.0);
        self.select([0..turn + 1, turn..turn + forward.count()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_meet_at_the_largest_command_and_end_at_zero() {
        let command = [-1.0, 0.0, 3.0, 3.0, 1.0, 0.0, -1.0];
        assert_eq!(
            (RampDirection::Rising.samples(&command), RampDirection::Falling.samples(&command)),
            (0..3, 2..6)
        );
        let backward = command.map(|value| -value);
        assert_eq!(
            (RampDirection::Rising.samples(&backward), RampDirection::Falling.samples(&backward)),
            (0..3, 2..6)
        );
        assert_eq!((RampDirection::Rising.samples(&[]), RampDirection::Falling.samples(&[])), (0..0, 0..0));
    }
}
