//! The solution of a loop: Newton's method for the values of its tears.
//!
//! The matrix of derivatives comes from differences. A step is shortened until the next step would be shorter, so that
//! the unknowns stay near the solution that they follow.

use nalgebra::{DMatrix, DVector, Dyn, LU};

use super::law::Law;
use super::order::Loop;

/// Largest number of steps of a solution.
const MAX_STEPS: usize = 60;
/// Length of the last step, as a share of the size of the unknowns.
const TOLERANCE: f64 = 1e-11;
/// Change of an unknown for a difference, as a share of its size.
const DIFFERENCE: f64 = 1e-7;
/// Least share of a step.
const LEAST_SHARE: f64 = 1e-3;
/// Starts of a search as multiples of the size of the unknowns.
const STARTS: [f64; 9] = [0.0, 0.5, -0.5, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0];
/// Factors of the size of the unknowns, in the order in which a search tries them.
const SIZES: [f64; 5] = [1.0, 1e-3, 1e3, 1e-6, 1e6];

/// A loop with the values of all nodes. Those of its tears are unknown.
pub(super) struct OpenLoop<'a> {
    /// The laws of all nodes.
    pub laws: &'a [Law],
    /// The loop.
    pub entry: &'a Loop,
    /// The values of all nodes.
    pub values: &'a mut [f64],
    /// The largest magnitude that each node has had as a tear, or may have; 0 if it is not known.
    pub sizes: &'a mut [f64],
    /// The value of each node near which the first solution is sought. `None` if it is not known.
    pub starts: &'a [Option<f64>],
}

impl OpenLoop<'_> {
    /// Solves the loop from the present values of the tears. Returns false if there is no solution near them.
    pub(super) fn follow(&mut self) -> bool {
        let is_solved = self.solve();
        if is_solved {
            for tear in &self.entry.tears {
                self.sizes[*tear] = self.sizes[*tear].max(self.values[*tear].abs());
            }
        }
        is_solved
    }

    /// Solves the loop from the known starts, with 0 for the other tears. If no start is known and there is no solution
    /// near 0, several starts are tried. Returns false if none leads to a solution. It need not be stable.
    pub(super) fn approach(&mut self) -> bool {
        self.set_starts();
        self.follow() || (!self.has_start() && self.follow_nearest(|_| true))
    }

    /// Solves the loop from the known starts. If there are none, or the solution near them is not stable, several starts
    /// are tried, and the solution nearest to 0 is taken. Returns false if none is found.
    pub(super) fn search(&mut self) -> bool {
        if self.has_start() {
            self.set_starts();
            if self.solve() && self.is_stable() {
                return self.follow();
            }
        }
        self.follow_nearest(Self::is_stable)
    }

    /// Whether the start of a tear is known.
    fn has_start(&self) -> bool {
        self.entry.tears.iter().any(|tear| self.starts[*tear].is_some())
    }

    /// Tries several starts, and takes the solution nearest to 0 that is permitted. Returns false if none is found.
    fn follow_nearest(&mut self, is_permitted: fn(&mut Self) -> bool) -> bool {
        for size in SIZES {
            let found = STARTS.iter().filter_map(|start| self.solution_from(start * size, is_permitted));
            let Some(nearest) = found.min_by(|one, other| one.amax().total_cmp(&other.amax())) else {
                continue;
            };
            self.set_tears(&nearest);
            return self.follow();
        }
        false
    }

    /// The permitted solution that is found from tears of this many sizes.
    fn solution_from(&mut self, start: f64, is_permitted: fn(&mut Self) -> bool) -> Option<DVector<f64>> {
        let size = |tear: &usize| if self.sizes[*tear] > 0.0 { self.sizes[*tear] } else { 1.0 };
        let starts = self.entry.tears.iter().map(|tear| start * size(tear)).collect();
        self.set_tears(&DVector::from_vec(starts));
        (self.solve() && is_permitted(self)).then(|| self.tears())
    }

    /// Whether an open amplifier keeps the present solution: the sum of a single equation rises with its unknown.
    fn is_stable(&mut self) -> bool {
        let [tear] = self.entry.tears[..] else { return true };
        if !matches!(self.laws[tear], Law::Zero(_)) {
            return true;
        }
        self.own_slope(0) > 0.0
    }

    /// The derivative of what must be 0 at a tear with respect to the tear itself, from differences to both sides. All
    /// values stay.
    pub(super) fn own_slope(&mut self, index: usize) -> f64 {
        let tear = self.entry.tears[index];
        let (begin, change) = (self.values[tear], self.difference(tear));
        let [[below, low], [above, high]] = [begin - change, begin + change].map(|value| {
            self.values[tear] = value;
            [value, self.residual()[index]]
        });
        self.values[tear] = begin;
        self.residual();
        (high - low) / (above - below)
    }

    /// Solves the loop from the present values of the tears. Returns false if the method finds no solution.
    fn solve(&mut self) -> bool {
        let mut residual = self.residual();
        for _ in 0..MAX_STEPS {
            if residual.iter().all(|value| *value == 0.0) {
                return true;
            }
            let factors = self.derivatives(&residual).lu();
            let Some(step) = factors.solve(&residual) else { return false };
            let begin = self.tears();
            let weights = self.weights(&begin, &step);
            let length = relative(&step, &weights);
            let Some(next) = self.descend(&factors, [&begin, &step, &weights], length) else { return false };
            if length <= TOLERANCE {
                return true;
            }
            residual = next;
        }
        false
    }

    /// Takes the largest share of a step from `begin` after which the next step is shorter. Returns the residual there;
    /// `None` if there is no such share.
    fn descend(
        &mut self,
        factors: &LU<f64, Dyn, Dyn>,
        [begin, step, weights]: [&DVector<f64>; 3],
        length: f64,
    ) -> Option<DVector<f64>> {
        let mut share = 1.0;
        while share >= LEAST_SHARE {
            self.set_tears(&(begin - step * share));
            let residual = self.residual();
            let next = relative(&factors.solve(&residual)?, weights);
            if next <= (1.0 - 0.25 * share) * length || length <= TOLERANCE {
                return Some(residual);
            }
            share *= 0.5;
        }
        None
    }

    /// The sizes of the unknowns before and after a step, by which steps are measured.
    fn weights(&self, begin: &DVector<f64>, step: &DVector<f64>) -> DVector<f64> {
        let known = self.entry.tears.iter().map(|tear| self.sizes[*tear]);
        let weights = known.zip(begin.iter().zip(step.iter())).map(|(size, (begin, step))| {
            let size = size.max(begin.abs()).max((begin - step).abs());
            if size > 0.0 { size } else { 1.0 }
        });
        DVector::from_vec(weights.collect())
    }

    /// Sets the tears to the known starts, and the others to 0.
    fn set_starts(&mut self) {
        for tear in &self.entry.tears {
            self.values[*tear] = self.starts[*tear].unwrap_or(0.0);
        }
    }

    /// The change of a tear for a difference.
    fn difference(&self, tear: usize) -> f64 {
        let size = self.sizes[tear].max(self.values[tear].abs());
        DIFFERENCE * if size > 0.0 { size } else { 1.0 }
    }

    /// The values of the tears.
    fn tears(&self) -> DVector<f64> {
        DVector::from_vec(self.entry.tears.iter().map(|tear| self.values[*tear]).collect())
    }

    /// Sets the values of the tears.
    fn set_tears(&mut self, to: &DVector<f64>) {
        for (tear, value) in self.entry.tears.iter().zip(to.iter()) {
            self.values[*tear] = *value;
        }
    }

    /// Computes the members from the tears. Returns what must be 0, one number for each tear.
    fn residual(&mut self) -> DVector<f64> {
        let mut residual = DVector::zeros(self.entry.tears.len());
        for (node, tear) in &self.entry.members {
            let law = &self.laws[*node];
            match tear {
                Some(index) => residual[*index] = law.residual(*node, self.values),
                None => self.values[*node] = law.value(*node, self.values),
            }
        }
        residual
    }

    /// The derivatives of the residual by the tears, from differences to the present residual. The tears stay, but the
    /// members change.
    fn derivatives(&mut self, residual: &DVector<f64>) -> DMatrix<f64> {
        let entry = self.entry;
        let mut derivatives = DMatrix::zeros(entry.tears.len(), entry.tears.len());
        for (column, tear) in entry.tears.iter().enumerate() {
            let begin = self.values[*tear];
            self.values[*tear] = begin + self.difference(*tear);
            let change = self.values[*tear] - begin;
            let slopes = (self.residual() - residual) / change;
            derivatives.set_column(column, &slopes);
            self.values[*tear] = begin;
        }
        derivatives
    }
}

/// The largest entry of a step as a share of its weight. NaN if an entry is not a number.
fn relative(step: &DVector<f64>, weights: &DVector<f64>) -> f64 {
    let shares = step.iter().zip(weights.iter()).map(|(step, weight)| (step / weight).abs());
    shares.fold(0.0, |largest, share| if share > largest || share.is_nan() { share } else { largest })
}
