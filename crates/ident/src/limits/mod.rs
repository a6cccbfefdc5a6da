//! The weakest effects that data would have shown.
//!
//! An effect of some strength is run beside the patch as it was fitted. What it changes in the outputs, less all that parameters,
//! initial voltages and offsets follow when they are fitted again (to first order), is what the search has to find it by: as
//! much as its score asks for in training, and as its confirmation asks for in the data that are held back. What would show so is
//! fitted in full: parameters may follow further than to first order.

mod cleared;
mod ground;
mod half;
mod tried;

use serde_json::{Value, json};

use self::ground::Ground;
use super::attached::Attached;
use super::candidate::Candidate;
use super::effect::Library;
use super::model::ModelError;
use super::parameter_values::ParameterValues;
use super::problem::Problem;
use super::round::{Bar, LeftOut, Round};
use super::search::Means;
use super::stage::{Stage, Untried, Version};
use patchcord_analysis::instruments::number;
use patchcord_analysis::{pool, spare};
use patchcord_core::document::behind;
use patchcord_core::patch::Patch;

/// The weakest effect of a kind, at a place, that data would have shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// Name of the effect.
    pub effect: String,
    /// The element that it acts on.
    pub junction: String,
    /// What it reads beside it, where there is a choice.
    pub reads: Vec<String>,
    /// The parameter that says how strong it is.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// Its value from which on the effect would have been seen; nothing where none in its range would.
    pub value: Option<f64>,
    /// The same as a share of the way from no effect to the end of the range: what limits are compared by.
    pub share: f64,
    /// What other parameters were taken to be there.
    pub beside: ParameterValues,
}

/// What data could show beside a patch, before anything is sought in them.
#[derive(Debug, Clone)]
pub struct Visible {
    /// What the patch as fitted leaves, rms over the noise.
    pub leaves: f64,
    /// The weakest effects that would show if it left but noise, those that show best first.
    pub limits: Vec<Limit>,
    /// What cannot be tried.
    pub left_out: Vec<LeftOut>,
}

impl Problem {
    /// The weakest effects that would have been seen of all that a round tried, those that show best first, worked out on so
    /// many threads.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub fn limits(&self, round: &Round, threads: usize) -> Result<Vec<Limit>, ModelError> {
        let tried: Vec<_> =
            round.trials.iter().map(|trial| (&trial.candidate, &trial.stage.version)).collect();
        self.weakest(&round.before, round.bar(), &tried, threads)
    }

    /// What the data could show of the effects of a library beside a patch, once it is fitted; nothing where it can be run from none
    /// of the points tried.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records at all.
    pub fn visible(
        &self,
        patch: &Patch,
        fit: &[String],
        with: &Means<'_>,
    ) -> Result<Option<Visible>, ModelError> {
        spare::with_threads(with.threads, || {
            let Some(base) = self.base(patch, fit, with.seed)? else { return Ok(None) };
            self.visible_beside(&base, with).map(Some)
        })
    }

    fn visible_beside(&self, base: &Stage, with: &Means<'_>) -> Result<Visible, ModelError> {
        let (sites, peaks) = (self.sites(base)?, self.peaks(base)?);
        let (mut wired, mut left_out) = (Vec::new(), Vec::new());
        for attached in with.library.iter().flat_map(|effect| Attached::all(effect, &sites)) {
            match self.wired(base, &attached, &peaks).and_then(|own| self.if_runs(own)) {
                Ok(own) => wired.push(own),
                Err(why) => left_out.push(LeftOut::of(&attached, &why)),
            }
        }
        let wired: Vec<_> = wired.iter().map(|(candidate, version)| (candidate, version)).collect();
        let limits = self.weakest(base, Bar::of_noise(wired.len()), &wired, with.threads)?;
        Ok(Visible { leaves: base.train.over_noise(), limits, left_out })
    }

    /// What is wired, if it can be run beside the records.
    fn if_runs(&self, own: (Candidate, Version)) -> Result<(Candidate, Version), Untried> {
        self.model(&own.1, &self.train, &self.outputs)?;
        Ok(own)
    }

    fn weakest(
        &self,
        before: &Stage,
        bar: Bar,
        tried: &[(&Candidate, &Version)],
        threads: usize,
    ) -> Result<Vec<Limit>, ModelError> {
        let mut grounds: Vec<(u32, Ground<'_>)> = Vec::new();
        for (_, version) in tried {
            let steps = version.steps;
            if grounds.iter().all(|own| own.0 != steps) {
                grounds.extend(Ground::of(self, before, bar, steps)?.map(|ground| (steps, ground)));
            }
        }
        let of = |(candidate, version): &(&Candidate, &Version)| {
            let ground = grounds.iter().find(|own| own.0 == version.steps);
            ground.map(|(_, ground)| ground.limit(candidate, version)).transpose()
        };
        let found = pool::each(tried, threads, of, |_| ());
        let found: Vec<Option<Limit>> = found.into_iter().collect::<Result<_, _>>()?;
        let mut limits: Vec<Limit> = Vec::new();
        for limit in found.into_iter().flatten() {
            match limits.iter_mut().find(|own| own.is_of(&limit)) {
                Some(own) if limit.share < own.share => *own = limit,
                Some(_) => (),
                None => limits.push(limit),
            }
        }
        limits.sort_by(|a, b| {
            a.share.total_cmp(&b.share).then_with(|| (&a.effect, &a.junction).cmp(&(&b.effect, &b.junction)))
        });
        Ok(limits)
    }
}

impl Limit {
    /// Whether both are of the same effect, place and parameter.
    fn is_of(&self, other: &Limit) -> bool {
        let is_there = self.junction == other.junction && self.reads == other.reads;
        is_there && self.effect == other.effect && self.parameter == other.parameter
    }

    /// The same in words; nothing where the data could not show the effect at all.
    pub fn sentence(&self) -> Option<String> {
        let told = self.told()?;
        Some(format!("the weakest {} that would have shown has {} = {told}", self.named(), self.parameter))
    }

    /// The effect and where it acts.
    pub fn named(&self) -> String {
        format!("{} at {}", self.effect, self.junction)
    }

    /// Its value with its unit.
    pub fn told(&self) -> Option<String> {
        self.value.map(|value| format!("{}{}", number(value), behind(&self.unit)))
    }

    /// What data must hold for the effect to be judged, behind a semicolon; nothing where the library does not have it.
    pub fn needs(&self, library: &Library) -> String {
        let effect = library.get(&self.effect);
        effect.map(|own| format!("; needs: {}", own.excitation)).unwrap_or_default()
    }

    /// Whether the data could show the effect at all.
    pub fn is_seen(&self) -> bool {
        self.value.is_some()
    }

    /// The same as a JSON document.
    pub fn document(&self) -> Value {
        let mut document = json!({
            "name": self.effect, "junction": self.junction, "reads": self.reads,
            "parameter": self.parameter, "seen": self.is_seen(),
        });
        if let Some(value) = self.value {
            document["value"] = json!(value);
            document["unit"] = json!(self.unit);
            document["with"] = self.beside.document().into();
        }
        document
    }
}

/// The best place of every effect, those that show best first.
pub fn best_places(limits: &[Limit]) -> Vec<&Limit> {
    let mut best: Vec<&Limit> = Vec::new();
    for limit in limits {
        if best.iter().all(|own| own.effect != limit.effect) {
            best.push(limit);
        }
    }
    best
}
