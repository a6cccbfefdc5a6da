//! Where the final circuit stops oscillating: found by ramps of the command, and by small disturbances of steady sliding.
//!
//! Critical velocities of ramps are those at which swings above 0.25 mm/s within 0.04 s end while the command rises.

use std::sync::LazyLock;

use super::recipe::{Problem, Recipe, first_number};
use crate::slideway::falling::FallingFriction;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::units::N_S_PER_MM;

/// Time constants of the sweep in s: those that the study names, 6 ... 25 ms (8.4), and some between.
pub(super) const MEMORIES: [f64; 10] =
    [0.006, 0.0065, 0.0071, 0.0075, 0.008, 0.010, 0.0125, 0.015, 0.020, 0.025];

/// Values of VcL in the sweep, the study's range of 1.27 ... 25.4 mm/s in equal steps.
pub(super) const LIMITS: usize = 20;
const LEAST_LIMIT: f64 = 1.27e-3;

/// The study's rate of the velocity command, in m/s2 (8.5).
pub(super) const RATE: f64 = 1.2e-3;

/// The ramps go up to this, in m/s: beyond every critical velocity of the sweep.
const HIGHEST: f64 = 14.4e-3;

/// What one ramp says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ceased {
    /// Time constant, in s.
    pub memory: f64,
    /// VcL, in m/s.
    pub limit: f64,
    /// The command at which oscillation ended, in m/s; none where none was seen.
    pub velocity: Option<f64>,
}

impl Ceased {
    /// The slope of solid friction there in N s/mm, where that still falls.
    pub fn slope(&self) -> Option<f64> {
        let slope = FallingFriction::simulated(self.limit).slope(self.velocity?).ok()?;
        (slope > 0.0).then_some(slope / N_S_PER_MM)
    }
}

/// Ramps for each time constant with its VcL, at a rate.
pub(super) fn ramps(settings: &[(f64, f64)], rate: f64) -> Result<Vec<Ceased>, Problem> {
    let recipe = Recipe::of("fig-8-16").set("v_rate", rate).lasting(HIGHEST / rate);
    let rows = settings.iter().map(|(memory, limit)| vec![*memory, *limit]).collect();
    let rows = recipe.sweep_rows(&["Tc", "VcL"], rows, &["critical_velocity"])?;
    let ceased = settings.iter().zip(&rows);
    Ok(ceased
        .map(|((memory, limit), row)| Ceased { memory: *memory, limit: *limit, velocity: first_number(row) })
        .collect())
}

/// "Tc=0.0065,0.01".
pub(super) fn axis(name: &str, values: &[f64]) -> String {
    let values: Vec<_> = values.iter().map(f64::to_string).collect();
    format!("{name}={}", values.join(","))
}

/// The values of VcL in the sweep, in m/s.
pub(super) fn limits() -> Vec<f64> {
    (1..=LIMITS).map(|count| count as f64 * LEAST_LIMIT).collect()
}

/// The sweep of Fig 8.30: every time constant with every VcL, at the study's rate. Made once.
pub(super) fn sweep() -> Result<&'static [Ceased], Problem> {
    static SWEEP: LazyLock<Result<Vec<Ceased>, String>> = LazyLock::new(|| {
        let with_limits =
            |memory: &f64| limits().into_iter().map(|limit| (*memory, limit)).collect::<Vec<_>>();
        let settings: Vec<_> = MEMORIES.iter().flat_map(with_limits).collect();
        ramps(&settings, RATE).map_err(|problem| problem.to_string())
    });
    SWEEP.as_deref().map_err(|problem| problem.clone().into())
}

/// Those of one time constant.
pub(super) fn of_memory(ceased: &[Ceased], memory: f64) -> impl Iterator<Item = &Ceased> {
    ceased.iter().filter(move |ceased| ceased.memory == memory)
}

/// The top of the curve of one time constant: the highest critical velocity of those at which solid friction still falls.
pub(super) fn top(ceased: &[Ceased], memory: f64) -> Option<Ceased> {
    let falling = of_memory(ceased, memory).filter(|ceased| ceased.slope().is_some());
    falling
        .copied()
        .max_by(|one, other| one.velocity.partial_cmp(&other.velocity).unwrap_or(std::cmp::Ordering::Equal))
}

/// Slopes in N s/mm at the tops, by time constant in s, with the law that fits them.
pub(super) fn slopes_at_tops(ceased: &[Ceased]) -> Result<(Vec<(f64, f64)>, PowerLaw), Problem> {
    let tops = MEMORIES.iter().filter_map(|memory| top(ceased, *memory));
    let points: Vec<_> = tops.filter_map(|top| Some((top.memory, top.slope()?))).collect();
    let law = PowerLaw::fit(&points)?;
    Ok((points, law))
}

/// The same ramps at another rate, at the VcL of the tops.
pub(super) fn slopes_at_rate(rate: f64) -> Result<(Vec<(f64, f64)>, PowerLaw), Problem> {
    let ceased = sweep()?;
    let tops = MEMORIES.iter().filter_map(|memory| top(ceased, *memory)).map(|top| (top.memory, top.limit));
    let slower = ramps(&tops.collect::<Vec<_>>(), rate)?;
    let points: Vec<_> = slower.iter().filter_map(|slower| Some((slower.memory, slower.slope()?))).collect();
    let law = PowerLaw::fit(&points)?;
    Ok((points, law))
}

/// A small disturbance: 1/1000 of the velocity.
const DISTURBED: f64 = 1.001;
/// The velocity is halved in on to this share of VcL.
const FINENESS: f64 = 5e-4;

/// The velocity in m/s above which a small disturbance of steady sliding dies away, below which it grows; none where it dies away
/// however slowly the table slides. `set` are the circuit's parameters, VcL among them.
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
    let recipe = Recipe::of("fig-8-16").with(set).set("v_start", velocity).set("v_rate", 0.0);
    let run = recipe.sliding(DISTURBED).lasting(0.5).every(5e-4).recording(&["v_o"]).run("disturbed", "")?;
    let swing =
        |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max((value - velocity).abs()));
    let values = run.values("v_o")?;
    // The first cycles show what lag and error make of the disturbance.
    let part = values.len() / 5;
    Ok(swing(&values[values.len() - part..]) > swing(&values[part..2 * part]))
}
