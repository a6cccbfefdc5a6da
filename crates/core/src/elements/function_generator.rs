//! Diode function generator: a curve of straight segments.
//!
//! A table gives the voltages between the outermost points, and is constant beyond them. Two straight lines are added
//! for the voltages outside. Every inner point is a corner of the curve.

use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The points are the whole curve.
const NONE: &str = "none";
/// The curve is mirrored at the origin: out(-in) = -out(in).
const ODD: &str = "odd";
/// The curve is mirrored at the vertical axis: out(-in) = out(in).
const EVEN: &str = "even";

/// The row of the function generator. The points are in ascending order of the input, which the parser checks.
pub(super) static KIND: Kind = Kind {
    name: "function-generator",
    summary: "diode function generator: a curve of straight segments between points",
    law: "out = linear interpolation between the points on both sides of in; beyond the outermost points the last \
          segment continues; odd: out(-in) = -out(in), even: out(-in) = out(in)",
    source: "diode function generators of the general-purpose machines",
    symbol: "function-generator",
    inputs: &[Input::jack("in", "abscissa of the curve")],
    settings: &[
        Setting::preset(
            "symmetry",
            SettingQuantity::Choice(&[NONE, ODD, EVEN]),
            0.0,
            "symmetry by which the points, all at 0 V or above, are mirrored to negative inputs",
        ),
        Setting::required(
            "points",
            SettingQuantity::Curve("symmetry"),
            "two or more points [in, out] with ascending inputs",
        ),
    ],
    parts: &[PartUse::always(Part::FunctionGenerator, 1)],
    output_law,
    ..Kind::AMPLIFIER
};

/// out = table(in) + s1 min(in - x1, 0) + sn max(in - xn, 0), in volts.
///
/// The table has the points (x1, y1) to (xn, yn). s1 and sn are the slopes of its first and last segment, in volts per
/// volt.
fn output_law(builder: &mut dyn Builder) -> Register {
    let points = mirrored(builder.points("points"), builder.choice("symmetry"));
    let input = builder.input("in");
    let zero = builder.constant(0.0);
    // The parser has checked that there are at least two points.
    let ends = [[points[0], points[1]], [points[points.len() - 1], points[points.len() - 2]]];
    let [below, above] = ends.map(|[end, _]| {
        let place = builder.constant(end[0]);
        builder.subtract(input, place)
    });
    let outside = [builder.minimum(below, zero), builder.maximum(above, zero)];
    let mut out = builder.look_up(points, input);
    for ([end, inner], outside) in ends.into_iter().zip(outside) {
        let slope = builder.constant((end[1] - inner[1]) / (end[0] - inner[0]));
        let change = builder.multiply(slope, outside);
        out = builder.add(out, change);
    }
    out
}

/// The points, preceded by the mirrored ones. A point at 0 V is not doubled.
fn mirrored(points: Vec<[f64; 2]>, symmetry: &str) -> Vec<[f64; 2]> {
    let sign = match symmetry {
        ODD => -1.0,
        EVEN => 1.0,
        _ => return points,
    };
    let added = points.iter().rev().filter(|point| point[0] > 0.0).map(|point| [-point[0], sign * point[1]]);
    added.chain(points.iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_at_0_volts_is_not_doubled() {
        let points = vec![[0.0, 0.0], [10.0, 5.0]];
        assert_eq!(mirrored(points.clone(), NONE), points);
        assert_eq!(mirrored(points.clone(), ODD), [[-10.0, -5.0], [0.0, 0.0], [10.0, 5.0]]);
        assert_eq!(mirrored(points, EVEN), [[-10.0, 5.0], [0.0, 0.0], [10.0, 5.0]]);
    }
}
