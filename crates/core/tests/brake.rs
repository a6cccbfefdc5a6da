//! A block with friction on a pulled spring: sinusoids between release and stick.

use crate::common::{
    built, check_derivatives, check_derivatives_except, element, patch, program, root, run_for, source,
    voltage, volts,
};
use patchcord_core::ir::Program;
use patchcord_core::solve::MachineMode;

/// Stiffness of the spring in N/m.
const K: f64 = 200.0;
/// Static friction in N.
const FS: f64 = 10.0;
/// Sliding friction in N.
const FK: f64 = 6.0;
/// Velocity of the spring's far end in m/s.
const PULL: f64 = 0.05;
/// Velocity in m/s at which the relay selects sliding friction. It drops out at half of this.
const V_ON: f64 = 0.002;
/// Natural frequency in rad/s.
const OMEGA: f64 = 10.0;
/// Metres per volt of the position.
const POSITION: f64 = 0.01;
/// Metres per second per volt of the velocity.
const VELOCITY: f64 = 0.005;

/// A block that slides under constant friction while the spring's far end moves at a constant velocity.
#[derive(Clone, Copy)]
struct Slide {
    begin: f64,
    /// Position and velocity relative to the moving equilibrium.
    position_from_centre: f64,
    speed: f64,
    /// The moving equilibrium at the beginning, and its velocity.
    centre: f64,
    drift: f64,
}

impl Slide {
    fn from(begin: f64, position: f64, velocity: f64, far_end: (f64, f64), friction: f64) -> Slide {
        let centre = far_end.0 - friction / K;
        Slide {
            begin,
            position_from_centre: position - centre,
            speed: velocity - far_end.1,
            centre,
            drift: far_end.1,
        }
    }

    /// Position in m and velocity in m/s.
    fn at(&self, time: f64) -> (f64, f64) {
        let elapsed = time - self.begin;
        let (sine, cosine) = (OMEGA * elapsed).sin_cos();
        let position = self.centre
            + self.drift * elapsed
            + self.position_from_centre * cosine
            + self.speed / OMEGA * sine;
        (position, self.drift + self.speed * cosine - OMEGA * self.position_from_centre * sine)
    }

    /// The time at which the velocity reaches a value, between two times after the beginning.
    fn time_of_velocity(&self, velocity: f64, low: f64, high: f64) -> f64 {
        root(|time| self.at(time).1 - velocity, self.begin + low, self.begin + high)
    }
}

/// One interval of the closed solution.
enum Interval {
    Stuck(f64),
    Sliding(Slide),
}

/// The closed solution: each interval with its beginning in s.
struct Solution(Vec<(f64, Interval)>);

impl Solution {
    fn at(&self, time: f64) -> (f64, f64) {
        let (_, interval) = self.0.iter().rev().find(|(begin, _)| *begin <= time).unwrap();
        match interval {
            Interval::Stuck(position) => (*position, 0.0),
            Interval::Sliding(slide) => slide.at(time),
        }
    }

    fn is_stuck(&self, time: f64) -> bool {
        self.0
            .iter()
            .rev()
            .find(|(begin, _)| *begin <= time)
            .is_some_and(|(_, interval)| matches!(interval, Interval::Stuck(_)))
    }
}

/// Coulomb friction with equal static and sliding friction. The far end reverses at `turn` while the block slides.
fn reversed_pull(turn: f64) -> Solution {
    let far_end = |time: f64| PULL * time.min(2.0 * turn - time);
    let release = FS / (K * PULL);
    let forward = Slide::from(release, 0.0, 0.0, (far_end(release), PULL), FS);
    let (position, velocity) = forward.at(turn);
    let braking = Slide::from(turn, position, velocity, (far_end(turn), -PULL), FS);
    let stick = braking.time_of_velocity(0.0, 0.0, 0.3);
    let (held, _) = braking.at(stick);
    let second_release = 2.0 * turn - (held - FS / K) / PULL;
    let back = Slide::from(second_release, held, 0.0, (far_end(second_release), -PULL), -FS);
    Solution(vec![
        (0.0, Interval::Stuck(0.0)),
        (release, Interval::Sliding(forward)),
        (turn, Interval::Sliding(braking)),
        (stick, Interval::Stuck(held)),
        (second_release, Interval::Sliding(back)),
    ])
}

/// Stick-slip up to a time: static friction until the relay pulls in, sliding friction until it drops out, then static
/// friction again.
fn stick_slip(until: f64) -> Solution {
    let mut intervals = Vec::new();
    let (mut begin, mut position) = (0.0, 0.0);
    while begin < until {
        let release = (position + FS / K) / PULL;
        let slide = |time: f64, (position, velocity): (f64, f64), friction| {
            Slide::from(time, position, velocity, (PULL * time, PULL), friction)
        };
        let first = slide(release, (position, 0.0), FS);
        let pulled_in = first.time_of_velocity(V_ON, 0.0, 0.2);
        let main = slide(pulled_in, first.at(pulled_in), FK);
        let dropped_out = main.time_of_velocity(V_ON / 2.0, 0.2, 0.6);
        let last = slide(dropped_out, main.at(dropped_out), FS);
        let stick = last.time_of_velocity(0.0, 0.0, 0.05);
        intervals.push((begin, Interval::Stuck(position)));
        intervals.push((release, Interval::Sliding(first)));
        intervals.push((pulled_in, Interval::Sliding(main)));
        intervals.push((dropped_out, Interval::Sliding(last)));
        (begin, position) = (stick, last.at(stick).0);
    }
    Solution(intervals)
}

/// The largest error of the position in m and of the velocity in m/s. The instants are not ends of steps.
fn errors(changes: &[(&str, f64)], solution: &Solution, step: f64, until: f64) -> (f64, f64) {
    let program = program(&patch("stick-slip-brake"), changes);
    let mut machine = run_for(&program, step, 0.0);
    let mut largest = (0.0f64, 0.0f64);
    while machine.time() < until {
        machine.operate(0.0137).unwrap();
        let (position, velocity) = solution.at(machine.time());
        largest.0 = largest.0.max((-voltage(&machine, "A2") * POSITION - position).abs());
        largest.1 = largest.1.max((voltage(&machine, "B3") * VELOCITY - velocity).abs());
        if solution.is_stuck(machine.time() - 1e-9) {
            assert_eq!(voltage(&machine, "A1"), 0.0, "stuck at {}", machine.time());
        }
    }
    largest
}

#[test]
fn coulomb_friction_sticks_and_releases_as_the_closed_solution() {
    let changes = [("Fk", FS), ("t_turn", 1.3)];
    let (position, velocity) = errors(&changes, &reversed_pull(1.3), 1e-3, 3.0);
    assert!(position < 1e-11 && velocity < 1e-10, "{position:e} {velocity:e}");
}

#[test]
fn lower_friction_in_motion_gives_stick_slip() {
    // Ten slips of order 4 at omega h = 0.01: each adds about (omega h)^4 / 120 of its amplitude of 0.02 m.
    let (position, velocity) = errors(&[], &stick_slip(8.0), 1e-3, 8.0);
    assert!(position < 1e-10 && velocity < 1e-9, "{position:e} {velocity:e}");
}

#[test]
fn below_the_brake_level_nothing_moves() {
    let program = program(&patch("stick-slip-brake"), &[]);
    let machine = run_for(&program, 1e-3, 0.999);
    assert!(machine.states().iter().all(|volts| *volts == 0.0));
}

/// A mass under a constant force in volts and a brake of 7 V.
fn balanced(initial: f64, force: f64) -> Program {
    let builder = source(source(volts("balanced"), "force", -force), "level", 7.0);
    let mass = element("integrator").cords("x1", ["force"]).cords("brake_x1", ["level"]);
    built(builder.element("A1", mass.set("initial", initial)))
}

#[test]
fn a_brake_holds_at_its_level_and_releases_just_above() {
    assert_eq!(voltage(&run_for(&balanced(0.0, 7.0), 1e-2, 3.0), "A1"), 0.0);
    assert_eq!(voltage(&run_for(&balanced(0.0, -7.0), 1e-2, 3.0), "A1"), 0.0);
    let released = voltage(&run_for(&balanced(0.0, 7.0 + 1e-9), 1e-2, 3.0), "A1");
    assert!((released - 3e-9).abs() < 1e-13, "{released}");
    // A force of the level keeps a moving mass at its velocity. A force of the opposite sign stops it after 20 V / 14
    // V/s.
    assert!((voltage(&run_for(&balanced(20.0, 7.0), 1e-2, 3.0), "A1") - 20.0).abs() < 1e-12);
    assert!((voltage(&run_for(&balanced(20.0, -7.0), 1e-2, 1.0), "A1") - 6.0).abs() < 1e-12);
    assert_eq!(voltage(&run_for(&balanced(20.0, -7.0), 1e-2, 3.0), "A1"), 0.0);
    // A force above the level reverses the mass without a rest: -3 V/s after 20 V / 17 V/s.
    let reversed = voltage(&run_for(&balanced(20.0, -10.0), 1.0, 3.0), "A1");
    assert!((reversed + 3.0 * (3.0 - 20.0 / 17.0)).abs() < 1e-11, "{reversed}");
}

#[test]
fn a_stuck_mass_stays_stuck_in_hold_and_slips_afterwards() {
    let builder = volts("held").parameter("force", 5.0, "V", [-50.0, 50.0]);
    let builder = source(builder.drive("f", "volt", element("step").set("height", "-force")), "level", 7.0);
    let mass = element("integrator").cords("x1", ["f"]).cords("brake_x1", ["level"]);
    let program = built(builder.element("A1", mass));
    let mut machine = run_for(&program, 1e-2, 1.0);
    machine.hold();
    machine.set_parameter("force", 20.0).unwrap();
    assert_eq!((machine.mode(), voltage(&machine, "A1")), (MachineMode::Hold, 0.0));
    machine.operate(0.5).unwrap();
    assert!((voltage(&machine, "A1") - 6.5).abs() < 1e-12, "{}", voltage(&machine, "A1"));
}

#[test]
fn derivatives_agree_stuck_and_sliding() {
    let program = program(&patch("stick-slip-brake"), &[]);
    check_derivatives(&program, 1e-3, &[1.2, 2.6]);
    check_derivatives_except(&program, 1e-3, &[0.5, 1.9], &["A1"]);
}

/// A mass with a brake of 5 V/s. It slides at 20 V towards a stop at a distance of 10 V and returns with 0.8 of its
/// speed.
fn braked_bounce() -> Program {
    let builder = source(source(volts("braked bounce"), "level", 5.0), "distance", 10.0);
    let mass = element("integrator").cords("brake_x1", ["level"]).cords("x1", ["ground"]).cords("gap", ["G"]);
    let builder = builder.element("A1", mass.set("initial", 20).set("restitution", 0.8));
    let builder = builder.element("A2", element("integrator").cords("x1", ["A1"]));
    let builder = builder.element("S", element("summer").cords("x1", ["A2", "distance"]));
    built(builder.element("G", element("summer").cords("x1", ["S"])))
}

#[test]
fn a_braked_mass_bounces() {
    // It hits the stop at sqrt(300) V and returns with 0.8 of that. The brake slows it by 5 V/s in both directions.
    let program = braked_bounce();
    let hit = (20.0 - 300f64.sqrt()) / 5.0;
    for step in [1e-3, 0.3] {
        let velocity = voltage(&run_for(&program, step, 1.0), "A1");
        let expected = -(0.8 * 300f64.sqrt() - 5.0 * (1.0 - hit));
        assert!((velocity - expected).abs() < 1e-9, "{step} {velocity} {expected}");
    }
}

#[test]
fn the_velocity_of_a_sliding_mass_can_be_reversed() {
    let program = braked_bounce();
    let mut machine = run_for(&program, 1e-2, 0.2);
    machine.set_state("A1", -10.0).unwrap();
    assert_eq!(voltage(&machine, "A1"), -10.0);
    machine.operate(0.5).unwrap();
    assert!((voltage(&machine, "A1") + 7.5).abs() < 1e-9, "{}", voltage(&machine, "A1"));
}
