//! The number of steps of a run, so that accepted patches end soon. A run that takes longer is then a hang.
//!
//! Drives force steps, such as at the edges of a square wave. A run that is short in time may thus have many steps.

use super::document::Node;
use crate::common::random::SplitMix64;

/// The largest number of steps of a run with the run plan of its patch.
const MAX_PLAN_STEPS: f64 = 2e3;

/// The longest run whose steps are chosen by the solver, in machine seconds.
const LONGEST_ADAPTIVE: f64 = 1e-2;

/// The steps of a run.
pub(crate) struct Pace {
    /// The length of a step in problem seconds.
    pub step: f64,
    /// The longest run whose steps are chosen by the solver, in problem seconds.
    pub longest_adaptive: f64,
    /// Whether the patch has a tolerance.
    has_tolerance: bool,
    /// The number of steps with the run plan of the patch. `None` if it is not known.
    plan_steps: Option<f64>,
}

impl Pace {
    /// The pace of a document, which may be wrong in any way.
    pub(crate) fn of(document: &Node, random: &mut SplitMix64) -> Pace {
        let time_scale = positive(document, "time_scale").unwrap_or(1.0);
        let shortest = shortest_time(document, time_scale);
        let run = document.get("run");
        let step = run.and_then(|run| positive(run, "step")).map(|step| step.min(shortest));
        Pace {
            step: step.unwrap_or_else(|| random.log_uniform(1e-6, 1.0).min(shortest)),
            longest_adaptive: (LONGEST_ADAPTIVE / time_scale).min(MAX_PLAN_STEPS * shortest),
            has_tolerance: run.is_some_and(|run| run.get("tolerance").is_some()),
            plan_steps: step.and_then(|step| Some(duration(run?)? / step)),
        }
    }

    /// Whether the run plan of the patch is short.
    pub(crate) fn is_short(&self) -> bool {
        !self.has_tolerance && self.plan_steps.is_some_and(|steps| steps <= MAX_PLAN_STEPS)
    }

    /// The duration of a number of steps of the patch, in problem seconds.
    pub(crate) fn duration(&self, steps: f64) -> f64 {
        let duration = self.step * steps;
        if self.has_tolerance { duration.min(self.longest_adaptive) } else { duration }
    }
}

/// The positive number with this key. `None` for other values.
fn positive(node: &Node, key: &str) -> Option<f64> {
    node.get(key)?.as_number().filter(|number| *number > 0.0 && number.is_finite())
}

/// The shortest period or interval of a drive, or time of a delay or lag, of a document, in problem seconds. Steps are
/// not longer.
fn shortest_time(document: &Node, time_scale: f64) -> f64 {
    let mut shortest = f64::INFINITY;
    document.visit("", &mut |key, node| {
        let Some(number) = node.as_number().filter(|number| *number > 0.0 && number.is_finite()) else {
            return;
        };
        let seconds = match key {
            "every" | "width" | "period" => number,
            // A chirp has its first and its last frequency.
            "frequency" | "from" | "to" => 1.0 / number,
            "delay" | "time" => number / time_scale,
            _ => return,
        };
        shortest = shortest.min(seconds);
    });
    shortest
}

/// The duration of a run plan in problem seconds. `None` if it is not known.
fn duration(run: &Node) -> Option<f64> {
    match run.get("phases") {
        Some(phases) => phases_duration(phases),
        None => {
            let repeats = run.get("repeat").map_or(Some(1.0), Node::as_number)?;
            Some(positive(run, "for")? * repeats.abs())
        }
    }
}

/// The duration of a list of phases. `None` if it is not known.
fn phases_duration(phases: &Node) -> Option<f64> {
    let Node::List(phases) = phases else { return None };
    phases.iter().map(phase_duration).sum()
}

/// The duration of a phase. `None` if it is not known.
fn phase_duration(phase: &Node) -> Option<f64> {
    let times = phase.entries().iter().map(|(key, value)| match key.as_str() {
        "operate" | "hold" => value.as_number().map(f64::abs),
        "phases" => Some(phases_duration(value)? * phase.get("repeat")?.as_number()?.abs()),
        _ => Some(0.0),
    });
    times.sum()
}
