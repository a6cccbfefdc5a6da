//! Measures as they come out of a sweep, where the values are known beforehand.

use super::{rows, sweep};
use crate::common::{element, shipped, volts};
use patchcord_core::patch::Patch;

/// The command rises by 2 mm/s2 for 4 s and comes back. v_o swings at 50 Hz until the command has risen to `end`, and again once it
/// has fallen to 3 mm/s. u stands still for 0.4 s and then rises by 10 V/s; S is asked for more than 100 V when u passes 10 V.
fn known() -> Patch {
    let swing = element("sine").set("amplitude", "size").set("frequency", 50);
    let relay = element("relay").cord("in", "v_i").cord("on", "ground").cord("off", "w");
    volts("known")
        .parameter("end", 5e-3, "m/s", [4e-3, 7e-3])
        .parameter("size", 4e-3, "m/s", [1e-3, 9e-3])
        .scale("velocity", 1e-4, "m/s")
        .drive("v_i", "velocity", element("ramp").set("rate", 2e-3).set("turn", 4))
        .drive("w", "velocity", swing)
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
    let sweep = sweep(&known(), &["end=4.5e-3,6e-3", "size=3e-3,5e-3"], &measures, |own| own);
    for (row, (end, size)) in
        rows(&sweep, 2).iter().zip([(4.5e-3, 3e-3), (4.5e-3, 5e-3), (6e-3, 3e-3), (6e-3, 5e-3)])
    {
        let cells: Vec<&str> = row.split(',').collect();
        let near = |column: usize, wanted: f64, within: f64| {
            let found: f64 = cells[column].parse().unwrap_or_else(|_| panic!("column {column} of {row}"));
            assert!((found - wanted).abs() <= within, "column {column}: {found} and not {wanted}");
        };
        near(0, end, 0.0);
        near(1, size, 0.0);
        // Extremes are those of parabolas through 20 samples a cycle.
        near(2, size, 2e-4 * size);
        near(3, 50.0, 1e-2);
        // Windows of 40 ms, in which the command goes 0.08 mm/s.
        near(4, end, 0.08e-3);
        near(5, 3e-3, 0.08e-3);
        near(6, 0.4, 1e-3);
        assert_eq!(cells[7], "S");
        near(8, 1.4, 1e-3);
    }
}

/// A velocity of 3 + 2 sin mm/s and a force of 50 + 30 sin N that leads it by `lead`, at 40 Hz, in mm/s and kN.
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
    let sweep = sweep(&driven(), &["lead=-1,0.5"], &["friction_loop:v,F"], |own| own);
    for (row, lead) in rows(&sweep, 1).iter().zip([-1.0_f64, 0.5]) {
        let cells: Vec<f64> = row.split(',').take(3).map(|cell| cell.parse().unwrap()).collect();
        let area = std::f64::consts::PI * 2e-3 * 30.0 * lead.sin();
        let work = (3e-3 * 50.0 + 0.5 * 2e-3 * 30.0 * lead.cos()) / 40.0;
        // 250 samples make the polygon of a cycle smaller by 1e-4.
        assert!((cells[1] / area - 1.0).abs() < 3e-4, "{row}: {area}");
        assert!((cells[2] / work - 1.0).abs() < 3e-4, "{row}: {work}");
    }
}

#[test]
fn a_profile_and_its_range_go_with_the_critical_velocity() {
    let measures = ["critical_velocity", "critical_velocity_range", "profile", "friction_loop"];
    let sweep = sweep(&shipped("thesis/fig-8-16"), &["VcL=2.54e-3,12.7e-3"], &measures, |own| own);
    for (row, sticks) in rows(&sweep, 2).iter().zip([true, false]) {
        let cells: Vec<&str> = row.split(',').collect();
        let number =
            |column: usize| cells[column].parse::<f64>().unwrap_or_else(|_| panic!("{column} of {row}"));
        let (rising, least, most) = (number(1), number(3), number(4));
        assert!(least < rising && rising < most && most < 1.3 * least, "{row}");
        assert_eq!(number(5), 0.0, "every criterion can be read");
        let back = [2, 6, 7, 8].map(|column| cells[column]);
        assert_eq!(back, [""; 4], "it does not come back");
        assert_eq!((number(9), number(13)), (number(10), rising), "{row}");
        assert_eq!((cells[11].is_empty(), cells[12].is_empty()), (!sticks, !sticks), "{row}");
        assert!(!sticks || (number(11) == number(9) && number(12) < rising), "{row}");
        // In its last half it still oscillates where friction falls slowly.
        assert_eq!((cells[14].is_empty(), cells[15].is_empty()), (sticks, sticks), "{row}");
        let quiet = "friction_loop_area: it oscillates for 0 whole cycles of 1";
        assert_eq!(row.contains(quiet), sticks, "{row}");
    }
}
