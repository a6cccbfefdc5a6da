//! Drive: a table of points.

use crate::program::{Lowering, Register};

use super::{Kind, Measure, Setting};

const LINEAR: &str = "linear";
const PREVIOUS: &str = "previous";

pub(super) static KIND: Kind = Kind {
    name: "table",
    summary: "a curve through points in time: straight between them or a staircase, level before and after",
    law: "out = the straight line between the points on either side of t; hold previous: the value of the last point at t or before",
    source: "curve follower of the period",
    symbol: "drive-table",
    settings: &[
        Setting::required(
            "points",
            Measure::Points,
            "points [time, value], times rising; or a CSV file that holds them",
        ),
        Setting::preset(
            "hold",
            Measure::Choice(&[LINEAR, PREVIOUS]),
            0.0,
            "what it gives between points: the straight line, or the value of the last one, as a sampled controller puts it out",
        ),
    ],
    output_law,
    ..Kind::DRIVE
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let value = match lowering.choice("hold") {
        PREVIOUS => lowering.held_in_time("points"),
        _ => lowering.straight_in_time("points"),
    };
    let volts = lowering.volts_per_signal();
    lowering.multiply(volts, value)
}
