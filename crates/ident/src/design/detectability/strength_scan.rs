//! The smallest detectable strength of an effect.
//!
//! The margin of an effect grows with its strength: in a linear patch, with the square of it. So some strengths are
//! simulated, and the strength with a margin of 1 is interpolated between the last that is not detected and the first
//! that is.

use crate::design::detectability::detection_limit::DetectionLimit;
use crate::design::detectability::detection_test::DetectionTest;
use crate::design::detectability::record_group::EffectResponse;
use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::ModelVariant;
use crate::fit::model::{Model, ModelError};
use crate::fit::parameter_values::ParameterValues;

/// Strengths that are simulated, as fractions of the way from no effect to the end of the range. A factor of about 4
/// between them suffices for a margin that grows with a power; the last ones resolve effects that only act near the
/// end.
const STRENGTHS: [f64; 11] = [6e-5, 2.5e-4, 1e-3, 4e-3, 0.016, 0.06, 0.25, 0.5, 0.8, 0.93, 1.0];
/// Number of strengths that are simulated together, as lanes of one run.
const STRENGTHS_PER_RUN: usize = 4;
/// Power of the strength above which the growth of the margin is too steep to interpolate. In a linear patch it is 2.
const STEEP_POWER: f64 = 4.0;
/// Number of times that a steep interval is divided.
const MAX_SUBDIVISIONS: usize = 2;
/// Number of parts into which a steep interval is divided.
const SUBDIVISION_PARTS: u32 = 5;
/// Maximum number of choices of an effect's other parameters.
const MAX_VARIANTS: usize = 3;

/// A fraction of the way to the end of a range, and the margin at that strength.
type Margin = (f64, f64);

/// The scan of an effect's strength with all its other parameters fixed.
pub(super) struct StrengthScan<'a> {
    pub(super) detection: &'a DetectionTest<'a>,
    /// The patch with the effect, for training and for validation.
    pub(super) models: &'a [Model; 2],
    pub(super) candidate: &'a Candidate,
    /// Values of all parameters except the first, which is the strength.
    pub(super) other_values: &'a [f64],
    /// Required decrease of chi2 over the variance of the noise.
    pub(super) required_decrease: f64,
    /// Outputs without the effect in training and in validation, by record.
    pub(super) reference: [Vec<Option<Vec<f64>>>; 2],
}

impl StrengthScan<'_> {
    /// The smallest detectable strength, and its fraction of the range. If both signs of the strength are detectable,
    /// it is the positive value at which both are. None if no strength is detectable.
    pub(super) fn least(&self) -> Option<(f64, f64)> {
        let strength = &self.candidate.graft.parameters[0];
        let zero = self.candidate.null_value;
        let origin = zero.unwrap_or(0.0);
        let ends: Vec<f64> = match zero {
            Some(zero) => strength.range.into_iter().filter(|end| *end != zero).collect(),
            None => vec![farther_end(strength.range)],
        };
        let longest = ends.iter().map(|end| (end - origin).abs()).fold(0.0, f64::max);
        let limits: Vec<f64> = ends.iter().filter_map(|end| self.least_towards(origin, *end)).collect();
        let farthest =
            limits.iter().copied().max_by(|a, b| (a - origin).abs().total_cmp(&(b - origin).abs()))?;
        let value = if limits.len() > 1 { origin + (farthest - origin).abs() } else { farthest };
        Some((value, (farthest - origin).abs() / longest))
    }

    /// The smallest detectable strength between `origin` and one end of the range.
    fn least_towards(&self, origin: f64, end: f64) -> Option<f64> {
        let candidate = self.candidate;
        // If zero strength is outside the range, the weakest effect is at the nearer end of the range.
        let [low, high] = candidate.graft.parameters[0].range;
        let nearer = if end == low { high } else { low };
        let weakest = candidate.null_value.map_or((nearer / end).max(0.0), |_| 0.0);
        let stronger = STRENGTHS.into_iter().filter(|fraction| *fraction > weakest);
        let fractions: Vec<f64> =
            Some(weakest).filter(|fraction| *fraction > 0.0).into_iter().chain(stronger).collect();
        let mut margins = self.margins(origin, end, &fractions);
        for _ in 0..MAX_SUBDIVISIONS {
            let Some([below, above]) = steep_interval(&margins) else { break };
            let inner = (1..SUBDIVISION_PARTS).map(|part| f64::from(part) / f64::from(SUBDIVISION_PARTS));
            let fractions: Vec<f64> = inner.map(|part| below.0 + part * (above.0 - below.0)).collect();
            let inner = self.margins(origin, end, &fractions);
            margins = [below].into_iter().chain(inner).chain([above]).collect();
        }
        let fraction = interpolate_to_one(&margins, candidate.null_value.is_some())?;
        Some(origin + fraction * (end - origin))
    }

    /// The margins at some fractions of the way from `origin` to `end`, up to the first that is detected. Strengths
    /// at which the patch cannot be run are left out.
    fn margins(&self, origin: f64, end: f64, fractions: &[f64]) -> Vec<Margin> {
        let values = |strength: f64| [&[strength], self.other_values].concat();
        let states = self.candidate.graft.initial_states.len();
        let groups = [&self.detection.train, &self.detection.validation];
        let mut margins = Vec::new();
        // Stronger effects are not run after the first that is detected. They may diverge, and then take long.
        for fractions in fractions.chunks(STRENGTHS_PER_RUN) {
            let strengths = fractions.iter().map(|fraction| values(origin + fraction * (end - origin)));
            let strengths: Vec<Vec<f64>> = strengths.collect();
            let [train, validation] = [0, 1].map(|group| {
                groups[group].responses(&self.models[group], &strengths, &self.reference[group], states)
            });
            for ((fraction, train), validation) in fractions.iter().zip(train).zip(validation) {
                let (Some(train), Some(validation)) = (train, validation) else { continue };
                let margin = self.margin(&[train, validation]);
                margins.push((*fraction, margin));
                if margin >= 1.0 {
                    return margins;
                }
            }
        }
        margins
    }

    /// The margin of a response: to first order, and after complete fits if the effect would be detected to first
    /// order.
    fn margin(&self, responses: &[EffectResponse; 2]) -> f64 {
        let margin = self.detection.margin(&self.detection.residual(responses), self.required_decrease);
        if margin < 1.0 {
            return margin;
        }
        let fitted = self.detection.fitted_residual(responses);
        fitted.map_or(margin, |residual| self.detection.margin(&residual, self.required_decrease))
    }
}

/// The end of a range that is farther from zero. If both are equally far, it is the upper one.
fn farther_end([low, high]: [f64; 2]) -> f64 {
    if low.abs() > high.abs() { low } else { high }
}

/// The first margin of at least 1, and the one before it, if there is one. None if no margin reaches 1.
fn first_detected(margins: &[Margin]) -> Option<(Option<Margin>, Margin)> {
    let index = margins.iter().position(|(_, margin)| *margin >= 1.0)?;
    Some((index.checked_sub(1).map(|before| margins[before]), margins[index]))
}

/// The first margin of at least 1 and the one before it, if the margin grows with more than the fourth power of the
/// strength between them. None otherwise.
fn steep_interval(margins: &[Margin]) -> Option<[Margin; 2]> {
    let (before, above) = first_detected(margins)?;
    let below = before?;
    let is_steep =
        below.1 <= 0.0 || libm::log(above.1 / below.1) > STEEP_POWER * libm::log(above.0 / below.0);
    is_steep.then_some([below, above])
}

/// The fraction at which the margin is 1. Between two fractions the margin is assumed to be a power of the fraction.
///
/// If the first fraction is detected already, the margin below it is assumed to grow with the square. Without
/// `can_extrapolate`, smaller strengths are outside the range, and the first fraction is the result.
fn interpolate_to_one(margins: &[Margin], can_extrapolate: bool) -> Option<f64> {
    let (below, (fraction, margin)) = first_detected(margins)?;
    Some(match below {
        None if can_extrapolate => fraction / margin.sqrt(),
        None => fraction,
        Some((_, lower)) if lower <= 0.0 => fraction,
        Some((before, lower)) => {
            before * libm::pow(fraction / before, libm::log(lower) / libm::log(lower / margin))
        }
    })
}

impl<'a> DetectionTest<'a> {
    /// The detection limit of an effect: the smallest detectable strength over the choices of its other parameters.
    ///
    /// # Errors
    /// If the patch with the effect cannot be simulated with the drives of the records.
    pub(super) fn limit(
        &self,
        candidate: &Candidate,
        variant: &ModelVariant,
    ) -> Result<DetectionLimit, ModelError> {
        let models = [
            self.problem.model(variant, &self.problem.train, &self.problem.outputs)?,
            self.problem.model(variant, &self.problem.validation, &self.problem.outputs)?,
        ];
        let added = variant.fit.len() - self.before.variant.fit.len();
        let required_decrease = self.required_decrease(added);
        let limits = variants(candidate).into_iter().filter_map(|other_values| {
            let reference = self.reference_outputs(&models, candidate, &other_values);
            let scan = StrengthScan {
                detection: self,
                models: &models,
                candidate,
                other_values: &other_values,
                required_decrease,
                reference,
            };
            scan.least().map(|(value, fraction)| (value, fraction, other_values.clone()))
        });
        let least = limits.min_by(|a, b| a.1.total_cmp(&b.1));
        let parameters = &candidate.graft.parameters;
        let others = least.iter().flat_map(|(_, _, values)| parameters[1..].iter().zip(values));
        Ok(DetectionLimit {
            effect: candidate.effect.clone(),
            site: candidate.site.clone(),
            reads: candidate.reads.clone(),
            parameter: parameters[0].name_in_effect.clone(),
            unit: parameters[0].unit.clone(),
            value: least.as_ref().map(|least| least.0),
            range_fraction: least.as_ref().map_or(f64::INFINITY, |least| least.1),
            other_parameters: ParameterValues(
                others
                    .map(|(parameter, value)| {
                        (parameter.name_in_effect.clone(), *value, parameter.unit.clone())
                    })
                    .collect(),
            ),
        })
    }

    /// Outputs in training and in validation, by record, without an effect whose other parameters are given.
    fn reference_outputs(
        &self,
        models: &[Model; 2],
        candidate: &Candidate,
        other_values: &[f64],
    ) -> [Vec<Option<Vec<f64>>>; 2] {
        let zero = candidate.null_value.map(|zero| [&[zero], other_values].concat());
        let groups = [&self.train, &self.validation];
        let states = candidate.graft.initial_states.len();
        [0, 1].map(|group| groups[group].reference_outputs(&models[group], zero.as_deref(), states))
    }
}

/// Choices for all parameters of an effect except the first, from the starts of its fits, without repetition. A
/// parameter with the unit of the first is another strength. It is set to the value in its range that is nearest to
/// zero.
fn variants(candidate: &Candidate) -> Vec<Vec<f64>> {
    let parameters = &candidate.graft.parameters;
    let mut variants: Vec<Vec<f64>> = Vec::new();
    for start in &candidate.starts {
        let value = |index: usize| match parameters[index].unit == parameters[0].unit {
            true => 0.0_f64.clamp(parameters[index].range[0], parameters[index].range[1]),
            false => start[index],
        };
        let values: Vec<f64> = (1..parameters.len()).map(value).collect();
        if !variants.contains(&values) {
            variants.push(values);
        }
    }
    variants.truncate(MAX_VARIANTS);
    variants
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_is_steep_if_the_margin_grows_faster_than_the_fourth_power() {
        assert_eq!(steep_interval(&[(0.1, 0.25), (0.4, 4.0)]), None);
        assert_eq!(steep_interval(&[(0.1, 0.0), (0.2, 0.1), (0.4, 9.0)]), Some([(0.2, 0.1), (0.4, 9.0)]));
        assert_eq!(steep_interval(&[(0.1, 0.0), (0.2, 16.0)]), Some([(0.1, 0.0), (0.2, 16.0)]));
        assert_eq!(steep_interval(&[(0.1, 16.0)]), None);
    }

    #[test]
    fn the_farther_end_of_a_range_has_the_larger_absolute_value() {
        assert_eq!([[1.0, 4.0], [-100.0, 0.0], [-1.0, 1.0]].map(farther_end), [4.0, -100.0, 1.0]);
    }

    #[test]
    fn the_margin_is_interpolated_by_a_power_law() {
        assert_eq!(
            interpolate_to_one(&[(0.1, 0.25), (0.4, 4.0)], true).map(|fraction| (fraction * 1e9).round()),
            Some(2e8)
        );
        // The weakest strength has four times the required margin. Half of it suffices, if the range permits it.
        assert_eq!(interpolate_to_one(&[(0.1, 4.0), (0.2, 16.0)], true), Some(0.05));
        assert_eq!(interpolate_to_one(&[(0.1, 4.0), (0.2, 16.0)], false), Some(0.1));
        // A stop that is never reached has no effect, so that there is no power law.
        assert_eq!(interpolate_to_one(&[(0.1, 0.0), (0.2, 16.0)], true), Some(0.2));
        assert_eq!(interpolate_to_one(&[(0.1, 0.1), (0.2, 0.4)], true), None);
    }
}
