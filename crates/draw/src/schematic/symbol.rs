//! What is drawn of a circuit, before it has a place: symbols and what is plugged into them.

use patchcord_analysis::instruments::Display;

/// An element, a drive, an instance of a macro or a port of one, as a drawing shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Symbol {
    /// Name of the element.
    pub name: String,
    /// Its kind, such as "summer", or the name of the macro.
    pub kind: String,
    /// Name of its symbol, such as "amplifier".
    pub shape: &'static str,
    /// What is plugged into it, from the top down.
    pub jacks: Vec<Jack>,
    /// How it is set, defaults included.
    pub settings: Vec<Setting>,
    /// Names of the machine's parts that it is made of, where the patch lists them.
    pub parts: Vec<String>,
    /// Its outputs, from the top down: one, or the output ports of an instance.
    pub outlets: Vec<Outlet>,
    /// The position that it has switched to, where voltages are drawn.
    pub position: Option<&'static str>,
    /// Names of the signals that are read inside it, where nothing comes out.
    pub inside: Vec<String>,
    /// The patch's note on it.
    pub note: String,
}

/// An output of a symbol.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outlet {
    /// Name of the port; empty where there is one output only.
    pub port: String,
    /// Names of the signals that are read at it.
    pub signals: Vec<String>,
    /// Voltage at it, where voltages are drawn.
    pub volts: Option<f64>,
}

/// How an element stands at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standing {
    /// The voltage at its output.
    pub volts: f64,
    /// The position that it has switched to, such as "pulled-in"; nothing where it has none.
    pub position: Option<&'static str>,
}

/// A jack of a symbol with a cord in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Jack {
    /// Name of the input, such as "x" or "bias_plus", or of the input port of an instance.
    pub input: String,
    /// Its gain, where jacks of the input have gains.
    pub gain: Option<f64>,
    /// What is plugged in.
    pub from: Source,
}

/// Where a cord comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// An output of a symbol, by the indices of the symbol and of the outlet.
    Output(usize, usize),
    /// A reference, drawn where it is needed.
    Reference(&'static str),
}

/// A setting of an element.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Its key in the document.
    pub name: String,
    /// Its formula, where the patch gives one.
    pub formula: Option<String>,
    /// Its value.
    pub value: Value,
    /// The value with its unit, in few digits.
    pub shown: String,
    /// Whether the patch gives it; else it is preset.
    pub is_given: bool,
}

/// The value of a setting.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number in the unit of the setting.
    Number(f64),
    /// true or false.
    Flag(bool),
    /// One of the setting's words.
    Word(&'static str),
    /// Points of a curve.
    Points(Vec<[f64; 2]>),
}

impl Symbol {
    /// How a setting is set; nothing where the element does without it.
    pub fn setting(&self, name: &str) -> Option<&Setting> {
        self.settings.iter().find(|setting| setting.name == name)
    }

    /// A setting that is a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.setting(name)?.value {
            Value::Number(value) => Some(value),
            _ => None,
        }
    }

    /// Whether a flag is set.
    pub fn flag(&self, name: &str) -> bool {
        self.setting(name).is_some_and(|setting| setting.value == Value::Flag(true))
    }

    /// The word chosen for a setting.
    pub fn word(&self, name: &str) -> &'static str {
        match self.setting(name).map(|setting| &setting.value) {
            Some(Value::Word(word)) => word,
            _ => "",
        }
    }

    /// The points of a curve.
    pub fn points(&self, name: &str) -> &[[f64; 2]] {
        match self.setting(name).map(|setting| &setting.value) {
            Some(Value::Points(points)) => points,
            _ => &[],
        }
    }
}

/// A share, as a potentiometer is set: four decimals, and four digits where it is small.
pub fn share(value: f64) -> String {
    match value.abs() {
        small if small > 0.0 && small < 1e-4 => digits(value),
        small if small > 0.0 && small < 0.01 => format!("{:0<6}", digits(value)),
        _ => format!("{value:.4}").replace('-', "−"),
    }
}

/// A value with its unit, as far as that goes in a prefix that keeps it short.
pub fn quantity(unit: &str, value: f64) -> String {
    Display::new(unit, value).text(value).replace('-', "−")
}

/// A voltage with its unit; what is too small for a voltmeter's scale in thousandths or millionths.
pub fn volts(value: f64) -> String {
    match value.abs() {
        small if small > 0.0 && small < 1e-3 => quantity("V", value),
        _ => format!("{} V", digits(value)),
    }
}

/// A number in four digits.
pub fn digits(value: f64) -> String {
    let magnitude = value.abs();
    if value != 0.0 && !(1e-4..1e5).contains(&magnitude) {
        let text = format!("{value:.3e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
        return format!("{mantissa}e{exponent}").replace('-', "−");
    }
    let decimals = if value == 0.0 { 0.0 } else { 3.0 - magnitude.log10().floor() };
    short(value, decimals.max(0.0) as usize)
}

/// A number with at most so many decimals.
fn short(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let shown = [0.0, 0.25, 1.0, -50.0, 12.345_67, 99.996, 2e5, -0.1, 1234.5].map(digits);
        assert_eq!(shown, ["0", "0.25", "1", "−50", "12.35", "100", "2e5", "−0.1", "1234"]);
        let shown = [0.0, 0.25, 0.004, 0.002_345_6, 1.0, 0.123_456, 4e-7, 1.234_56e-5].map(share);
        assert_eq!(shown, ["0.0000", "0.2500", "0.0040", "0.002346", "1.0000", "0.1235", "4e−7", "1.235e−5"]);
        assert_eq!(quantity("m/s", -0.5), "−500 mm/s");
        let shown = [0.0, -50.0, 0.001, 1e-6, -2.5e-4].map(volts);
        assert_eq!(shown, ["0 V", "−50 V", "0.001 V", "1 µV", "−250 µV"]);
    }
}
