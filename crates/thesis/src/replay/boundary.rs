//! Where the final circuit stops oscillating: found by ramps of the command, and by small disturbances of steady sliding.
//!
//! Critical velocities of ramps are those at which swings above 0.25 mm/s within 0.04 s end while the command rises.

use std::sync::LazyLock;

use super::recipe::{Problem, Recipe};
use crate::slideway::falling::FallingFriction;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::units::{N_PER_MM, N_S_PER_MM};
use patchcord_analysis::instruments::{Criterion, NoCriticalVelocity};

/// Time constants of the sweep in s: those that the study names, 6 ... 25 ms (8.4), and some between.
pub(super) const MEMORIES: [f64; 10] =
    [0.006, 0.0065, 0.0071, 0.0075, 0.008, 0.010, 0.0125, 0.015, 0.020, 0.025];

/// Values of VcL in the sweep, the study's range of 1.27 ... 25.4 mm/s in equal steps.
pub(super) const LIMITS: usize = 20;
/// The least of them, in units of 10 um/s, in which all are whole numbers.
const LEAST_LIMIT: usize = 127;

/// The study's rate of the velocity command, in m/s2 (8.5).
pub(super) const RATE: f64 = 1.2e-3;

/// The ramps go up to this, in m/s: beyond every critical velocity of the sweep, else there is none.
const HIGHEST: f64 = 14.4e-3;

/// What one ramp says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ceased {
    /// Time constant, in s.
    pub memory: f64,
    /// VcL, in m/s.
    pub limit: f64,
    /// The command at which oscillation ended, in m/s, or why none was read.
    pub velocity: Result<f64, NoCriticalVelocity>,
}

impl Ceased {
    /// The slope of solid friction there in N s/mm, where that still falls.
    pub fn slope(&self) -> Option<f64> {
        let slope = FallingFriction::simulated(self.limit).slope(self.velocity.ok()?).ok()?;
        (slope > 0.0).then_some(slope / N_S_PER_MM)
    }
}

/// The final circuit with a command that rises at a rate in m/s2.
pub(super) fn ramp(rate: f64) -> Recipe {
    Recipe::of("fig-8-16").set("v_rate", rate).lasting(HIGHEST / rate)
}

/// Ramps for each time constant with its VcL, at a rate, read with each of some thresholds in m/s.
pub(super) fn ramps(
    settings: &[(f64, f64)],
    rate: f64,
    thresholds: &[f64],
) -> Result<Vec<Vec<Ceased>>, Problem> {
    let rows: Vec<_> = settings.iter().map(|(memory, limit)| vec![*memory, *limit]).collect();
    let criterion = |threshold: &f64| Criterion { threshold: *threshold, ..Criterion::USUAL };
    let read = ramp(rate).recording(&["v_i", "v_o"]).each(&["Tc", "VcL"], &rows, |run| {
        let rising = |threshold| Ok::<_, Problem>(run.critical_by(criterion(threshold))?.rising);
        thresholds.iter().map(rising).collect::<Result<Vec<_>, _>>()
    })?;
    let of_threshold = |index: usize| {
        let ceased = settings.iter().zip(&read);
        let ceased = ceased.map(|((memory, limit), velocities)| Ceased {
            memory: *memory,
            limit: *limit,
            velocity: velocities[index],
        });
        ceased.collect()
    };
    Ok((0..thresholds.len()).map(of_threshold).collect())
}

/// The values of VcL in the sweep, in m/s.
pub(super) fn limits() -> Vec<f64> {
    (1..=LIMITS).map(|count| (count * LEAST_LIMIT) as f64 / 1e5).collect()
}

/// The sweep of Fig 8.30: every time constant with every VcL, at the study's rate. Made once.
pub(super) fn sweep() -> Result<&'static [Ceased], Problem> {
    static SWEEP: LazyLock<Result<Vec<Ceased>, String>> = LazyLock::new(|| {
        let with_limits =
            |memory: &f64| limits().into_iter().map(|limit| (*memory, limit)).collect::<Vec<_>>();
        let settings: Vec<_> = MEMORIES.iter().flat_map(with_limits).collect();
        let read = ramps(&settings, RATE, &[Criterion::USUAL.threshold]);
        read.map(|mut read| read.remove(0)).map_err(|problem| problem.to_string())
    });
    SWEEP.as_deref().map_err(|problem| problem.clone().into())
}

/// Those of one time constant.
pub(super) fn of_memory(ceased: &[Ceased], memory: f64) -> impl Iterator<Item = &Ceased> {
    ceased.iter().filter(move |ceased| ceased.memory == memory)
}

/// Slopes in N s/mm, by time constant in s or stiffness in N/mm, with the law that fits them.
pub(super) type Slopes = (Vec<(f64, f64)>, PowerLaw);

fn slopes(ceased: impl Iterator<Item = Ceased>) -> Result<Slopes, Problem> {
    let points: Vec<_> = ceased.filter_map(|ceased| Some((ceased.memory, ceased.slope()?))).collect();
    let law = PowerLaw::fit(&points)?;
    Ok((points, law))
}

/// Time constants in s with the VcL in m/s of the top of their curves, the highest of their critical velocities. Tops are flat: what lies
/// within 1 % of the highest is the top, and its middle is taken. Made once.
pub(super) fn tops() -> Result<&'static [(f64, f64)], Problem> {
    static TOPS: LazyLock<Result<Vec<(f64, f64)>, String>> = LazyLock::new(|| {
        let found = MEMORIES.iter().map(|memory| Ok((*memory, middle_of_top(*memory)?)));
        found.collect::<Result<_, Problem>>().map_err(|problem| problem.to_string())
    });
    TOPS.as_deref().map_err(|problem| problem.clone().into())
}

/// Near the highest of the sweep the curve is run through so many values of VcL.
const AROUND_TOP: usize = 40;

fn middle_of_top(memory: f64) -> Result<f64, Problem> {
    let height =
        |ceased: &&Ceased| if ceased.slope().is_some() { ceased.velocity.unwrap_or(0.0) } else { 0.0 };
    let highest = |ceased: &[Ceased]| ceased.iter().map(|ceased| height(&ceased)).fold(0.0, f64::max);
    let coarse: Vec<_> = of_memory(sweep()?, memory).copied().collect();
    let peak = coarse.iter().find(|ceased| height(ceased) == highest(&coarse)).ok_or("no curve has a top")?;
    let step = coarse[0].limit;
    let around =
        (1..=AROUND_TOP).map(|count| peak.limit + step * (2.0 * count as f64 / AROUND_TOP as f64 - 1.0));
    let settings: Vec<_> = around.map(|limit| (memory, limit.max(1e-3))).collect();
    let fine = ramps(&settings, RATE, &[Criterion::USUAL.threshold])?.remove(0);
    let top: Vec<_> = fine.iter().filter(|ceased| height(ceased) >= 0.99 * highest(&fine)).collect();
    Ok(top.iter().map(|ceased| ceased.limit).sum::<f64>() / top.len() as f64)
}

/// Critical velocities in m/s at the tops, by ramps at the study's rate.
pub(super) fn highest() -> Result<Vec<f64>, Problem> {
    let read = ramps(tops()?, RATE, &[Criterion::USUAL.threshold])?.remove(0);
    read.into_iter().map(|ceased| Ok(ceased.velocity?)).collect()
}

/// Slopes at the tops, by ramps at the study's rate and the usual threshold.
pub(super) fn slopes_at_tops() -> Result<Slopes, Problem> {
    Ok(slopes_at_rate(RATE, &[Criterion::USUAL.threshold])?.remove(0))
}

/// Slopes where ramps at another rate end oscillation, at the VcL of the tops, for each of some thresholds in m/s.
pub(super) fn slopes_at_rate(rate: f64, thresholds: &[f64]) -> Result<Vec<Slopes>, Problem> {
    ramps(tops()?, rate, thresholds)?.into_iter().map(|ceased| slopes(ceased.into_iter())).collect()
}

/// VcL in m/s and Tc in s of the study's tests with other stiffnesses (Fig 8.35).
const STIFFNESS_TESTS: (f64, f64) = (40e-3, 0.0071);

/// The circuit of these tests. The table moves up to twice as fast as the command, which the scales of the study have no room for.
pub(super) fn of_other_stiffness() -> Recipe {
    let (limit, memory) = STIFFNESS_TESTS;
    Recipe::of("fig-8-16").set("VcL", limit).set("Tc", memory).scaled(2.0)
}

/// The same with a command that rises at the study's rate up to VcL.
pub(super) fn ramp_of_other_stiffness() -> Recipe {
    of_other_stiffness().set("v_rate", RATE).lasting(STIFFNESS_TESTS.0 / RATE)
}

/// Solid friction of these tests.
pub(super) fn friction_of_other_stiffness() -> FallingFriction {
    FallingFriction::simulated(STIFFNESS_TESTS.0)
}

/// Critical velocities in m/s of a command that rises at the study's rate up to VcL, by stiffness in N/m; those at which it
/// oscillates.
pub(super) fn by_stiffness(stiffnesses: &[f64]) -> Result<Vec<(f64, f64)>, Problem> {
    let recipe = ramp_of_other_stiffness().recording(&["v_i", "v_o"]);
    let read = recipe.along("K", stiffnesses, |run| match run.critical()?.rising {
        Err(NoCriticalVelocity::Quiet) => Ok(None),
        velocity => Ok(Some(velocity?)),
    })?;
    Ok(read.into_iter().filter_map(|(stiffness, velocity)| Some((stiffness, velocity?))).collect())
}

/// Slopes in N s/mm at velocities in m/s, by stiffness in N/mm, with the law that fits them.
pub(super) fn slope_by_stiffness(velocities: &[(f64, f64)]) -> Result<Slopes, Problem> {
    let friction = friction_of_other_stiffness();
    let slope = |(stiffness, velocity): &(f64, f64)| {
        Ok::<_, Problem>((stiffness / N_PER_MM, friction.slope(*velocity)? / N_S_PER_MM))
    };
    let points = velocities.iter().map(slope).collect::<Result<Vec<_>, _>>()?;
    let law = PowerLaw::fit(&points)?;
    Ok((points, law))
}

/// A small disturbance: 1/1000 of the velocity.
const DISTURBED: f64 = 1.001;
/// The velocity is halved in on to this share of VcL.
const FINENESS: f64 = 5e-4;

/// The velocity in m/s above which a small disturbance of steady sliding dies away, below which it grows; none where it dies away at
/// 2 % of VcL too: friction falls the less steeply the faster the table slides. `set` are the circuit's parameters, VcL among them.
pub(super) fn undisturbed(set: &[(&str, f64)], limit: f64) -> Result<Option<f64>, Problem> {
    let (mut low, mut high) = (0.02 * limit, limit);
    if !grows(set, low)? {
        return Ok(None);
    }
    while high - low > FINENESS * limit {
        let middle = 0.5 * (low + high);
        if grows(set, middle)? { low = middle } else { high = middle }
    }
    Ok(Some(0.5 * (low + high)))
}

/// Whether a small disturbance of sliding at this velocity grows.
fn grows(set: &[(&str, f64)], velocity: f64) -> Result<bool, Problem> {
    Ok(growth(Recipe::of("fig-8-16").with(set), velocity)? > 1.0)
}

/// By what a small disturbance of sliding at this velocity in m/s has grown after 0.3 s.
pub(super) fn growth(recipe: Recipe, velocity: f64) -> Result<f64, Problem> {
    let recipe = recipe.steady(velocity).sliding(DISTURBED).lasting(0.5).every(5e-4);
    let run = recipe.recording(&["v_o"]).run("disturbed", "")?;
    let swing =
        |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max((value - velocity).abs()));
    let values = run.values("v_o")?;
    // The first cycles show what lag and error make of the disturbance.
    let part = values.len() / 5;
    Ok(swing(&values[values.len() - part..]) / swing(&values[part..2 * part]))
}
