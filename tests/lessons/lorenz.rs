//! Lorenz: fixed points, symmetry, contraction, and the first peaks.

use crate::common::{run_for, voltage};
use crate::known_problems::runs::{program, run, step_of};
use crate::lessons::crossings::next_rise;

const STEM: &str = "lessons/lorenz";
/// Units of z per volt.
const PROFILE: f64 = 0.6;

/// Times and heights of the first peaks of z from (1, 1, 20): Taylor series of order 40 in steps of 1/50, with
/// 40 digits (mpmath 1.3).
const PEAKS: [(f64, f64); 10] = [
    (0.531_575_382_610_344, 40.413_265_046_244),
    (1.273_892_998_468_884, 38.668_559_701_461),
    (2.281_593_197_616_826, 44.071_717_181_419),
    (2.926_062_901_526_811, 33.602_232_251_145),
    (3.583_540_651_534_529, 34.280_868_390_127),
    (4.252_817_457_015_682, 35.127_684_427_676),
    (4.940_932_368_607_833, 36.247_046_770_777),
    (5.664_984_383_316_177, 37.907_754_625_164),
    (6.510_787_914_065_246, 41.438_140_183_673),
    (7.211_323_468_563_166, 37.020_103_032_645),
];

#[test]
fn the_first_peaks_match_a_taylor_series() {
    let program = program(STEM, &[]);
    let mut machine = run_for(&program, step_of(STEM) / 4.0, 0.0);
    let rate_of_z = |machine: &patchcord::solve::Machine<'_>| -machine.rates()[2];
    for (time, height) in PEAKS {
        let found = (next_rise(&mut machine, rate_of_z), voltage(&machine, "A3") * PROFILE);
        // Errors of order 4 at steps of 1/2000, amplified by the flow as e^(0.9 t), up to 1000.
        assert!((found.0 - time).abs() < 1e-7, "{found:?} {time}");
        assert!((found.1 - height).abs() < 1e-6, "{found:?} {height}");
    }
}

#[test]
fn all_rates_are_0_at_the_fixed_points() {
    let coordinate = (8.0f64 / 3.0 * 27.0).sqrt();
    for [x, y, z] in [[0.0; 3], [coordinate, coordinate, 27.0], [-coordinate, -coordinate, 27.0]] {
        let program = program(STEM, &[("x0", x), ("y0", y), ("z0", z)]);
        let rates = run_for(&program, step_of(STEM), 0.0).rates().to_vec();
        assert!(rates.iter().all(|rate| rate.abs() < 1e-11), "{rates:?}");
    }
}

#[test]
fn a_rotated_start_gives_the_rotated_run() {
    let (one, other) = (program(STEM, &[]), program(STEM, &[("x0", -1.0), ("y0", -1.0)]));
    for time in [1.0, 10.0, 30.0] {
        let (one, other) = (run_for(&one, step_of(STEM), time), run_for(&other, step_of(STEM), time));
        let voltages = |machine| ["A1", "A2", "A3"].map(|name| voltage(machine, name));
        let ([x, y, z], rotated) = (voltages(&one), voltages(&other));
        assert_eq!([-x, -y, z], rotated, "equal bits at every time");
    }
}

#[test]
fn volumes_shrink_everywhere_at_the_same_rate() {
    let program = program(STEM, &[]);
    for time in [0.0, 3.3, 12.0] {
        let divergence = run_for(&program, step_of(STEM), time)
            .linearise()
            .by_states
            .iter()
            .enumerate()
            .map(|(index, row)| row[index])
            .sum::<f64>();
        assert!((divergence + 10.0 + 1.0 + 8.0 / 3.0).abs() < 1e-12, "{divergence}");
    }
}

#[test]
fn voltages_use_at_least_half_of_full_scale_without_overload() {
    let trace = run(STEM, &[], 200.0);
    assert_eq!(trace.overloads().count(), 0);
    for track in &trace.tracks {
        let extremes = track.extremes[0];
        let (least, most) = (extremes.least.volts, extremes.most.volts);
        let largest = most.max(-least);
        assert!((50.0..95.0).contains(&largest), "{} goes from {least} V to {most} V", track.name);
    }
}

#[test]
fn below_rho_1_it_decays_and_at_20_it_settles_on_a_fixed_point() {
    let end = |rho: f64| {
        let program = program(STEM, &[("rho", rho)]);
        let machine = run_for(&program, step_of(STEM), 200.0);
        ["A1", "A3"].map(|name| voltage(&machine, name))
    };
    assert!(end(0.5).iter().all(|volts| volts.abs() < 1e-9), "{:?}", end(0.5));
    let [x, z] = end(20.0);
    let coordinate = (8.0f64 / 3.0 * 19.0).sqrt() / 0.25;
    // The slowest mode decays as e^(-0.15 t).
    assert!((x.abs() - coordinate).abs() < 1e-9 && (z - 19.0 / PROFILE).abs() < 1e-9, "{x} {z}");
}
