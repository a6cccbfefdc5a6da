//! The elliptical contact area of two crossed cylinders.

use std::f64::consts::{FRAC_PI_2, PI};

use super::root::bisect;
use super::{Range, SlidewayError};

/// Permitted cross angles in radians: 30 ... 90 degrees. The table from which the thesis took its constants begins at
/// 30 degrees.
pub(super) const CROSS_ANGLE: Range = Range::new("cross angle", "rad", PI / 6.0 - 1e-12, FRAC_PI_2 + 1e-12);

/// Semi-axes of a Hertz contact, in units of (3/4 W Delta / (A + B))^(1/3) (eq 10-7, 11-7).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ellipse {
    /// The longer semi-axis, m.
    pub major: f64,
    /// The shorter semi-axis, n.
    pub minor: f64,
}

impl Ellipse {
    /// The ellipse for an auxiliary angle arccos((B - A) / (A + B)) in radians. For equal radii this is the cross
    /// angle (eq 14-7).
    ///
    /// It is calculated from complete elliptic integrals, like the tables of Timoshenko and Goodier: m = 2.731 and n
    /// = 0.493 at 30 degrees.
    ///
    /// # Errors
    /// If the angle is outside 30 ... 90 degrees.
    pub(super) fn at(angle: f64) -> Result<Self, SlidewayError> {
        let cosine = CROSS_ANGLE.check(angle)?.cos();
        // The cosine grows with the difference of the axes. Within the range the ratio of the axes is 0.18 ... 1.
        let ratio = bisect(0.1, 1.0, |ratio| cosine_of(ratio) > cosine);
        let second = Integrals::of(ratio).second();
        let major = (second / FRAC_PI_2 / ratio.powi(2)).cbrt();
        Ok(Ellipse { major, minor: ratio * major })
    }
}

/// (B - A) / (A + B) of the ellipse with a ratio r of its axes, below 1: ((1 + r^2) E - 2 r^2 K) / ((1 - r^2) E).
///
/// The expression is rearranged so that nothing cancels near a circle.
fn cosine_of(ratio: f64) -> f64 {
    let integrals = Integrals::of(ratio);
    let Integrals { square, rest, .. } = integrals;
    (square.powi(2) / 2.0 - (2.0 - square) * rest) / (square * integrals.ratio())
}

/// Complete elliptic integrals K and E, by the arithmetic-geometric mean.
#[derive(Debug, Clone, Copy)]
struct Integrals {
    /// K.
    first: f64,
    /// The square of the modulus.
    square: f64,
    /// 1 - E / K minus half the square of the modulus.
    rest: f64,
}

impl Integrals {
    /// The integrals for a complementary modulus above 0 and up to 1.
    fn of(complement: f64) -> Self {
        let (mut one, mut other) = (1.0, complement);
        let (mut rest, mut weight) = (0.0, 1.0);
        while one - other > 1e-15 {
            rest += weight * ((one - other) / 2.0).powi(2);
            weight *= 2.0;
            (one, other) = ((one + other) / 2.0, f64::sqrt(one * other));
        }
        Integrals { first: FRAC_PI_2 / one, square: (1.0 - complement) * (1.0 + complement), rest }
    }

    /// E / K.
    fn ratio(&self) -> f64 {
        1.0 - self.square / 2.0 - self.rest
    }

    /// E.
    fn second(&self) -> f64 {
        self.first * self.ratio()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_of_timoshenko_and_goodier_is_reproduced() {
        // Timoshenko and Goodier, in degrees: m, n.
        for (degrees, major, minor) in [(30.0, 2.731, 0.493), (60.0, 1.486, 0.717), (90.0, 1.0, 1.0)] {
            let ellipse = Ellipse::at(f64::to_radians(degrees)).unwrap();
            assert!(
                (ellipse.major - major).abs() < 6e-4 && (ellipse.minor - minor).abs() < 6e-4,
                "{degrees}"
            );
        }
    }

    #[test]
    fn elliptic_integrals_have_known_values() {
        let integrals = Integrals::of(0.5_f64.sqrt());
        assert!((integrals.first - 1.854_074_677_301_372).abs() < 1e-14);
        assert!((integrals.second() - 1.350_643_881_047_676).abs() < 1e-14);
    }

    #[test]
    fn angles_outside_the_table_are_refused() {
        assert!(Ellipse::at(0.5).is_err() && Ellipse::at(1.6).is_err());
    }
}
