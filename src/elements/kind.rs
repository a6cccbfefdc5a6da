//! What an element says of itself, once, for the checker, the schema, the reference page and every backend.

use std::fmt;

use crate::machines::{Part, REFERENCE};
use crate::program::{Lowering, Register};

/// One kind of computing element or drive: a row of the registry.
pub struct Kind {
    /// Name in documents, such as "summer".
    pub name: &'static str,
    /// Whether it is a computing element or a drive.
    pub family: Family,
    /// What it is, in one line.
    pub summary: &'static str,
    /// Its law as a formula in volts.
    pub law: &'static str,
    /// What it does at overload.
    pub overload: &'static str,
    /// What it does in initial condition and in hold.
    pub modes: &'static str,
    /// Where the law comes from.
    pub source: &'static str,
    /// Name of its symbol in drawings.
    pub symbol: &'static str,
    /// Its inputs; the first is the one that a bare `"in"` means.
    pub inputs: &'static [Input],
    /// What can be set on it.
    pub settings: &'static [Setting],
    /// Settings of which the first must lie below the second.
    pub ordered: &'static [(&'static str, &'static str)],
    /// Settings of which the second must not lie below the first nor above the third, as far as these are set.
    pub bounded: &'static [(&'static str, &'static str, &'static str)],
    /// The positions between which it switches, by the values 0, 1, ... of its first mode; a phase of a run may
    /// wait for them.
    pub positions: &'static [&'static str],
    /// The parts of a machine that it is made of.
    pub parts: &'static [Takes],
    /// Whether its output is an amplifier's: stops at ±100 V and lights a lamp.
    pub output: Output,
    /// How the output follows the main input.
    pub transfer: Transfer,
    /// Emits the operations of its output, reading inputs that are `direct` only.
    pub output_law: fn(&mut Lowering<'_>) -> Register,
    /// Emits what its memory needs (rates, guards, histories), reading any input.
    pub memory_law: Option<fn(&mut Lowering<'_>)>,
}

/// Parts of a machine that an element is made of.
#[derive(Debug, Clone, Copy)]
pub struct Takes {
    /// The part.
    pub part: Part,
    /// How many.
    pub count: usize,
    /// The input or setting (or group of settings) with which it takes them; "": always.
    pub with: &'static str,
}

impl Takes {
    /// Parts that the element always takes.
    pub const fn always(part: Part, count: usize) -> Self {
        Takes { part, count, with: "" }
    }

    /// Parts that the element takes only with this input, setting or group of settings.
    pub const fn with(with: &'static str, part: Part, count: usize) -> Self {
        Takes { part, count, with }
    }
}

/// Where a kind may stand in a document.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// In `elements`: patched by cords, set in volts.
    Computing,
    /// In `drives`: a function of time, set in the physical units of its scale.
    Drive,
    /// In the machine itself: the fixed references.
    Reference,
}

/// What stands behind an output jack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// An amplifier: clipped at ±100 V, with an overload lamp.
    Amplifier,
    /// An amplifier without feedback of its own, clipped and watched like the others: its output is what makes
    /// its inputs agree.
    OpenAmplifier,
    /// An amplifier that integrates: its state is what is limited.
    Integrator,
    /// A network without an amplifier: as high as what drives it.
    Passive,
}

/// How an output follows the main input: what gains measure, whether a pot in front may be a rate, and what the
/// audit of amplitude scaling can follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transfer {
    /// Minus the gain of the jack.
    Inverting,
    /// Minus the gain of the jack, integrated: gains are per machine second.
    Integrating,
    /// The share that its setting says.
    Share,
    /// Otherwise: the audit does not follow it.
    Other,
}

/// An input of an element.
pub struct Input {
    /// Name of the jack, or the prefix of jacks with gains ("x" for x1, x10, ...).
    pub name: &'static str,
    /// How many cords it takes.
    pub jacks: Jacks,
    /// Whether the patch must drive it.
    pub required: bool,
    /// Whether the output follows it within the same instant.
    pub direct: bool,
    /// What it is for.
    pub description: &'static str,
}

/// How cords go into an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Jacks {
    /// One jack, one cord.
    One,
    /// This many equal jacks, one cord each, all of them driven.
    Exactly(usize),
    /// Any number of equal jacks.
    Any,
    /// Summing jacks, each with the gain that its name says.
    Gains,
}

/// Something that can be set on an element.
pub struct Setting {
    /// Key in the document; a dot means a nested object ("limit.upper").
    pub name: &'static str,
    /// What kind of value it is, and in which unit.
    pub measure: Measure,
    /// What it is when the patch does not say.
    pub default: Default,
    /// Least and largest value allowed.
    pub range: (f64, f64),
    /// What it does.
    pub description: &'static str,
}

/// Up to here every whole number is a number of the machine that runs this.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// What rounding may add to a fraction.
const ROUNDING: f64 = 1e-12;

/// What a setting's value measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// A potentiometer setting: a pure number from 0 to 1; a rate before an integrator.
    Fraction,
    /// A pure number.
    Ratio,
    /// A whole number, 0 or above.
    Whole,
    /// Volts of the machine.
    Volts,
    /// Machine seconds.
    MachineSeconds,
    /// Problem seconds (drives).
    Seconds,
    /// Cycles per problem second (drives).
    Hertz,
    /// An angle in radians (drives).
    Radians,
    /// An angle in radians for a volt of the machine.
    RadiansPerVolt,
    /// The unit of the drive's scale.
    Signal,
    /// The unit of the drive's scale per problem second.
    SignalRate,
    /// true or false.
    Flag,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A list of points [problem seconds, value in the unit of the drive's scale].
    Points,
    /// A list of points [volts in, volts out], mirrored as the setting of this name says, which stands before
    /// it.
    Curve(&'static str),
}

/// What a setting is when the patch does not say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Default {
    /// The patch must say.
    Required,
    /// This number (for flags: not 0 is true; for choices: the index).
    Number(f64),
    /// There is none, and the element does without.
    Absent,
}

impl fmt::Debug for Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
    }
}

impl Measure {
    /// The widest range that a value of this measure can have.
    const fn widest(self) -> (f64, f64) {
        match self {
            Measure::Fraction | Measure::Flag => (0.0, 1.0),
            Measure::Volts | Measure::Curve(_) => (-REFERENCE, REFERENCE),
            Measure::Whole => (0.0, LARGEST_WHOLE),
            Measure::MachineSeconds | Measure::Seconds | Measure::Hertz => (0.0, f64::MAX),
            _ => (f64::MIN, f64::MAX),
        }
    }
}

impl Input {
    /// An input of one jack that the patch must drive and that acts within the same instant.
    pub const fn jack(name: &'static str, description: &'static str) -> Self {
        Input { name, jacks: Jacks::One, required: true, direct: true, description }
    }

    /// Summing inputs with gains that the patch must drive and that act within the same instant.
    pub const fn gains(name: &'static str, description: &'static str) -> Self {
        Input { name, jacks: Jacks::Gains, required: true, direct: true, description }
    }

    /// The same input with other jacks.
    pub const fn jacks(self, jacks: Jacks) -> Self {
        Input { jacks, ..self }
    }

    /// The same input, which acts through the element's memory only.
    pub const fn remembered(self) -> Self {
        Input { direct: false, ..self }
    }

    /// The same input, which may be left open.
    pub const fn open(self) -> Self {
        Input { required: false, ..self }
    }
}

impl Kind {
    /// What networks without an amplifier have in common.
    pub const NETWORK: Kind = Kind {
        name: "",
        family: Family::Computing,
        summary: "",
        law: "",
        overload: "has no amplifier: cannot overload",
        modes: "computes in every mode",
        source: "",
        symbol: "",
        inputs: &[],
        settings: &[],
        ordered: &[],
        bounded: &[],
        positions: &[],
        parts: &[],
        output: Output::Passive,
        transfer: Transfer::Other,
        output_law: |lowering| lowering.constant(0.0),
        memory_law: None,
    };

    /// What drives have in common.
    pub const DRIVE: Kind = Kind {
        family: Family::Drive,
        overload: "its output amplifier stops at ±100 V; the lamp lights when more is asked for",
        modes: "stands at its value of t = 0 in initial condition; its time stops in hold",
        output: Output::Amplifier,
        ..Kind::NETWORK
    };

    /// What amplifiers that do not integrate have in common.
    pub const AMPLIFIER: Kind = Kind {
        overload: "stops at ±100 V; the lamp lights when more is asked for",
        output: Output::Amplifier,
        ..Kind::NETWORK
    };

    /// The input of this name, or whose prefix with a gain this is, and that gain.
    pub fn input(&self, jack: &str) -> Option<(usize, f64)> {
        self.inputs.iter().enumerate().find_map(|(index, input)| match input.jacks {
            Jacks::Gains => gain_of(input.name, jack).map(|gain| (index, gain)),
            _ => (input.name == jack).then_some((index, 1.0)),
        })
    }

    /// The index of a setting by its name.
    pub fn setting(&self, name: &str) -> Option<usize> {
        self.settings.iter().position(|setting| setting.name == name)
    }

    /// Whether it keeps something from one instant to the next: a charge, a position, a history.
    pub fn has_memory(&self) -> bool {
        self.memory_law.is_some()
    }
}

/// The gain in a jack's name: 10 in "x10" for the prefix "x".
pub(crate) fn gain_of(prefix: &str, jack: &str) -> Option<f64> {
    let digits = jack.strip_prefix(prefix)?;
    let plain = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    let gain: f64 = if plain { digits.parse().ok()? } else { return None };
    (gain > 0.0 && gain.is_finite()).then_some(gain)
}

impl Setting {
    /// The forward drop that elements with diodes have in common.
    pub const DIODE_DROP: Setting =
        Setting::preset("drop", Measure::Volts, 0.0, "forward drop of the diodes").within(0.0, 10.0);

    /// A setting that the patch must give, in the widest range that its measure allows.
    pub const fn required(name: &'static str, measure: Measure, description: &'static str) -> Self {
        Setting { name, measure, default: Default::Required, range: measure.widest(), description }
    }

    /// A setting with a default.
    pub const fn preset(name: &'static str, measure: Measure, value: f64, description: &'static str) -> Self {
        Setting { name, measure, default: Default::Number(value), range: measure.widest(), description }
    }

    /// A setting that the element can do without.
    pub const fn optional(name: &'static str, measure: Measure, description: &'static str) -> Self {
        Setting { name, measure, default: Default::Absent, range: measure.widest(), description }
    }

    /// The same setting in a narrower range.
    pub const fn within(self, low: f64, high: f64) -> Self {
        Setting { range: (low, high), ..self }
    }

    /// The range that a coefficient keeps to: what a drive gives has become volts, of either sign.
    pub fn coefficient_range(&self) -> (f64, f64) {
        match self.measure {
            Measure::Signal | Measure::SignalRate => (f64::MIN, f64::MAX),
            _ => self.allowed(),
        }
    }

    /// The range that a value worked out of formulas keeps to: a fraction may pass its ends by rounding, as a
    /// pot at "0.1 * 3 / 0.3" does.
    fn allowed(&self) -> (f64, f64) {
        let slack = if self.measure == Measure::Fraction { ROUNDING } else { 0.0 };
        (self.range.0 - slack, self.range.1 + slack)
    }

    /// Whether a value may be set.
    pub fn allows(&self, value: f64) -> bool {
        let (low, high) = self.allowed();
        (low..=high).contains(&value)
    }

    /// A setting that is a number: the unit in which its plain numbers stand.
    pub fn unit(&self) -> &'static str {
        match self.measure {
            Measure::Fraction | Measure::Ratio => "1",
            Measure::Whole => "whole number",
            Measure::Volts => "V",
            Measure::MachineSeconds => "machine s",
            Measure::Seconds => "s",
            Measure::Hertz => "Hz",
            Measure::Radians => "rad",
            Measure::RadiansPerVolt => "rad/V",
            Measure::Signal => "unit of the scale",
            Measure::SignalRate => "unit of the scale per s",
            Measure::Flag => "true or false",
            Measure::Choice(_) => "a word",
            Measure::Points => "[s, unit of the scale]",
            Measure::Curve(_) => "[V, V]",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pot_may_be_set_to_1_and_a_rounding() {
        let setting = Setting::required("setting", Measure::Fraction, "");
        assert!([0.0, 0.5, 1.0, 0.1 * 3.0 / 0.3, -1e-13].iter().all(|value| setting.allows(*value)));
        assert!([1.0 + 1e-9, -1e-9, f64::NAN].iter().all(|value| !setting.allows(*value)));
        let drop = Setting::DIODE_DROP;
        assert!(drop.allows(10.0) && !drop.allows(10.0 + 1e-13));
    }

    #[test]
    fn gains_are_read_from_the_name_of_the_jack() {
        assert_eq!(gain_of("x", "x10"), Some(10.0));
        assert_eq!(gain_of("x", "x0.5"), Some(0.5));
        assert_eq!(gain_of("brake_x", "brake_x1000"), Some(1000.0));
        for wrong in ["x", "x0", "x-1", "x1e3", "y1", "xten", "x1.2.3", "brake_x1"] {
            assert_eq!(gain_of("x", wrong), None, "{wrong}");
        }
        assert_eq!(gain_of("x", &format!("x{}", "9".repeat(400))), None, "beyond the numbers");
    }
}
