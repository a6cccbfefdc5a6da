//! The metal of slideways: elasticity, hardness and shear strength.

use super::units::KGF_PER_MM2;
use super::{Range, SlidewayError};

const MODULUS: Range = Range::new("Young's modulus", "Pa", 1e6, 1e13);
const POISSON: Range = Range::new("Poisson's ratio", "", 0.0, 0.5);
const HARDNESS: Range = Range::new("Brinell hardness", "Pa", 1e6, 1e12);
const SHEAR: Range = Range::new("shear strength", "Pa", 0.0, 1e12);

/// Mean pressure over a Hertz contact as a share of the pressure in its middle (eq 28-7).
pub const MEAN_TO_PEAK: f64 = 2.0 / 3.0;

/// Peak pressure at which a contact yields, as a share of the hardness (7.2, after Greenwood and Williamson).
pub const YIELD_TO_HARDNESS: f64 = 0.6;

/// A metal.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::material::Material;
/// use patchcord_thesis::slideway::units::KGF_PER_MM2;
///
/// let iron = Material::GRADE_17_IRON;
/// assert!((iron.yield_pressure() / KGF_PER_MM2 - 132.0).abs() < 1e-9);
/// assert!((iron.with_tabor_shear().shear_strength / KGF_PER_MM2 - 76.2).abs() < 0.05);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus E, in Pa.
    pub modulus: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Brinell hardness, in Pa.
    pub hardness: f64,
    /// Shear strength Ss of a junction, in Pa.
    pub shear_strength: f64,
}

impl Material {
    /// Cast iron of grade 17 (7.2): E = 1.32e4 kgf/mm2, hardness 220 kgf/mm2, shear strength 30.87 kgf/mm2.
    ///
    /// Poisson's ratio is not printed. Values of 0.257 ... 0.279 give the printed figures of eq 24-7, and 0.27 also
    /// gives those of eq 26-7 and 30-7.
    pub const GRADE_17_IRON: Material = Material {
        modulus: 1.32e4 * KGF_PER_MM2,
        poisson: 0.27,
        hardness: 220.0 * KGF_PER_MM2,
        shear_strength: 30.87 * KGF_PER_MM2,
    };

    /// Returns the material if every property is possible for a metal: E of 1e6 ... 1e13 Pa, Poisson's ratio of 0 ...
    /// 0.5, a hardness of 1e6 ... 1e12 Pa, a shear strength of 0 ... 1e12 Pa.
    ///
    /// # Errors
    /// The first property that is out of its range.
    pub fn checked(&self) -> Result<&Self, SlidewayError> {
        MODULUS.check(self.modulus)?;
        POISSON.check(self.poisson)?;
        HARDNESS.check(self.hardness)?;
        SHEAR.check(self.shear_strength)?;
        Ok(self)
    }

    /// Pressure Pm in the middle of a contact at which it yields, in Pa: 0.6 x hardness, 132 kgf/mm2 for grade 17 iron.
    pub fn yield_pressure(&self) -> f64 {
        YIELD_TO_HARDNESS * self.hardness
    }

    /// Compliance of two bodies of the metal in contact, Delta = 2 (1 - nu^2) / E in 1/Pa (eq 15-7).
    pub fn pair_compliance(&self) -> f64 {
        2.0 * (1.0 - self.poisson.powi(2)) / self.modulus
    }

    /// The same metal with the shear strength Pm / sqrt(3) that Tabor gives a junction, in Pa (eq 70-7).
    pub fn with_tabor_shear(self) -> Self {
        Material { shear_strength: self.yield_pressure() / 3f64.sqrt(), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_the_thesis_are_reproduced() {
        let iron = Material::GRADE_17_IRON.checked().unwrap();
        assert!((iron.yield_pressure() / KGF_PER_MM2 - 132.0).abs() < 1e-9);
        assert!((iron.pair_compliance() * KGF_PER_MM2 - 1.4047e-4).abs() < 1e-8);
        assert!((iron.with_tabor_shear().shear_strength / KGF_PER_MM2 - 76.21).abs() < 0.01);
    }

    #[test]
    fn impossible_properties_are_refused() {
        let iron = Material::GRADE_17_IRON;
        assert!(Material { poisson: 0.6, ..iron }.checked().is_err());
        assert!(Material { modulus: 0.0, ..iron }.checked().is_err());
    }
}
