//! Whether something was measured, or wired, the wrong way round: a patch that explains the opposite of an output lacks no effect.

use super::model::ModelError;
use super::problem::Problem;
use super::record::Record;
use super::stage::Stage;
use crate::instruments::number;
use crate::patch::Patch;

/// An output is the wrong way round where turned it leaves no more than such a share of the gap, in rms.
const FAR_LESS: f64 = 0.2;

/// Outputs whose opposite a patch explains.
#[derive(Debug, Clone, PartialEq)]
pub struct Turned {
    /// Their names.
    pub outputs: Vec<String>,
    /// What the patch leaves of all outputs with these as they are and turned, rms over the noise.
    pub leaves: [f64; 2],
}

impl Turned {
    /// The same in words.
    pub fn sentence(&self) -> String {
        let [before, after] = self.leaves.map(number);
        format!(
            "with {} turned round the patch leaves {after} times the noise, and {before} as it is: look at the signs of signal, column and drives",
            self.outputs.join(", ")
        )
    }
}

impl Problem {
    /// The outputs whose opposite a patch explains that does not explain them: one, or all where a drive is the wrong way round.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub(super) fn turned(
        &self,
        base: &Stage,
        patch: &Patch,
        fit: &[String],
        seed: u64,
    ) -> Result<Option<Turned>, ModelError> {
        if !base.is_far() {
            return Ok(None);
        }
        let all: Vec<usize> = (0..self.outputs.len()).collect();
        let alone = all.iter().map(|place| vec![*place]);
        let together = (all.len() > 1).then(|| all.clone());
        for places in alone.chain(together) {
            let turned = self.with_turned(&places).base(patch, fit, seed)?;
            if let Some(stage) = turned.filter(|own| own.gap() < FAR_LESS * base.gap()) {
                let outputs = places.iter().map(|place| self.outputs[*place].clone()).collect();
                let leaves = [base, &stage].map(|own| own.train.over_noise());
                return Ok(Some(Turned { outputs, leaves }));
            }
        }
        Ok(None)
    }

    /// The same with the opposite of some outputs.
    fn with_turned(&self, places: &[usize]) -> Problem {
        let turned = |records: &[Record]| -> Vec<Record> {
            let turned = |record: &Record| {
                let mut own = record.clone();
                places
                    .iter()
                    .for_each(|place| own.outputs[*place].iter_mut().for_each(|value| *value = -*value));
                own
            };
            records.iter().map(turned).collect()
        };
        Problem {
            train: turned(&self.train),
            pieces: turned(&self.pieces),
            test: turned(&self.test),
            ..self.clone()
        }
    }
}
