//! Claims on describing functions and limit cycles (9.4 (ii)).
//!
//! Forces are in units of the viscous friction a = f v0 at the steady velocity v0. `E` is the amplitude of the drive's
//! force, E/a; `n` is that of solid friction, n/a, a quarter of a period later. The force that accelerates the mass is
//! E sin - n cos, cut off at -1, because the drive does not push back. N is the describing function of this cut-off and
//! G the frequency response of the table, K / (jw (jw M + f)). A limit cycle is a solution of 1 + N G = 0.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::super::check_arguments::{ArgumentError, CheckArguments};
use super::super::finding::{Finding, PrintedNumber};
use super::stability::table;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::describing::{
    LimitCycle, Oscillation, Swing, cut_off_gain, dead_zone_gain, oscillation_at,
};
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{MM, MM_PER_S, N_S_PER_MM};

/// The checks of this file, by the name that the ledger uses.
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
    Check { name: "limit-cycle-sticks", run: limit_cycle_sticks },
    Check { name: "ends-with-a-swing", run: ends_with_a_swing },
    Check { name: "slower-is-larger", run: slower_is_larger },
    Check { name: "softer-is-larger", run: softer_is_larger },
    Check { name: "softer-swings-more", run: softer_swings_more },
    Check { name: "softer-ends-later", run: softer_ends_later },
    Check { name: "limit-cycle-without-memory", run: without_memory },
];

/// The amplitudes E/a and n/a; n is 0 by default.
fn swing(given: &CheckArguments) -> Result<Swing, CheckError> {
    Ok(Swing { force: given.number("E")?, friction: given.number_or("n", 0.0)? })
}

/// 1/|N| at E/a and n/a.
///
/// Tables T9-3 and T9-4: claims 9-084 ... 9-088 and every second one of 9-097 ... 9-149.
fn reciprocal(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(swing(given)?.reciprocal()?))
}

/// The angle of N at E/a and n/a, in degrees.
///
/// The output lags by atan(n / E) (eq 71-9). Table T9-4: claims 9-098 ... 9-150.
fn angle(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(swing(given)?.angle()?.to_degrees()))
}

/// Checks that the angle of N depends only on n/E, for several E/a.
///
/// Arguments: `ratio` n/E, and `E` as a list. The tangent must be the ratio to 1e-9. Claim 9-095.
fn angle_is_ratio(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (ratio, mut tangents, mut holds) = (given.number("ratio")?, Vec::new(), true);
    for force in given.numbers("E")? {
        let angle = Swing { force, friction: ratio * force }.angle()?;
        holds &= (angle.tan().abs() / ratio - 1.0).abs() < 1e-9;
        tangents.push(format!("{:.3}", angle.tan()));
    }
    Ok(Finding::truth(holds, format!("tangents {} for n/E = {ratio}", tangents.join(", "))))
}

/// The gain of the cut-off for a sine of amplitude E/a (eq 56-9).
///
/// The limits are 1 up to E = a and 1/2 for a large E. Claims 9-083.a and b.
fn gain(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(cut_off_gain(given.number("E")?)))
}

/// Fundamental of a periodic output as g + j b, by the integrals of eq 46-9 and 47-9. Eq 47-9 needs a cosine, which
/// is used here.
///
/// g = (1/pi) integral of output sin, b = (1/pi) integral of output cos, both over one period and not yet divided by E.
/// The integrals are sums at 100 000 midpoints. The printed eq 47-9 has a sine, which is a misprint (claim 9-073).
fn fundamental(output: impl Fn(f64) -> f64) -> Complex<f64> {
    const POINTS: usize = 100_000;
    let step = TAU / POINTS as f64;
    let parts = (0..POINTS).map(|index| {
        let angle = step * (index as f64 + 0.5);
        Complex::new(angle.sin(), angle.cos()) * output(angle)
    });
    parts.sum::<Complex<f64>>() * step / PI
}

/// E sin - n cos, cut off at -1. All in units of a (eq 53-9).
fn cut_off(force: f64, friction: f64) -> impl Fn(f64) -> f64 {
    move |angle| (force * angle.sin() - friction * angle.cos()).max(-1.0)
}

/// The in-phase part by the formulas of the text, in units of a: eq 67-9, 69-9, 70-9 for n < a, eq 75-9, 77-9, 78-9
/// for n > a. With n = 0 both are eq 56-9.
fn in_branch(force: f64, friction: f64) -> f64 {
    let squared = force.powi(2) + friction.powi(2);
    let root = (squared - 1.0).max(0.0).sqrt();
    let third = ((force * root - friction) / squared).acos();
    let other = ((force * root + friction) / squared).min(1.0).acos();
    let turn = if friction < 1.0 { third + other } else { third - other };
    0.5 * (1.0 + turn / PI) + root / (PI * squared)
}

/// Checks that the branch of the text equals its integral.
///
/// Arguments: `E` and `n`. Three values must agree to 1e-6: the formula of the text, the integral, and the function
/// that the rest of the crate uses. Claims 9-081, 9-093, 9-094 and 9-096.b.
fn integral(given: &CheckArguments) -> Result<Finding, CheckError> {
    let swing = swing(given)?;
    let summed = fundamental(cut_off(swing.force, swing.friction)) / swing.force;
    let (branch, ours) = (in_branch(swing.force, swing.friction), swing.describing_function()?);
    let found = format!("g = {branch:.5}, by the integral {:.5}, b = {:.5}", summed.re, summed.im);
    let holds = (branch - summed.re).abs() < 1e-6 && (ours - summed).norm() < 1e-6;
    Ok(Finding::truth(holds, found))
}

/// Checks that both branches agree at n = a.
///
/// The friction is 1e-9 below and above a; the values must agree to 1e-4. Claim 9-096.
fn branches_meet(given: &CheckArguments) -> Result<Finding, CheckError> {
    let force = given.number("E")?;
    let [below, above] = [1.0 - 1e-9, 1.0 + 1e-9].map(|friction| in_branch(force, friction));
    let found = format!("{below:.6} with n just below a, {above:.6} just above");
    Ok(Finding::truth((below - above).abs() < 1e-4, found))
}

/// Checks that the gain of a plain dead zone rises towards 1 with the amplitude.
///
/// Argument `E`: amplitudes in units of F, ascending. Fig 9.10, claim 9-076.
fn dead_zone_rises(given: &CheckArguments) -> Result<Finding, CheckError> {
    let sizes = given.numbers("E")?;
    let gains: Vec<f64> = sizes.iter().map(|size| dead_zone_gain(*size)).collect();
    let rises = gains.windows(2).all(|pair| pair[0] < pair[1]) && gains.iter().all(|gain| *gain < 1.0);
    Ok(Finding::shape(rises, format!("{gains:.3?} at amplitudes of {sizes:?} F")))
}

/// Checks that the gain is 1 for an amplitude below a.
///
/// Claim 9-078. The gain must be exactly 1.
fn small_swing_passes(given: &CheckArguments) -> Result<Finding, CheckError> {
    let gain = cut_off_gain(given.number("E")?);
    Ok(Finding::truth(gain == 1.0, format!("gain {gain}")))
}

/// Checks that the gain is below 1 for an amplitude above a, and the limit cycle is slower than wn.
///
/// Claim 9-079. The frequency is wn sqrt(g) without lag.
fn large_swing_slows(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (table, natural) = (table(given)?, table(given)?.natural_frequency()?);
    let cycle = table.limit_cycle(given.number("E")?)?;
    let found = format!("gain {:.3}, {:.1} rad/s for wn = {natural:.1}", cycle.gain, cycle.frequency);
    Ok(Finding::shape(cycle.gain < 1.0 && cycle.frequency < natural, found))
}

/// Checks that G never reaches the negative real axis, on which -1/N of a single-valued function is.
///
/// The angle of G above the negative real axis is atan(f / (M w)), which is positive at every frequency. Fig 9.13,
/// claim 9-090.
fn no_intersection(given: &CheckArguments) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let degrees = |frequency: f64| Ok(table.open_loop_angle(frequency)?.to_degrees());
    let angles = given.numbers("w")?.into_iter().map(degrees).collect::<Result<Vec<_>, SlidewayError>>()?;
    let found = format!("{angles:.3?} degrees from the negative real axis");
    Ok(Finding::truth(angles.iter().all(|angle| *angle > 0.0), found))
}

/// Checks that b is 0 for a single-valued function with the weight that `weight` selects; eq 47-9 prints a sine.
///
/// With the sine the result is g, which is not 0. Claims 9-073 and 9-073.b.
fn quadrature_weight(given: &CheckArguments) -> Result<Finding, CheckError> {
    let part = fundamental(cut_off(given.number("E")?, 0.0));
    let weighted = given.choice("weight", &[("sine", part.re), ("cosine", part.im)])?;
    Ok(Finding::truth(weighted.abs() < 1e-6, format!("b = {:.4} a", weighted)))
}

/// Checks that the ratio that eq 41-9 calls xi/xo is xi/xo, which must exceed 1 far above wn.
///
/// The check takes N = 1. Claim 9-071: N G / (1 + N G) is output by input, which is small above wn.
fn closed_loop_ratio(given: &CheckArguments) -> Result<Finding, CheckError> {
    let open = table(given)?.open_loop(given.number("w")?)?;
    let ratio = (open / (open + 1.0)).norm();
    Ok(Finding::truth(ratio > 1.0, format!("N G / (1 + N G) = {ratio:.4} at this frequency")))
}

/// The modulus of G(jw).
///
/// Argument `w` in rad/s. Table T9-5: claims 9-151 ... 9-167.
fn open_loop_modulus(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.open_loop(given.number("w")?)?.norm()))
}

/// The angle between G(jw) and the negative real axis, in degrees.
///
/// Argument `w` in rad/s; the angle is atan(f / (M w)) (eq 59-9). Table T9-5: claims 9-152 ... 9-168.
fn open_loop_angle(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(table(given)?.open_loop_angle(given.number("w")?)?.to_degrees()))
}

/// The frequency in rad/s (eq 59-9) or n/E (eq 71-9) that the text calculates from an angle in degrees.
///
/// Arguments: `angle` in degrees and `part`. The frequency is f / (M tan), n/E is the tangent. Claims 9-183.own and
/// 9-188.own show that the text read its angles from a plot.
fn at_angle(given: &CheckArguments) -> Result<Finding, CheckError> {
    let angle = given.number("angle")?.to_radians();
    let parts = [("frequency", table(given)?.frequency_at_angle(angle)?), ("n/E", angle.tan())];
    Ok(Finding::Number(given.choice("part", &parts)?))
}

/// The limit cycle with E/a, and its oscillation with the friction of the claim.
///
/// `force` is E/a. The slope Cn of the cycle determines the steady velocity on the curve of friction (eq 64-9).
fn cycle(
    given: &CheckArguments,
    table: &DrivenTable,
    force: f64,
) -> Result<(LimitCycle, Oscillation), CheckError> {
    let cycle = table.limit_cycle(force)?;
    Ok((cycle, cycle.oscillation(table, &friction(given)?)?))
}

/// The friction of the simulation. VcL is 40 mm/s by default, as for Table T9-6. Static friction is 771 N.
fn friction(given: &CheckArguments) -> Result<FallingFriction, CheckError> {
    Ok(FallingFriction::simulated(given.number_or("VcL", 0.04)?))
}

/// A quantity of the limit cycle with E/a: angle in degrees, frequency in rad/s, n/E, n/a, Cn in N s/mm, v0 and v in
/// mm/s, e in mm.
///
/// Argument `part`, with the equation: `angle` (59-9), `frequency`, `n/E` (85-9), `n/a`, slope `Cn` of friction (85-9),
/// steady velocity `v0` (64-9), amplitude `e` of position (86-9), amplitude `v` of velocity (84-9). The table before eq
/// 84-9 and Table T9-6: claims 9-170 ... 9-233.
fn limit_cycle(given: &CheckArguments) -> Result<Finding, CheckError> {
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
    Ok(Finding::Number(given.choice("part", &parts)?))
}

/// Checks that without lag the slope at every intersection is f (wn / w)^2, independent of the stiffness.
///
/// The condition is Cn = f / g with g = (w / wn)^2, to 1e-9. Claim 9-200 (eq 85-9, 90-9).
fn slope_by_frequency(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (table, mut texts, mut holds) = (table(given)?, Vec::new(), true);
    for force in given.numbers("E")? {
        let cycle = table.limit_cycle(force)?;
        let by_frequency = table.damping * (table.natural_frequency()? / cycle.frequency).powi(2);
        holds &= (cycle.slope / by_frequency - 1.0).abs() < 1e-9;
        texts.push(format!("{:.2} (formula {:.2})", cycle.slope / N_S_PER_MM, by_frequency / N_S_PER_MM));
    }
    Ok(Finding::truth(holds, format!("{} N s/mm", texts.join(", "))))
}

/// Checks whether velocity reaches rest in the limit cycle with E/a.
///
/// The table reaches rest if the amplitude of velocity is at least the steady velocity. Claims 9-235.45, 9-235.22.5 and
/// 9-236.
fn limit_cycle_sticks(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (_, motion) = cycle(given, &table(given)?, given.number("E")?)?;
    let wanted = given.choice("is", &[("stick-slip", true), ("quasi-harmonic", false)])?;
    let found = format!("swing {:.2} about {:.2} mm/s", motion.swing / MM_PER_S, motion.velocity / MM_PER_S);
    Ok(Finding::shape(motion.is_stick_slip() == wanted, found))
}

/// Checks whether velocity still swings at E/a = 1, and a command faster by a thousandth has no limit cycle, because
/// the slope of friction is too small.
///
/// Fig 9.17, claim 9-239. At E/a = 1 the cut-off hardly acts, so the slope is nearly the critical slope.
fn ends_with_a_swing(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (table, friction) = (table(given)?, friction(given)?);
    let (_, motion) = cycle(given, &table, 1.0)?;
    let faster = 1.001 * motion.velocity;
    let has_none = matches!(
        oscillation_at(&table, &friction, faster),
        Err(SlidewayError::NoSolution { sought: "limit cycle", .. })
    );
    let is_last = has_none && friction.slope(faster)? < table.critical_slope()?;
    let found = format!(
        "amplitude {:.2} mm/s, up to a command of {:.2} mm/s",
        motion.swing / MM_PER_S,
        motion.velocity / MM_PER_S
    );
    Ok(Finding::shape(is_last && motion.swing > 0.0, found))
}

/// Checks that a quantity grows, or the frequency falls, as the command gets slower: E/a = 1, 5 and 20.
///
/// Argument `part`: `n/a`, `e`, `v` or `frequency`. The check also requires that a larger E/a belongs to a slower
/// command. Claims 9-196 and 9-234.
fn slower_is_larger(given: &CheckArguments) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let motions = [1.0, 5.0, 20.0].map(|force| cycle(given, &table, force));
    let [(slow, one), (slower, two), (slowest, three)] = {
        let [a, b, c] = motions;
        [a?, b?, c?]
    };
    let is_slower = one.velocity > two.velocity && two.velocity > three.velocity;
    let cycles = [(slow, one), (slower, two), (slowest, three)];
    type CycleQuantity = fn(&(LimitCycle, Oscillation)) -> f64;
    let parts: [(&str, (CycleQuantity, f64)); 4] = [
        ("n/a", (|(cycle, _)| cycle.friction_by_spare(), 1.0)),
        ("e", (|(_, motion)| motion.error / MM, 1.0)),
        ("v", (|(_, motion)| motion.swing / MM_PER_S, 1.0)),
        ("frequency", (|(_, motion)| motion.frequency, -1.0)),
    ];
    let (part, sign) = given.choice("part", &parts)?;
    let values = cycles.each_ref().map(part);
    let follows = values.windows(2).all(|pair| sign * (pair[1] - pair[0]) > 0.0);
    let velocities = cycles.each_ref().map(|(_, motion)| motion.velocity / MM_PER_S);
    Ok(Finding::shape(is_slower && follows, format!("{values:.4?} at {velocities:.2?} mm/s")))
}

/// The limit cycles with both stiffnesses of the text, at one E/a; the stiffer drive first.
fn both_stiffnesses(given: &CheckArguments) -> Result<[(LimitCycle, Oscillation); 2], CheckError> {
    let (table, force) = (table(given)?, given.number("E")?);
    let softer = DrivenTable { stiffness: 0.5 * table.stiffness, ..table };
    Ok([cycle(given, &table, force)?, cycle(given, &softer, force)?])
}

/// Checks that with half the stiffness n/a and the amplitude of velocity are larger and the frequency is lower.
///
/// The finding states the three ratios. Claim 9-197.
fn softer_is_larger(given: &CheckArguments) -> Result<Finding, CheckError> {
    let [(hard, hard_motion), (soft, soft_motion)] = both_stiffnesses(given)?;
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

/// The increase of the amplitude of velocity with half the stiffness, in percent.
///
/// Amplitudes are proportional to 1 / sqrt(K), so the result is 41 %. The text says about 50 %. Claims 9-237.1, 9-237.5
/// and 9-237.20.
fn softer_swings_more(given: &CheckArguments) -> Result<Finding, CheckError> {
    let [(_, hard), (_, soft)] = both_stiffnesses(given)?;
    Ok(Finding::Number(100.0 * (soft.swing / hard.swing - 1.0)))
}

/// Checks that the steady velocity of the limit cycle is higher with half the stiffness.
///
/// Without Tc the slope Cn = f / g hardly depends on K, so the velocities agree to the printed digits. Claims 9-198.a
/// and b.
fn softer_ends_later(given: &CheckArguments) -> Result<Finding, CheckError> {
    let [(_, hard), (_, soft)] = both_stiffnesses(given)?;
    let [hard, soft] = [hard, soft].map(|motion| motion.velocity / MM_PER_S);
    // The tolerance is half a unit of the last digit that the text prints.
    Ok(Finding::shape(soft > hard + 0.005, format!("{hard:.3} mm/s, with half the stiffness {soft:.3}")))
}

/// Checks that the critical velocity of the limit cycles without Tc agrees with the critical velocity with Tc.
///
/// "Agrees" means to 2 %. If no critical velocity with Tc exists, the statement does not hold, and the finding states
/// the reason. Claim 9-238.
fn without_memory(given: &CheckArguments) -> Result<Finding, CheckError> {
    let table = table(given)?;
    let plain = DrivenTable { memory: 0.0, ..table };
    let (_, motion) = cycle(given, &plain, 1.0)?;
    let friction = FallingFriction::simulated(given.number_or("VcL", 0.04)?);
    let plain = motion.velocity / MM_PER_S;
    match table.critical_velocity(&friction) {
        Ok(velocity) => {
            let velocity = velocity / MM_PER_S;
            let found = format!("{plain:.2} mm/s without Tc, {velocity:.2} mm/s with Tc");
            Ok(Finding::truth((plain / velocity - 1.0).abs() < 0.02, found))
        }
        Err(reason) => Ok(Finding::truth(false, format!("{plain:.2} mm/s without Tc; with Tc {reason}"))),
    }
}

/// Checks whether a printed number is the product of two others, if each may be off by half a unit of its last digit.
///
/// Arguments: `a`, `b` and `is`, as printed. The slack is |b| da + |a| db + dp with half a unit of the last digit for
/// each. Table T9-6 (eq 84-9): claims 9-205.own ... 9-230.own and 9-210.b.
fn product_of_digits(given: &CheckArguments) -> Result<Finding, CheckError> {
    let [first, second, product] = ["a", "b", "is"].map(|name| printed(given, name));
    let (first, second, product) = (first?, second?, product?);
    let half = |number: &PrintedNumber| 0.5 * number.last_digit();
    let slack = half(&first) * second.number.abs() + half(&second) * first.number.abs() + half(&product);
    let got = first.number * second.number;
    let found = format!("{} x {} = {:.5}", first.text, second.text, got);
    Ok(Finding::truth((got - product.number).abs() <= slack, found))
}

/// A printed number among the arguments. Its text is kept, because the number of digits counts.
fn printed(given: &CheckArguments, name: &str) -> Result<PrintedNumber, ArgumentError> {
    let text = given.require(name)?;
    PrintedNumber::parse(text)
        .ok_or_else(|| ArgumentError::NotANumber { name: name.to_owned(), text: text.to_owned() })
}
