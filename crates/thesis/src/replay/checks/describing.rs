//! Claims on describing functions (9.4 (ii)).
//!
//! Forces are in units of the viscous friction a = f v0 at the steady velocity v0. `E` is the amplitude of the drive's
//! force, E/a; `n` is that of solid friction, n/a, a quarter of a period later. The force that accelerates the mass is
//! E sin - n cos, cut off at -1, because the drive does not push back. N is the describing function of this cut-off and
//! G the frequency response of the table, K / (jw (jw M + f)).

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::series::is_rising;
use super::stability::table;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::describing::{Swing, cut_off_gain, dead_zone_gain};

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
    Check { name: "no-intersection", run: no_intersection },
    Check { name: "quadrature-weight", run: quadrature_weight },
    Check { name: "closed-loop-ratio", run: closed_loop_ratio },
    Check { name: "open-loop-modulus", run: open_loop_modulus },
    Check { name: "open-loop-angle", run: open_loop_angle },
    Check { name: "at-angle", run: at_angle },
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
    let rises = is_rising(&gains) && gains.iter().all(|gain| *gain < 1.0);
    Ok(Finding::shape(rises, format!("{gains:.3?} at amplitudes of {sizes:?} F")))
}

/// Checks that the gain is 1 for an amplitude below a.
///
/// Claim 9-078. The gain must be exactly 1.
fn small_swing_passes(given: &CheckArguments) -> Result<Finding, CheckError> {
    let gain = cut_off_gain(given.number("E")?);
    Ok(Finding::truth(gain == 1.0, format!("gain {gain}")))
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
