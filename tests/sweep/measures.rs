//! Measures as they come out of a sweep, where the values are known beforehand.

use patchcord::patch::Patch;

use super::common::{element, volts};
use super::{rows, sweep};

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
