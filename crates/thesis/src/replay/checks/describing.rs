//! Describing functions and limit cycles (9.4 (ii)).

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::super::finding::{Finding, Printed};
use super::super::given::{Given, GivenError};
use super::stability::table;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::describing::{
    LimitCycle, Oscillation, Swing, cut_off_gain, dead_zone_gain, oscillation_at,
};
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{MM, MM_PER_S, N_S_PER_MM};

pub(super) const CHECKS: &[Check] = &[
    Check { name: "describing-reciprocal", run: reciprocal },
    Check { name: "describing-angle", run: angle },
    Check { name: "angle-is-ratio", run: angle_is_ratio },
    Check { name: "cut-off-gain", run: gain },
    Check { name: "cut-off-integral", run: integral },
    Check { name: "branches-meet", run: branches_meet },
    Check { name: "dead-zone-gain-rises", run: dead_zone_rises },
    Check { name: "small-swing-passes", run: small_swing_passes },
    Check { name: "large-swing-slows", run: large_swing_slows },
    Check { name: "no-intersection", run: no_intersection },
    Check { name: "quadrature-weight", run: quadrature_weight },
    Check { name: "closed-loop-ratio", run: closed_loop_ratio },
    Check { name: "open-loop-modulus", run: open_loop_modulus },
    Check { name: "open-loop-angle", run: open_loop_angle },
    Check { name: "at-angle", run: at_angle },
    Check { name: "limit-cycle", run: limit_cycle },
    Check { name: "slope-by-frequency", run: slope_by_frequency },
    Check { name: "product-of-digits", run: product_of_digits },
    Check { name: "limit-cycle-sticks", run: sticks },
    Check { name: "ends-with-a-swing", run: ends_with_a_swing },
    Check { name: "slower-is-larger", run: slower_is_larger },
    Check { name: "softer-is-larger", run: softer_is_larger },
    Check { name: "softer-swings-more", run: softer_swings_more },
    Check { name: "softer-ends-later", run: softer_ends_later },
    Check { name: "limit-cycle-without-memory", run: without_memory },
];

fn swing(given: &Given) -> Result<Swing, CheckError> {
    Ok(Swing { force: given.number("E")?, friction: given.number_or("n", 0.0)? })
}

/// 1/|N| at E/a and n/a.
fn reciprocal(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(swing(given)?.reciprocal()?))
}

/// The angle of N at E/a and n/a, in degrees.
fn angle(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(swing(given)?.angle()?.to_degrees()))
}

/// That the angle of N is that of n/E, whatever E/a.
fn angle_is_ratio(given: &Given) -> Result<Finding, CheckError> {
    let (ratio, mut told, mut holds) = (given.number("ratio")?, Vec::new(), true);
    for force in given.numbers("E")? {
        let angle = Swing { force, friction: ratio * force }.angle()?;
        holds &= (angle.tan().abs() / ratio - 1.0).abs() < 1e-9;
        told.push(format!("{:.3}", angle.tan()));
    }
    Ok(Finding::truth(holds, format!("tangents {} for n/E = {ratio}", told.join(", "))))
}

/// The share of a sine of E/a that passes (eq 56-9).
fn gain(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(cut_off_gain(given.number("E")?)))
}

/// Fundamental of a periodic output, by the integrals of eq 46-9 and 47-9 (with the cosine that it needs), as g + j b.
fn fundamental(output: impl Fn(f64) -> f64) -> Complex<f64> {
    const POINTS: usize = 100_000;
    let step = TAU / POINTS as f64;
    let parts = (0..POINTS).map(|index| {
        let angle = step * (index as f64 + 0.5);
        Complex::new(angle.sin(), angle.cos()) * output(angle)
    });
    parts.sum::<Complex<f64>>() * step / PI
}

/// What is left of E sin - n cos, cut off at -1.
fn cut_off(force: f64, friction: f64) -> impl Fn(f64) -> f64 {
    move |angle| (force * angle.sin() - friction * angle.cos()).max(-1.0)
}

/// The in-phase part as the text has it: eq 67-9, 69-9, 70-9 for n < a, eq 75-9, 77-9, 78-9 for n > a, in units of a. With n = 0
/// both are eq 56-9.
fn in_branch(force: f64, friction: f64) -> f64 {
    let squared = force.powi(2) + friction.powi(2);
    let root = (squared - 1.0).max(0.0).sqrt();
    let third = ((force * root - friction) / squared).acos();
    let other = ((force * root + friction) / squared).min(1.0).acos();
    let turn = if friction < 1.0 { third + other } else { third - other };
    0.5 * (1.0 + turn / PI) + root / (PI * squared)
}

/// That the text's branch is the integral that it is said to be.
fn integral(given: &Given) -> Result<Finding, CheckError> {
    let swing = swing(given)?;
    let summed = fundamental(cut_off(swing.force, swing.friction)) / swing.force;
    let (branch, ours) = (in_branch(swing.force, swing.friction), swing.describing_function()?);
    let found = format!("g = {branch:.5}, by the integral {:.5}, b = {:.5}", summed.re, summed.im);
    let holds = (branch - summed.re).abs() < 1e-6 && (ours - summed).norm() < 1e-6;
    Ok(Finding::truth(holds, found))
}

/// That both branches give the same where n = a.
fn branches_meet(given: &Given) -> Result<Finding, CheckError> {
    let force = given.number("E")?;
    let [below, above] = [1.0 - 1e-9, 1.0 + 1e-9].map(|friction| in_branch(force, friction));
    let found = format!("{below:.6} with n just below a, {above:.6} just above");
    Ok(Finding::truth((below - above).abs() < 1e-4, found))
}

/// That the gain of a plain dead zone rises towards one with the amplitude.
fn dead_zone_rises(given: &Given) -> Result<Finding, CheckError> {
    let sizes = given.numbers("E")?;
    let gains: Vec<f64> = sizes.iter().map(|size| dead_zone_gain(*size)).collect();
    let rises = gains.windows(2).all(|pair| pair[0] < pair[1]) && gains.iter().all(|gain| *gain < 1.0);
    Ok(Finding::shape(rises, format!("{gains:.3?} at amplitudes of {sizes:?} F")))
}

/// That a swing smaller than a passes whole.
fn small_swing_passes(given: &Given) -> Result<Finding, CheckError> {
    let gain = cut_off_gain(given.number("E")?);
    Ok(Finding::truth(gain == 1.0, format!("gain {gain}")))
}

/// That beyond a less than all passes, and the limit cycle is slower than wn.
fn large_swing_slows(given: &Given) -> Result<Finding, CheckError> {
    let (table, natural) = (table(given)?, table(given)?.natural_frequency()?);
    let cycle = table.limit_cycle(given.number("E")?)?;
    let found = format!("gain {:.3}, {:.1} rad/s for wn = {natural:.1}", cycle.gain, cycle.frequency);
    Ok(Finding::shape(cycle.gain < 1.0 && cycle.frequency < natural, found))
}

/// That G never comes to the negative real axis, on which 1/N of a single-valued function lies.
fn no_intersection(given: &Given) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let short = |frequency: f64| Ok(table.open_loop_angle(frequency)?.to_degrees());
    let angles = given.numbers("w")?.into_iter().map(short).collect::<Result<Vec<_>, SlidewayError>>()?;
    let found = format!("{angles:.3?} degrees short of it");
    Ok(Finding::truth(angles.iter().all(|angle| *angle > 0.0), found))
}

/// That b is 0 for a single-valued function if it is weighted as said: eq 47-9 prints a sine.
fn quadrature_weight(given: &Given) -> Result<Finding, CheckError> {
    let part = fundamental(cut_off(given.number("E")?, 0.0));
    let weighted = given.word("weight", &[("sine", part.re), ("cosine", part.im)])?;
    Ok(Finding::truth(weighted.abs() < 1e-6, format!("b = {:.4} a", weighted)))
}

/// That what eq 41-9 calls xi/xo is xi/xo, which has to grow beyond one far above wn.
fn closed_loop_ratio(given: &Given) -> Result<Finding, CheckError> {
    let open = table(given)?.open_loop(given.number("w")?)?;
    let ratio = (open / (open + 1.0)).norm();
    Ok(Finding::truth(ratio > 1.0, format!("N G / (1 + N G) = {ratio:.4} there")))
}

/// |G(jw)|.
fn open_loop_modulus(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.open_loop(given.number("w")?)?.norm()))
}

/// The angle of G(jw) short of half a turn, in degrees.
fn open_loop_angle(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.open_loop_angle(given.number("w")?)?.to_degrees()))
}

/// What the text makes of an angle that it reads off, in degrees: frequency in rad/s (eq 59-9), or n/E (eq 71-9).
fn at_angle(given: &Given) -> Result<Finding, CheckError> {
    let angle = given.number("angle")?.to_radians();
    let parts = [("frequency", table(given)?.frequency_at_angle(angle)?), ("n/E", angle.tan())];
    Ok(Finding::Number(given.word("part", &parts)?))
}

/// The limit cycle with E/a, and its oscillation on the friction of the simulation, VcL as given or 40 mm/s.
fn cycle(given: &Given, table: &DrivenTable, force: f64) -> Result<(LimitCycle, Oscillation), CheckError> {
    let cycle = table.limit_cycle(force)?;
    Ok((cycle, cycle.oscillation(table, &friction(given)?)?))
}

/// The friction that Table T9-6 was read with.
fn friction(given: &Given) -> Result<FallingFriction, CheckError> {
    Ok(FallingFriction::simulated(given.number_or("VcL", 0.04)?))
}

/// A part of the limit cycle with E/a: angle in degrees, frequency in rad/s, n/E, n/a, Cn in N s/mm, v0 and v in mm/s, e in mm.
fn limit_cycle(given: &Given) -> Result<Finding, CheckError> {
    let (cycle, motion) = cycle(given, &table(given)?, given.number("E")?)?;
    let parts = [
        ("angle", cycle.angle.to_degrees()),
        ("frequency", cycle.frequency),
        ("n/E", cycle.friction_ratio),
        ("n/a", cycle.friction_by_spare()),
        ("Cn", cycle.slope / N_S_PER_MM),
        ("v0", motion.velocity / MM_PER_S),
        ("e", motion.error / MM),
        ("v", motion.swing / MM_PER_S),
    ];
    Ok(Finding::Number(given.word("part", &parts)?))
}

/// That without memory the slope at every intersection is f (wn / w)^2, whatever the stiffness.
fn slope_by_frequency(given: &Given) -> Result<Finding, CheckError> {
    let (table, mut told, mut holds) = (table(given)?, Vec::new(), true);
    for force in given.numbers("E")? {
        let cycle = table.limit_cycle(force)?;
        let by_frequency = table.damping * (table.natural_frequency()? / cycle.frequency).powi(2);
        holds &= (cycle.slope / by_frequency - 1.0).abs() < 1e-9;
        told.push(format!("{:.2} by {:.2}", cycle.slope / N_S_PER_MM, by_frequency / N_S_PER_MM));
    }
    Ok(Finding::truth(holds, format!("{} N s/mm", told.join(", "))))
}

/// Whether velocity comes to rest in the limit cycle with E/a.
fn sticks(given: &Given) -> Result<Finding, CheckError> {
    let (_, motion) = cycle(given, &table(given)?, given.number("E")?)?;
    let wanted = given.word("is", &[("stick-slip", true), ("quasi-harmonic", false)])?;
    let found = format!("swing {:.2} about {:.2} mm/s", motion.swing / MM_PER_S, motion.velocity / MM_PER_S);
    Ok(Finding::shape(motion.sticks() == wanted, found))
}

/// Whether velocity still swings at E/a = 1, beyond which a command a thousandth faster has no limit cycle: friction falls too little.
fn ends_with_a_swing(given: &Given) -> Result<Finding, CheckError> {
    let (table, friction) = (table(given)?, friction(given)?);
    let (_, motion) = cycle(given, &table, 1.0)?;
    let faster = 1.001 * motion.velocity;
    let has_none = matches!(
        oscillation_at(&table, &friction, faster),
        Err(SlidewayError::NoSolution { sought: "limit cycle", .. })
    );
    let is_last = has_none && friction.slope(faster)? < table.critical_slope()?;
    let found =
        format!("swings by {:.2} mm/s up to {:.2} mm/s", motion.swing / MM_PER_S, motion.velocity / MM_PER_S);
    Ok(Finding::shape(is_last && motion.swing > 0.0, found))
}

/// That what is asked for grows, or falls, as the command is slower: E/a of 1, 5 and 20.
fn slower_is_larger(given: &Given) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let motions = [1.0, 5.0, 20.0].map(|force| cycle(given, &table, force));
    let [(slow, one), (slower, two), (slowest, three)] = {
        let [a, b, c] = motions;
        [a?, b?, c?]
    };
    let is_slower = one.velocity > two.velocity && two.velocity > three.velocity;
    let cycles = [(slow, one), (slower, two), (slowest, three)];
    type Part = fn(&(LimitCycle, Oscillation)) -> f64;
    let parts: [(&str, (Part, f64)); 4] = [
        ("n/a", (|(cycle, _)| cycle.friction_by_spare(), 1.0)),
        ("e", (|(_, motion)| motion.error / MM, 1.0)),
        ("v", (|(_, motion)| motion.swing / MM_PER_S, 1.0)),
        ("frequency", (|(_, motion)| motion.frequency, -1.0)),
    ];
    let (part, sign) = given.word("part", &parts)?;
    let values = cycles.each_ref().map(part);
    let follows = values.windows(2).all(|pair| sign * (pair[1] - pair[0]) > 0.0);
    let velocities = cycles.each_ref().map(|(_, motion)| motion.velocity / MM_PER_S);
    Ok(Finding::shape(is_slower && follows, format!("{values:.4?} at {velocities:.2?} mm/s")))
}

/// Both stiffnesses of the text, at one E/a.
fn both(given: &Given) -> Result<[(LimitCycle, Oscillation); 2], CheckError> {
    let (table, force) = (table(given)?, given.number("E")?);
    let softer = DrivenTable { stiffness: 0.5 * table.stiffness, ..table };
    Ok([cycle(given, &table, force)?, cycle(given, &softer, force)?])
}

/// That half the stiffness makes n/a and the amplitude of velocity larger and the frequency lower.
fn softer_is_larger(given: &Given) -> Result<Finding, CheckError> {
    let [(hard, hard_motion), (soft, soft_motion)] = both(given)?;
    let ratios = [
        soft.friction_by_spare() / hard.friction_by_spare(),
        soft_motion.swing / hard_motion.swing,
        soft.frequency / hard.frequency,
    ];
    let holds = ratios[0] > 1.0 && ratios[1] > 1.0 && ratios[2] < 1.0;
    let [friction, swing, frequency] = ratios;
    let found = format!("n/a x {friction:.3}, v x {swing:.3}, frequency x {frequency:.3}");
    Ok(Finding::shape(holds, found))
}

/// By how many percent half the stiffness makes the amplitude of velocity larger.
fn softer_swings_more(given: &Given) -> Result<Finding, CheckError> {
    let [(_, hard), (_, soft)] = both(given)?;
    Ok(Finding::Number(100.0 * (soft.swing / hard.swing - 1.0)))
}

/// That half the stiffness makes the velocity of the limit cycle higher.
fn softer_ends_later(given: &Given) -> Result<Finding, CheckError> {
    let [(_, hard), (_, soft)] = both(given)?;
    let [hard, soft] = [hard, soft].map(|motion| motion.velocity / MM_PER_S);
    // The digits that the text itself prints.
    Ok(Finding::shape(soft > hard + 0.005, format!("{hard:.3} mm/s, with half the stiffness {soft:.3}")))
}

/// That the critical velocity read off the limit cycles, which leave Tc out, is the one with Tc.
fn without_memory(given: &Given) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let plain = DrivenTable { memory: 0.0, ..table };
    let (_, motion) = cycle(given, &plain, 1.0)?;
    let friction = FallingFriction::simulated(given.number_or("VcL", 0.04)?);
    let read = motion.velocity / MM_PER_S;
    match table.critical_velocity(&friction) {
        Ok(velocity) => {
            let velocity = velocity / MM_PER_S;
            let found = format!("{read:.2} mm/s without Tc, {velocity:.2} with it");
            Ok(Finding::truth((read / velocity - 1.0).abs() < 0.02, found))
        }
        Err(reason) => Ok(Finding::truth(false, format!("{read:.2} mm/s without Tc; with it {reason}"))),
    }
}

/// Whether a printed number is the product of two others, as far as their last digits tell: each may be off by half of one.
fn product_of_digits(given: &Given) -> Result<Finding, CheckError> {
    let [first, second, product] = ["a", "b", "is"].map(|name| printed(given, name));
    let (first, second, product) = (first?, second?, product?);
    let half = |number: &Printed| 0.5 * number.last_digit();
    let slack = half(&first) * second.number.abs() + half(&second) * first.number.abs() + half(&product);
    let got = first.number * second.number;
    let found = format!("{} x {} = {:.5}", first.text, second.text, got);
    Ok(Finding::truth((got - product.number).abs() <= slack, found))
}

fn printed(given: &Given, name: &str) -> Result<Printed, GivenError> {
    let text = given.need(name)?;
    Printed::parse(text)
        .ok_or_else(|| GivenError::NotANumber { name: name.to_owned(), text: text.to_owned() })
}
