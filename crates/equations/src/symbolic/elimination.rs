//! Small systems of linear equations.

/// The solution of a square system by elimination with the largest pivot of each column. `None` if it is singular.
pub(super) fn solved(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let order = right.len();
    for column in 0..order {
        let size = |row: &usize| matrix[*row][column].abs();
        let pivot = (column..order).max_by(|one, other| size(one).total_cmp(&size(other)))?;
        if !(size(&pivot) > 0.0 && size(&pivot).is_finite()) {
            return None;
        }
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        for row in column + 1..order {
            let factor = matrix[row][column] / matrix[column][column];
            let (above, below) = matrix.split_at_mut(row);
            below[0].iter_mut().zip(&above[column]).for_each(|(entry, top)| *entry -= factor * top);
            right[row] -= factor * right[column];
        }
    }
    for row in (0..order).rev() {
        let known: f64 = (row + 1..order).map(|column| matrix[row][column] * right[column]).sum();
        right[row] = (right[row] - known) / matrix[row][row];
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_with_a_pivot_of_0_is_solved() {
        // x = 1, y = -2, z = 3
        let matrix = vec![vec![0.0, 2.0, 1.0], vec![1.0, 1.0, 0.0], vec![2.0, 0.0, 1.0]];
        let found = solved(matrix, vec![-1.0, -1.0, 5.0]).unwrap();
        assert!(
            found.iter().zip([1.0, -2.0, 3.0]).all(|(one, other)| (one - other).abs() < 1e-14),
            "{found:?}"
        );
    }

    #[test]
    fn a_singular_system_has_no_solution() {
        assert_eq!(solved(vec![vec![1.0, 2.0], vec![2.0, 4.0]], vec![1.0, 2.0]), None);
    }
}
