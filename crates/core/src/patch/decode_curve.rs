//! Decodes and checks points: tables of time and curves in volts.
//!
//! Points come from a list in the document or from a CSV file. Both ways make a [`PointList`], which knows the position
//! of every point for reports. [`checked_time_points`] and [`checked_curve`] then check the order and the range.

use crate::document::fields::{Findings, list, number, wrong_type};
use crate::document::tree::{Content, Node};
use crate::document::{Code, Diagnostic, Span, format_number, format_outside};
use crate::machines::REFERENCE;

/// The symmetry by which the points of a curve at 0 V and above define the curve below 0 V.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Symmetry {
    /// The points define the whole curve.
    None,
    /// f(-x) = -f(x)
    Odd,
    /// f(-x) = f(x)
    Even,
}

/// Smallest distance between the inputs of two points of a curve, in volts. Nearer points would make a segment whose
/// slope is dominated by rounding. The value is 1e-8 of the reference.
const MIN_INPUT_DISTANCE: f64 = 1e-6;

/// Points that were read from a document or a file, but not checked yet.
pub(super) struct PointList<'a> {
    /// The points [abscissa, ordinate].
    pub points: Vec<[f64; 2]>,
    /// Returns the position of a point in the document, and a text that follows messages about it, such as the line of
    /// a file. The text may be empty.
    pub locate: &'a dyn Fn(usize) -> (Span, String),
    /// Position of the whole list.
    pub span: Span,
    /// The code for reports about points.
    pub code: Code,
    /// The hint if the points are not in increasing order.
    pub order_hint: &'static str,
}

/// The hint for points that are not in increasing order, if no more is known about their origin.
pub(super) const SORT_HINT: &str =
    "sort the points by their first number, and keep only one of those with the same first number";

/// Decodes points [time, value] of a drive; at least one.
pub(super) fn time_points(node: &Node, key: &str, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
    checked_list(node, key, findings, checked_time_points)
}

/// Decodes points [input, output] of a curve in volts; at least two.
pub(super) fn curve(
    node: &Node,
    key: &str,
    symmetry: Symmetry,
    findings: &mut Findings,
) -> Option<Vec<[f64; 2]>> {
    checked_list(node, key, findings, |points, findings| checked_curve(points, key, symmetry, findings))
}

/// Decodes points [input, output] of a table of a problem, in the units of the table; at least two.
pub(super) fn table_points(node: &Node, key: &str, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
    if let Content::Text(_) = &node.value {
        let hint = "write the points themselves: [[0, 0], [1, 2]]";
        findings.push(wrong_type(node, key, "a list of points", &node.value).hint(hint));
        return None;
    }
    checked_list(node, key, findings, |points, findings| checked_table(points, key, findings))
}

/// Decodes a list of points and passes it to `check`.
fn checked_list(
    node: &Node,
    key: &str,
    findings: &mut Findings,
    check: impl Fn(PointList<'_>, &mut Findings) -> Option<Vec<[f64; 2]>>,
) -> Option<Vec<[f64; 2]>> {
    let (items, points) = number_pairs(node, key, findings)?;
    let locate = |index: usize| (items[index].span, String::new());
    let code = Code::BAD_NUMBER;
    check(PointList { points, locate: &locate, span: node.span, code, order_hint: SORT_HINT }, findings)
}

/// Checks points in time: there is at least one, and the times are strictly increasing. `None` after a report.
pub(super) fn checked_time_points(points: PointList<'_>, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
    if let Some(fault) = points.order_fault(0.0, "the times of a table must rise from point to point") {
        findings.push(fault);
        return None;
    }
    if points.points.is_empty() {
        findings.push(Diagnostic::at(points.code, points.span, "a table needs at least one point"));
        return None;
    }
    Some(points.points)
}

/// Checks the points of a table of a problem: number and order. `None` after a report. `key` is the key of the list.
fn checked_table(points: PointList<'_>, key: &str, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
    let findings_before = findings.len();
    findings.extend(points.count_fault("table", key));
    findings.extend(points.order_fault(0.0, "the inputs of a table must rise from point to point"));
    (findings.len() == findings_before).then_some(points.points)
}

/// Checks the points of a curve: number, range, order and symmetry. `None` after a report. `key` is the key of the
/// list.
pub(super) fn checked_curve(
    points: PointList<'_>,
    key: &str,
    symmetry: Symmetry,
    findings: &mut Findings,
) -> Option<Vec<[f64; 2]>> {
    let findings_before = findings.len();
    let count = points.points.len();
    findings.extend(points.count_fault("curve", key));
    findings.extend((0..count).filter_map(|index| points.range_fault(index)).take(MAX_RANGE_FAULTS));
    let message =
        format!("the inputs of a curve must rise from point to point, by more than {MIN_INPUT_DISTANCE} V");
    findings.extend(points.order_fault(MIN_INPUT_DISTANCE, &message));
    findings.extend(points.symmetry_fault(symmetry));
    (findings.len() == findings_before).then_some(points.points)
}

/// Largest number of points outside ±100 V that are reported for one curve. More reports would not help the reader, and
/// a large file would fill the memory with them.
const MAX_RANGE_FAULTS: usize = 1000;

/// Decodes a list of pairs of numbers. Returns the items, for their positions, and the pairs.
///
/// A text instead of a list is probably the name of a file: the hint gives the correct form.
fn number_pairs<'a>(
    node: &'a Node,
    key: &str,
    findings: &mut Findings,
) -> Option<(&'a [Node], Vec<[f64; 2]>)> {
    if let Content::Text(file) = &node.value {
        let hint = format!("points in a file: {{\"csv\": {}}}", serde_json::Value::from(file.as_str()));
        findings.push(wrong_type(node, key, "a list of points", &node.value).hint(hint));
        return None;
    }
    let items = list(node, key, findings)?;
    let pairs: Vec<_> = items.iter().map(|item| number_pair(item, key, findings)).collect();
    let pairs: Option<Vec<[f64; 2]>> = pairs.into_iter().collect();
    Some((items, pairs?))
}

/// Decodes a list of two numbers.
fn number_pair(node: &Node, key: &str, findings: &mut Findings) -> Option<[f64; 2]> {
    let items = list(node, key, findings)?;
    let [abscissa, ordinate] = items else {
        findings.push(Diagnostic::at(Code::WRONG_TYPE, node.span, "a point is a list of two numbers"));
        return None;
    };
    Some([number(abscissa, key, findings)?, number(ordinate, key, findings)?])
}

impl PointList<'_> {
    /// A diagnostic at the position of a point.
    fn diagnostic(&self, index: usize, message: &str) -> Diagnostic {
        let (span, addition) = (self.locate)(index);
        Diagnostic::at(self.code, span, format!("{message}{addition}"))
    }

    /// Reports fewer than two points. `noun` is what the points define, and `key` is the key of the list.
    fn count_fault(&self, noun: &str, key: &str) -> Option<Diagnostic> {
        let count = self.points.len();
        let message = format!("a {noun} needs at least two points, and \"{key}\" has {count}");
        let hint = "its segments connect neighbouring points, and the outermost segments continue";
        (count < 2).then(|| Diagnostic::at(self.code, self.span, message).hint(hint))
    }

    /// Reports the first point whose first number does not exceed the one before by more than `distance`.
    fn order_fault(&self, distance: f64, message: &str) -> Option<Diagnostic> {
        let before = self.points.windows(2).position(|pair| pair[1][0] - pair[0][0] <= distance)?;
        Some(self.diagnostic(before + 1, message).hint(self.order_hint))
    }

    /// Reports a point whose input or output is outside ±100 V.
    fn range_fault(&self, index: usize) -> Option<Diagnostic> {
        let outside = self.points[index].into_iter().find(|volts| volts.abs() > REFERENCE)?;
        let message = format!(
            "a point of a curve is at {} V, outside -{REFERENCE} ... {REFERENCE} V",
            format_outside(outside, (-REFERENCE, REFERENCE))
        );
        let hint = "rescale: the machine works between -100 and 100 V; the outermost segments continue \
                    automatically";
        Some(self.diagnostic(index, &message).hint(hint))
    }

    /// Reports a first point that prevents the symmetry: one below 0 V, or an odd curve that is not 0 V at 0 V.
    fn symmetry_fault(&self, symmetry: Symmetry) -> Option<Diagnostic> {
        let [input, output] = *self.points.first()?;
        let (message, hint) = match symmetry {
            Symmetry::Odd | Symmetry::Even if input < 0.0 => (
                format!(
                    "a curve with \"symmetry\" must begin at 0 V or above, not at {} V",
                    format_number(input)
                ),
                "specify only the points at 0 V and above, or remove \"symmetry\"",
            ),
            Symmetry::Odd if input == 0.0 && output != 0.0 => (
                format!(
                    "an odd curve must pass through the origin: at 0 V it is {} V",
                    format_number(output)
                ),
                "begin with [0, 0], or with the first corner above 0 V",
            ),
            _ => return None,
        };
        Some(self.diagnostic(0, &message).hint(hint))
    }
}
