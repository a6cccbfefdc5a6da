//! The fixed voltages of the machine: +100 V, -100 V and signal ground.

use super::{Family, Kind, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::REFERENCE as VOLTS;

/// The names of the references in cords, and their voltages.
///
/// # Examples
///
/// ```
/// use patchcord_core::elements::REFERENCES;
///
/// assert!(REFERENCES.contains(&("+100", 100.0)));
/// ```
pub const REFERENCES: &[(&str, f64)] = &[("+100", VOLTS), ("-100", -VOLTS), ("ground", 0.0)];

/// The fixed references as one kind of element, with the voltage as its setting.
pub static REFERENCE: Kind = Kind {
    name: "reference",
    family: Family::Reference,
    summary: "fixed voltage of the machine",
    law: "out = volts",
    source: "thesis 8.1",
    symbol: "reference",
    settings: &[Setting::required("volts", SettingQuantity::Volts, "voltage of the reference")],
    output_law,
    ..Kind::NETWORK
};

/// out = volts. The settings of the three references are fixed numbers.
fn output_law(builder: &mut dyn Builder) -> Register {
    builder.get("volts")
}
