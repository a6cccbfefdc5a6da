//! What an experiment may tell wrongly: the sign of an output, its unit, the unit of time. A patch that explains the data once that
//! is told otherwise lacks no effect.

use super::blind::over_sigma;
use super::model::ModelError;
use super::problem::Problem;
use super::record::Record;
use super::stage::Stage;
use crate::instruments::number;
use crate::patch::Patch;

/// Something is told wrongly where told otherwise it leaves no more than such a share of the gap, in rms.
const FAR_LESS: f64 = 0.2;
/// Units are in question where of an output more is left than this share of how far it moves, in rms.
const HARDLY: f64 = 0.5;
/// What prefixes of units differ by.
const THOUSAND: f64 = 1e3;

/// What may be told otherwise.
#[derive(Debug, Clone, PartialEq)]
pub enum Otherwise {
    /// These outputs are so many times what is told; -1 where they are turned round.
    Outputs(Vec<String>, f64),
    /// All times are a thousandth of what is told.
    Times,
}

impl Otherwise {
    fn told(&self) -> String {
        match self {
            Otherwise::Outputs(names, -1.0) => format!("{} turned round", names.join(", ")),
            Otherwise::Outputs(names, factor) if *factor > 1.0 => {
                format!("a thousand times {}", names.join(", "))
            }
            Otherwise::Outputs(names, _) => format!("a thousandth of {}", names.join(", ")),
            Otherwise::Times => "a thousandth of all times".to_owned(),
        }
    }

    /// Where to look.
    fn advice(&self) -> &'static str {
        match self {
            Otherwise::Outputs(_, -1.0) => "look at the signs of signal, column and drives",
            Otherwise::Outputs(..) => {
                "look at the units of columns and drives, which are those of the signals where no \"unit\" is told"
            }
            Otherwise::Times => "look at the unit of \"time\", which is s where none is told",
        }
    }
}

/// What a patch explains that does not explain what is told.
#[derive(Debug, Clone, PartialEq)]
pub struct Mistold {
    /// What is told otherwise then.
    pub otherwise: Otherwise,
    /// What the patch leaves of all outputs as they are told and otherwise, rms over the noise.
    pub leaves: [f64; 2],
}

impl Mistold {
    /// The same in words.
    pub fn sentence(&self) -> String {
        let ([before, after], told) = (self.leaves.map(number), self.otherwise.told());
        let advice = self.otherwise.advice();
        format!("with {told} the patch leaves {after} times the noise, and {before} as it is: {advice}")
    }
}

impl Problem {
    /// What is told wrongly, where a patch far from the data explains them told otherwise: one output turned round, or all, as where a
    /// drive is the wrong way round; and where it hardly explains what moves, those in other units, or all times.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub(super) fn mistold(
        &self,
        base: &Stage,
        patch: &Patch,
        fit: &[String],
        seed: u64,
    ) -> Result<Option<Mistold>, ModelError> {
        if !base.is_far() {
            return Ok(None);
        }
        let mut all = self.scaled_by(-1.0);
        if self.hardly_explained(base) {
            all.extend([THOUSAND.recip(), THOUSAND].into_iter().flat_map(|factor| self.scaled_by(factor)));
            all.push(Otherwise::Times);
        }
        for otherwise in all {
            let stage = self.told_otherwise(&otherwise, patch, fit)?.base(patch, fit, seed)?;
            if let Some(stage) = stage.filter(|own| own.gap() < FAR_LESS * base.gap()) {
                let leaves = [base, &stage].map(|own| own.train.over_noise());
                return Ok(Some(Mistold { otherwise, leaves }));
            }
        }
        Ok(None)
    }

    /// Every output so many times what is told, and all together.
    fn scaled_by(&self, factor: f64) -> Vec<Otherwise> {
        let alone = self.outputs.iter().map(|own| vec![own.clone()]);
        let together = (self.outputs.len() > 1).then(|| self.outputs.clone());
        alone.chain(together).map(|names| Otherwise::Outputs(names, factor)).collect()
    }

    /// Whether a stage leaves more than half of how far an output moves.
    fn hardly_explained(&self, stage: &Stage) -> bool {
        (0..self.outputs.len()).any(|output| over_sigma(&stage.train, output) > HARDLY * self.moves(output))
    }

    fn told_otherwise(
        &self,
        otherwise: &Otherwise,
        patch: &Patch,
        fit: &[String],
    ) -> Result<Problem, ModelError> {
        match otherwise {
            Otherwise::Outputs(names, factor) => {
                let factors = self.outputs.iter().map(|own| if names.contains(own) { *factor } else { 1.0 });
                Ok(self.with_outputs(&factors.collect::<Vec<_>>()))
            }
            Otherwise::Times => {
                let mut own = self.with_records(|record| {
                    for time in [&mut record.begin, &mut record.since, &mut record.interval] {
                        *time /= THOUSAND;
                    }
                });
                own.steps = own.steps(patch, fit)?;
                Ok(own)
            }
        }
    }

    /// The same with so many times each output, and its noise.
    fn with_outputs(&self, factors: &[f64]) -> Problem {
        let with = self.with_records(|record| {
            for (output, factor) in record.outputs.iter_mut().zip(factors) {
                output.iter_mut().for_each(|value| *value *= factor);
            }
        });
        let sigma = self.sigma.iter().zip(factors).map(|(own, factor)| own * factor.abs());
        Problem { sigma: sigma.collect(), ..with }
    }

    /// The same with every record changed.
    fn with_records(&self, change: impl Fn(&mut Record)) -> Problem {
        let mut own = self.clone();
        own.train.iter_mut().chain(&mut own.pieces).chain(&mut own.test).for_each(change);
        own
    }
}
