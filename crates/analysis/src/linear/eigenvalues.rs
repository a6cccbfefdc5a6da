//! Eigenvalues of a real matrix, block by block, with what rounding splits put together again.

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{Complex, DMatrix, DVector, Matrix2, Schur, Vector2};
use petgraph::algo::kosaraju_scc;
use petgraph::graph::DiGraph;

/// An eigenvalue with the number of times that it stands in its block.
pub(super) type Counted = (Complex<f64>, usize);

/// Eigenvalues of the blocks of states that act on each other, or the states of a block for which they were not
/// found. A row of blocks that act one way only has those of the blocks: no rounding goes from one to the next.
pub(super) fn eigenvalues(matrix: &DMatrix<f64>) -> Result<Vec<Counted>, Vec<usize>> {
    let mut all = Vec::new();
    for mut block in blocks(matrix) {
        block.sort_unstable();
        let part =
            DMatrix::from_fn(block.len(), block.len(), |row, column| matrix[(block[row], block[column])]);
        all.extend(of_block(part).ok_or(block)?);
    }
    Ok(all)
}

/// The groups of indices that act on each other, by way of others too.
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

/// Iterations for each row, beyond which the method does not converge.
const MOST_ITERATIONS: usize = 100;

fn of_block(mut matrix: DMatrix<f64>) -> Option<Vec<Counted>> {
    if matrix.nrows() == 1 {
        return Some(vec![(Complex::from(matrix[(0, 0)]), 1)]);
    }
    balance_parlett_reinsch(&mut matrix);
    let most = MOST_ITERATIONS * matrix.nrows();
    let schur = Schur::try_new(matrix.clone(), f64::EPSILON, most)
        .or_else(|| Schur::try_new(reflected(&matrix), f64::EPSILON, most))?;
    let (_, triangle) = schur.unpack();
    let triangle = upper(&triangle);
    Some(merged(&triangle, triangle.diagonal().iter().map(|one| (*one, 1)).collect()))
}

/// The same matrix in mirrored coordinates. Equal gains around a ring can make the iteration run in circles, which
/// ends once they are not equal any more.
fn reflected(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let axis = DVector::from_fn(matrix.nrows(), |row, _| 1.0 / (1.0 + row as f64)).normalize();
    let mirror = DMatrix::identity(matrix.nrows(), matrix.nrows()) - 2.0 * &axis * axis.transpose();
    &mirror * matrix * &mirror
}

/// A triangle with blocks of two rows along its diagonal, turned until it has none: eigenvalues stand on the diagonal,
/// those of a block conjugate to each other.
fn upper(triangle: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
    let mut turned = triangle.map(Complex::from);
    for row in (1..triangle.nrows()).filter(|row| triangle[(*row, row - 1)] != 0.0) {
        let (a, b) = (triangle[(row - 1, row - 1)], triangle[(row - 1, row)]);
        let (c, d) = (triangle[(row, row - 1)], triangle[(row, row)]);
        let root = Complex::from(0.25 * (a - d) * (a - d) + b * c).sqrt();
        let (middle, slant) = (Complex::from(0.5 * (a + d)), Complex::from(0.5 * (a - d)));
        // The longer of the eigenvector's two forms is (slant + root, c) with the root that does not cancel.
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

/// What a rounded matrix can be off, as a share of its size and of its rows.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Eigenvalues farther from each other than this share of the matrix are not one that rounding has split.
const SPLIT: f64 = 1e-2;

/// Eigenvalues of which the mean is an eigenvalue to rounding are one that stands there several times: rounding
/// splits it by the root of their number of itself, and leaves their mean alone. Neighbours are put together until none
/// are one any more. Parts smaller than rounding are 0.
fn merged(triangle: &DMatrix<Complex<f64>>, mut all: Vec<Counted>) -> Vec<Counted> {
    let size = triangle.norm();
    let rounding = ROUNDING * triangle.nrows() as f64 * size;
    let (mut at, mut apart) = (0, 0);
    while apart < all.len() {
        let one = all[at];
        let neighbour = nearest(&all, at).filter(|other| {
            (one.0 - all[*other].0).norm() <= SPLIT * size
                && has_eigenvalue(triangle, together(one, all[*other]).0, rounding)
        });
        match neighbour {
            Some(other) => {
                all[at] = together(one, all[other]);
                all.remove(other);
                (at, apart) = (at - usize::from(other < at), 0);
            }
            None => (at, apart) = ((at + 1) % all.len(), apart + 1),
        }
    }
    let clean = |part: f64| if part.abs() <= rounding { 0.0 } else { part };
    all.into_iter().map(|(one, times)| (Complex::new(clean(one.re), clean(one.im)), times)).collect()
}

/// The one that lies nearest to that of an index.
fn nearest(all: &[Counted], at: usize) -> Option<usize> {
    let distance = |other: usize| (all[at].0 - all[other].0).norm();
    let others = (0..all.len()).filter(|other| *other != at);
    others.min_by(|one, other| distance(*one).total_cmp(&distance(*other)))
}

/// Two as one that is there as often as both: their mean.
fn together(one: Counted, other: Counted) -> Counted {
    let times = one.1 + other.1;
    ((one.0 * one.1 as f64 + other.0 * other.1 as f64) / times as f64, times)
}

/// Rounds of the iteration: the first finds the scale, the others the rest of it.
const ROUNDS: usize = 4;

/// Whether a triangle is as near as `rounding` to one with this eigenvalue: its least singular value without it is, by
/// inverse iteration, no larger.
fn has_eigenvalue(triangle: &DMatrix<Complex<f64>>, eigenvalue: Complex<f64>, rounding: f64) -> bool {
    let mut shifted = triangle.clone();
    (0..shifted.nrows()).for_each(|row| shifted[(row, row)] -= eigenvalue);
    let mut vector = DVector::from_element(shifted.nrows(), Complex::from(1.0)).normalize();
    for _ in 0..ROUNDS {
        let back = shifted.ad_solve_upper_triangular(&vector);
        // A zero on the diagonal: it is an eigenvalue.
        let Some(forth) = back.and_then(|back| shifted.solve_upper_triangular(&back)) else { return true };
        let growth = forth.norm();
        let is_apart = growth.sqrt() * rounding < 1.0;
        if !is_apart {
            return true;
        }
        vector = forth / Complex::from(growth);
    }
    false
}
