//! Divided differences (Newton's interpolation).
//!
//! The delay line and the location of events interpolate by polynomials through a few points. Newton's form needs no
//! system of equations, and it is accurate for unequally spaced points.

/// Replaces the values of a polynomial at `nodes` by its Newton coefficients.
///
/// The coefficients belong to 1, (x - x0), (x - x0)(x - x1) and so on. The nodes must differ from each other. For
/// example, nodes 0, 1 with values 3, 5 become 3, 2: the line 3 + 2 x.
pub(crate) fn newton_coefficients(nodes: &[f64], values: &mut [f64]) {
    for order in 1..values.len() {
        for index in (order..values.len()).rev() {
            values[index] = (values[index] - values[index - 1]) / (nodes[index] - nodes[index - order]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coefficients_of_a_cubic_are_recovered() {
        let nodes = [0.0, 1.0, -2.0, 5.0];
        let mut values = nodes.map(|x| 3.0 + x * (2.0 + (x - 1.0) * (0.5 - 4.0 * (x + 2.0))));
        newton_coefficients(&nodes, &mut values);
        assert_eq!(values, [3.0, 2.0, 0.5, -4.0]);
    }
}
