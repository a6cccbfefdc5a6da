//! Chapter 9: limit cycles by describing functions (9.4 (ii)).
//!
//! The table oscillates by itself where its frequency response meets the negative reciprocal of the describing
//! function of friction. The intersection gives the frequency and the amplitude.

use super::chapter_9_describing::{
    Curve, DRIVES, SETTINGS, complex_plane, locus, negative_reciprocal, open_loop_point, table,
};
use super::graph::{geomspace, linspace, sample_curve};
use super::{DrawnFigure, Figure, Graph};
use crate::replay::recipe::BoxError;
use crate::slideway::SlidewayError;
use crate::slideway::describing::{LimitCycle, Oscillation, Swing, oscillation_at};
use crate::slideway::falling::FallingFriction;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{MM_PER_S, N_S_PER_MM};

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-9-15",
        place: "9.4 (ii), Tables T9-4, T9-5",
        title: "Nyquist diagram with intersections",
        claims: &[
            "9-097", "9-113", "9-115", "9-121", "9-133", "9-151", "9-157", "9-165", "9-196.a", "9-196.b",
        ],
        draw: nyquist,
    },
    Figure {
        id: "fig-9-16",
        place: "9.4 (ii), table before eq 84-9",
        title: "modulus by phase angle, and where the curves meet",
        claims: &["9-170", "9-174", "9-178", "9-182", "9-186", "9-190", "9-193", "9-197"],
        draw: modulus_by_angle,
    },
    Figure {
        id: "fig-9-17",
        place: "9.4 (ii), Table T9-6",
        title: "velocity profile by describing functions",
        claims: &["9-203", "9-208", "9-213", "9-215", "9-230", "9-235.45", "9-236.45.5", "9-237.1", "9-238"],
        draw: profile,
    },
];

/// Ratios E/a of the thesis: amplitude of the force by viscous friction.
const FORCES: [f64; 3] = [1.0, 5.0, 20.0];

/// Ratios n/a of Table T9-4: amplitude of friction by viscous friction.
const T9_4: [f64; 9] = [0.0, 0.1, 0.4, 0.6, 1.0, 2.0, 4.0, 5.0, 10.0];

/// Fig 9.15: the Nyquist diagram of both tables with the curves of friction.
///
/// The intersections are the solutions of 1 + N G = 0 (claims 9-170 ... 9-193).
fn nyquist(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = complex_plane(figure).x_range(-2.5, 0.0).y_range(-1.0, 0.2);
    for drive in DRIVES {
        let low = 150.0 * (drive / DRIVES[0]).sqrt();
        graph = graph.line(format!("G(jω), {drive} MN/m"), locus(&table(drive), low, 3000.0)?);
    }
    let mut dots = Vec::new();
    for force in FORCES {
        let curve: Vec<_> = linspace(0.0, 10.0, 201)
            .map(|friction| negative_reciprocal(force, friction))
            .collect::<Result<_, _>>()?;
        graph = graph.line(format!("−1 / NE, E/a = {force}"), curve);
        let printed = T9_4.iter().map(|friction| negative_reciprocal(force, *friction));
        dots.extend(printed.collect::<Result<Vec<_>, _>>()?);
    }
    let intersections =
        limit_cycles()?.into_iter().map(|(table, cycle)| open_loop_point(&table, cycle.frequency));
    let intersections = intersections.collect::<Result<_, _>>()?;
    let graph = graph.dots("n/a of Table T9-4", dots).dots("limit cycles", intersections);
    let cycle = table(DRIVES[0]).limit_cycle(FORCES[2])?;
    let reading = format!(
        "the curves meet at E/a = 20 and 45 MN/m with n/a = {:.2} at {:.0} rad/s (printed 2.10, 235)",
        cycle.friction_amplitude(),
        cycle.frequency
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Returns the limit cycles of both tables for all ratios E/a.
fn limit_cycles() -> Result<Vec<(DrivenTable, LimitCycle)>, SlidewayError> {
    let all = DRIVES.iter().flat_map(|drive| FORCES.map(|force| (table(*drive), force)));
    all.map(|(table, force)| Ok((table, table.limit_cycle(force)?))).collect()
}

/// Fig 9.16: modulus by phase angle of the table and of friction, and their intersections.
fn modulus_by_angle(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut graph = Graph::new(&figure.heading(), ("phase angle φ, δ", "degrees"), ("|G(jω)|, 1 / |NE|", ""))
        .x_range(0.0, 10.0)
        .y_range(0.0, 2.5);
    for drive in DRIVES {
        let table = table(drive);
        let points = geomspace(90.0, 2000.0, 301).map(|frequency| by_angle(&table, frequency));
        graph = graph.line(format!("|G|, {drive} MN/m"), points.collect::<Result<_, _>>()?);
    }
    for force in FORCES {
        let points = sample_curve(linspace(0.0, 10.0, 51), |degrees| {
            Swing { force, friction: force * degrees.to_radians().tan() }.reciprocal()
        })?;
        graph = graph.line(format!("1 / |NE|, E/a = {force}"), points);
    }
    let intersections = limit_cycles()?;
    let dots = intersections.iter().map(|(table, cycle)| by_angle(table, cycle.frequency));
    let dots = dots.collect::<Result<_, _>>()?;
    let frequencies: Vec<_> =
        intersections.iter().map(|(_, cycle)| format!("{:.0}", cycle.frequency)).collect();
    let mut graph = graph.dots("they meet, at rad/s", dots);
    for (index, frequency) in frequencies.iter().enumerate() {
        graph = graph.label(index, frequency.clone());
    }
    let reading = format!(
        "at E/a = 1, 5, 20 the curves meet at {} rad/s with 45 MN/m, {} with 22.5; printed 322.2, 255, 235, 227.7, \
         180, 166",
        frequencies[..3].join(", "),
        frequencies[3..].join(", ")
    );
    Ok(DrawnFigure::from_theory(vec![graph.picture()], SETTINGS, reading))
}

/// Returns the phase of G above -180 degrees, and its modulus, at a frequency in rad/s. The angle is in degrees.
fn by_angle(table: &DrivenTable, frequency: f64) -> Result<(f64, f64), SlidewayError> {
    Ok((table.open_loop_angle(frequency)?.to_degrees(), table.open_loop(frequency)?.norm()))
}

/// Fig 9.17: the profile by describing functions for both stiffnesses.
///
/// The amplitude is v = e w with e = (E/a) f v0 / K (eq 84-9, 86-9). Oscillation ends where E/a is 1.
fn profile(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let friction = FallingFriction::simulated(40.0 * MM_PER_S);
    let heading = figure.heading();
    let mut graph = Graph::new(&heading, ("steady velocity v0", "mm/s"), ("output velocity", "mm/s"))
        .x_range(15.0, 35.0)
        .y_range(-15.0, 60.0)
        .line("command", vec![(15.0, 15.0), (35.0, 35.0)]);
    let (mut dots, mut swings) = (Vec::new(), Vec::new());
    let (mut slowest, mut reaches_rest) = (0.0, true);
    for drive in DRIVES {
        let table = table(drive);
        let motions = motions(&table, &friction)?;
        let (fastest, last) = (motions[0], motions[2]);
        let range = velocity_range(&table, &friction, last.velocity, fastest.velocity)?;
        graph = graph.line(format!("range of oscillation, {drive} MN/m"), range);
        for Oscillation { velocity, swing, .. } in motions {
            dots.extend([swing, -swing].map(|off| (velocity / MM_PER_S, (velocity + off) / MM_PER_S)));
        }
        swings.push(format!("{:.1}", last.swing / MM_PER_S));
        slowest = last.velocity;
        reaches_rest &= last.swing >= last.velocity;
    }
    let graph = graph.dots("E/a = 1, 5, 20 of Table T9-6", dots);
    let table = table(DRIVES[0]);
    let reading = format!(
        "at {:.1} mm/s the amplitude is {} mm/s ({}); oscillation ends at {:.2} mm/s, where Cn is {:.2} N s/mm",
        slowest / MM_PER_S,
        swings.join(" and "),
        if reaches_rest {
            "the table comes to rest: stick-slip"
        } else {
            "the table does not always come to rest"
        },
        motions(&table, &friction)?[0].velocity / MM_PER_S,
        table.limit_cycle(FORCES[0])?.slope / N_S_PER_MM
    );
    let settings = format!("Fs = 771 N, VcL = 40 mm/s, {SETTINGS}");
    Ok(DrawnFigure::from_theory(vec![graph.picture()], &settings, reading))
}

/// Returns the oscillations of a table for the ratios of Table T9-6, the fastest command first.
fn motions(table: &DrivenTable, friction: &FallingFriction) -> Result<Vec<Oscillation>, SlidewayError> {
    FORCES.iter().map(|force| table.limit_cycle(*force)?.oscillation(table, friction)).collect()
}

/// Returns the range of velocities of the oscillation in mm/s, by command in mm/s: along the upper edge, and back
/// along the lower one. `slow` and `fast` are the first and last command, in m/s.
fn velocity_range(
    table: &DrivenTable,
    friction: &FallingFriction,
    slow: f64,
    fast: f64,
) -> Result<Curve, BoxError> {
    // The last limit cycle is at the limit of existence, so the last command is slightly below it.
    let commands = geomspace(slow, fast * (1.0 - 1e-9), 101);
    let swings = sample_curve(commands, |velocity| Ok(oscillation_at(table, friction, velocity)?.swing))?;
    let edge = |sign: f64| {
        swings
            .iter()
            .map(move |(velocity, swing)| (velocity / MM_PER_S, (velocity + sign * swing) / MM_PER_S))
    };
    Ok(edge(1.0).chain(edge(-1.0).rev()).collect())
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_reading_contains;

    #[test]
    fn readings_agree_with_the_text() {
        assert_reading_contains("fig-9-15", "n/a = 2.10 at 235 rad/s");
        assert_reading_contains("fig-9-16", "322, 255, 235 rad/s");
        assert_reading_contains("fig-9-17", "28.89 mm/s");
    }
}
