//! Functions with their arguments.
//!
//! Equal ones are shared within a thread. So an expression that occurs at several places exists once, its comparison
//! with itself takes no time, and a walk through an expression can visit it once.

use std::cell::RefCell;
use std::cmp::Ordering;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Arc, Weak};

use super::fraction::Fraction;
use super::monomial::Operation;

/// A function with its arguments.
#[derive(Debug)]
pub(crate) struct Application {
    /// The function.
    pub operation: Operation,
    /// Its arguments, each in normal form.
    pub arguments: Vec<Fraction>,
    /// A hash of the function and its arguments.
    hash: u64,
    /// Properties that follow from the arguments.
    pub(super) properties: Properties,
}

/// Properties of a function that follow from its arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Properties {
    /// Whether the value is constant in a run.
    pub is_constant: bool,
    /// Whether it is a step, or a step is inside.
    pub has_step: bool,
    /// The number of functions inside each other, with this one.
    pub depth: usize,
    /// The number of absolute values inside each other, with this function if it is one.
    pub absolute_depth: usize,
}

impl Properties {
    /// The properties of a function of these arguments.
    fn new(operation: Operation, arguments: &[Fraction]) -> Self {
        let largest = |depth: fn(&Fraction) -> usize| arguments.iter().map(depth).max().unwrap_or_default();
        let own_absolute = usize::from(operation == Operation::Absolute);
        Properties {
            is_constant: arguments.iter().all(Fraction::is_constant),
            has_step: operation == Operation::Step || arguments.iter().any(Fraction::has_step),
            depth: 1 + largest(Fraction::depth),
            absolute_depth: own_absolute + largest(Fraction::absolute_depth),
        }
    }
}

impl Application {
    /// A function of these arguments. It is shared with all equal ones of the thread.
    pub(super) fn shared(operation: Operation, arguments: Vec<Fraction>) -> Arc<Self> {
        let mut hasher = DefaultHasher::new();
        operation.hash(&mut hasher);
        arguments.hash(&mut hasher);
        let (hash, properties) = (hasher.finish(), Properties::new(operation, &arguments));
        let application = Application { operation, arguments, hash, properties };
        SHARED.with_borrow_mut(|shared| shared.unique(application))
    }
}

impl PartialEq for Application {
    fn eq(&self, other: &Self) -> bool {
        self.hash == other.hash && self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Application {}

impl Hash for Application {
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u64(self.hash);
    }
}

impl Ord for Application {
    fn cmp(&self, other: &Self) -> Ordering {
        if std::ptr::eq(self, other) {
            return Ordering::Equal;
        }
        self.operation.cmp(&other.operation).then_with(|| self.arguments.cmp(&other.arguments))
    }
}

impl PartialOrd for Application {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

thread_local! {
    /// The functions of the thread.
    static SHARED: RefCell<Shared> = RefCell::default();
}

/// Functions that are in use.
#[derive(Default)]
struct Shared {
    /// The functions by their hash, also some that are no longer in use.
    by_hash: HashMap<u64, Vec<Weak<Application>>>,
    /// The number of hashes at which those that are no longer in use are removed.
    limit: usize,
}

/// The least number of hashes at which unused functions are removed.
const MIN_LIMIT: usize = 1024;

impl Shared {
    /// The function that is equal to this one. If there is none, it is this one.
    fn unique(&mut self, application: Application) -> Arc<Application> {
        if self.by_hash.len() >= self.limit {
            self.remove_unused();
        }
        let equal = self.by_hash.entry(application.hash).or_default();
        let known = equal.iter().filter_map(Weak::upgrade).find(|known| **known == application);
        known.unwrap_or_else(|| {
            let new = Arc::new(application);
            equal.push(Arc::downgrade(&new));
            new
        })
    }

    /// Removes the functions that are no longer in use.
    fn remove_unused(&mut self) {
        self.by_hash.retain(|_, equal| {
            equal.retain(|function| function.strong_count() > 0);
            !equal.is_empty()
        });
        self.limit = MIN_LIMIT.max(2 * self.by_hash.len());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::symbolic::Atom;
    use crate::testing::reading::read;

    /// The function of an expression that is one.
    fn function(text: &str) -> Arc<Application> {
        let expression = read(text);
        let (product, _) = expression.numerator().as_term().unwrap();
        match product.factors() {
            [(Atom::Apply(applied), 1)] => Arc::clone(applied),
            factors => panic!("{factors:?}"),
        }
    }

    #[test]
    fn equal_functions_are_shared() {
        let [first, second] = ["sin(x + abs(y))", "sin(abs(-y) + x)"].map(function);
        assert!(Arc::ptr_eq(&first, &second));
        assert!(!Arc::ptr_eq(&first, &function("sin(x + abs(z))")));
        assert_ne!(first, function("cos(x + abs(y))"));
    }

    #[test]
    fn functions_of_other_threads_are_equal_too() {
        let own = function("sin(x + cos(y))");
        let other = std::thread::spawn(|| function("sin(x + cos(y))")).join().unwrap();
        assert_eq!(own, other);
        assert_eq!(own.cmp(&other), Ordering::Equal);
    }

    #[test]
    fn functions_that_are_not_in_use_are_removed() {
        let mut shared = Shared::default();
        let argument = |number: i64| vec![Fraction::whole(number)];
        let application = |number: i64| {
            let properties = Properties::new(Operation::Step, &argument(number));
            let hash = u64::try_from(number).unwrap();
            Application { operation: Operation::Step, arguments: argument(number), hash, properties }
        };
        let kept = shared.unique(application(0));
        (1..5000).for_each(|number| drop(shared.unique(application(number))));
        assert!(shared.by_hash.len() <= MIN_LIMIT, "{}", shared.by_hash.len());
        assert!(Arc::ptr_eq(&kept, &shared.unique(application(0))));
    }

    #[test]
    fn properties_follow_from_the_arguments() {
        let of = |text: &str| function(text).properties;
        let properties = |is_constant, has_step, depth, absolute_depth| Properties {
            is_constant,
            has_step,
            depth,
            absolute_depth,
        };
        assert_eq!(of("sin(p)"), properties(true, false, 1, 0));
        assert_eq!(of("sin(x + abs(y + abs(x)))"), properties(false, false, 3, 2));
        assert_eq!(of("cos(p + step(x - exp(y)))"), properties(false, true, 3, 0));
    }
}
