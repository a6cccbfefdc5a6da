//! A machine with as much of everything as a patch wants.

use super::Machine;

/// The roomy machine: ±100 V like the others, any gain, any number of parts.
pub static MACHINE: Machine = Machine {
    name: "unlimited",
    title: "as many parts and gains as the patch asks for, ±100 V",
    source: "none: for study, not a machine that was built",
    inventory: None,
    summer_gains: &[],
    integrator_gains: &[],
};
