//! The settings of elements: name, unit, default and range.

use crate::machines::REFERENCE;

/// A setting of an element.
pub struct Setting {
    /// Key in the document. A dot means a nested object: "limit.upper".
    pub name: &'static str,
    /// The quantity that it specifies, which also decides the unit.
    pub quantity: SettingQuantity,
    /// Its value if the patch omits it.
    pub default: SettingDefault,
    /// Least and largest permitted value, in its unit.
    pub range: (f64, f64),
    /// Its effect in a few words.
    pub description: &'static str,
}

/// The quantity that a setting specifies.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SettingQuantity {
    /// A potentiometer setting: a pure number from 0 to 1. In front of an integrator it can be a rate.
    Fraction,
    /// A pure number.
    Ratio,
    /// A whole number that is not negative.
    Whole,
    /// A voltage of the machine, in volts.
    Volts,
    /// A time in machine seconds.
    MachineSeconds,
    /// A time in problem seconds (drives only).
    Seconds,
    /// A frequency in cycles per problem second (drives only). A formula in rad/s or rpm is converted.
    Hertz,
    /// An angle in radians (drives only).
    Radians,
    /// Radians per volt of the machine.
    RadiansPerVolt,
    /// A value in the unit of the drive's scale.
    Signal,
    /// A rate in the unit of the drive's scale per problem second.
    SignalRate,
    /// True or false.
    Flag,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A list of points [problem seconds, value in the unit of the drive's scale].
    Points,
    /// A list of points [volts in, volts out]. The setting with this name, which must come first, says how it is
    /// mirrored.
    Curve(&'static str),
}

/// The value of a setting if the patch omits it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SettingDefault {
    /// The patch must specify it.
    Required,
    /// This number. For a flag, 0 is false and anything else true. For a choice, it is the index of the word.
    Number(f64),
    /// The element works without it.
    Absent,
}

/// 2^53: up to here every whole number is exact in a double.
const MAX_WHOLE: f64 = 9_007_199_254_740_992.0;

/// Margin for rounding at the ends of a fraction's range.
const FRACTION_TOLERANCE: f64 = 1e-12;

impl SettingQuantity {
    /// The widest range that a value of this quantity can have.
    const fn widest(self) -> (f64, f64) {
        match self {
            SettingQuantity::Fraction | SettingQuantity::Flag => (0.0, 1.0),
            SettingQuantity::Volts | SettingQuantity::Curve(_) => (-REFERENCE, REFERENCE),
            SettingQuantity::Whole => (0.0, MAX_WHOLE),
            SettingQuantity::MachineSeconds | SettingQuantity::Seconds | SettingQuantity::Hertz => {
                (0.0, f64::MAX)
            }
            _ => (f64::MIN, f64::MAX),
        }
    }

    /// The unit of a number alone, or the form of the value, in words.
    pub(crate) const fn unit(self) -> &'static str {
        match self {
            SettingQuantity::Fraction | SettingQuantity::Ratio => "1",
            SettingQuantity::Whole => "whole number",
            SettingQuantity::Volts => "V",
            SettingQuantity::MachineSeconds => "machine s",
            SettingQuantity::Seconds => "s",
            SettingQuantity::Hertz => "Hz",
            SettingQuantity::Radians => "rad",
            SettingQuantity::RadiansPerVolt => "rad/V",
            SettingQuantity::Signal => "unit of the scale",
            SettingQuantity::SignalRate => "unit of the scale per s",
            SettingQuantity::Flag => "true or false",
            SettingQuantity::Choice(_) => "a word",
            SettingQuantity::Points => "[s, unit of the scale]",
            SettingQuantity::Curve(_) => "[V, V]",
        }
    }
}

impl Setting {
    /// The forward drop that all elements with diodes have.
    pub const DIODE_DROP: Setting =
        Setting::preset("drop", SettingQuantity::Volts, 0.0, "forward drop of the diodes").within(0.0, 10.0);

    /// A setting that the patch must specify, with the widest range of its quantity.
    pub const fn required(name: &'static str, quantity: SettingQuantity, description: &'static str) -> Self {
        Setting { name, quantity, default: SettingDefault::Required, range: quantity.widest(), description }
    }

    /// A setting with a default value, with the widest range of its quantity.
    pub const fn preset(
        name: &'static str,
        quantity: SettingQuantity,
        value: f64,
        description: &'static str,
    ) -> Self {
        Setting {
            name,
            quantity,
            default: SettingDefault::Number(value),
            range: quantity.widest(),
            description,
        }
    }

    /// A setting that the patch may omit and that then has no value.
    pub const fn optional(name: &'static str, quantity: SettingQuantity, description: &'static str) -> Self {
        Setting { name, quantity, default: SettingDefault::Absent, range: quantity.widest(), description }
    }

    /// The same setting with a narrower range.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::elements::{Setting, SettingQuantity};
    ///
    /// let width = Setting::required("width", SettingQuantity::Volts, "width of the zone").within(0.0, 10.0);
    /// assert_eq!(width.range, (0.0, 10.0));
    /// assert!(!width.is_allowed(-1.0));
    /// ```
    pub const fn within(self, low: f64, high: f64) -> Self {
        Setting { range: (low, high), ..self }
    }

    /// The range for the coefficient in the program. A drive's value is converted to volts and can have either sign.
    pub fn coefficient_range(&self) -> (f64, f64) {
        match self.quantity {
            SettingQuantity::Signal | SettingQuantity::SignalRate => (f64::MIN, f64::MAX),
            _ => self.allowed_range(),
        }
    }

    /// The range for a computed value. A fraction may exceed its range by rounding: a pot at "0.1 * 3 / 0.3" is not
    /// exactly 1.
    fn allowed_range(&self) -> (f64, f64) {
        let slack = if self.quantity == SettingQuantity::Fraction { FRACTION_TOLERANCE } else { 0.0 };
        (self.range.0 - slack, self.range.1 + slack)
    }

    /// Whether a value is permitted.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::elements::{Setting, SettingQuantity};
    ///
    /// let setting = Setting::required("setting", SettingQuantity::Fraction, "position of the wiper");
    /// assert!(setting.is_allowed(0.5) && !setting.is_allowed(1.5));
    /// assert_eq!(setting.unit(), "1");
    /// ```
    pub fn is_allowed(&self, value: f64) -> bool {
        let (low, high) = self.allowed_range();
        (low..=high).contains(&value)
    }

    /// The unit in which the patch specifies the setting.
    pub fn unit(&self) -> &'static str {
        self.quantity.unit()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pot_may_exceed_1_by_rounding() {
        let setting = Setting::required("setting", SettingQuantity::Fraction, "");
        assert!([0.0, 0.5, 1.0, 0.1 * 3.0 / 0.3, -1e-13].iter().all(|value| setting.is_allowed(*value)));
        assert!([1.0 + 1e-9, -1e-9, f64::NAN].iter().all(|value| !setting.is_allowed(*value)));
        let drop = Setting::DIODE_DROP;
        assert!(drop.is_allowed(10.0) && !drop.is_allowed(10.0 + 1e-13));
    }
}
