//! Finds the physical gain of a path as an expression of the parameters.

use super::Circuit;
use patchcord_expr::{Dimension, Scope as _};

/// A physical gain as an expression of parameters.
pub(super) struct Block {
    /// The expression, such as "1 / M".
    pub name: String,
    /// The value in SI units.
    pub value: f64,
    dimension: Dimension,
}

/// Difference of the logarithms of two gains up to which they agree. It is far above rounding errors and far below the
/// accuracy of any scale.
const GAIN_AGREEMENT: f64 = 1e-6;

impl Block {
    /// The expression with this dimension that agrees with the gain: 1, a parameter, the reciprocal of a parameter, or
    /// a quotient or product of two. The sign of the gain does not count.
    ///
    /// If none agrees, the gain is wrong or is none of these expressions. Then the expression of the first three kinds
    /// that differs by a power of ten, as with a wrong input, or the only one with this dimension. `None` if it is not
    /// clear which of several is meant: the right unit alone is no reason.
    pub(super) fn find(circuit: &Circuit, dimension: Dimension, gain: f64) -> Option<Block> {
        let singles = Block::singles(circuit);
        let fits = |block: &Block| block.dimension == dimension && block.value > 0.0;
        let agrees = |block: &Block| (gain.abs() / block.value).ln().abs() < GAIN_AGREEMENT;
        let pair = Block::pairs(&singles).into_iter().filter(fits).find(agrees);
        let unity = Block { name: "1".to_owned(), value: 1.0, dimension: Dimension::NONE };
        let mut fitting: Vec<Block> = [unity].into_iter().chain(singles).filter(fits).collect();
        if let Some(index) = fitting.iter().position(agrees) {
            return Some(fitting.swap_remove(index));
        }
        pair.or_else(|| Block::probable(fitting, gain))
    }

    /// The only expression that differs from the gain by a power of ten, or else the only expression.
    fn probable(mut fitting: Vec<Block>, gain: f64) -> Option<Block> {
        let is_decades_off = |block: &Block| {
            let decades = (gain.abs() / block.value).log10();
            (decades - decades.round()).abs() < GAIN_AGREEMENT
        };
        let decades_off: Vec<usize> =
            (0..fitting.len()).filter(|index| is_decades_off(&fitting[*index])).collect();
        match (decades_off.as_slice(), fitting.len()) {
            ([only], _) => Some(fitting.swap_remove(*only)),
            (_, 1) => fitting.pop(),
            _ => None,
        }
    }

    /// Every parameter and its reciprocal.
    fn singles(circuit: &Circuit) -> Vec<Block> {
        let quantities = circuit.quantities();
        let mut singles = Vec::new();
        for (name, ..) in circuit.parameters() {
            let (Some(value), Some(dimension)) = (quantities.value(name), quantities.dimension(name)) else {
                continue;
            };
            singles.push(Block { name: name.to_owned(), value, dimension });
            let dimension = Dimension::NONE.over(dimension);
            singles.push(Block { name: format!("1 / {name}"), value: 1.0 / value, dimension });
        }
        singles
    }

    /// The quotients and products of two different parameters.
    fn pairs(singles: &[Block]) -> Vec<Block> {
        let parameters: Vec<_> = singles.iter().filter(|block| !block.name.starts_with("1 /")).collect();
        let mut pairs = Vec::new();
        for first in &parameters {
            for second in parameters.iter().filter(|second| second.name != first.name) {
                pairs.push(Block {
                    name: format!("{} / {}", first.name, second.name),
                    value: first.value / second.value,
                    dimension: first.dimension.over(second.dimension),
                });
                pairs.push(Block {
                    name: format!("{} * {}", first.name, second.name),
                    value: first.value * second.value,
                    dimension: first.dimension.times(second.dimension),
                });
            }
        }
        pairs
    }
}
