//! Small systems of linear equations between numbers.

use nalgebra::{DMatrix, DVector};

/// The solution of a square system. `matrix` has its rows. `None` if it is singular, or if a number is not finite.
pub(crate) fn linear_solution(matrix: &[Vec<f64>], right: Vec<f64>) -> Option<Vec<f64>> {
    if !matrix.iter().flatten().all(|entry| entry.is_finite()) {
        return None;
    }
    let order = right.len();
    let matrix = DMatrix::from_fn(order, order, |row, column| matrix[row][column]);
    let solution = matrix.lu().solve(&DVector::from_vec(right))?;
    solution.iter().all(|value| value.is_finite()).then(|| solution.as_slice().to_vec())
}

#[cfg(test)]
mod tests {
    use super::linear_solution;

    #[test]
    fn a_system_with_a_pivot_of_0_is_solved() {
        // 2 y = 4 and 3 x + y = 11, in an order that needs an exchange of rows.
        let found = linear_solution(&[vec![0.0, 2.0], vec![3.0, 1.0]], vec![4.0, 11.0]);
        assert_eq!(found, Some(vec![3.0, 2.0]));
        // x = 1, y = -2, z = 3
        let matrix = [vec![0.0, 2.0, 1.0], vec![1.0, 1.0, 0.0], vec![2.0, 0.0, 1.0]];
        let found = linear_solution(&matrix, vec![-1.0, -1.0, 5.0]).unwrap();
        let is_near = |(one, other): (&f64, f64)| (one - other).abs() < 1e-14;
        assert!(found.iter().zip([1.0, -2.0, 3.0]).all(is_near), "{found:?}");
    }

    #[test]
    fn a_singular_system_has_no_solution() {
        assert_eq!(linear_solution(&[vec![1.0, 2.0], vec![2.0, 4.0]], vec![1.0, 2.0]), None);
        assert_eq!(linear_solution(&[vec![0.0]], vec![0.0]), None);
    }

    #[test]
    fn numbers_that_are_not_finite_have_no_solution() {
        for entry in [f64::NAN, f64::INFINITY] {
            assert_eq!(linear_solution(&[vec![entry]], vec![1.0]), None);
        }
        assert_eq!(linear_solution(&[vec![1.0]], vec![f64::NAN]), None);
    }
}
