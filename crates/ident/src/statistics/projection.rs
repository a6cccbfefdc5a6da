//! Signals as vectors: orthonormal bases and projections.
//!
//! A fit can cancel every change of the outputs in the span of its sensitivities. The part of a signal that is
//! orthogonal to that span is what the data can show.

/// The least ratio of the orthogonal part of a vector to the vector, to be independent of the others. A smaller part is
/// mostly rounding. A chosen limit.
pub(crate) const MIN_INDEPENDENT_RATIO: f64 = 1e-6;

/// Returns an orthonormal basis of the columns (Gram-Schmidt, in the given order). Columns that depend linearly on the
/// earlier ones are left out.
pub(crate) fn orthonormal(columns: impl Iterator<Item = Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let original_length = dot(&column, &column).sqrt();
        remove_projections(&basis, &mut column);
        let length = dot(&column, &column).sqrt();
        if length > MIN_INDEPENDENT_RATIO * original_length {
            scale(&mut column, 1.0 / length);
            basis.push(column);
        }
    }
    basis
}

/// Subtracts the projections onto all vectors of an orthonormal basis from a signal.
pub(crate) fn remove_projections(basis: &[Vec<f64>], signal: &mut [f64]) {
    for direction in basis {
        let factor = dot(direction, signal);
        subtract_multiple(signal, factor, direction);
    }
}

/// Returns the scalar product, summed in the order of the entries.
pub(crate) fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

/// Subtracts `factor` times `direction` from a signal.
pub(crate) fn subtract_multiple(signal: &mut [f64], factor: f64, direction: &[f64]) {
    signal.iter_mut().zip(direction).for_each(|(value, other)| *value -= factor * other);
}

/// Multiplies a signal by a factor.
pub(crate) fn scale(signal: &mut [f64], factor: f64) {
    signal.iter_mut().for_each(|value| *value *= factor);
}

/// Returns `left` minus `right`.
pub(crate) fn difference(left: &[f64], right: &[f64]) -> Vec<f64> {
    left.iter().zip(right).map(|(left, right)| left - right).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependent_columns_are_not_in_the_basis() {
        let basis = orthonormal([vec![3.0, 0.0, 0.0], vec![1.0, 2.0, 0.0], vec![5.0, 5.0, 0.0]].into_iter());
        assert_eq!(basis, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let mut signal = [1.0, 2.0, 3.0];
        remove_projections(&basis, &mut signal);
        assert_eq!(signal, [0.0, 0.0, 3.0]);
    }
}
