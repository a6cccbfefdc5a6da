//! The symbols of a drawing before layout, with their jacks and settings, and the format of numbers.

use patchcord_analysis::format::QuantityFormat;

/// The symbol of an element, a drive, a macro instance or a port.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_draw::schematic::Schematic;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let patch = PatchBuilder::new("Decay")
///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50))
///     .element("P1", ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.5))
///     .run(1.0, 1e-3)
///     .build()?;
/// let diagram = Schematic::new(&Circuit::new(&patch)?, "", "", &|_| None)?.main;
///
/// let pot = &diagram.symbols[1].symbol;
/// assert_eq!((pot.kind.as_str(), pot.number("setting")), ("pot", Some(0.5)));
/// assert_eq!(pot.setting("setting").map(|setting| setting.shown.as_str()), Some("0.5000"));
/// assert_eq!(pot.number("gain"), None);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Symbol {
    /// The name of the element.
    pub name: String,
    /// The kind of the element, such as "summer", or the name of the macro.
    pub kind: String,
    /// The name of the shape, such as "amplifier".
    pub shape: &'static str,
    /// The input jacks with cords, from the top down.
    pub jacks: Vec<Jack>,
    /// The settings, including defaults.
    pub settings: Vec<SymbolSetting>,
    /// The names of the machine parts, if the patch specifies them.
    pub parts: Vec<String>,
    /// The outputs, from the top down: one, or the output ports of an instance.
    pub outputs: Vec<SymbolOutput>,
    /// The switching position, if voltages are drawn.
    pub position: Option<&'static str>,
    /// The names of signals at elements inside an instance that are not among its outputs.
    pub inside: Vec<String>,
    /// The note in the patch; may be empty.
    pub note: String,
}

/// An output of a symbol.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SymbolOutput {
    /// The name of the output port; empty if there is one output only.
    pub port: String,
    /// The names of the signals at the output.
    pub signals: Vec<String>,
    /// The voltage; `None` if voltages are not drawn.
    pub volts: Option<f64>,
}

/// The state of an element at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementState {
    /// The voltage at the output.
    pub volts: f64,
    /// The switching position, such as "pulled-in"; `None` if the element does not switch.
    pub position: Option<&'static str>,
}

/// A jack of a symbol with a cord in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Jack {
    /// The name of the input, such as "x" or "bias_plus", or of the input port of an instance.
    pub input: String,
    /// The gain; `None` if the jacks of the input have no gains.
    pub gain: Option<f64>,
    /// The source of the cord.
    pub from: CordSource,
}

/// The source of a cord.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CordSource {
    /// An output of a symbol: the indices of the symbol and of the output.
    Output(usize, usize),
    /// A reference. It is drawn at each jack that uses it.
    Reference(&'static str),
}

/// A setting of an element.
#[derive(Debug, Clone, PartialEq)]
pub struct SymbolSetting {
    /// The key in the patch file.
    pub name: String,
    /// The formula; `None` if the patch specifies a number.
    pub formula: Option<String>,
    /// The value.
    pub value: SettingValue,
    /// The value with its unit, rounded to four digits.
    pub shown: String,
    /// Whether the patch specifies the setting; otherwise it is the default.
    pub is_given: bool,
}

/// The value of a setting.
#[derive(Debug, Clone, PartialEq)]
pub enum SettingValue {
    /// A number in the unit of the setting.
    Number(f64),
    /// A flag.
    Flag(bool),
    /// One of the choices of the setting.
    Word(&'static str),
    /// The points of a curve.
    Points(Vec<[f64; 2]>),
}

impl Symbol {
    /// Returns a setting; `None` if the element has no value for it.
    pub fn setting(&self, name: &str) -> Option<&SymbolSetting> {
        self.settings.iter().find(|setting| setting.name == name)
    }

    /// Returns the value of a numeric setting; `None` if it is absent or not a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.setting(name)?.value {
            SettingValue::Number(value) => Some(value),
            _ => None,
        }
    }

    /// Whether a flag is set; false if it is absent.
    pub fn flag(&self, name: &str) -> bool {
        self.setting(name).is_some_and(|setting| setting.value == SettingValue::Flag(true))
    }

    /// Returns the choice of a setting; empty if it is absent.
    pub fn word(&self, name: &str) -> &'static str {
        match self.setting(name).map(|setting| &setting.value) {
            Some(SettingValue::Word(word)) => word,
            _ => "",
        }
    }

    /// Returns the points of a curve; empty if the setting is absent.
    pub fn points(&self, name: &str) -> &[[f64; 2]] {
        match self.setting(name).map(|setting| &setting.value) {
            Some(SettingValue::Points(points)) => points,
            _ => &[],
        }
    }
}

/// Formats a fraction such as the setting of a potentiometer.
///
/// The text has four decimals, or four significant digits if the value is below 0.01.
///
/// Examples: 0.25 gives `0.2500`, and 0.001 gives `0.0010`.
pub fn format_fraction(value: f64) -> String {
    match value.abs() {
        small if small > 0.0 && small < 1e-4 => format_number(value),
        small if small > 0.0 && small < 0.01 => format!("{:0<6}", format_number(value)),
        _ => format!("{value:.4}").replace('-', "−"),
    }
}

/// Formats a value with its unit; the prefix of the unit is chosen so that the text is short.
pub fn format_quantity(unit: &str, value: f64) -> String {
    QuantityFormat::new(unit, value).text(value).replace('-', "−")
}

/// Formats a voltage with its unit; below 1 mV the unit has a prefix.
///
/// Examples: 12.5 gives `12.5 V`, and 2e-4 gives `200 µV`.
pub fn format_volts(value: f64) -> String {
    match value.abs() {
        small if small > 0.0 && small < 1e-3 => format_quantity("V", value),
        _ => format!("{} V", format_number(value)),
    }
}

/// Formats a number with four significant digits: `12.35`, `2e5`, `1.235e−5`.
pub fn format_number(value: f64) -> String {
    let magnitude = value.abs();
    if value != 0.0 && !(1e-4..1e5).contains(&magnitude) {
        let text = format!("{value:.3e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
        return format!("{mantissa}e{exponent}").replace('-', "−");
    }
    let decimals = if value == 0.0 { 0.0 } else { 3.0 - magnitude.log10().floor() };
    format_decimals(value, decimals.max(0.0) as usize)
}

/// Formats a number with at most this many decimals; trailing zeros are omitted.
fn format_decimals(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let shown = [0.0, 0.25, 1.0, -50.0, 12.345_67, 99.996, 2e5, -0.1, 1234.5].map(format_number);
        assert_eq!(shown, ["0", "0.25", "1", "−50", "12.35", "100", "2e5", "−0.1", "1234"]);
        let shown = [0.0, 0.25, 0.004, 0.002_345_6, 1.0, 0.123_456, 4e-7, 1.234_56e-5].map(format_fraction);
        assert_eq!(shown, ["0.0000", "0.2500", "0.0040", "0.002346", "1.0000", "0.1235", "4e−7", "1.235e−5"]);
        assert_eq!(format_quantity("m/s", -0.5), "−500 mm/s");
        let shown = [0.0, -50.0, 0.001, 1e-6, -2.5e-4].map(format_volts);
        assert_eq!(shown, ["0 V", "−50 V", "0.001 V", "1 µV", "−250 µV"]);
    }
}
