//! What lowers the critical velocity: the list of 9.5, each tried by a run.

use super::error::ChainError;
use super::parameters::Parameters;
use super::predictions::{Prediction, stability};
use super::settings::Settings;
use super::simulation::Simulation;
use crate::slideway::design::{Design, DesignEquation};
use patchcord_analysis::instruments::{CriticalVelocity, NoCriticalVelocity, REST};
use patchcord_analysis::pool;

/// An advice of 9.5, and what came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// Its letter in 9.5.
    pub letter: char,
    /// What to do.
    pub text: &'static str,
    /// The quantity that is changed.
    pub quantity: &'static str,
    /// What it is multiplied by.
    pub factor: f64,
    /// What it comes to.
    pub outcome: Result<Outcome, String>,
    /// Whether the run confirms it.
    pub verdict: Verdict,
}

/// What the chain gives once a quantity is changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The parameters of the circuit then.
    pub parameters: Parameters,
    /// The critical velocity read off the run, in m/s.
    pub critical: CriticalVelocity,
    /// The same with half of the threshold, and with twice as much.
    pub nearby: [CriticalVelocity; 2],
    /// By eq 93-9 as printed.
    pub printed: Prediction,
    /// By Routh-Hurwitz.
    pub stability: Prediction,
}

/// Whether runs confirm that the critical velocity gets lower. The command rises; it has to be so with the threshold, with half of it and
/// with twice as much, wherever it oscillates without the advice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It is lower by more than it can be read to, or there is none any more. Where oscillation has not ended without the advice, it was
    /// higher than the command at the last rest that it may have had.
    Confirmed,
    /// It is not lower, or not with every threshold.
    NotConfirmed,
    /// It changes by less than it can be read to.
    TooClose,
    /// There is no oscillation without the advice.
    NothingToLower,
    /// Without the advice it rings as it breaks away, and does not oscillate after that.
    OnlyRings,
    /// What the advice would change is set by hand, and stays.
    NothingChanged,
    /// Oscillation goes on where the command turns back, with the advice or without, and either critical velocity may be the lower one.
    NotRead,
    /// The command is too fast for half of the threshold.
    TooFast,
    /// The run could not be made.
    NotRun,
}

impl Verdict {
    /// In words.
    pub fn told(self) -> &'static str {
        match self {
            Verdict::Confirmed => "confirmed",
            Verdict::NotConfirmed => "not confirmed by the run",
            Verdict::TooClose => "not confirmed by the run: too close",
            Verdict::NothingToLower => "nothing to lower",
            Verdict::NothingChanged => "nothing changes: it is set",
            Verdict::OnlyRings => "nothing to lower: it only rings",
            Verdict::NotRead => "cannot be read: it oscillates on where the command turns back",
            Verdict::TooFast => "cannot be read: the command is too fast for half the threshold",
            Verdict::NotRun => "could not be run",
        }
    }
}

/// A row of the list.
struct Row {
    letter: char,
    text: &'static str,
    quantity: &'static str,
    /// Whether the quantity is to rise.
    rises: bool,
    change: fn(&mut Design, f64),
}

/// The list of 9.5.
const LIST: [Row; 7] = [
    Row {
        letter: 'a',
        text: "more viscous oil",
        quantity: "viscosity",
        rises: true,
        change: |design, factor| design.viscosity *= factor,
    },
    Row {
        letter: 'b',
        text: "less weight",
        quantity: "weight",
        rises: false,
        change: |design, factor| design.weight *= factor,
    },
    Row {
        letter: 'c',
        text: "stiffer drive",
        quantity: "stiffness",
        rises: true,
        change: |design, factor| design.stiffness *= factor,
    },
    Row {
        letter: 'd',
        text: "less KLP: polar additive",
        quantity: "KLP",
        rises: false,
        change: |design, factor| design.interface.polar *= factor,
    },
    Row {
        letter: 'e',
        text: "more lift: scraped, wavier surfaces",
        quantity: "Ho + hd",
        rises: true,
        change: |design, factor| design.lift *= factor,
    },
    Row {
        letter: 'f',
        text: "flatter ridges: smoother surfaces",
        quantity: "tan",
        rises: false,
        change: |design, factor| design.interface.flank *= factor,
    },
    Row {
        letter: 'g',
        text: "less area: slots in the surface",
        quantity: "area",
        rises: false,
        change: |design, factor| design.interface.area *= factor,
    },
];

/// How many there are.
pub(super) const COUNT: u64 = LIST.len() as u64;

/// Every advice, tried by runs side by side. `before` is the run without any. `progress` is told how many are tried.
pub(super) fn all(
    design: &Design,
    before: &Simulation,
    settings: &Settings,
    progress: impl FnMut(u64),
) -> Vec<Advice> {
    pool::each(&LIST, settings.threads, |row| row.tried(design, before, settings), progress)
}

impl Row {
    fn tried(&self, design: &Design, before: &Simulation, settings: &Settings) -> Advice {
        let factor = if self.rises { 1.0 + settings.share } else { 1.0 - settings.share };
        let mut changed = *design;
        (self.change)(&mut changed, factor);
        let outcome = outcome(&changed, settings);
        let verdict = verdict(before, outcome.as_ref().ok());
        let Row { letter, text, quantity, .. } = *self;
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

fn outcome(design: &Design, settings: &Settings) -> Result<Outcome, ChainError> {
    let parameters = settings.parameters(design)?;
    let Simulation { critical, nearby, .. } = Simulation::new("", &parameters, settings)?;
    let printed = DesignEquation::PRINTED.critical_velocity(design);
    Ok(Outcome { parameters, critical, nearby, printed, stability: stability(&parameters) })
}

fn verdict(before: &Simulation, after: Option<&Outcome>) -> Verdict {
    let Some(after) = after else { return Verdict::NotRun };
    if before.critical.rising == Err(NoCriticalVelocity::Quiet) {
        return Verdict::NothingToLower;
    }
    if before.only_rings() {
        return Verdict::OnlyRings;
    }
    if after.parameters == before.parameters {
        return Verdict::NothingChanged;
    }
    let rising = |critical: &CriticalVelocity| critical.rising;
    let befores = [before.critical].into_iter().chain(before.nearby).map(|critical| rising(&critical));
    let afters = [after.critical].into_iter().chain(after.nearby).map(|critical| rising(&critical));
    let oscillating = befores.zip(afters).filter(|(before, _)| *before != Err(NoCriticalVelocity::Quiet));
    together(oscillating.map(|(one, other)| compared(one, other, before.resolution())))
}

/// A critical velocity without an advice, and with it.
fn compared(
    before: Result<f64, NoCriticalVelocity>,
    after: Result<f64, NoCriticalVelocity>,
    resolution: f64,
) -> Verdict {
    let [Some(before), Some(after)] = [before, after].map(|read| between(read, resolution)) else {
        return Verdict::TooFast;
    };
    let is_below = |one: [f64; 2], other: [f64; 2]| one[1] + resolution < other[0];
    match () {
        () if is_below(after, before) => Verdict::Confirmed,
        () if is_below(before, after) => Verdict::NotConfirmed,
        () if before[1].is_finite() && after[1].is_finite() => Verdict::TooClose,
        () => Verdict::NotRead,
    }
}

/// The least and the largest critical velocity that a reading leaves open. Oscillation that has not ended may end where the command turns
/// back, or rested there for less than four windows.
fn between(read: Result<f64, NoCriticalVelocity>, resolution: f64) -> Option<[f64; 2]> {
    match read {
        Ok(velocity) => Some([velocity; 2]),
        Err(NoCriticalVelocity::Quiet) => Some([f64::NEG_INFINITY; 2]),
        Err(NoCriticalVelocity::NotEnded(top)) => Some([top - (REST + 1) as f64 * resolution, f64::INFINITY]),
        Err(_) => None,
    }
}

/// What comparisons with several thresholds come to.
fn together(verdicts: impl Iterator<Item = Verdict>) -> Verdict {
    let all: Vec<_> = verdicts.collect();
    let least = [Verdict::TooFast, Verdict::NotRead, Verdict::NotConfirmed, Verdict::TooClose];
    least.into_iter().find(|verdict| all.contains(verdict)).unwrap_or(Verdict::Confirmed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_holds_with_every_threshold() {
        use Verdict::*;
        let quiet = Err(NoCriticalVelocity::Quiet);
        let near = |before, after| compared(before, after, 0.1);
        assert_eq!(near(Ok(5.0), Ok(4.8)), Confirmed);
        assert_eq!(near(Ok(5.0), quiet), Confirmed);
        assert_eq!(near(Ok(0.05), quiet), Confirmed, "it is gone");
        assert_eq!(near(Ok(5.0), Ok(5.05)), TooClose);
        assert_eq!(near(Ok(5.0), Ok(5.2)), NotConfirmed);
        assert_eq!(near(Ok(5.0), Err(NoCriticalVelocity::NotEnded(9.0))), NotConfirmed);
        assert_eq!(near(Ok(5.0), Err(NoCriticalVelocity::CommandTooFast(0.3))), TooFast);
        let on = |top| Err(NoCriticalVelocity::NotEnded(top));
        assert_eq!(near(on(9.0), Ok(5.0)), Confirmed, "it was above 8.5");
        assert_eq!(near(on(9.0), quiet), Confirmed);
        assert_eq!(near(on(9.0), Ok(8.6)), NotRead, "it may have been 8.5");
        assert_eq!(near(on(9.0), on(9.0)), NotRead);
        assert_eq!(near(on(9.0), on(5.0)), NotRead);
        assert_eq!(near(Ok(5.0), on(5.2)), NotRead, "it may have sunk to 4.7");
        assert_eq!(together([Confirmed, TooClose, Confirmed].into_iter()), TooClose);
        assert_eq!(together([Confirmed, TooClose, NotConfirmed].into_iter()), NotConfirmed);
        assert_eq!(together([Confirmed; 3].into_iter()), Confirmed);
    }
}
