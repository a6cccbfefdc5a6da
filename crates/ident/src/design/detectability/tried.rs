//! The strength from which on an effect shows.

use crate::design::detectability::detection_limit::Limit;
use crate::design::detectability::ground::Ground;
use crate::design::detectability::half::Change;
use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::Version;
use crate::fit::model::{Model, ModelError};
use crate::fit::parameter_values::ParameterValues;

/// Strengths that are tried on either side of none, as shares of the way to the end of the range.
const STRENGTHS: [f64; 11] = [6e-5, 2.5e-4, 1e-3, 4e-3, 0.016, 0.06, 0.25, 0.5, 0.8, 0.93, 1.0];
/// So many are run side by side.
const AT_ONCE: usize = 4;
/// Where the margin grows with more than such a power of the strength,
const STEEP: f64 = 4.0;
/// so often more strengths are tried,
const FINER: usize = 2;
/// which make so many parts of the way.
const BETWEEN: u32 = 5;

/// An effect with all but its strength chosen.
pub(super) struct Tried<'a> {
    pub(super) ground: &'a Ground<'a>,
    pub(super) models: &'a [Model; 2],
    pub(super) candidate: &'a Candidate,
    pub(super) rest: &'a [f64],
    pub(super) need: f64,
    /// Of both halves, by record, what there is without it.
    pub(super) without: [Vec<Option<Vec<f64>>>; 2],
}

impl Tried<'_> {
    /// The strength from which on the effect would have been seen, whatever its sign if it would with both, and its share of the range.
    pub(super) fn least(&self) -> Option<(f64, f64)> {
        let brought = &self.candidate.graft.parameters[0];
        let none = self.candidate.none;
        let home = none.unwrap_or(0.0);
        let ends: Vec<f64> = match none {
            Some(none) => brought.range.into_iter().filter(|end| *end != none).collect(),
            None => vec![farther(brought.range)],
        };
        let most = ends.iter().map(|end| (end - home).abs()).fold(0.0, f64::max);
        let seen: Vec<f64> = ends.iter().filter_map(|end| self.on_one_side(home, *end)).collect();
        let far = seen.iter().copied().max_by(|a, b| (a - home).abs().total_cmp(&(b - home).abs()))?;
        let value = if seen.len() > 1 { home + (far - home).abs() } else { far };
        Some((value, (far - home).abs() / most))
    }

    /// The same between no effect and an end of its range.
    fn on_one_side(&self, home: f64, end: f64) -> Option<f64> {
        let candidate = self.candidate;
        // Where no effect lies outside the range, the weakest is that at its beginning.
        let [low, high] = candidate.graft.parameters[0].range;
        let nearer = if end == low { high } else { low };
        let weakest = candidate.none.map_or((nearer / end).max(0.0), |_| 0.0);
        let stronger = STRENGTHS.into_iter().filter(|share| *share > weakest);
        let shares: Vec<f64> =
            Some(weakest).filter(|share| *share > 0.0).into_iter().chain(stronger).collect();
        let mut margins = self.margins(home, end, &shares);
        for _ in 0..FINER {
            let Some([below, above]) = steep(&margins) else { break };
            let between = (1..BETWEEN).map(|place| f64::from(place) / f64::from(BETWEEN));
            let shares: Vec<f64> = between.map(|part| below.0 + part * (above.0 - below.0)).collect();
            let inner = self.margins(home, end, &shares);
            margins = [below].into_iter().chain(inner).chain([above]).collect();
        }
        let share = reaches_one(&margins, candidate.none.is_some())?;
        Some(home + share * (end - home))
    }

    /// Shares of the way to the end of a range and their margins, up to the first that shows.
    fn margins(&self, home: f64, end: f64, shares: &[f64]) -> Vec<Margin> {
        let with = |strength: f64| [&[strength], self.rest].concat();
        let states = self.candidate.graft.free.len();
        let halves = [&self.ground.train, &self.ground.test];
        let mut margins = Vec::new();
        // Where a weak one shows, none of the strong ones are run, which take long to go astray.
        for shares in shares.chunks(AT_ONCE) {
            let strengths = shares.iter().map(|share| with(home + share * (end - home)));
            let strengths: Vec<Vec<f64>> = strengths.collect();
            let [train, test] = [0, 1].map(|half| {
                halves[half].changes(&self.models[half], &strengths, &self.without[half], states)
            });
            for ((share, train), test) in shares.iter().zip(train).zip(test) {
                let (Some(train), Some(test)) = (train, test) else { continue };
                let margin = self.margin(&[train, test]);
                margins.push((*share, margin));
                if margin >= 1.0 {
                    return margins;
                }
            }
        }
        margins
    }

    /// The margin of what a strength changes: to first order, and in full where it would show so.
    fn margin(&self, changes: &[Change; 2]) -> f64 {
        let margin = self.ground.margin(&self.ground.left(changes), self.need);
        if margin < 1.0 {
            return margin;
        }
        let in_full = self.ground.left_in_full(changes);
        in_full.map_or(margin, |left| self.ground.margin(&left, self.need))
    }
}

/// The end of a range that lies farther from zero; of two as far the upper.
fn farther([low, high]: [f64; 2]) -> f64 {
    if low.abs() > high.abs() { low } else { high }
}

/// A share of the way to the end of a range, and the margin there.
type Margin = (f64, f64);

/// The first strength that shows, behind the one before it.
fn first_that_shows(margins: &[Margin]) -> Option<(Option<Margin>, Margin)> {
    let place = margins.iter().position(|(_, margin)| *margin >= 1.0)?;
    Some((place.checked_sub(1).map(|before| margins[before]), margins[place]))
}

/// The first strength that shows and the one before it, where the margin grows far more steeply than with the square of the strength.
fn steep(margins: &[Margin]) -> Option<[Margin; 2]> {
    let (before, above) = first_that_shows(margins)?;
    let below = before?;
    let is_steep = below.1 <= 0.0 || libm::log(above.1 / below.1) > STEEP * libm::log(above.0 / below.0);
    is_steep.then_some([below, above])
}

/// Where a margin that grows with the square of a share, or faster, comes to 1; `goes_on` says whether it does so below the first.
fn reaches_one(margins: &[Margin], goes_on: bool) -> Option<f64> {
    let (below, (share, margin)) = first_that_shows(margins)?;
    Some(match below {
        None if goes_on => share / margin.sqrt(),
        None => share,
        Some((_, less)) if less <= 0.0 => share,
        Some((before, less)) => {
            before * libm::pow(share / before, libm::log(less) / libm::log(less / margin))
        }
    })
}

/// So many choices of an effect's other parameters are tried.
const VARIANTS: usize = 3;

impl<'a> Ground<'a> {
    /// The least strength at which an effect would have been seen, whatever its other parameters.
    pub(super) fn limit(&self, candidate: &Candidate, version: &Version) -> Result<Limit, ModelError> {
        let models = [
            self.problem.model(version, &self.problem.train, &self.problem.outputs)?,
            self.problem.model(version, &self.problem.test, &self.problem.outputs)?,
        ];
        let numbers = version.fit.len() - self.before.version.fit.len();
        let need = self.need(numbers);
        let found = variants(candidate).into_iter().filter_map(|rest| {
            let without = self.without(&models, candidate, &rest);
            let tried = Tried { ground: self, models: &models, candidate, rest: &rest, need, without };
            tried.least().map(|(value, share)| (value, share, rest.clone()))
        });
        let least = found.min_by(|a, b| a.1.total_cmp(&b.1));
        let brought = &candidate.graft.parameters;
        let beside = least.iter().flat_map(|(_, _, rest)| brought[1..].iter().zip(rest));
        Ok(Limit {
            effect: candidate.effect.clone(),
            junction: candidate.junction.clone(),
            reads: candidate.reads.clone(),
            parameter: brought[0].of.clone(),
            unit: brought[0].unit.clone(),
            value: least.as_ref().map(|least| least.0),
            share: least.as_ref().map_or(f64::INFINITY, |least| least.1),
            beside: ParameterValues(
                beside.map(|(own, value)| (own.of.clone(), *value, own.unit.clone())).collect(),
            ),
        })
    }

    /// Of both halves, by record, what there is without an effect whose other parameters are told.
    fn without(
        &self,
        models: &[Model; 2],
        candidate: &Candidate,
        rest: &[f64],
    ) -> [Vec<Option<Vec<f64>>>; 2] {
        let none = candidate.none.map(|none| [&[none], rest].concat());
        let halves = [&self.train, &self.test];
        [0, 1].map(|half| halves[half].without(&models[half], none.as_deref(), candidate.graft.free.len()))
    }
}

/// Values of all parameters but the first, as fits begin with them; what has the unit of the first is another strength, and left
/// out where it can be.
fn variants(candidate: &Candidate) -> Vec<Vec<f64>> {
    let brought = &candidate.graft.parameters;
    let mut variants: Vec<Vec<f64>> = Vec::new();
    for start in &candidate.starts {
        let value = |place: usize| match brought[place].unit == brought[0].unit {
            true => 0.0_f64.clamp(brought[place].range[0], brought[place].range[1]),
            false => start[place],
        };
        let rest: Vec<f64> = (1..brought.len()).map(value).collect();
        if !variants.contains(&rest) {
            variants.push(rest);
        }
    }
    variants.truncate(VARIANTS);
    variants
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_the_margin_jumps_more_strengths_are_tried() {
        assert_eq!(steep(&[(0.1, 0.25), (0.4, 4.0)]), None);
        assert_eq!(steep(&[(0.1, 0.0), (0.2, 0.1), (0.4, 9.0)]), Some([(0.2, 0.1), (0.4, 9.0)]));
        assert_eq!(steep(&[(0.1, 0.0), (0.2, 16.0)]), Some([(0.1, 0.0), (0.2, 16.0)]));
        assert_eq!(steep(&[(0.1, 16.0)]), None);
    }

    #[test]
    fn a_range_is_gone_through_away_from_zero() {
        assert_eq!([[1.0, 4.0], [-100.0, 0.0], [-1.0, 1.0]].map(farther), [4.0, -100.0, 1.0]);
    }

    #[test]
    fn between_two_strengths_the_margin_grows_by_a_power() {
        assert_eq!(
            reaches_one(&[(0.1, 0.25), (0.4, 4.0)], true).map(|share| (share * 1e9).round()),
            Some(2e8)
        );
        // Twice as much as is needed at the weakest: less would do, where there may be less.
        assert_eq!(reaches_one(&[(0.1, 4.0), (0.2, 16.0)], true), Some(0.05));
        assert_eq!(reaches_one(&[(0.1, 4.0), (0.2, 16.0)], false), Some(0.1));
        // A stop that is not met does nothing.
        assert_eq!(reaches_one(&[(0.1, 0.0), (0.2, 16.0)], true), Some(0.2));
        assert_eq!(reaches_one(&[(0.1, 0.1), (0.2, 0.4)], true), None);
    }
}
