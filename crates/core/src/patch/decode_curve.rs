//! Points in time and curves in volts, read off the tree of the text.

use crate::document::fields::{Findings, list, number, wrong_type};
use crate::document::tree::{Content, Node};
use crate::document::{Code, Diagnostic, Span, told};
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

/// Points as they were read, from the patch or from a file.
pub(super) struct Points<'a> {
    pub points: Vec<[f64; 2]>,
    /// Where a point stands, and what is to be said of its place besides.
    pub place: &'a dyn Fn(usize) -> (Span, String),
    /// Where all of them stand.
    pub span: Span,
    /// What wrong ones are called.
    pub code: Code,
    /// What to do about points that do not rise.
    pub order_hint: &'static str,
}

/// What to do about points that do not rise, when no more is known of them.
pub(super) const SORT: &str = "sort the points by their first number, and keep one of those that share it";

/// Points in time, at least one.
pub(super) fn points(node: &Node, key: &str, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
    listed(node, key, findings, points_of)
}

/// A curve: two or more points in volts.
pub(super) fn curve(
    node: &Node,
    key: &str,
    mirror: Mirror,
    findings: &mut Findings,
) -> Option<Vec<[f64; 2]>> {
    listed(node, key, findings, |points, findings| curve_of(points, key, mirror, findings))
}

/// The points of a list, if they are found fit.
fn listed(
    node: &Node,
    key: &str,
    findings: &mut Findings,
    fit: impl Fn(Points<'_>, &mut Findings) -> Option<Vec<[f64; 2]>>,
) -> Option<Vec<[f64; 2]>> {
    let (items, points) = pairs(node, key, findings)?;
    let place = |index: usize| (items[index].span, String::new());
    fit(Points { points, place: &place, span: node.span, code: Code::BadNumber, order_hint: SORT }, findings)
}

/// Points in time, if they are.
pub(super) fn points_of(points: Points<'_>, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
    if let Some(falls) = points.falls(0.0, "the times of a table must rise from point to point") {
        findings.push(falls);
        return None;
    }
    if points.points.is_empty() {
        findings.push(Diagnostic::at(points.code, points.span, "a table needs at least one point"));
        return None;
    }
    Some(points.points)
}

/// The points of a curve, if they make one.
pub(super) fn curve_of(
    points: Points<'_>,
    key: &str,
    mirror: Mirror,
    findings: &mut Findings,
) -> Option<Vec<[f64; 2]>> {
    let reported = findings.len();
    if points.points.len() < 2 {
        let message = format!("a curve needs at least two points, and \"{key}\" has {}", points.points.len());
        let hint = "its segments run from point to point, and on beyond the outermost ones";
        findings.push(Diagnostic::at(points.code, points.span, message).hint(hint));
    }
    findings.extend((0..points.points.len()).filter_map(|index| points.outside(index)).take(MOST_OUTSIDE));
    let message = format!("the inputs of a curve must rise from point to point, by more than {APART} V");
    findings.extend(points.falls(APART, &message));
    findings.extend(points.not_mirrored(mirror));
    (findings.len() == reported).then_some(points.points)
}

/// More points outside the machine's voltages than this are not told one by one.
const MOST_OUTSIDE: usize = 1000;

fn pairs<'a>(node: &'a Node, key: &str, findings: &mut Findings) -> Option<(&'a [Node], Vec<[f64; 2]>)> {
    if let Content::Text(file) = &node.value {
        let hint = format!("points in a file: {{\"csv\": {}}}", serde_json::Value::from(file.as_str()));
        findings.push(wrong_type(node, key, "a list of points", &node.value).hint(hint));
        return None;
    }
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

impl Points<'_> {
    fn wrong(&self, index: usize, message: &str) -> Diagnostic {
        let (span, besides) = (self.place)(index);
        Diagnostic::at(self.code, span, format!("{message}{besides}"))
    }

    /// The first point that does not lie so far to the right of the one before.
    fn falls(&self, by: f64, message: &str) -> Option<Diagnostic> {
        let falling = self.points.windows(2).position(|pair| pair[1][0] - pair[0][0] <= by)?;
        Some(self.wrong(falling + 1, message).hint(self.order_hint))
    }

    fn outside(&self, index: usize) -> Option<Diagnostic> {
        let beyond = self.points[index].into_iter().find(|volts| volts.abs() > REFERENCE)?;
        let message =
            format!("a point of a curve lies at {} V, outside -{REFERENCE} ... {REFERENCE} V", told(beyond));
        let hint =
            "rescale: the machine works between -100 and 100 V; the outermost segments go on by themselves";
        Some(self.wrong(index, &message).hint(hint))
    }

    /// What keeps the curve from being mirrored.
    fn not_mirrored(&self, mirror: Mirror) -> Option<Diagnostic> {
        let [input, output] = *self.points.first()?;
        let (message, hint) = match mirror {
            Mirror::Odd | Mirror::Even if input < 0.0 => (
                format!("a curve that is mirrored begins at 0 V or above, not at {} V", told(input)),
                "give the points at 0 V and above: those below follow; or take \"symmetry\" away",
            ),
            Mirror::Odd if input == 0.0 && output != 0.0 => (
                format!(
                    "an odd curve passes through the origin: it gives 0 V at 0 V, not {} V",
                    told(output)
                ),
                "begin with [0, 0], or with the first break above 0 V",
            ),
            _ => return None,
        };
        Some(self.wrong(0, &message).hint(hint))
    }
}
