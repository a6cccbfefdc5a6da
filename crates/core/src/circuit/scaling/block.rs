//! Finds the physical gain of a path as an expression of the parameters.

use super::Circuit;
use patchcord_expr::{Dimension, Scope as _};

/// A physical gain as an expression of parameters.
struct Block {
    /// The expression, such as "1 / M".
    name: String,
    /// The value in SI units.
    value: f64,
    dimension: Dimension,
}

/// The expressions that a circuit offers for a physical gain.
pub(super) struct Blocks {
    /// 1, and then every parameter followed by its reciprocal.
    singles: Vec<Block>,
    /// The pairs with a positive value, in the order of their values.
    pairs: Vec<Pair>,
}

/// The quotient or the product of two different parameters.
struct Pair {
    /// Indices of the two parameters in `singles`.
    factors: [usize; 2],
    /// Whether it is the product.
    is_product: bool,
    /// The value in SI units.
    value: f64,
    dimension: Dimension,
    /// Position in the order of preference.
    rank: usize,
}

/// Difference of the logarithms of two gains up to which they agree. It is far above rounding errors and far below the
/// accuracy of any scale.
const GAIN_AGREEMENT: f64 = 1e-6;

/// Number of parameters up to which pairs are considered. With more parameters, some pair is likely to agree with any
/// gain by coincidence.
const MAX_PAIRED_PARAMETERS: usize = 100;

impl Blocks {
    /// The expressions in the parameters of a circuit.
    pub(super) fn new(circuit: &Circuit) -> Blocks {
        let quantities = circuit.quantities();
        let mut singles = vec![Block { name: "1".to_owned(), value: 1.0, dimension: Dimension::NONE }];
        for (name, ..) in circuit.parameters() {
            let (Some(value), Some(dimension)) = (quantities.value(name), quantities.dimension(name)) else {
                continue;
            };
            singles.push(Block { name: name.to_owned(), value, dimension });
            let dimension = Dimension::NONE.over(dimension);
            singles.push(Block { name: format!("1 / {name}"), value: 1.0 / value, dimension });
        }
        let pairs = pairs(&singles);
        Blocks { singles, pairs }
    }

    /// The expression with this dimension that agrees with the gain: 1, a parameter, the reciprocal of a parameter, or
    /// a quotient or product of two. The sign of the gain does not count. `None` if none agrees: the right unit alone is
    /// no reason.
    pub(super) fn find(&self, dimension: Dimension, gain: f64) -> Option<String> {
        let agrees = |block: &&Block| {
            block.dimension == dimension
                && is_usable(block.value)
                && logarithmic_distance(gain, block.value) < GAIN_AGREEMENT
        };
        match self.singles.iter().find(agrees) {
            Some(block) => Some(block.name.clone()),
            None => self.pair(dimension, gain),
        }
    }

    /// The first pair in the order of preference that has this dimension and agrees with the gain.
    fn pair(&self, dimension: Dimension, gain: f64) -> Option<String> {
        // The window is wider than the agreement, so that rounding excludes no pair.
        let margin = 2.0 * GAIN_AGREEMENT;
        let [low, high] = [1.0 - margin, 1.0 + margin].map(|end| gain.abs() * end);
        let begin = self.pairs.partition_point(|pair| pair.value < low);
        let near = self.pairs[begin..].iter().take_while(|pair| pair.value <= high);
        let agrees = |pair: &&Pair| {
            pair.dimension == dimension && logarithmic_distance(gain, pair.value) < GAIN_AGREEMENT
        };
        near.filter(agrees).min_by_key(|pair| pair.rank).map(|pair| self.name_of(pair))
    }

    /// The name of a pair, such as "k / m".
    fn name_of(&self, pair: &Pair) -> String {
        let [first, second] = pair.factors.map(|index| &self.singles[index].name);
        let sign = if pair.is_product { "*" } else { "/" };
        format!("{first} {sign} {second}")
    }
}

/// Whether the value of an expression can be that of a gain. The reciprocal of a parameter of 0 cannot.
fn is_usable(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}

/// The absolute difference of the logarithms of a gain and a positive value. The sign of the gain does not count.
fn logarithmic_distance(gain: f64, value: f64) -> f64 {
    (gain.abs() / value).ln().abs()
}

/// The quotients and products of two different parameters with a positive value, in the order of their values. Empty if
/// there are more than [`MAX_PAIRED_PARAMETERS`] parameters.
fn pairs(singles: &[Block]) -> Vec<Pair> {
    let parameters: Vec<usize> = (1..singles.len()).step_by(2).collect();
    let mut pairs = Vec::new();
    if parameters.len() > MAX_PAIRED_PARAMETERS {
        return pairs;
    }
    let with_each = |first: usize| parameters.iter().map(move |second| [first, *second]);
    for factors in parameters.iter().copied().flat_map(with_each) {
        let [first, second] = factors.map(|index| &singles[index]);
        let quotient = (first.value / second.value, first.dimension.over(second.dimension));
        let product = (first.value * second.value, first.dimension.times(second.dimension));
        for (is_product, (value, dimension)) in [(false, quotient), (true, product)] {
            if factors[0] != factors[1] && is_usable(value) {
                pairs.push(Pair { factors, is_product, value, dimension, rank: pairs.len() });
            }
        }
    }
    pairs.sort_by(|one, other| one.value.total_cmp(&other.value));
    pairs
}
