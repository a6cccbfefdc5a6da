//! Other units and other values of scales, and no time scale.

use patchcord_expr::Unit;
use serde_json::{Value, json};

use super::super::change::{Change, Setting};
use super::super::formula::Product;
use super::super::influence::Part;
use super::{Candidates, cost};

/// Prefixes of units that are often wrong.
const PREFIXES: [char; 3] = ['m', 'k', 'u'];
/// Powers of ten by which a prefix changes a unit.
const PREFIX_POWERS: [f64; 4] = [1e3, 1e-3, 1e6, 1e-6];
/// Powers of ten by which the value of a scale is often wrong, most often by a wrong prefix.
const SCALE_POWERS: [f64; 8] = [1e3, 1e-3, 10.0, 0.1, 100.0, 0.01, 1e6, 1e-6];
/// Deviation of a ratio from a power of ten by rounding.
const ROUNDING: f64 = 1e-9;

impl Candidates<'_, '_> {
    /// The changes of scales and of the time scale.
    pub(super) fn scales(&mut self, factors: &[f64]) {
        let patch = self.panel.circuit.patch();
        for (name, scale) in &patch.scales {
            let unit = scale.unit.text();
            self.units(name, &scale.unit);
            self.per_volt(name, unit, &patch.value()["scales"][name]["per_volt"], factors);
        }
        if patch.time_scale != 1.0 {
            let description = "set time_scale to 1".to_owned();
            let path = vec!["time_scale".to_owned()];
            let setting = Setting { path, value: json!(1), description, part: Part::All };
            self.push(cost::TIME_SCALE, Change::Set(setting));
        }
    }

    /// Other values of a scale: powers of ten times the present one, and those that correct a factor of a term. A term
    /// can contain the scale or its square.
    fn per_volt(&mut self, name: &str, unit: &str, present: &Value, factors: &[f64]) {
        let Some(product) = Product::new(present) else { return };
        let powers = SCALE_POWERS.into_iter().map(|factor| {
            let is_prefix = [1e3, 1e-3].contains(&factor);
            (if is_prefix { cost::SCALE } else { cost::SCALE + cost::FITTING }, factor)
        });
        let found =
            factors.iter().flat_map(|factor| [*factor, factor.recip(), factor.sqrt(), factor.sqrt().recip()]);
        let found = found.map(|factor| (cost::SCALE_FACTOR, factor));
        for (cost, factor) in powers.chain(found.filter(|_| product.is_literal())) {
            let value = product.times(factor).value();
            let description = format!("let 1 V of the scale {name} be {value} {unit}");
            self.scale(cost, name, "per_volt", value, description);
        }
    }

    /// The unit of a scale with another prefix. A prefix that another scale has too is likelier.
    fn units(&mut self, name: &str, unit: &Unit) {
        let patch = self.panel.circuit.patch();
        let others: Vec<&str> = patch
            .scales
            .iter()
            .filter(|(other, _)| *other != name)
            .map(|(_, scale)| scale.unit.text())
            .collect();
        let text = unit.text();
        let prefixed = PREFIXES.map(|prefix| format!("{prefix}{text}"));
        let stripped = text.strip_prefix(PREFIXES).map(str::to_owned);
        for other in prefixed.into_iter().chain(stripped) {
            if !is_other_prefix(unit, &other) {
                continue;
            }
            let beginning = |text: &str| text.chars().take(2).collect::<String>();
            let is_common = others.iter().any(|text| beginning(text) == beginning(&other));
            let cost = if is_common { cost::UNIT - cost::FITTING } else { cost::UNIT };
            let description = format!("give the scale {name} the unit {other}");
            self.scale(cost, name, "unit", json!(other), description);
        }
    }

    /// Adds another value of a key of a scale.
    fn scale(&mut self, cost: u32, name: &str, key: &str, value: Value, description: String) {
        let path = ["scales", name, key].map(str::to_owned).to_vec();
        self.push(cost, Change::Set(Setting { path, value, description, part: Part::All }));
    }
}

/// Whether a text is the same unit with another prefix.
fn is_other_prefix(unit: &Unit, text: &str) -> bool {
    Unit::parse(text).is_ok_and(|other| {
        let ratio = other.factor() / unit.factor();
        let is_prefix = PREFIX_POWERS.iter().any(|power| (ratio / power - 1.0).abs() < ROUNDING);
        is_prefix && other.dimension() == unit.dimension()
    })
}
