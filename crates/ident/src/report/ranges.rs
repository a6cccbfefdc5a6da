//! Values beyond their ranges, in words and as a document.

use serde_json::{Value, json};

use crate::search::range_extension::Beyond;
use patchcord_analysis::instruments::number;

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
