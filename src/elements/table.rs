//! Drive: a table of points.

use crate::program::{Lowering, Register};

use super::{Kind, Measure, Setting};

pub(super) static KIND: Kind = Kind {
    name: "table",
    summary: "a curve through points in time: straight between them, level before and after",
    law: "out = the straight line between the points on either side of t",
    source: "curve follower of the period",
    symbol: "drive-table",
    settings: &[Setting::required(
        "points",
        Measure::Points,
        "points [time, value], times rising; or a CSV file that holds them",
    )],
    output_law,
    ..Kind::DRIVE
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let time = lowering.time();
    let value = lowering.table("points", time);
    lowering.corners("points");
    let volts = lowering.volts_per_signal();
    lowering.multiply(volts, value)
}
