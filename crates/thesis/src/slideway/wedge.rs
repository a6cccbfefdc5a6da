//! The room that oil has between two ranges of ridges, and the wedge that it is taken for (7.3.ii).

use super::power_law::PowerLaw;
use super::ridge::Ridge;
use super::units::{CM, UM};
use super::{Range, SlidewayError};

const GAP: Range = Range::positive("height of the gap H", "m");
const SPACING: Range = Range::new("width of a range", "m", 1e-9, 1.0);
const FALL: Range = Range::new("fall from ridge to ridge", "m", 0.0, 1e-3);
/// Flatter wedges build up next to nothing, as a difference of two large numbers.
const SLOPE: Range = Range::new("slope of the wedge m", "", 1e-3, 1e3);

/// The profile of a range of ridges: as wide as the spacing, ridges falling by the same amount from one to the next on either side of
/// its middle (Fig 7.6a, 7.26).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeProfile {
    /// Its ridges.
    pub ridge: Ridge,
    /// Its width l, in m.
    pub spacing: f64,
    /// Fall hT from one ridge to the next, in m.
    pub fall: f64,
}

impl RangeProfile {
    /// The study's: ridges 50 um wide and 2.5 um high, one range to a centimetre, hT = 0.03 um (7.2).
    pub const OF_STUDY: RangeProfile = RangeProfile { ridge: Ridge::GROUND, spacing: CM, fall: 0.03 * UM };

    /// How many ridges a range has: 200 (7.2).
    ///
    /// # Errors
    /// What is no range.
    pub fn ridges(&self) -> Result<f64, SlidewayError> {
        self.ridge.climb()?;
        Ok(SPACING.check(self.spacing)? / self.ridge.width)
    }

    /// How much lower the outermost ridges are than the middle, in m: 3 um (7.2).
    ///
    /// # Errors
    /// What is no range.
    pub fn depth(&self) -> Result<f64, SlidewayError> {
        Ok(FALL.check(self.fall)? * self.ridges()? / 2.0)
    }

    /// Free area in m2 between two ranges that just touch, across one spacing: half of (l - B) depth + (2 l - B) Z / 2
    /// (eq 137-7, where the scan lost the half).
    ///
    /// # Errors
    /// What is no range.
    pub fn free_area(&self) -> Result<f64, SlidewayError> {
        let Ridge { width, height } = self.ridge;
        let ranges = (self.spacing - width) * self.depth()?;
        Ok((ranges + (2.0 * self.spacing - width) * height / 2.0) / 2.0)
    }

    /// Height in m of a gap of even height that holds as much oil as both ranges where they just touch: 2 he, 5.48 um (eq 139-7).
    ///
    /// # Errors
    /// What is no range.
    pub fn touching_gap(&self) -> Result<f64, SlidewayError> {
        Ok(2.0 * self.free_area()? / self.spacing)
    }

    /// The wedge that the ranges are taken for where the gap is H at least, in m.
    ///
    /// # Errors
    /// What is no range, a gap that is not above 0, or where m is outside of 0.001 ... 1000.
    pub fn wedge(&self, gap: f64) -> Result<Wedge, SlidewayError> {
        Wedge::new(self.depth()? / GAP.check(gap)?)
    }
}

/// A plain wedge of oil between surfaces that slide (Fig 7.27).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wedge {
    slope: f64,
}

impl Wedge {
    /// A wedge with m = H1 / H - 1: by how much it is higher where oil enters (eq 141-7).
    ///
    /// # Errors
    /// Outside of 0.001 ... 1000.
    pub fn new(slope: f64) -> Result<Self, SlidewayError> {
        Ok(Wedge { slope: SLOPE.check(slope)? })
    }

    /// Its slope m.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// Kp of the pressure PL = 6 eta V l Kp / H^2: ln(1 + m) / m^2 - 2 / (m (2 + m)) (eq 136-7, 142-7).
    pub fn pressure_factor(&self) -> f64 {
        let m = self.slope;
        m.ln_1p() / m.powi(2) - 2.0 / (m * (2.0 + m))
    }

    /// Kf of the force F = eta A V Kf / H on the surface that rests: 6 / (2 + m) - (2 / m) ln(1 + m) (eq 171-7, 175-7).
    pub fn drag_factor(&self) -> f64 {
        let m = self.slope;
        6.0 / (2.0 + m) - 2.0 / m * m.ln_1p()
    }
}

/// Ks, the study's law for Kp by the gap in um (eq 151-7). It goes with gaps of 4.64 ... 9.2 um.
pub const PRESSURE_FACTOR: PowerLaw = PowerLaw::new(0.05, -0.478);

/// The study's law for Kf by the gap in um (eq 176-7), 4.64 ... 9 um.
pub const DRAG_FACTOR: PowerLaw = PowerLaw::new(0.51, 0.23);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slideway::near;

    #[test]
    fn figures_of_the_study_come_out() {
        let profile = RangeProfile::OF_STUDY;
        near(profile.ridges().unwrap(), 200.0, 1e-12);
        near(profile.depth().unwrap() / UM, 3.0, 1e-12);
        near(profile.free_area().unwrap() / UM.powi(2), 27440.0, 2e-3);
        near(profile.touching_gap().unwrap() / UM, 5.48, 1e-3);
        let wedge = profile.wedge(5.48 * UM).unwrap();
        near(wedge.slope(), 0.54745, 1e-5);
        near(wedge.pressure_factor(), 0.022709, 1e-4);
        near(wedge.drag_factor(), 0.76024, 1e-4);
        assert!(profile.wedge(0.0).is_err() && Wedge::new(0.0).is_err());
    }

    #[test]
    fn the_laws_by_the_gap_are_fits_of_the_wedge() {
        let gaps: Vec<f64> = (0..=20).map(|step| 4.64 + (9.2 - 4.64) * f64::from(step) / 20.0).collect();
        let fit = |factor: fn(&Wedge) -> f64| {
            let at = |gap: &f64| (*gap, factor(&RangeProfile::OF_STUDY.wedge(gap * UM).unwrap()));
            PowerLaw::fit(&gaps.iter().map(at).collect::<Vec<_>>()).unwrap()
        };
        let (pressure, drag) = (fit(Wedge::pressure_factor), fit(Wedge::drag_factor));
        near(pressure.factor, PRESSURE_FACTOR.factor, 0.03);
        assert!((pressure.exponent - PRESSURE_FACTOR.exponent).abs() < 0.005, "{pressure:?}");
        near(drag.factor, DRAG_FACTOR.factor, 0.02);
        assert!((drag.exponent - DRAG_FACTOR.exponent).abs() < 0.006, "{drag:?}");
    }
}
