use crate::function::Function;

/// What can be called in a formula.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Callee {
    /// A function that machines can take as well.
    Function(Function),
    /// `min(a, b)`: the smaller of two numbers.
    Minimum,
    /// `max(a, b)`: the larger of two numbers.
    Maximum,
    /// `abs(a)`: the number without its sign.
    Absolute,
}

impl Callee {
    /// Everything that can be called.
    pub fn all() -> impl Iterator<Item = Self> {
        Function::all().map(Self::Function).chain([Self::Minimum, Self::Maximum, Self::Absolute])
    }

    /// The callee of this name, if there is one. Upper and lower case differ.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|callee| callee.name() == name)
    }

    /// The name under which it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Function(function) => function.name(),
            Self::Minimum => "min",
            Self::Maximum => "max",
            Self::Absolute => "abs",
        }
    }

    /// How many arguments it takes: 1 or 2.
    pub fn arguments(self) -> usize {
        match self {
            Self::Function(function) => function.arguments(),
            Self::Minimum | Self::Maximum => 2,
            Self::Absolute => 1,
        }
    }

    /// Its value; one that takes one argument ignores `b`.
    pub fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Function(function) => function.apply(a, b),
            Self::Minimum => a.min(b),
            Self::Maximum => a.max(b),
            Self::Absolute => a.abs(),
        }
    }

    /// Which arguments it needs, if it does not take all.
    pub(super) fn domain(self) -> Option<&'static str> {
        match self {
            Self::Function(function) => function.domain(),
            Self::Minimum | Self::Maximum | Self::Absolute => None,
        }
    }
}
