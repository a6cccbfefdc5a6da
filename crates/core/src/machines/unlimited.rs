//! A machine without limits on parts and gains, for study.
//!
//! Patches use it by default. It differs from the other machines only in the checks of parts and gains: voltages and
//! laws are the same.

use super::MachineModel;

/// The unlimited machine: ±100 V like the others, any gain, any number of parts.
pub(super) static MACHINE: MachineModel = MachineModel {
    name: "unlimited",
    title: "as many parts and gains as the patch asks for, ±100 V",
    source: "none: for study, not a machine that was built",
    inventory: None,
    summer_gains: &[],
    integrator_gains: &[],
};
