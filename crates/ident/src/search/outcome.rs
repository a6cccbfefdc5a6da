//! What came of a search.

use crate::design::detectability::detection_limit::Limit;
use crate::design::discriminating_experiment::Separating;
use crate::effects::candidate::Candidate;
use crate::effects::places::Places;
use crate::fit::fitted_model::Stage;
use crate::fit::overload::RecordOverload;
use crate::fit::starts::Agreement;
use crate::fit::step_size::Fineness;
use crate::localise::force::Whereabouts;
use crate::residuals::correlation::Correlation;
use crate::search::inconclusive::Blind;
use crate::search::range_extension::Beyond;
use crate::search::round::Round;
use crate::search::search_log::Change;
use crate::search::verdict::Verdict;

/// What came of a search.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What was found out.
    pub verdict: Verdict,
    /// The patch as it was, fitted.
    pub base: Stage,
    /// Whether fits from elsewhere come to the same.
    pub agreement: Agreement,
    /// What was tried, one effect after the other.
    pub rounds: Vec<Round>,
    /// What was taken in the first of these rounds.
    pub effects: Vec<Candidate>,
    /// Which amplifier of the patch that is told of is overloaded first, if one is.
    pub overload: Option<RecordOverload>,
    /// How it came there, change by change.
    pub way: Vec<Change>,
    /// The patch with all that was taken, fitted.
    pub last: Stage,
    /// The share of the gap that is left, in rms.
    pub left: f64,
    /// What the residuals of the patch as it was go with.
    pub correlations: Vec<Correlation>,
    /// Where and when something is missing in the patch as it was; of no junction where nothing is.
    pub whereabouts: Vec<Whereabouts>,
    /// The weakest effects that the first round would have found, where nothing was taken.
    pub limits: Vec<Limit>,
    /// Where the patch as it was comes to beyond its ranges, if it stands at their ends and leaves a gap.
    pub beyond: Option<Beyond>,
    /// Why the data cannot judge, where they cannot.
    pub blind: Option<Blind>,
    /// The experiment that would tell two effects apart, where the data cannot.
    pub separating: Option<Separating>,
    /// Where the patch as it was has room for effects; empty where none was tried.
    pub places: Places,
    /// How finely the patch that is told of was run.
    pub fineness: Fineness,
}

impl Outcome {
    /// The stage that is told of: the last one where something is named, else the patch as it was.
    pub fn told(&self) -> &Stage {
        if self.verdict.has_names() { &self.last } else { &self.base }
    }

    /// The force that closes the gap best, where something is missing that has no name.
    pub(crate) fn unnamed(&self) -> Option<&Whereabouts> {
        self.whereabouts.first().filter(|_| self.verdict == Verdict::UnknownEffect)
    }

    /// Whether more is left than a law of another shape mostly leaves, and that is no noise.
    pub fn leaves_much(&self) -> bool {
        leaves_much(&self.last, self.left)
    }
}

/// If named effects leave structure, and more than this share of the gap in rms, they may explain only in part what is no effect of
/// the library.
const CLEAR: f64 = 0.1;

/// The rounds that took something.
pub(crate) fn taken(rounds: &[Round]) -> impl Iterator<Item = &Round> + Clone {
    rounds.iter().filter(|round| round.taken)
}

/// Whether a stage leaves structure, and such a share of the gap that this is no small matter.
pub(crate) fn leaves_much(stage: &Stage, left: f64) -> bool {
    stage.leaves_structure() && left > CLEAR
}

impl Outcome {
    /// Whether the way led through more than one change of the patch as it was: what its rounds alone do not tell.
    pub fn has_a_way(&self) -> bool {
        self.way.len() > 2
    }
}
