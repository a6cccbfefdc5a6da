//! The diode network of the dead zone: two free potentiometers and a diode pair.

use crate::machines::Part;
use crate::program::{Lowering, Register};

use super::{Default, Family, Input, Jacks, Kind, Measure, Output, Setting, Takes};

const fn jack(name: &'static str, description: &'static str) -> Input {
    Input { name, jacks: Jacks::One, required: true, direct: true, description }
}

pub(super) static KIND: Kind = Kind {
    name: "diode-dead-zone",
    family: Family::Computing,
    summary: "dead zone of two free pots and a diode pair, its width set by two bias voltages",
    law: "out = max(0, in - r (in - bias_minus) - drop) + min(0, in - r (in - bias_plus) + drop), r the setting: \
          breaks at bias r / (1 - r), slope 1 - r beyond",
    overload: "has no amplifier: cannot overload",
    modes: "computes in every mode",
    source: "thesis Fig 8.5 (c), eq. 17-8 to 27-8",
    symbol: "diode-dead-zone",
    inputs: &[
        jack("in", "signal, at one end of both tracks"),
        jack("bias_plus", "+VB, at the other end of the track for negative signals"),
        jack("bias_minus", "-VB, at the other end of the track for positive signals"),
    ],
    settings: &[
        Setting {
            name: "setting",
            measure: Measure::Fraction,
            default: Default::Required,
            range: (0.0, 1.0),
            description: "position r of both wipers, 0 at the signal's end",
        },
        Setting {
            name: "drop",
            measure: Measure::Volts,
            default: Default::Number(0.0),
            range: (0.0, 10.0),
            description: "forward drop of the diodes",
        },
    ],
    ordered: &[],
    parts: &[Takes::always(Part::FreePot, 2), Takes::always(Part::DiodePair, 1)],
    output: Output::Passive,
    output_law,
    memory_law: None,
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let zero = lowering.constant(0.0);
    let drop = lowering.get("drop");
    let upper_wiper = wiper(lowering, "bias_minus");
    let upper = lowering.subtract(upper_wiper, drop);
    let positive = lowering.maximum(upper, zero);
    let lower_wiper = wiper(lowering, "bias_plus");
    let lower = lowering.add(lower_wiper, drop);
    let negative = lowering.minimum(lower, zero);
    lowering.add(positive, negative)
}

/// Voltage on the wiper of the track that ends at a bias.
fn wiper(lowering: &mut Lowering<'_>, bias: &str) -> Register {
    let setting = lowering.get("setting");
    let (signal, end) = (lowering.input("in"), lowering.input(bias));
    let across = lowering.subtract(signal, end);
    let dropped = lowering.multiply(setting, across);
    lowering.subtract(signal, dropped)
}
