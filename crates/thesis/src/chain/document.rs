//! The circuit of Fig 8.16 as a patch document with the parameters of a slideway.
//!
//! All four scales are multiplied by one factor, so that no voltage exceeds 100 V. Gains and the settings for K, M
//! and f do not change with this factor.

use std::sync::LazyLock;

use serde_json::Value;

use super::error::{ChainError, RangeViolation};
use super::parameters::Parameters;
use super::ramp::Ramp;
use super::settings::Settings;
use super::simulation::{COMMAND, VELOCITY};
use patchcord_core::document::json_value;
use patchcord_core::patch::{Patch, PictureEntry};
use patchcord_expr::round_significant;

/// The shipped patch of Fig 8.16.
static FIG_8_16: LazyLock<Patch> = LazyLock::new(|| {
    let text = include_str!("../../../../patches/thesis/fig-8-16.json");
    Patch::parse("fig-8-16.json", text).expect("the circuit of the thesis is a document")
});

/// The factors by which the scales of Fig 8.16 (scale set B) may be multiplied, in ascending order. One factor
/// applies to all four scales, so every gain and the settings for K, M and f stay the same.
pub(super) const MULTIPLES: [f64; 8] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];

/// The names of the multiplied scales.
const SCALES: [&str; 4] = ["position", "force", "velocity", "acceleration"];

/// The parameters whose range is proportional to the scales.
const SCALED: [&str; 4] = ["Fs", "VcL", "v_start", "x_step"];

/// Maximum voltage of the velocity command in V. The rest of the 100 V is for the overshoot of velocity.
const MAX_COMMAND_VOLTS: f64 = 90.0;

/// The circuit of Fig 8.16, whose parameters a chain sets.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::chain::template;
///
/// assert_eq!(template().parameters["VcL"].unit.text(), "m/s");
/// ```
pub fn template() -> &'static Patch {
    &FIG_8_16
}

/// The value of a parameter in the thesis's circuit. NaN if there is no such parameter.
pub(super) fn default_of(template: &Patch, name: &str) -> f64 {
    template.parameters.get(name).map_or(f64::NAN, |parameter| parameter.value)
}

/// The quantity that one volt of a scale represents in the thesis's circuit, in SI units.
fn per_volt(template: &Patch, scale: &str) -> f64 {
    template.value()["scales"][scale]["per_volt"].as_f64().unwrap_or(f64::NAN)
}

/// The range of a parameter if the scales are multiplied by `multiple`.
fn range(template: &Patch, name: &str, multiple: f64) -> [f64; 2] {
    let range = template.parameters.get(name).and_then(|parameter| parameter.range);
    let (low, high) = range.unwrap_or((f64::MIN, f64::MAX));
    let factor = if SCALED.contains(&name) { multiple } else { 1.0 };
    [low, high].map(|end| rounded(end * factor))
}

/// The range of a parameter over all multiples of the scales.
fn widest_range(template: &Patch, name: &str) -> [f64; 2] {
    let [smallest, largest] =
        [MULTIPLES[0], MULTIPLES[MULTIPLES.len() - 1]].map(|multiple| range(template, name, multiple));
    [smallest[0].min(largest[0]), smallest[1].max(largest[1])]
}

/// A number as JSON, without a decimal point if it is whole.
fn json_number(value: f64) -> Value {
    const EXACT: f64 = 1e15;
    let is_whole = value.fract() == 0.0 && value.abs() < EXACT;
    if is_whole { (value as i64).into() } else { value.into() }
}

/// A number rounded to six significant digits. A potentiometer cannot be set more finely.
pub(super) fn rounded(value: f64) -> f64 {
    round_significant(value, 6)
}

/// The parameters, command and settings for which a patch is made.
#[derive(Debug, Clone, Copy)]
pub(super) struct PatchRequest<'a> {
    /// The thesis's circuit.
    pub template: &'a Patch,
    /// Title of the patch.
    pub title: &'a str,
    /// Parameters of the slideway.
    pub parameters: &'a Parameters,
    /// The velocity command.
    pub ramp: &'a Ramp,
    /// Settings of the run, and the parameters that they set.
    pub settings: &'a Settings,
}

impl PatchRequest<'_> {
    /// The smallest scales with which no value is too large, as an index into [`MULTIPLES`].
    pub(super) fn first_scale(&self) -> usize {
        let velocity = per_volt(self.template, "velocity");
        let is_sufficient = |multiple: &f64| {
            let fits = self.ramp.top() <= MAX_COMMAND_VOLTS * velocity * multiple;
            fits && self.values().all(|(name, value)| value <= range(self.template, name, *multiple)[1])
        };
        MULTIPLES.iter().position(is_sufficient).unwrap_or(MULTIPLES.len() - 1)
    }

    /// The patch with scales that are `multiple` times those of Fig 8.16. Everything else in the document keeps its
    /// text.
    ///
    /// # Errors
    /// If a value is out of its range with these scales.
    pub(super) fn patch(&self, multiple: f64) -> Result<Patch, ChainError> {
        self.check(multiple)?;
        let mut editor = self.template.edit();
        editor.set_title(self.title);
        editor.set_source(&format!("Thesis Fig 8.16; scale set B times {multiple}"));
        editor.put(["run"], self.run());
        editor.put(["pictures"], pictures());
        for scale in SCALES {
            let enlarged = rounded(per_volt(self.template, scale) * multiple);
            editor.put(["scales", scale, "per_volt"], json_number(enlarged));
        }
        for (name, value) in self.values() {
            let range = range(self.template, name, multiple).map(json_number);
            editor.put(["parameters", name, "value"], json_number(value));
            editor.put(["parameters", name, "range"], range);
        }
        Ok(editor.finish("slideway.json")?)
    }

    /// Checks that every value is within the range of the circuit, and within the range that these scales permit.
    ///
    /// # Errors
    /// If a value is outside one of these ranges.
    pub(super) fn check(&self, multiple: f64) -> Result<(), ChainError> {
        if let Some(violation) = self.range_violation(|name| widest_range(self.template, name)) {
            return Err(ChainError::OutsideCircuitRange(violation));
        }
        match self.range_violation(|name| range(self.template, name, multiple)) {
            Some(violation) => Err(ChainError::OutsideScaleRange { violation, multiple }),
            None => Ok(()),
        }
    }

    /// The first parameter whose value is outside the bounds of its name.
    fn range_violation(&self, bounds: impl Fn(&str) -> [f64; 2]) -> Option<RangeViolation> {
        let is_within = |name: &str, value: f64| (bounds(name)[0]..=bounds(name)[1]).contains(&value);
        let (name, value) = self.values().find(|(name, value)| !is_within(name, *value))?;
        let unit = self.template.parameters.get(name).map_or("", |parameter| parameter.unit.text());
        Some(RangeViolation { name: name.to_owned(), value, unit: unit.to_owned(), bounds: bounds(name) })
    }

    /// Names and values of all parameters of the circuit. A value comes from the slideway, the command, the settings
    /// or the template, in this order of precedence.
    fn values(&self) -> impl Iterator<Item = (&str, f64)> {
        let of_slideway = self.parameters.named();
        self.template.parameters.keys().map(move |name| {
            let parameter = of_slideway.iter().find(|(parameter, _)| parameter == name);
            let turn = (name == "v_turn").then_some(self.ramp.turn);
            let setting = || self.settings.value(name).unwrap_or_else(|| default_of(self.template, name));
            (name.as_str(), parameter.map(|(_, value)| *value).or(turn).unwrap_or_else(setting))
        })
    }

    /// The "run" section of the patch.
    fn run(&self) -> Value {
        let mut run = self.template.value()["run"].clone();
        run["for"] = json_number(self.ramp.duration());
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

/// The pictures of a patch: the velocity profile, and the loops of spring force against velocity.
fn pictures() -> Value {
    let pictures = [
        PictureEntry::new("System velocity profile", COMMAND, [VELOCITY]).with_own_ranges(),
        PictureEntry::new("Error force against output velocity", VELOCITY, ["spring_force"]),
    ];
    json_value(&pictures)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn template_has_every_scale_and_parameter_that_is_changed() {
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
