//! The normal form of an expression: a sum of products over a product of sums.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::sync::Arc;

use num_traits::{One as _, Signed as _, ToPrimitive as _};
use patchcord_expr::Function;

use super::application::Application;
use super::apply::{absolute, opaque, powers_reduced, step, with_reduced_powers};
use super::monomial::{Atom, CallOrder, Monomial, Operation};
use super::number::{Rational, exact, whole};
use super::polynomial::Polynomial;
use super::replacement::Replacement;
use super::symbol::Symbol;

/// An expression in normal form.
///
/// Products are multiplied out, like terms are added, and common factors are cancelled. Divisors with one term are
/// negative powers in the numerator. So equal expressions nearly always have equal normal forms: the exceptions are
/// divisors with a common factor that is not a divisor itself, and identities between functions.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub(crate) struct Fraction {
    /// The numerator.
    numerator: Polynomial,
    /// The divisors with more than one term, each with its power. Each begins with the number 1 and has no factor in
    /// common to all terms.
    divisors: BTreeMap<Polynomial, u32>,
}

impl Fraction {
    /// The number 0.
    pub(crate) fn zero() -> Self {
        Self::default()
    }

    /// An exact number.
    pub(crate) fn rational(number: Rational) -> Self {
        Self::from(Polynomial::constant(number))
    }

    /// The number that a decimal means. A number that is not finite is 1/0.
    pub(crate) fn number(value: f64) -> Self {
        if value.is_finite() { Self::rational(exact(value)) } else { Self::zero().reciprocal() }
    }

    /// A whole number.
    pub(crate) fn whole(number: i64) -> Self {
        Self::rational(whole(number))
    }

    /// A symbol.
    pub(crate) fn symbol(symbol: Symbol) -> Self {
        Self::atom(Atom::Symbol(symbol))
    }

    /// A factor.
    pub(crate) fn atom(atom: Atom) -> Self {
        Self::from(Polynomial::term(Rational::one(), Monomial::power_of(atom, 1)))
    }

    /// The numerator.
    pub(crate) fn numerator(&self) -> &Polynomial {
        &self.numerator
    }

    /// The divisors with their powers.
    pub(crate) fn divisors(&self) -> impl ExactSizeIterator<Item = (&Polynomial, u32)> {
        self.divisors.iter().map(|(divisor, power)| (divisor, *power))
    }

    /// Whether it is the number 0.
    pub(crate) fn is_zero(&self) -> bool {
        self.numerator.is_zero()
    }

    /// The number, if it is one.
    pub(crate) fn as_rational(&self) -> Option<Rational> {
        if self.divisors.is_empty() { self.numerator.as_constant() } else { None }
    }

    /// The whole number, if it is a small one.
    fn as_whole(&self) -> Option<i32> {
        self.as_rational().filter(Rational::is_integer)?.to_integer().to_i32()
    }

    /// Whether it is constant in a run.
    pub(crate) fn is_constant(&self) -> bool {
        self.atoms().all(Atom::is_constant)
    }

    /// Whether it cannot be negative.
    pub(crate) fn is_nonnegative(&self) -> bool {
        self.numerator.is_nonnegative() && self.divisors.keys().all(Polynomial::is_nonnegative)
    }

    /// Whether it is above 0 wherever it has a value.
    pub(crate) fn is_positive(&self) -> bool {
        self.numerator.is_positive() && self.divisors.keys().all(Polynomial::is_nonnegative)
    }

    /// The sum.
    pub(crate) fn plus(&self, other: &Fraction) -> Fraction {
        if self.divisors == other.divisors {
            let numerator = self.numerator.plus(&other.numerator);
            return Fraction { numerator, divisors: self.divisors.clone() }.cancelled();
        }
        let divisors = common_divisors(self, other);
        let numerator = self.numerator_over(&divisors).plus(&other.numerator_over(&divisors));
        Fraction { numerator, divisors }.reduced()
    }

    /// All divisors of two expressions with their powers, and the numerators of both over their product.
    pub(crate) fn over_common_divisors(both: [&Fraction; 2]) -> (BTreeMap<Polynomial, u32>, [Polynomial; 2]) {
        let divisors = common_divisors(both[0], both[1]);
        let numerators = both.map(|fraction| with_reduced_powers(fraction.numerator_over(&divisors)));
        (divisors, numerators)
    }

    /// The difference.
    pub(crate) fn minus(&self, other: &Fraction) -> Fraction {
        self.plus(&other.negated())
    }

    /// The negative.
    pub(crate) fn negated(&self) -> Fraction {
        Fraction { numerator: self.numerator.negated(), divisors: self.divisors.clone() }
    }

    /// The product.
    pub(crate) fn times(&self, other: &Fraction) -> Fraction {
        let mut divisors = self.divisors.clone();
        for (divisor, power) in &other.divisors {
            *divisors.entry(divisor.clone()).or_default() += power;
        }
        Fraction { numerator: self.numerator.times(&other.numerator), divisors }.reduced()
    }

    /// The quotient.
    pub(crate) fn over(&self, other: &Fraction) -> Fraction {
        self.times(&other.reciprocal())
    }

    /// A whole power.
    pub(crate) fn power(&self, exponent: i32) -> Fraction {
        let base = if exponent < 0 { self.reciprocal() } else { self.clone() };
        if let (Some((product, number)), true) = (base.numerator.as_term(), base.divisors.is_empty()) {
            let exponent = exponent.abs();
            let power = Polynomial::term(number.pow(exponent), product.power(exponent));
            return Fraction::from(power).reduced();
        }
        (0..exponent.abs()).fold(Fraction::whole(1), |power, _| power.times(&base))
    }

    /// Number of terms of a power if it is multiplied out, at most.
    fn power_size(&self, exponent: i32) -> usize {
        let terms = self.size();
        (0..exponent.unsigned_abs() as usize).fold(1, |size, step| size * (terms + step) / (step + 1))
    }

    /// 1 over the expression. For 0 it is a function without a value, which nothing cancels.
    fn reciprocal(&self) -> Fraction {
        if self.is_zero() {
            let power = Operation::Call(CallOrder(Function::Power));
            return opaque(power, vec![Fraction::zero(), Fraction::whole(-1)]);
        }
        let (number, content, rest) = self.numerator.clone().into_primitive();
        let divisor = if rest.is_one() { None } else { Some((rest, 1)) };
        let top = Polynomial::term(number.recip(), content.power(-1));
        let numerator = self
            .divisors
            .iter()
            .fold(top, |top, (divisor, power)| (0..*power).fold(top, |top, _| top.times(divisor)));
        Fraction { numerator, divisors: divisor.into_iter().collect() }.reduced()
    }

    /// The smaller of two values.
    pub(crate) fn minimum(&self, other: &Fraction) -> Fraction {
        self.plus(other).minus(&absolute(&self.minus(other))).over(&Fraction::whole(2))
    }

    /// The larger of two values.
    pub(crate) fn maximum(&self, other: &Fraction) -> Fraction {
        self.plus(other).plus(&absolute(&self.minus(other))).over(&Fraction::whole(2))
    }

    /// `then` if left >= right, otherwise `otherwise`.
    pub(crate) fn select(
        left: &Fraction,
        right: &Fraction,
        then: &Fraction,
        otherwise: &Fraction,
    ) -> Fraction {
        otherwise.plus(&then.minus(otherwise).times(&step(&left.minus(right))))
    }

    /// The power with an exponent that is an expression, if it is a whole number from -12 to 12.
    pub(crate) fn whole_power(&self, exponent: &Fraction) -> Option<Fraction> {
        let is_short =
            |exponent: &i32| exponent.abs() <= MOST_EXPANDED && self.power_size(*exponent) <= LONGEST_POWER;
        let exponent = exponent.as_whole().filter(is_short)?;
        Some(self.power(exponent))
    }

    /// The expression with each symbol replaced.
    pub(crate) fn mapped(&self, replace: &mut dyn FnMut(Symbol) -> Fraction) -> Fraction {
        self.with_factors(&mut |atom| match atom {
            Atom::Symbol(symbol) => Some(replace(*symbol)),
            Atom::Apply(_) => None,
        })
    }

    /// The expression with some symbols replaced.
    pub(crate) fn with_symbols(&self, by: &HashMap<Symbol, Fraction>) -> Fraction {
        self.mapped(&mut |symbol| by.get(&symbol).cloned().unwrap_or_else(|| Fraction::symbol(symbol)))
    }

    /// The expression with some factors replaced, also inside functions. A factor stays if `replace` gives `None`. It is
    /// asked once for each function, and has one result for equal factors.
    pub(crate) fn with_factors(&self, replace: &mut dyn FnMut(&Atom) -> Option<Fraction>) -> Fraction {
        Replacement::new(replace).rewritten(self)
    }

    /// Whether a symbol with this property occurs anywhere in it.
    pub(crate) fn contains(&self, is_wanted: &mut dyn FnMut(Symbol) -> bool) -> bool {
        self.has_factor(&mut |atom| matches!(atom, Atom::Symbol(symbol) if is_wanted(*symbol)))
    }

    /// The symbols anywhere in it.
    pub(crate) fn symbols(&self) -> BTreeSet<Symbol> {
        let mut found = BTreeSet::new();
        self.contains(&mut |symbol| {
            found.insert(symbol);
            false
        });
        found
    }

    /// The functions with this property anywhere in it. A function comes before those in its arguments.
    pub(crate) fn functions_with(&self, is_wanted: &dyn Fn(&Application) -> bool) -> Vec<Arc<Application>> {
        let mut found = Vec::new();
        self.has_factor(&mut |atom| {
            if let Atom::Apply(applied) = atom
                && is_wanted(applied)
            {
                found.push(Arc::clone(applied));
            }
            false
        });
        found
    }

    /// Whether a factor with this property occurs anywhere in it. Each function is visited once, before its arguments.
    pub(super) fn has_factor(&self, is_wanted: &mut dyn FnMut(&Atom) -> bool) -> bool {
        self.has_new_factor(is_wanted, &mut HashSet::new())
    }

    /// The same, without the functions that were visited before.
    fn has_new_factor(
        &self,
        is_wanted: &mut dyn FnMut(&Atom) -> bool,
        visited: &mut HashSet<*const Application>,
    ) -> bool {
        self.atoms().any(|atom| match atom {
            Atom::Symbol(_) => is_wanted(atom),
            Atom::Apply(applied) => {
                let is_new = visited.insert(Arc::as_ptr(applied));
                let mut arguments = applied.arguments.iter();
                is_new
                    && (is_wanted(atom)
                        || arguments.any(|argument| argument.has_new_factor(is_wanted, visited)))
            }
        })
    }

    /// The factors of the numerator and the divisors, without those inside functions.
    fn atoms(&self) -> impl Iterator<Item = &Atom> {
        [&self.numerator].into_iter().chain(self.divisors.keys()).flat_map(Polynomial::atoms)
    }

    /// The functions of the numerator and the divisors, without those inside functions.
    fn functions(&self) -> impl Iterator<Item = &Application> {
        self.atoms().filter_map(Atom::as_function)
    }

    /// The largest number of functions inside each other.
    pub(crate) fn depth(&self) -> usize {
        self.functions().map(|function| function.properties.depth).max().unwrap_or_default()
    }

    /// The largest number of absolute values inside each other.
    pub(crate) fn absolute_depth(&self) -> usize {
        self.functions().map(|function| function.properties.absolute_depth).max().unwrap_or_default()
    }

    /// Whether a step occurs anywhere in it.
    pub(crate) fn has_step(&self) -> bool {
        self.functions().any(|function| function.properties.has_step)
    }

    /// The expression as a sum of two: the terms for which a condition holds, and the others.
    pub(crate) fn split(&self, is_first: &mut dyn FnMut(&Fraction) -> bool) -> [Fraction; 2] {
        let mut parts = [Fraction::zero(), Fraction::zero()];
        for (product, number) in self.numerator.terms() {
            let numerator = Polynomial::term(number.clone(), product.clone());
            let term = Fraction { numerator, divisors: self.divisors.clone() };
            let place = usize::from(!is_first(&term));
            parts[place] = parts[place].plus(&term);
        }
        parts
    }

    /// Number of terms, also inside functions, counted up to a limit.
    pub(crate) fn nested_size(&self, limit: usize) -> usize {
        let mut size = self.size();
        for function in self.functions() {
            for argument in &function.arguments {
                if size >= limit {
                    return size;
                }
                size += argument.nested_size(limit - size);
            }
        }
        size
    }

    /// Number of terms in the numerator and the divisors, a measure of the cost of a product.
    pub(crate) fn size(&self) -> usize {
        self.numerator.terms().len()
            + self.divisors.keys().map(|divisor| divisor.terms().len()).sum::<usize>()
    }

    /// The numerator over other divisors, which contain the own ones.
    fn numerator_over(&self, divisors: &BTreeMap<Polynomial, u32>) -> Polynomial {
        divisors.iter().fold(self.numerator.clone(), |numerator, (divisor, power)| {
            let own = self.divisors.get(divisor).copied().unwrap_or_default();
            (own..*power).fold(numerator, |numerator, _| numerator.times(divisor))
        })
    }

    /// The normal form after a product: powers of functions are reduced and common factors are cancelled.
    fn reduced(self) -> Fraction {
        match powers_reduced(&self.numerator) {
            Some(numerator) => {
                let divisors =
                    Fraction { numerator: Polynomial::constant(Rational::one()), divisors: self.divisors };
                // The divisors have no powers that can be reduced, so this ends.
                numerator.times(&divisors)
            }
            None => self.cancelled(),
        }
    }

    /// The same with common factors of numerator and divisors cancelled.
    fn cancelled(mut self) -> Fraction {
        if self.numerator.is_zero() {
            return Fraction::zero();
        }
        let divisors = std::mem::take(&mut self.divisors);
        for (divisor, mut power) in divisors {
            while power > 0
                && let Some(quotient) = self.numerator.divided_by(&divisor)
            {
                self.numerator = quotient;
                power -= 1;
            }
            if power > 0 {
                self.divisors.insert(divisor, power);
            }
        }
        self
    }
}

/// Terms of a power that is multiplied out at most.
const LONGEST_POWER: usize = 200;
/// Exponents up to this size are multiplied out.
const MOST_EXPANDED: i32 = 12;

impl From<Polynomial> for Fraction {
    fn from(numerator: Polynomial) -> Self {
        Fraction { numerator, divisors: BTreeMap::new() }
    }
}

/// The divisors of two expressions, each with its larger power.
fn common_divisors(first: &Fraction, second: &Fraction) -> BTreeMap<Polynomial, u32> {
    let mut divisors = first.divisors.clone();
    for (divisor, power) in &second.divisors {
        let own = divisors.entry(divisor.clone()).or_default();
        *own = (*own).max(*power);
    }
    divisors
}

/// Whether the number in front of the greatest product is negative.
pub(super) fn leads_negative(fraction: &Fraction) -> bool {
    fraction.numerator.terms().next_back().is_some_and(|(_, number)| number.is_negative())
}
