//! Drive: a table of points in time.
//!
//! The times of the points are known before the run, so no step reaches across one of them.

use super::{Kind, Setting, SettingQuantity};
use crate::ir::{Builder, Register};

/// Straight lines between the points. The points are corners.
const LINEAR: &str = "linear";
/// Each value stays until the next point. The output jumps at the points.
const PREVIOUS: &str = "previous";

/// The row of the table. The points can come from a CSV file, which is read together with the patch.
pub(super) static KIND: Kind = Kind {
    name: "table",
    summary: "a curve through points in time: straight lines or a staircase, constant before and after",
    law: "out = linear interpolation between the points on both sides of t; with hold previous: the value of the \
          last point at or before t",
    source: "curve follower of the period",
    symbol: "drive-table",
    settings: &[
        Setting::required(
            "points",
            SettingQuantity::Points,
            "points [time, value] with ascending times, or a CSV file that contains them",
        ),
        Setting::preset(
            "hold",
            SettingQuantity::Choice(&[LINEAR, PREVIOUS]),
            0.0,
            "value between points: linear interpolation, or the value of the previous point like the output of a \
             sampled controller",
        ),
    ],
    output_law,
    ..Kind::DRIVE
};

/// out = table(t), in volts; t is in problem seconds. Before the first point and after the last one it is constant.
///
/// The points are in the unit of the scale. Unlike other settings they are not formulas, so the law converts them here.
fn output_law(builder: &mut dyn Builder) -> Register {
    let value = match builder.choice("hold") {
        PREVIOUS => builder.stepped_time_table("points"),
        _ => builder.linear_time_table("points"),
    };
    let volts = builder.volts_per_signal();
    builder.multiply(volts, value)
}
