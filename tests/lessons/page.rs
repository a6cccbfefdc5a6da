//! docs/lessons.md: its commands run and give the numbers that the page states.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use serde_json::Value;

/// The page in one line, to search for sentences.
static PAGE: LazyLock<String> = LazyLock::new(|| {
    let page = fs::read_to_string("docs/lessons.md").unwrap();
    page.split_whitespace().collect::<Vec<_>>().join(" ")
});

/// The commands of the page.
fn commands() -> Vec<String> {
    let page = fs::read_to_string("docs/lessons.md").unwrap();
    page.lines().filter_map(|line| line.strip_prefix("    patchcord ")).map(str::to_owned).collect()
}

/// The result of a command: exit code, JSON document, and recorded columns.
struct CommandResult {
    code: Option<i32>,
    document: Value,
    columns: BTreeMap<String, Vec<f64>>,
}

/// Runs a command in a temporary folder with a copy of its lesson.
fn run_command(command: &str) -> CommandResult {
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
    CommandResult {
        code: output.status.code(),
        document: serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{command}: {error}")),
        columns: columns(&table),
    }
}

/// The columns of a CSV table by name.
fn columns(table: &str) -> BTreeMap<String, Vec<f64>> {
    let mut rows = table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(','));
    let names: Vec<_> = rows.next().into_iter().flatten().collect();
    let rows: Vec<Vec<f64>> = rows.map(|row| row.map(|cell| cell.parse().unwrap()).collect()).collect();
    let column = |index: usize| rows.iter().map(|row| row[index]).collect();
    names.iter().enumerate().map(|(index, name)| ((*name).to_owned(), column(index))).collect()
}

impl CommandResult {
    fn column(&self, name: &str) -> &[f64] {
        &self.columns[name]
    }

    fn reading(&self, signal: &str) -> &Value {
        let readings = self.document["readings"].as_array().unwrap();
        readings.iter().find(|reading| reading["signal"] == signal).unwrap()
    }

    fn start(&self, signal: &str) -> f64 {
        self.reading(signal)["start"].as_f64().unwrap()
    }

    fn end(&self, signal: &str) -> f64 {
        self.reading(signal)["end"].as_f64().unwrap()
    }

    /// The end value of a signal in one of several runs, counted from 1.
    fn end_of_run(&self, run: usize, signal: &str) -> f64 {
        let mut readings = self.document["readings"].as_array().unwrap().iter();
        let reading = readings.find(|reading| reading["run"] == run && reading["signal"] == signal);
        reading.unwrap()["end"].as_f64().unwrap()
    }

    /// The smallest ("least") or largest ("most") value of a signal.
    fn peak(&self, signal: &str, which: &str) -> f64 {
        self.reading(signal)[which]["value"].as_f64().unwrap()
    }

    /// The time of that value.
    fn peak_time(&self, signal: &str, which: &str) -> f64 {
        self.reading(signal)[which]["t"].as_f64().unwrap()
    }

    /// The samples of a signal in the last `last` seconds.
    fn last_samples(&self, signal: &str, last: f64) -> impl Iterator<Item = f64> {
        let time = self.column("t");
        let from = time[time.len() - 1] - last;
        time.iter().zip(self.column(signal)).filter(move |(time, _)| **time >= from).map(|(_, value)| *value)
    }

    /// The largest absolute value of a signal in the last `last` seconds.
    fn swing(&self, signal: &str, last: f64) -> f64 {
        self.last_samples(signal, last).map(f64::abs).fold(0.0, f64::max)
    }

    /// Times at which a signal falls through a level, by linear interpolation.
    fn falls(&self, signal: &str, level: f64) -> Vec<f64> {
        let (time, values) = (self.column("t"), self.column(signal));
        let fall = |pair: usize| {
            let (before, after) = (values[pair] - level, values[pair + 1] - level);
            let fraction = before / (before - after);
            (before > 0.0 && after <= 0.0).then(|| time[pair] + fraction * (time[pair + 1] - time[pair]))
        };
        (0..time.len() - 1).filter_map(fall).collect()
    }

    /// How long a signal stays above or below a level the second time. The first time may be cut off by the start.
    fn stay(&self, signal: &str, level: f64, above: bool) -> f64 {
        let (time, values) = (self.column("t"), self.column(signal));
        let changes: Vec<usize> =
            (1..time.len()).filter(|row| (values[*row] > level) != (values[*row - 1] > level)).collect();
        let first = changes.iter().skip(1).position(|row| (values[*row] > level) == above).unwrap() + 1;
        time[changes[first + 1]] - time[changes[first]]
    }

    /// The time of the first overload, which must be of this element.
    fn lamp(&self, element: &str) -> f64 {
        let first = &self.document["sweeps"][0]["overloads"][0];
        assert_eq!(first["element"], element);
        first["t"].as_f64().unwrap()
    }

    /// The duration of a phase.
    fn phase(&self, number: usize) -> f64 {
        let [begin, end] =
            ["begin", "end"].map(|key| self.document["phases"][number - 1][key].as_f64().unwrap());
        end - begin
    }

    /// A signal at the end of a phase.
    fn after_phase(&self, number: usize, signal: &str) -> f64 {
        self.column(signal)[self.document["phases"][number]["sample"].as_u64().unwrap() as usize - 1]
    }
}

/// A number on the page: the arguments of `run` with the stem of the file, a piece of text with `#` for the number,
/// how it is measured, and its decimals.
type Statement = (&'static str, &'static str, fn(&CommandResult) -> f64, usize);

/// The numbers on the page. Some commands have further options for finer recording.
const STATEMENTS: &[Statement] = &[
    ("mass-and-spring", "grows from # s to 1.987 s", |result| period(result, "x"), 3),
    ("mass-and-spring --set m=4", "from 0.993 s to # s", |result| period(result, "x"), 3),
    ("mass-and-spring --set k=10", "from 0.993 s to # s", |result| period(result, "x"), 3),
    ("mass-and-spring --set m=4", "the velocity reaches # mm/s", |result| result.peak("v", "most"), 0),
    ("mass-and-spring", "instead of # mm/s", |result| result.peak("v", "most"), 0),
    ("mass-and-spring --step 0.04 --for 20", "from # mJ to", |result| result.start("total"), 0),
    ("mass-and-spring --step 0.04 --for 20", "to # mJ in 20 s", |result| result.end("total"), 1),
    ("driven-oscillator", "at 1 Hz, it swings # mm", |result| result.swing("x", 2.0), 1),
    (
        "driven-oscillator --set f=0.5 --for 20",
        "at 0.5 Hz it swings # mm",
        |result| result.swing("x", 4.0),
        0,
    ),
    ("driven-oscillator --set f=2 --for 20", "# mm at 2 Hz", |result| result.swing("x", 2.0), 0),
    ("driven-oscillator --set d=0.5 --for 20", "A2 lights after # s", |result| result.lamp("A2"), 1),
    (
        "driven-oscillator --set d=0.5 --set F=0.25 --for 60",
        "far there, # mm",
        |result| 4.0 * result.swing("x", 2.0),
        0,
    ),
    (
        "driven-oscillator --set d=0.5 --set F=0.25 --for 60",
        "it swings # mm again",
        |result| result.swing("x", 2.0),
        1,
    ),
    ("two-phase-oscillator --set start=90", "to the same # V", |result| result.swing("sine", 2.0), 1),
    ("two-phase-oscillator --set level=30", "it settles at # V", |result| result.swing("sine", 2.0), 1),
    (
        "two-phase-oscillator --set level=30",
        "always # times the level",
        |result| result.swing("sine", 2.0) / 30.0,
        2,
    ),
    ("two-phase-oscillator --set damp=0", "A2 overloads, after # s", |result| result.lamp("A2"), 1),
    ("van-der-pol --set mu=0.1 --for 100", "a circle of radius #,", |result| result.swing("x", 7.0), 0),
    ("van-der-pol --set mu=0.1 --for 100", "about #0 seconds", |result| settled(result) / 10.0, 0),
    ("van-der-pol --set mu=0", "it keeps the # it was given", |result| result.swing("x", 7.0), 1),
    (
        "lorenz --set x0=1.001 --for 12",
        "after 11 s x is # in the one",
        |result| result.column("x")[at(result, 11.0)],
        1,
    ),
    ("lorenz --for 12", "in the one and # in the other", |result| result.column("x")[at(result, 11.0)], 1),
    ("mathieu", "beats, and stays below #", |result| result.swing("y", 60.0), 1),
    ("mathieu --set a=1", "A2 lights after # s", |result| result.lamp("A2"), 1),
    (
        "mathieu --set a=-0.1 --set q=0.6 --set y0=0.1",
        "never further than # from the top",
        |result| result.swing("y", 60.0),
        2,
    ),
    (
        "predator-and-prey --set x0=10000",
        "hares up to #000",
        |result| result.peak("hares", "most") / 1000.0,
        0,
    ),
    (
        "predator-and-prey --set x0=10000",
        "lynxes down to #00",
        |result| result.peak("lynxes", "least") / 100.0,
        0,
    ),
    (
        "bouncing-ball --set g=1.62 --for 15",
        "the floor after # s",
        |result| result.peak_time("vy", "least"),
        2,
    ),
    ("bouncing-ball", "instead of # s. With nothing lost", |result| result.peak_time("vy", "least"), 2),
    ("projectile", "how far it goes: # m and", |result| result.end("x"), 1),
    ("projectile", "112.3 m and # m. The table", |result| result.end_of_run(2, "x"), 1),
    ("projectile", "at 40 degrees # s with air", |result| result.phase(2), 2),
    ("projectile", "with air and # s without", |result| result.phase(5), 2),
    ("projectile --set angle=30", "the ball goes # m with air", |result| result.after_phase(2, "x"), 0),
    ("projectile --set angle=90", "to a stop after # s", |result| result.peak_time("speed", "least"), 2),
    ("projectile --set v0=30", "it takes # s off a flight", |result| result.phase(5) - result.phase(2), 2),
    ("projectile --set v0=30", "off a flight of # s", |result| result.phase(5), 2),
    ("square-root-and-division --set a=1.5e-4 --for 150", "empties the tank in # s", empty, 1),
    ("square-root-and-division --set h0=0.25 --for 110", "half the time, # s", empty, 1),
    ("square-root-and-division", "the arm stands at # degrees", |result| result.start("arm"), 1),
    (
        "square-root-and-division --set L=1.25 --set h0=1.2",
        "and at # degrees where it is short",
        |result| result.start("arm"),
        1,
    ),
    ("heat-rod --set a=1.2e-5", "far end is # K warmer after 1500 s", |result| result.end("T6"), 1),
    ("heat-rod", "that of copper # K", |result| result.end("T6"), 1),
    ("heat-rod --set d=100 --for 6000", "that of copper # K", |result| result.end("T6"), 1),
    (
        "relay-thermostat --set width=1 --every 0.01 --for 700",
        "on for # s and off for 61 s",
        |result| result.stay("heater", 50.0, true),
        0,
    ),
    (
        "relay-thermostat --set width=1 --every 0.01 --for 700",
        "and off for # s. A stronger",
        |result| result.stay("heater", 50.0, false),
        0,
    ),
    (
        "relay-thermostat --set P=200 --every 0.1",
        "is on for # s instead of 127 s",
        |result| result.stay("heater", 50.0, true),
        0,
    ),
    (
        "relay-thermostat --every 0.1",
        "instead of # s; the pause",
        |result| result.stay("heater", 50.0, true),
        0,
    ),
    (
        "relay-thermostat --set P=200 --every 0.1",
        "the pause, # s, is",
        |result| result.stay("heater", 50.0, false),
        0,
    ),
    ("relay-thermostat --every 0.1", "the pause, # s, is", |result| result.stay("heater", 50.0, false), 0),
    (
        "stick-slip --every 1e-3",
        "the block sticks, from # s to",
        |result| result.stay("sliding", -1e-9, true),
        1,
    ),
    (
        "stick-slip --set v=0.1 --every 1e-3",
        "0.8 s to # s. With less",
        |result| result.stay("sliding", -1e-9, true),
        1,
    ),
    (
        "stick-slip --set Fs=6",
        "evenly between # mm and",
        |result| 1e3 * result.last_samples("x", 2.0).fold(f64::MAX, f64::min),
        0,
    ),
    ("stick-slip --set Fs=6", "mm and # mm and never sticks", |result| 1e3 * result.swing("x", 2.0), 0),
];

/// The time between the first two falls of a signal through 0.
fn period(result: &CommandResult, signal: &str) -> f64 {
    let falls = result.falls(signal, 0.0);
    falls[1] - falls[0]
}

/// The index of the sample at a time.
fn at(result: &CommandResult, time: f64) -> usize {
    result.column("t").iter().position(|sampled| (sampled - time).abs() < 1e-9).unwrap()
}

/// The time at which |x| first reaches 1.98.
fn settled(result: &CommandResult) -> f64 {
    result.column("t")[result.column("x").iter().position(|x| x.abs() >= 1.98).unwrap()]
}

/// The time at which the tank is empty. The signal `lasts` is half of the actual remaining time.
fn empty(result: &CommandResult) -> f64 {
    150.0f64.min(*result.column("t").last().unwrap()) + 2.0 * result.end("lasts")
}

#[test]
#[ignore = "takes several seconds: every command of the page"]
fn the_page_states_the_results_of_its_commands() {
    let commands = commands();
    let (mut missing, mut done) = (Vec::new(), BTreeMap::new());
    for (words, text, measure, digits) in STATEMENTS {
        let (stem, options) = words.split_once(' ').unwrap_or((words, ""));
        let command = format!("run patches/lessons/{stem}.json {options}");
        let command = command.trim();
        let is_proposed = commands.iter().any(|proposed| command.starts_with(proposed));
        assert!(is_proposed || !options.contains("--set"), "{command} is not on the page");
        let result: &CommandResult =
            done.entry(command.to_owned()).or_insert_with_key(|command| run_command(command));
        let number = format!("{:.digits$}", measure(result));
        let sentence = text.replace('#', &number);
        if !PAGE.contains(&sentence) {
            missing.push(format!("{command}: {sentence}"));
        }
    }
    assert!(missing.is_empty(), "docs/lessons.md does not say: {missing:#?}");
}

/// The only command of the page that must fail, and its description there.
const STOPS: (&str, &str) =
    ("run patches/lessons/square-root-and-division.json --for 240", "stops with an error at 225.5 s");

#[test]
#[ignore = "takes several seconds: every command of the page"]
fn every_command_of_the_page_runs() {
    let commands = commands();
    for command in &commands {
        let result = run_command(command);
        assert_eq!(result.code, Some(i32::from(command == STOPS.0)), "{command}: {}", result.document);
    }
    assert!(commands.len() >= 3 * 13, "{commands:?}");
    let why = run_command(STOPS.0).document["error"].as_str().unwrap().to_owned();
    assert!(PAGE.contains(STOPS.1) && why.starts_with("at t = 225.5 s"), "{why}");
}
