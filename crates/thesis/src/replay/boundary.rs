//! The command at which the final circuit stops oscillating, found by two methods.
//!
//! A ramp raises the command until oscillation ends. A small disturbance of steady sliding grows or decays, and
//! bisection finds the velocity at which it does neither.
//!
//! A ramp reads its critical velocity while the command rises: where the swings above 0.25 mm/s within 0.04 s end.
//!
//! Two results are cached for the process, because several figures and claims need them: the sweep of [`sweep`], and
//! the VcL with the highest critical velocity of each time constant ([`worst_limits`]). The sweep has 200 runs, each of
//! which covers the whole ramp.

use std::sync::LazyLock;

use super::recipe::{BoxError, Recipe};
use crate::slideway::falling::FallingFriction;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::units::{N_PER_MM, N_S_PER_MM};
use patchcord_analysis::instruments::{Criterion, CriticalVelocityError};

/// Time constants of the sweep in s: those that the thesis names, 6 ... 25 ms (8.4), and some values between them.
pub(super) const MEMORIES: [f64; 10] =
    [0.006, 0.0065, 0.0071, 0.0075, 0.008, 0.010, 0.0125, 0.015, 0.020, 0.025];

/// Number of values of VcL in the sweep. They divide the thesis's range of 1.27 ... 25.4 mm/s into equal steps.
pub(super) const LIMIT_COUNT: usize = 20;
/// The smallest VcL and the step of the sweep, in units of 10 um/s. In this unit all values are whole numbers.
const LIMIT_STEP: usize = 127;

/// The thesis's rate of the velocity command, in m/s2 (8.5).
pub(super) const RATE: f64 = 1.2e-3;

/// The command at the end of a ramp, in m/s. It exceeds every critical velocity of the sweep; a higher one would not
/// be read.
const RAMP_END: f64 = 14.4e-3;

/// The result of one ramp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RampResult {
    /// Time constant of the friction lag, in s.
    pub memory: f64,
    /// VcL, the velocity at which solid friction vanishes, in m/s.
    pub limit: f64,
    /// The command at which oscillation ended, in m/s, or the reason why none was read.
    pub velocity: Result<f64, CriticalVelocityError>,
}

impl RampResult {
    /// Returns the slope by which solid friction falls at that command, in N s/mm. `None` if no command was read, or
    /// if friction does not fall there.
    pub(super) fn slope(&self) -> Option<f64> {
        let slope = FallingFriction::simulated(self.limit).slope(self.velocity.ok()?).ok()?;
        (slope > 0.0).then_some(slope / N_S_PER_MM)
    }
}

/// The final circuit with a command that rises from 0 to the end of the ramp, at a rate in m/s2.
pub(super) fn ramp(rate: f64) -> Recipe {
    Recipe::new("fig-8-16").set("v_rate", rate).run_time(RAMP_END / rate)
}

/// Runs a ramp for each setting (time constant in s, VcL in m/s) at a rate in m/s2. Reads it with each threshold in
/// m/s. Returns one list per threshold, each in the order of the settings.
pub(super) fn ramps(
    settings: &[(f64, f64)],
    rate: f64,
    thresholds: &[f64],
) -> Result<Vec<Vec<RampResult>>, BoxError> {
    let rows: Vec<_> = settings.iter().map(|(memory, limit)| vec![*memory, *limit]).collect();
    let criterion = |threshold: &f64| Criterion { threshold: *threshold, ..Criterion::USUAL };
    let read = ramp(rate).record(&["v_i", "v_o"]).run_rows(&["Tc", "VcL"], &rows, |run| {
        let rising = |threshold| Ok::<_, BoxError>(run.critical_velocity_by(criterion(threshold))?.rising);
        thresholds.iter().map(rising).collect::<Result<Vec<_>, _>>()
    })?;
    let of_threshold = |index: usize| {
        let results = settings.iter().zip(&read);
        let results = results.map(|((memory, limit), velocities)| RampResult {
            memory: *memory,
            limit: *limit,
            velocity: velocities[index],
        });
        results.collect()
    };
    Ok((0..thresholds.len()).map(of_threshold).collect())
}

/// Returns the values of VcL in the sweep, in m/s, in ascending order.
pub(super) fn limits() -> Vec<f64> {
    (1..=LIMIT_COUNT).map(|count| (count * LIMIT_STEP) as f64 / 1e5).collect()
}

/// The sweep of Fig 8.30: every time constant with every VcL, at the thesis's rate and the usual threshold. It is run
/// once and cached.
pub(super) fn sweep() -> Result<&'static [RampResult], BoxError> {
    static SWEEP: LazyLock<Result<Vec<RampResult>, String>> = LazyLock::new(|| {
        let with_limits =
            |memory: &f64| limits().into_iter().map(|limit| (*memory, limit)).collect::<Vec<_>>();
        let settings: Vec<_> = MEMORIES.iter().flat_map(with_limits).collect();
        let read = ramps(&settings, RATE, &[Criterion::USUAL.threshold]);
        read.map(|mut read| read.remove(0)).map_err(|problem| problem.to_string())
    });
    SWEEP.as_deref().map_err(|problem| problem.clone().into())
}

/// Selects the results of one time constant, which must be one of those that were run.
pub(super) fn with_memory(results: &[RampResult], memory: f64) -> impl Iterator<Item = &RampResult> {
    results.iter().filter(move |result| result.memory == memory)
}

/// Points of slopes in N s/mm by time constant in s, or by stiffness in N/mm, and the power law fitted to them.
pub(super) type Slopes = (Vec<(f64, f64)>, PowerLaw);

/// Fits a power law to the slopes by time constant. Ramps without a falling slope are omitted.
fn slopes(results: impl Iterator<Item = RampResult>) -> Result<Slopes, BoxError> {
    let points: Vec<_> = results.filter_map(|result| Some((result.memory, result.slope()?))).collect();
    let law = PowerLaw::fit(&points)?;
    Ok((points, law))
}

/// Returns each time constant in s with its worst VcL in m/s, at which its critical velocity is highest. Curves are
/// flat near the maximum, so the centre of the range within 1 % of it is taken. The result is computed once and cached.
pub(super) fn worst_limits() -> Result<&'static [(f64, f64)], BoxError> {
    static WORST_LIMITS: LazyLock<Result<Vec<(f64, f64)>, String>> = LazyLock::new(|| {
        let found = MEMORIES.iter().map(|memory| Ok((*memory, worst_limit(*memory)?)));
        found.collect::<Result<_, BoxError>>().map_err(|problem| problem.to_string())
    });
    WORST_LIMITS.as_deref().map_err(|problem| problem.clone().into())
}

/// Number of values of VcL that refine a curve near the maximum of the sweep.
const REFINEMENT_POINTS: usize = 40;

/// Returns the VcL in m/s at the maximum of one curve: the centre of the range within 1 % of it. The sweep gives the
/// maximum coarsely; ramps within one step on each side refine it.
fn worst_limit(memory: f64) -> Result<f64, BoxError> {
    let height =
        |result: &&RampResult| if result.slope().is_some() { result.velocity.unwrap_or(0.0) } else { 0.0 };
    let highest = |results: &[RampResult]| results.iter().map(|result| height(&result)).fold(0.0, f64::max);
    let coarse: Vec<_> = with_memory(sweep()?, memory).copied().collect();
    let peak = coarse
        .iter()
        .find(|result| height(result) == highest(&coarse))
        .ok_or("no ramp has a critical velocity")?;
    let step = coarse[0].limit;
    let around = (1..=REFINEMENT_POINTS)
        .map(|count| peak.limit + step * (2.0 * count as f64 / REFINEMENT_POINTS as f64 - 1.0));
    let settings: Vec<_> = around.map(|limit| (memory, limit.max(1e-3))).collect();
    let fine = ramps(&settings, RATE, &[Criterion::USUAL.threshold])?.remove(0);
    let near_peak: Vec<_> = fine.iter().filter(|result| height(result) >= 0.99 * highest(&fine)).collect();
    Ok(near_peak.iter().map(|result| result.limit).sum::<f64>() / near_peak.len() as f64)
}

/// Returns the highest critical velocity of each time constant, in m/s, by ramps at the thesis's rate.
pub(super) fn max_critical_velocities() -> Result<Vec<f64>, BoxError> {
    let read = ramps(worst_limits()?, RATE, &[Criterion::USUAL.threshold])?.remove(0);
    read.into_iter().map(|result| Ok(result.velocity?)).collect()
}

/// Returns the slopes at the worst VcL of each time constant, by ramps at the thesis's rate and the usual threshold.
pub(super) fn slopes_at_worst_limits() -> Result<Slopes, BoxError> {
    Ok(slopes_at_rate(RATE, &[Criterion::USUAL.threshold])?.remove(0))
}

/// Returns the slopes at which ramps at another rate end oscillation, at the worst VcL of each time constant. There is
/// one result per threshold (in m/s).
pub(super) fn slopes_at_rate(rate: f64, thresholds: &[f64]) -> Result<Vec<Slopes>, BoxError> {
    ramps(worst_limits()?, rate, thresholds)?.into_iter().map(|result| slopes(result.into_iter())).collect()
}

/// VcL in m/s and Tc in s of the thesis's tests with other stiffnesses (Fig 8.35).
const STIFFNESS_TESTS: (f64, f64) = (40e-3, 0.0071);

/// The circuit of the tests with other stiffnesses. Its scales are doubled, because the table moves up to twice as
/// fast as the command and would overload the scales of the thesis.
pub(super) fn stiffness_test_circuit() -> Recipe {
    let (limit, memory) = STIFFNESS_TESTS;
    Recipe::new("fig-8-16").set("VcL", limit).set("Tc", memory).scale_by(2.0)
}

/// The circuit of those tests with a command that rises at the thesis's rate up to VcL.
pub(super) fn stiffness_test_ramp() -> Recipe {
    stiffness_test_circuit().set("v_rate", RATE).run_time(STIFFNESS_TESTS.0 / RATE)
}

/// Solid friction of the tests with other stiffnesses.
pub(super) fn stiffness_test_friction() -> FallingFriction {
    FallingFriction::simulated(STIFFNESS_TESTS.0)
}

/// Returns the critical velocity in m/s for each stiffness in N/m, with a command that rises at the thesis's rate up
/// to VcL. A stiffness without oscillation is omitted.
pub(super) fn velocities_by_stiffness(stiffnesses: &[f64]) -> Result<Vec<(f64, f64)>, BoxError> {
    let recipe = stiffness_test_ramp().record(&["v_i", "v_o"]);
    let read = recipe.run_values("K", stiffnesses, |run| match run.critical_velocity()?.rising {
        Err(CriticalVelocityError::NoOscillation) => Ok(None),
        velocity => Ok(Some(velocity?)),
    })?;
    Ok(read.into_iter().filter_map(|(stiffness, velocity)| Some((stiffness, velocity?))).collect())
}

/// Returns the slopes in N s/mm at some velocities, by stiffness in N/mm, and the power law fitted to them.
/// `velocities` holds stiffness in N/m and velocity in m/s.
pub(super) fn slopes_by_stiffness(velocities: &[(f64, f64)]) -> Result<Slopes, BoxError> {
    let friction = stiffness_test_friction();
    let slope = |(stiffness, velocity): &(f64, f64)| {
        Ok::<_, BoxError>((stiffness / N_PER_MM, friction.slope(*velocity)? / N_S_PER_MM))
    };
    let points = velocities.iter().map(slope).collect::<Result<Vec<_>, _>>()?;
    let law = PowerLaw::fit(&points)?;
    Ok((points, law))
}

/// The initial velocity divided by the steady one. It makes a disturbance of 1/1000 of the velocity.
const DISTURBANCE: f64 = 1.001;
/// Bisection stops when the interval is smaller than this share of VcL.
const BISECTION_TOLERANCE: f64 = 5e-4;

/// Returns the velocity in m/s above which a small disturbance of steady sliding decays, and below which it grows.
/// `None` if it decays at 2 % of VcL, because then it decays everywhere: the faster the table slides, the less
/// steeply friction falls. `set` holds the parameters of the circuit, VcL among them.
pub(super) fn disturbance_boundary(set: &[(&str, f64)], limit: f64) -> Result<Option<f64>, BoxError> {
    let (mut low, mut high) = (0.02 * limit, limit);
    if !is_growing(set, low)? {
        return Ok(None);
    }
    while high - low > BISECTION_TOLERANCE * limit {
        let middle = 0.5 * (low + high);
        if is_growing(set, middle)? { low = middle } else { high = middle }
    }
    Ok(Some(0.5 * (low + high)))
}

/// Returns whether a small disturbance of sliding at this velocity in m/s grows.
fn is_growing(set: &[(&str, f64)], velocity: f64) -> Result<bool, BoxError> {
    Ok(disturbance_growth(Recipe::new("fig-8-16").set_all(set), velocity)? > 1.0)
}

/// Returns the factor by which a small disturbance of sliding at this velocity in m/s grows in 0.3 s: the largest
/// deviation in the last fifth of the run, divided by that in the second fifth.
pub(super) fn disturbance_growth(recipe: Recipe, velocity: f64) -> Result<f64, BoxError> {
    let recipe =
        recipe.steady_command(velocity).disturbed_sliding(DISTURBANCE).run_time(0.5).sample_interval(5e-4);
    let run = recipe.record(&["v_o"]).run("disturbed", "")?;
    let swing =
        |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max((value - velocity).abs()));
    let values = run.record.values("v_o")?;
    // The first fifth is skipped: there the lag and the position error still adjust to the disturbance.
    let part = values.len() / 5;
    Ok(swing(&values[values.len() - part..]) / swing(&values[part..2 * part]))
}
