//! Runs of circuits at a steady command, unchanged or rewired, and the quantities read from their velocity.

use serde_json::{Map, Value, json};

use crate::common::document;
use crate::known_problems::runs::{recording_settings, run_circuit};
use crate::velocity_readings;
use patchcord_core::patch::Patch;
use patchcord_core::trace::Trace;

/// The patch of Nakashima's circuit.
pub(super) const NAKASHIMA: &str = "others/nakashima";
/// The patch of Singh's circuit.
pub(super) const SINGH: &str = "others/singh";
/// The patch of the final circuit of the thesis.
pub(super) const THESIS: &str = "thesis/fig-8-16";
/// The patch of Fig 8.16 with a brake in place of the dead zone.
pub(super) const BRAKE: &str = "thesis/fig-8-16-coulomb";

/// Parameters that give Fig 8.16 the friction of Nakashima's patch: Fs = mu_s M g, and VcL.
pub(super) const FRICTION: [(&str, f64); 2] = [("Fs", 0.1815 * 433.0 * 9.80665), ("VcL", 12.7e-3)];

/// Interval of the recorded samples in s.
const EVERY: f64 = 1e-4;

/// A shipped patch, unchanged.
pub(super) fn shipped(stem: &str) -> Patch {
    crate::common::shipped(stem)
}

/// A patch with an edited document, on the unlimited machine.
pub(super) fn edited(stem: &str, edit: impl FnOnce(&mut Map<String, Value>)) -> Patch {
    let mut document = document(stem);
    document["machine"] = json!("unlimited");
    let elements = document["elements"].as_object_mut().unwrap();
    elements.values_mut().for_each(|element| drop(element.as_object_mut().unwrap().remove("uses")));
    edit(elements);
    Patch::parse(stem, &document.to_string()).unwrap_or_else(|report| panic!("{report}"))
}

/// A patch with a lag behind every multiplier, which limits the bandwidth of its output. The lags start at the
/// initial outputs of the multipliers.
pub(super) fn with_slow_multipliers(stem: &str, time: f64) -> Patch {
    let program = crate::common::program(&shipped(stem), &[]);
    let machine = patchcord_core::solve::Machine::new(&program, 2e-5).unwrap();
    edited(stem, |elements| {
        let multipliers: Vec<_> = names(elements, "multiplier");
        let slow = |name: &str| multipliers.iter().any(|of| of == name).then(|| format!("{name}-slow"));
        elements.values_mut().for_each(|element| replace_cords(element, &slow));
        for name in &multipliers {
            let initial = -machine.voltage(name).unwrap();
            let lag = json!({"kind": "lag", "in": {"x1": [name]}, "time": time, "initial": initial});
            elements.insert(format!("{name}-lag"), lag);
            elements.insert(format!("{name}-slow"), json!({"kind": "inverter", "in": format!("{name}-lag")}));
        }
    })
}

/// Names of the elements of a kind.
pub(super) fn names(elements: &Map<String, Value>, kind: &str) -> Vec<String> {
    let of_kind = elements.iter().filter(|(_, element)| element["kind"] == kind);
    of_kind.map(|(name, _)| name.clone()).collect()
}

/// Redirects every cord whose source has a replacement to this replacement.
fn replace_cords(value: &mut Value, instead: &impl Fn(&str) -> Option<String>) {
    match value {
        Value::String(name) => *name = instead(name).unwrap_or_else(|| name.clone()),
        Value::Array(values) => values.iter_mut().for_each(|value| replace_cords(value, instead)),
        Value::Object(fields) => fields.values_mut().for_each(|value| replace_cords(value, instead)),
        _ => (),
    }
}

/// A run that records the given signals.
pub(super) fn record(patch: &Patch, changes: &[(&str, f64)], duration: f64, signals: &[&str]) -> Trace {
    let circuit = crate::common::circuit(patch, changes);
    run_circuit(&circuit, &recording_settings(&circuit, duration, EVERY, signals))
}

/// The output velocity in the last second of 2 s at a steady command.
pub(super) struct SteadyRun {
    /// The command in m/s.
    command: f64,
    /// The output velocity in m/s.
    pub velocity: Vec<f64>,
}

impl SteadyRun {
    /// Nakashima's circuit, unchanged or rewired, at a set velocity in m/s.
    pub(super) fn set(patch: &Patch, changes: &[(&str, f64)], command: f64) -> SteadyRun {
        SteadyRun::of(patch, &[changes, &[("v_set", command)]].concat(), command)
    }

    /// Fig 8.16, unchanged or rewired, with Nakashima's friction at the same command in m/s.
    pub(super) fn commanded(patch: &Patch, command: f64) -> SteadyRun {
        SteadyRun::of(patch, &[&FRICTION[..], &[("v_start", command), ("v_rate", 0.0)]].concat(), command)
    }

    /// Runs 2 s and keeps the second half. Panics if an overload lamp lit.
    fn of(patch: &Patch, changes: &[(&str, f64)], command: f64) -> SteadyRun {
        let trace = record(patch, changes, 2.0, &["v_o"]);
        let overloaded: Vec<_> = trace.overloads().map(|overload| &overload.element).collect();
        assert!(overloaded.is_empty(), "{changes:?}: {overloaded:?}");
        let velocity = trace.values("v_o").unwrap();
        SteadyRun { command, velocity: velocity[velocity.len() / 2..].to_vec() }
    }

    /// Share of the time at rest.
    pub(super) fn rest_share(&self) -> f64 {
        self.velocity.iter().filter(|velocity| **velocity == 0.0).count() as f64 / self.velocity.len() as f64
    }

    /// The minimum velocity in m/s.
    pub(super) fn min(&self) -> f64 {
        velocity_readings::min(&self.velocity)
    }

    /// The maximum velocity in m/s.
    pub(super) fn max(&self) -> f64 {
        velocity_readings::max(&self.velocity)
    }

    /// Number of rises of velocity through the command per second.
    pub(super) fn slips_per_second(&self) -> f64 {
        let slips = velocity_readings::slips(&self.velocity, |_| self.command);
        velocity_readings::slips_per_second(&slips, EVERY)
    }

    /// Whether the swing in the last quarter is less than `share` times the swing in the first quarter.
    pub(super) fn decays(&self, share: f64) -> bool {
        let quarter = self.velocity.len() / 4;
        let swing = |part: &[f64]| {
            part.iter().fold(0.0, |swing: f64, velocity| swing.max((velocity - self.command).abs()))
        };
        swing(&self.velocity[3 * quarter..]) < share * swing(&self.velocity[..quarter])
    }
}
