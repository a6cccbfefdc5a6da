//! Point h of the thesis's comparison: friction applied by five relays, and the effects of their hysteresis and delay.

use serde_json::json;

use crate::common::document;
use crate::others::steady_run::{NAKASHIMA, SteadyRun, edited, names, shipped};
use patchcord_core::patch::Patch;

/// The patch with coils behind R1. R3, R4 and R5 follow R1 through a lag, and switch when the lag has reached half
/// its final value.
pub(super) fn with_coils(time: f64) -> Patch {
    edited(NAKASHIMA, |elements| {
        for relay in ["R3", "R4", "R5"] {
            elements[relay]["in"] = json!("coil");
        }
        elements.insert("coil-lag".to_owned(), json!({"kind": "lag", "in": {"x1": ["R1"]}, "time": time}));
        elements.insert("coil".to_owned(), json!({"kind": "inverter", "in": "coil-lag"}));
    })
}

/// The faults of the relays on the page, each with its run at 1 mm/s.
pub(super) fn faults() -> Vec<(String, SteadyRun)> {
    let ideal = shipped(NAKASHIMA);
    let set = |changes: &[(&str, f64)]| SteadyRun::set(&ideal, changes, 1e-3);
    let mut faults = vec![("none".to_owned(), set(&[]))];
    for volts in [0.1, 1.0] {
        faults.push((format!("hysteresis of {volts} V"), set(&[("hysteresis", volts)])));
    }
    for volts in [0.1, 1.0] {
        let run = set(&[("hysteresis", 2.0 * volts), ("late", volts)]);
        faults.push((format!("{volts} V late in both directions"), run));
    }
    for time in [0.2e-3, 1e-3, 2e-3] {
        let run = SteadyRun::set(&with_coils(time), &[], 1e-3);
        faults.push((format!("coils with {} ms", time * 1e3), run));
    }
    faults
}

#[test]
fn point_h_five_relays_apply_the_friction() {
    let relays = |stem| names(document(stem)["elements"].as_object().unwrap(), "relay").len();
    assert_eq!([relays(NAKASHIMA), relays("thesis/fig-8-16"), relays("thesis/fig-8-17")], [5, 0, 0]);
}

#[test]
fn point_h_hysteresis_alone_changes_nothing() {
    let ideal = SteadyRun::set(&shipped(NAKASHIMA), &[], 1e-3);
    let wide = SteadyRun::set(&shipped(NAKASHIMA), &[("hysteresis", 1.0)], 1e-3);
    let differences = ideal.velocity.iter().zip(&wide.velocity).map(|(one, other)| (one - other).abs());
    assert!(differences.fold(0.0, f64::max) < 1e-11, "hysteresis alone must not change the motion");
}

/// With late relays the table slides backward, and more with a longer delay.
#[test]
fn point_h_relays_that_switch_late_change_the_motion() {
    let coils = [0.2e-3, 1e-3, 2e-3].map(|time| SteadyRun::set(&with_coils(time), &[], 1e-3));
    let ideal = SteadyRun::set(&shipped(NAKASHIMA), &[], 1e-3);
    let mut before = &ideal;
    for coil in &coils {
        assert!(coil.slips_per_second() < before.slips_per_second());
        assert!(coil.max() > before.max() && coil.min() < before.min());
        before = coil;
    }
}
