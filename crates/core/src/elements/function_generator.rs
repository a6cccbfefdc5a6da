//! Diode function generator: a curve of straight segments.

use super::{Input, Kind, Measure, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;

const NONE: &str = "none";
const ODD: &str = "odd";
const EVEN: &str = "even";

pub(super) static KIND: Kind = Kind {
    name: "function-generator",
    summary: "diode function generator: a curve of straight segments between points",
    law: "out = the straight line between the points on either side of in; beyond the outermost points the last \
          segment continues; odd: out(-in) = -out(in), even: out(-in) = out(in)",
    source: "diode function generators of the general-purpose machines",
    symbol: "function-generator",
    inputs: &[Input::jack("in", "where on the curve")],
    settings: &[
        Setting::preset(
            "symmetry",
            Measure::Choice(&[NONE, ODD, EVEN]),
            0.0,
            "whether the points, all at 0 V or above, are mirrored to negative inputs",
        ),
        Setting::required(
            "points",
            Measure::Curve("symmetry"),
            "two or more points [in, out], inputs rising",
        ),
    ],
    parts: &[Takes::always(Part::FunctionGenerator, 1)],
    output_law,
    ..Kind::AMPLIFIER
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let points = mirrored(builder.points("points"), builder.choice("symmetry"));
    let input = builder.input("in");
    let zero = builder.constant(0.0);
    // The reader has seen to it that there are two points.
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

/// The points with those that symmetry adds in front.
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
