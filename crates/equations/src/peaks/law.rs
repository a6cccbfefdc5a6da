//! The laws of the nodes: how each follows from others at the same instant.

use patchcord_expr::Function;

/// How a node follows from others at the same instant.
#[derive(Debug)]
pub(super) enum Law {
    /// The value of a state, a drive or a delay line, which is known before the evaluation.
    Given,
    /// A number.
    Constant(f64),
    /// A weighted sum.
    Sum(Vec<Weighted>),
    /// A weighted sum between bounds, which may be infinite.
    Limited {
        /// The sum.
        sum: Vec<Weighted>,
        /// The lower bound.
        lower: f64,
        /// The upper bound.
        upper: f64,
    },
    /// A product of two nodes.
    Product([usize; 2]),
    /// A weighted sum over a node.
    Quotient {
        /// The dividend.
        dividend: Vec<Weighted>,
        /// The divisor.
        divisor: usize,
    },
    /// The square root of a weighted sum. Negative sums count as 0.
    Root(Vec<Weighted>),
    /// The value for which a weighted sum is 0.
    Zero(Vec<Weighted>),
    /// The angle from -pi to pi whose tangent is the first weighted sum over the second one, with their signs.
    Angle([Vec<Weighted>; 2]),
    /// The absolute value of a node.
    Absolute(usize),
    /// The lower of two weighted nodes.
    Lower([Weighted; 2]),
    /// The higher of two weighted nodes.
    Higher([Weighted; 2]),
    /// One of two numbers by the sign of a node.
    Switch {
        /// The node.
        input: usize,
        /// The value while the node is 0 or more.
        at_least_0: f64,
        /// The value while the node is below 0.
        below_0: f64,
    },
    /// 0 within a zone, otherwise the distance from it.
    DeadZone {
        /// The input.
        input: usize,
        /// The half width of the zone.
        width: Weighted,
    },
    /// A function of a weighted node.
    Function(Function, Weighted),
    /// Straight lines between points. The outermost lines continue.
    Curve {
        /// The points.
        points: Vec<[f64; 2]>,
        /// The abscissa.
        input: Weighted,
    },
}

/// A node times a number.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weighted {
    /// The number.
    pub factor: f64,
    /// The node.
    pub node: usize,
}

impl Weighted {
    /// The product, from the values of all nodes.
    pub(super) fn value(self, values: &[f64]) -> f64 {
        self.factor * values[self.node]
    }
}

/// The value of a weighted sum.
pub(super) fn total(sum: &[Weighted], values: &[f64]) -> f64 {
    sum.iter().fold(0.0, |total, term| total + term.value(values))
}

/// The sum of the magnitudes of the terms of a weighted sum.
pub(super) fn size(sum: &[Weighted], values: &[f64]) -> f64 {
    sum.iter().fold(0.0, |total, term| total + term.value(values).abs())
}

impl Law {
    /// The nodes that the law reads at the same instant.
    pub(super) fn inputs(&self) -> Vec<usize> {
        let nodes = |sum: &[Weighted]| sum.iter().map(|term| term.node).collect::<Vec<_>>();
        match self {
            Law::Given | Law::Constant(_) => Vec::new(),
            Law::Sum(sum) | Law::Limited { sum, .. } | Law::Root(sum) | Law::Zero(sum) => nodes(sum),
            Law::Product(factors) => factors.to_vec(),
            Law::Angle(sums) => sums.iter().flat_map(|sum| nodes(sum)).collect(),
            Law::Quotient { dividend, divisor } => {
                let mut inputs = nodes(dividend);
                inputs.push(*divisor);
                inputs
            }
            Law::Absolute(input) | Law::Switch { input, .. } => vec![*input],
            Law::Lower(terms) | Law::Higher(terms) => nodes(terms),
            Law::DeadZone { input, width } => vec![*input, width.node],
            Law::Function(_, argument) => vec![argument.node],
            Law::Curve { input, .. } => vec![input.node],
        }
    }

    /// The value of a node with this law, from the values of all nodes. Values that other laws find, as those of states
    /// and of unknowns, stay as they are.
    pub(super) fn value(&self, node: usize, values: &[f64]) -> f64 {
        match self {
            Law::Given | Law::Zero(_) => values[node],
            Law::Constant(number) => *number,
            Law::Sum(sum) => total(sum, values),
            Law::Limited { sum, lower, upper } => limited(total(sum, values), *lower, *upper),
            Law::Product([one, other]) => values[*one] * values[*other],
            Law::Quotient { dividend, divisor } => total(dividend, values) / values[*divisor],
            Law::Root(sum) => limited(total(sum, values), 0.0, f64::INFINITY).sqrt(),
            Law::Angle([one, other]) => Function::Atan2.apply(total(one, values), total(other, values)),
            Law::Absolute(input) => values[*input].abs(),
            Law::Lower([one, other]) => -higher(-one.value(values), -other.value(values)),
            Law::Higher([one, other]) => higher(one.value(values), other.value(values)),
            Law::Switch { input, .. } if values[*input].is_nan() => f64::NAN,
            Law::Switch { input, at_least_0, below_0 } => {
                *(if values[*input] >= 0.0 { at_least_0 } else { below_0 })
            }
            Law::DeadZone { input, width } => beyond(values[*input], width.value(values)),
            Law::Function(function, argument) => {
                let argument = argument.value(values);
                function.apply(argument, argument)
            }
            Law::Curve { points, input } => on_curve(points, input.value(values)),
        }
    }

    /// What must be 0 for the present value of an unknown: its sum, or the difference between its law and its value.
    pub(super) fn residual(&self, node: usize, values: &[f64]) -> f64 {
        match self {
            Law::Zero(sum) => total(sum, values),
            _ => self.value(node, values) - values[node],
        }
    }
}

/// A number between bounds. NaN stays NaN.
fn limited(number: f64, lower: f64, upper: f64) -> f64 {
    if number < lower {
        lower
    } else if number > upper {
        upper
    } else {
        number
    }
}

/// The distance of a number from the zone -width ... width, with its sign. NaN stays NaN.
fn beyond(number: f64, width: f64) -> f64 {
    if number > width {
        number - width
    } else if number < -width {
        number + width
    } else {
        0.0 * number
    }
}

/// The higher of two numbers. NaN if one of them is NaN, so that a value without meaning is not hidden.
fn higher(one: f64, other: f64) -> f64 {
    if one >= other || one.is_nan() { one } else { other }
}

/// The ordinate of a curve at an abscissa: straight lines through points, of which the outermost continue. NaN if there
/// are fewer than two points.
fn on_curve(points: &[[f64; 2]], at: f64) -> f64 {
    let Some(last) = points.len().checked_sub(2) else { return f64::NAN };
    let before = points.partition_point(|point| point[0] < at).saturating_sub(1).min(last);
    let ([x, y], [next, ordinate]) = (points[before], points[before + 1]);
    y + (ordinate - y) * (at - x) / (next - x)
}
