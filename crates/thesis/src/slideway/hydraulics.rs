//! Stiffness of hydraulic drives (4.4).

use super::{Range, SlidewayError};

const BULK: Range = Range::positive("bulk modulus B", "Pa");
const AREA: Range = Range::positive("piston area A", "m2");
const VOLUME: Range = Range::positive("volume of one side V", "m3");

/// Stiffness of a hydraulic cylinder with equal volumes on both sides, K = 2 B A^2 / V, in N/m (eq 1-4).
///
/// The arguments are the bulk modulus of the fluid in Pa, the area of the piston in m2 and the volume of one side in
/// m3. Air in the oil lowers the bulk modulus, mainly below 6.9 MN/m2.
///
/// # Errors
/// If an argument is not above 0.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::hydraulics::cylinder_stiffness;
///
/// // 1.7 GPa, 20 cm2 and 0.3 l.
/// let stiffness = cylinder_stiffness(1.7e9, 20e-4, 0.3e-3)?;
/// assert!((stiffness / 45.333e6 - 1.0).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cylinder_stiffness(bulk_modulus: f64, area: f64, volume: f64) -> Result<f64, SlidewayError> {
    Ok(2.0 * BULK.check(bulk_modulus)? * AREA.check(area)?.powi(2) / VOLUME.check(volume)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_contribute_to_the_stiffness() {
        let (bulk, area, volume) = (1.7e9, 20e-4, 0.3e-3);
        // A small move x compresses one side and relaxes the other by A x of V.
        let force = 2.0 * bulk * (area * 1e-6 / volume) * area;
        let stiffness = cylinder_stiffness(bulk, area, volume).unwrap();
        assert!((stiffness * 1e-6 / force - 1.0).abs() < 1e-12);
        assert!((stiffness / 45.33e6 - 1.0).abs() < 1e-4);
        assert!(cylinder_stiffness(bulk, area, 0.0).is_err());
    }
}
