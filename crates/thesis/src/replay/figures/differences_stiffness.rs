//! Differences from the thesis that concern the stiffness of the drive: figures D2 and D4.

use super::differences::{BY_RATE, PLOTTED_NOISE, critical_velocities, curves, ends, with_table};
use super::{DrawnFigure, Figure, Graph, Recipe, SweepCommand, comma_separated};
use crate::replay::boundary::{self, RATE};
use crate::replay::conditions::{
    Condition, ConditionReading, FALLING, RISING, ReadNumber, ReadingConditions, format_changes, read_number,
};
use crate::replay::number_table::NumberTable;
use crate::replay::recipe::BoxError;
use crate::replay::series::min_max;
use crate::slideway::simulated::SLOPE_BY_STIFFNESS;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{MM_PER_S, N_S_PER_MM};
use patchcord_analysis::instruments::{CriticalVelocity, CriticalVelocityError};
use patchcord_expr::format_decimals;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "difference-2",
        place: "9.2, eq 5-9",
        title: "claim that the slope at which oscillation ends is proportional to K^0.077",
        claims: &["9-009"],
        draw: by_stiffness,
    },
    Figure {
        id: "difference-4",
        place: "9.4 (ii), 3)",
        title: "claim that half the stiffness makes the swing larger by about 50 %",
        claims: &["9-237.1", "9-237.5", "9-237.20", "9-235.a", "9-235.b"],
        draw: half_the_stiffness,
    },
];

/// The explanation of figure D2.
const STIFFNESS_REASON: &str = "By Routh-Hurwitz the part of the slope above f is proportional to K. The whole slope \
     includes f, which does not depend on K, so its exponent is below 1. Ramps add their overrun, which is larger \
     for soft drives. None of the conditions varied here makes the slope nearly independent of K. Without noise and \
     with the stiffest of these drives, there is nothing from which oscillation could grow as the command falls.";

/// The explanation of figure D4.
const SQUARE_ROOT_REASON: &str = "Amplitudes of velocity are proportional to 1/sqrt(K) in the describing function, \
     in Table T9-6 and in the run. The root of 2 is an increase of 41 %, which the text calls \"about 50 %\". \
     The swings themselves are a fifth of those in the table, because the slope of friction in the circuit is not \
     constant.";

/// Stiffnesses in N/m at which the circuit oscillates within the machine range.
const STIFFNESSES: [f64; 4] = [10e6, 12.5e6, 15e6, 20e6];

/// The conditions of figure D2.
const BY_STIFFNESS: ReadingConditions = ReadingConditions { rates: &[2.4e-3, RATE, 0.3e-3], ..BY_RATE };

/// Returns the exponent of the slope at which oscillation ends against stiffness. `velocities` holds the critical
/// velocities at [`STIFFNESSES`], in m/s. The result is the first reason why one is missing, if there is one.
///
/// # Errors
/// If a run is not a velocity profile, or the exponent cannot be fitted.
fn exponent(
    velocities: impl Iterator<Item = Result<f64, CriticalVelocityError>>,
) -> Result<ReadNumber, BoxError> {
    let velocities = velocities.map(read_number).collect::<Result<Vec<_>, _>>()?;
    let velocities: Vec<f64> = match velocities.into_iter().collect::<Result<_, _>>() {
        Ok(velocities) => velocities,
        Err(none) => return Ok(Err(none)),
    };
    let points: Vec<_> = STIFFNESSES.into_iter().zip(velocities).collect();
    Ok(Ok(boundary::slopes_by_stiffness(&points)?.1.exponent))
}

/// Reads the exponents under all conditions.
fn exponents() -> Result<Vec<ConditionReading>, BoxError> {
    let rows: Vec<_> = STIFFNESSES.iter().map(|stiffness| vec![*stiffness]).collect();
    let found = BY_STIFFNESS.profiles(&boundary::stiffness_test_circuit(), 30e-3, &["K"], &rows)?;
    let reading = |(condition, critical): (Condition, Vec<CriticalVelocity>)| {
        let rising = exponent(critical.iter().map(|critical| critical.rising))?;
        let falling = exponent(critical.iter().map(|critical| critical.falling))?;
        Ok::<_, BoxError>(ConditionReading { case: "run".to_owned(), condition, rising, falling })
    };
    found.into_iter().map(reading).collect()
}

/// Figure D2: the exponent of the slope at which oscillation ends, by stiffness.
fn by_stiffness(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let readings = exponents()?;
    let theory = DrivenTable::simulated(0.0071).slope_by_stiffness(&STIFFNESSES)?.exponent;
    let (min, max) = ends(&readings, RISING);
    let (min_falling, max_falling) = ends(&readings, FALLING);
    let reading = format!(
        "the exponent is {min:.2} ... {max:.2} rising and {min_falling:.2} ... {max_falling:.2} falling, where the \
         text has {} and Routh-Hurwitz {theory:.2}; it changes as follows: {}",
        SLOPE_BY_STIFFNESS.exponent,
        format_changes(&readings, 2, None)
    );
    let table = BY_STIFFNESS.table(STIFFNESS_REASON, ("circuit", "exponent"), &readings, 3);
    let graph = curves(
        "exponent of Cn against K",
        ("exponent", ""),
        &readings,
        &[RISING, FALLING],
        SLOPE_BY_STIFFNESS.exponent,
    );
    let level = |value| [2, 0].map(|rate: usize| (BY_STIFFNESS.rates[rate] / MM_PER_S, value)).to_vec();
    let graph = graph.line("Routh-Hurwitz", level(theory)).y_range(0.0, 1.2);
    let stiffnesses = vec![("K", comma_separated(&STIFFNESSES))];
    let sweep = critical_velocities("", boundary::stiffness_test_circuit(), 30e-3, stiffnesses);
    with_table(figure, &[sweep], vec![graph.picture()], reading, table)
}

/// Constant commands at which the swing is read, in m/s. The highest is that of T9-6 at E/a = 20.
const COMMANDS: [f64; 4] = [5e-3, 10e-3, 15e-3, 19.1e-3];

/// Viscous friction in N s/m: that of T9-6, and half of it.
const DAMPINGS: [f64; 2] = [10.7e3, 5.35e3];

/// Stiffnesses of T9-6, in N/m.
const STIFF_AND_SOFT: [f64; 2] = [45e6, 22.5e6];

/// Swings with both stiffnesses under the same conditions.
struct SwingPair {
    /// Viscous friction, in N s/m.
    damping: f64,
    /// Noise on the command, rms in m/s.
    noise: f64,
    /// Constant command, in m/s.
    command: f64,
    /// Swings peak to peak in mm/s, stiff drive first.
    swings: [f64; 2],
}

impl SwingPair {
    /// Returns by how much the swing of the soft drive is larger, in percent.
    fn increase(&self) -> f64 {
        100.0 * (self.swings[1] / self.swings[0] - 1.0)
    }

    /// Formats a row of the table.
    fn cells(&self) -> Vec<String> {
        let settings = [self.damping / N_S_PER_MM, self.command / MM_PER_S, self.noise / MM_PER_S];
        let settings = settings.map(|value| format_decimals(value, 6));
        let [stiff, soft] = self.swings.map(|swing| format!("{swing:.2}"));
        settings.into_iter().chain([stiff, soft, format!("{:.1}", self.increase())]).collect()
    }
}

/// Makes the circuit without lag at a constant command, with a duration of 4 s. Its scales are doubled, because its
/// swings exceed the machine range.
fn without_lag_at(damping: f64, noise: f64) -> Recipe {
    let recipe = Recipe::new("fig-8-14").set("VcL", 40e-3).set("f", damping).steady_command(COMMANDS[0]);
    recipe.command_noise(noise).scale_by(2.0).run_time(4.0).sample_interval(2e-4)
}

/// Reads the swings of the circuit without lag at constant commands.
fn swing_pairs() -> Result<Vec<SwingPair>, BoxError> {
    let mut found = Vec::new();
    for damping in DAMPINGS {
        for noise in [0.0, PLOTTED_NOISE] {
            let recipe = without_lag_at(damping, noise).record(&["v_o"]);
            for command in COMMANDS {
                let rows = STIFF_AND_SOFT.map(|stiffness| vec![command, stiffness]);
                let swings = recipe.run_rows(&["v_start", "K"], &rows, |run| {
                    Ok(2.0 * run.measure("amplitude:v_o,last=1")? / MM_PER_S)
                })?;
                found.push(SwingPair { damping, noise, command, swings: [swings[0], swings[1]] });
            }
        }
    }
    Ok(found)
}

/// Figure D4: increase of the swing at half the stiffness.
fn half_the_stiffness(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let found = swing_pairs()?;
    let mut table = NumberTable::new(
        SQUARE_ROOT_REASON,
        [
            "f, N s/mm",
            "command, mm/s",
            "noise, mm/s rms",
            "swing at 45 kN/mm, mm/s",
            "at 22.5 kN/mm, mm/s",
            "larger by, %",
        ],
    );
    table.rows.extend(found.iter().map(SwingPair::cells));
    let mut graph = Graph::new("swing at half the stiffness", ("command", "mm/s"), ("larger by", "%"))
        .x_range(0.0, 20.0)
        .y_range(0.0, 60.0);
    for damping in DAMPINGS {
        let points = found.iter().filter(|row| row.damping == damping && row.noise == PLOTTED_NOISE);
        let points = points.map(|row| (row.command / MM_PER_S, row.increase())).collect();
        graph = graph.dots(format!("run without lag, f = {} N s/mm", damping / N_S_PER_MM), points);
    }
    let root = 100.0 * (2.0_f64.sqrt() - 1.0);
    let graph = graph
        .line("the text", vec![(0.0, 50.0), (20.0, 50.0)])
        .line("root of 2", vec![(0.0, root), (20.0, root)]);
    let (min, max) = min_max(found.iter().map(SwingPair::increase));
    let reading = format!(
        "over all commands, f and noise levels the swing is larger by {min:.1} ... {max:.1} %; the root of 2 is \
         an increase of {root:.1} %, and amplitudes are proportional to 1/sqrt(K)"
    );
    let vary = vec![("K", comma_separated(&STIFF_AND_SOFT)), ("v_start", comma_separated(&COMMANDS))];
    let recipe = without_lag_at(DAMPINGS[0], 0.0);
    let sweep = SweepCommand { which: "", recipe, vary, measure: "amplitude:v_o,last=1" };
    with_table(figure, &[sweep], vec![graph.picture()], reading, table)
}
