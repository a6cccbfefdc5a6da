//! The statements of the study that the ideal circuit contradicts: the size of each difference, and what it depends
//! on.
//!
//! Each figure runs circuits under all combinations of rate, noise and threshold. It prints a table of all numbers,
//! and curves at one noise and one threshold.

use super::{DrawnFigure, Figure, Graph, Recipe, SweepCommand, comma_separated};
use crate::replay::boundary::{self, RATE};
use crate::replay::conditions::{
    Condition, ConditionReading, FALLING, RISING, ReadDirection, ReadNumber, ReadingConditions,
    format_changes, read_number,
};
use crate::replay::number_table::NumberTable;
use crate::replay::recipe::BoxError;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::simulated::SLOPE_BY_STIFFNESS;
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{MM_PER_S, N_PER_MM, N_S_PER_MM};
use patchcord_analysis::instruments::{Criterion, CriticalVelocity, NoCriticalVelocity};
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
        id: "difference-2",
        place: "9.2, eq 5-9",
        title: "claim that the slope at which oscillation ends is proportional to K^0.077",
        claims: &["9-009"],
        draw: by_stiffness,
    },
    Figure {
        id: "difference-3",
        place: "8.3",
        title: "claim that a lag behind the multiplier does not affect the results at all",
        claims: &["8-105.a", "8-105.b", "8-105.c", "8-105.d"],
        draw: lag_behind,
    },
    Figure {
        id: "difference-4",
        place: "9.4 (ii), 3)",
        title: "claim that half the stiffness makes the swing larger by about 50 %",
        claims: &["9-237.1", "9-237.5", "9-237.20", "9-235.a", "9-235.b"],
        draw: half_the_stiffness,
    },
];

/// The explanation of figure D1.
const LARGE_SWING_REASON: &str = "Small motions grow below the velocity of minimum friction and decay above it, at \
     any rate of the command. A falling command therefore starts oscillation near that velocity; it starts later if \
     there is less to grow from. A large oscillation behaves differently. In every cycle its velocity is below that \
     of minimum friction for some time, where falling friction supplies energy. It therefore persists at commands at \
     which steady sliding is stable too. The range of such commands is larger if VcL is smaller in relation to the \
     swing. With a slower ramp oscillation ends nearer to VcL, but not at VcL.";
/// The explanation of figure D2.
const STIFFNESS_REASON: &str = "By Routh-Hurwitz the part of the slope above f is proportional to K. The whole slope \
     includes f, which does not depend on K, so its exponent is below 1. Ramps add their overrun, which is larger \
     for soft drives. None of the conditions varied here makes the slope nearly independent of K. Without noise and \
     with the stiffest of these drives, there is nothing from which oscillation could grow as the command falls.";
/// The explanation of figure D3.
const LAG_PLACE_REASON: &str = "The place of the lag does not affect small motions, because only the slope of the \
     square matters for them. It affects large motions: the square of a delayed velocity differs from the delayed \
     square. The place of the lag therefore changes the rising critical velocity if swings are large in relation to \
     VcL. As the command falls, oscillation grows from any remaining motion. Without noise that is the rest of the \
     first swings, which differs between the circuits by chance. With noise the place of the lag changes the number \
     by a few percent at most.";
/// The explanation of figure D4.
const SQUARE_ROOT_REASON: &str = "Amplitudes of velocity are proportional to 1/sqrt(K) in the describing function, \
     in Table T9-6 and in the run. The root of 2 is an increase of 41 %, which the text calls \"about 50 %\". \
     The swings themselves are a fifth of those in the table, because the slope of friction in the circuit is not \
     constant.";

/// Levels of noise that are run, rms in m/s.
const NOISES: &[f64] = &[0.0, 2e-7, PLOTTED_NOISE, 2e-5];
/// The noise of the plotted curves, rms in m/s. It is below a hundredth of the usual threshold, so it does not count
/// as oscillation.
const PLOTTED_NOISE: f64 = 2e-6;
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
fn ends(readings: &[ConditionReading], (_, number): ReadDirection) -> (f64, f64) {
    let numbers = readings.iter().filter_map(|reading| number(reading).ok());
    numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), number| {
        (least.min(number), most.max(number))
    })
}

/// Makes the graph of curves by the rate of the command: one per case and direction, and a level line at the number
/// `stated` in the text.
fn curves(
    title: &str,
    quantity: (&str, &str),
    readings: &[ConditionReading],
    directions: &[ReadDirection],
    stated: f64,
) -> Graph {
    let rates = || readings.iter().map(|reading| reading.condition.rate / MM_PER_S);
    let (slowest, fastest) = (rates().fold(f64::INFINITY, f64::min), rates().fold(0.0, f64::max));
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
fn with_table(
    figure: &Figure,
    sweeps: &[SweepCommand],
    pictures: Vec<Picture>,
    reading: String,
    table: NumberTable,
) -> Result<DrawnFigure, BoxError> {
    Ok(DrawnFigure { table: Some(table), ..DrawnFigure::from_sweeps(figure, sweeps, pictures, reading)? })
}

/// Makes the sweep of critical velocities by some parameters, at the study's rate and with the plotted noise.
/// `highest` is the command at which the profile turns back, in m/s.
fn critical_velocities(
    which: &'static str,
    recipe: Recipe,
    highest: f64,
    vary: Vec<(&'static str, String)>,
) -> SweepCommand {
    let recipe = recipe.triangle_command(highest, RATE).command_noise(PLOTTED_NOISE);
    SweepCommand { which, recipe, vary, measure: "critical_velocity" }
}

/// The conditions of figure D1.
const BY_RATE: ReadingConditions =
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

/// Stiffnesses in N/m at which the circuit oscillates within the machine range.
const STIFFNESSES: [f64; 4] = [10e6, 12.5e6, 15e6, 20e6];

/// The conditions of figure D2.
const BY_STIFFNESS: ReadingConditions = ReadingConditions { rates: &[2.4e-3, RATE, 0.3e-3], ..BY_RATE };

/// Figure D2: the exponent of the slope at which oscillation ends, by stiffness.
fn by_stiffness(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let rows: Vec<_> = STIFFNESSES.iter().map(|stiffness| vec![*stiffness]).collect();
    let found = BY_STIFFNESS.profiles(&boundary::stiffness_test_circuit(), 30e-3, &["K"], &rows)?;
    let exponent = |of: fn(&CriticalVelocity) -> Result<f64, NoCriticalVelocity>,
                    critical: &[CriticalVelocity]| {
        let velocities =
            critical.iter().map(|critical| read_number(of(critical))).collect::<Result<Vec<_>, _>>()?;
        let velocities = match velocities.into_iter().collect::<Result<Vec<_>, _>>() {
            Ok(velocities) => velocities,
            Err(none) => return Ok::<ReadNumber, BoxError>(Err(none)),
        };
        let points: Vec<_> = STIFFNESSES.into_iter().zip(velocities).collect();
        Ok(Ok(boundary::slopes_by_stiffness(&points)?.1.exponent))
    };
    let mut readings = Vec::new();
    for (condition, critical) in found {
        let rising = exponent(|critical| critical.rising, &critical)?;
        let falling = exponent(|critical| critical.falling, &critical)?;
        readings.push(ConditionReading { case: "run".to_owned(), condition, rising, falling });
    }
    let theory = STIFFNESSES.map(|stiffness| {
        let table = DrivenTable { stiffness, ..DrivenTable::simulated(0.0071) };
        Ok::<_, BoxError>((stiffness / N_PER_MM, table.critical_slope()? / N_S_PER_MM))
    });
    let theory = PowerLaw::fit(&theory.into_iter().collect::<Result<Vec<_>, _>>()?)?.exponent;
    let (least, most) = ends(&readings, RISING);
    let (least_falling, most_falling) = ends(&readings, FALLING);
    let reading = format!(
        "the exponent is {least:.2} ... {most:.2} rising and {least_falling:.2} ... {most_falling:.2} falling, where \
         the text has {} and Routh-Hurwitz {theory:.2}; it changes as follows: {}",
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
    let ends = |value| [2, 0].map(|rate: usize| (BY_STIFFNESS.rates[rate] / MM_PER_S, value)).to_vec();
    let graph = graph.line("Routh-Hurwitz", ends(theory)).y_range(0.0, 1.2);
    let stiffnesses = vec![("K", comma_separated(&STIFFNESSES))];
    let sweep = critical_velocities("", boundary::stiffness_test_circuit(), 30e-3, stiffnesses);
    with_table(figure, &[sweep], vec![graph.picture()], reading, table)
}

/// Settings at which the place of the lag is compared: VcL in m/s and Tc in s.
const LAGS: [(f64, f64); 4] = [(1.27e-3, 0.0065), (2.54e-3, 0.0065), (2.54e-3, 0.0125), (10.16e-3, 0.0065)];

/// The conditions of figure D3.
const BY_PLACE: ReadingConditions = ReadingConditions { rates: &[2.4e-3, RATE, 0.3e-3], ..BY_RATE };

/// Figure D3: change of the critical velocity in percent if the lag is behind the multiplier instead of before it.
///
/// Cases in which a circuit does not oscillate, or still oscillates at the turn, have the reason instead of a number.
fn lag_behind(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let rows: Vec<_> = LAGS.iter().map(|(limit, memory)| vec![*limit, *memory]).collect();
    let found = |circuit| BY_PLACE.profiles(&Recipe::new(circuit), 10.16e-3, &["VcL", "Tc"], &rows);
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
    let table = BY_PLACE.table(LAG_PLACE_REASON, ("settings", "%"), &readings, 1);
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
        let settings = settings.map(|value| ((value * 1e6).round() / 1e6).to_string());
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
    let (least, most) = found
        .iter()
        .map(SwingPair::increase)
        .fold((f64::INFINITY, 0.0_f64), |(least, most), by| (least.min(by), most.max(by)));
    let reading = format!(
        "over all commands, f and noise levels the swing is larger by {least:.1} ... {most:.1} %; the root of 2 is \
         an increase of {root:.1} %, and amplitudes are proportional to 1/sqrt(K)"
    );
    let vary = vec![("K", comma_separated(&STIFF_AND_SOFT)), ("v_start", comma_separated(&COMMANDS))];
    let recipe = without_lag_at(DAMPINGS[0], 0.0);
    let sweep = SweepCommand { which: "", recipe, vary, measure: "amplitude:v_o,last=1" };
    with_table(figure, &[sweep], vec![graph.picture()], reading, table)
}
