//! Fig 8.16 with its lag behind the multiplier compared with Fig 8.16: "this did not affect the simulation results at
//! all" (8.3).

use crate::others::steady_run::{THESIS, record, shipped};
use patchcord_analysis::instruments::{Criterion, critical_velocity};

/// The patch of Fig 8.16 with the lag after the multiplier.
const LAST: &str = "thesis/fig-8-16-lag-last";

/// Settings of the table: VcL in m/s and Tc in s.
pub(super) const SETTINGS: [(f64, f64); 8] = [
    (1.27e-3, 0.0065),
    (2.54e-3, 0.004),
    (2.54e-3, 0.0065),
    (2.54e-3, 0.0095),
    (2.54e-3, 0.0125),
    (5.08e-3, 0.0065),
    (5.08e-3, 0.0095),
    (10.16e-3, 0.004),
];

/// Rising and falling critical velocities of Fig 8.16, and of Fig 8.16 with its lag last, in m/s. The command rises
/// at 1.2 mm/s2 to twice VcL plus 3 mm/s, and falls again.
pub(super) fn critical(vcl: f64, tc: f64) -> [(f64, f64); 2] {
    [THESIS, LAST].map(|stem| {
        let turn = (2.0 * vcl + 3e-3) / 1.2e-3;
        let changes = [("VcL", vcl), ("Tc", tc), ("v_turn", turn)];
        let trace = record(&shipped(stem), &changes, 2.0 * turn - 0.1, &["v_i", "v_o"]);
        let [command, velocity] = ["v_i", "v_o"].map(|name| trace.values(name).unwrap());
        let criterion = Criterion { threshold: 0.25e-3, window: 0.04 };
        let read = critical_velocity(&trace.time, &command, &velocity, criterion);
        (read.rising.unwrap(), read.falling.unwrap())
    })
}

#[test]
#[ignore = "takes several seconds"]
fn position_of_the_lag_matters_for_steep_friction() {
    for (vcl, tc) in SETTINGS {
        let [(rising, falling), (last, begins)] = critical(vcl, tc);
        let change = last / rising - 1.0;
        let is_expected = if vcl < 3e-3 { change > 0.09 } else { change.abs() < 0.025 };
        assert!(is_expected, "{change} at {vcl} m/s, {tc} s");
        // Small motions about steady sliding are the same, and oscillation grows from them.
        assert!((begins / falling - 1.0).abs() < 0.05, "{begins} and {falling} at {vcl} m/s, {tc} s");
    }
}
