//! Chapter 9: the study's laws and measurements beside runs of the circuit.

use super::graph::by_ratio;
use super::{Drawn, Figure, Graph};
use crate::chain::{Compared, Settings, table_9_2};
use crate::plot::Picture;
use crate::replay::boundary::{self, MEMORIES, undisturbed};
use crate::replay::recipe::Problem;
use crate::slideway::falling::FallingFriction;
use crate::slideway::simulated::SLOPE_BY_MEMORY;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{MM_PER_S, MS, N_PER_MM, N_S_PER_MM, POISE};

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[Figure {
    id: "table-9-2",
    place: "9.3, table T9-2",
    title: "twelve measured critical velocities beside equation and simulation",
    claims: &[],
    draw: measured,
}];

/// Slopes at which oscillation of the circuit ends, by time constant: by ramps at two rates and by small disturbances, beside the
/// study's law and Routh-Hurwitz; with what is read off it.
pub(super) fn slopes_of_the_circuit() -> Result<(Picture, String), Problem> {
    let ceased = boundary::sweep()?;
    let (fast, law) = boundary::slopes_at_tops(ceased)?;
    let (slow, slower_law) = boundary::slopes_at_rate(0.3e-3)?;
    let mut small = Vec::new();
    for top in MEMORIES.iter().filter_map(|memory| boundary::top(ceased, *memory)) {
        if let Some(velocity) = undisturbed(&[("Tc", top.memory), ("VcL", top.limit)], top.limit)? {
            small.push((top.memory, FallingFriction::simulated(top.limit).slope(velocity)? / N_S_PER_MM));
        }
    }
    let in_ms = |points: Vec<(f64, f64)>| points.into_iter().map(|(x, y)| (x / MS, y)).collect::<Vec<_>>();
    let memories = || by_ratio(0.006, 0.025, 40);
    let theory = memories().map(|memory| {
        Ok::<_, Problem>((memory / MS, DrivenTable::simulated(memory).critical_slope()? / N_S_PER_MM))
    });
    let study = memories().map(|memory| (memory / MS, SLOPE_BY_MEMORY.at(memory)));
    let graph = Graph::new("(b) the circuit, run", ("time constant Tc", "ms"), ("slope Cn", "N s/mm"))
        .logarithmic(true, true)
        .across(5.0, 30.0)
        .up(20.0, 500.0)
        .line("study's simulation: 7.5e4 Tc^1.54 (1-9)", study.collect())
        .line("Routh-Hurwitz (32-9)", theory.collect::<Result<_, _>>()?)
        .dots("ramp of 1.2 mm/s2", in_ms(fast))
        .dots("ramp of 0.3 mm/s2", in_ms(slow))
        .dots("small disturbances at constant speed", in_ms(small));
    let reading = format!(
        "run, ramps of 1.2 mm/s2 give {:.2e} Tc^{:.2}, of 0.3 mm/s2 {:.2e} Tc^{:.2}, and small disturbances Routh-Hurwitz: a ramp \
         overruns the boundary",
        law.factor, law.exponent, slower_law.factor, slower_law.exponent
    );
    Ok((graph.picture(), reading))
}

/// What stands beside a measured critical velocity in T9-2, in m/s.
type Beside = (&'static str, fn(&Compared) -> Option<f64>);

const BESIDE: [Beside; 4] = [
    ("equation (18-9)", |row| row.equation.clone().ok()),
    ("Routh-Hurwitz", |row| row.stability.clone().ok().filter(|velocity| *velocity > 0.0)),
    ("run, command rising", |row| row.run.rising.ok()),
    ("run, command falling", |row| row.run.falling.ok()),
];

fn measured(_: &Figure) -> Result<Drawn, Problem> {
    // What is drawn at the same time has the other threads.
    let compared = table_9_2(&Settings { threads: 1, ..Settings::default() })?;
    let drives: Vec<&[Compared]> =
        compared.chunk_by(|one, next| one.cell.stiffness == next.cell.stiffness).collect();
    let pictures = drives.iter().map(|cells| beside_measured(cells)).collect();
    let told: Vec<_> = drives.iter().map(|cells| runs_told(cells)).collect();
    let reading =
        format!("run with a rising command, the circuit gives {} of what was measured", told.join(", "));
    let settings = "what was measured is lost but for the Tc of T9-2, eq 15-9 run backwards; 450 kgf, Fs = 1249 N, f = 10.7 N s/mm, VcL and Tc by the oil (eqs 11-9, 17-9)";
    Ok(Drawn::of_theory(pictures, settings, reading))
}

fn in_kn_per_mm(cells: &[Compared]) -> f64 {
    cells[0].cell.stiffness / N_PER_MM / 1e3
}

/// The cells of one drive, by viscosity.
fn beside_measured(cells: &[Compared]) -> Picture {
    let points = |value: fn(&Compared) -> Option<f64>| -> Vec<(f64, f64)> {
        let point = |row: &Compared| Some((row.cell.viscosity / POISE, value(row)? / MM_PER_S));
        cells.iter().filter_map(point).collect()
    };
    let title = format!("{} kN/mm", in_kn_per_mm(cells));
    let mut graph = Graph::new(&title, ("viscosity", "P"), ("Vc", "mm/s"))
        .across(0.0, 0.7)
        .dots("behind T9-2 (eq 15-9 backwards)", points(|row| Some(row.measured)));
    for (name, value) in BESIDE {
        let points = points(value);
        if !points.is_empty() {
            graph = graph.line(name, points);
        }
    }
    graph.picture()
}

/// "0.84 ... 0.97 at 27.6 kN/mm".
fn runs_told(cells: &[Compared]) -> String {
    let shares = cells.iter().filter_map(|row| Some(row.run.rising.ok()? / row.measured));
    let (least, most) =
        shares.fold((f64::INFINITY, 0.0_f64), |(least, most), share| (least.min(share), most.max(share)));
    format!("{least:.2} ... {most:.2} at {} kN/mm", in_kn_per_mm(cells))
}
