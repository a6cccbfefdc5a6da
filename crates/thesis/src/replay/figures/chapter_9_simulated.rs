//! Chapter 9: the study's laws and measurements beside runs of the circuit.

use super::graph::by_ratio;
use super::{Drawn, Figure, Graph, Sweep, listed};
use crate::chain::{Compared, Settings, table_9_2};
use crate::replay::boundary::{self, MEMORIES, RATE, Slopes, undisturbed};
use crate::replay::recipe::Problem;
use crate::replay::table::Table;
use crate::slideway::falling::FallingFriction;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::simulated::SLOPE_BY_MEMORY;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{MM_PER_S, MS, N_PER_MM, N_S_PER_MM, POISE};
use patchcord_draw::plot::Picture;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[Figure {
    id: "table-9-2",
    place: "9.3, table T9-2",
    title: "twelve measured critical velocities beside equation and simulation",
    claims: &[],
    draw: measured,
}];

const REASON: &str = "A ramp goes on while oscillation dies away, and so ends it beyond the boundary of small motions, at a lower slope; the longer the \
                      time constant, the lower the critical velocity and the larger the share that is overrun. That lowers the exponent. The slower \
                      the ramp and the larger the threshold, the sooner oscillation counts as ended, and the nearer to that boundary. A time constant at which a \
                      threshold sees no oscillation is no point of its law.";

/// Rates in m/s2 and thresholds in m/s at which slopes are read.
const RATES: [f64; 4] = [2.4e-3, RATE, 0.3e-3, 0.075e-3];
const THRESHOLDS: [f64; 3] = [0.25e-3, 0.5e-3, 1e-3];

/// Slopes at the tops by small disturbances of steady sliding.
fn slopes_by_disturbance() -> Result<Vec<(f64, f64)>, Problem> {
    let mut small = Vec::new();
    for &(memory, limit) in boundary::tops()? {
        if let Some(velocity) = undisturbed(&[("Tc", memory), ("VcL", limit)], limit)? {
            small.push((memory, FallingFriction::simulated(limit).slope(velocity)? / N_S_PER_MM));
        }
    }
    Ok(small)
}

/// Slopes at which oscillation of the circuit ends, by time constant, by ramps and by small disturbances, beside the study's law and
/// Routh-Hurwitz; with the laws that fit them, by rate and threshold.
pub(super) struct SlopesOfTheCircuit {
    pub pictures: Vec<Picture>,
    pub reading: String,
    pub table: Table,
    pub sweep: Sweep,
}

pub(super) fn slopes_of_the_circuit() -> Result<SlopesOfTheCircuit, Problem> {
    let ramps: Vec<Vec<Slopes>> =
        RATES.iter().map(|rate| boundary::slopes_at_rate(*rate, &THRESHOLDS)).collect::<Result<_, _>>()?;
    let small = slopes_by_disturbance()?;
    let theory: Vec<_> = by_ratio(0.006, 0.025, 40)
        .map(|memory| {
            Ok::<_, Problem>((memory, DrivenTable::simulated(memory).critical_slope()? / N_S_PER_MM))
        })
        .collect::<Result<_, _>>()?;
    let (theory_law, small_law) = (PowerLaw::fit(&theory)?, PowerLaw::fit(&small)?);
    let mut table = Table::new(
        REASON,
        ["how", "threshold, mm/s", "factor, N s/mm", "exponent", "Cn at 6 ms, N s/mm", "at 25 ms", "points"],
    );
    let mut row = |how: String, threshold: String, law: &PowerLaw, points: String| {
        let slopes = [0.006, 0.025].map(|memory| format!("{:.1}", law.at(memory)));
        let law = [format!("{:.2e}", law.factor), format!("{:.3}", law.exponent)];
        table.rows.push([how, threshold].into_iter().chain(law).chain(slopes).chain([points]).collect());
    };
    for (rate, laws) in RATES.iter().zip(&ramps) {
        for (threshold, (points, law)) in THRESHOLDS.iter().zip(laws) {
            row(ramp_told(*rate), (threshold / MM_PER_S).to_string(), law, points.len().to_string());
        }
    }
    row("small disturbances".to_owned(), "none".to_owned(), &small_law, small.len().to_string());
    row("Routh-Hurwitz".to_owned(), "none".to_owned(), &theory_law, "law".to_owned());
    row("the study, eq 1-9".to_owned(), "not told".to_owned(), &SLOPE_BY_MEMORY, "law".to_owned());
    let laws = ramps.iter().zip(RATES).map(|(laws, rate)| {
        format!("{:.2e} Tc^{:.2} by ramps of {} mm/s2", laws[0].1.factor, laws[0].1.exponent, rate / MM_PER_S)
    });
    let reading = format!(
        "run, the circuit gives {}, and {:.2e} Tc^{:.2} by small disturbances, where Routh-Hurwitz has {:.2e} Tc^{:.2}: the slower the \
         ramp, the nearer to the boundary it ends",
        laws.collect::<Vec<_>>().join(", "),
        small_law.factor,
        small_law.exponent,
        theory_law.factor,
        theory_law.exponent
    );
    let pictures = vec![slopes(&ramps, small, theory), exponents(&ramps, theory_law.exponent)];
    let vary = vec![("Tc", listed(&MEMORIES)), ("VcL", listed(&boundary::limits()))];
    let sweep = Sweep { which: "", recipe: boundary::ramp(RATE), vary, measure: "critical_velocity" };
    Ok(SlopesOfTheCircuit { pictures, reading, table, sweep })
}

fn ramp_told(rate: f64) -> String {
    format!("ramp of {} mm/s2", rate / MM_PER_S)
}

/// Slopes by time constant, ramps at the usual threshold.
fn slopes(ramps: &[Vec<Slopes>], small: Vec<(f64, f64)>, theory: Vec<(f64, f64)>) -> Picture {
    let in_ms = |points: Vec<(f64, f64)>| points.into_iter().map(|(x, y)| (x / MS, y)).collect::<Vec<_>>();
    let study = by_ratio(0.006, 0.025, 40).map(|memory| (memory / MS, SLOPE_BY_MEMORY.at(memory)));
    let mut graph = Graph::new("(b) the circuit, run", ("time constant Tc", "ms"), ("slope Cn", "N s/mm"))
        .logarithmic(true, true)
        .across(5.0, 30.0)
        .up(20.0, 500.0)
        .line("study's simulation: 7.5e4 Tc^1.54 (1-9)", study.collect())
        .line("Routh-Hurwitz (32-9)", in_ms(theory));
    // The fastest is seen in (c): there are no more colours than the others take.
    for (rate, laws) in RATES.iter().zip(ramps).skip(1) {
        graph = graph.dots(ramp_told(*rate), in_ms(laws[0].0.clone()));
    }
    graph.dots("small disturbances at constant speed", in_ms(small)).picture()
}

/// Exponents by the rate of the command, for each threshold.
fn exponents(ramps: &[Vec<Slopes>], theory: f64) -> Picture {
    let title = "(c) exponent of Cn against Tc";
    let mut graph = Graph::new(title, ("rate of the command", "mm/s2"), ("exponent", ""))
        .logarithmic(true, false)
        .up(0.6, 1.8);
    for (index, threshold) in THRESHOLDS.iter().enumerate() {
        let points = RATES.iter().zip(ramps).map(|(rate, laws)| (rate / MM_PER_S, laws[index].1.exponent));
        graph = graph.line(format!("swings above {} mm/s", threshold / MM_PER_S), points.collect());
    }
    let ends = |value: f64| vec![(RATES[RATES.len() - 1] / MM_PER_S, value), (RATES[0] / MM_PER_S, value)];
    graph.line("the study", ends(SLOPE_BY_MEMORY.exponent)).line("Routh-Hurwitz", ends(theory)).picture()
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
    let drawn = Drawn::of_theory(pictures, settings, reading);
    let command = "patchcord slideway --oil 0.34 --weight 450 --stiffness 27.6";
    Ok(Drawn { commands: vec![format!("{command}, and the like: docs/slideway.md")], ..drawn })
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
