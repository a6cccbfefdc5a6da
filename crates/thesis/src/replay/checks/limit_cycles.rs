//! Claims on limit cycles by describing functions (9.4 (ii)).
//!
//! A limit cycle is a solution of 1 + N G = 0, with N and G as in [`describing`](super::describing). `E` is the
//! amplitude of the drive's force in units of the viscous friction a = f v0.

use super::super::check_arguments::{ArgumentError, CheckArguments};
use super::super::finding::{Finding, PrintedNumber};
use super::stability::table;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::describing::{LimitCycle, Oscillation, oscillation_at};
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{MM, MM_PER_S, N_S_PER_MM};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "large-swing-slows", run: large_swing_slows },
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

/// Checks that the gain is below 1 for an amplitude above a, and the limit cycle is slower than wn.
///
/// Claim 9-079. The frequency is wn sqrt(g) without lag.
fn large_swing_slows(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (table, natural) = (table(given)?, table(given)?.natural_frequency()?);
    let cycle = table.limit_cycle(given.number("E")?)?;
    let found = format!("gain {:.3}, {:.1} rad/s for wn = {natural:.1}", cycle.gain, cycle.frequency);
    Ok(Finding::shape(cycle.gain < 1.0 && cycle.frequency < natural, found))
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
        ("n/a", cycle.friction_amplitude()),
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
        ("n/a", (|(cycle, _)| cycle.friction_amplitude(), 1.0)),
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
        soft.friction_amplitude() / hard.friction_amplitude(),
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
