//! Two crossed ridges: overlap, area of contact and load.

use std::f64::consts::{FRAC_PI_2, PI};

use super::ellipse::{CROSS_ANGLE, Ellipse};
use super::material::{MEAN_TO_PEAK, Material};
use super::ridge::Ridge;
use super::{Range, SlidewayError};

const LOAD: Range = Range::new("load of a contact", "N", 0.0, 1e9);

/// Two equal ridges that cross at an angle, approximated by a Hertz contact of circular arcs.
///
/// # Examples
///
/// Two ground ridges at right angles under 1 kgf, and the overlap at which they yield (eq 24-7, 42-7):
///
/// ```
/// use patchcord_thesis::slideway::crossing::Crossing;
/// use patchcord_thesis::slideway::units::{KGF, MM, UM};
///
/// let pair = Crossing::of_thesis()?;
/// let (major, minor) = pair.semi_axes(KGF)?;
/// assert!((major / MM - 0.0237).abs() < 2e-4 && (major / minor - 1.0).abs() < 1e-3);
/// assert!((pair.yield_overlap() / UM - 0.46).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Area / load^(2/3) while elastic, m2/N^(2/3).
    area_factor: f64,
    /// Area / overlap^2 of the two wedges, a pure number.
    wedge_factor: f64,
    ellipse: Ellipse,
    yield_pressure: f64,
}

impl Crossing {
    /// Ridges of a metal that cross at an angle in radians, 30 ... 90 degrees.
    ///
    /// # Errors
    /// If a dimension of the ridge, a property of the metal, or the angle is out of its range.
    pub fn new(ridge: &Ridge, material: &Material, angle: f64) -> Result<Self, SlidewayError> {
        let ellipse = Ellipse::at(CROSS_ANGLE.check(angle)?)?;
        let compliance = material.checked()?.pair_compliance();
        // A + B = 1 / R (eq 16-7); area = pi m n (3/4 Delta R W)^(2/3) (eq 19-7, 22-7).
        let circle = PI * (0.75 * compliance * ridge.radius()?).powf(2.0 / 3.0);
        Ok(Crossing {
            area_factor: circle * ellipse.major * ellipse.minor,
            wedge_factor: ridge.overlap_area(1.0, angle)?,
            ellipse,
            yield_pressure: material.yield_pressure(),
        })
    }

    /// The thesis's pair: ground ridges of grade 17 iron at right angles.
    ///
    /// # Errors
    /// None: all values are within the ranges.
    pub fn of_thesis() -> Result<Self, SlidewayError> {
        Crossing::new(&Ridge::GROUND, &Material::GRADE_17_IRON, FRAC_PI_2)
    }

    /// Semi-axes of the area of contact in m, the longer first, under a load in N while elastic (eq 10-7, 11-7, 18-7).
    ///
    /// # Errors
    /// If the load is outside 0 ... 1e9 N.
    pub fn semi_axes(&self, load: f64) -> Result<(f64, f64), SlidewayError> {
        let Ellipse { major, minor } = self.ellipse;
        let unit = (self.area(load)? / (PI * major * minor)).sqrt();
        Ok((major * unit, minor * unit))
    }

    /// Area of contact in m2 under a load in N while elastic (eq 19-7, 25-7).
    ///
    /// # Errors
    /// If the load is outside 0 ... 1e9 N.
    pub fn area(&self, load: f64) -> Result<f64, SlidewayError> {
        Ok(self.area_factor * LOAD.check(load)?.powf(2.0 / 3.0))
    }

    /// Overlap h in m under a load in N while elastic (eq 22-7, 26-7). At this overlap the wedges share the same area
    /// as the arcs.
    ///
    /// # Errors
    /// If the load is outside 0 ... 1e9 N.
    pub fn overlap(&self, load: f64) -> Result<f64, SlidewayError> {
        Ok((self.area(load)? / self.wedge_factor).sqrt())
    }

    /// Pressure in the middle in Pa under a load in N, 3/2 of the mean (eq 29-7, 30-7).
    ///
    /// # Errors
    /// If the load is outside 0 ... 1e9 N.
    pub fn peak_pressure(&self, load: f64) -> Result<f64, SlidewayError> {
        Ok(self.mean_pressure(load)? / MEAN_TO_PEAK)
    }

    /// Mean pressure over the contact in Pa under a load in N while elastic (eq 31-7).
    ///
    /// # Errors
    /// If the load is outside 0 ... 1e9 N.
    pub fn mean_pressure(&self, load: f64) -> Result<f64, SlidewayError> {
        Ok(LOAD.check(load)?.cbrt() / self.area_factor)
    }

    /// Overlap in m at which the pressure in the middle reaches the yield pressure: 0.46 um for the thesis's ridges
    /// (eq 42-7).
    pub fn yield_overlap(&self) -> f64 {
        let root = MEAN_TO_PEAK * self.yield_pressure * self.area_factor;
        (self.area_factor * root.powi(2) / self.wedge_factor).sqrt()
    }

    /// Load in N under which the pressure in the middle reaches the yield pressure.
    pub fn yield_load(&self) -> f64 {
        self.pressed(self.yield_overlap()).1
    }

    /// Area in m2 and load in N at an overlap in m; both are 0 below 0.
    ///
    /// The contact is elastic up to the yield overlap (eq 23-7, 26-7). Above it the whole area carries the mean yield
    /// pressure (eq 36-7).
    pub(super) fn pressed(&self, overlap: f64) -> (f64, f64) {
        let area = self.wedge_factor * overlap.max(0.0).powi(2);
        let elastic = (area / self.area_factor).powf(1.5);
        let yielding = MEAN_TO_PEAK * self.yield_pressure * area;
        // The elastic load is the smaller one exactly up to the yield overlap.
        (area, elastic.min(yielding))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::slideway::assert_close;
    use crate::slideway::units::{KGF, KGF_PER_MM2, MM, MM2, UM};

    fn at(degrees: f64) -> Crossing {
        Crossing::new(&Ridge::GROUND, &Material::GRADE_17_IRON, degrees.to_radians()).unwrap()
    }

    #[test]
    fn fig_7_4_is_reproduced() {
        let square = at(90.0);
        assert_close(square.semi_axes(KGF).unwrap().0 / MM, 0.0237, 2e-3);
        assert_close(square.area(KGF).unwrap() / MM2, 0.001_765, 1e-3);
        assert_close(square.overlap(KGF).unwrap() / MM, 0.002_97, 1e-3);
        assert_close(square.peak_pressure(KGF).unwrap() / KGF_PER_MM2, 850.0, 1e-3);
        let oblique = at(30.0);
        assert_close(oblique.semi_axes(KGF).unwrap().1 / MM, 0.0117, 3e-3);
        assert_close(oblique.overlap(KGF).unwrap() / MM, 0.002_44, 3e-3);
        assert_close(oblique.mean_pressure(KGF).unwrap() / KGF_PER_MM2, 420.0, 4e-3);
    }

    #[test]
    fn yield_overlaps_agree_with_the_thesis() {
        assert_close(at(90.0).yield_overlap() / UM, 0.46, 3e-3);
        assert_close(at(30.0).yield_overlap() / UM, 0.51, 3e-3);
        let (area, load) = at(90.0).pressed(1.0 * UM);
        assert_close(load / area / KGF_PER_MM2, 88.0, 1e-12);
    }

    proptest! {
        #[test]
        fn overlap_and_load_are_inverse(micrometres in 0.01..0.45f64, degrees in 30.0..90.0f64) {
            let crossing = at(degrees);
            let (area, load) = crossing.pressed(micrometres * UM);
            prop_assert!((crossing.overlap(load).unwrap() / (micrometres * UM) - 1.0).abs() < 1e-9);
            prop_assert!((crossing.area(load).unwrap() / area - 1.0).abs() < 1e-9);
        }

        #[test]
        fn load_rises_with_overlap(low in 0.0..1.0f64, more in 1e-3..1.0f64) {
            let carried = |micrometres: f64| at(90.0).pressed(micrometres * UM).1;
            prop_assert!(carried(low + more) > carried(low));
        }
    }
}
