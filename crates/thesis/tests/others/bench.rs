//! Circuits at an even command, as they are and rewired, and what is read off their velocity.

use serde_json::{Map, Value, json};

use crate::common::document;
use crate::known::runs::{ran_circuit, recording};
use patchcord_core::patch::Patch;
use patchcord_core::trace::Trace;

pub const NAKASHIMA: &str = "others/nakashima";
pub const SINGH: &str = "others/singh";
pub const THESIS: &str = "thesis/fig-8-16";
pub const BRAKE: &str = "thesis/fig-8-16-coulomb";

/// Where the weight is what Nakashima's patch has, friction that his has too: mu_s M g, and VcL.
pub const FRICTION: [(&str, f64); 2] = [("Fs", 0.1815 * 433.0 * 9.80665), ("VcL", 12.7e-3)];

const EVERY: f64 = 1e-4;

/// A patch as it stands.
pub fn shipped(stem: &str) -> Patch {
    crate::common::shipped(stem)
}

/// A patch with its document changed; on the machine that has everything.
pub fn edited(stem: &str, edit: impl FnOnce(&mut Map<String, Value>)) -> Patch {
    let mut document = document(stem);
    document["machine"] = json!("unlimited");
    let elements = document["elements"].as_object_mut().unwrap();
    elements.values_mut().for_each(|element| drop(element.as_object_mut().unwrap().remove("uses")));
    edit(elements);
    Patch::parse(stem, &document.to_string()).unwrap_or_else(|report| panic!("{report}"))
}

/// Behind every multiplier a lag: what comes out of it has a bandwidth. Lags begin where the multipliers stand.
pub fn with_slow_multipliers(stem: &str, time: f64) -> Patch {
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

/// Elements of a kind.
pub fn names(elements: &Map<String, Value>, kind: &str) -> Vec<String> {
    let of_kind = elements.iter().filter(|(_, element)| element["kind"] == kind);
    of_kind.map(|(name, _)| name.clone()).collect()
}

/// Every cord from an element that another stands for comes from that one.
fn replace_cords(value: &mut Value, instead: &impl Fn(&str) -> Option<String>) {
    match value {
        Value::String(name) => *name = instead(name).unwrap_or_else(|| name.clone()),
        Value::Array(values) => values.iter_mut().for_each(|value| replace_cords(value, instead)),
        Value::Object(fields) => fields.values_mut().for_each(|value| replace_cords(value, instead)),
        _ => (),
    }
}

/// A run with a record of its own.
pub fn record(patch: &Patch, changes: &[(&str, f64)], duration: f64, signals: &[&str]) -> Trace {
    let circuit = crate::common::circuit(patch, changes);
    ran_circuit(&circuit, &recording(&circuit, duration, EVERY, signals))
}

/// The output velocity in the last of 2 s at one command.
pub struct Even {
    command: f64,
    pub velocity: Vec<f64>,
}

impl Even {
    /// Nakashima's arrangement, or what was made of it, at a set velocity.
    pub fn set(patch: &Patch, changes: &[(&str, f64)], command: f64) -> Even {
        Even::of(patch, &[changes, &[("v_set", command)]].concat(), command)
    }

    /// Fig 8.16, or what was made of it, with Nakashima's friction at the same command.
    pub fn commanded(patch: &Patch, command: f64) -> Even {
        Even::of(patch, &[&FRICTION[..], &[("v_start", command), ("v_rate", 0.0)]].concat(), command)
    }

    fn of(patch: &Patch, changes: &[(&str, f64)], command: f64) -> Even {
        let trace = record(patch, changes, 2.0, &["v_o"]);
        let lit: Vec<_> = trace.overloads().map(|overload| &overload.element).collect();
        assert!(lit.is_empty(), "{changes:?}: {lit:?}");
        let velocity = trace.values("v_o").unwrap();
        Even { command, velocity: velocity[velocity.len() / 2..].to_vec() }
    }

    /// Share of the time for which it stands still.
    pub fn stands(&self) -> f64 {
        self.velocity.iter().filter(|velocity| **velocity == 0.0).count() as f64 / self.velocity.len() as f64
    }

    pub fn least(&self) -> f64 {
        self.velocity.iter().copied().fold(f64::MAX, f64::min)
    }

    pub fn most(&self) -> f64 {
        self.velocity.iter().copied().fold(f64::MIN, f64::max)
    }

    /// Rises of the velocity through the command in a second.
    pub fn slips_per_second(&self) -> f64 {
        let ahead = |row: usize| self.velocity[row] >= self.command;
        let slips: Vec<_> = (1..self.velocity.len()).filter(|row| !ahead(row - 1) && ahead(*row)).collect();
        (slips.len() - 1) as f64 / ((slips[slips.len() - 1] - slips[0]) as f64 * EVERY)
    }

    /// Whether the swing is less at the end than at the beginning, by so much at least.
    pub fn dies_away(&self, share: f64) -> bool {
        let quarter = self.velocity.len() / 4;
        let swing = |part: &[f64]| {
            part.iter().fold(0.0, |swing: f64, velocity| swing.max((velocity - self.command).abs()))
        };
        swing(&self.velocity[3 * quarter..]) < share * swing(&self.velocity[..quarter])
    }
}
