//! Drive: noise.

use super::{Kind, Measure, Setting};
use crate::ir::{Builder, Register};

pub(super) static KIND: Kind = Kind {
    name: "noise",
    summary: "noise: a number drawn by chance at equal times, kept until the next; the same for the same seed",
    law: "out = offset + rms x n_k for k x every <= t < (k + 1) x every, n_k independent, of mean 0 and variance 1; \
          integrated over a time T long against every, its variance is rms^2 x every x T",
    modes: "stands at its first number in initial condition, and begins its row anew with it; its time stops in hold",
    source: "noise generators of the general-purpose machines; ChaCha8 (Bernstein 2008), Box and Muller 1958",
    symbol: "drive-noise",
    settings: &[
        Setting::required("rms", Measure::Signal, "standard deviation").within(0.0, f64::MAX),
        Setting::required("every", Measure::Seconds, "time from one number to the next; steps end there")
            .within(1e-9, 1e9),
        Setting::required(
            "seed",
            Measure::Whole,
            "which row of numbers; drives of one seed give the same row",
        ),
        Setting::preset(
            "distribution",
            Measure::Choice(&["normal", "uniform"]),
            0.0,
            "how the numbers are distributed; uniform ones stay within sqrt(3) x rms",
        ),
        Setting::preset("offset", Measure::Signal, 0.0, "mean value"),
    ],
    output_law,
    ..Kind::DRIVE
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let number = builder.noise("seed", "every", "distribution");
    let (rms, offset) = (builder.get("rms"), builder.get("offset"));
    let swing = builder.multiply(rms, number);
    builder.add(offset, swing)
}
