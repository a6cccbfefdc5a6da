//! A block on a drawn spring: sinusoids between stick and release.

use crate::common::{
    built, check_derivatives, check_derivatives_but, element, patch, program, ran, root, source, voltage,
    volts,
};
use patchcord_core::ir::Program;
use patchcord_core::solve::MachineMode;

const K: f64 = 200.0;
const FS: f64 = 10.0;
const FK: f64 = 6.0;
const PULL: f64 = 0.05;
const V_ON: f64 = 0.002;
const OMEGA: f64 = 10.0;
const POSITION: f64 = 0.01;
const VELOCITY: f64 = 0.005;

/// A block sliding under constant friction while the spring's far end moves evenly.
#[derive(Clone, Copy)]
struct Slide {
    begin: f64,
    /// Position about the moving place of rest, and velocity against it.
    place: f64,
    speed: f64,
    /// The moving place of rest at the beginning, and its velocity.
    centre: f64,
    drift: f64,
}

impl Slide {
    fn from(begin: f64, position: f64, velocity: f64, far_end: (f64, f64), friction: f64) -> Slide {
        let centre = far_end.0 - friction / K;
        Slide { begin, place: position - centre, speed: velocity - far_end.1, centre, drift: far_end.1 }
    }

    fn at(&self, time: f64) -> (f64, f64) {
        let flown = time - self.begin;
        let (sine, cosine) = (OMEGA * flown).sin_cos();
        let position = self.centre + self.drift * flown + self.place * cosine + self.speed / OMEGA * sine;
        (position, self.drift + self.speed * cosine - OMEGA * self.place * sine)
    }

    /// When the velocity comes to a value, in a bracket of time since the beginning.
    fn reaches(&self, velocity: f64, low: f64, high: f64) -> f64 {
        root(|time| self.at(time).1 - velocity, self.begin + low, self.begin + high)
    }
}

/// One stretch of the closed solution.
enum Stretch {
    Stuck(f64),
    Sliding(Slide),
}

/// What holds from each time on.
struct Solution(Vec<(f64, Stretch)>);

impl Solution {
    fn at(&self, time: f64) -> (f64, f64) {
        let (_, stretch) = self.0.iter().rev().find(|(begin, _)| *begin <= time).unwrap();
        match stretch {
            Stretch::Stuck(position) => (*position, 0.0),
            Stretch::Sliding(slide) => slide.at(time),
        }
    }

    fn is_stuck(&self, time: f64) -> bool {
        self.0
            .iter()
            .rev()
            .find(|(begin, _)| *begin <= time)
            .is_some_and(|(_, stretch)| matches!(stretch, Stretch::Stuck(_)))
    }
}

/// Plain Coulomb friction, the far end turning back at `turn` while the block slides.
fn turned_back(turn: f64) -> Solution {
    let far_end = |time: f64| PULL * time.min(2.0 * turn - time);
    let release = FS / (K * PULL);
    let forth = Slide::from(release, 0.0, 0.0, (far_end(release), PULL), FS);
    let (position, velocity) = forth.at(turn);
    let braking = Slide::from(turn, position, velocity, (far_end(turn), -PULL), FS);
    let stick = braking.reaches(0.0, 0.0, 0.3);
    let (held, _) = braking.at(stick);
    let again = 2.0 * turn - (held - FS / K) / PULL;
    let back = Slide::from(again, held, 0.0, (far_end(again), -PULL), -FS);
    Solution(vec![
        (0.0, Stretch::Stuck(0.0)),
        (release, Stretch::Sliding(forth)),
        (turn, Stretch::Sliding(braking)),
        (stick, Stretch::Stuck(held)),
        (again, Stretch::Sliding(back)),
    ])
}

/// Stick-slip: friction at rest until the relay pulls in, in motion until it drops out, at rest again.
fn stick_slip(until: f64) -> Solution {
    let mut stretches = Vec::new();
    let (mut begin, mut position) = (0.0, 0.0);
    while begin < until {
        let release = (position + FS / K) / PULL;
        let slide = |time: f64, (position, velocity): (f64, f64), friction| {
            Slide::from(time, position, velocity, (PULL * time, PULL), friction)
        };
        let first = slide(release, (position, 0.0), FS);
        let pulled_in = first.reaches(V_ON, 0.0, 0.2);
        let main = slide(pulled_in, first.at(pulled_in), FK);
        let dropped_out = main.reaches(V_ON / 2.0, 0.2, 0.6);
        let last = slide(dropped_out, main.at(dropped_out), FS);
        let stick = last.reaches(0.0, 0.0, 0.05);
        stretches.push((begin, Stretch::Stuck(position)));
        stretches.push((release, Stretch::Sliding(first)));
        stretches.push((pulled_in, Stretch::Sliding(main)));
        stretches.push((dropped_out, Stretch::Sliding(last)));
        (begin, position) = (stick, last.at(stick).0);
    }
    Solution(stretches)
}

/// The largest error of position in m and of velocity in m/s, at instants off the grid.
fn errors(changes: &[(&str, f64)], solution: &Solution, step: f64, until: f64) -> (f64, f64) {
    let program = program(&patch("stick-slip-brake"), changes);
    let mut machine = ran(&program, step, 0.0);
    let mut worst = (0.0f64, 0.0f64);
    while machine.time() < until {
        machine.operate(0.0137).unwrap();
        let (position, velocity) = solution.at(machine.time());
        worst.0 = worst.0.max((-voltage(&machine, "A2") * POSITION - position).abs());
        worst.1 = worst.1.max((voltage(&machine, "B3") * VELOCITY - velocity).abs());
        if solution.is_stuck(machine.time() - 1e-9) {
            assert_eq!(voltage(&machine, "A1"), 0.0, "stuck at {}", machine.time());
        }
    }
    worst
}

#[test]
fn coulomb_friction_sticks_and_releases_when_it_should() {
    let changes = [("Fk", FS), ("t_turn", 1.3)];
    let (position, velocity) = errors(&changes, &turned_back(1.3), 1e-3, 3.0);
    assert!(position < 1e-11 && velocity < 1e-10, "{position:e} {velocity:e}");
}

#[test]
fn lower_friction_in_motion_gives_stick_slip() {
    // Ten slips of order 4 at omega h = 0.01: each adds about (omega h)^4 / 120 of its amplitude of 0.02 m.
    let (position, velocity) = errors(&[], &stick_slip(8.0), 1e-3, 8.0);
    assert!(position < 1e-10 && velocity < 1e-9, "{position:e} {velocity:e}");
}

#[test]
fn below_the_level_nothing_moves_at_all() {
    let program = program(&patch("stick-slip-brake"), &[]);
    let machine = ran(&program, 1e-3, 0.999);
    assert!(machine.states().iter().all(|volts| *volts == 0.0));
}

/// A mass under a constant force and a brake of the same level.
fn balanced(initial: f64, force: f64) -> Program {
    let builder = source(source(volts("balanced"), "force", -force), "level", 7.0);
    let mass = element("integrator").cords("x1", ["force"]).cords("brake_x1", ["level"]);
    built(builder.element("A1", mass.set("initial", initial)))
}

#[test]
fn exactly_at_its_level_a_brake_holds_and_just_above_it_lets_go() {
    assert_eq!(voltage(&ran(&balanced(0.0, 7.0), 1e-2, 3.0), "A1"), 0.0);
    assert_eq!(voltage(&ran(&balanced(0.0, -7.0), 1e-2, 3.0), "A1"), 0.0);
    let released = voltage(&ran(&balanced(0.0, 7.0 + 1e-9), 1e-2, 3.0), "A1");
    assert!((released - 3e-9).abs() < 1e-13, "{released}");
    // Driven along at the level, what moves keeps moving; driven against, it is stopped after 20 V / 14 V/s.
    assert!((voltage(&ran(&balanced(20.0, 7.0), 1e-2, 3.0), "A1") - 20.0).abs() < 1e-12);
    assert!((voltage(&ran(&balanced(20.0, -7.0), 1e-2, 1.0), "A1") - 6.0).abs() < 1e-12);
    assert_eq!(voltage(&ran(&balanced(20.0, -7.0), 1e-2, 3.0), "A1"), 0.0);
    // A force that overcomes the brake turns it round without a rest: -3 V/s after 20 V / 17 V/s.
    let turned = voltage(&ran(&balanced(20.0, -10.0), 1.0, 3.0), "A1");
    assert!((turned + 3.0 * (3.0 - 20.0 / 17.0)).abs() < 1e-11, "{turned}");
}

#[test]
fn hold_keeps_what_sticks_and_it_slips_from_there() {
    let builder = volts("held").parameter("force", 5.0, "V", [-50.0, 50.0]);
    let builder = source(builder.drive("f", "volt", element("step").set("height", "-force")), "level", 7.0);
    let mass = element("integrator").cords("x1", ["f"]).cords("brake_x1", ["level"]);
    let program = built(builder.element("A1", mass));
    let mut machine = ran(&program, 1e-2, 1.0);
    machine.hold();
    machine.set("force", 20.0).unwrap();
    assert_eq!((machine.mode(), voltage(&machine, "A1")), (MachineMode::Hold, 0.0));
    machine.operate(0.5).unwrap();
    assert!((voltage(&machine, "A1") - 6.5).abs() < 1e-12, "{}", voltage(&machine, "A1"));
}

#[test]
fn derivatives_agree_stuck_and_sliding() {
    let program = program(&patch("stick-slip-brake"), &[]);
    check_derivatives(&program, 1e-3, &[1.2, 2.6]);
    check_derivatives_but(&program, 1e-3, &[0.5, 1.9], &["A1"]);
}

/// A mass under a brake of 5 V/s that slides at 20 V towards a stop 10 V away, and comes back with 0.8 of it.
fn braked_bounce() -> Program {
    let builder = source(source(volts("braked bounce"), "level", 5.0), "room", 10.0);
    let mass = element("integrator").cords("brake_x1", ["level"]).cords("x1", ["ground"]).cords("gap", ["G"]);
    let builder = builder.element("A1", mass.set("initial", 20).set("restitution", 0.8));
    let builder = builder.element("A2", element("integrator").cords("x1", ["A1"]));
    let builder = builder.element("S", element("summer").cords("x1", ["A2", "room"]));
    built(builder.element("G", element("summer").cords("x1", ["S"])))
}

#[test]
fn a_brake_lets_what_it_slows_bounce() {
    // Slowed by 5 V/s it hits at sqrt(300) V, comes back at 0.8 of that, and is slowed on its way back.
    let program = braked_bounce();
    let hit = (20.0 - 300f64.sqrt()) / 5.0;
    for step in [1e-3, 0.3] {
        let velocity = voltage(&ran(&program, step, 1.0), "A1");
        let wanted = -(0.8 * 300f64.sqrt() - 5.0 * (1.0 - hit));
        assert!((velocity - wanted).abs() < 1e-9, "{step} {velocity} {wanted}");
    }
}

#[test]
fn a_hand_may_turn_round_what_slides() {
    let program = braked_bounce();
    let mut machine = ran(&program, 1e-2, 0.2);
    machine.set_state("A1", -10.0).unwrap();
    assert_eq!(voltage(&machine, "A1"), -10.0);
    machine.operate(0.5).unwrap();
    assert!((voltage(&machine, "A1") + 7.5).abs() < 1e-9, "{}", voltage(&machine, "A1"));
}
