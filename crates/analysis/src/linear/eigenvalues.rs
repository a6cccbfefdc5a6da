//! Eigenvalues of a real matrix, with multiplicities.
//!
//! The matrix is first divided into blocks of states that act on each other. Each block is balanced and brought to
//! Schur form. Rounding splits a multiple eigenvalue into a cluster. Clusters whose mean is an eigenvalue to rounding
//! are merged.

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{Complex, DMatrix, DVector, Matrix2, Schur, Vector2};
use petgraph::algo::kosaraju_scc;
use petgraph::graph::DiGraph;

/// An eigenvalue and its multiplicity within its block.
pub(super) type Eigenvalue = (Complex<f64>, usize);

/// The eigenvalues of all blocks. The error has the states of a block whose iteration does not converge.
///
/// Blocks that act on each other in one direction only are independent, so rounding errors of one do not affect
/// another.
pub(super) fn eigenvalues(matrix: &DMatrix<f64>) -> Result<Vec<Eigenvalue>, Vec<usize>> {
    let mut all = Vec::new();
    for mut block in blocks(matrix) {
        block.sort_unstable();
        let part =
            DMatrix::from_fn(block.len(), block.len(), |row, column| matrix[(block[row], block[column])]);
        all.extend(of_block(part).ok_or(block)?);
    }
    Ok(all)
}

/// Groups of indices that act on each other directly or through others (strongly connected components).
pub(super) fn blocks(matrix: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let mut graph = DiGraph::<(), ()>::new();
    let nodes: Vec<_> = (0..matrix.nrows()).map(|_| graph.add_node(())).collect();
    for (row, column) in
        (0..matrix.nrows()).flat_map(|row| (0..matrix.ncols()).map(move |column| (row, column)))
    {
        if matrix[(row, column)] != 0.0 {
            graph.add_edge(nodes[column], nodes[row], ());
        }
    }
    let groups = kosaraju_scc(&graph).into_iter();
    groups.map(|group| group.into_iter().map(|node| node.index()).collect()).collect()
}

/// The largest number of iterations per row before the method counts as not converging.
const MAX_ITERATIONS: usize = 100;

/// The eigenvalues of one block; None if the iteration does not converge.
fn of_block(mut matrix: DMatrix<f64>) -> Option<Vec<Eigenvalue>> {
    if matrix.nrows() == 1 {
        return Some(vec![(Complex::from(matrix[(0, 0)]), 1)]);
    }
    balance_parlett_reinsch(&mut matrix);
    let limit = MAX_ITERATIONS * matrix.nrows();
    let schur = Schur::try_new(matrix.clone(), f64::EPSILON, limit)
        .or_else(|| Schur::try_new(reflected(&matrix), f64::EPSILON, limit))?;
    let (_, triangle) = schur.unpack();
    let triangle = upper(&triangle);
    Some(merge_clusters(&triangle, triangle.diagonal().iter().map(|one| (*one, 1)).collect()))
}

/// The matrix in reflected coordinates, with the same eigenvalues. If all gains around a ring are equal, the iteration
/// can cycle forever. The reflection makes them unequal.
fn reflected(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let axis = DVector::from_fn(matrix.nrows(), |row, _| 1.0 / (1.0 + row as f64)).normalize();
    let mirror = DMatrix::identity(matrix.nrows(), matrix.nrows()) - 2.0 * &axis * axis.transpose();
    &mirror * matrix * &mirror
}

/// Converts a real Schur form, with 2 x 2 blocks on the diagonal, to a complex upper triangle. The eigenvalues are on
/// the diagonal, and those of a block are exactly conjugate.
fn upper(triangle: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
    let mut turned = triangle.map(Complex::from);
    for row in (1..triangle.nrows()).filter(|row| triangle[(*row, row - 1)] != 0.0) {
        let (a, b) = (triangle[(row - 1, row - 1)], triangle[(row - 1, row)]);
        let (c, d) = (triangle[(row, row - 1)], triangle[(row, row)]);
        let root = Complex::from(0.25 * (a - d) * (a - d) + b * c).sqrt();
        let (middle, slant) = (Complex::from(0.5 * (a + d)), Complex::from(0.5 * (a - d)));
        // (slant + root, c) is an eigenvector. The sign of the root avoids cancellation.
        let root = if (slant.conj() * root).re < 0.0 { -root } else { root };
        let vector = Vector2::new(slant + root, Complex::from(c)).normalize();
        let turn = Matrix2::new(vector.x, -vector.y.conj(), vector.y, vector.x.conj());
        let columns = turned.columns(row - 1, 2) * turn;
        turned.columns_mut(row - 1, 2).copy_from(&columns);
        let rows = turn.adjoint() * turned.rows(row - 1, 2);
        turned.rows_mut(row - 1, 2).copy_from(&rows);
        (turned[(row - 1, row - 1)], turned[(row, row)]) = (middle + root, middle - root);
        turned[(row, row - 1)] = Complex::from(0.0);
    }
    turned
}

/// Relative rounding error of a matrix, per row.
const MATRIX_ROUNDING: f64 = 16.0 * f64::EPSILON;
/// The largest distance of eigenvalues that may be merged, as a fraction of the norm of the matrix.
const MAX_SPLIT: f64 = 1e-2;

/// Merges eigenvalues that rounding has split.
///
/// Rounding splits an n-fold eigenvalue by the n-th root of the rounding error, but hardly moves the mean. Neighbours
/// are merged as long as their mean is an eigenvalue to rounding. Real and imaginary parts below rounding become 0.
fn merge_clusters(triangle: &DMatrix<Complex<f64>>, mut all: Vec<Eigenvalue>) -> Vec<Eigenvalue> {
    let size = triangle.norm();
    let rounding = MATRIX_ROUNDING * triangle.nrows() as f64 * size;
    let (mut at, mut unmerged) = (0, 0);
    while unmerged < all.len() {
        let one = all[at];
        let neighbour = nearest(&all, at).filter(|other| {
            (one.0 - all[*other].0).norm() <= MAX_SPLIT * size
                && has_eigenvalue(triangle, weighted_mean(one, all[*other]).0, rounding)
        });
        match neighbour {
            Some(other) => {
                all[at] = weighted_mean(one, all[other]);
                all.remove(other);
                (at, unmerged) = (at - usize::from(other < at), 0);
            }
            None => (at, unmerged) = ((at + 1) % all.len(), unmerged + 1),
        }
    }
    let clean = |part: f64| if part.abs() <= rounding { 0.0 } else { part };
    all.into_iter().map(|(one, times)| (Complex::new(clean(one.re), clean(one.im)), times)).collect()
}

/// The index of the eigenvalue nearest to that at `at`; None if there is no other.
fn nearest(all: &[Eigenvalue], at: usize) -> Option<usize> {
    let distance = |other: usize| (all[at].0 - all[other].0).norm();
    let others = (0..all.len()).filter(|other| *other != at);
    others.min_by(|one, other| distance(*one).total_cmp(&distance(*other)))
}

/// The mean of two eigenvalues, weighted by multiplicity, with the sum of their multiplicities.
fn weighted_mean(one: Eigenvalue, other: Eigenvalue) -> Eigenvalue {
    let multiplicity = one.1 + other.1;
    ((one.0 * one.1 as f64 + other.0 * other.1 as f64) / multiplicity as f64, multiplicity)
}

/// The number of inverse iterations. The first one finds the order of magnitude, the others refine it.
const INVERSE_ITERATIONS: usize = 4;

/// Whether a triangle within the distance `rounding` of the given one has this eigenvalue. Inverse iteration estimates
/// the smallest singular value of the shifted triangle, which is this distance.
fn has_eigenvalue(triangle: &DMatrix<Complex<f64>>, eigenvalue: Complex<f64>, rounding: f64) -> bool {
    let mut shifted = triangle.clone();
    (0..shifted.nrows()).for_each(|row| shifted[(row, row)] -= eigenvalue);
    let mut vector = DVector::from_element(shifted.nrows(), Complex::from(1.0)).normalize();
    for _ in 0..INVERSE_ITERATIONS {
        let backward = shifted.ad_solve_upper_triangular(&vector);
        // A solution does not exist if the diagonal has a zero, so this is an eigenvalue.
        let Some(forward) = backward.and_then(|backward| shifted.solve_upper_triangular(&backward)) else {
            return true;
        };
        let growth = forward.norm();
        let is_distinct = growth.sqrt() * rounding < 1.0;
        if !is_distinct {
            return true;
        }
        vector = forward / Complex::from(growth);
    }
    false
}
