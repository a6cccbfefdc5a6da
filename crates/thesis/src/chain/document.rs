//! The circuit of Fig 8.16 as a document, with a slideway's parameters, and with scales that leave room for it.

use std::sync::LazyLock;

use serde_json::{Value, json};

use super::error::{Beyond, ChainError};
use super::parameters::Parameters;
use super::ramp::Ramp;
use super::settings::Settings;
use patchcord_core::patch::Patch;

static FIG_8_16: LazyLock<Patch> = LazyLock::new(|| {
    let text = include_str!("../../../../patches/thesis/fig-8-16.json");
    Patch::parse("fig-8-16.json", text).expect("the circuit of the study is a document")
});

/// By how much the scales of Fig 8.16, scale set B, may be multiplied: all four together, which leaves every gain and the settings for K,
/// M and f as they are.
pub(super) const MULTIPLES: [f64; 8] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];

/// The scales that are multiplied.
const SCALES: [&str; 4] = ["position", "force", "velocity", "acceleration"];

/// The parameters whose range goes with the scales.
const SCALED: [&str; 4] = ["Fs", "VcL", "v_start", "x_step"];

/// What of 100 V the command may take: velocity overshoots it.
const ROOM: f64 = 90.0;

/// The study's circuit.
pub(super) fn template() -> &'static Patch {
    &FIG_8_16
}

/// The value that a parameter has there.
pub(super) fn default_of(template: &Patch, name: &str) -> f64 {
    template.parameters.get(name).map_or(f64::NAN, |parameter| parameter.value)
}

/// What a volt of a scale stands for there.
fn per_volt(template: &Patch, scale: &str) -> f64 {
    template.value()["scales"][scale]["per_volt"].as_f64().unwrap_or(f64::NAN)
}

/// The range of a parameter with scales so many times as large.
fn range(template: &Patch, name: &str, multiple: f64) -> [f64; 2] {
    let range = template.parameters.get(name).and_then(|parameter| parameter.range);
    let (low, high) = range.unwrap_or((f64::MIN, f64::MAX));
    let factor = if SCALED.contains(&name) { multiple } else { 1.0 };
    [low, high].map(|end| rounded(end * factor))
}

/// From the least to the largest value that it may have, whatever the scales.
fn widest_range(template: &Patch, name: &str) -> [f64; 2] {
    let [least, most] =
        [MULTIPLES[0], MULTIPLES[MULTIPLES.len() - 1]].map(|multiple| range(template, name, multiple));
    [least[0].min(most[0]), least[1].max(most[1])]
}

/// A number as a person would write it: a whole one without a point.
fn written(value: f64) -> Value {
    const EXACT: f64 = 1e15;
    let is_whole = value.fract() == 0.0 && value.abs() < EXACT;
    if is_whole { (value as i64).into() } else { value.into() }
}

/// A number to six digits, which is more than a potentiometer can be set to.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// What is asked of the circuit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked<'a> {
    pub template: &'a Patch,
    pub title: &'a str,
    pub parameters: &'a Parameters,
    pub ramp: &'a Ramp,
    pub settings: &'a Settings,
}

impl Asked<'_> {
    /// The smallest scales of which no value is too large, as a place among the multiples.
    pub fn first_scale(&self) -> usize {
        let velocity = per_volt(self.template, "velocity");
        let takes = |multiple: &f64| {
            let fits = self.ramp.top() <= ROOM * velocity * multiple;
            fits && self.values().all(|(name, value)| value <= range(self.template, name, *multiple)[1])
        };
        MULTIPLES.iter().position(takes).unwrap_or(MULTIPLES.len() - 1)
    }

    /// The patch with scales so many times those of Fig 8.16; the rest of it is as it was written.
    ///
    /// # Errors
    /// Where a value is out of its range then.
    pub fn patch(&self, multiple: f64) -> Result<Patch, ChainError> {
        self.check(multiple)?;
        let mut editor = self.template.edit();
        editor.set_title(self.title);
        editor.set_source(&format!("Thesis Fig 8.16; scale set B times {multiple}"));
        editor.put(&["run"], self.run());
        editor.put(&["pictures"], pictures());
        for scale in SCALES {
            let enlarged = rounded(per_volt(self.template, scale) * multiple);
            editor.put(&["scales", scale, "per_volt"], written(enlarged));
        }
        for (name, value) in self.values() {
            let range = range(self.template, name, multiple).map(written);
            editor.put(&["parameters", name, "value"], written(value));
            editor.put(&["parameters", name, "range"], json!(range));
        }
        Ok(editor.finish("slideway.json")?)
    }

    /// That every value is one that the circuit takes, and one that it takes with these scales.
    ///
    /// # Errors
    /// Where one is not.
    pub fn check(&self, multiple: f64) -> Result<(), ChainError> {
        if let Some(beyond) = self.outside(|name| widest_range(self.template, name)) {
            return Err(ChainError::BeyondCircuit(beyond));
        }
        match self.outside(|name| range(self.template, name, multiple)) {
            Some(beyond) => Err(ChainError::BeyondScales { beyond, multiple }),
            None => Ok(()),
        }
    }

    /// A value that lies outside of the bounds of its name.
    fn outside(&self, bounds: impl Fn(&str) -> [f64; 2]) -> Option<Beyond> {
        let is_within = |name: &str, value: f64| (bounds(name)[0]..=bounds(name)[1]).contains(&value);
        let (name, value) = self.values().find(|(name, value)| !is_within(name, *value))?;
        let unit = self.template.parameters.get(name).map_or("", |parameter| parameter.unit.text());
        Some(Beyond { name: name.to_owned(), value, unit: unit.to_owned(), bounds: bounds(name) })
    }

    /// Names and values of all parameters.
    fn values(&self) -> impl Iterator<Item = (&str, f64)> {
        let own = self.parameters.named();
        self.template.parameters.keys().map(move |name| {
            let own = own.iter().find(|(own, _)| own == name).map(|(_, value)| *value);
            let turn = (name == "v_turn").then_some(self.ramp.turn);
            let set = || self.settings.value(name).unwrap_or_else(|| default_of(self.template, name));
            (name.as_str(), own.or(turn).unwrap_or_else(set))
        })
    }

    /// How the patch is to be run.
    fn run(&self) -> Value {
        let mut run = self.template.value()["run"].clone();
        run["for"] = written(self.ramp.duration());
        let Settings { step, tolerance, every, .. } = *self.settings;
        if let (Some(tolerance), Value::Object(run)) = (tolerance, &mut run) {
            run.remove("step");
            run.insert("tolerance".to_owned(), tolerance.into());
        }
        for (key, value) in [("step", step), ("every", every)] {
            if let Some(value) = value {
                run[key] = value.into();
            }
        }
        run
    }
}

fn pictures() -> Value {
    json!([
        {"title": "System velocity profile", "x": "v_i", "y": ["v_o"]},
        {"title": "Error force against output velocity", "x": "v_o", "y": ["spring_force"]},
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_circuit_of_the_study_has_what_is_changed_in_it() {
        let template = template();
        assert_eq!(default_of(template, "v_rate"), 1.2e-3);
        for name in SCALES {
            assert!(per_volt(template, name) > 0.0, "{name}");
        }
        for name in SCALED {
            assert_eq!(range(template, name, 2.0)[1], 2.0 * range(template, name, 1.0)[1], "{name}");
        }
        assert_eq!(range(template, "K", 2.0), [5e6, 178e6]);
    }
}
