//! Drive: a table of points.

use super::{Kind, Measure, Setting};
use crate::ir::{Builder, Register};

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

fn output_law(builder: &mut dyn Builder) -> Register {
    let value = match builder.choice("hold") {
        PREVIOUS => builder.held_in_time("points"),
        _ => builder.straight_in_time("points"),
    };
    let volts = builder.volts_per_signal();
    builder.multiply(volts, value)
}
