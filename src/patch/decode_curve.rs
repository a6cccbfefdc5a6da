//! Points in time and curves in volts, read off the tree of the text.

use super::code::Code;
use super::diagnostic::{Diagnostic, told};
use super::fields::{Findings, list, number};
use super::tree::Node;
use crate::machines::REFERENCE;

/// How the points of a curve are mirrored to negative inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Mirror {
    None,
    /// With the opposite sign.
    Odd,
    /// With the same sign.
    Even,
}

/// Inputs of a curve that lie nearer to each other than this, in volts, make no segment.
const APART: f64 = 1e-6;

/// Points in time, at least one.
pub(super) fn points(node: &Node, key: &str, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
    let (items, points) = pairs(node, key, findings)?;
    let message = "the times of a table must rise from point to point";
    if !rises(items, &points, 0.0, message, findings) {
        return None;
    }
    if points.is_empty() {
        findings.push(Diagnostic::at(Code::BadNumber, node.span, "a table needs at least one point"));
        return None;
    }
    Some(points)
}

/// A curve: two or more points in volts.
pub(super) fn curve(
    node: &Node,
    key: &str,
    mirror: Mirror,
    findings: &mut Findings,
) -> Option<Vec<[f64; 2]>> {
    let (items, points) = pairs(node, key, findings)?;
    let reported = findings.len();
    if points.len() < 2 {
        let message = format!("a curve needs at least two points, and \"{key}\" has {}", points.len());
        let hint = "its segments run from point to point, and on beyond the outermost ones";
        findings.push(Diagnostic::at(Code::BadNumber, node.span, message).hint(hint));
    }
    for (item, point) in items.iter().zip(&points) {
        findings.extend(outside(item, *point));
    }
    let message = format!("the inputs of a curve must rise from point to point, by more than {APART} V");
    rises(items, &points, APART, &message, findings);
    if let (Some(item), Some(first)) = (items.first(), points.first()) {
        findings.extend(not_mirrored(item, *first, mirror));
    }
    (findings.len() == reported).then_some(points)
}

fn pairs<'a>(node: &'a Node, key: &str, findings: &mut Findings) -> Option<(&'a [Node], Vec<[f64; 2]>)> {
    let items = list(node, key, findings)?;
    let points: Vec<_> = items.iter().map(|item| point(item, key, findings)).collect();
    let points: Option<Vec<[f64; 2]>> = points.into_iter().collect();
    Some((items, points?))
}

fn point(node: &Node, key: &str, findings: &mut Findings) -> Option<[f64; 2]> {
    let pair = list(node, key, findings)?;
    let [from, to] = pair else {
        findings.push(Diagnostic::at(Code::WrongType, node.span, "a point is a list of two numbers"));
        return None;
    };
    Some([number(from, key, findings)?, number(to, key, findings)?])
}

/// Whether every point lies so far to the right of the one before; reports the first that does not.
fn rises(items: &[Node], points: &[[f64; 2]], by: f64, message: &str, findings: &mut Findings) -> bool {
    let falling = points.windows(2).position(|pair| pair[1][0] - pair[0][0] <= by);
    if let Some(index) = falling {
        let hint = "sort the points by their first number, and keep one of those that share it";
        findings.push(Diagnostic::at(Code::BadNumber, items[index + 1].span, message).hint(hint));
    }
    falling.is_none()
}

fn outside(item: &Node, point: [f64; 2]) -> Option<Diagnostic> {
    let beyond = point.into_iter().find(|volts| volts.abs() > REFERENCE)?;
    let message =
        format!("a point of a curve lies at {} V, outside -{REFERENCE} ... {REFERENCE} V", told(beyond));
    let hint =
        "rescale: the machine works between -100 and 100 V; the outermost segments go on by themselves";
    Some(Diagnostic::at(Code::BadNumber, item.span, message).hint(hint))
}

/// What keeps a curve with this first point from being mirrored.
fn not_mirrored(item: &Node, [input, output]: [f64; 2], mirror: Mirror) -> Option<Diagnostic> {
    let (message, hint) = match mirror {
        Mirror::Odd | Mirror::Even if input < 0.0 => (
            format!("a curve that is mirrored begins at 0 V or above, not at {} V", told(input)),
            "give the points at 0 V and above: those below follow; or take \"symmetry\" away",
        ),
        Mirror::Odd if input == 0.0 && output != 0.0 => (
            format!("an odd curve passes through the origin: it gives 0 V at 0 V, not {} V", told(output)),
            "begin with [0, 0], or with the first break above 0 V",
        ),
        _ => return None,
    };
    Some(Diagnostic::at(Code::BadNumber, item.span, message).hint(hint))
}
