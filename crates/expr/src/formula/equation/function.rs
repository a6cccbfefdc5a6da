//! The functions that only equations can call.

/// A function that an equation can call in addition to those of [`Callee`](crate::Callee).
///
/// # Examples
///
/// ```
/// use patchcord_expr::EquationFunction;
///
/// let limit = EquationFunction::from_name("limit");
/// assert_eq!(limit, Some(EquationFunction::Limit));
/// assert_eq!(EquationFunction::Limit.argument_count(), 3);
/// assert_eq!(EquationFunction::Limit.value(&[7.0, -5.0, 5.0]), Some(5.0));
/// assert_eq!(EquationFunction::Delay.value(&[7.0, 1.0]), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EquationFunction {
    /// `sign(x)`: 1 if x is positive, -1 if it is negative, otherwise 0.
    Sign,
    /// `step(x)`: 1 if x is 0 or positive, otherwise 0.
    Step,
    /// `dead_zone(x, w)`: 0 if x is between -w and w, otherwise the excess, `max(x - w, 0) + min(x + w, 0)`.
    DeadZone,
    /// `limit(x, low, high)`: x, but at least `low` and at most `high`.
    Limit,
    /// `delay(x, T)`: the value that x had a time T ago.
    Delay,
}

impl EquationFunction {
    /// All functions, in the order of the enumeration.
    pub const ALL: [Self; 5] = [Self::Sign, Self::Step, Self::DeadZone, Self::Limit, Self::Delay];

    /// Returns the function with this name; `None` if there is none. Names are case-sensitive.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|function| function.name() == name)
    }

    /// Returns the name used in equations.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sign => "sign",
            Self::Step => "step",
            Self::DeadZone => "dead_zone",
            Self::Limit => "limit",
            Self::Delay => "delay",
        }
    }

    /// Returns the number of arguments: 1, 2 or 3.
    pub fn argument_count(self) -> usize {
        match self {
            Self::Sign | Self::Step => 1,
            Self::DeadZone | Self::Delay => 2,
            Self::Limit => 3,
        }
    }

    /// Returns the value of the function.
    ///
    /// `None` for a delay, whose value depends on the past, and if the number of arguments is wrong.
    pub fn value(self, arguments: &[f64]) -> Option<f64> {
        match (self, arguments) {
            (Self::Sign, &[x]) => Some(f64::from(i8::from(x > 0.0) - i8::from(x < 0.0))),
            (Self::Step, &[x]) => Some(f64::from(u8::from(x >= 0.0))),
            (Self::DeadZone, &[x, width]) => Some((x - width).max(0.0) + (x + width).min(0.0)),
            (Self::Limit, &[x, low, high]) => Some(x.max(low).min(high)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Callee;

    #[test]
    fn names_are_unique_and_not_those_of_formulas() {
        for function in EquationFunction::ALL {
            assert_eq!(EquationFunction::from_name(function.name()), Some(function));
            assert_eq!(Callee::from_name(function.name()), None);
        }
        assert_eq!(EquationFunction::from_name("Sign"), None);
    }

    #[test]
    fn values_follow_the_definitions() {
        let cases: [(EquationFunction, &[f64], Option<f64>); 14] = [
            (EquationFunction::Sign, &[3.0], Some(1.0)),
            (EquationFunction::Sign, &[-0.5], Some(-1.0)),
            (EquationFunction::Sign, &[0.0], Some(0.0)),
            (EquationFunction::Step, &[0.0], Some(1.0)),
            (EquationFunction::Step, &[-1e-9], Some(0.0)),
            (EquationFunction::Step, &[2.0], Some(1.0)),
            (EquationFunction::DeadZone, &[3.0, 1.0], Some(2.0)),
            (EquationFunction::DeadZone, &[-3.0, 1.0], Some(-2.0)),
            (EquationFunction::DeadZone, &[0.5, 1.0], Some(0.0)),
            (EquationFunction::Limit, &[3.0, -1.0, 2.0], Some(2.0)),
            (EquationFunction::Limit, &[-3.0, -1.0, 2.0], Some(-1.0)),
            (EquationFunction::Limit, &[0.5, -1.0, 2.0], Some(0.5)),
            (EquationFunction::Delay, &[3.0, 1.0], None),
            (EquationFunction::Sign, &[3.0, 1.0], None),
        ];
        for (function, arguments, expected) in cases {
            assert_eq!(function.value(arguments), expected, "{function:?} {arguments:?}");
        }
    }

    #[test]
    fn a_function_has_a_value_for_its_number_of_arguments() {
        for function in EquationFunction::ALL {
            let has_value = function.value(&vec![1.0; function.argument_count()]).is_some();
            assert_eq!(has_value, function != EquationFunction::Delay, "{function:?}");
        }
    }
}
