//! The points a to g of the thesis's comparison with Nakashima's circuit (8.3). Point h is in relays.rs.

use serde_json::{Map, Value};

use crate::common::document;
use crate::others::steady_run::{
    BRAKE, FRICTION, NAKASHIMA, SteadyRun, THESIS, edited, names, record, shipped, with_slow_multipliers,
};
use patchcord_analysis::instruments::{Criterion, critical_velocity};

/// A circuit whose parts are counted as in the text.
pub(super) struct Counts {
    elements: Map<String, Value>,
    /// Elements whose output is the output velocity, its negative or its modulus.
    velocity_elements: &'static [&'static str],
}

impl Counts {
    /// Nakashima's circuit and Fig 8.16.
    pub(super) fn both() -> [Counts; 2] {
        let velocity_elements: [&[&str]; 2] = [&["A2", "R5", "B3", "B4"], &["A3", "B3", "U"]];
        let elements = |stem| document(stem)["elements"].as_object().unwrap().clone();
        [0, 1].map(|index| Counts {
            elements: elements([NAKASHIMA, THESIS][index]),
            velocity_elements: velocity_elements[index],
        })
    }

    /// Number of elements of these kinds.
    pub(super) fn of(&self, kinds: &[&str]) -> usize {
        kinds.iter().map(|kind| names(&self.elements, kind).len()).sum()
    }

    /// Number of summing and integrating amplifiers.
    pub(super) fn amplifiers(&self) -> usize {
        self.of(&["summer", "inverter", "integrator"])
    }

    /// Number of amplifiers including the output amplifiers of multipliers and function generators, and the
    /// comparators of relays.
    pub(super) fn amplifiers_inside(&self) -> usize {
        self.amplifiers() + self.of(&["multiplier", "function-generator", "relay"])
    }

    /// Number of multipliers with a setting as one input, that is a pot on a reference.
    pub(super) fn electronic_pots(&self) -> usize {
        let is_setting = |cord: &Value| {
            let from = cord.as_str().and_then(|name| self.elements.get(name));
            from.is_some_and(|from| {
                from["kind"] == "pot" && ["+100", "-100"].iter().any(|fixed| from["in"] == *fixed)
            })
        };
        let multipliers = self.elements.values().filter(|element| element["kind"] == "multiplier");
        multipliers.filter(|element| is_setting(&element["a"]) || is_setting(&element["b"])).count()
    }

    /// Number of inputs of the output velocity.
    pub(super) fn inputs_of_velocity(&self) -> usize {
        let is_velocity =
            |value: &Value| value.as_str().is_some_and(|from| self.velocity_elements.contains(&from));
        let outside =
            self.elements.iter().filter(|(name, _)| !self.velocity_elements.contains(&name.as_str()));
        outside.map(|(_, element)| leaves(element).into_iter().filter(|leaf| is_velocity(leaf)).count()).sum()
    }

    /// Number of settings that contain a parameter.
    pub(super) fn settings_of(&self, parameter: &str) -> usize {
        let names = |text: &str| {
            text.split(|letter: char| !letter.is_alphanumeric() && letter != '_')
                .any(|word| word == parameter)
        };
        let settings =
            self.elements.values().filter(|element| element["setting"].as_str().is_some_and(names));
        settings.count()
    }
}

/// The leaf values of an element's document, which include its cords.
fn leaves(value: &Value) -> Vec<&Value> {
    match value {
        Value::Array(values) => values.iter().flat_map(leaves).collect(),
        Value::Object(fields) => fields.values().flat_map(leaves).collect(),
        other => vec![other],
    }
}

#[test]
fn point_a_nakashima_needs_nearly_twice_as_many_amplifiers() {
    let [nakashima, thesis] = Counts::both();
    assert_eq!([nakashima.amplifiers(), thesis.amplifiers()], [13, 13]);
    assert_eq!([nakashima.amplifiers_inside(), thesis.amplifiers_inside()], [27, 14]);
}

/// Time constants of the multipliers on the page, in s; 0 means no lag.
pub(super) const SLOW: [f64; 4] = [0.0, 50e-6, 100e-6, 200e-6];

/// Nakashima's circuit and Fig 8.16 with a brake at one command, with lagging multipliers.
pub(super) fn slowed(time: f64, command: f64) -> [SteadyRun; 2] {
    let patch = |stem| if time == 0.0 { shipped(stem) } else { with_slow_multipliers(stem, time) };
    [SteadyRun::set(&patch(NAKASHIMA), &[], command), SteadyRun::commanded(&patch(BRAKE), command)]
}

#[test]
fn point_b_slow_multipliers_disturb_sliding() {
    assert_eq!(Counts::both().map(|counts| counts.electronic_pots()), [7, 0]);
    let [quick, _] = slowed(0.0, 9e-3);
    let [slow, thesis] = slowed(50e-6, 9e-3);
    assert!(quick.decays(0.6) && thesis.decays(0.6));
    assert!(slow.rest_share() > 0.02, "{}", slow.rest_share());
    // The single multiplier of the thesis increases the lag of friction, which stabilises.
    assert!(slowed(200e-6, 9e-3)[1].decays(0.6));
}

#[test]
fn point_c_nakashima_permits_no_negative_velocity() {
    let reversed = edited(NAKASHIMA, |elements| elements["PV"]["in"] = "-100".into());
    let trace = record(&reversed, &[("v_set", 1e-3)], 0.2, &["v_o", "spring_force"]);
    assert!(trace.values("v_o").unwrap().iter().all(|velocity| *velocity == 0.0));
    // The spring is stretched until its amplifier is overloaded.
    assert!(trace.overloads().any(|overload| overload.element == "A1"));
    let [forward, backward] = [1e-3, -1e-3].map(|command| {
        let changes = [&FRICTION[..], &[("v_start", command), ("v_rate", 0.0)]].concat();
        record(&shipped(THESIS), &changes, 0.5, &["v_o"]).values("v_o").unwrap()
    });
    assert!(forward.iter().zip(&backward).all(|(forward, backward)| (forward + backward).abs() < 1e-12));
}

#[test]
fn point_d_quantities_have_several_inputs() {
    let [nakashima, thesis] = Counts::both();
    assert_eq!([nakashima.settings_of("M"), thesis.settings_of("M")], [3, 1]);
    assert_eq!([nakashima.settings_of("f"), thesis.settings_of("f")], [1, 1]);
    assert_eq!([nakashima.inputs_of_velocity(), thesis.inputs_of_velocity()], [4, 3]);
}

#[test]
fn point_e_main_output_is_the_total_coefficient_of_friction() {
    let names = ["mu", "spring_force", "a_o"];
    let trace = record(&shipped(NAKASHIMA), &[], 0.5, &names);
    let [mu, spring, acceleration] = names.map(|name| trace.values(name).unwrap());
    for row in 0..trace.len() {
        let friction = spring[row] - 433.0 * acceleration[row];
        assert!((mu[row] * 433.0 * 9.80665 - friction).abs() < 1e-9, "row {row}");
    }
    assert!(document(THESIS)["signals"].as_object().unwrap().keys().all(|name| name != "mu"));
}

/// Rising critical velocity of Fig 8.16 with a brake and Nakashima's friction, by one ramp of 1.2 mm/s2 up to 12 mm/s.
pub(super) fn critical_velocity_by_ramp() -> f64 {
    let trace = record(&shipped(BRAKE), &FRICTION, 10.0, &["v_i", "v_o"]);
    let [command, velocity] = ["v_i", "v_o"].map(|name| trace.values(name).unwrap());
    let criterion = Criterion { threshold: 0.25e-3, window: 0.04 };
    critical_velocity(&trace.time, &command, &velocity, criterion).rising.unwrap()
}

#[test]
fn point_f_nakashima_has_one_set_velocity_and_no_ramp() {
    let drives = |stem| document(stem)["drives"].as_object().map_or(0, Map::len);
    assert_eq!([drives(NAKASHIMA), drives(THESIS)], [0, 2]);
    let critical = critical_velocity_by_ramp();
    assert!(critical > 7e-3 && critical < 10e-3, "{critical}");
}

#[test]
fn point_g_nakashima_has_no_positions() {
    let lengths = |stem| {
        let document = document(stem);
        let scales = document["scales"].as_object().unwrap();
        scales.values().filter(|scale| scale["unit"] == "m").count()
    };
    assert_eq!([lengths(NAKASHIMA), lengths(THESIS)], [0, 1]);
    // A step of position moves the thesis's table immediately.
    let step = [("v_rate", 0.0), ("x_step", 0.0254e-3)];
    let velocity = record(&shipped(THESIS), &step, 0.05, &["v_o"]).values("v_o").unwrap();
    assert!(velocity.iter().any(|velocity| *velocity > 1e-3));
}
