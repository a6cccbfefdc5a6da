//! The statements that the ideal circuit does not bear out: how large the difference is, and what it depends on.

use super::{Drawn, Figure, Graph, Recipe, Sweep, listed};
use crate::replay::boundary::{self, RATE};
use crate::replay::conditions::{
    Conditions, FALLING, Number, RISING, Reading, Under, Way, moved_told, short,
};
use crate::replay::recipe::Problem;
use crate::replay::table::Table;
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
        title: "the text: without lag oscillation ends at VcL",
        claims: &["8-079.a", "8-079.b", "8-127.a", "8-127.b", "8-127.c"],
        draw: without_lag,
    },
    Figure {
        id: "difference-2",
        place: "9.2, eq 5-9",
        title: "the text: the slope at which oscillation ends goes with K^0.077",
        claims: &["9-009"],
        draw: by_stiffness,
    },
    Figure {
        id: "difference-3",
        place: "8.3",
        title: "the text: a lag behind the multiplier does not affect the results at all",
        claims: &["8-105.a", "8-105.b", "8-105.c", "8-105.d"],
        draw: lag_behind,
    },
    Figure {
        id: "difference-4",
        place: "9.4 (ii), 3)",
        title: "the text: half the stiffness makes the swing larger by about 50 %",
        claims: &["9-237.1", "9-237.5", "9-237.20", "9-235.a", "9-235.b"],
        draw: half_the_stiffness,
    },
];

const LARGE_SWINGS_LIVE_ON: &str = "Small motions grow below the velocity of least friction and die away above it, at any rate: falling commands find it, later the less \
     there is to grow from. A large swing is another matter. It dips below that velocity in every cycle, where falling friction feeds it, \
     and lives on beside steady sliding; the smaller VcL is beside the swing, the further. A slower ramp ends nearer, but not at VcL.";
const ONLY_ABOVE_F: &str = "By Routh-Hurwitz the part of the slope above f goes with K; with f, which does not, it is a power below 1. Ramps add their overrun, which is \
     larger for soft drives. Nothing that was varied here makes the slope nearly independent of K. Without noise a falling command finds nothing to \
     grow oscillation from at the stiffest of these drives.";
const LARGE_ONES_TELL: &str = "Small motions cannot tell where the lag stands: the slope of the square is all they meet. Large ones can: the square of a late velocity is \
     not the late square. So the place of the lag moves the rising critical velocity where swings are large beside VcL. Falling, oscillation grows from \
     whatever there is: without noise that is what the run left of its first swings, which differs between the circuits by chance; with noise the \
     place of the lag moves the number by a few percent at most.";
const AS_THE_ROOT: &str = "Amplitudes of velocity go with 1/sqrt(K), in the describing function, in Table T9-6 and in the run alike; \"about 50 %\" is a generous word for \
     the root of 2. The swings themselves are a fifth of the table's, as the slope of the circuit's friction is not constant.";

/// Noise that is tried, rms in m/s.
const NOISES: &[f64] = &[0.0, 2e-7, DRAWN_NOISE, 2e-5];
/// Curves are drawn with this much, which hides below a hundredth of the usual threshold.
const DRAWN_NOISE: f64 = 2e-6;
/// The usual threshold, twice and four times as much, in m/s.
const THRESHOLDS: &[f64] = &[0.25e-3, 0.5e-3, 1e-3];

/// Rate in mm/s2 and number of the readings of one case at the usual threshold, with noise.
fn by_rate(readings: &[Reading], case: &str, number: fn(&Reading) -> Number) -> Vec<(f64, f64)> {
    let is_drawn = |under: Under| under.noise == DRAWN_NOISE && under.threshold == Criterion::USUAL.threshold;
    let drawn = readings.iter().filter(|reading| reading.case == case && is_drawn(reading.under));
    drawn.filter_map(|reading| Some((reading.under.rate / MM_PER_S, number(reading).ok()?))).collect()
}

/// The least and the largest of some readings.
fn ends(readings: &[Reading], (_, number): Way) -> (f64, f64) {
    let numbers = readings.iter().filter_map(|reading| number(reading).ok());
    numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), number| {
        (least.min(number), most.max(number))
    })
}

/// Curves by the rate of the command, of each case, and what the text says.
fn curves(title: &str, quantity: (&str, &str), readings: &[Reading], ways: &[Way], said: f64) -> Graph {
    let rates = || readings.iter().map(|reading| reading.under.rate / MM_PER_S);
    let (slowest, fastest) = (rates().fold(f64::INFINITY, f64::min), rates().fold(0.0, f64::max));
    let mut graph = Graph::new(title, ("rate of the command", "mm/s2"), quantity)
        .logarithmic(true, false)
        .note("swings above 0.25 mm/s, noise of 0.002 mm/s rms on the command")
        .line("the text", vec![(slowest, said), (fastest, said)]);
    for (way, number) in ways {
        for case in readings.chunk_by(|one, next| one.case == next.case) {
            let case = &case[0].case;
            graph = graph.line(format!("{case}, {way}"), by_rate(readings, case, *number));
        }
    }
    graph
}

/// What sweeps show, with their numbers; one sweep stands for those under other conditions.
fn drawn(
    figure: &Figure,
    sweeps: &[Sweep],
    pictures: Vec<Picture>,
    reading: String,
    table: Table,
) -> Result<Drawn, Problem> {
    Ok(Drawn { table: Some(table), ..Drawn::of_sweeps(figure, sweeps, pictures, reading)? })
}

/// Critical velocities by some parameters at the study's rate, with noise.
fn critical_velocities(
    which: &'static str,
    recipe: Recipe,
    highest: f64,
    vary: Vec<(&'static str, String)>,
) -> Sweep {
    let recipe = recipe.there_and_back(highest, RATE).noisy(DRAWN_NOISE);
    Sweep { which, recipe, vary, measure: "critical_velocity" }
}

const BY_RATE: Conditions =
    Conditions { rates: &[2.4e-3, RATE, 0.3e-3, 0.15e-3], noises: NOISES, thresholds: THRESHOLDS };

fn without_lag(figure: &Figure) -> Result<Drawn, Problem> {
    let mut readings = Vec::new();
    for (circuit, friction) in [("fig-8-11", "straight"), ("fig-8-14", "square")] {
        for (limit, highest) in [(2.54e-3, 6e-3), (10.16e-3, 14e-3)] {
            let case = format!("{friction}, VcL = {} mm/s", limit / MM_PER_S);
            let found = BY_RATE.profiles(&Recipe::of(circuit), highest, &["VcL"], &[vec![limit]])?;
            for (under, critical) in found {
                let share = |velocity| Ok::<_, Problem>(short(velocity)?.map(|velocity| velocity / limit));
                let (rising, falling) = (share(critical[0].rising)?, share(critical[0].falling)?);
                readings.push(Reading { case: case.clone(), under, rising, falling });
            }
        }
    }
    let per_circuit = readings.len() / 2;
    let ((_, highest), (lowest, _)) = (ends(&readings, RISING), ends(&readings, FALLING));
    let reading = format!(
        "oscillation ends at up to {highest:.2} VcL, and begins again from {lowest:.2} VcL on; the number moves {}",
        moved_told(&readings, 2, Some("friction and VcL"))
    );
    let table = BY_RATE.table(LARGE_SWINGS_LIVE_ON, ("friction", "Vc / VcL"), &readings, 3);
    let both = [
        ("(a) straight friction, Fig 8.11", &readings[..per_circuit]),
        ("(b) square friction, Fig 8.14", &readings[per_circuit..]),
    ];
    let pictures = both.map(|(title, readings)| {
        curves(title, ("Vc / VcL", ""), readings, &[RISING, FALLING], 1.0).up(0.6, 2.0).picture()
    });
    let sweeps = [("a", "fig-8-11"), ("b", "fig-8-14")].map(|(which, circuit)| {
        let limits = vec![("VcL", listed(&[2.54e-3, 10.16e-3]))];
        critical_velocities(which, Recipe::of(circuit), 14e-3, limits)
    });
    drawn(figure, &sweeps, pictures.to_vec(), reading, table)
}

/// Stiffnesses in N/m at which the circuit oscillates within the machine.
const STIFFNESSES: [f64; 4] = [10e6, 12.5e6, 15e6, 20e6];

const BY_STIFFNESS: Conditions = Conditions { rates: &[2.4e-3, RATE, 0.3e-3], ..BY_RATE };

fn by_stiffness(figure: &Figure) -> Result<Drawn, Problem> {
    let rows: Vec<_> = STIFFNESSES.iter().map(|stiffness| vec![*stiffness]).collect();
    let found = BY_STIFFNESS.profiles(&boundary::of_other_stiffness(), 30e-3, &["K"], &rows)?;
    let exponent = |of: fn(&CriticalVelocity) -> Result<f64, NoCriticalVelocity>,
                    critical: &[CriticalVelocity]| {
        let velocities =
            critical.iter().map(|critical| short(of(critical))).collect::<Result<Vec<_>, _>>()?;
        let velocities = match velocities.into_iter().collect::<Result<Vec<_>, _>>() {
            Ok(velocities) => velocities,
            Err(none) => return Ok::<Number, Problem>(Err(none)),
        };
        let points: Vec<_> = STIFFNESSES.into_iter().zip(velocities).collect();
        Ok(Ok(boundary::slope_by_stiffness(&points)?.1.exponent))
    };
    let mut readings = Vec::new();
    for (under, critical) in found {
        let rising = exponent(|critical| critical.rising, &critical)?;
        let falling = exponent(|critical| critical.falling, &critical)?;
        readings.push(Reading { case: "run".to_owned(), under, rising, falling });
    }
    let theory = STIFFNESSES.map(|stiffness| {
        let table = DrivenTable { stiffness, ..DrivenTable::simulated(0.0071) };
        Ok::<_, Problem>((stiffness / N_PER_MM, table.critical_slope()? / N_S_PER_MM))
    });
    let theory = PowerLaw::fit(&theory.into_iter().collect::<Result<Vec<_>, _>>()?)?.exponent;
    let (least, most) = ends(&readings, RISING);
    let (least_falling, most_falling) = ends(&readings, FALLING);
    let reading = format!(
        "the exponent is {least:.2} ... {most:.2} rising and {least_falling:.2} ... {most_falling:.2} falling, where the text has \
         {} and Routh-Hurwitz {theory:.2}; it moves {}",
        SLOPE_BY_STIFFNESS.exponent,
        moved_told(&readings, 2, None)
    );
    let table = BY_STIFFNESS.table(ONLY_ABOVE_F, ("circuit", "exponent"), &readings, 3);
    let graph = curves(
        "exponent of Cn against K",
        ("exponent", ""),
        &readings,
        &[RISING, FALLING],
        SLOPE_BY_STIFFNESS.exponent,
    );
    let ends = |value| [2, 0].map(|rate: usize| (BY_STIFFNESS.rates[rate] / MM_PER_S, value)).to_vec();
    let graph = graph.line("Routh-Hurwitz", ends(theory)).up(0.0, 1.2);
    let stiffnesses = vec![("K", listed(&STIFFNESSES))];
    let sweep = critical_velocities("", boundary::of_other_stiffness(), 30e-3, stiffnesses);
    drawn(figure, &[sweep], vec![graph.picture()], reading, table)
}

/// VcL in m/s and Tc in s at which the lag is moved.
const LAGS: [(f64, f64); 4] = [(1.27e-3, 0.0065), (2.54e-3, 0.0065), (2.54e-3, 0.0125), (10.16e-3, 0.0065)];

const BY_PLACE: Conditions = Conditions { rates: &[2.4e-3, RATE, 0.3e-3], ..BY_RATE };

fn lag_behind(figure: &Figure) -> Result<Drawn, Problem> {
    let rows: Vec<_> = LAGS.iter().map(|(limit, memory)| vec![*limit, *memory]).collect();
    let found = |circuit| BY_PLACE.profiles(&Recipe::of(circuit), 10.16e-3, &["VcL", "Tc"], &rows);
    let (first, last) = (found("fig-8-16")?, found("fig-8-16-lag-last")?);
    let percent = |first, last| {
        Ok::<_, Problem>(match (short(first)?, short(last)?) {
            (Ok(first), Ok(last)) => Ok(100.0 * (last / first - 1.0)),
            (Err(none), _) | (_, Err(none)) => Err(none),
        })
    };
    let mut readings = Vec::new();
    for (index, (limit, memory)) in LAGS.into_iter().enumerate() {
        let case = format!("VcL = {} mm/s, Tc = {} ms", limit / MM_PER_S, memory * 1e3);
        for ((under, first), (_, last)) in first.iter().zip(&last) {
            let rising = percent(first[index].rising, last[index].rising)?;
            let falling = percent(first[index].falling, last[index].falling)?;
            readings.push(Reading { case: case.clone(), under: *under, rising, falling });
        }
    }
    let ((least, most), (least_falling, most_falling)) = (ends(&readings, RISING), ends(&readings, FALLING));
    let reading = format!(
        "with the lag behind, oscillation ends at a rising command {least:+.1} ... {most:+.1} % off, and begins at a falling one \
         {least_falling:+.1} ... {most_falling:+.1} % off; the number moves {}",
        moved_told(&readings, 1, Some("VcL and Tc"))
    );
    let table = BY_PLACE.table(LARGE_ONES_TELL, ("settings", "%"), &readings, 1);
    let pictures = [("(a) command rising", RISING), ("(b) command falling", FALLING)]
        .map(|(title, way)| curves(title, ("change", "%"), &readings, &[way], 0.0).up(-10.0, 50.0).picture());
    let sweeps = [("a", "fig-8-16"), ("b", "fig-8-16-lag-last")].map(|(which, circuit)| {
        let vary = vec![("VcL", listed(&[1.27e-3, 2.54e-3, 10.16e-3])), ("Tc", listed(&[0.0065, 0.0125]))];
        critical_velocities(which, Recipe::of(circuit), 10.16e-3, vary)
    });
    drawn(figure, &sweeps, pictures.to_vec(), reading, table)
}

/// Commands in m/s at which the swing is read: up to that of T9-6 at E/a = 20.
const COMMANDS: [f64; 4] = [5e-3, 10e-3, 15e-3, 19.1e-3];
/// Viscous friction in N s/m: that of T9-6, and half of it.
const DAMPINGS: [f64; 2] = [10.7e3, 5.35e3];
/// Stiffnesses in N/m of T9-6.
const STIFF_AND_SOFT: [f64; 2] = [45e6, 22.5e6];

/// Swings peak to peak in mm/s at both stiffnesses and how much larger the second is, in percent.
struct Softer {
    damping: f64,
    noise: f64,
    command: f64,
    swings: [f64; 2],
}

impl Softer {
    fn larger_by(&self) -> f64 {
        100.0 * (self.swings[1] / self.swings[0] - 1.0)
    }

    fn cells(&self) -> Vec<String> {
        let settings = [self.damping / N_S_PER_MM, self.command / MM_PER_S, self.noise / MM_PER_S];
        let settings = settings.map(|value| ((value * 1e6).round() / 1e6).to_string());
        let [stiff, soft] = self.swings.map(|swing| format!("{swing:.2}"));
        settings.into_iter().chain([stiff, soft, format!("{:.1}", self.larger_by())]).collect()
    }
}

/// The circuit without lag at a steady command, four seconds long; scales have room for its swings.
fn without_lag_at(damping: f64, noise: f64) -> Recipe {
    let recipe = Recipe::of("fig-8-14").set("VcL", 40e-3).set("f", damping).steady(COMMANDS[0]);
    recipe.noisy(noise).scaled(2.0).lasting(4.0).every(2e-4)
}

/// Swings of the circuit without lag, at steady commands.
fn softer() -> Result<Vec<Softer>, Problem> {
    let mut found = Vec::new();
    for damping in DAMPINGS {
        for noise in [0.0, DRAWN_NOISE] {
            let recipe = without_lag_at(damping, noise).recording(&["v_o"]);
            for command in COMMANDS {
                let rows = STIFF_AND_SOFT.map(|stiffness| vec![command, stiffness]);
                let swings = recipe.each(&["v_start", "K"], &rows, |run| {
                    Ok(2.0 * run.measure("amplitude:v_o,last=1")? / MM_PER_S)
                })?;
                found.push(Softer { damping, noise, command, swings: [swings[0], swings[1]] });
            }
        }
    }
    Ok(found)
}

fn half_the_stiffness(figure: &Figure) -> Result<Drawn, Problem> {
    let found = softer()?;
    let mut table = Table::new(
        AS_THE_ROOT,
        [
            "f, N s/mm",
            "command, mm/s",
            "noise, mm/s rms",
            "swing at 45 kN/mm, mm/s",
            "at 22.5 kN/mm, mm/s",
            "larger by, %",
        ],
    );
    table.rows.extend(found.iter().map(Softer::cells));
    let mut graph = Graph::new("swing at half the stiffness", ("command", "mm/s"), ("larger by", "%"))
        .across(0.0, 20.0)
        .up(0.0, 60.0);
    for damping in DAMPINGS {
        let points = found.iter().filter(|row| row.damping == damping && row.noise == DRAWN_NOISE);
        let points = points.map(|row| (row.command / MM_PER_S, row.larger_by())).collect();
        graph = graph.dots(format!("run without lag, f = {} N s/mm", damping / N_S_PER_MM), points);
    }
    let root = 100.0 * (2.0_f64.sqrt() - 1.0);
    let graph = graph
        .line("the text", vec![(0.0, 50.0), (20.0, 50.0)])
        .line("root of 2", vec![(0.0, root), (20.0, root)]);
    let (least, most) = found
        .iter()
        .map(Softer::larger_by)
        .fold((f64::INFINITY, 0.0_f64), |(least, most), by| (least.min(by), most.max(by)));
    let reading = format!(
        "the swing is larger by {least:.1} ... {most:.1} % at all commands, f and noise that are tried; the root of 2 is {root:.1} % more, \
         and amplitudes go with 1/sqrt(K)"
    );
    let vary = vec![("K", listed(&STIFF_AND_SOFT)), ("v_start", listed(&COMMANDS))];
    let recipe = without_lag_at(DAMPINGS[0], 0.0);
    let sweep = Sweep { which: "", recipe, vary, measure: "amplitude:v_o,last=1" };
    drawn(figure, &[sweep], vec![graph.picture()], reading, table)
}
