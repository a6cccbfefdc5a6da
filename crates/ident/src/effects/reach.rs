//! What the parameters of an effect are measured in: products of powers of what is largest where it attaches.

use patchcord_expr::{Expression, Formula, Node, Operator, Unit};

/// A quantity that a reach names, and its largest value in its unit.
#[derive(Debug, Clone)]
pub struct Largest {
    /// Its name in formulas.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// Its largest value, without sign.
    pub value: f64,
    /// How far it goes.
    pub extent: Extent,
}

/// From where to where something goes.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// Its least and its largest value.
    pub ends: [f64; 2],
    /// The part between them that the patch goes through: what acts beyond is not felt.
    pub met: [f64; 2],
}

impl Extent {
    /// All of which is met.
    pub fn of(ends: [f64; 2]) -> Extent {
        Extent { ends, met: ends }
    }

    /// What was measured, and the part of it that the patch goes through; all of it where they do not meet.
    pub fn measured(ends: [f64; 2], through: [f64; 2]) -> Extent {
        let met = [ends[0].max(through[0]), ends[1].min(through[1])];
        if met[0] < met[1] { Extent { ends, met } } else { Extent::of(ends) }
    }

    /// In another unit.
    pub fn times(self, factor: f64) -> Extent {
        Extent { ends: self.ends.map(|end| factor * end), met: self.met.map(|end| factor * end) }
    }
}

impl Largest {
    /// A quantity that goes so far.
    pub fn of(name: &'static str, unit: Unit, extent: Extent) -> Largest {
        let value = extent.ends[0].abs().max(extent.ends[1].abs());
        Largest { name, unit, value, extent }
    }
}

/// A reach, as a value with its unit; `None` where the formula is no product of powers of what is known.
pub fn reach(formula: &Formula, largest: &[Largest]) -> Option<(f64, Unit)> {
    let mut powers = Vec::new();
    let value = product(formula.root(), 1.0, largest, &mut powers)?;
    let parts = powers.iter().map(|(index, power): &(usize, f64)| (&largest[*index].unit, *power));
    Some((value, Unit::of_product(parts)))
}

/// The names that a reach may have.
pub const NAMES: [&str; 9] =
    ["signal", "own", "sum", "position", "load", "force", "next", "sample", "record"];

/// What a formula of these names comes to where each of them is ten; nothing where it is no product of powers.
pub fn of_tens(formula: &Formula) -> Option<f64> {
    let unit = Unit::parse("1");
    let ten = |name| Some(Largest::of(name, unit.clone().ok()?, Extent::of([0.0, 10.0])));
    reach(formula, &NAMES.into_iter().filter_map(ten).collect::<Vec<_>>()).map(|(value, _)| value)
}

/// The value of a part raised to a power; what it names is noted with the powers.
fn product(node: &Node, power: f64, largest: &[Largest], powers: &mut Vec<(usize, f64)>) -> Option<f64> {
    match &node.expression {
        Expression::Number(value) => Some(libm::pow(*value, power)),
        Expression::Name(name) => {
            let index = largest.iter().position(|own| own.name == name)?;
            powers.push((index, power));
            Some(libm::pow(largest[index].value, power))
        }
        Expression::Binary(Operator::Multiply, left, right) => {
            Some(product(left, power, largest, powers)? * product(right, power, largest, powers)?)
        }
        Expression::Binary(Operator::Divide, left, right) => {
            Some(product(left, power, largest, powers)? * product(right, -power, largest, powers)?)
        }
        Expression::Binary(Operator::Power, base, exponent) => match &exponent.expression {
            Expression::Number(exponent) => product(base, power * exponent, largest, powers),
            _ => None,
        },
        _ => None,
    }
}
