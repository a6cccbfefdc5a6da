//! The way that a command goes while a profile is read: up, or back down.

use std::ops::Range;

use super::super::critical_velocity::first_largest;

/// The way that a command goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// From its first value up to its largest, without sign.
    Rising,
    /// From its largest value back, as long as it does not change its sign.
    Falling,
}

/// What a point or a section is called, rising and falling.
type Names = [&'static str; 2];

const POINTS: [Names; 5] = [
    ["breaks away", "comes to rest"],
    ["oscillation begins", "oscillation ends"],
    ["stick-slip begins", "stick-slip ends"],
    ["stick-slip ends", "stick-slip begins"],
    ["oscillation ends", "oscillation begins"],
];

const SECTIONS: [Names; 4] = [
    ["smooth sliding"; 2],
    ["oscillation grows", "oscillation dies away"],
    ["stick-slip"; 2],
    ["oscillation dies away", "oscillation grows"],
];

impl Way {
    /// What happens at points 1 to 5.
    pub fn points(self) -> [&'static str; 5] {
        POINTS.map(|names| self.of(names))
    }

    /// What happens in sections A to D.
    pub fn sections(self) -> [&'static str; 4] {
        SECTIONS.map(|names| self.of(names))
    }

    /// What stands first while the command rises, and what stands there while it falls.
    pub fn of<T>(self, [rising, falling]: [T; 2]) -> T {
        match self {
            Way::Rising => rising,
            Way::Falling => falling,
        }
    }

    /// The samples in which a command goes this way.
    pub fn samples(self, command: &[f64]) -> Range<usize> {
        let turn = first_largest(command);
        let Some(largest) = command.get(turn) else { return 0..0 };
        let forward = command[turn..].iter().take_while(|value| **value * largest.signum() >= 0.0);
        self.of([0..turn + 1, turn..turn + forward.count()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_to_the_largest_value_and_back_to_zero() {
        let command = [-1.0, 0.0, 3.0, 3.0, 1.0, 0.0, -1.0];
        assert_eq!((Way::Rising.samples(&command), Way::Falling.samples(&command)), (0..3, 2..6));
        let backward = command.map(|value| -value);
        assert_eq!((Way::Rising.samples(&backward), Way::Falling.samples(&backward)), (0..3, 2..6));
        assert_eq!((Way::Rising.samples(&[]), Way::Falling.samples(&[])), (0..0, 0..0));
    }
}
