//! Unit tests of `describing`.

use proptest::prelude::*;

use super::*;
use crate::slideway::units::{MM, MM_PER_S, N_S_PER_MM};

/// The table of Table T9-6, which was read with f = 10.71 N s/mm and VcL = 40 mm/s.
fn table(stiffness: f64) -> DrivenTable {
    DrivenTable { stiffness, damping: 10.71e3, ..DrivenTable::simulated(0.0) }
}

fn assert_near(got: f64, expected: f64, tolerance: f64) {
    assert!((got - expected).abs() <= tolerance, "got {got}, expected {expected}");
}

#[test]
fn tables_of_the_thesis_are_reproduced() {
    for (force, friction, reciprocal, degrees) in
        [(20.0, 0.0, 1.88, 0.0), (20.0, 10.0, 1.69, 26.6), (5.0, 0.6, 1.587, 6.84), (1.0, 4.0, 0.37, 75.96)]
    {
        let swing = Swing { force, friction };
        assert_near(swing.reciprocal().unwrap(), reciprocal, 5e-3);
        assert_near(swing.angle().unwrap().to_degrees(), degrees, 0.05);
    }
    assert_near(DrivenTable::simulated(0.0).open_loop(100.0).unwrap().norm(), 10.09, 5e-3);
    assert_near(DrivenTable::simulated(0.0).open_loop_angle(100.0).unwrap().to_degrees(), 13.9, 0.05);
    let cycle = table(45e6).limit_cycle(20.0).unwrap();
    assert_near(cycle.slope / N_S_PER_MM, 20.13, 0.02);
    assert_near(cycle.frequency, 235.0, 0.1);
    assert_near(cycle.friction_amplitude(), 2.10, 0.01);
    let motion = cycle.oscillation(&table(45e6), &FallingFriction::simulated(0.04)).unwrap();
    assert_near(motion.velocity / MM_PER_S, 19.1, 0.01);
    assert_near(motion.error / MM, 0.0909, 1e-4);
    assert_near(motion.swing / MM_PER_S, 21.36, 0.02);
    assert!(motion.is_stick_slip());
}

/// Fundamental of E sin(t) - n cos(t), cut off at -1, by the integrals of eq 46-9 and 47-9.
fn by_integrals(force: f64, friction: f64) -> Complex<f64> {
    const POINTS: usize = 20_000;
    let step = 2.0 * PI / POINTS as f64;
    let sums = (0..POINTS).map(|index| {
        let (sine, cosine) = (step * index as f64).sin_cos();
        Complex::new(sine, cosine) * cut_off(force * sine - friction * cosine)
    });
    sums.sum::<Complex<f64>>() * step / (PI * force)
}

/// The thesis's own formulas: eq 67-9, 69-9, 70-9 for n < a, eq 75-9, 77-9, 78-9 for n > a, in units of a.
fn in_branches(force: f64, friction: f64) -> f64 {
    let squared = force.powi(2) + friction.powi(2);
    let root = (squared - 1.0).sqrt();
    let third = ((force * root - friction) / squared).acos();
    let other = ((force * root + friction) / squared).acos();
    let turn = if friction < 1.0 { third + other } else { third - other };
    0.5 * (1.0 + turn / PI) + root / (PI * squared)
}

proptest! {
    #[test]
    fn describing_function_equals_its_integrals(force in 0.1..30.0f64, friction in 0.0..15.0f64) {
        let got = Swing { force, friction }.describing_function().unwrap();
        prop_assert!((got - by_integrals(force, friction)).norm() < 1e-6);
    }

    #[test]
    fn one_formula_covers_both_branches_of_the_thesis(force in 1.0..30.0f64, friction in 0.01..15.0f64) {
        let got = Swing { force, friction }.describing_function().unwrap().re;
        prop_assert!((got - in_branches(force, friction)).abs() < 1e-7);
    }

    #[test]
    fn limit_cycle_solves_the_loop_equation(
        memory in 0.0..0.02f64, damping in 2e3..4e4f64, stiffness in 5e6..1e8f64, force in 0.5..40.0f64,
    ) {
        let table = DrivenTable { mass: 433.0, stiffness, damping, memory };
        let cycle = table.limit_cycle(force).unwrap();
        let lag = Complex::new(1.0, cycle.frequency * memory);
        let sum = Complex::new(1.0, 0.0) - Complex::new(0.0, cycle.friction_ratio) / lag;
        let function = sum * cut_off_gain(force * sum.norm());
        let closed = function * table.open_loop(cycle.frequency).unwrap() + 1.0;
        prop_assert!(closed.norm() < 1e-9, "{}", closed);
    }

    #[test]
    fn oscillation_at_a_velocity_is_its_limit_cycle(memory in 0.0..0.005f64, force in 1.5..20.0f64) {
        let (table, friction) = (DrivenTable::simulated(memory), FallingFriction::simulated(0.01));
        let wanted = table.limit_cycle(force).unwrap().oscillation(&table, &friction).unwrap();
        let got = oscillation_at(&table, &friction, wanted.velocity).unwrap();
        prop_assert!((got.swing / wanted.swing - 1.0).abs() < 1e-6);
        prop_assert!((got.frequency / wanted.frequency - 1.0).abs() < 1e-9);
    }
}

#[test]
fn small_swings_agree_with_routh_hurwitz() {
    let table = DrivenTable::simulated(0.0065);
    let cycle = table.limit_cycle(0.5).unwrap();
    assert_eq!(cycle.gain, 1.0);
    assert_near(cycle.slope / table.critical_slope().unwrap(), 1.0, 1e-12);
    assert_near(cycle.frequency / table.boundary_frequency().unwrap(), 1.0, 1e-12);
}

#[test]
fn sticking_ends_where_the_swing_reaches_standstill() {
    let (table, friction) = (DrivenTable::simulated(0.0065), FallingFriction::simulated(0.010_16));
    let end = end_of_sticking(&table, &friction).unwrap();
    assert_near(end.swing / end.velocity, 1.0, 1e-9);
    assert_near(oscillation_at(&table, &friction, end.velocity).unwrap().swing / end.swing, 1.0, 1e-6);
    assert!(end.velocity < table.critical_velocity(&friction).unwrap());
    assert!(end_of_sticking(&DrivenTable { memory: 0.02, ..table }, &friction).is_err());
    assert!(end_of_sticking(&DrivenTable { damping: 0.0, ..table }, &friction).is_err());
}

#[test]
fn limit_cycle_exists_only_between_its_bounds() {
    let (table, friction) = (DrivenTable::simulated(0.0), FallingFriction::simulated(0.04));
    let error = |velocity| oscillation_at(&table, &friction, velocity).unwrap_err().to_string();
    assert!(error(0.035).contains("too small"));
    assert!(error(0.005).contains("without limit"));
    assert!(DrivenTable { damping: 0.0, ..table }.limit_cycle(1.0).is_err());
    assert_eq!(dead_zone_gain(0.5), 0.0);
    assert_near(dead_zone_gain(1e6), 1.0, 1e-5);
}
