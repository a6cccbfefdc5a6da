//! Exponentials whose values are far from 1, as in Arrhenius' law.
//!
//! The element gives the voltage `reference`, which is from 1e-6 to 100 V, at the input 0 V. So the output of exp(u) with
//! u near -25 would be 1e-9 V. Such an exponential gets an input u - u0 with a whole number u0, which a summer computes,
//! and its reference contains the factor exp(u0). The circuit is exact for all values of the parameters, because
//! exp(u) = exp(u0) exp(u - u0).

use std::collections::BTreeMap;

use patchcord_expr::Dimension;

use super::centred::one;
use super::significant::LEAST_PEAK;
use crate::graph::{FunctionKind, Node, NodeId, Operation, Plan, Sum, Term};
use crate::symbolic::Fraction;

/// The smallest and the largest peak of an exponential without an offset. With the references that the element permits,
/// the output peaks at 51 V and at 94 V.
const USUAL_PEAKS: (f64, f64) = (0.51, 9.4e7);

/// Subtracts an offset from the exponents of the exponentials whose peaks are not usual. The result has the offset of
/// each of these exponentials: the value of its exponent at which its input is 0.
///
/// The ranges are in SI units by node, and `value` gives the values of coefficients. Nodes are added at the end.
pub(super) fn offset_exponents(
    plan: &mut Plan,
    ranges: &mut Vec<[f64; 2]>,
    value: &dyn Fn(&Fraction) -> f64,
) -> BTreeMap<NodeId, i32> {
    let mut offsets = BTreeMap::new();
    for id in plan.ids() {
        let Operation::Function { kind: FunctionKind::Exp, argument } = &plan.node(id).operation else {
            continue;
        };
        let (argument, [_, peak]) = (argument.clone(), ranges[id.0 as usize]);
        if let Some(offset) = offset(peak) {
            let ends = ranges[argument.node.0 as usize].map(|end| value(&argument.coefficient) * end);
            let range = [ends[0].min(ends[1]), ends[0].max(ends[1])].map(|end| end - f64::from(offset));
            subtract(plan, ranges, id, &argument, offset, range);
            offsets.insert(id, offset);
        }
    }
    offsets
}

/// The offset for an exponential with this peak: the largest whole number that its exponent reaches. `None` if the peak
/// is usual or counts as 0.
fn offset(peak: f64) -> Option<i32> {
    let is_usual = (USUAL_PEAKS.0..=USUAL_PEAKS.1).contains(&peak);
    let is_known = peak.is_finite() && peak >= LEAST_PEAK;
    (is_known && !is_usual).then(|| peak.ln().floor() as i32)
}

/// Puts a new node in front of an exponential: its argument less the offset. The range is that of the new node.
fn subtract(
    plan: &mut Plan,
    ranges: &mut Vec<[f64; 2]>,
    id: NodeId,
    argument: &Term,
    offset: i32,
    range: [f64; 2],
) {
    let one = one(plan, ranges);
    let mut sum = Sum::term(&argument.coefficient, argument.node);
    sum.add(&Fraction::whole(i64::from(-offset)), one);
    let name = difference_name(&plan.node(id).name, offset);
    let added = NodeId(plan.nodes.len() as u32);
    plan.nodes.push(Node { name, dimension: Dimension::NONE, operation: Operation::Sum(sum) });
    ranges.push(range);
    let argument = Term { coefficient: Fraction::whole(1), node: added };
    plan.nodes[id.0 as usize].operation = Operation::Function { kind: FunctionKind::Exp, argument };
}

/// The name of the exponent of an exponential less an offset: `-E/T + 22` for exp(-E/T).
fn difference_name(exponential: &str, offset: i32) -> String {
    let inside = exponential.strip_prefix("exp(").and_then(|rest| rest.strip_suffix(')'));
    let exponent = match inside.filter(|inside| has_all_pairs(inside)) {
        Some(inside) => inside.to_owned(),
        None => format!("ln({exponential})"),
    };
    let sign = if offset < 0 { '+' } else { '-' };
    format!("{exponent} {sign} {}", offset.unsigned_abs())
}

/// Whether no parenthesis in a text is closed before it is opened.
fn has_all_pairs(text: &str) -> bool {
    let mut depth = 0;
    text.chars().all(|letter| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        depth >= 0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_offset_is_the_largest_whole_number_below_the_exponent() {
        for (exponent, expected) in [(-22.5_f64, -23), (-130.1, -131), (21.3, 21), (-0.8, -1)] {
            assert_eq!(offset(exponent.exp()), Some(expected), "{exponent}");
        }
        for peak in [0.0, 1e-61, 0.51, 1.0, 9e7, f64::INFINITY, f64::NAN] {
            assert_eq!(offset(peak), None, "{peak}");
        }
    }

    #[test]
    fn the_difference_has_the_name_of_the_exponent() {
        let cases = [
            ("exp(-E/T)", -22, "-E/T + 22"),
            ("exp((a + b) c)", 25, "(a + b) c - 25"),
            ("exp(a)^(b)", -3, "ln(exp(a)^(b)) + 3"),
            ("rate", -14, "ln(rate) + 14"),
        ];
        for (exponential, offset, expected) in cases {
            assert_eq!(difference_name(exponential, offset), expected);
        }
    }
}
