//! Eigenvalues of a real matrix, block by block, with what rounding splits put together again.

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{Complex, DMatrix, DVector, Schur};
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
    Some(merged(&matrix, diagonal(&triangle)))
}

/// The same matrix in mirrored coordinates. Equal gains around a ring can make the iteration run in circles, which
/// ends once they are not equal any more.
fn reflected(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let axis = DVector::from_fn(matrix.nrows(), |row, _| 1.0 / (1.0 + row as f64)).normalize();
    let mirror = DMatrix::identity(matrix.nrows(), matrix.nrows()) - 2.0 * &axis * axis.transpose();
    &mirror * matrix * &mirror
}

/// The eigenvalues of the blocks of one and two rows along the diagonal.
fn diagonal(triangle: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let (mut row, mut all) = (0, Vec::new());
    while row < triangle.nrows() {
        let is_pair = row + 1 < triangle.nrows() && triangle[(row + 1, row)] != 0.0;
        if is_pair {
            let (a, b) = (triangle[(row, row)], triangle[(row, row + 1)]);
            let (c, d) = (triangle[(row + 1, row)], triangle[(row + 1, row + 1)]);
            let root = Complex::from(0.25 * (a - d) * (a - d) + b * c).sqrt();
            let middle = Complex::from(0.5 * (a + d));
            all.extend([middle + root, middle - root]);
            row += 2;
        } else {
            all.push(Complex::from(triangle[(row, row)]));
            row += 1;
        }
    }
    all
}

/// What a rounded matrix can be off, as a share of its size and of its rows.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Eigenvalues farther from each other than this share of the matrix are not one that rounding has split.
const SPLIT: f64 = 1e-2;

/// Eigenvalues of which the mean is an eigenvalue to rounding are one that stands there several times: rounding
/// splits it by the root of their number of itself, and leaves their mean alone. Parts smaller than rounding are 0.
fn merged(matrix: &DMatrix<f64>, mut all: Vec<Complex<f64>>) -> Vec<Counted> {
    let size = matrix.norm();
    let rounding = ROUNDING * matrix.nrows() as f64 * size;
    let is_one = |one: Complex<f64>, other: Complex<f64>| {
        (one - other).norm() <= SPLIT * size && distance(matrix, 0.5 * (one + other)) <= rounding
    };
    let mut found = Vec::new();
    while let Some(first) = all.pop() {
        let mut group = vec![first];
        let mut next = 0;
        while next < group.len() {
            let (near, far) = all.into_iter().partition(|other| is_one(group[next], *other));
            group.extend::<Vec<_>>(near);
            (all, next) = (far, next + 1);
        }
        let mean = group.iter().sum::<Complex<f64>>() / group.len() as f64;
        let clean = |part: f64| if part.abs() <= rounding { 0.0 } else { part };
        found.push((Complex::new(clean(mean.re), clean(mean.im)), group.len()));
    }
    found
}

/// How far the matrix is from one that has this eigenvalue: its least singular value without it.
fn distance(matrix: &DMatrix<f64>, eigenvalue: Complex<f64>) -> f64 {
    let shifted = matrix.map(Complex::from)
        - DMatrix::from_diagonal_element(matrix.nrows(), matrix.nrows(), eigenvalue);
    shifted.singular_values().min()
}
