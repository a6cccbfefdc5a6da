//! What the dead zone of Fig 8.16 costs beside a brake: docs/compromise.md, whose numbers are measured here.

use crate::common::pages::{check_part, check_told};
use crate::known::runs;
use crate::thesis::bench;
use patchcord_core::trace::Trace;

/// Stem of the patch, and what the page calls it.
const CIRCUITS: [(&str, &str); 2] = [("thesis/fig-8-16", "dead zone"), ("thesis/fig-8-16-coulomb", "brake")];

const PAGE: &str = "docs/compromise.md";
const EVERY: f64 = 2e-4;
/// Samples in a millisecond: swings are read from samples 1 ms apart, as in fig_8_16.rs.
const COARSE: usize = 5;

/// What a run recorded, column by column.
struct Record {
    command: Vec<f64>,
    velocity: Vec<f64>,
    error: Vec<f64>,
    spring: Vec<f64>,
    level: Vec<f64>,
}

fn record(stem: &str, named: &[(&str, f64)], duration: f64, from: f64) -> Record {
    let names = ["v_i", "v_o", "x_error", "spring_force", "friction_level"];
    let trace: Trace = runs::record(stem, named, duration, EVERY, &names);
    assert!(bench::lit(&trace).is_empty(), "{:?}", trace.sweeps);
    let first = trace.time.iter().position(|time| *time >= from).unwrap();
    let [command, velocity, error, spring, level] =
        names.map(|name| trace.values(name).unwrap().split_off(first));
    Record { command, velocity, error, spring, level }
}

/// A command that stays the same: the last 2 of 3 s.
fn steady(stem: &str, command: f64) -> Record {
    record(stem, &[("v_start", command), ("v_rate", 0.0)], 3.0, 1.0)
}

impl Record {
    fn rows(&self) -> usize {
        self.velocity.len()
    }

    fn share(&self, holds: impl Fn(usize) -> bool) -> f64 {
        (0..self.rows()).filter(|row| holds(*row)).count() as f64 / self.rows() as f64
    }

    /// Whether the spring pulls less than solid friction can hold.
    fn is_held(&self, row: usize) -> bool {
        self.spring[row].abs() < self.level[row]
    }

    /// Rows at which the velocity rises through the command.
    fn slips(&self) -> Vec<usize> {
        let ahead = |row: usize| self.velocity[row] >= self.command[row];
        (1..self.rows()).filter(|row| !ahead(row - 1) && ahead(*row)).collect()
    }

    fn slips_per_second(&self) -> f64 {
        let slips = self.slips();
        (slips.len() - 1) as f64 / ((slips[slips.len() - 1] - slips[0]) as f64 * EVERY)
    }

    /// The longest way back, in m, while the spring pulls less than friction can hold.
    fn way_back(&self) -> f64 {
        let mut longest = 0.0f64;
        let mut way = 0.0;
        for row in 0..self.rows() {
            let back = self.is_held(row) && self.velocity[row] < 0.0;
            way = if back { way - self.velocity[row] * EVERY } else { 0.0 };
            longest = longest.max(way);
        }
        longest
    }

    /// The power that a solid friction takes from the mass, in W, and that which it gives to it.
    fn friction_power(&self, solid: impl Fn(&Self, usize) -> f64) -> (f64, f64) {
        let power = (0..self.rows()).map(|row| solid(self, row) * self.velocity[row]);
        let mean = |part: fn(f64) -> f64| power.clone().map(part).sum::<f64>() / self.rows() as f64;
        (mean(|watts| watts.max(0.0)), mean(|watts| (-watts).max(0.0)))
    }

    /// Position errors at which it comes to stand, in m.
    fn stops(&self) -> Vec<f64> {
        let stops =
            (1..self.rows()).filter(|row| self.velocity[row - 1] != 0.0 && self.velocity[*row] == 0.0);
        stops.map(|row| self.error[row]).collect()
    }
}

/// In the dead zone friction is whatever the spring is: that much of the spring's force never comes to the mass.
fn of_the_dead_zone(record: &Record, row: usize) -> f64 {
    record.spring[row].clamp(-record.level[row], record.level[row])
}

fn of_the_brake(record: &Record, row: usize) -> f64 {
    record.level[row] * record.velocity[row].signum()
}

fn friction_power(circuit: usize, record: &Record) -> (f64, f64) {
    record.friction_power([of_the_dead_zone, of_the_brake][circuit])
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::MAX, f64::min)
}

fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::MIN, f64::max)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// In thousandths or millionths of the unit, without a trace of rounding below what is shown.
fn shown(value: f64, per: f64, digits: usize) -> String {
    let text = format!("{:.digits$}", value / per);
    if text.trim_start_matches('-').bytes().all(|byte| b"0.".contains(&byte)) { "0".to_owned() } else { text }
}

const COMMANDS: [f64; 5] = [0.2e-3, 0.5e-3, 1e-3, 2e-3, 4e-3];

fn steady_row(circuit: usize, command: f64, record: &Record) -> String {
    let (takes, gives) = friction_power(circuit, record);
    let stops = record.stops();
    let cells = [
        shown(command, 1e-3, 1),
        CIRCUITS[circuit].1.to_owned(),
        format!("{} %", shown(record.share(|row| record.velocity[row] == 0.0), 1e-2, 0)),
        shown(record.slips_per_second(), 1.0, 1),
        format!("{} ... {}", shown(least(&record.velocity), 1e-3, 2), shown(most(&record.velocity), 1e-3, 2)),
        shown(record.way_back(), 1e-6, 2),
        format!("{} ... {}", shown(least(&record.error), 1e-6, 1), shown(most(&record.error), 1e-6, 1)),
        shown(mean(&record.error), 1e-6, 1),
        if stops.is_empty() { "never".to_owned() } else { shown(mean(&stops), 1e-6, 1) },
        shown(takes, 1e-3, 0),
        shown(gives, 1e-3, 0),
    ];
    format!("| {} |\n", cells.join(" | "))
}

fn steady_table(records: &[[Record; 2]]) -> String {
    let pair = |(command, pair): (&f64, &[Record; 2])| {
        steady_row(0, *command, &pair[0]) + &steady_row(1, *command, &pair[1])
    };
    let rows: String = COMMANDS.iter().zip(records).map(pair).collect();
    format!(
        "| v_i, mm/s | friction by | stands still | slips per s | v_o, mm/s | longest way back while held, µm | \
         x_error, µm | its mean | where it comes to stand | friction takes, mW | gives, mW |\n{}\n{rows}",
        "|---".repeat(11) + "|"
    )
}

/// Up to 5.04 mm/s at 1.2 mm/s2, and down again.
const TURN: f64 = 4.2;
const THRESHOLDS: [f64; 3] = [0.1e-3, 0.25e-3, 0.5e-3];

struct Profile {
    record: Record,
    /// Peak to peak over 40 ms from each millisecond on.
    swing: Vec<f64>,
}

fn profile(circuit: usize) -> Profile {
    let record = record(CIRCUITS[circuit].0, &[("v_turn", TURN)], 7.4, 0.0);
    let coarse: Vec<f64> = record.velocity.iter().copied().step_by(COARSE).collect();
    Profile { swing: bench::swing(&coarse), record }
}

impl Profile {
    fn turn(&self) -> usize {
        (TURN * 1e3) as usize
    }

    fn command(&self, milliseconds: usize) -> f64 {
        self.record.command[milliseconds * COARSE]
    }

    /// The command at which the last swing above the threshold begins while it rises.
    fn rising(&self, threshold: f64) -> f64 {
        self.command(self.swing[..self.turn()].iter().rposition(|swing| *swing > threshold).unwrap())
    }

    /// The command at which the first one begins while it falls.
    fn falling(&self, threshold: f64) -> f64 {
        let after = self.swing[self.turn()..].iter().position(|swing| *swing > threshold).unwrap();
        self.command(self.turn() + after)
    }

    /// Slips while the command rises to where oscillation ends.
    fn slips(&self) -> usize {
        let end = self.rising(0.25e-3);
        let rising = self.turn() * COARSE;
        self.record.slips().iter().filter(|row| **row < rising && self.record.command[**row] < end).count()
    }

    /// Peak to peak of the velocity about the command in the 40 ms after the turn.
    fn disturbance(&self) -> f64 {
        let rows = self.turn() * COARSE..(self.turn() + 40) * COARSE;
        let about: Vec<f64> = rows.map(|row| self.record.velocity[row] - self.record.command[row]).collect();
        most(&about) - least(&about)
    }
}

fn profile_table(profiles: &[Profile; 2]) -> String {
    let mut text = String::from("| | dead zone | brake |\n|---|---|---|\n");
    let mut row = |what: &str, value: &dyn Fn(&Profile) -> String| {
        text += &format!("| {what} | {} | {} |\n", value(&profiles[0]), value(&profiles[1]));
    };
    for threshold in THRESHOLDS {
        let named = shown(threshold, 1e-3, 2);
        row(&format!("rising, oscillation ends (above {named} mm/s), mm/s"), &|p| {
            shown(p.rising(threshold), 1e-3, 2)
        });
    }
    for threshold in THRESHOLDS {
        let named = shown(threshold, 1e-3, 2);
        row(&format!("falling, it begins (above {named} mm/s), mm/s"), &|p| {
            shown(p.falling(threshold), 1e-3, 2)
        });
    }
    row("disturbance after the turn, mm/s", &|p| shown(p.disturbance(), 1e-3, 4));
    row("slips while rising", &|p| p.slips().to_string());
    row("most negative velocity, mm/s", &|p| shown(least(&p.record.velocity), 1e-3, 2));
    text
}

#[test]
fn the_page_tells_what_is_measured() {
    let profiles = [profile(0), profile(1)];
    check_part(PAGE, "profile", &profile_table(&profiles), "patchcord-thesis");
    let records = COMMANDS.map(|command| CIRCUITS.map(|(stem, _)| steady(stem, command)));
    check_part(PAGE, "steady", &steady_table(&records), "patchcord-thesis");
    check_told(PAGE, &[steady_sentences(&records), vec![profile_sentence(&profiles)]].concat());
    for [dead_zone, brake] in &records {
        check_dead_zone(dead_zone);
        check_brake(brake);
    }
    for threshold in [0.1e-3, 0.25e-3] {
        let off = profiles[0].falling(threshold) - profiles[1].falling(threshold);
        // Two samples of the falling command: where nothing stands still, both are one circuit.
        assert!(off.abs() < 2.5e-6, "{off}");
    }
}

/// How much one value is off another, in per cent.
fn off(one: f64, other: f64) -> String {
    shown((one / other - 1.0).abs(), 1e-2, 0)
}

/// What the text takes from the table of even commands.
fn steady_sentences([slowest, slow, _, fast, fastest]: &[[Record; 2]; 5]) -> Vec<String> {
    let stands = |record: &Record| shown(record.share(|row| record.velocity[row] == 0.0), 1e-2, 0);
    let slips = |record: &Record| shown(record.slips_per_second(), 1.0, 1);
    let slips_off = |pair: &[Record; 2]| off(pair[0].slips_per_second(), pair[1].slips_per_second());
    let peak_off = |pair: &[Record; 2]| off(most(&pair[0].velocity), most(&pair[1].velocity));
    let error = |record: &Record| shown(mean(&record.error), 1e-6, 1);
    let (takes, gives) = friction_power(0, &slow[0]);
    vec![
        format!(
            "for {} % of the time at 0.2 mm/s and for {} % at 4",
            stands(&slowest[1]),
            stands(&fastest[1])
        ),
        format!("at 0.2 mm/s for {} µm in one go", shown(slowest[0].way_back(), 1e-6, 2)),
        format!("gives back {} of the {} mW", shown(gives, 1e-3, 0), shown(takes, 1e-3, 0)),
        format!("{} slips a second instead of {} at 0.2", slips(&slowest[0]), slips(&slowest[1])),
        format!("{} instead of {} at 0.5", slips(&slow[0]), slips(&slow[1])),
        format!("the brake slips every {} ms", shown(1.0 / slow[1].slips_per_second(), 1e-3, 0)),
        format!("{} µm at 0.5 mm/s, where the brake has {}", error(&slow[0]), error(&slow[1])),
        format!("({} % at 2 mm/s, {} % at 4)", slips_off(fast), slips_off(fastest)),
        format!("peaks ({} % and {} %)", peak_off(fast), peak_off(fastest)),
    ]
}

/// What the text takes from the table of the ramp.
fn profile_sentence(profiles: &[Profile; 2]) -> String {
    let rising = THRESHOLDS.map(|threshold| [0, 1].map(|circuit| profiles[circuit].rising(threshold)));
    let higher = rising.map(|[dead_zone, brake]| brake - dead_zone);
    let share = rising.map(|[dead_zone, brake]| brake / dead_zone - 1.0);
    let [least, most] = [least(&higher), most(&higher)].map(|off| shown(off, 1e-3, 2));
    format!("{least} or {most} mm/s ({} %) higher", shown(mean(&share), 1e-2, 1))
}

/// Nothing stands still, friction pushes, and inside the mass coasts on viscous friction alone.
fn check_dead_zone(record: &Record) {
    assert_eq!(record.share(|row| record.velocity[row] == 0.0), 0.0);
    assert!(friction_power(0, record).1 > 0.02);
    let coasts = (-10.7e3 / 433.0 * EVERY).exp();
    let inside: Vec<_> =
        (1..record.rows()).filter(|row| record.is_held(row - 1) && record.is_held(*row)).collect();
    for row in &inside {
        let off = record.velocity[*row] - coasts * record.velocity[row - 1];
        assert!(off.abs() < 1e-12, "{off} m/s at row {row}");
    }
    assert!(inside.len() > 300, "{}", inside.len());
}

/// It stands still once every slip, and friction never pushes.
fn check_brake(record: &Record) {
    assert!(record.share(|row| record.velocity[row] == 0.0) > 0.03);
    assert!(record.stops().len().abs_diff(record.slips().len()) <= 1);
    assert_eq!(friction_power(1, record).1, 0.0);
}

#[test]
fn until_the_spring_comes_into_the_dead_zone_both_are_the_same() {
    let [dead_zone, brake] =
        CIRCUITS.map(|(stem, _)| record(stem, &[("v_start", 0.5e-3), ("v_rate", 0.0)], 0.1, 0.0));
    let released = (0..dead_zone.rows()).find(|row| !dead_zone.is_held(*row)).unwrap();
    let caught = (released..dead_zone.rows()).find(|row| dead_zone.is_held(*row)).unwrap();
    let off = runs::difference(&brake.velocity[..caught], &dead_zone.velocity[..caught]);
    assert!(off < 1e-8, "{off:e} of the peak");
    let parted = runs::difference(&brake.velocity[..2 * caught], &dead_zone.velocity[..2 * caught]);
    assert!(parted > 0.1, "{parted:e} of the peak");
    // What the page says of it.
    let peak = most(&dead_zone.velocity[..caught]);
    assert_eq!(shown(peak, 1e-3, 2), "4.03");
    assert_eq!([released, caught].map(|row| shown(row as f64 * EVERY, 1e-3, 0)), ["34", "47"]);
}
