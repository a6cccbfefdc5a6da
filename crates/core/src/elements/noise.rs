//! Drive: white noise, constant between equally spaced instants.
//!
//! The numbers are levels: the solver ends a step at each instant at which one changes. They depend on the seed and on
//! their index only, so a run has the same numbers with every step and on every machine.

use super::{Kind, Setting, SettingQuantity};
use crate::ir::{Builder, Register};

/// The row of the noise drive. Far below the frequency 1 / every, its two-sided power density is rms^2 x every.
pub(super) static KIND: Kind = Kind {
    name: "noise",
    summary: "noise: a random number at equal intervals, constant in between; equal seeds give equal numbers",
    law: "out = offset + rms x n_k for k x every <= t < (k + 1) x every, with independent n_k of mean 0 and variance \
          1; its integral over a time T much longer than every has the variance rms^2 x every x T",
    modes: "has its first number in initial condition, where the sequence restarts; its time stops in hold",
    source: "noise generators of the general-purpose machines; ChaCha8 (Bernstein 2008), Box and Muller 1958",
    symbol: "drive-noise",
    settings: &[
        Setting::required("rms", SettingQuantity::Signal, "standard deviation").within(0.0, f64::MAX),
        Setting::required(
            "every",
            SettingQuantity::Seconds,
            "interval between two numbers; a step ends at each",
        )
        .within(1e-9, 1e9),
        Setting::required(
            "seed",
            SettingQuantity::Whole,
            "number that selects the sequence; drives with equal seeds have equal sequences",
        ),
        Setting::preset(
            "distribution",
            SettingQuantity::Choice(&["normal", "uniform"]),
            0.0,
            "distribution of the numbers; uniform ones are within ±sqrt(3) x rms",
        ),
        Setting::preset("offset", SettingQuantity::Signal, 0.0, "mean value"),
    ],
    output_law,
    ..Kind::DRIVE
};

/// out = offset + rms x n, in volts; n has mean 0 and variance 1. The lowering has converted the settings to volts.
fn output_law(builder: &mut dyn Builder) -> Register {
    let number = builder.noise("seed", "every", "distribution");
    let (rms, offset) = (builder.get("rms"), builder.get("offset"));
    let swing = builder.multiply(rms, number);
    builder.add(offset, swing)
}
