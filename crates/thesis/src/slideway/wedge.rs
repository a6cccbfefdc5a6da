//! The oil space between two ranges of ridges, and the wedge that approximates it (7.3.ii).

use super::power_law::PowerLaw;
use super::ridge::Ridge;
use super::units::{CM, UM};
use super::{Range, SlidewayError};

const GAP: Range = Range::positive("height of the gap H", "m");
const SPACING: Range = Range::new("width of a range", "m", 1e-9, 1.0);
const FALL: Range = Range::new("fall from ridge to ridge", "m", 0.0, 1e-3);
/// Permitted slopes m. For flatter wedges the pressure is a difference of two nearly equal numbers.
const SLOPE: Range = Range::new("slope of the wedge m", "", 1e-3, 1e3);

/// The profile of a range of ridges (Fig 7.6a, 7.26). On either side of its middle the ridges fall by the same amount
/// from one to the next.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::units::UM;
/// use patchcord_thesis::slideway::wedge::RangeProfile;
///
/// let profile = RangeProfile::OF_THESIS;
/// assert!((profile.ridges()? - 200.0).abs() < 1e-6);
/// assert!((profile.touching_gap()? / UM - 5.48).abs() < 0.01);
/// assert!((profile.wedge(5.48 * UM)?.slope() - 0.5474).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeProfile {
    /// The shape of one ridge.
    pub ridge: Ridge,
    /// Width l of the range, in m.
    pub spacing: f64,
    /// Fall hT from one ridge to the next, in m.
    pub fall: f64,
}

impl RangeProfile {
    /// The thesis's profile: ridges 50 um wide and 2.5 um high, one range per centimetre, hT = 0.03 um (7.2).
    pub const OF_THESIS: RangeProfile = RangeProfile { ridge: Ridge::GROUND, spacing: CM, fall: 0.03 * UM };

    /// The number of ridges in a range: 200 in the thesis (7.2).
    ///
    /// # Errors
    /// If a dimension of the profile is out of its range.
    pub fn ridges(&self) -> Result<f64, SlidewayError> {
        self.ridge.climb()?;
        Ok(SPACING.check(self.spacing)? / self.ridge.width)
    }

    /// The depth of the outermost ridges below the middle, in m: 3 um in the thesis (7.2).
    ///
    /// # Errors
    /// If a dimension of the profile is out of its range.
    pub fn depth(&self) -> Result<f64, SlidewayError> {
        Ok(FALL.check(self.fall)? * self.ridges()? / 2.0)
    }

    /// Free area in m2 between two ranges that just touch, across one spacing: half of (l - B) depth + (2 l - B) Z / 2
    /// (eq 137-7, where the scan lost the half).
    ///
    /// # Errors
    /// If a dimension of the profile is out of its range.
    pub fn free_area(&self) -> Result<f64, SlidewayError> {
        let Ridge { width, height } = self.ridge;
        let ranges = (self.spacing - width) * self.depth()?;
        Ok((ranges + (2.0 * self.spacing - width) * height / 2.0) / 2.0)
    }

    /// Height in m of a uniform gap that holds as much oil as two ranges that just touch: 2 he, 5.48 um in the thesis
    /// (eq 139-7).
    ///
    /// # Errors
    /// If a dimension of the profile is out of its range.
    pub fn touching_gap(&self) -> Result<f64, SlidewayError> {
        Ok(2.0 * self.free_area()? / self.spacing)
    }

    /// The wedge that approximates the ranges, for a minimum gap H in m.
    ///
    /// # Errors
    /// If a dimension of the profile is out of its range, the gap is not above 0, or m is outside 0.001 ... 1000.
    pub fn wedge(&self, gap: f64) -> Result<Wedge, SlidewayError> {
        Wedge::new(self.depth()? / GAP.check(gap)?)
    }
}

/// A plain wedge of oil between sliding surfaces (Fig 7.27).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wedge {
    slope: f64,
}

impl Wedge {
    /// A wedge with the slope m = H1 / H - 1, where H1 is the height at which oil enters (eq 141-7).
    ///
    /// # Errors
    /// If the slope is outside 0.001 ... 1000.
    pub fn new(slope: f64) -> Result<Self, SlidewayError> {
        Ok(Wedge { slope: SLOPE.check(slope)? })
    }

    /// The slope m of the wedge.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// Factor Kp of the pressure PL = 6 eta V l Kp / H^2: ln(1 + m) / m^2 - 2 / (m (2 + m)) (eq 136-7, 142-7).
    pub fn pressure_factor(&self) -> f64 {
        let m = self.slope;
        m.ln_1p() / m.powi(2) - 2.0 / (m * (2.0 + m))
    }

    /// Factor Kf of the force F = eta A V Kf / H on the surface at rest: 6 / (2 + m) - (2 / m) ln(1 + m) (eq 171-7,
    /// 175-7).
    pub fn drag_factor(&self) -> f64 {
        let m = self.slope;
        6.0 / (2.0 + m) - 2.0 / m * m.ln_1p()
    }
}

/// Ks, the thesis's law for Kp against the gap in um (eq 151-7), for 4.64 ... 9.2 um.
pub const PRESSURE_FACTOR: PowerLaw = PowerLaw::new(0.05, -0.478);

/// The thesis's law for Kf against the gap in um (eq 176-7), for 4.64 ... 9 um.
pub const DRAG_FACTOR: PowerLaw = PowerLaw::new(0.51, 0.23);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slideway::assert_close;

    #[test]
    fn figures_of_the_thesis_are_reproduced() {
        let profile = RangeProfile::OF_THESIS;
        assert_close(profile.ridges().unwrap(), 200.0, 1e-12);
        assert_close(profile.depth().unwrap() / UM, 3.0, 1e-12);
        assert_close(profile.free_area().unwrap() / UM.powi(2), 27440.0, 2e-3);
        assert_close(profile.touching_gap().unwrap() / UM, 5.48, 1e-3);
        let wedge = profile.wedge(5.48 * UM).unwrap();
        assert_close(wedge.slope(), 0.54745, 1e-5);
        assert_close(wedge.pressure_factor(), 0.022709, 1e-4);
        assert_close(wedge.drag_factor(), 0.76024, 1e-4);
        assert!(profile.wedge(0.0).is_err() && Wedge::new(0.0).is_err());
    }

    #[test]
    fn laws_of_the_gap_are_fits_of_the_wedge() {
        let gaps: Vec<f64> = (0..=20).map(|step| 4.64 + (9.2 - 4.64) * f64::from(step) / 20.0).collect();
        let fit = |factor: fn(&Wedge) -> f64| {
            let at = |gap: &f64| (*gap, factor(&RangeProfile::OF_THESIS.wedge(gap * UM).unwrap()));
            PowerLaw::fit(&gaps.iter().map(at).collect::<Vec<_>>()).unwrap()
        };
        let (pressure, drag) = (fit(Wedge::pressure_factor), fit(Wedge::drag_factor));
        assert_close(pressure.factor, PRESSURE_FACTOR.factor, 0.03);
        assert!((pressure.exponent - PRESSURE_FACTOR.exponent).abs() < 0.005, "{pressure:?}");
        assert_close(drag.factor, DRAG_FACTOR.factor, 0.02);
        assert!((drag.exponent - DRAG_FACTOR.exponent).abs() < 0.006, "{drag:?}");
    }
}
