//! The symbols of a drawing before layout, with their jacks and settings.

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
    /// The voltage in volts of the machine; `None` if voltages are not drawn.
    pub volts: Option<f64>,
}

/// The state of an element at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementState {
    /// The voltage at the output, in volts of the machine.
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
#[non_exhaustive]
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
