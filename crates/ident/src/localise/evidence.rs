//! Regularised least squares: numbers of which neighbours are alike, found from data beside others that are free, with as much
//! likeness as the data bear out (the largest marginal likelihood).

use nalgebra::{DMatrix, DVector};

/// Sums of products of the columns of a linear problem: those of the free numbers,
/// those of the sought ones, and last what is to be explained.
#[derive(Debug, Clone)]
pub struct Products {
    /// What is known of each free number before.
    pub known: Vec<Known>,
    /// How many numbers are sought, group by group: only within a group neighbours are alike.
    pub groups: Vec<usize>,
    /// The sum of squares that is left without the sought numbers.
    pub without: f64,
    sums: DMatrix<f64>,
    rows: usize,
}

/// What is known of a number.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// Where it is expected.
    pub at: f64,
    /// The inverse of the variance about that, over that of the noise.
    pub weight: f64,
    /// The least and the largest value that it may have.
    pub range: [f64; 2],
}

impl Known {
    fn may_be(&self, value: f64) -> bool {
        (self.range[0]..=self.range[1]).contains(&value)
    }
}

/// Numbers found.
#[derive(Debug, Clone)]
pub struct Solved {
    /// The free ones.
    pub(super) free: DVector<f64>,
    /// The sought ones.
    pub(super) sought: DVector<f64>,
    /// Their covariance.
    pub(super) covariance: DMatrix<f64>,
    /// Logarithm of the marginal likelihood, above that of all sought numbers being 0.
    pub evidence: f64,
    /// To how many free numbers the sought ones come.
    pub effective: f64,
    /// The sum of squares that is left.
    pub left: f64,
    /// How neighbours are alike.
    pub likeness: Likeness,
    /// The variance of what is sought, over that of the noise.
    weight: f64,
}

/// How neighbouring numbers are alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Likeness {
    /// Their differences are small: a curve that may jump.
    Rough,
    /// Differences of their differences are small: a smooth curve.
    Smooth,
}

impl Likeness {
    /// Both.
    pub const ALL: [Likeness; 2] = [Likeness::Rough, Likeness::Smooth];

    /// The word for it.
    pub fn as_str(self) -> &'static str {
        match self {
            Likeness::Rough => "rough",
            Likeness::Smooth => "smooth",
        }
    }

    /// Numbers of a group as sums of independent ones of variance 1; the last of them has a variance of 2 or 3 whatever their count.
    fn root(self, count: usize) -> DMatrix<f64> {
        let n = count as f64;
        DMatrix::from_fn(count, count, |row, column| match (self, column) {
            (_, 0) => 1.0,
            (Likeness::Smooth, 1) => row as f64 / n,
            (Likeness::Rough, _) if column <= row => n.sqrt().recip(),
            (Likeness::Smooth, _) if column <= row => (row + 1 - column) as f64 * (3.0 / n.powi(3)).sqrt(),
            _ => 0.0,
        })
    }

    fn roots(self, groups: &[usize]) -> DMatrix<f64> {
        let all = groups.iter().sum();
        let mut roots = DMatrix::zeros(all, all);
        let mut first = 0;
        for count in groups {
            roots.view_mut((first, first), (*count, *count)).copy_from(&self.root(*count));
            first += count;
        }
        roots
    }
}

/// Weights are tried from this on, over the inverse of what the data tell of what they tell most of, each so many times the one before.
const FIRST_WEIGHT: f64 = 1e-2;
const NEXT_WEIGHT: f64 = 2.0;
const WEIGHTS: i32 = 60;

/// What is known of frozen numbers, over what the data tell of any.
const FROZEN: f64 = 1e6;

/// The problem without its free numbers, in independent numbers.
struct Reduced {
    roots: DMatrix<f64>,
    values: DVector<f64>,
    vectors: DMatrix<f64>,
    /// What the data say of each direction.
    told: DVector<f64>,
    /// What is to be explained, in squares.
    all: f64,
    without: f64,
    rows: f64,
}

impl Products {
    /// Of no rows yet.
    pub fn new(known: Vec<Known>, groups: Vec<usize>, without: f64) -> Products {
        let size = known.len() + groups.iter().sum::<usize>() + 1;
        Products { known, groups, without, sums: DMatrix::zeros(size, size), rows: 0 }
    }

    /// Adds rows.
    pub fn add(&mut self, rows: &DMatrix<f64>) {
        // Most numbers matter to few records.
        let is_felt = |place: &usize| rows.column(*place).iter().any(|value| *value != 0.0);
        let felt: Vec<usize> = (0..rows.ncols()).filter(is_felt).collect();
        for (first, one) in felt.iter().enumerate() {
            for other in &felt[first..] {
                let sum = self.sums[(*one, *other)] + rows.column(*one).dot(&rows.column(*other));
                (self.sums[(*one, *other)], self.sums[(*other, *one)]) = (sum, sum);
            }
        }
        self.rows += rows.nrows();
    }

    /// The same where the sought numbers are sums of fewer: a row of `shares` for each.
    pub fn over(&self, shares: &DMatrix<f64>, groups: Vec<usize>) -> Products {
        let (free, sought) = (self.known.len(), self.sought());
        let mut all = DMatrix::zeros(free + sought + 1, free + shares.ncols() + 1);
        (0..free).for_each(|place| all[(place, place)] = 1.0);
        all.view_mut((free, free), shares.shape()).copy_from(shares);
        all[(free + sought, free + shares.ncols())] = 1.0;
        let sums = all.tr_mul(&(&self.sums * &all));
        Products { known: self.known.clone(), groups, without: self.without, sums, rows: self.rows }
    }

    /// The same with free numbers that stay where they are.
    pub fn frozen(&self) -> Products {
        let known = self.known.iter().map(|own| self.fixed(own, 0.0)).collect();
        Products { known, ..self.clone() }
    }

    /// What is known of a free number that is at a value.
    fn fixed(&self, known: &Known, at: f64) -> Known {
        Known { at, weight: FROZEN * self.sums.diagonal().max(), ..*known }
    }

    /// The most likely numbers, with the likeness and weight that the data bear out; free numbers that would leave their ranges stand
    /// at the ends of these.
    pub fn solved(&self) -> Option<Solved> {
        let mut known = self.known.clone();
        let mut is_open = vec![true; known.len()];
        loop {
            let solved = self.most_likely(&known)?;
            let left: Vec<usize> = (0..known.len())
                .filter(|place| is_open[*place] && !known[*place].may_be(solved.free[*place]))
                .collect();
            if left.is_empty() {
                return Some(solved);
            }
            for place in left {
                let [low, high] = known[place].range;
                known[place] = self.fixed(&known[place], solved.free[place].clamp(low, high));
                is_open[place] = false;
            }
        }
    }

    fn most_likely(&self, known: &[Known]) -> Option<Solved> {
        let sums = self.with_known(known);
        let each = Likeness::ALL.iter().filter_map(|likeness| self.solve(&sums, *likeness));
        each.max_by(|a, b| a.evidence.total_cmp(&b.evidence))
    }

    fn with_known(&self, known: &[Known]) -> DMatrix<f64> {
        let (mut sums, last) = (self.sums.clone(), self.sums.ncols() - 1);
        for (place, Known { at, weight, .. }) in known.iter().enumerate() {
            sums[(place, place)] += weight;
            sums[(place, last)] += weight * at;
            sums[(last, place)] += weight * at;
            sums[(last, last)] += weight * at * at;
        }
        sums
    }

    fn sought(&self) -> usize {
        self.groups.iter().sum()
    }

    fn solve(&self, sums: &DMatrix<f64>, likeness: Likeness) -> Option<Solved> {
        let (eliminated, reduced) = self.reduced(sums, likeness)?;
        let weight = reduced.best();
        let (sought, covariance) = reduced.found(weight);
        Some(Solved {
            free: eliminated.free(&sought),
            sought,
            covariance,
            evidence: reduced.evidence(weight),
            effective: reduced.values.iter().map(|value| weight * value / (1.0 + weight * value)).sum(),
            left: reduced.left(weight),
            likeness,
            weight,
        })
    }

    /// The covariance of the sought numbers if the free ones were known, of numbers found.
    pub fn covariance_alone(&self, found: &Solved) -> Option<DMatrix<f64>> {
        let frozen = self.frozen();
        let (_, reduced) = frozen.reduced(&frozen.with_known(&frozen.known), found.likeness)?;
        Some(reduced.found(found.weight).1)
    }

    fn reduced(&self, sums: &DMatrix<f64>, likeness: Likeness) -> Option<(Eliminated, Reduced)> {
        let free = self.known.len();
        let eliminated = Eliminated::of(sums, free)?;
        let rows = self.rows.saturating_sub(free).max(1);
        let reduced = Reduced::of(&eliminated, likeness.roots(&self.groups), rows, self.without);
        Some((eliminated, reduced))
    }
}

/// The problem without its free numbers.
struct Eliminated {
    /// What the free numbers come to: for each sought one, and for what is to be explained.
    through: DMatrix<f64>,
    /// The sums of products that are left.
    outer: DMatrix<f64>,
}

impl Eliminated {
    fn of(sums: &DMatrix<f64>, free: usize) -> Option<Eliminated> {
        let rest = sums.ncols() - free;
        let inner = sums.view((0, 0), (free, free)).clone_owned().cholesky()?;
        let beside = sums.view((0, free), (free, rest));
        let through = inner.solve(&beside);
        let outer = sums.view((free, free), (rest, rest)) - beside.tr_mul(&through);
        Some(Eliminated { through, outer })
    }

    fn sought(&self) -> usize {
        self.outer.ncols() - 1
    }

    /// Products of the sought numbers among each other and with what is to be explained, by independent ones.
    fn of_roots(&self, roots: &DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
        let count = self.sought();
        let matrix = roots.tr_mul(&(self.outer.view((0, 0), (count, count)) * roots));
        let told = roots.tr_mul(&self.outer.view((0, count), (count, 1)).column(0));
        ((&matrix + matrix.transpose()) / 2.0, told)
    }

    /// The free numbers that go with the sought ones.
    fn free(&self, sought: &DVector<f64>) -> DVector<f64> {
        let count = self.sought();
        self.through.column(count) - self.through.columns(0, count) * sought
    }
}

impl Reduced {
    fn of(eliminated: &Eliminated, roots: DMatrix<f64>, rows: usize, without: f64) -> Reduced {
        let (matrix, told) = eliminated.of_roots(&roots);
        let eigen = matrix.symmetric_eigen();
        let told = eigen.eigenvectors.tr_mul(&told);
        let values = eigen.eigenvalues.map(|value| value.max(0.0));
        let all = eliminated.outer[(eliminated.sought(), eliminated.sought())];
        Reduced { roots, values, vectors: eigen.eigenvectors, told, all, without, rows: rows as f64 }
    }

    /// Of each direction, how far it goes for what the data say of it.
    fn pliancy(&self, weight: f64) -> DVector<f64> {
        self.values.map(|value| weight / (1.0 + weight * value))
    }

    /// The sum of squares and penalties over noise that is left.
    fn misfit(&self, weight: f64) -> f64 {
        let taken: f64 =
            self.told.iter().zip(&self.pliancy(weight)).map(|(told, goes)| told * told * goes).sum();
        (self.all - taken).max(f64::MIN_POSITIVE)
    }

    fn left(&self, weight: f64) -> f64 {
        let goes = self.pliancy(weight);
        let terms = self.told.iter().zip(&self.values).zip(&goes);
        let taken: f64 = terms.map(|((told, value), goes)| told * told * goes * (2.0 - value * goes)).sum();
        (self.all - taken).max(f64::MIN_POSITIVE)
    }

    fn evidence(&self, weight: f64) -> f64 {
        let spread: f64 = self.values.iter().map(|value| libm::log1p(weight * value)).sum();
        -0.5 * (self.rows * libm::log(self.misfit(weight) / self.without) + spread)
    }

    /// The weight of the largest evidence.
    fn best(&self) -> f64 {
        let first = FIRST_WEIGHT / self.values.max().max(f64::MIN_POSITIVE);
        let weights = (0..WEIGHTS).map(|place| first * NEXT_WEIGHT.powi(place));
        let better = |a: &f64, b: &f64| self.evidence(*a).total_cmp(&self.evidence(*b));
        weights.max_by(better).unwrap_or(first)
    }

    /// The numbers and their covariance.
    fn found(&self, weight: f64) -> (DVector<f64>, DMatrix<f64>) {
        let goes = self.pliancy(weight);
        let directions = &self.roots * &self.vectors;
        let found = &directions * goes.component_mul(&self.told);
        let noise = self.misfit(weight) / self.rows;
        let mut scaled = directions.clone();
        for (mut column, goes) in scaled.column_iter_mut().zip(&goes) {
            column *= goes * noise;
        }
        (found, scaled * directions.transpose())
    }
}
