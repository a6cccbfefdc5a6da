//! Tracks as vectors: what is left of them when directions that others can follow are taken out.

/// A direction of which less than this share is left tells nothing that others do not.
pub(crate) const NEW: f64 = 1e-6;

/// Columns at right angles and of length 1, those left out that others make up.
pub(crate) fn orthonormal(columns: impl Iterator<Item = Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let was = product(&column, &column).sqrt();
        clear(&basis, &mut column);
        let length = product(&column, &column).sqrt();
        if length > NEW * was {
            scale(&mut column, 1.0 / length);
            basis.push(column);
        }
    }
    basis
}

/// Takes directions out of a track.
pub(crate) fn clear(basis: &[Vec<f64>], track: &mut [f64]) {
    for direction in basis {
        let share = product(direction, track);
        subtract(track, share, direction);
    }
}

pub(crate) fn product(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

pub(crate) fn subtract(track: &mut [f64], share: f64, direction: &[f64]) {
    track.iter_mut().zip(direction).for_each(|(own, other)| *own -= share * other);
}

pub(crate) fn scale(track: &mut [f64], factor: f64) {
    track.iter_mut().for_each(|own| *own *= factor);
}

pub(crate) fn less(left: &[f64], right: &[f64]) -> Vec<f64> {
    left.iter().zip(right).map(|(left, right)| left - right).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_others_make_up_is_no_direction() {
        let basis = orthonormal([vec![3.0, 0.0, 0.0], vec![1.0, 2.0, 0.0], vec![5.0, 5.0, 0.0]].into_iter());
        assert_eq!(basis, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let mut track = [1.0, 2.0, 3.0];
        clear(&basis, &mut track);
        assert_eq!(track, [0.0, 0.0, 3.0]);
    }
}
