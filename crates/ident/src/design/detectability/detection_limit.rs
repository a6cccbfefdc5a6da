//! The detection limit of an effect at a site, and the limits of a whole library.

use crate::fit::extended_model::SkippedTrial;
use crate::fit::parameter_values::ParameterValues;
use crate::fit::step_size::StepRefinement;

/// The smallest strength of an effect at a site that would be detected in given data.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DetectionLimit {
    /// Name of the effect.
    pub effect: String,
    /// The element that it acts on.
    pub site: String,
    /// The signals that the effect reads, if there is a choice.
    pub reads: Vec<String>,
    /// The parameter that is the strength of the effect.
    pub parameter: String,
    /// Unit of the strength.
    pub unit: String,
    /// The smallest strength that would be detected. None if no strength in its range would be.
    pub value: Option<f64>,
    /// The same as a fraction of the way from no effect to the end of the range. It is infinite without a `value`.
    pub range_fraction: f64,
    /// Values of the effect's other parameters at the limit. Empty without a `value`.
    pub other_parameters: ParameterValues,
}

/// The effects of a library that data can show, before any search.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Detectability {
    /// Rms residual of the fitted patch in training, over the noise.
    pub residual_rms: f64,
    /// The number of solver steps of the fitted patch, and the solver's error.
    pub step_refinement: StepRefinement,
    /// The detection limits if the residual were only noise, the most detectable effect first.
    pub limits: Vec<DetectionLimit>,
    /// Effects that cannot be tried at a site, with the reason.
    pub skipped: Vec<SkippedTrial>,
}

impl DetectionLimit {
    /// Whether both limits are for the same effect, site and parameter. Their forms may differ.
    pub(crate) fn is_same_case(&self, other: &DetectionLimit) -> bool {
        let is_same_site = self.site == other.site && self.reads == other.reads;
        is_same_site && self.effect == other.effect && self.parameter == other.parameter
    }

    /// Whether some strength of the effect would be detected.
    pub fn is_detectable(&self) -> bool {
        self.value.is_some()
    }
}

/// The first limit of every effect, in the order of `limits`. If these are sorted, it is the site at which the
/// effect is most detectable.
pub fn best_sites(limits: &[DetectionLimit]) -> Vec<&DetectionLimit> {
    let mut best: Vec<&DetectionLimit> = Vec::new();
    for limit in limits {
        if best.iter().all(|other| other.effect != limit.effect) {
            best.push(limit);
        }
    }
    best
}
