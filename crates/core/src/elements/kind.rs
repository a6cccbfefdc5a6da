//! What an element says of itself, once, for the checker, the schema, the reference page and every backend.

use std::fmt;

use super::setting::Setting;
use crate::ir::{Builder, Register};
use crate::machines::Part;

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
    pub output_law: fn(&mut dyn Builder) -> Register,
    /// Emits what its memory needs (rates, guards, histories), reading any input.
    pub memory_law: Option<fn(&mut dyn Builder)>,
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

impl fmt::Debug for Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
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
        output_law: |builder| builder.constant(0.0),
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

#[cfg(test)]
mod tests {
    use super::*;

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
