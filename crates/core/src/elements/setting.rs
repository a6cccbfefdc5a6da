//! What can be set on an element, and what its values measure.

use crate::machines::REFERENCE;

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

/// Up to here every whole number is a number of the machine that runs this.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// What rounding may add to a fraction.
const ROUNDING: f64 = 1e-12;

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
}
