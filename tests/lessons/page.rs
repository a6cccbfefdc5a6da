//! docs/lessons.md: its commands run as they stand there, and give the numbers that it tells of them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use serde_json::Value;

/// The page in one line, so that sentences can be looked for.
static PAGE: LazyLock<String> = LazyLock::new(|| {
    let page = fs::read_to_string("docs/lessons.md").unwrap();
    page.split_whitespace().collect::<Vec<_>>().join(" ")
});

/// The commands of the page.
fn commands() -> Vec<String> {
    let page = fs::read_to_string("docs/lessons.md").unwrap();
    page.lines().filter_map(|line| line.strip_prefix("    patchcord ")).map(str::to_owned).collect()
}

/// What a command gave: its code, its JSON document, and what it recorded.
struct Ran {
    code: Option<i32>,
    told: Value,
    columns: BTreeMap<String, Vec<f64>>,
}

/// Runs a command in a folder of its own beside the lessons.
fn ran(command: &str) -> Ran {
    let folder = tempfile::tempdir().unwrap();
    let lessons = folder.path().join("patches/lessons");
    fs::create_dir_all(&lessons).unwrap();
    let file = command.split_whitespace().nth(1).unwrap();
    fs::copy(file, lessons.join(Path::new(file).file_name().unwrap())).unwrap();
    let recorded: &[&str] = if command.starts_with("run ") { &["--csv", "recorded.csv"] } else { &[] };
    let output = Command::new(env!("CARGO_BIN_EXE_patchcord"))
        .current_dir(&folder)
        .args(command.split_whitespace())
        .arg("--json")
        .args(recorded)
        .output()
        .unwrap();
    let table = fs::read_to_string(folder.path().join("recorded.csv")).unwrap_or_default();
    Ran {
        code: output.status.code(),
        told: serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{command}: {error}")),
        columns: columns(&table),
    }
}

fn columns(table: &str) -> BTreeMap<String, Vec<f64>> {
    let mut rows = table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(','));
    let names: Vec<_> = rows.next().into_iter().flatten().collect();
    let rows: Vec<Vec<f64>> = rows.map(|row| row.map(|cell| cell.parse().unwrap()).collect()).collect();
    let column = |index: usize| rows.iter().map(|row| row[index]).collect();
    names.iter().enumerate().map(|(index, name)| ((*name).to_owned(), column(index))).collect()
}

impl Ran {
    fn column(&self, name: &str) -> &[f64] {
        &self.columns[name]
    }

    fn reading(&self, signal: &str) -> &Value {
        let readings = self.told["readings"].as_array().unwrap();
        readings.iter().find(|reading| reading["signal"] == signal).unwrap()
    }

    fn start(&self, signal: &str) -> f64 {
        self.reading(signal)["start"].as_f64().unwrap()
    }

    fn end(&self, signal: &str) -> f64 {
        self.reading(signal)["end"].as_f64().unwrap()
    }

    /// The same of a later run.
    fn end_of_run(&self, run: usize, signal: &str) -> f64 {
        let mut readings = self.told["readings"].as_array().unwrap().iter();
        let reading = readings.find(|reading| reading["run"] == run && reading["signal"] == signal);
        reading.unwrap()["end"].as_f64().unwrap()
    }

    /// The least or most of a signal.
    fn peak(&self, signal: &str, which: &str) -> f64 {
        self.reading(signal)[which]["value"].as_f64().unwrap()
    }

    /// When it is there.
    fn peak_time(&self, signal: &str, which: &str) -> f64 {
        self.reading(signal)[which]["t"].as_f64().unwrap()
    }

    /// The samples of a signal in the last seconds.
    fn late(&self, signal: &str, last: f64) -> impl Iterator<Item = f64> {
        let time = self.column("t");
        let from = time[time.len() - 1] - last;
        time.iter().zip(self.column(signal)).filter(move |(time, _)| **time >= from).map(|(_, value)| *value)
    }

    /// The largest amount of a signal in the last seconds.
    fn swing(&self, signal: &str, last: f64) -> f64 {
        self.late(signal, last).map(f64::abs).fold(0.0, f64::max)
    }

    /// Times at which a signal falls through a level, by straight lines between samples.
    fn falls(&self, signal: &str, level: f64) -> Vec<f64> {
        let (time, values) = (self.column("t"), self.column(signal));
        let fall = |pair: usize| {
            let (before, after) = (values[pair] - level, values[pair + 1] - level);
            let share = before / (before - after);
            (before > 0.0 && after <= 0.0).then(|| time[pair] + share * (time[pair + 1] - time[pair]))
        };
        (0..time.len() - 1).filter_map(fall).collect()
    }

    /// How long a signal stays above a level, or below it, the second time: the first time it may have begun there.
    fn stay(&self, signal: &str, level: f64, above: bool) -> f64 {
        let (time, values) = (self.column("t"), self.column(signal));
        let changes: Vec<usize> =
            (1..time.len()).filter(|row| (values[*row] > level) != (values[*row - 1] > level)).collect();
        let first = changes.iter().skip(1).position(|row| (values[*row] > level) == above).unwrap() + 1;
        time[changes[first + 1]] - time[changes[first]]
    }

    /// When the lamp of an amplifier lit, before all others.
    fn lamp(&self, element: &str) -> f64 {
        let first = &self.told["sweeps"][0]["overloads"][0];
        assert_eq!(first["element"], element);
        first["t"].as_f64().unwrap()
    }

    /// How long a phase took.
    fn phase(&self, number: usize) -> f64 {
        let [begin, end] = ["begin", "end"].map(|key| self.told["phases"][number - 1][key].as_f64().unwrap());
        end - begin
    }

    /// A signal at the end of a phase.
    fn after_phase(&self, number: usize, signal: &str) -> f64 {
        self.column(signal)[self.told["phases"][number]["sample"].as_u64().unwrap() as usize - 1]
    }
}

/// The words of a command after `run`, without folder and ending of the file; a piece of the page with `#` for a number, how the number is measured, and its decimals.
type Told = (&'static str, &'static str, fn(&Ran) -> f64, usize);

/// Commands of the page, some with words behind them that record finer; and the lessons' own runs.
const TOLD: &[Told] = &[
    ("mass-and-spring", "grows from # s to 1.987 s", |ran| period(ran, "x"), 3),
    ("mass-and-spring --set m=4", "from 0.993 s to # s", |ran| period(ran, "x"), 3),
    ("mass-and-spring --set k=10", "from 0.993 s to # s", |ran| period(ran, "x"), 3),
    ("mass-and-spring --set m=4", "the velocity reaches # mm/s", |ran| ran.peak("v", "most"), 0),
    ("mass-and-spring", "instead of # mm/s", |ran| ran.peak("v", "most"), 0),
    ("mass-and-spring --step 0.04 --for 20", "from # mJ to", |ran| ran.start("total"), 0),
    ("mass-and-spring --step 0.04 --for 20", "to # mJ in 20 s", |ran| ran.end("total"), 1),
    ("driven-oscillator", "at 1 Hz, it swings # mm", |ran| ran.swing("x", 2.0), 1),
    ("driven-oscillator --set f=0.5 --for 20", "at 0.5 Hz it swings # mm", |ran| ran.swing("x", 4.0), 0),
    ("driven-oscillator --set f=2 --for 20", "# mm at 2 Hz", |ran| ran.swing("x", 2.0), 0),
    ("driven-oscillator --set d=0.5 --for 20", "A2 lights after # s", |ran| ran.lamp("A2"), 1),
    (
        "driven-oscillator --set d=0.5 --set F=0.25 --for 60",
        "far there, # mm",
        |ran| 4.0 * ran.swing("x", 2.0),
        0,
    ),
    (
        "driven-oscillator --set d=0.5 --set F=0.25 --for 60",
        "it swings # mm again",
        |ran| ran.swing("x", 2.0),
        1,
    ),
    ("two-phase-oscillator --set start=90", "to the same # V", |ran| ran.swing("sine", 2.0), 1),
    ("two-phase-oscillator --set level=30", "it settles at # V", |ran| ran.swing("sine", 2.0), 1),
    (
        "two-phase-oscillator --set level=30",
        "always # times the level",
        |ran| ran.swing("sine", 2.0) / 30.0,
        2,
    ),
    ("two-phase-oscillator --set damp=0", "A2 overloads, after # s", |ran| ran.lamp("A2"), 1),
    ("van-der-pol --set mu=0.1 --for 100", "a circle of radius #,", |ran| ran.swing("x", 7.0), 0),
    ("van-der-pol --set mu=0.1 --for 100", "about #0 seconds", |ran| settled(ran) / 10.0, 0),
    ("van-der-pol --set mu=0", "it keeps the # it was given", |ran| ran.swing("x", 7.0), 1),
    (
        "lorenz --set x0=1.001 --for 12",
        "after 11 s x is # in the one",
        |ran| ran.column("x")[at(ran, 11.0)],
        1,
    ),
    ("lorenz --for 12", "in the one and # in the other", |ran| ran.column("x")[at(ran, 11.0)], 1),
    ("mathieu", "beats, and stays below #", |ran| ran.swing("y", 60.0), 1),
    ("mathieu --set a=1", "A2 lights after # s", |ran| ran.lamp("A2"), 1),
    (
        "mathieu --set a=-0.1 --set q=0.6 --set y0=0.1",
        "never further than # from the top",
        |ran| ran.swing("y", 60.0),
        2,
    ),
    ("predator-and-prey --set x0=10000", "hares up to #000", |ran| ran.peak("hares", "most") / 1000.0, 0),
    ("predator-and-prey --set x0=10000", "lynxes down to #00", |ran| ran.peak("lynxes", "least") / 100.0, 0),
    ("bouncing-ball --set g=1.62 --for 15", "the floor after # s", |ran| ran.peak_time("vy", "least"), 2),
    ("bouncing-ball", "instead of # s. With nothing lost", |ran| ran.peak_time("vy", "least"), 2),
    ("projectile", "how far it goes: # m and", |ran| ran.end("x"), 1),
    ("projectile", "112.3 m and # m. The table", |ran| ran.end_of_run(2, "x"), 1),
    ("projectile", "at 40 degrees # s with air", |ran| ran.phase(2), 2),
    ("projectile", "with air and # s without", |ran| ran.phase(5), 2),
    ("projectile --set angle=30", "the ball goes # m with air", |ran| ran.after_phase(2, "x"), 0),
    ("projectile --set angle=90", "to a stop after # s", |ran| ran.peak_time("speed", "least"), 2),
    ("projectile --set v0=30", "it takes # s off a flight", |ran| ran.phase(5) - ran.phase(2), 2),
    ("projectile --set v0=30", "off a flight of # s", |ran| ran.phase(5), 2),
    ("square-root-and-division --set a=1.5e-4 --for 150", "empties the tank in # s", empty, 1),
    ("square-root-and-division --set h0=0.25 --for 110", "half the time, # s", empty, 1),
    ("square-root-and-division", "the arm stands at # degrees", |ran| ran.start("arm"), 1),
    (
        "square-root-and-division --set L=1.25 --set h0=1.2",
        "and at # degrees where it is short",
        |ran| ran.start("arm"),
        1,
    ),
    ("heat-rod --set a=1.2e-5", "far end is # K warmer after 1500 s", |ran| ran.end("T6"), 1),
    ("heat-rod", "that of copper # K", |ran| ran.end("T6"), 1),
    ("heat-rod --set d=100 --for 6000", "that of copper # K", |ran| ran.end("T6"), 1),
    (
        "relay-thermostat --set width=1 --every 0.01 --for 700",
        "on for # s and off for 61 s",
        |ran| ran.stay("heater", 50.0, true),
        0,
    ),
    (
        "relay-thermostat --set width=1 --every 0.01 --for 700",
        "and off for # s. A stronger",
        |ran| ran.stay("heater", 50.0, false),
        0,
    ),
    (
        "relay-thermostat --set P=200 --every 0.1",
        "is on for # s instead of 127 s",
        |ran| ran.stay("heater", 50.0, true),
        0,
    ),
    ("relay-thermostat --every 0.1", "instead of # s; the pause", |ran| ran.stay("heater", 50.0, true), 0),
    (
        "relay-thermostat --set P=200 --every 0.1",
        "the pause, # s, is",
        |ran| ran.stay("heater", 50.0, false),
        0,
    ),
    ("relay-thermostat --every 0.1", "the pause, # s, is", |ran| ran.stay("heater", 50.0, false), 0),
    ("stick-slip --every 1e-3", "the block sticks, from # s to", |ran| ran.stay("sliding", -1e-9, true), 1),
    (
        "stick-slip --set v=0.1 --every 1e-3",
        "0.8 s to # s. With less",
        |ran| ran.stay("sliding", -1e-9, true),
        1,
    ),
    (
        "stick-slip --set Fs=6",
        "evenly between # mm and",
        |ran| 1e3 * ran.late("x", 2.0).fold(f64::MAX, f64::min),
        0,
    ),
    ("stick-slip --set Fs=6", "mm and # mm and never sticks", |ran| 1e3 * ran.swing("x", 2.0), 0),
];

/// The time between two falls through 0.
fn period(ran: &Ran, signal: &str) -> f64 {
    let falls = ran.falls(signal, 0.0);
    falls[1] - falls[0]
}

/// The sample at a time.
fn at(ran: &Ran, time: f64) -> usize {
    ran.column("t").iter().position(|sampled| (sampled - time).abs() < 1e-9).unwrap()
}

/// When the swing of x first comes within a hundredth of 2.
fn settled(ran: &Ran) -> f64 {
    ran.column("t")[ran.column("x").iter().position(|x| x.abs() >= 1.98).unwrap()]
}

/// When the tank is empty: the time that the water would last is half of that which it does last.
fn empty(ran: &Ran) -> f64 {
    150.0f64.min(*ran.column("t").last().unwrap()) + 2.0 * ran.end("lasts")
}

#[test]
#[ignore = "takes several seconds: every command of the page"]
fn the_page_tells_what_its_commands_give() {
    let commands = commands();
    let (mut missing, mut done) = (Vec::new(), BTreeMap::new());
    for (words, text, measure, digits) in TOLD {
        let (stem, options) = words.split_once(' ').unwrap_or((words, ""));
        let command = format!("run patches/lessons/{stem}.json {options}");
        let command = command.trim();
        let is_proposed = commands.iter().any(|proposed| command.starts_with(proposed));
        assert!(is_proposed || !options.contains("--set"), "{command} is not on the page");
        let ran: &Ran = done.entry(command.to_owned()).or_insert_with_key(|command| ran(command));
        let number = format!("{:.digits$}", measure(ran));
        let sentence = text.replace('#', &number);
        if !PAGE.contains(&sentence) {
            missing.push(format!("{command}: {sentence}"));
        }
    }
    assert!(missing.is_empty(), "docs/lessons.md does not say: {missing:#?}");
}

/// The one command of the page that has to stop, and why.
const STOPS: (&str, &str) =
    ("run patches/lessons/square-root-and-division.json --for 240", "stops with an error at 225.5 s");

#[test]
#[ignore = "takes several seconds: every command of the page"]
fn every_command_of_the_page_runs_as_it_stands_there() {
    let commands = commands();
    for command in &commands {
        let ran = ran(command);
        assert_eq!(ran.code, Some(i32::from(command == STOPS.0)), "{command}: {}", ran.told);
    }
    assert!(commands.len() >= 3 * 13, "{commands:?}");
    let why = ran(STOPS.0).told["error"].as_str().unwrap().to_owned();
    assert!(PAGE.contains(STOPS.1) && why.starts_with("at t = 225.5 s"), "{why}");
}
