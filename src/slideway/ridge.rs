//! One ridge of a ground surface: a low triangle, and the arc that stands in for it where it is pressed.

use super::units::UM;
use super::{Range, SlidewayError};

const WIDTH: Range = Range::positive("width of a ridge", "m");
const HEIGHT: Range = Range::positive("height of a ridge", "m");

/// The profile of a ridge (Fig 7.1): a triangle of base width B and height Z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ridge {
    /// Base width B, in m.
    pub width: f64,
    /// Height Z, in m.
    pub height: f64,
}

impl Ridge {
    /// The ridge of the study's ground cast iron: B = 50 um, Z = 2.5 um (7.2).
    pub const GROUND: Ridge = Ridge { width: 50.0 * UM, height: 2.5 * UM };

    /// Radius of the arc through both ends of the base and the crest, in m: R = (4 Z^2 + B^2) / (8 Z), eq 9-7.
    ///
    /// # Errors
    /// Where width or height is not above 0.
    pub fn radius(&self) -> Result<f64, SlidewayError> {
        let (width, height) = (WIDTH.check(self.width)?, HEIGHT.check(self.height)?);
        Ok((4.0 * height.powi(2) + width.powi(2)) / (8.0 * height))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arc_passes_through_crest_and_ends() {
        let radius = Ridge::GROUND.radius().unwrap();
        assert!((radius - 126.25 * UM).abs() < 1e-12);
        let sagitta = radius - (radius.powi(2) - (Ridge::GROUND.width / 2.0).powi(2)).sqrt();
        assert!((sagitta - Ridge::GROUND.height).abs() < 1e-12);
    }

    #[test]
    fn a_ridge_without_height_has_no_arc() {
        assert!(Ridge { height: 0.0, ..Ridge::GROUND }.radius().is_err());
    }
}
