//! The seven design rules of section 9.5 that lower the critical velocity, each tested by a run.
//!
//! A rule changes one quantity of the design. A run gives the new critical velocity, which is compared with that of the
//! unchanged design at three thresholds.

use super::error::ChainError;
use super::parameters::Parameters;
use super::predictions::{Prediction, stability};
use super::settings::Settings;
use super::simulation::Simulation;
use crate::slideway::design::{Design, DesignEquation};
use patchcord_analysis::instruments::{CriticalVelocity, CriticalVelocityError, REST_WINDOWS};
use patchcord_analysis::parallel;

/// A design rule of section 9.5 and the result of its test.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// Letter of the rule in section 9.5, 'a' to 'g'.
    pub letter: char,
    /// The change of the design, in words.
    pub text: &'static str,
    /// The changed quantity.
    pub quantity: &'static str,
    /// The factor by which the quantity is multiplied.
    pub factor: f64,
    /// The critical velocity after the change, or the reason why the run failed.
    pub outcome: Result<AdviceOutcome, String>,
    /// Whether the run confirms it.
    pub verdict: AdviceVerdict,
}

/// The results of the chain after a change.
#[derive(Debug, Clone, PartialEq)]
pub struct AdviceOutcome {
    /// The parameters of the circuit after the change.
    pub parameters: Parameters,
    /// The critical velocity that was read from the run, in m/s.
    pub critical: CriticalVelocity,
    /// The critical velocity with half the threshold and with twice the threshold.
    pub nearby_thresholds: [CriticalVelocity; 2],
    /// The critical velocity by eq 93-9 as printed.
    pub printed: Prediction,
    /// The critical velocity by Routh-Hurwitz.
    pub stability: Prediction,
}

/// Whether the runs confirm that a rule lowers the critical velocity.
///
/// The critical velocity of the rising command is compared with the threshold, with half of it and with twice of it.
/// Only those thresholds count at which the unchanged design oscillates. The rule must hold at all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum AdviceVerdict {
    /// The critical velocity falls by more than the resolution, or oscillation disappears. If oscillation of the
    /// unchanged design has not ended, the command at which it last may have been at rest counts as its critical
    /// velocity.
    Confirmed,
    /// The critical velocity does not fall, or not at every threshold.
    NotConfirmed,
    /// The critical velocity changes by less than the resolution.
    TooClose,
    /// The unchanged design does not oscillate.
    NothingToLower,
    /// The unchanged design rings as it breaks away, and does not oscillate later.
    RingingOnly,
    /// The parameters that the rule would change are set by the user, so nothing changes.
    NothingChanged,
    /// Oscillation has not ended at the turn of the command, so either critical velocity may be the lower one.
    NotRead,
    /// The command is too fast for a reading at half the threshold.
    TooFast,
    /// The run failed.
    NotRun,
}

impl AdviceVerdict {
    /// The verdict in words, as reports and JSON have it.
    pub fn as_str(self) -> &'static str {
        match self {
            AdviceVerdict::Confirmed => "confirmed",
            AdviceVerdict::NotConfirmed => "not confirmed by the run",
            AdviceVerdict::TooClose => "not confirmed by the run: too close",
            AdviceVerdict::NothingToLower => "nothing to lower",
            AdviceVerdict::NothingChanged => "nothing changes: it is set",
            AdviceVerdict::RingingOnly => "nothing to lower: it only rings",
            AdviceVerdict::NotRead => "cannot be read: it oscillates on where the command turns back",
            AdviceVerdict::TooFast => "cannot be read: the command is too fast for half the threshold",
            AdviceVerdict::NotRun => "could not be run",
        }
    }
}

/// A design rule before its test.
struct Rule {
    /// Letter of the rule in section 9.5.
    letter: char,
    /// The change of the design, in words.
    text: &'static str,
    /// The changed quantity.
    quantity: &'static str,
    /// Whether the quantity is increased.
    rises: bool,
    /// Multiplies the quantity of a design by a factor.
    change: fn(&mut Design, f64),
}

/// The rules of section 9.5, in the order a to g.
const RULES: [Rule; 7] = [
    Rule {
        letter: 'a',
        text: "more viscous oil",
        quantity: "viscosity",
        rises: true,
        change: |design, factor| design.viscosity *= factor,
    },
    Rule {
        letter: 'b',
        text: "less weight",
        quantity: "weight",
        rises: false,
        change: |design, factor| design.weight *= factor,
    },
    Rule {
        letter: 'c',
        text: "stiffer drive",
        quantity: "stiffness",
        rises: true,
        change: |design, factor| design.stiffness *= factor,
    },
    Rule {
        letter: 'd',
        text: "less KLP: polar additive",
        quantity: "KLP",
        rises: false,
        change: |design, factor| design.interface.polar *= factor,
    },
    Rule {
        letter: 'e',
        text: "more lift: scraped, wavier surfaces",
        quantity: "Ho + hd",
        rises: true,
        change: |design, factor| design.lift *= factor,
    },
    Rule {
        letter: 'f',
        text: "flatter ridges: smoother surfaces",
        quantity: "tan",
        rises: false,
        change: |design, factor| design.interface.flank *= factor,
    },
    Rule {
        letter: 'g',
        text: "less area: slots in the surface",
        quantity: "area",
        rises: false,
        change: |design, factor| design.interface.area *= factor,
    },
];

/// The number of rules.
pub(super) const COUNT: u64 = RULES.len() as u64;

/// Tests all rules by runs in parallel. `before` is the run of the unchanged design. `progress` receives the number of
/// finished tests.
pub(super) fn all(
    design: &Design,
    before: &Simulation,
    settings: &Settings,
    progress: impl FnMut(u64) + Send,
) -> Vec<Advice> {
    let test = |rule: &Rule| rule.test(design, before, settings);
    parallel::with_threads(settings.threads, || parallel::map(&RULES, test, progress))
}

impl Rule {
    fn test(&self, design: &Design, before: &Simulation, settings: &Settings) -> Advice {
        let factor = if self.rises { 1.0 + settings.share } else { 1.0 - settings.share };
        let mut changed = *design;
        (self.change)(&mut changed, factor);
        let outcome = outcome(&changed, settings);
        let verdict = verdict(before, outcome.as_ref().ok());
        let Rule { letter, text, quantity, .. } = *self;
        Advice {
            letter,
            text,
            quantity,
            factor,
            outcome: outcome.map_err(|error| error.to_string()),
            verdict,
        }
    }
}

fn outcome(design: &Design, settings: &Settings) -> Result<AdviceOutcome, ChainError> {
    let parameters = settings.parameters(design)?;
    let Simulation { critical, nearby_thresholds, .. } = Simulation::new("", &parameters, settings)?;
    let printed = DesignEquation::PRINTED.critical_velocity(design);
    Ok(AdviceOutcome { parameters, critical, nearby_thresholds, printed, stability: stability(&parameters) })
}

fn verdict(before: &Simulation, after: Option<&AdviceOutcome>) -> AdviceVerdict {
    let Some(after) = after else { return AdviceVerdict::NotRun };
    if before.critical.rising == Err(CriticalVelocityError::NoOscillation) {
        return AdviceVerdict::NothingToLower;
    }
    if before.is_ringing_only() {
        return AdviceVerdict::RingingOnly;
    }
    if after.parameters == before.parameters {
        return AdviceVerdict::NothingChanged;
    }
    let rising = |critical: &CriticalVelocity| critical.rising;
    let befores =
        [before.critical].into_iter().chain(before.nearby_thresholds).map(|critical| rising(&critical));
    let afters =
        [after.critical].into_iter().chain(after.nearby_thresholds).map(|critical| rising(&critical));
    let oscillating =
        befores.zip(afters).filter(|(before, _)| *before != Err(CriticalVelocityError::NoOscillation));
    combined(oscillating.map(|(one, other)| compare(one, other, before.resolution())))
}

/// Compares the critical velocities without and with a rule at one threshold. `resolution` is their accuracy in m/s.
fn compare(
    before: Result<f64, CriticalVelocityError>,
    after: Result<f64, CriticalVelocityError>,
    resolution: f64,
) -> AdviceVerdict {
    let [Some(before), Some(after)] = [before, after].map(|read| possible_range(read, resolution)) else {
        return AdviceVerdict::TooFast;
    };
    let is_below = |one: [f64; 2], other: [f64; 2]| one[1] + resolution < other[0];
    match () {
        () if is_below(after, before) => AdviceVerdict::Confirmed,
        () if is_below(before, after) => AdviceVerdict::NotConfirmed,
        () if before[1].is_finite() && after[1].is_finite() => AdviceVerdict::TooClose,
        () => AdviceVerdict::NotRead,
    }
}

/// The minimum and the maximum critical velocity that agree with a reading, in m/s. `None` if nothing can be read.
///
/// Oscillation counts as ended only after a rest of [`REST_WINDOWS`] windows. So oscillation that has not ended may in
/// truth have ended up to this time before the turn, or at any higher command.
fn possible_range(read: Result<f64, CriticalVelocityError>, resolution: f64) -> Option<[f64; 2]> {
    match read {
        Ok(velocity) => Some([velocity; 2]),
        Err(CriticalVelocityError::NoOscillation) => Some([f64::NEG_INFINITY; 2]),
        Err(CriticalVelocityError::NotEnded(top)) => {
            Some([top - (REST_WINDOWS + 1) as f64 * resolution, f64::INFINITY])
        }
        Err(_) => None,
    }
}

/// The verdict from the comparisons at several thresholds: the least favourable one.
fn combined(verdicts: impl Iterator<Item = AdviceVerdict>) -> AdviceVerdict {
    let all: Vec<_> = verdicts.collect();
    let order = [
        AdviceVerdict::TooFast,
        AdviceVerdict::NotRead,
        AdviceVerdict::NotConfirmed,
        AdviceVerdict::TooClose,
    ];
    order.into_iter().find(|verdict| all.contains(verdict)).unwrap_or(AdviceVerdict::Confirmed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdict_requires_every_threshold() {
        use AdviceVerdict::*;
        let quiet = Err(CriticalVelocityError::NoOscillation);
        let verdict = |before, after| compare(before, after, 0.1);
        assert_eq!(verdict(Ok(5.0), Ok(4.8)), Confirmed);
        assert_eq!(verdict(Ok(5.0), quiet), Confirmed);
        assert_eq!(verdict(Ok(0.05), quiet), Confirmed, "oscillation disappears");
        assert_eq!(verdict(Ok(5.0), Ok(5.05)), TooClose);
        assert_eq!(verdict(Ok(5.0), Ok(5.2)), NotConfirmed);
        assert_eq!(verdict(Ok(5.0), Err(CriticalVelocityError::NotEnded(9.0))), NotConfirmed);
        assert_eq!(verdict(Ok(5.0), Err(CriticalVelocityError::CommandTooFast(0.3))), TooFast);
        let not_ended = |top| Err(CriticalVelocityError::NotEnded(top));
        assert_eq!(verdict(not_ended(9.0), Ok(5.0)), Confirmed, "the critical velocity before was above 8.5");
        assert_eq!(verdict(not_ended(9.0), quiet), Confirmed);
        assert_eq!(
            verdict(not_ended(9.0), Ok(8.6)),
            NotRead,
            "the critical velocity before may have been 8.5"
        );
        assert_eq!(verdict(not_ended(9.0), not_ended(9.0)), NotRead);
        assert_eq!(verdict(not_ended(9.0), not_ended(5.0)), NotRead);
        assert_eq!(verdict(Ok(5.0), not_ended(5.2)), NotRead, "the critical velocity may have fallen to 4.7");
        assert_eq!(combined([Confirmed, TooClose, Confirmed].into_iter()), TooClose);
        assert_eq!(combined([Confirmed, TooClose, NotConfirmed].into_iter()), NotConfirmed);
        assert_eq!(combined([Confirmed; 3].into_iter()), Confirmed);
    }
}
