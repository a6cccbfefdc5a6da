//! Chapter 8, fourth part: critical velocities of many settings (8.5).
//!
//! Points are ramps of the final circuit. Curves are the printed laws and the stability criterion of Routh and
//! Hurwitz.

use super::graph::{geomspace, linspace};
use super::{DrawnFigure, Figure, Graph, SweepCommand, comma_separated};
use crate::replay::boundary::{self, MEMORIES, RATE, with_memory};
use crate::replay::recipe::BoxError;
use crate::slideway::SlidewayError;
use crate::slideway::falling::FallingFriction;
use crate::slideway::simulated::SLOPE_BY_MEMORY;
use crate::slideway::stability::{DrivenTable, SIMULATED_DAMPING};
use crate::slideway::units::{MM_PER_S, MS, N_PER_MM, N_S_PER_MM};
use patchcord_analysis::format::format_quantity;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-8-30",
        place: "8.5, eq 40-8 ... 45-8",
        title: "critical velocity against VcL, for time constants of 6 ... 25 ms",
        claims: &["8-134", "8-137", "8-139", "8-140", "8-141.a", "8-141.b", "8-142"],
        draw: by_limit,
    },
    Figure {
        id: "fig-8-31",
        place: "8.5, eq 46-8 ... 51-8",
        title: "critical velocity against Tc, for three values of VcL",
        claims: &["8-143.a", "8-143.b", "8-144", "8-145", "8-146", "8-147"],
        draw: by_memory,
    },
    Figure {
        id: "fig-8-35",
        place: "8.5",
        title: "critical velocity against drive stiffness",
        claims: &[],
        draw: by_stiffness,
    },
];

/// Returns the sweep of every time constant with some values of VcL in m/s, as a command line.
fn sweep_command(limits: &[f64]) -> SweepCommand {
    let vary = vec![("VcL", comma_separated(limits)), ("Tc", comma_separated(&MEMORIES))];
    SweepCommand { which: "", recipe: boundary::ramp(RATE), vary, measure: "critical_velocity" }
}

/// The time constants of the sweep that are plotted, in s.
const PLOTTED: [f64; 5] = [0.006, 0.0071, 0.010, 0.015, 0.025];

/// Fig 8.30: critical velocity against VcL, by simulation and by the law of the thesis.
///
/// Every curve has one maximum. By eq 44-8 and 45-8 it is Fs / (2 Cn) at VcL = Fs / Cn.
fn by_limit(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let results = boundary::sweep()?;
    let mut simulated =
        Graph::new("(a) simulated, command rising at 1.2 mm/s2", ("VcL", "mm/s"), ("Vc", "mm/s"));
    let mut printed =
        Graph::new("(b) by the thesis's law, Cn = 7.5e4 Tc^1.54", ("VcL", "mm/s"), ("Vc", "mm/s"));
    (simulated, printed) = (simulated.y_range(0.0, 14.0), printed.y_range(0.0, 14.0));
    for memory in PLOTTED {
        let name = format!("Tc = {}", format_quantity(memory, "s"));
        let points = with_memory(results, memory)
            .filter_map(|result| Some((result.limit / MM_PER_S, result.velocity.ok()? / MM_PER_S)));
        simulated = simulated.line(&name, points.collect());
        let slope = SLOPE_BY_MEMORY.at(memory) * N_S_PER_MM;
        let law = linspace(0.5e-3, 25.4e-3, 100).filter_map(|limit| {
            let velocity = FallingFriction::simulated(limit).velocity_at_slope(slope).ok()?;
            Some((limit / MM_PER_S, velocity / MM_PER_S))
        });
        printed = printed.line(&name, law.collect());
    }
    let (_, law) = boundary::slopes_at_worst_limits()?;
    let (worst_limits, highest) = (boundary::worst_limits()?, boundary::max_critical_velocities()?);
    let reading = format!(
        "the maximum is {} at 6 ms, at VcL = {}, and {} at 25 ms; slopes at the maxima are {:.2e} Tc^{:.2} N s/mm",
        format_quantity(highest[0], "m/s"),
        format_quantity(worst_limits[0].1, "m/s"),
        format_quantity(highest[highest.len() - 1], "m/s"),
        law.factor,
        law.exponent,
    );
    DrawnFigure::from_sweeps(
        figure,
        &[sweep_command(&boundary::limits())],
        vec![simulated.picture(), printed.picture()],
        reading,
    )
}

/// A law of the slope at which oscillation ends, in N s/m, by time constant in s, with its name.
type SlopeLaw = (&'static str, fn(f64) -> Result<f64, SlidewayError>);

/// Fig 8.31: critical velocity against Tc for three values of VcL, compared with two laws.
fn by_memory(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let limits = [2.54e-3, 10.16e-3, 25.4e-3];
    let results = boundary::sweep()?;
    let slopes: [SlopeLaw; 2] = [
        ("(a) by Routh-Hurwitz", |memory| DrivenTable::simulated(memory).critical_slope()),
        ("(b) by the thesis's law (4-9), Cn = 7.5e4 Tc^1.54", |memory| {
            Ok(SLOPE_BY_MEMORY.at(memory) * N_S_PER_MM)
        }),
    ];
    let pictures = slopes.map(|(title, slope)| {
        let mut graph = Graph::new(title, ("Tc", "ms"), ("Vc", "mm/s")).x_range(0.0, 25.0).y_range(0.0, 24.0);
        for limit in limits {
            let at = results.iter().filter(|result| (result.limit - limit).abs() < 1e-9);
            let points = at.filter_map(|result| Some((result.memory / MS, result.velocity.ok()? / MM_PER_S)));
            graph =
                graph.dots(format!("simulated, VcL = {}", format_quantity(limit, "m/s")), points.collect());
        }
        for limit in limits {
            let law = geomspace(0.5e-3, 25e-3, 200).filter_map(|memory| {
                let velocity =
                    FallingFriction::simulated(limit).velocity_at_slope(slope(memory).ok()?).ok()?;
                (velocity > 0.0).then_some((memory / MS, velocity / MM_PER_S))
            });
            graph = graph.line(format!("law, {}", format_quantity(limit, "m/s")), law.collect());
        }
        graph.picture()
    });
    let limiting = FallingFriction::simulated(25.4e-3).velocity_of_least(SIMULATED_DAMPING)?;
    let reading = format!(
        "as Tc tends to 0, Vc tends to VcL (1 - f VcL / (2 Fs)): {} for 25.4 mm/s, not 25.4 mm/s",
        format_quantity(limiting, "m/s")
    );
    DrawnFigure::from_sweeps(figure, &[sweep_command(&limits)], pictures.to_vec(), reading)
}

/// Stiffnesses that are run, in N/m. The tests of the thesis are within 5 ... 45 kN/mm.
const STIFFNESSES: [f64; 9] = [5e6, 7.5e6, 10e6, 12.5e6, 15e6, 20e6, 25e6, 30e6, 45e6];

/// Fig 8.35: critical velocity against drive stiffness, compared with two laws.
///
/// VcL is 40 mm/s and Tc 7.1 ms. The laws are Routh-Hurwitz (eq 32-9) and 16 K^0.077 N s/mm (eq 5-9).
fn by_stiffness(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let read = boundary::velocities_by_stiffness(&STIFFNESSES)?.into_iter();
    let simulated: Vec<_> =
        read.map(|(stiffness, velocity)| (stiffness / N_PER_MM / 1e3, velocity / MM_PER_S)).collect();
    let friction = boundary::stiffness_test_friction();
    let stiffnesses = geomspace(4e6, 45e6, 100);
    let theory = stiffnesses.clone().filter_map(|stiffness| {
        let table = DrivenTable { stiffness, ..DrivenTable::simulated(0.0071) };
        let velocity = table.critical_velocity(&friction).ok()?;
        (velocity > 0.0).then_some((stiffness / N_PER_MM / 1e3, velocity / MM_PER_S))
    });
    let law = stiffnesses.filter_map(|stiffness| {
        let slope = crate::slideway::simulated::SLOPE_BY_STIFFNESS.at(stiffness / N_PER_MM) * N_S_PER_MM;
        Some((stiffness / N_PER_MM / 1e3, friction.velocity_at_slope(slope).ok()? / MM_PER_S))
    });
    let graph = Graph::new(&figure.heading(), ("K", "kN/mm"), ("Vc", "mm/s"))
        .x_range(0.0, 50.0)
        .y_range(0.0, 40.0)
        .dots("simulated", simulated.clone())
        .line("Routh-Hurwitz", theory.collect())
        .line("the thesis's Cn = 16 K^0.077", law.collect());
    let texts: Vec<_> = simulated.iter().map(|(k, v)| format!("{v:.1} mm/s at {k} kN/mm")).collect();
    let reading = format!("oscillation ends at {}", texts.join(", "));
    let sweep = SweepCommand {
        which: "",
        recipe: boundary::stiffness_test_ramp(),
        vary: vec![("K", comma_separated(&STIFFNESSES))],
        measure: "critical_velocity",
    };
    DrawnFigure::from_sweeps(figure, &[sweep], vec![graph.picture()], reading)
}
