//! The statements of the thesis that the ideal circuit contradicts: the size of each difference, and what it depends
//! on.
//!
//! Each figure runs circuits under all combinations of rate, noise and threshold. It prints a table of all numbers,
//! and curves at one noise and one threshold.

use super::{DrawnFigure, Figure, Graph, Recipe, SweepCommand, comma_separated};
use crate::replay::boundary::RATE;
use crate::replay::conditions::{
    Condition, ConditionReading, FALLING, RISING, ReadDirection, ReadNumber, ReadingConditions,
    format_changes, read_number,
};
use crate::replay::number_table::NumberTable;
use crate::replay::recipe::BoxError;
use crate::replay::series::min_max;
use crate::slideway::units::MM_PER_S;
use patchcord_analysis::instruments::Criterion;
use patchcord_draw::plot::Picture;

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "difference-1",
        place: "8.2, 8.4",
        title: "claim that without lag oscillation ends at VcL",
        claims: &["8-079.a", "8-079.b", "8-127.a", "8-127.b", "8-127.c"],
        draw: without_lag,
    },
    Figure {
        id: "difference-3",
        place: "8.3",
        title: "claim that a lag behind the multiplier does not affect the results at all",
        claims: &["8-105.a", "8-105.b", "8-105.c", "8-105.d"],
        draw: lag_behind,
    },
];

/// The explanation of figure D1.
const LARGE_SWING_REASON: &str = "Small motions grow below the velocity of minimum friction and decay above it, at \
     any rate of the command. A falling command therefore starts oscillation near that velocity; it starts later if \
     there is less to grow from. A large oscillation behaves differently. In every cycle its velocity is below that \
     of minimum friction for some time, where falling friction supplies energy. It therefore persists at commands at \
     which steady sliding is stable too. The range of such commands is larger if VcL is smaller in relation to the \
     swing. With a slower ramp oscillation ends nearer to VcL, but not at VcL.";

/// The explanation of figure D3.
const LAG_PLACE_REASON: &str = "The place of the lag does not affect small motions, because only the slope of the \
     square matters for them. It affects large motions: the square of a delayed velocity differs from the delayed \
     square. The place of the lag therefore changes the rising critical velocity if swings are large in relation to \
     VcL. As the command falls, oscillation grows from any remaining motion. Without noise that is the rest of the \
     first swings, which differs between the circuits by chance. With noise the place of the lag changes the number \
     by a few percent at most.";

/// Levels of noise that are run, rms in m/s.
const NOISES: &[f64] = &[0.0, 2e-7, PLOTTED_NOISE, 2e-5];

/// The noise of the plotted curves, rms in m/s. It is below a hundredth of the usual threshold, so it does not count
/// as oscillation.
pub(super) const PLOTTED_NOISE: f64 = 2e-6;

/// Thresholds in m/s: the usual one, twice and four times that.
const THRESHOLDS: &[f64] = &[0.25e-3, 0.5e-3, 1e-3];

/// Returns rate in mm/s2 and number of one case, at the usual threshold and the plotted noise.
fn by_rate(
    readings: &[ConditionReading],
    case: &str,
    number: fn(&ConditionReading) -> ReadNumber,
) -> Vec<(f64, f64)> {
    let is_drawn = |condition: Condition| {
        condition.noise == PLOTTED_NOISE && condition.threshold == Criterion::USUAL.threshold
    };
    let drawn = readings.iter().filter(|reading| reading.case == case && is_drawn(reading.condition));
    drawn.filter_map(|reading| Some((reading.condition.rate / MM_PER_S, number(reading).ok()?))).collect()
}

/// Returns the smallest and the largest number of some readings.
pub(super) fn ends(readings: &[ConditionReading], (_, number): ReadDirection) -> (f64, f64) {
    let numbers = readings.iter().filter_map(|reading| number(reading).ok());
    min_max(numbers)
}

/// Makes the graph of curves by the rate of the command: one per case and direction, and a level line at the number
/// `stated` in the text.
pub(super) fn curves(
    title: &str,
    quantity: (&str, &str),
    readings: &[ConditionReading],
    directions: &[ReadDirection],
    stated: f64,
) -> Graph {
    let (slowest, fastest) = min_max(readings.iter().map(|reading| reading.condition.rate / MM_PER_S));
    let mut graph = Graph::new(title, ("rate of the command", "mm/s2"), quantity)
        .logarithmic(true, false)
        .note("swings above 0.25 mm/s, noise of 0.002 mm/s rms on the command")
        .line("the text", vec![(slowest, stated), (fastest, stated)]);
    for (direction, number) in directions {
        for case in readings.chunk_by(|one, next| one.case == next.case) {
            let case = &case[0].case;
            graph = graph.line(format!("{case}, {direction}"), by_rate(readings, case, *number));
        }
    }
    graph
}

/// Makes a figure of sweeps with its table. The sweeps show one combination of conditions as commands; the table has
/// all of them.
pub(super) fn with_table(
    figure: &Figure,
    sweeps: &[SweepCommand],
    pictures: Vec<Picture>,
    reading: String,
    table: NumberTable,
) -> Result<DrawnFigure, BoxError> {
    Ok(DrawnFigure { table: Some(table), ..DrawnFigure::from_sweeps(figure, sweeps, pictures, reading)? })
}

/// Makes the sweep of critical velocities by some parameters, at the thesis's rate and with the plotted noise.
/// `highest` is the command at which the profile turns back, in m/s.
pub(super) fn critical_velocities(
    which: &'static str,
    recipe: Recipe,
    highest: f64,
    vary: Vec<(&'static str, String)>,
) -> SweepCommand {
    let recipe = recipe.triangle_command(highest, RATE).command_noise(PLOTTED_NOISE);
    SweepCommand { which, recipe, vary, measure: "critical_velocity" }
}

/// The conditions of figure D1.
pub(super) const BY_RATE: ReadingConditions =
    ReadingConditions { rates: &[2.4e-3, RATE, 0.3e-3, 0.15e-3], noises: NOISES, thresholds: THRESHOLDS };

/// Figure D1: critical velocity by VcL of the circuits without lag, with straight and with square friction.
fn without_lag(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let mut readings = Vec::new();
    for (circuit, friction) in [("fig-8-11", "straight"), ("fig-8-14", "square")] {
        for (limit, highest) in [(2.54e-3, 6e-3), (10.16e-3, 14e-3)] {
            let case = format!("{friction}, VcL = {} mm/s", limit / MM_PER_S);
            let found = BY_RATE.profiles(&Recipe::new(circuit), highest, &["VcL"], &[vec![limit]])?;
            for (condition, critical) in found {
                let share =
                    |velocity| Ok::<_, BoxError>(read_number(velocity)?.map(|velocity| velocity / limit));
                let (rising, falling) = (share(critical[0].rising)?, share(critical[0].falling)?);
                readings.push(ConditionReading { case: case.clone(), condition, rising, falling });
            }
        }
    }
    let per_circuit = readings.len() / 2;
    let ((_, highest), (lowest, _)) = (ends(&readings, RISING), ends(&readings, FALLING));
    let reading = format!(
        "oscillation ends at up to {highest:.2} VcL, and begins again at {lowest:.2} VcL or above; the number \
         changes as follows: {}",
        format_changes(&readings, 2, Some("friction and VcL"))
    );
    let table = BY_RATE.table(LARGE_SWING_REASON, ("friction", "Vc / VcL"), &readings, 3);
    let both = [
        ("(a) straight friction, Fig 8.11", &readings[..per_circuit]),
        ("(b) square friction, Fig 8.14", &readings[per_circuit..]),
    ];
    let pictures = both.map(|(title, readings)| {
        curves(title, ("Vc / VcL", ""), readings, &[RISING, FALLING], 1.0).y_range(0.6, 2.0).picture()
    });
    let sweeps = [("a", "fig-8-11"), ("b", "fig-8-14")].map(|(which, circuit)| {
        let limits = vec![("VcL", comma_separated(&[2.54e-3, 10.16e-3]))];
        critical_velocities(which, Recipe::new(circuit), 14e-3, limits)
    });
    with_table(figure, &sweeps, pictures.to_vec(), reading, table)
}

/// Settings at which the place of the lag is compared: VcL in m/s and Tc in s.
const LAGS: [(f64, f64); 4] = [(1.27e-3, 0.0065), (2.54e-3, 0.0065), (2.54e-3, 0.0125), (10.16e-3, 0.0065)];

/// The conditions of figure D3.
const LAG_CONDITIONS: ReadingConditions = ReadingConditions { rates: &[2.4e-3, RATE, 0.3e-3], ..BY_RATE };

/// Figure D3: change of the critical velocity in percent if the lag is behind the multiplier instead of before it.
///
/// Cases in which a circuit does not oscillate, or still oscillates at the turn, have the reason instead of a number.
fn lag_behind(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let rows: Vec<_> = LAGS.iter().map(|(limit, memory)| vec![*limit, *memory]).collect();
    let found = |circuit| LAG_CONDITIONS.profiles(&Recipe::new(circuit), 10.16e-3, &["VcL", "Tc"], &rows);
    let (first, last) = (found("fig-8-16")?, found("fig-8-16-lag-last")?);
    let percent = |first, last| {
        Ok::<_, BoxError>(match (read_number(first)?, read_number(last)?) {
            (Ok(first), Ok(last)) => Ok(100.0 * (last / first - 1.0)),
            (Err(none), _) | (_, Err(none)) => Err(none),
        })
    };
    let mut readings = Vec::new();
    for (index, (limit, memory)) in LAGS.into_iter().enumerate() {
        let case = format!("VcL = {} mm/s, Tc = {} ms", limit / MM_PER_S, memory * 1e3);
        for ((condition, first), (_, last)) in first.iter().zip(&last) {
            let rising = percent(first[index].rising, last[index].rising)?;
            let falling = percent(first[index].falling, last[index].falling)?;
            readings.push(ConditionReading { case: case.clone(), condition: *condition, rising, falling });
        }
    }
    let ((least, most), (least_falling, most_falling)) = (ends(&readings, RISING), ends(&readings, FALLING));
    let reading = format!(
        "with the lag behind the multiplier, the critical velocity changes by {least:+.1} ... {most:+.1} % with a \
         rising command and by {least_falling:+.1} ... {most_falling:+.1} % with a falling one; the number changes \
         as follows: {}",
        format_changes(&readings, 1, Some("VcL and Tc"))
    );
    let table = LAG_CONDITIONS.table(LAG_PLACE_REASON, ("settings", "%"), &readings, 1);
    let pictures =
        [("(a) command rising", RISING), ("(b) command falling", FALLING)].map(|(title, direction)| {
            curves(title, ("change", "%"), &readings, &[direction], 0.0).y_range(-10.0, 50.0).picture()
        });
    let sweeps = [("a", "fig-8-16"), ("b", "fig-8-16-lag-last")].map(|(which, circuit)| {
        let vary = vec![
            ("VcL", comma_separated(&[1.27e-3, 2.54e-3, 10.16e-3])),
            ("Tc", comma_separated(&[0.0065, 0.0125])),
        ];
        critical_velocities(which, Recipe::new(circuit), 10.16e-3, vary)
    });
    with_table(figure, &sweeps, pictures.to_vec(), reading, table)
}
