//! Drive: a sine wave whose frequency sweeps from one value to another.
//!
//! The angle is the integral of the frequency, so the wave has no jump where the sweep ends. The end of the sweep is a
//! change of mode, so no step of the solver reaches across it.

use super::sine::sine_of;
use super::{Kind, Setting, SettingQuantity};
use crate::ir::{Builder, Guard, ModeNames, Register, Transition};
use patchcord_expr::Function;

/// The frequency is a straight line in time.
const LINEAR: &str = "linear";
/// The logarithm of the frequency is a straight line in time: equal times for equal ratios of frequencies.
const LOGARITHMIC: &str = "logarithmic";

/// The row of the chirp. Amplitude and offset are in the unit of the drive's scale.
pub(super) static KIND: Kind = Kind {
    name: "chirp",
    summary: "a sine wave whose frequency sweeps from one value to another and then stays",
    law: "out = offset + amplitude x sin(2 pi c + phase); c is the integral of the frequency f from 0 to t; f = from + \
          (to - from) t / time, or with a logarithmic sweep f = from x (to / from)^(t / time); f = to for t > time. So \
          until t = time, c = from t + (to - from) t^2 / (2 time), or with r = ln(to / from), c = from x time / r x \
          ((to / from)^(t / time) - 1)",
    source: "sweep generators for frequency response tests",
    symbol: "drive-chirp",
    settings: &[
        Setting::required("amplitude", SettingQuantity::Signal, "amplitude about the offset"),
        Setting::required("from", SettingQuantity::Hertz, "frequency at t = 0, above 0").within(1e-9, 1e9),
        Setting::required("to", SettingQuantity::Hertz, "frequency at the end of the sweep, above 0")
            .within(1e-9, 1e9),
        Setting::required("time", SettingQuantity::Seconds, "time of the sweep").within(1e-9, 1e9),
        Setting::preset(
            "sweep",
            SettingQuantity::Choice(&[LINEAR, LOGARITHMIC]),
            0.0,
            "course of the frequency: equal times for equal differences, or for equal ratios",
        ),
        Setting::preset("phase", SettingQuantity::Radians, 0.0, "phase at t = 0"),
        Setting::preset("offset", SettingQuantity::Signal, 0.0, "mean value"),
    ],
    output_law,
    ..Kind::DRIVE
};

/// Mode while the frequency changes.
const SWEEPING: f64 = 0.0;
/// Mode after the sweep.
const STEADY: f64 = 1.0;

/// out = offset + amplitude x sin(2 pi c + phase), in volts. c is the number of cycles since t = 0.
fn output_law(builder: &mut dyn Builder) -> Register {
    let [swept, rest] = times(builder);
    let sweep = match builder.choice("sweep") {
        LOGARITHMIC => logarithmic_cycles(builder, swept),
        _ => linear_cycles(builder, swept),
    };
    let to = builder.get("to");
    let steady = builder.multiply(to, rest);
    let cycles = builder.add(sweep, steady);
    sine_of(builder, cycles)
}

/// The mode of the sweep.
const COURSE: ModeNames = ModeNames { mode: "course", values: &[(SWEEPING, "sweeping"), (STEADY, "steady")] };

/// The time within the sweep and the time after it, in problem seconds: t and 0 during the sweep, then its length and
/// the rest of t.
fn times(builder: &mut dyn Builder) -> [Register; 2] {
    let (time, length) = (builder.time(), builder.get("time"));
    let (since, until) = (builder.subtract(time, length), builder.subtract(length, time));
    let course = builder.new_mode(COURSE, SWEEPING);
    builder.transition(course, Transition::new(SWEEPING, STEADY, Guard::reached(since)));
    builder.transition(course, Transition::new(STEADY, SWEEPING, Guard::passed(until)));
    let half = builder.constant(0.5);
    let swept = builder.select(course.value, half, length, time);
    [swept, builder.subtract(time, swept)]
}

/// The cycles of a linear sweep after a time s within it: the mean frequency so far times s. The mean frequency is
/// from + (to - from) s / (2 time).
fn linear_cycles(builder: &mut dyn Builder, swept: Register) -> Register {
    let (from, to, length) = (builder.get("from"), builder.get("to"), builder.get("time"));
    let (change, half) = (builder.subtract(to, from), builder.constant(0.5));
    let share = builder.divide(swept, length);
    let half_change = builder.multiply(half, change);
    let increase = builder.multiply(half_change, share);
    let mean = builder.add(from, increase);
    builder.multiply(mean, swept)
}

/// Logarithm of the ratio of the frequencies, without sign, below which a series replaces the exponential. The first
/// term that the series omits is then below rounding.
const LEAST_LOGARITHM: f64 = 1e-8;

/// The cycles of a logarithmic sweep after a time s within it: from x time / r x (e^x - 1), with r = ln(to / from) and
/// x = r s / time. For equal frequencies, r is 0; near them the result is from x s x (1 + x / 2).
///
/// e^x - 1 is computed as tanh(x / 2) x (e^x + 1), which loses no digits for small x.
fn logarithmic_cycles(builder: &mut dyn Builder, swept: Register) -> Register {
    let (from, to, length) = (builder.get("from"), builder.get("to"), builder.get("time"));
    let [half, one, least] = [0.5, 1.0, LEAST_LOGARITHM].map(|number| builder.constant(number));
    let ratio = builder.divide(to, from);
    let logarithm = builder.call(Function::Ln, ratio);
    let size = builder.absolute(logarithm);
    let divisor = builder.select(size, least, logarithm, one);
    let share = builder.divide(swept, length);
    let exponent = builder.multiply(logarithm, share);
    let half_exponent = builder.multiply(half, exponent);
    let (tangent, power) =
        (builder.call(Function::Tanh, half_exponent), builder.call(Function::Exp, exponent));
    let sum = builder.add(power, one);
    let growth = builder.multiply(tangent, sum);
    let scale = builder.divide(length, divisor);
    let exact = builder.multiply(scale, growth);
    let factor = builder.add(one, half_exponent);
    let series = builder.multiply(swept, factor);
    let seconds = builder.select(size, least, exact, series);
    builder.multiply(from, seconds)
}
