//! The valve machine of the thesis: Solartron 1451.
//!
//! Its gains are powers of ten, which the input resistors of the amplifiers give. Every other factor needs a
//! potentiometer in front of an input. It has no relays, delay lines or function generators.

use super::{MachineModel, Part};

/// Solartron 1451, as listed in section 8.1 of the thesis.
pub(super) static MACHINE: MachineModel = MachineModel {
    name: "solartron-1451",
    title: "Solartron 1451: valve amplifiers, chopper stabilised, ±100 V",
    source: "thesis, section 8.1",
    inventory: Some(&[
        (Part::Summer, 16),
        (Part::Integrator, 8),
        (Part::FixedPot, 12),
        (Part::FreePot, 6),
        (Part::DiodePair, 4),
        (Part::Multiplier, 2),
    ]),
    summer_gains: &[1.0, 10.0],
    integrator_gains: &[1.0, 10.0, 100.0, 1000.0],
};
