//! Products of powers.

use std::cmp::Ordering;
use std::sync::Arc;

use patchcord_expr::Function;

use super::application::Application;
use super::fraction::Fraction;
use super::polynomial::Polynomial;
use super::symbol::Symbol;

/// A factor of a product: a symbol, or a function of other expressions.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Atom {
    /// A named quantity.
    Symbol(Symbol),
    /// A function with its arguments.
    Apply(Arc<Application>),
}

/// A function that is not written as sums, products and quotients.
///
/// In the normal form, absolute values and steps express minimum, maximum and choices by condition. So equal
/// characteristics have equal normal forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Operation {
    /// The absolute value.
    Absolute,
    /// 1 if the argument is 0 or above, 0 if it is below.
    Step,
    /// A mathematical function.
    Call(CallOrder),
    /// A table of points: straight lines between them, constant outside.
    Table(u32),
    /// The slope of a table.
    TableSlope(u32),
    /// The first argument, as it was some time ago. The second argument is that time.
    Delay,
    /// The smaller argument, in the written form only.
    Minimum,
    /// The larger argument, in the written form only.
    Maximum,
    /// The first argument, but at least the second and at most the third one, in the written form only.
    Limit,
    /// 1 if the argument is above 0, -1 if it is below 0, otherwise 0, in the written form only.
    Sign,
    /// The argument itself: a long sum that is not multiplied out.
    Group,
}

/// A mathematical function with an order, which sorts products.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct CallOrder(pub Function);

impl Ord for CallOrder {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.0 as usize).cmp(&(other.0 as usize))
    }
}

impl PartialOrd for CallOrder {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Atom {
    /// A function of expressions as a factor.
    pub(crate) fn function(operation: Operation, arguments: Vec<Fraction>) -> Self {
        Atom::Apply(Application::shared(operation, arguments))
    }

    /// Whether the factor is constant in a run.
    pub(crate) fn is_constant(&self) -> bool {
        match self {
            Atom::Symbol(symbol) => symbol.is_constant,
            Atom::Apply(applied) => applied.properties.is_constant,
        }
    }

    /// The function with its arguments, if the factor is one.
    pub(super) fn as_function(&self) -> Option<&Application> {
        match self {
            Atom::Symbol(_) => None,
            Atom::Apply(applied) => Some(applied),
        }
    }

    /// Whether the factor is never negative.
    pub(crate) fn is_nonnegative(&self) -> bool {
        match self {
            Atom::Symbol(symbol) => symbol.is_nonnegative,
            Atom::Apply(applied) => match applied.operation {
                Operation::Absolute | Operation::Step => true,
                Operation::Group => applied.arguments.iter().all(Fraction::is_nonnegative),
                Operation::Call(CallOrder(function)) => {
                    matches!(function, Function::Sqrt | Function::Exp | Function::Exp10)
                }
                _ => false,
            },
        }
    }

    /// Whether the factor is always above 0.
    fn is_positive(&self) -> bool {
        match self {
            Atom::Symbol(symbol) => symbol.is_positive,
            Atom::Apply(applied) => match applied.operation {
                Operation::Call(CallOrder(Function::Exp | Function::Exp10)) => true,
                Operation::Call(CallOrder(Function::Sqrt)) | Operation::Group => {
                    applied.arguments.iter().all(Fraction::is_positive)
                }
                _ => false,
            },
        }
    }

    /// Whether a power of the factor is above 0 wherever it has a value. A divisor is not 0.
    pub(crate) fn has_positive_power(&self, exponent: i32) -> bool {
        self.is_positive() || (exponent < 0 && (exponent % 2 == 0 || self.is_nonnegative()))
    }
}

/// A product of powers with whole exponents, which may be negative. The empty product is 1.
///
/// The order is lexicographic: the first factor with different exponents decides. It is kept by multiplication, which
/// the division of polynomials needs.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub(crate) struct Monomial {
    /// The factors in ascending order, with exponents other than 0.
    factors: Vec<(Atom, i32)>,
}

impl Monomial {
    /// A power of one factor.
    pub(crate) fn power_of(atom: Atom, exponent: i32) -> Self {
        Monomial { factors: if exponent == 0 { Vec::new() } else { vec![(atom, exponent)] } }
    }

    /// The factors with their exponents, in ascending order.
    pub(crate) fn factors(&self) -> &[(Atom, i32)] {
        &self.factors
    }

    /// Whether the product is empty.
    pub(crate) fn is_one(&self) -> bool {
        self.factors.is_empty()
    }

    /// The exponent of a factor; 0 if it is absent.
    pub(crate) fn exponent(&self, atom: &Atom) -> i32 {
        self.factors.iter().find(|(factor, _)| factor == atom).map_or(0, |(_, exponent)| *exponent)
    }

    /// The product of the factors for which a condition holds.
    pub(crate) fn only(&self, mut is_wanted: impl FnMut(&Atom, i32) -> bool) -> Monomial {
        let factors = self.factors.iter().filter(|(atom, exponent)| is_wanted(atom, *exponent));
        Monomial { factors: factors.cloned().collect() }
    }

    /// Whether the product is constant in a run.
    pub(crate) fn is_constant(&self) -> bool {
        self.factors.iter().all(|(atom, _)| atom.is_constant())
    }

    /// Whether the product is never negative.
    pub(crate) fn is_nonnegative(&self) -> bool {
        self.factors.iter().all(|(atom, exponent)| exponent % 2 == 0 || atom.is_nonnegative())
    }

    /// Whether the product is above 0 wherever it has a value.
    pub(crate) fn is_positive(&self) -> bool {
        self.factors.iter().all(|(atom, exponent)| atom.has_positive_power(*exponent))
    }

    /// The product as rest x |inside|, if it has an absolute value of a sum as a factor.
    pub(crate) fn absolute_factor(&self) -> Option<(Monomial, &Polynomial)> {
        self.factors.iter().find_map(|(atom, exponent)| match atom {
            Atom::Apply(applied) if applied.operation == Operation::Absolute && *exponent == 1 => {
                let inside = applied.arguments.first().filter(|inside| inside.divisors().len() == 0)?;
                Some((self.over(&Monomial::power_of(atom.clone(), 1)), inside.numerator()))
            }
            _ => None,
        })
    }

    /// The product of two products.
    pub(crate) fn times(&self, other: &Monomial) -> Monomial {
        self.merged(other, |own, other| own + other)
    }

    /// The quotient of two products.
    pub(crate) fn over(&self, other: &Monomial) -> Monomial {
        self.merged(other, |own, other| own - other)
    }

    /// The factors that two products have in common: each with the smaller exponent.
    pub(crate) fn common(&self, other: &Monomial) -> Monomial {
        self.merged(other, i32::min)
    }

    /// A power of the product.
    pub(crate) fn power(&self, exponent: i32) -> Monomial {
        let powers = self.factors.iter().map(|(atom, own)| (atom.clone(), own * exponent));
        Monomial { factors: powers.filter(|(_, exponent)| *exponent != 0).collect() }
    }

    /// A product whose exponents are functions of those of two products.
    fn merged(&self, other: &Monomial, exponent: impl Fn(i32, i32) -> i32) -> Monomial {
        let (mut own, mut others) = (self.factors.iter().peekable(), other.factors.iter().peekable());
        let mut factors = Vec::with_capacity(self.factors.len() + other.factors.len());
        loop {
            let order = match (own.peek(), others.peek()) {
                (None, None) => return Monomial { factors },
                (Some(_), None) => Ordering::Less,
                (None, Some(_)) => Ordering::Greater,
                (Some((own, _)), Some((other, _))) => own.cmp(other),
            };
            let left = if order == Ordering::Greater { None } else { own.next() };
            let right = if order == Ordering::Less { None } else { others.next() };
            let value = |factor: Option<&(Atom, i32)>| factor.map_or(0, |(_, exponent)| *exponent);
            let exponent = exponent(value(left), value(right));
            if let Some((atom, _)) = left.or(right).filter(|_| exponent != 0) {
                factors.push((atom.clone(), exponent));
            }
        }
    }
}

impl Ord for Monomial {
    fn cmp(&self, other: &Self) -> Ordering {
        let (mut own, mut others) = (self.factors.iter(), other.factors.iter());
        loop {
            match (own.next(), others.next()) {
                (None, None) => return Ordering::Equal,
                (Some((_, exponent)), None) => return exponent.cmp(&0),
                (None, Some((_, exponent))) => return 0.cmp(exponent),
                (Some((left, exponent)), Some((right, other))) => match left.cmp(right) {
                    Ordering::Less => return exponent.cmp(&0),
                    Ordering::Greater => return 0.cmp(other),
                    Ordering::Equal if exponent != other => return exponent.cmp(other),
                    Ordering::Equal => {}
                },
            }
        }
    }
}

impl PartialOrd for Monomial {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
