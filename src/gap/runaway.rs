//! A patch that runs away from the data, as where a sign in one of its loops is wrong: what it lacks cannot be told from there.

use super::blind::over_sigma;
use super::fit::Task;
use super::model::ModelError;
use super::normal::Column;
use super::problem::Problem;
use super::stage::Stage;
use crate::instruments::number;

/// A patch runs away where what is changed at its beginning grows by more than this factor: that of three integrators in a row grows to
/// 256 times what it was after the first part of a record.
const GROWTH: f64 = 1e3;
/// Of so many parts of a record the first is where it begins.
const PARTS: usize = 16;

/// That a patch runs away from the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Runaway {
    /// The output.
    pub output: String,
    /// What is left of it, rms over its noise; more than it moves by.
    pub left: f64,
}

impl Runaway {
    /// The same in words.
    pub fn sentence(&self) -> String {
        format!(
            "the patch runs away: what is left of {}, {} times its noise, is more than that moves, and what little is changed where it begins grows more than a thousandfold: look at the signs in its loops, or write \"pieces\" where it is to run away",
            self.output,
            number(self.left)
        )
    }
}

impl Problem {
    /// That a stage runs away from an output of which it leaves more than that moves.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub(super) fn runs_away(&self, stage: &Stage) -> Result<Option<Runaway>, ModelError> {
        let left = |output: usize| over_sigma(&stage.train, output);
        let lost: Vec<usize> =
            (0..self.outputs.len()).filter(|output| left(*output) > self.moves(*output)).collect();
        if lost.is_empty() {
            return Ok(None);
        }
        let model = self.model(&stage.version, &self.train, &self.outputs)?;
        let task = self.task(&model, &self.train, false);
        let away = lost.into_iter().find(|output| grows(&task, stage, *output));
        Ok(away.map(|output| Runaway { output: self.outputs[output].clone(), left: left(output) }))
    }
}

/// Whether initial voltages matter ever more to an output.
fn grows(task: &Task<'_>, stage: &Stage, output: usize) -> bool {
    let at = task.shares(&stage.train.point);
    let Some(courses) = task.courses(std::slice::from_ref(&at)).pop().flatten() else { return false };
    let responses = |(record, course)| task.responses(&at, record, course).swap_remove(output);
    let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
    let grows = |(_, response): Column| {
        largest(&response) > GROWTH * largest(&response[..response.len().div_ceil(PARTS)])
    };
    courses.iter().enumerate().flat_map(responses).any(grows)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use serde_json::json;

    use super::*;
    use crate::gap::Experiment;
    use crate::patch::Edit;

    /// Whether the oscillator runs away from data in which nothing is hidden, with other wires.
    fn runs_away(edits: &[Edit]) -> bool {
        let path = Path::new("tests/gap/hidden/nothing/experiment.json");
        let mut experiment = Experiment::read(path).unwrap_or_else(|error| panic!("{error}"));
        experiment.patch = experiment.patch.edited("other.json", edits).unwrap();
        for record in experiment.train.iter_mut().chain(&mut experiment.test) {
            record.drives.iter_mut().chain(&mut record.outputs).for_each(|column| column.truncate(400));
        }
        let problem = Problem::of(&experiment).unwrap();
        let base = problem.base(&experiment.patch, &experiment.fit, 1).unwrap().unwrap();
        problem.runs_away(&base).unwrap().is_some()
    }

    #[test]
    fn a_wrong_sign_of_a_spring_is_told_and_no_spring_is_not() {
        let inverter = Edit::new("elements/BX", json!({"kind": "inverter", "in": "IX"}));
        assert!(runs_away(&[inverter, Edit::new("elements/PK/in", json!("BX"))]));
        assert!(!runs_away(&[Edit::new("elements/SF/in", json!({"x1": ["BF"], "x10": ["PC"]}))]));
        // Fitted, damping of the wrong sign comes to nothing.
        assert!(!runs_away(&[Edit::new("elements/PC/in", json!("IV"))]));
    }
}
