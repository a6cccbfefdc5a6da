//! Motions with closed solutions.

use super::{assert_range, driven, integral, product, range_of, solved, sum};
use crate::graph::{NodeId, Operation};
use crate::symbolic::Fraction;

/// The angular frequency of the oscillator in rad/s.
const FREQUENCY: f64 = 3.0;
/// The damping of the oscillator in 1/s.
const DAMPING: f64 = 0.2;

/// An oscillator x'' = -w^2 x - 2 d x' that starts at 1 with velocity 0: x is node 0, x' is node 1.
fn oscillator() -> Vec<(&'static str, Operation)> {
    let velocity = integral(0.0, &[(-FREQUENCY * FREQUENCY, 0), (-2.0 * DAMPING, 1)]);
    vec![("x", integral(1.0, &[(1.0, 1)])), ("x'", velocity)]
}

#[test]
fn an_oscillator_has_the_peaks_of_its_closed_solution() {
    let damped = (FREQUENCY * FREQUENCY - DAMPING * DAMPING).sqrt();
    let lowest = -(-DAMPING * std::f64::consts::PI / damped).exp();
    // The velocity -w^2/wd exp(-d t) sin(wd t) turns first where tan(wd t) = wd/d, and again half a period later.
    let fastest = FREQUENCY * (-DAMPING / damped * (damped / DAMPING).atan()).exp();
    let mut nodes = oscillator();
    nodes.push(("x x'", product(0, 1)));
    let ranges = solved(10.0, nodes);
    assert_range(&ranges, 0, [lowest, 1.0]);
    assert_range(&ranges, 1, [-fastest, -fastest * lowest]);
    assert!((ranges.rates[0] - fastest).abs() < 1e-5 * fastest);
    assert!(
        (ranges.rates[1] - FREQUENCY * FREQUENCY).abs() < 1e-9,
        "the acceleration is largest at the start"
    );
    let motion = |t: f64| {
        let (sine, cosine) = (damped * t).sin_cos();
        let decay = (-DAMPING * t).exp();
        let position = decay * (cosine + DAMPING / damped * sine);
        position * -FREQUENCY * FREQUENCY / damped * decay * sine
    };
    assert_range(&ranges, 2, range_of(10.0, motion));
}

#[test]
fn a_delayed_feedback_has_the_range_of_the_method_of_steps() {
    // x' = -x(t - 1) from 1: x is 1 - t, then + (t - 1)^2/2, then - (t - 2)^3/6. It turns at 2 s.
    let delay = Operation::Delay { input: NodeId(0), time: Fraction::whole(1), initial: Fraction::whole(1) };
    let ranges = solved(3.0, vec![("x", integral(1.0, &[(-1.0, 1)])), ("past", delay)]);
    assert_range(&ranges, 0, [-0.5, 1.0]);
    assert_range(&ranges, 1, [-0.5, 1.0]);
    assert!((ranges.rates[0] - 1.0).abs() < 1e-9);
}

#[test]
fn a_delay_keeps_jumps() {
    // A step of 4 mm at 0.25 s arrives at 0.75 s; its integral ends at 4 mm x 0.25 s.
    let drive = r#"{"kind": "step", "height": 4, "at": 0.25, "scale": "force"}"#;
    let time = Fraction::number(0.5);
    let delay = Operation::Delay { input: NodeId(0), time, initial: Fraction::zero() };
    let nodes = vec![
        ("push", Operation::Drive("push".to_owned())),
        ("late", delay),
        ("x", integral(0.0, &[(1.0, 1)])),
    ];
    let ranges = driven(1.0, drive, nodes);
    assert_range(&ranges, 1, [0.0, 4e-3]);
    assert_range(&ranges, 2, [0.0, 1e-3]);
}

#[test]
fn a_triangular_drive_is_integrated_from_corner_to_corner() {
    // The drive rises to 4 mm in 1 s and falls to -4 mm at 3 s. The integral is largest at 2 s, after both halves.
    let drive = r#"{"kind": "triangle", "amplitude": 4, "frequency": 0.25, "scale": "force"}"#;
    let nodes = vec![("push", Operation::Drive("push".to_owned())), ("x", integral(0.0, &[(1.0, 0)]))];
    let ranges = driven(3.5, drive, nodes);
    assert!((ranges.nodes[0][0] + 4e-3).abs() < 1e-12 && (ranges.nodes[0][1] - 4e-3).abs() < 1e-12);
    assert_range(&ranges, 1, [0.0, 4e-3]);
    assert!((ranges.rates[1] - 4e-3).abs() < 1e-12);
}

#[test]
fn a_pulse_between_steps_is_not_missed() {
    // A pulse of 2 mm for 1/10 000 of the run.
    let drive = r#"{"kind": "pulse", "height": 2, "begin": 3.21, "width": 0.001, "scale": "force"}"#;
    let nodes = vec![("push", Operation::Drive("push".to_owned())), ("x", integral(0.0, &[(1.0, 0)]))];
    let ranges = driven(10.0, drive, nodes);
    assert_range(&ranges, 0, [0.0, 2e-3]);
    assert_range(&ranges, 1, [0.0, 2e-6]);
}

#[test]
fn a_limited_sum_has_its_bounds_as_range() {
    // Over half a period the sine, limited to 1/2, has the integral 2 (1 - cos 30 deg) + 60 deg.
    let limited = Operation::Limited {
        sum: sum(&[(1.0, 0)]),
        lower: Some(Fraction::number(-0.5)),
        upper: Some(Fraction::number(0.5)),
    };
    let nodes = vec![
        ("sine", integral(0.0, &[(1.0, 1)])),
        ("cosine", integral(1.0, &[(-1.0, 0)])),
        ("limited", limited),
        ("area", integral(0.0, &[(1.0, 2)])),
    ];
    let ranges = solved(6.0, nodes);
    assert_eq!(ranges.nodes[2], [-0.5, 0.5]);
    let sixth = std::f64::consts::PI / 6.0;
    assert_range(&ranges, 3, [0.0, 2.0 * (1.0 - sixth.cos()) + 2.0 * sixth]);
}

#[test]
fn a_switch_is_crossed_at_the_right_time() {
    // x'' = -sign(x) from 1/2: a parabola to 0 in 1 s, then its mirror image. The velocity reaches -1.
    let switch =
        Operation::Switch { input: NodeId(0), at_least_0: Fraction::whole(-1), below_0: Fraction::whole(1) };
    let nodes =
        vec![("x", integral(0.5, &[(1.0, 1)])), ("x'", integral(0.0, &[(1.0, 2)])), ("force", switch)];
    let ranges = solved(8.0, nodes);
    assert_range(&ranges, 0, [-0.5, 0.5]);
    assert_range(&ranges, 1, [-1.0, 1.0]);
}

#[test]
fn endless_switching_ends() {
    // x' = 1/2 - sign(x) reaches 0 from 1 in 2 s and stays there.
    let switch =
        Operation::Switch { input: NodeId(1), at_least_0: Fraction::whole(-1), below_0: Fraction::whole(1) };
    let nodes =
        vec![("1", Operation::One), ("x", integral(1.0, &[(0.5, 0), (1.0, 2)])), ("friction", switch)];
    let [low, high] = solved(4.0, nodes).nodes[1];
    assert!(high == 1.0 && (-1e-3..=0.0).contains(&low), "{low} ... {high}");
}
