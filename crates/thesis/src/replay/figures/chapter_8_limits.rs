//! Chapter 8, third part: critical velocities of many settings.

use super::graph::{by_ratio, evenly};
use super::{Drawn, Figure, Graph, Sweep, listed, told};
use crate::replay::boundary::{self, MEMORIES, RATE, of_memory};
use crate::replay::recipe::Problem;
use crate::slideway::SlidewayError;
use crate::slideway::falling::FallingFriction;
use crate::slideway::simulated::SLOPE_BY_MEMORY;
use crate::slideway::stability::{DrivenTable, SIMULATED_DAMPING};
use crate::slideway::units::{MM_PER_S, MS, N_PER_MM, N_S_PER_MM};

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

/// The sweep of every time constant with some values of VcL.
fn as_swept(limits: &[f64]) -> Sweep {
    let vary = vec![("VcL", listed(limits)), ("Tc", listed(&MEMORIES))];
    Sweep { which: "", recipe: boundary::ramp(RATE), vary, measure: "critical_velocity" }
}

/// Of the sweep's time constants these are drawn, in s.
const DRAWN: [f64; 5] = [0.006, 0.0071, 0.010, 0.015, 0.025];

fn by_limit(figure: &Figure) -> Result<Drawn, Problem> {
    let ceased = boundary::sweep()?;
    let mut simulated =
        Graph::new("(a) simulated, command rising at 1.2 mm/s2", ("VcL", "mm/s"), ("Vc", "mm/s"));
    let mut printed =
        Graph::new("(b) by the study's law, Cn = 7.5e4 Tc^1.54", ("VcL", "mm/s"), ("Vc", "mm/s"));
    (simulated, printed) = (simulated.up(0.0, 14.0), printed.up(0.0, 14.0));
    for memory in DRAWN {
        let name = format!("Tc = {}", told(memory, "s"));
        let points = of_memory(ceased, memory)
            .filter_map(|ceased| Some((ceased.limit / MM_PER_S, ceased.velocity.ok()? / MM_PER_S)));
        simulated = simulated.line(&name, points.collect());
        let slope = SLOPE_BY_MEMORY.at(memory) * N_S_PER_MM;
        let law = evenly(0.5e-3, 25.4e-3, 100).filter_map(|limit| {
            let velocity = FallingFriction::simulated(limit).velocity_at_slope(slope).ok()?;
            Some((limit / MM_PER_S, velocity / MM_PER_S))
        });
        printed = printed.line(&name, law.collect());
    }
    let (_, law) = boundary::slopes_at_tops()?;
    let (tops, highest) = (boundary::tops()?, boundary::highest()?);
    let reading = format!(
        "the highest is {} at 6 ms, at VcL = {}, and {} at 25 ms; slopes at the tops go with {:.2e} Tc^{:.2} N s/mm",
        told(highest[0], "m/s"),
        told(tops[0].1, "m/s"),
        told(highest[highest.len() - 1], "m/s"),
        law.factor,
        law.exponent,
    );
    Drawn::of_sweeps(
        figure,
        &[as_swept(&boundary::limits())],
        vec![simulated.picture(), printed.picture()],
        reading,
    )
}

/// A law of the slope at which oscillation ends, in N s/m by time constant in s.
type SlopeLaw = (&'static str, fn(f64) -> Result<f64, SlidewayError>);

fn by_memory(figure: &Figure) -> Result<Drawn, Problem> {
    let limits = [2.54e-3, 10.16e-3, 25.4e-3];
    let ceased = boundary::sweep()?;
    let slopes: [SlopeLaw; 2] = [
        ("(a) by Routh-Hurwitz", |memory| DrivenTable::simulated(memory).critical_slope()),
        ("(b) by the study's law (4-9), Cn = 7.5e4 Tc^1.54", |memory| {
            Ok(SLOPE_BY_MEMORY.at(memory) * N_S_PER_MM)
        }),
    ];
    let pictures = slopes.map(|(title, slope)| {
        let mut graph = Graph::new(title, ("Tc", "ms"), ("Vc", "mm/s")).across(0.0, 25.0).up(0.0, 24.0);
        for limit in limits {
            let at = ceased.iter().filter(|ceased| (ceased.limit - limit).abs() < 1e-9);
            let points = at.filter_map(|ceased| Some((ceased.memory / MS, ceased.velocity.ok()? / MM_PER_S)));
            graph = graph.dots(format!("simulated, VcL = {}", told(limit, "m/s")), points.collect());
        }
        for limit in limits {
            let law = by_ratio(0.5e-3, 25e-3, 200).filter_map(|memory| {
                let velocity =
                    FallingFriction::simulated(limit).velocity_at_slope(slope(memory).ok()?).ok()?;
                (velocity > 0.0).then_some((memory / MS, velocity / MM_PER_S))
            });
            graph = graph.line(format!("law, {}", told(limit, "m/s")), law.collect());
        }
        graph.picture()
    });
    let limiting = FallingFriction::simulated(25.4e-3).velocity_of_least(SIMULATED_DAMPING)?;
    let reading = format!(
        "as Tc tends to 0, Vc tends to VcL (1 - f VcL / (2 Fs)): {} for 25.4 mm/s, not 25.4 mm/s",
        told(limiting, "m/s")
    );
    Drawn::of_sweeps(figure, &[as_swept(&limits)], pictures.to_vec(), reading)
}

/// The stiffnesses of the study's tests lie within 5 ... 45 kN/mm; in N/m.
const STIFFNESSES: [f64; 9] = [5e6, 7.5e6, 10e6, 12.5e6, 15e6, 20e6, 25e6, 30e6, 45e6];

fn by_stiffness(figure: &Figure) -> Result<Drawn, Problem> {
    let read = boundary::by_stiffness(&STIFFNESSES)?.into_iter();
    let simulated: Vec<_> =
        read.map(|(stiffness, velocity)| (stiffness / N_PER_MM / 1e3, velocity / MM_PER_S)).collect();
    let friction = boundary::friction_of_other_stiffness();
    let stiffnesses = by_ratio(4e6, 45e6, 100);
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
        .across(0.0, 50.0)
        .up(0.0, 40.0)
        .dots("simulated", simulated.clone())
        .line("Routh-Hurwitz", theory.collect())
        .line("the study's Cn = 16 K^0.077", law.collect());
    let told: Vec<_> = simulated.iter().map(|(k, v)| format!("{v:.1} mm/s at {k} kN/mm")).collect();
    let reading = format!("oscillation ends at {}", told.join(", "));
    let sweep = Sweep {
        which: "",
        recipe: boundary::ramp_of_other_stiffness(),
        vary: vec![("K", listed(&STIFFNESSES))],
        measure: "critical_velocity",
    };
    Drawn::of_sweeps(figure, &[sweep], vec![graph.picture()], reading)
}
