//! The builders of scales and signals.

use serde_json::{Map, Value};

/// Builds a scale for [`PatchBuilder::put_scale`](super::PatchBuilder::put_scale).
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::{PatchBuilder, ScaleBuilder};
///
/// let scale = ScaleBuilder::new(0.5, "mm").description("position of the mass");
/// let patch = PatchBuilder::new("spring").put_scale("x", scale).build()?;
/// assert!(patch.text().contains("position of the mass"));
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ScaleBuilder {
    /// The JSON object of the scale.
    entry: Map<String, Value>,
}

impl ScaleBuilder {
    /// Begins a scale with the value of one volt, as a number in `unit` or as a formula.
    pub fn new(per_volt: impl Into<Value>, unit: &str) -> Self {
        let mut entry = Map::new();
        entry.insert("per_volt".into(), per_volt.into());
        entry.insert("unit".into(), unit.into());
        ScaleBuilder { entry }
    }

    /// Sets the description.
    pub fn description(mut self, description: &str) -> Self {
        self.entry.insert("description".into(), description.into());
        self
    }

    /// The JSON object of the document.
    pub(super) fn into_value(self) -> Value {
        Value::Object(self.entry)
    }
}

/// Builds a signal for [`PatchBuilder::put_signal`](super::PatchBuilder::put_signal).
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder, SignalBuilder};
///
/// let patch = PatchBuilder::new("ramp")
///     .scale("speed", 0.5, "m/s")
///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["+100"]))
///     .put_signal("v", SignalBuilder::new("A1").scale("speed").factor(-1.0))
///     .build()?;
/// assert_eq!(patch.signals["v"].factor, -1.0);
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
#[derive(Debug, Clone)]
pub struct SignalBuilder {
    /// The JSON object of the signal.
    entry: Map<String, Value>,
}

impl SignalBuilder {
    /// Begins a signal in volts at the output of an element or a drive.
    pub fn new(element: &str) -> Self {
        let mut entry = Map::new();
        entry.insert("at".into(), element.into());
        SignalBuilder { entry }
    }

    /// Sets the scale.
    pub fn scale(mut self, scale: &str) -> Self {
        self.entry.insert("scale".into(), scale.into());
        self
    }

    /// Sets the factor by which the scaled voltage is multiplied. It must not be 0.
    pub fn factor(mut self, factor: impl Into<Value>) -> Self {
        self.entry.insert("factor".into(), factor.into());
        self
    }

    /// Sets the description.
    pub fn description(mut self, description: &str) -> Self {
        self.entry.insert("description".into(), description.into());
        self
    }

    /// The JSON object of the document.
    pub(super) fn into_value(self) -> Value {
        Value::Object(self.entry)
    }
}
