//! Divided differences (Newton's interpolation).
//!
//! The delay line and the location of events interpolate by polynomials through a few points. Newton's form needs no
//! system of equations, and it is accurate for unequally spaced points.

/// Replaces the values of a polynomial at `places` by its Newton coefficients.
///
/// The coefficients belong to 1, (x - x0), (x - x0)(x - x1) and so on. The places must differ from each other. For
/// example, places 0, 1 with values 3, 5 become 3, 2: the line 3 + 2 x.
pub(crate) fn newton_coefficients(places: &[f64], values: &mut [f64]) {
    for order in 1..values.len() {
        for at in (order..values.len()).rev() {
            values[at] = (values[at] - values[at - 1]) / (places[at] - places[at - order]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coefficients_of_a_cubic_are_recovered() {
        let places = [0.0, 1.0, -2.0, 5.0];
        let mut values = places.map(|x| 3.0 + x * (2.0 + (x - 1.0) * (0.5 - 4.0 * (x + 2.0))));
        newton_coefficients(&places, &mut values);
        assert_eq!(values, [3.0, 2.0, 0.5, -4.0]);
    }
}
