//! Chapter 9: laws and measurements of the thesis compared with runs of the circuit.
//!
//! Ramps at several rates, and small disturbances, give the slope of friction at which oscillation ends. The twelve
//! cells of Table T9-2 are run one by one.

use super::graph::geomspace;
use super::{DrawnFigure, Figure, Graph, SweepCommand, comma_separated};
use crate::chain::{MeasurementComparison, Settings, table_9_2};
use crate::replay::boundary::{self, MEMORIES, RATE, Slopes, disturbance_boundary};
use crate::replay::number_table::NumberTable;
use crate::replay::recipe::BoxError;
use crate::replay::series::min_max;
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
    title: "twelve measured critical velocities, with equation and simulation",
    claims: &[],
    draw: measured,
}];

/// The explanation of the table of slopes.
const REASON: &str = "The command of a ramp continues to rise while oscillation decays. Oscillation therefore ends \
     above the stability boundary of small motions, at a lower slope. This overrun is a larger share of the critical \
     velocity for a longer time constant, because the critical velocity is lower. That lowers the exponent. With a \
     slower ramp or a larger threshold, oscillation counts as ended nearer to that boundary. A time constant without \
     oscillation above a threshold is not a point of the law for that threshold.";

/// Rates of the command at which slopes are read, in m/s2.
const RATES: [f64; 4] = [2.4e-3, RATE, 0.3e-3, 0.075e-3];
/// Thresholds of the swing at which slopes are read, in m/s.
const THRESHOLDS: [f64; 3] = [0.25e-3, 0.5e-3, 1e-3];

/// Returns the slopes in N s/mm at the worst VcL of each time constant, by time constant in s. They come from small
/// disturbances of steady sliding.
fn slopes_by_disturbance() -> Result<Vec<(f64, f64)>, BoxError> {
    let mut slopes = Vec::new();
    for &(memory, limit) in boundary::worst_limits()? {
        if let Some(velocity) = disturbance_boundary(&[("Tc", memory), ("VcL", limit)], limit)? {
            slopes.push((memory, FallingFriction::simulated(limit).slope(velocity)? / N_S_PER_MM));
        }
    }
    Ok(slopes)
}

/// The slopes at which oscillation of the circuit ends, by time constant. They come from ramps and from small
/// disturbances, and are compared with the thesis's law and with Routh-Hurwitz.
pub(super) struct CircuitSlopes {
    /// Slopes by time constant, and exponents by rate.
    pub pictures: Vec<Picture>,
    /// The fitted laws, in one line.
    pub reading: String,
    /// The fitted laws, by rate and threshold.
    pub table: NumberTable,
    /// The sweep at the thesis's rate.
    pub sweep: SweepCommand,
}

/// Runs the ramps and the disturbances and fits the laws. It takes more than a minute.
pub(super) fn circuit_slopes() -> Result<CircuitSlopes, BoxError> {
    let ramps: Vec<Vec<Slopes>> =
        RATES.iter().map(|rate| boundary::slopes_at_rate(*rate, &THRESHOLDS)).collect::<Result<_, _>>()?;
    let disturbed = slopes_by_disturbance()?;
    let theory: Vec<_> = geomspace(0.006, 0.025, 40)
        .map(|memory| {
            Ok::<_, BoxError>((memory, DrivenTable::simulated(memory).critical_slope()? / N_S_PER_MM))
        })
        .collect::<Result<_, _>>()?;
    let (theory_law, disturbed_law) = (PowerLaw::fit(&theory)?, PowerLaw::fit(&disturbed)?);
    let mut table = NumberTable::new(
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
            row(ramp_name(*rate), (threshold / MM_PER_S).to_string(), law, points.len().to_string());
        }
    }
    row("small disturbances".to_owned(), "none".to_owned(), &disturbed_law, disturbed.len().to_string());
    row("Routh-Hurwitz".to_owned(), "none".to_owned(), &theory_law, "law".to_owned());
    row("the thesis, eq 1-9".to_owned(), "not stated".to_owned(), &SLOPE_BY_MEMORY, "law".to_owned());
    let laws = ramps.iter().zip(RATES).map(|(laws, rate)| {
        format!("{:.2e} Tc^{:.2} by ramps of {} mm/s2", laws[0].1.factor, laws[0].1.exponent, rate / MM_PER_S)
    });
    let reading = format!(
        "runs of the circuit give {}, and {:.2e} Tc^{:.2} by small disturbances; Routh-Hurwitz gives {:.2e} \
         Tc^{:.2}; with a slower ramp oscillation ends nearer to the stability boundary",
        laws.collect::<Vec<_>>().join(", "),
        disturbed_law.factor,
        disturbed_law.exponent,
        theory_law.factor,
        theory_law.exponent
    );
    let pictures =
        vec![slope_picture(&ramps, disturbed, theory), exponent_picture(&ramps, theory_law.exponent)];
    let vary = vec![("Tc", comma_separated(&MEMORIES)), ("VcL", comma_separated(&boundary::limits()))];
    let sweep = SweepCommand { which: "", recipe: boundary::ramp(RATE), vary, measure: "critical_velocity" };
    Ok(CircuitSlopes { pictures, reading, table, sweep })
}

/// Formats the name of a ramp by its rate in m/s2.
fn ramp_name(rate: f64) -> String {
    format!("ramp of {} mm/s2", rate / MM_PER_S)
}

/// Makes the picture of slopes by time constant, with ramps at the usual threshold.
fn slope_picture(ramps: &[Vec<Slopes>], disturbed: Vec<(f64, f64)>, theory: Vec<(f64, f64)>) -> Picture {
    let in_ms = |points: Vec<(f64, f64)>| points.into_iter().map(|(x, y)| (x / MS, y)).collect::<Vec<_>>();
    let thesis = geomspace(0.006, 0.025, 40).map(|memory| (memory / MS, SLOPE_BY_MEMORY.at(memory)));
    let mut graph = Graph::new("(b) the circuit, run", ("time constant Tc", "ms"), ("slope Cn", "N s/mm"))
        .logarithmic(true, true)
        .x_range(5.0, 30.0)
        .y_range(20.0, 500.0)
        .line("thesis's simulation: 7.5e4 Tc^1.54 (1-9)", thesis.collect())
        .line("Routh-Hurwitz (32-9)", in_ms(theory));
    // The fastest ramp is only in picture (c), because there are not enough colours here.
    for (rate, laws) in RATES.iter().zip(ramps).skip(1) {
        graph = graph.dots(ramp_name(*rate), in_ms(laws[0].0.clone()));
    }
    graph.dots("small disturbances at constant speed", in_ms(disturbed)).picture()
}

/// Makes the picture of exponents by the rate of the command, for each threshold.
fn exponent_picture(ramps: &[Vec<Slopes>], theory: f64) -> Picture {
    let title = "(c) exponent of Cn against Tc";
    let mut graph = Graph::new(title, ("rate of the command", "mm/s2"), ("exponent", ""))
        .logarithmic(true, false)
        .y_range(0.6, 1.8);
    for (index, threshold) in THRESHOLDS.iter().enumerate() {
        let points = RATES.iter().zip(ramps).map(|(rate, laws)| (rate / MM_PER_S, laws[index].1.exponent));
        graph = graph.line(format!("swings above {} mm/s", threshold / MM_PER_S), points.collect());
    }
    let ends = |value: f64| vec![(RATES[RATES.len() - 1] / MM_PER_S, value), (RATES[0] / MM_PER_S, value)];
    graph.line("the thesis", ends(SLOPE_BY_MEMORY.exponent)).line("Routh-Hurwitz", ends(theory)).picture()
}

/// A velocity in m/s that is compared with a measured critical velocity of T9-2, with its name. The function returns
/// `None` if there is no such velocity.
type Comparison = (&'static str, fn(&MeasurementComparison) -> Option<f64>);

/// The velocities that are compared with each measurement.
const COMPARISONS: [Comparison; 4] = [
    ("equation (18-9)", |row| row.equation.clone().ok()),
    ("Routh-Hurwitz", |row| row.stability.clone().ok().filter(|velocity| *velocity > 0.0)),
    ("run, command rising", |row| row.run.rising.ok()),
    ("run, command falling", |row| row.run.falling.ok()),
];

/// Table T9-2: measured critical velocities, with equation, stability criterion and runs.
fn measured(_: &Figure) -> Result<DrawnFigure, BoxError> {
    // One thread, because other figures are drawn at the same time on the other threads.
    let compared = table_9_2(&Settings { threads: 1, ..Settings::default() })?;
    let drives: Vec<&[MeasurementComparison]> =
        compared.chunk_by(|one, next| one.cell.stiffness == next.cell.stiffness).collect();
    let pictures = drives.iter().map(|cells| measured_picture(cells)).collect();
    let shares: Vec<_> = drives.iter().map(|cells| format_run_shares(cells)).collect();
    let reading = format!(
        "with a rising command, runs of the circuit give {} of the measured value",
        shares.join(", ")
    );
    let settings = "the measurements are lost except for the Tc of T9-2, from which eq 15-9 is inverted; 450 kgf, Fs \
         = 1249 N, f = 10.7 N s/mm, VcL and Tc by the oil (eqs 11-9, 17-9)";
    let drawn = DrawnFigure::from_theory(pictures, settings, reading);
    let command = "patchcord slideway --oil 0.34 --weight 450 --stiffness 27.6";
    Ok(DrawnFigure { commands: vec![format!("{command}, and similar commands: docs/slideway.md")], ..drawn })
}

/// Returns the stiffness of the drive in kN/mm. `cells` is not empty.
fn in_kn_per_mm(cells: &[MeasurementComparison]) -> f64 {
    cells[0].cell.stiffness / N_PER_MM / 1e3
}

/// Makes the picture of the cells of one drive, by viscosity.
fn measured_picture(cells: &[MeasurementComparison]) -> Picture {
    let points = |value: fn(&MeasurementComparison) -> Option<f64>| -> Vec<(f64, f64)> {
        let point = |row: &MeasurementComparison| Some((row.cell.viscosity / POISE, value(row)? / MM_PER_S));
        cells.iter().filter_map(point).collect()
    };
    let title = format!("{} kN/mm", in_kn_per_mm(cells));
    let mut graph = Graph::new(&title, ("viscosity", "P"), ("Vc", "mm/s"))
        .x_range(0.0, 0.7)
        .dots("measured, from T9-2 (eq 15-9 inverted)", points(|row| Some(row.measured)));
    for (name, value) in COMPARISONS {
        let points = points(value);
        if !points.is_empty() {
            graph = graph.line(name, points);
        }
    }
    graph.picture()
}

/// Formats the range of run velocity divided by measured velocity: "0.84 ... 0.97 at 27.6 kN/mm".
fn format_run_shares(cells: &[MeasurementComparison]) -> String {
    let shares = cells.iter().filter_map(|row| Some(row.run.rising.ok()? / row.measured));
    let (min, max) = min_max(shares);
    format!("{min:.2} ... {max:.2} at {} kN/mm", in_kn_per_mm(cells))
}
