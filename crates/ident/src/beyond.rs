//! Values beyond the ranges that a patch was fitted in: they may be all that it lacks.

use serde_json::{Value, json};

use super::model::ModelError;
use super::problem::Problem;
use super::round::APART;
use super::score::advantage;
use super::search::Verdict;
use super::stage::{Stage, Version};
use patchcord_analysis::instruments::number;
use patchcord_core::patch::Edit;

/// So many times as far from zero a range goes, or so much nearer, where a patch stood at its end.
const WIDER: f64 = 10.0;

/// A patch fitted with wider ranges where it stood at their ends.
#[derive(Debug, Clone)]
pub struct Beyond {
    /// Where it came to.
    pub stage: Stage,
    /// The places of what lies beyond its range now.
    pub(super) places: Vec<usize>,
    /// Whether the data cannot tell it from the patch with what is named.
    pub is_rival: bool,
}

impl Beyond {
    /// What lies beyond its range, and where, in words.
    pub fn told(&self) -> String {
        let told = self.places.iter().map(|place| self.stage.value_told(*place));
        format!("{}, beyond {}", told.collect::<Vec<_>>().join(" and "), self.ranges())
    }

    /// What the patch alone would come to there, in a sentence.
    pub fn sentence(&self) -> String {
        let [train, test] = [&self.stage.train, &self.stage.test].map(|own| number(own.over_noise()));
        format!(
            "The patch as it was asks for {}; so it alone would leave {train} times the noise in training and {test} in the test.",
            self.told()
        )
    }

    /// What the data say when it is weighed against what they seemed to: it may be what is missing, and is what is not.
    pub(super) fn weighed(&self, verdict: Verdict) -> Verdict {
        match verdict {
            Verdict::Named if self.is_rival => Verdict::Ambiguous,
            Verdict::UnknownEffect if self.leaves_noise() => Verdict::CannotJudge,
            own => own,
        }
    }

    /// Whether it leaves nothing but noise.
    pub(super) fn leaves_noise(&self) -> bool {
        !self.stage.leaves_structure()
    }

    fn ranges(&self) -> &'static str {
        if self.places.len() == 1 { "its range" } else { "their ranges" }
    }

    /// The same as a JSON document.
    pub fn document(&self) -> Value {
        let value = |place: &usize| {
            let name = &self.stage.version.fit[*place];
            json!({"name": name, "value": self.stage.train.point.knobs[*place], "unit": self.stage.unit(*place)})
        };
        json!({
            "parameters": self.places.iter().map(value).collect::<Vec<_>>(),
            "leaves": {"train": self.stage.train.over_noise(), "test": self.stage.test.over_noise()},
            "is_rival": self.is_rival,
        })
    }
}

impl Problem {
    /// Where a patch that leaves a gap comes to beyond the ends of ranges at which it stands; nothing where there is none or it
    /// stays. `last` is the patch with what is named.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub(super) fn beyond(&self, base: &Stage, last: &Stage) -> Result<Option<Beyond>, ModelError> {
        let was: Vec<Option<(f64, f64)>> = base.version.ranges().collect();
        let widened = base.at_end().filter_map(|place| {
            let (low, high) = wider(was[place]?, base.train.point.knobs[place]);
            let path = ["parameters", &base.version.fit[place], "range"].map(str::to_owned).to_vec();
            (was[place] != Some((low, high))).then(|| Edit { path, value: json!([low, high]) })
        });
        let widened: Vec<Edit> = widened.collect();
        if widened.is_empty() || !base.leaves_structure() {
            return Ok(None);
        }
        let patch = base.version.patch.edited(base.version.patch.file(), &widened)?;
        let version = Version { patch, ..base.version.clone() };
        let Some(stage) = self.again(base, version, base.train.point.clone())? else { return Ok(None) };
        let places: Vec<usize> = stage.beyond_of(&was).collect();
        let behind = advantage(&stage.train, &last.train).and(advantage(&stage.test, &last.test));
        let is_rival = behind.ratio() < APART;
        Ok((!places.is_empty()).then_some(Beyond { stage, places, is_rival }))
    }
}

/// A range that goes on where a value stands at its end; nature changes no signs.
fn wider((low, high): (f64, f64), value: f64) -> (f64, f64) {
    let on = |end: f64, is_outward: bool| if is_outward { end * WIDER } else { end / WIDER };
    match value - low < high - value {
        true => (on(low, low < 0.0), high),
        false => (low, on(high, high > 0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_go_on_where_a_value_stands_but_not_through_zero() {
        assert_eq!(wider((1.0, 8.0), 8.0), (1.0, 80.0));
        assert_eq!(wider((1.0, 8.0), 1.0), (0.1, 8.0));
        assert_eq!(wider((-3.0, -2.0), -3.0), (-30.0, -2.0));
        assert_eq!(wider((-3.0, -2.0), -2.0), (-3.0, -0.2));
        assert_eq!(wider((0.0, 5.0), 0.0), (0.0, 5.0));
    }
}
