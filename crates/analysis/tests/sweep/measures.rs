//! Measures of sweeps, compared with known values.

use super::{rows, sweep};
use crate::common::{element, shipped, volts};
use patchcord_core::patch::Patch;

/// The command rises by 2 mm/s2 for 4 s and falls back. v_o swings at 50 Hz until the command reaches `end`, and again
/// when it has fallen to 3 mm/s. u is constant for 0.4 s, then rises by 10 V/s. S overloads when u exceeds 10 V.
fn with_known_measures() -> Patch {
    let oscillation = element("sine").set("amplitude", "size").set("frequency", 50);
    let relay = element("relay").cord("in", "v_i").cord("on", "ground").cord("off", "w");
    volts("known measures")
        .parameter("end", 5e-3, "m/s", [4e-3, 7e-3])
        .parameter("size", 4e-3, "m/s", [1e-3, 9e-3])
        .scale("velocity", 1e-4, "m/s")
        .drive("v_i", "velocity", element("ramp").set("rate", 2e-3).set("turn", 4))
        .drive("w", "velocity", oscillation)
        .drive("u", "volt", element("table").set("points", serde_json::json!([[0.4, 0], [2.4, 20]])))
        .element("K", relay.set("pull_in", "end / velocity").set("drop_out", 30))
        .element("S", element("summer").cords("x10", ["u"]))
        .signal("v_o", "K", "velocity", 1.0)
        .signal("s", "S", "volt", 1.0)
        .run(8.0, 1e-3)
        .build()
        .unwrap_or_else(|report| panic!("{report}"))
}

#[test]
fn every_measure_has_its_own_column() {
    let measures = ["amplitude:w", "frequency:w", "critical_velocity", "stick_end:u", "overload"];
    let sweep =
        sweep(&with_known_measures(), &["end=4.5e-3,6e-3", "size=3e-3,5e-3"], &measures, |settings| settings);
    for (row, (end, size)) in
        rows(&sweep, 2).iter().zip([(4.5e-3, 3e-3), (4.5e-3, 5e-3), (6e-3, 3e-3), (6e-3, 5e-3)])
    {
        let cells: Vec<&str> = row.split(',').collect();
        let near = |column: usize, expected: f64, tolerance: f64| {
            let found: f64 = cells[column].parse().unwrap_or_else(|_| panic!("column {column} of {row}"));
            assert!((found - expected).abs() <= tolerance, "column {column}: {found}, expected {expected}");
        };
        near(0, end, 0.0);
        near(1, size, 0.0);
        // Extremes are interpolated by parabolas, with 20 samples per cycle.
        near(2, size, 2e-4 * size);
        near(3, 50.0, 1e-2);
        // The command changes by 0.08 mm/s in a window of 40 ms.
        near(4, end, 0.08e-3);
        near(5, 3e-3, 0.08e-3);
        near(6, 0.4, 1e-3);
        assert_eq!(cells[7], "S");
        near(8, 1.4, 1e-3);
    }
}

/// A velocity of 3 + 2 sin(w t) mm/s and a force of 50 + 30 sin(w t + lead) N at 40 Hz, in mm/s and kN.
fn driven() -> Patch {
    let sine = |size: f64| element("sine").set("amplitude", size).set("frequency", 40);
    volts("driven")
        .parameter("lead", 0.5, "1", [-3.0, 3.0])
        .scale("velocity", 0.1, "mm/s")
        .scale("force", 1e-3, "kN")
        .drive("v", "velocity", sine(2.0).set("offset", 3))
        .drive("F", "force", sine(0.03).set("offset", 0.05).set("phase", "lead"))
        .element("B", element("inverter").cord("in", "v"))
        .run(1.0, 1e-4)
        .build()
        .unwrap_or_else(|report| panic!("{report}"))
}

#[test]
fn a_friction_loop_is_measured_in_si_units() {
    let sweep = sweep(&driven(), &["lead=-1,0.5"], &["friction_loop:v,F"], |settings| settings);
    for (row, lead) in rows(&sweep, 1).iter().zip([-1.0_f64, 0.5]) {
        let cells: Vec<f64> = row.split(',').take(3).map(|cell| cell.parse().unwrap()).collect();
        let area = std::f64::consts::PI * 2e-3 * 30.0 * lead.sin();
        let work = (3e-3 * 50.0 + 0.5 * 2e-3 * 30.0 * lead.cos()) / 40.0;
        // With 250 samples per cycle the area of the polygon is too small by 1e-4.
        assert!((cells[1] / area - 1.0).abs() < 3e-4, "{row}: {area}");
        assert!((cells[2] / work - 1.0).abs() < 3e-4, "{row}: {work}");
    }
}

#[test]
fn profile_and_range_agree_with_the_critical_velocity() {
    let measures = ["critical_velocity", "critical_velocity_range", "profile", "friction_loop"];
    let sweep = sweep(&shipped("thesis/fig-8-16"), &["VcL=2.54e-3,12.7e-3"], &measures, |settings| settings);
    for (row, sticks) in rows(&sweep, 2).iter().zip([true, false]) {
        let cells: Vec<&str> = row.split(',').collect();
        let number =
            |column: usize| cells[column].parse::<f64>().unwrap_or_else(|_| panic!("{column} of {row}"));
        let (rising, minimum, maximum) = (number(1), number(3), number(4));
        assert!(minimum < rising && rising < maximum && maximum < 1.3 * minimum, "{row}");
        assert_eq!(number(5), 0.0, "every criterion can be read");
        let falling = [2, 6, 7, 8].map(|column| cells[column]);
        assert_eq!(falling, [""; 4], "the command does not fall");
        assert_eq!((number(9), number(13)), (number(10), rising), "{row}");
        assert_eq!((cells[11].is_empty(), cells[12].is_empty()), (!sticks, !sticks), "{row}");
        assert!(!sticks || (number(11) == number(9) && number(12) < rising), "{row}");
        // If friction falls slowly, the last half of the run still oscillates.
        assert_eq!((cells[14].is_empty(), cells[15].is_empty()), (sticks, sticks), "{row}");
        let none = "friction_loop_area: the velocity completes 0 whole cycles of 1 requested";
        assert_eq!(row.contains(none), sticks, "{row}");
    }
}
