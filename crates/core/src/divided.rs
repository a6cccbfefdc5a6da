//! Divided differences.

/// Turns values at places into what the polynomial through them has as factors of 1, x - x0, (x - x0)(x - x1), ... (Newton).
pub(crate) fn divide(places: &[f64], values: &mut [f64]) {
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
    fn a_cubic_has_its_own_factors() {
        let places = [0.0, 1.0, -2.0, 5.0];
        let mut values = places.map(|x| 3.0 + x * (2.0 + (x - 1.0) * (0.5 - 4.0 * (x + 2.0))));
        divide(&places, &mut values);
        assert_eq!(values, [3.0, 2.0, 0.5, -4.0]);
    }
}
