//! The reach of a parameter: its unit and natural size at a site, as a product of powers of the largest values there.
//!
//! A document gives a reach as a formula such as `sum / own^2`. The names stand for quantities of the site. With the
//! largest value of each, the formula gives a value and a unit. Ranges and start values are multiples of it.

use patchcord_expr::{Expression, Formula, Node, Operator, Unit};

/// A quantity that a reach may name, with its unit and its extent in the data.
#[derive(Debug, Clone)]
pub struct QuantitySize {
    /// The name in formulas: one of [`REACH_NAMES`].
    pub name: &'static str,
    /// The unit of `value` and `extent`.
    pub unit: Unit,
    /// The largest magnitude.
    pub value: f64,
    /// The least and the largest value.
    pub extent: Extent,
}

/// The interval of values that a quantity takes.
///
/// # Examples
///
/// ```
/// use patchcord_ident::effects::reach::Extent;
///
/// let extent = Extent::with_simulated([0.0, 10.0], [2.0, 20.0]);
/// assert_eq!((extent.range, extent.visited), ([0.0, 10.0], [2.0, 10.0]));
/// assert_eq!(extent.times(1000.0).visited, [2000.0, 10_000.0]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// The least and the largest value in the data.
    pub range: [f64; 2],
    /// The part of `range` that the model visits. An effect that acts only outside of it changes nothing.
    pub visited: [f64; 2],
}

impl Extent {
    /// An interval that the model visits completely.
    pub fn of(range: [f64; 2]) -> Extent {
        Extent { range, visited: range }
    }

    /// A measured interval, and its overlap with the interval that the model visits. If they do not overlap, the whole
    /// measured interval counts as visited.
    pub fn with_simulated(range: [f64; 2], simulated: [f64; 2]) -> Extent {
        let visited = [range[0].max(simulated[0]), range[1].min(simulated[1])];
        if visited[0] < visited[1] { Extent { range, visited } } else { Extent::of(range) }
    }

    /// The interval in another unit, of which one old unit is `factor`.
    pub fn times(self, factor: f64) -> Extent {
        Extent { range: self.range.map(|end| factor * end), visited: self.visited.map(|end| factor * end) }
    }
}

impl QuantitySize {
    /// A quantity with this extent; its value is the larger magnitude of the two ends.
    pub fn of(name: &'static str, unit: Unit, extent: Extent) -> QuantitySize {
        let value = extent.range[0].abs().max(extent.range[1].abs());
        QuantitySize { name, unit, value, extent }
    }
}

/// Evaluates a reach to a value and its unit. `None` if the formula is not a product of powers of numbers and `sizes`.
///
/// Example: `sum / own` with a largest force of 20 N and a largest velocity of 4 m/s gives 5 N s/m.
///
/// # Examples
///
/// ```
/// use patchcord_expr::{Formula, Unit};
/// use patchcord_ident::effects::reach::{Extent, QuantitySize, evaluate_reach};
///
/// let sizes = [
///     QuantitySize::of("sum", Unit::parse("N")?, Extent::of([-20.0, 10.0])),
///     QuantitySize::of("own", Unit::parse("m/s")?, Extent::of([0.0, 4.0])),
/// ];
/// let (value, unit) = evaluate_reach(&Formula::parse("sum / own")?, &sizes).ok_or("a product of powers")?;
/// assert!((value - 5.0).abs() < 1e-12);
/// assert!(unit.dimension() == Unit::parse("N s/m")?.dimension());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn evaluate_reach(formula: &Formula, sizes: &[QuantitySize]) -> Option<(f64, Unit)> {
    let mut powers = Vec::new();
    let value = product(formula.root(), 1.0, sizes, &mut powers)?;
    let factors = powers.iter().map(|(index, power): &(usize, f64)| (&sizes[*index].unit, *power));
    Some((value, Unit::of_product(factors)))
}

/// The names that a reach may contain; docs/effect-format.md lists their meanings.
pub const REACH_NAMES: [&str; 9] =
    ["signal", "own", "sum", "position", "load", "force", "next", "sample", "record"];

/// The value of a reach if every name is 10. The reader checks the powers of a formula with it. `None` if the formula
/// is not a product of powers.
pub fn reach_at_ten(formula: &Formula) -> Option<f64> {
    let unit = Unit::parse("1");
    let ten = |name| Some(QuantitySize::of(name, unit.clone().ok()?, Extent::of([0.0, 10.0])));
    evaluate_reach(formula, &REACH_NAMES.into_iter().filter_map(ten).collect::<Vec<_>>())
        .map(|(value, _)| value)
}

/// The value of a sub-formula raised to a power. Appends each quantity in it to `powers`, as an index of `sizes` and an
/// exponent.
fn product(node: &Node, power: f64, sizes: &[QuantitySize], powers: &mut Vec<(usize, f64)>) -> Option<f64> {
    match &node.expression {
        Expression::Number(value) => Some(libm::pow(*value, power)),
        Expression::Name(name) => {
            let index = sizes.iter().position(|size| size.name == name)?;
            powers.push((index, power));
            Some(libm::pow(sizes[index].value, power))
        }
        Expression::Binary(Operator::Multiply, left, right) => {
            Some(product(left, power, sizes, powers)? * product(right, power, sizes, powers)?)
        }
        Expression::Binary(Operator::Divide, left, right) => {
            Some(product(left, power, sizes, powers)? * product(right, -power, sizes, powers)?)
        }
        Expression::Binary(Operator::Power, base, exponent) => match &exponent.expression {
            Expression::Number(exponent) => product(base, power * exponent, sizes, powers),
            _ => None,
        },
        _ => None,
    }
}
