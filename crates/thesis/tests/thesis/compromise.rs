//! The dead zone of Fig 8.16 compared with a brake. The numbers of docs/compromise.md are measured here.

use crate::common::pages::{assert_page_contains, assert_part_up_to_date};
use crate::known_problems::runs;
use crate::thesis::circuit_readings;
use crate::velocity_readings::{self, format_fixed, max, min};
use patchcord_core::trace::Trace;

/// Stem of the patch, and its name on the page.
const CIRCUITS: [(&str, &str); 2] = [("thesis/fig-8-16", "dead zone"), ("thesis/fig-8-16-coulomb", "brake")];

/// The page with these tables.
const PAGE: &str = "docs/compromise.md";
/// Interval of the recorded samples in s.
const EVERY: f64 = 2e-4;
/// Samples per millisecond. Swings are read from samples 1 ms apart, as in fig_8_16.rs.
const COARSE: usize = 5;

/// The recorded signals of a run.
struct Record {
    /// Velocity command in m/s.
    command: Vec<f64>,
    /// Output velocity in m/s.
    velocity: Vec<f64>,
    /// Position error in m.
    error: Vec<f64>,
    /// Spring force in N.
    spring: Vec<f64>,
    /// Level of solid friction in N.
    level: Vec<f64>,
}

/// Records a run and keeps the samples from the time `from` on. Panics if an overload lamp lit.
fn record(stem: &str, changes: &[(&str, f64)], duration: f64, from: f64) -> Record {
    let names = ["v_i", "v_o", "x_error", "spring_force", "friction_level"];
    let trace: Trace = runs::record(stem, changes, duration, EVERY, &names);
    assert!(circuit_readings::overloaded_elements(&trace).is_empty(), "{:?}", trace.repetitions);
    let first = trace.time.iter().position(|time| *time >= from).unwrap();
    let [command, velocity, error, spring, level] =
        names.map(|name| trace.values(name).unwrap().split_off(first));
    Record { command, velocity, error, spring, level }
}

/// The last 2 s of 3 s at a steady command.
fn steady(stem: &str, command: f64) -> Record {
    record(stem, &[("v_start", command), ("v_rate", 0.0)], 3.0, 1.0)
}

impl Record {
    /// Number of samples.
    fn rows(&self) -> usize {
        self.velocity.len()
    }

    /// The share of rows for which a condition holds.
    fn share(&self, holds: impl Fn(usize) -> bool) -> f64 {
        (0..self.rows()).filter(|row| holds(*row)).count() as f64 / self.rows() as f64
    }

    /// Whether the spring pulls less than solid friction can hold.
    fn is_held(&self, row: usize) -> bool {
        self.spring[row].abs() < self.level[row]
    }

    /// Rows at which the velocity rises through the command.
    fn slips(&self) -> Vec<usize> {
        velocity_readings::slips(&self.velocity, |row| self.command[row])
    }

    /// Mean frequency of slips in Hz, from the first slip to the last.
    fn slips_per_second(&self) -> f64 {
        velocity_readings::slips_per_second(&self.slips(), EVERY)
    }

    /// The longest backward distance, in m, while the spring pulls less than friction can hold.
    fn backward_distance(&self) -> f64 {
        let mut longest = 0.0f64;
        let mut distance = 0.0;
        for row in 0..self.rows() {
            let back = self.is_held(row) && self.velocity[row] < 0.0;
            distance = if back { distance - self.velocity[row] * EVERY } else { 0.0 };
            longest = longest.max(distance);
        }
        longest
    }

    /// The mean power that solid friction takes from the mass and the mean power that it gives to the mass, in W.
    fn friction_power(&self, solid: impl Fn(&Self, usize) -> f64) -> (f64, f64) {
        let power = (0..self.rows()).map(|row| solid(self, row) * self.velocity[row]);
        let mean = |part: fn(f64) -> f64| power.clone().map(part).sum::<f64>() / self.rows() as f64;
        (mean(|watts| watts.max(0.0)), mean(|watts| (-watts).max(0.0)))
    }

    /// Position errors at which the table stops, in m.
    fn stops(&self) -> Vec<f64> {
        let stops =
            (1..self.rows()).filter(|row| self.velocity[row - 1] != 0.0 && self.velocity[*row] == 0.0);
        stops.map(|row| self.error[row]).collect()
    }
}

/// Solid friction of the dead zone: the part of the spring force that does not reach the mass.
fn dead_zone_friction(record: &Record, row: usize) -> f64 {
    record.spring[row].clamp(-record.level[row], record.level[row])
}

/// Solid friction of the brake.
fn brake_friction(record: &Record, row: usize) -> f64 {
    record.level[row] * record.velocity[row].signum()
}

/// The mean power that the friction of a circuit takes and gives, in W. 0 is the dead zone, 1 the brake.
fn friction_power(circuit: usize, record: &Record) -> (f64, f64) {
    record.friction_power([dead_zone_friction, brake_friction][circuit])
}

/// The mean.
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// A value in units of `per` with a number of decimals.
fn format_value(value: f64, per: f64, decimals: usize) -> String {
    format_fixed(value / per, decimals)
}

/// The steady commands of the first table in m/s.
const COMMANDS: [f64; 5] = [0.2e-3, 0.5e-3, 1e-3, 2e-3, 4e-3];

/// A row of the table of steady commands.
fn steady_row(circuit: usize, command: f64, record: &Record) -> String {
    let (takes, gives) = friction_power(circuit, record);
    let stops = record.stops();
    let cells = [
        format_value(command, 1e-3, 1),
        CIRCUITS[circuit].1.to_owned(),
        format!("{} %", format_value(record.share(|row| record.velocity[row] == 0.0), 1e-2, 0)),
        format_value(record.slips_per_second(), 1.0, 1),
        format!(
            "{} ... {}",
            format_value(min(&record.velocity), 1e-3, 2),
            format_value(max(&record.velocity), 1e-3, 2)
        ),
        format_value(record.backward_distance(), 1e-6, 2),
        format!(
            "{} ... {}",
            format_value(min(&record.error), 1e-6, 1),
            format_value(max(&record.error), 1e-6, 1)
        ),
        format_value(mean(&record.error), 1e-6, 1),
        if stops.is_empty() { "never".to_owned() } else { format_value(mean(&stops), 1e-6, 1) },
        format_value(takes, 1e-3, 0),
        format_value(gives, 1e-3, 0),
    ];
    format!("| {} |\n", cells.join(" | "))
}

/// The table of steady commands, with both circuits per command.
fn steady_table(records: &[[Record; 2]]) -> String {
    let pair = |(command, pair): (&f64, &[Record; 2])| {
        steady_row(0, *command, &pair[0]) + &steady_row(1, *command, &pair[1])
    };
    let rows: String = COMMANDS.iter().zip(records).map(pair).collect();
    format!(
        "| v_i, mm/s | friction by | at rest | slips per s | v_o, mm/s | longest backward distance while held, µm | \
         x_error, µm | mean x_error, µm | x_error at stops, µm | friction takes, mW | friction gives, mW |\n{}\n{rows}",
        "|---".repeat(11) + "|"
    )
}

/// Time of the turn in s: the command rises to 5.04 mm/s at 1.2 mm/s2, and falls again.
const TURN: f64 = 4.2;
/// Thresholds of the swing of velocity, peak to peak in m/s.
const THRESHOLDS: [f64; 3] = [0.1e-3, 0.25e-3, 0.5e-3];

/// A run with a rising and falling command.
struct Profile {
    record: Record,
    /// Peak-to-peak velocity over 40 ms, from each millisecond on, in m/s.
    swing: Vec<f64>,
}

/// The profile of a circuit: 0 is the dead zone, 1 the brake.
fn profile(circuit: usize) -> Profile {
    let record = record(CIRCUITS[circuit].0, &[("v_turn", TURN)], 7.4, 0.0);
    let coarse: Vec<f64> = record.velocity.iter().copied().step_by(COARSE).collect();
    Profile { swing: circuit_readings::swing(&coarse), record }
}

impl Profile {
    /// Index of the turn of the command in ms.
    fn turn(&self) -> usize {
        (TURN * 1e3) as usize
    }

    /// The command in m/s at a time in ms.
    fn command(&self, milliseconds: usize) -> f64 {
        self.record.command[milliseconds * COARSE]
    }

    /// The command at which the last swing above the threshold begins while the command rises, in m/s.
    fn rising(&self, threshold: f64) -> f64 {
        self.command(self.swing[..self.turn()].iter().rposition(|swing| *swing > threshold).unwrap())
    }

    /// The command at which the first swing above the threshold begins while the command falls, in m/s.
    fn falling(&self, threshold: f64) -> f64 {
        let after = self.swing[self.turn()..].iter().position(|swing| *swing > threshold).unwrap();
        self.command(self.turn() + after)
    }

    /// Number of slips while the command rises to the end of oscillation.
    fn slips(&self) -> usize {
        let end = self.rising(0.25e-3);
        let rising = self.turn() * COARSE;
        self.record.slips().iter().filter(|row| **row < rising && self.record.command[**row] < end).count()
    }

    /// Peak-to-peak velocity about the command in the 40 ms after the turn, in m/s.
    fn disturbance(&self) -> f64 {
        let rows = self.turn() * COARSE..(self.turn() + 40) * COARSE;
        let errors: Vec<f64> = rows.map(|row| self.record.velocity[row] - self.record.command[row]).collect();
        max(&errors) - min(&errors)
    }
}

/// The table of the profile.
fn profile_table(profiles: &[Profile; 2]) -> String {
    let mut text = String::from("| | dead zone | brake |\n|---|---|---|\n");
    let mut row = |what: &str, value: &dyn Fn(&Profile) -> String| {
        text += &format!("| {what} | {} | {} |\n", value(&profiles[0]), value(&profiles[1]));
    };
    for threshold in THRESHOLDS {
        let named = format_value(threshold, 1e-3, 2);
        row(&format!("rising, oscillation ends (above {named} mm/s), mm/s"), &|p| {
            format_value(p.rising(threshold), 1e-3, 2)
        });
    }
    for threshold in THRESHOLDS {
        let named = format_value(threshold, 1e-3, 2);
        row(&format!("falling, oscillation begins (above {named} mm/s), mm/s"), &|p| {
            format_value(p.falling(threshold), 1e-3, 2)
        });
    }
    row("disturbance after the turn, mm/s", &|p| format_value(p.disturbance(), 1e-3, 4));
    row("slips while rising", &|p| p.slips().to_string());
    row("most negative velocity, mm/s", &|p| format_value(min(&p.record.velocity), 1e-3, 2));
    text
}

#[test]
fn page_agrees_with_the_measurement() {
    let profiles = [profile(0), profile(1)];
    assert_part_up_to_date(PAGE, "profile", &profile_table(&profiles), "patchcord-thesis");
    let records = COMMANDS.map(|command| CIRCUITS.map(|(stem, _)| steady(stem, command)));
    assert_part_up_to_date(PAGE, "steady", &steady_table(&records), "patchcord-thesis");
    assert_page_contains(PAGE, &[steady_sentences(&records), vec![profile_sentence(&profiles)]].concat());
    for [dead_zone, brake] in &records {
        check_dead_zone(dead_zone);
        check_brake(brake);
    }
    for threshold in [0.1e-3, 0.25e-3] {
        let difference = profiles[0].falling(threshold) - profiles[1].falling(threshold);
        // The tolerance is two samples of the falling command. Without standstill both circuits are the same.
        assert!(difference.abs() < 2.5e-6, "{difference}");
    }
}

/// The difference between two values relative to the second, in percent.
fn percent_difference(one: f64, other: f64) -> String {
    format_value((one / other - 1.0).abs(), 1e-2, 0)
}

/// The sentences of the page that quote the table of steady commands.
fn steady_sentences([slowest, slow, _, fast, fastest]: &[[Record; 2]; 5]) -> Vec<String> {
    let rest_share = |record: &Record| format_value(record.share(|row| record.velocity[row] == 0.0), 1e-2, 0);
    let slips = |record: &Record| format_value(record.slips_per_second(), 1.0, 1);
    let slips_difference =
        |pair: &[Record; 2]| percent_difference(pair[0].slips_per_second(), pair[1].slips_per_second());
    let peak_difference =
        |pair: &[Record; 2]| percent_difference(max(&pair[0].velocity), max(&pair[1].velocity));
    let error = |record: &Record| format_value(mean(&record.error), 1e-6, 1);
    let (takes, gives) = friction_power(0, &slow[0]);
    vec![
        format!(
            "for {} % of the time at 0.2 mm/s and for {} % at 4",
            rest_share(&slowest[1]),
            rest_share(&fastest[1])
        ),
        format!("by up to {} µm at 0.2 mm/s", format_value(slowest[0].backward_distance(), 1e-6, 2)),
        format!("gives back {} of the {} mW", format_value(gives, 1e-3, 0), format_value(takes, 1e-3, 0)),
        format!("{} slips a second instead of {} at 0.2", slips(&slowest[0]), slips(&slowest[1])),
        format!("{} instead of {} at 0.5", slips(&slow[0]), slips(&slow[1])),
        format!("the brake slips every {} ms", format_value(1.0 / slow[1].slips_per_second(), 1e-3, 0)),
        format!("{} µm at 0.5 mm/s, where the brake has {}", error(&slow[0]), error(&slow[1])),
        format!("({} % at 2 mm/s, {} % at 4)", slips_difference(fast), slips_difference(fastest)),
        format!("peaks ({} % and {} %)", peak_difference(fast), peak_difference(fastest)),
    ]
}

/// The sentence of the page that quotes the table of the ramp.
fn profile_sentence(profiles: &[Profile; 2]) -> String {
    let rising = THRESHOLDS.map(|threshold| [0, 1].map(|circuit| profiles[circuit].rising(threshold)));
    let higher = rising.map(|[dead_zone, brake]| brake - dead_zone);
    let share = rising.map(|[dead_zone, brake]| brake / dead_zone - 1.0);
    let [smallest, largest] =
        [min(&higher), max(&higher)].map(|difference| format_value(difference, 1e-3, 2));
    format!("{smallest} or {largest} mm/s ({} %) higher", format_value(mean(&share), 1e-2, 1))
}

/// Asserts that the dead zone has no standstill, that its friction pushes, and that inside it only viscous friction
/// slows the mass.
fn check_dead_zone(record: &Record) {
    assert_eq!(record.share(|row| record.velocity[row] == 0.0), 0.0);
    assert!(friction_power(0, record).1 > 0.02);
    // The factor of the velocity per sample under viscous friction alone.
    let decay = (-10.7e3 / 433.0 * EVERY).exp();
    let inside: Vec<_> =
        (1..record.rows()).filter(|row| record.is_held(row - 1) && record.is_held(*row)).collect();
    for row in &inside {
        let error = record.velocity[*row] - decay * record.velocity[row - 1];
        assert!(error.abs() < 1e-12, "{error} m/s at row {row}");
    }
    assert!(inside.len() > 300, "{}", inside.len());
}

/// Asserts that with the brake the table stops once every slip, and friction never pushes.
fn check_brake(record: &Record) {
    assert!(record.share(|row| record.velocity[row] == 0.0) > 0.03);
    assert!(record.stops().len().abs_diff(record.slips().len()) <= 1);
    assert_eq!(friction_power(1, record).1, 0.0);
}

#[test]
fn both_agree_until_the_spring_enters_the_dead_zone() {
    let [dead_zone, brake] =
        CIRCUITS.map(|(stem, _)| record(stem, &[("v_start", 0.5e-3), ("v_rate", 0.0)], 0.1, 0.0));
    let released = (0..dead_zone.rows()).find(|row| !dead_zone.is_held(*row)).unwrap();
    let caught = (released..dead_zone.rows()).find(|row| dead_zone.is_held(*row)).unwrap();
    let error = runs::difference(&brake.velocity[..caught], &dead_zone.velocity[..caught]);
    assert!(error < 1e-8, "{error:e} of the peak");
    let later = runs::difference(&brake.velocity[..2 * caught], &dead_zone.velocity[..2 * caught]);
    assert!(later > 0.1, "{later:e} of the peak");
    // These numbers are quoted on the page.
    let peak = max(&dead_zone.velocity[..caught]);
    assert_eq!(format_value(peak, 1e-3, 2), "4.03");
    assert_eq!([released, caught].map(|row| format_value(row as f64 * EVERY, 1e-3, 0)), ["34", "47"]);
}
