//! Drive: a table of points.

use crate::program::{Lowering, Register};

use super::{Default, Family, Kind, Measure, Output, Setting};

pub(super) static KIND: Kind = Kind {
    name: "table",
    family: Family::Drive,
    summary: "a curve through points in time: straight between them, level before and after",
    law: "out = the straight line between the points on either side of t",
    overload: "its output amplifier stops at ±100 V; the lamp lights when more is asked for",
    modes: "stands at its value of t = 0 in initial condition; its time stops in hold",
    source: "curve follower of the period",
    symbol: "drive-table",
    inputs: &[],
    settings: &[Setting {
        name: "points",
        measure: Measure::Points,
        default: Default::Required,
        range: (f64::MIN, f64::MAX),
        description: "points [time, value], times rising",
    }],
    ordered: &[],
    parts: &[],
    output: Output::Amplifier,
    output_law,
    memory_law: None,
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let time = lowering.time();
    let value = lowering.table("points", time);
    let volts = lowering.volts_per_signal();
    lowering.multiply(volts, value)
}
