//! States between the corners of an equation, such as those on both sides of a threshold.

use super::places::{Place, with_state};
use super::question::{Question, has_jump};
use super::{Known, Numerical};
use crate::compare::corners::{corner_residuals, root};
use crate::compare::expansions::TimeLaws;
use crate::compare::points::ParameterValues;
use crate::compare::terms::TOLERANCE;
use crate::operating_point::{has_switches, state_limits};
use crate::symbolic::{Fraction, Symbol};

/// Places near which corners are looked for.
const BASES: usize = 3;
/// States near a place at most. Their loops are solved, and elements that switch settle, which takes long.
const MAX_STATES: usize = 24;
/// States between two corners, as shares of their distance.
const SHARES: [f64; 2] = [0.5, 0.23];

impl Numerical<'_> {
    /// A state between neighbouring corners at which the sides of an equation differ. `None` if none is found.
    pub(super) fn different_between_corners(
        &self,
        question: &Question,
        time_laws: TimeLaws,
        places: &[Place],
    ) -> Option<Place> {
        // Elements settle at t = 0 only.
        let has_switches = has_switches(self.program);
        let mut bases = places.iter().filter(|place| !has_switches || place.point.time == 0.0).take(BASES);
        bases.find_map(|place| {
            let known = self.known(question, place, ParameterValues::Present)?;
            let before = question.angles(&known);
            let differs = |other: &Place| {
                let sample = self.sample(question, other, ParameterValues::Present);
                sample
                    .is_some_and(|sample| sample.difference > TOLERANCE && !has_jump(&before, &sample.angles))
            };
            let between = self.between_corners(question, time_laws, (place, &known)).into_iter();
            let mut states = between
                .take(MAX_STATES)
                .filter_map(|(state, volts)| with_state(self.program, place, state, volts));
            states.find(differs)
        })
    }

    /// The states between the corners along each state near a place: its index and its voltage.
    fn between_corners(
        &self,
        question: &Question,
        time_laws: TimeLaws,
        (place, known): (&Place, &Known<'_>),
    ) -> Vec<(usize, f64)> {
        let functions = question.corner_functions();
        let system = &self.model.system;
        let residuals = functions.iter().flat_map(|function| corner_residuals(function, system, known));
        let residuals: Vec<Fraction> = residuals.collect();
        let limits = state_limits(self.program, &place.point);
        let mut found = Vec::new();
        for (index, symbol) in self.outputs.states.iter().enumerate() {
            if !(self.ramps[index] && time_laws.ramps) {
                let volts = between(&residuals, *symbol, known, limits[index]);
                found.extend(volts.into_iter().map(|volts| (index, volts)));
            }
        }
        found
    }
}

/// The voltages of a state between the values at which expressions are 0, and between these and its limits.
fn between(residuals: &[Fraction], state: Symbol, known: &Known<'_>, limits: [f64; 2]) -> Vec<f64> {
    let Some(per_volt) = known.per_volt(state).filter(|per_volt| *per_volt != 0.0) else { return Vec::new() };
    let [one, other] = limits.map(|volts| volts * per_volt);
    let range = [one.min(other), one.max(other)];
    let own = residuals.iter().filter(|residual| residual.contains(&mut |symbol| symbol == state));
    let corners = own.filter_map(|residual| Some(root(residual, state, known, range)? / per_volt));
    let mut corners: Vec<f64> = corners.collect();
    if corners.is_empty() {
        return corners;
    }
    corners.extend(limits);
    corners.sort_by(f64::total_cmp);
    let pairs = corners.windows(2).map(|pair| (pair[0], pair[1]));
    let pairs = pairs.filter(|(low, high)| high - low > TOLERANCE * low.abs().max(high.abs()));
    pairs.flat_map(|(low, high)| SHARES.map(|share| low + share * (high - low))).collect()
}
