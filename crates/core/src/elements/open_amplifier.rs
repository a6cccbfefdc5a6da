//! Amplifier without built-in feedback: the elements patched between output and input decide what it computes.
//!
//! The feedback makes a loop without an integrator, which the program solves at every evaluation. The amplification is
//! finite, so a small error remains: the sum of the inputs is -out / amplification instead of 0 V.

use super::{Input, Kind, OutputStage, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The setting with the open-loop gain.
pub(crate) const AMPLIFICATION: &str = "amplification";

/// The row of the open amplifier. Without feedback, almost every input drives the output to ±100 V.
pub(super) static KIND: Kind = Kind {
    name: "open-amplifier",
    summary: "amplifier without built-in feedback: the patched feedback makes it divide, take roots or invert \
              functions",
    law: "out = -amplification x (sum of gain x input); with feedback, out is the voltage at which the sum is -out / \
          amplification, which is nearly 0. The feedback must rise with out, so a divisor must be positive. The \
          relative error of a quotient with divisor d is 100 V / (d x amplification)",
    overload: "limited to ±100 V; the lamp lights if the demanded output exceeds this, as with a divisor of 0 or the \
               root of a negative number",
    source: "operational amplifier with its feedback resistor removed; division: out = -100 V x n / d from inputs n \
             and out x d / 100 V",
    symbol: "open-amplifier",
    inputs: &[Input::gains("x", "summing inputs, the gain in the name; at least one is for the feedback")],
    settings: &[Setting::preset(
        AMPLIFICATION,
        SettingQuantity::Ratio,
        1e6,
        "open-loop gain; chopper-stabilised valve amplifiers had 1e5 ... 1e8 for slow signals",
    )
    .within(1e2, 1e9)],
    parts: &[PartUse::always(Part::Summer, 1)],
    output: OutputStage::OpenAmplifier,
    output_law,
    ..Kind::AMPLIFIER
};

/// out = -amplification x (sum of gain x input), in volts. The amplification is a pure number from 1e2 to 1e9.
fn output_law(builder: &mut dyn Builder) -> Register {
    let (sum, amplification) = (builder.sum("x"), builder.get(AMPLIFICATION));
    let amplified = builder.multiply(amplification, sum);
    builder.negate(amplified)
}
