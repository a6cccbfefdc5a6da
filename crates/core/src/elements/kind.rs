//! The description of one kind of element: a row of the registry.
//!
//! The checker, the schema, the reference page and every backend read it. So a new element needs one file and one line
//! in the registry.

use std::fmt;

use super::setting::Setting;
use crate::ir::{Builder, Register};
use crate::machines::{MachineModel, Part};

/// One kind of computing element, drive or reference.
pub struct Kind {
    /// Its name in documents, such as "summer".
    pub name: &'static str,
    /// Whether it is a computing element or a drive.
    pub family: Family,
    /// A description in one line.
    pub summary: &'static str,
    /// Its law as a formula in volts.
    pub law: &'static str,
    /// Its behaviour at overload.
    pub overload: &'static str,
    /// Its behaviour in initial condition and in hold.
    pub modes: &'static str,
    /// The source of the law.
    pub source: &'static str,
    /// The name of its symbol in drawings.
    pub symbol: &'static str,
    /// Its inputs. The first one is meant by a bare `"in"`.
    pub inputs: &'static [Input],
    /// Its settings.
    pub settings: &'static [Setting],
    /// Pairs of settings of which the first must be below the second.
    pub ordered: &'static [(&'static str, &'static str)],
    /// Triples of settings of which the second must be between the first and the third. A limit that is not set does
    /// not apply.
    pub bounded: &'static [(&'static str, &'static str, &'static str)],
    /// Names of the positions between which it switches, in the order of the values 0, 1 and so on of its first mode.
    /// A phase of a run can wait for a position.
    pub positions: &'static [&'static str],
    /// The parts of a machine that it needs.
    pub parts: &'static [PartUse],
    /// The kind of its output. The output of an amplifier is limited to ±100 V and has an overload lamp.
    pub output: OutputStage,
    /// How the output follows the main input. The scaling audit uses it.
    pub transfer: Transfer,
    /// Emits the operations of the output. It may read only inputs that are `direct`.
    pub output_law: fn(&mut dyn Builder) -> Register,
    /// Emits the operations of the memory: rates, guards and sampled values. It may read every input. `None` if there
    /// is no memory.
    pub memory_law: Option<fn(&mut dyn Builder)>,
}

/// The number of one part that an element needs.
#[derive(Debug, Clone, Copy)]
pub struct PartUse {
    /// The part.
    pub part: Part,
    /// The number of parts.
    pub count: usize,
    /// The input, the setting or the group of settings that makes the part necessary; "" if it is always necessary.
    pub with: &'static str,
}

impl PartUse {
    /// A part that the element always needs.
    pub const fn always(part: Part, count: usize) -> Self {
        PartUse { part, count, with: "" }
    }

    /// A part that the element needs only with this input, setting or group of settings.
    pub const fn with(with: &'static str, part: Part, count: usize) -> Self {
        PartUse { part, count, with }
    }
}

/// The section of a document in which a kind occurs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// In `elements`: connected by cords, with settings in volts.
    Computing,
    /// In `drives`: a function of time, with settings in the units of its scale.
    Drive,
    /// In the machine itself: the fixed references.
    Reference,
}

/// The kind of circuit at an output jack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputStage {
    /// An amplifier: its output is limited to ±100 V, and it has an overload lamp.
    Amplifier,
    /// An amplifier without built-in feedback. It is limited like the others; its output has the value at which its
    /// inputs balance.
    OpenAmplifier,
    /// An integrating amplifier: its state is limited.
    Integrator,
    /// A network without an amplifier: its output is limited only by its inputs.
    Passive,
}

/// How an output follows the main input.
///
/// It decides what the gain of a jack means, whether a pot in front may be set as a rate, and what the audit of
/// amplitude scaling can follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transfer {
    /// out = -gain x input.
    Inverting,
    /// d out / dt = -gain x input, with the gain per machine second.
    Integrating,
    /// out = setting x input.
    Share,
    /// Anything else; the audit does not follow it.
    Other,
}

/// An input of an element.
pub struct Input {
    /// Name of the jack. For inputs with gains it is the prefix: "x" for x1, x10 and so on.
    pub name: &'static str,
    /// How many cords it takes.
    pub jacks: Jacks,
    /// Whether something must be plugged in.
    pub required: bool,
    /// Whether the output depends on it in the same instant. Otherwise it acts through the memory only.
    pub direct: bool,
    /// Its purpose in a few words.
    pub description: &'static str,
}

/// The number of jacks of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Jacks {
    /// One jack for one cord.
    One,
    /// This number of equal jacks, each with one cord.
    Exactly(usize),
    /// Any number of equal jacks.
    Any,
    /// Summing jacks; the name of each gives its gain.
    Gains,
}

impl fmt::Debug for Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
    }
}

impl Input {
    /// A required input with one jack that acts in the same instant.
    pub const fn jack(name: &'static str, description: &'static str) -> Self {
        Input { name, jacks: Jacks::One, required: true, direct: true, description }
    }

    /// Required summing inputs with gains that act in the same instant.
    pub const fn gains(name: &'static str, description: &'static str) -> Self {
        Input { name, jacks: Jacks::Gains, required: true, direct: true, description }
    }

    /// The same input with other jacks.
    pub const fn jacks(self, jacks: Jacks) -> Self {
        Input { jacks, ..self }
    }

    /// The same input, acting through the element's memory only.
    pub const fn remembered(self) -> Self {
        Input { direct: false, ..self }
    }

    /// The same input, which may stay open.
    pub const fn open(self) -> Self {
        Input { required: false, ..self }
    }
}

impl Kind {
    /// Common values for networks without an amplifier.
    pub const NETWORK: Kind = Kind {
        name: "",
        family: Family::Computing,
        summary: "",
        law: "",
        overload: "no amplifier, so no overload",
        modes: "computes in every mode",
        source: "",
        symbol: "",
        inputs: &[],
        settings: &[],
        ordered: &[],
        bounded: &[],
        positions: &[],
        parts: &[],
        output: OutputStage::Passive,
        transfer: Transfer::Other,
        output_law: |builder| builder.constant(0.0),
        memory_law: None,
    };

    /// Common values for drives.
    pub const DRIVE: Kind = Kind {
        family: Family::Drive,
        overload: "its output amplifier is limited to ±100 V; the lamp lights if the demanded output exceeds this",
        modes: "has its value at t = 0 in initial condition; its time stops in hold",
        output: OutputStage::Amplifier,
        ..Kind::NETWORK
    };

    /// Common values for amplifiers that do not integrate.
    pub const AMPLIFIER: Kind = Kind {
        overload: "limited to ±100 V; the lamp lights if the demanded output exceeds this",
        output: OutputStage::Amplifier,
        ..Kind::NETWORK
    };

    /// The index of the input to which a jack belongs, and the gain of the jack (1 if its name has none).
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::elements::{Family, find};
    ///
    /// let summer = find(Family::Computing, "summer").expect("an element");
    /// assert_eq!(summer.input("x10"), Some((0, 10.0)));
    /// assert_eq!(summer.input("y"), None);
    /// ```
    pub fn input(&self, jack: &str) -> Option<(usize, f64)> {
        self.inputs.iter().enumerate().find_map(|(index, input)| match input.jacks {
            Jacks::Gains => gain_of(input.name, jack).map(|gain| (index, gain)),
            _ => (input.name == jack).then_some((index, 1.0)),
        })
    }

    /// The jack with a gain that was probably meant by a name that no jack has: "x10" for "X10" and for "10". `None` for
    /// other names.
    pub(crate) fn similar_jack(&self, written: &str) -> Option<String> {
        self.inputs.iter().find_map(|input| similar_jack(input, written))
    }

    /// The index of the setting with this name.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::elements::{Family, find};
    ///
    /// let integrator = find(Family::Computing, "integrator").expect("an element");
    /// assert_eq!(integrator.setting("initial"), Some(0));
    /// assert_eq!(integrator.setting("charge"), None);
    /// ```
    pub fn setting(&self, name: &str) -> Option<usize> {
        self.settings.iter().position(|setting| setting.name == name)
    }

    /// The input gains that a machine has for this kind, in ascending order. Empty if it has all gains.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::elements::{Family, find};
    /// use patchcord_core::machines;
    ///
    /// let machine = machines::find("solartron-1451").expect("a machine");
    /// let integrator = find(Family::Computing, "integrator").expect("an element");
    /// assert_eq!(integrator.available_gains(machine), [1.0, 10.0, 100.0, 1000.0]);
    /// ```
    pub fn available_gains(&self, machine: &MachineModel) -> &'static [f64] {
        match self.transfer {
            Transfer::Integrating => machine.integrator_gains,
            _ => machine.summer_gains,
        }
    }

    /// Whether its cords are in an object "in" of jacks with gains: `"in": {"x1": ["A1"], "x10": ["P2"]}`. Other kinds
    /// have a key for each input: `"in": "A1"`.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::elements::{Family, find};
    ///
    /// let has_gains = |name| find(Family::Computing, name).map(|kind| kind.has_gains());
    /// assert_eq!((has_gains("summer"), has_gains("pot")), (Some(true), Some(false)));
    /// ```
    pub fn has_gains(&self) -> bool {
        self.inputs.first().is_some_and(|main| main.jacks == Jacks::Gains)
    }
}

/// The jack with a gain that was probably meant at an input: the name was written in capitals, or as the gain alone.
fn similar_jack(input: &Input, written: &str) -> Option<String> {
    let lower_case = written.to_lowercase();
    let candidates = [lower_case.clone(), format!("{}{lower_case}", input.name)];
    candidates.into_iter().find(|jack| input.jacks == Jacks::Gains && gain_of(input.name, jack).is_some())
}

/// The gain in the name of a jack, for example 10 for "x10" and the prefix "x". `None` if the name is not the prefix
/// with a positive number.
fn gain_of(prefix: &str, jack: &str) -> Option<f64> {
    let digits = jack.strip_prefix(prefix)?;
    let plain = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    let gain: f64 = if plain { digits.parse().ok()? } else { return None };
    (gain > 0.0 && gain.is_finite()).then_some(gain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::find;

    #[test]
    fn gains_are_read_from_jack_names() {
        assert_eq!(gain_of("x", "x10"), Some(10.0));
        assert_eq!(gain_of("x", "x0.5"), Some(0.5));
        assert_eq!(gain_of("brake_x", "brake_x1000"), Some(1000.0));
        for wrong in ["x", "x0", "x-1", "x1e3", "y1", "xten", "x1.2.3", "brake_x1"] {
            assert_eq!(gain_of("x", wrong), None, "{wrong}");
        }
        assert_eq!(gain_of("x", &format!("x{}", "9".repeat(400))), None, "overflow");
    }

    #[test]
    fn a_jack_is_recognised_in_capitals_and_as_its_gain_alone() {
        let similar = |kind, written| find(Family::Computing, kind).unwrap().similar_jack(written);
        assert_eq!(similar("summer", "X10").as_deref(), Some("x10"));
        assert_eq!(similar("summer", "0.5").as_deref(), Some("x0.5"));
        assert_eq!(similar("integrator", "BRAKE_X1").as_deref(), Some("brake_x1"));
        for written in ["x", "A1", "min", ""] {
            assert_eq!(similar("integrator", written), None, "{written}");
        }
        assert_eq!(similar("pot", "10"), None);
    }
}
