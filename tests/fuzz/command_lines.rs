//! Random command lines for a document, which may be wrong in any way.

use super::document::Node;
use super::edge_values::UNITS;
use super::number_text::{changed_number, edge_formula, edge_name, edge_number, usual_number};
use super::pace::Pace;
use crate::common::random::SplitMix64;

/// The name of the patch file of a case.
pub(crate) const PATCH: &str = "case.json";
/// The table of a run or of a frequency response.
pub(crate) const TABLE: &str = "out.csv";
/// The table of a sweep.
pub(crate) const SWEEP: &str = "sweep.csv";
/// The parameter values of a sweep.
pub(crate) const ROWS: &str = "rows.csv";

/// The measures of a sweep, and one that does not exist.
static MEASURES: [&str; 15] = [
    "voltmeter",
    "peak",
    "least",
    "most",
    "amplitude",
    "frequency",
    "critical_velocity",
    "critical_velocity_range",
    "first_oscillation",
    "profile",
    "profile_falling",
    "friction_loop",
    "stick_end",
    "overload",
    "mean",
];

/// A command line that is being written.
struct CommandLine<'a> {
    /// The patch.
    document: &'a Node,
    /// The names of signals, drives and elements. Not empty.
    signals: Vec<String>,
    /// The names of parameters. Not empty.
    parameters: Vec<String>,
    /// The steps of a run.
    pace: Pace,
    /// The command and its options so far.
    words: Vec<String>,
}

/// A command on a patch, with random options. Its runs have few steps, since a step may contain a thousand events.
pub(crate) fn patch_command(document: &Node, random: &mut SplitMix64) -> Vec<String> {
    let or_x = |names: Vec<String>| if names.is_empty() { vec!["x".to_owned()] } else { names };
    let sections = ["signals", "drives", "elements"];
    let mut line = CommandLine {
        document,
        signals: or_x(sections.iter().flat_map(|section| document.names_in(section)).collect()),
        parameters: or_x(document.names_in("parameters")),
        pace: Pace::of(document, random),
        words: Vec::new(),
    };
    match random.below(20) {
        0..3 => line.check(random),
        3 => line.equations(random),
        4..11 => line.run(random),
        11..13 => line.draw(random),
        13..16 => line.linearise(random),
        16..19 => line.sweep(random),
        _ => line.profile(random),
    }
    line.words
}

/// Whether something happens that happens once in `times` cases.
pub(crate) fn once_in(times: usize, random: &mut SplitMix64) -> bool {
    random.below(times) == 0
}

impl CommandLine<'_> {
    /// Adds words.
    fn add(&mut self, words: &[&str]) {
        self.words.extend(words.iter().map(|word| (*word).to_owned()));
    }

    /// Adds words once in a number of cases.
    fn add_once_in(&mut self, times: usize, words: &[&str], random: &mut SplitMix64) {
        if once_in(times, random) {
            self.add(words);
        }
    }

    /// The name of a signal, drive or element.
    fn signal(&self, random: &mut SplitMix64) -> String {
        random.pick(&self.signals).clone()
    }

    /// Adds the command, the patch, and sometimes parameter values.
    fn begin(&mut self, command: &str, random: &mut SplitMix64) {
        self.add(&[command, PATCH]);
        while once_in(6, random) {
            let set = self.set(random);
            self.add(&["--set", &set]);
        }
    }

    /// A value of `--set`.
    fn set(&self, random: &mut SplitMix64) -> String {
        let is_edge = once_in(10, random);
        let name = if is_edge { edge_name(random) } else { random.pick(&self.parameters).clone() };
        let parameter = self.document.get("parameters").and_then(|section| section.get(&name));
        let value = parameter.and_then(|parameter| parameter.get("value")?.as_number()).unwrap_or(1.0);
        let unit = parameter.and_then(|parameter| parameter.get("unit")?.as_text()).unwrap_or("m");
        let value = match random.below(7) {
            0 => changed_number(&value.to_string(), random),
            1 => edge_number(random),
            2 => format!("{value}{}", random.pick(&UNITS)),
            3 => edge_name(random),
            4 => edge_formula(random),
            _ => format!("{value}{unit}"),
        };
        format!("{name}{}{value}", random.pick(&["=", "=", "=", "=", "=", "", " = "]))
    }

    /// Writes `check`.
    fn check(&mut self, random: &mut SplitMix64) {
        self.begin("check", random);
        self.add_once_in(2, &["--json"], random);
        match random.below(4) {
            0 | 1 => self.add(&["--scaling", "--voltages"]),
            2 => self.test(random),
            _ => (),
        }
    }

    /// Adds the test values of a static check.
    fn test(&mut self, random: &mut SplitMix64) {
        match random.below(6) {
            0 | 1 => self.add(&["--test", "initial"]),
            2..5 => self.add(&["--test", "random", "--seed", "3"]),
            _ => {
                let value = format!("{}={}", self.signal(random), edge_number(random));
                self.add(&["--test", &value]);
            }
        }
    }

    /// Writes `equations`.
    fn equations(&mut self, random: &mut SplitMix64) {
        self.begin("equations", random);
        self.add_once_in(3, &["--all"], random);
        match random.below(3) {
            0 => self.add(&["--json"]),
            1 => self.add(&["--latex"]),
            _ => (),
        }
    }

    /// Writes `run`.
    fn run(&mut self, random: &mut SplitMix64) {
        self.begin("run", random);
        self.add_times(false, random);
        self.add_once_in(2, &["--json"], random);
        match random.below(6) {
            0 => (),
            1 => self.add(&["--csv", TABLE, "--plot", "out.svg"]),
            2 => self.add(&["--csv", TABLE, "--plot", "out.png"]),
            3 => self.add(&["--out", "results"]),
            _ => self.add(&["--csv", TABLE]),
        }
        if once_in(5, random) {
            let names: Vec<String> = (0..=random.below(3)).map(|_| self.signal(random)).collect();
            self.add(&["--record", &names.join(",")]);
        }
        if once_in(5, random) {
            let parameter = random.pick(&self.parameters).clone();
            self.add(&["--sensitivity", &parameter]);
        }
        if once_in(5, random) {
            self.add(&["--backend", random.choose(&["reference", "interpreter", "lanes", "native"])]);
        }
        self.add_once_in(10, &["--hold-on-overload"], random);
        self.add_once_in(10, &["--fail-on-overload"], random);
        self.add_once_in(10, &["--verbose"], random);
        self.add_once_in(20, &["--repeat", "3"], random);
        self.add_once_in(20, &["--width", "240", "--height", "4000", "--scale", "0.25"], random);
    }

    /// Writes `draw`.
    fn draw(&mut self, random: &mut SplitMix64) {
        self.begin("draw", random);
        self.add(&["--plot", random.choose(&["d.svg", "d.svg", "d.png"])]);
        self.add_once_in(5, &["--out", "results"], random);
        self.add_once_in(3, &["--json"], random);
        match random.below(4) {
            0 => self.add(&["--board"]),
            1 => self.add(&["--open", "--dark"]),
            2 => {
                let seconds = self.pace.duration(random.below(100) as f64).to_string();
                self.add(&["--values", &seconds]);
            }
            _ => (),
        }
    }

    /// Writes `linearise`, often with a frequency response.
    fn linearise(&mut self, random: &mut SplitMix64) {
        self.begin("linearise", random);
        self.add_once_in(2, &["--json"], random);
        if once_in(2, random) {
            let seconds = self.pace.duration(random.choose(&[0.0, 1.0, 10.0, 100.0])).to_string();
            self.add(&["--at", &seconds]);
        }
        let drives = self.document.names_in("drives");
        if drives.is_empty() || once_in(4, random) {
            return;
        }
        let from = if once_in(4, random) { self.signal(random) } else { random.pick(&drives).clone() };
        let to = self.signal(random);
        self.add(&["--from", &from, "--to", &to]);
        if once_in(5, random) {
            let by = random.pick(&drives).clone();
            self.add(&["--by", &by]);
        }
        self.add_once_in(2, &["--csv", TABLE], random);
        self.add_once_in(3, &["--plot", "out.svg"], random);
        if once_in(3, random) {
            let band = format!("{}:{}", usual_number(random), edge_number(random));
            self.add(&["--hz", &band]);
        }
    }

    /// Writes `sweep` with one or two axes and measures.
    fn sweep(&mut self, random: &mut SplitMix64) {
        self.begin("sweep", random);
        self.add_times(true, random);
        self.add(&["--threads", random.choose(&["1", "2"])]);
        for _ in 0..=random.below(2) {
            let (axis, measure) = (self.axis(random), self.measure(random));
            self.add(&["--vary", &axis, "--measure", &measure]);
        }
        self.add_once_in(6, &["--rows", ROWS], random);
        if !once_in(4, random) {
            self.add(&["--out", SWEEP]);
            self.add_once_in(4, &["--json"], random);
        }
    }

    /// A value of `--vary` with few runs.
    fn axis(&self, random: &mut SplitMix64) -> String {
        let name = random.pick(&self.parameters);
        let parameter = self.document.get("parameters").and_then(|section| section.get(name));
        let (low, high) = match parameter.and_then(|parameter| parameter.get("range")) {
            Some(Node::List(ends)) if ends.len() == 2 => (ends[0].json(), ends[1].json()),
            _ => (usual_number(random), usual_number(random)),
        };
        match random.below(10) {
            0 => format!("{name}={low}:{high}:3:log"),
            1 => format!("{name}={low},{low}"),
            2 => format!("{name}={high}"),
            3 => format!("{name}={}:{}:3", edge_number(random), edge_number(random)),
            4 => format!("{name}={low}:{high}:{}", random.pick(&["0", "1", "-1", "1e9", "2.5", "", "3:lin"])),
            5 => format!("{name}={}", edge_name(random)),
            _ => format!("{name}={low}:{high}:3"),
        }
    }

    /// A value of `--measure`.
    fn measure(&self, random: &mut SplitMix64) -> String {
        // The first six measures are known for every signal.
        let measure = if once_in(2, random) { random.pick(&MEASURES[..6]) } else { random.pick(&MEASURES) };
        let signal = self.signal(random);
        match random.below(6) {
            0 => (*measure).to_owned(),
            1 => format!("{measure}:{signal},{}", self.signal(random)),
            2 => {
                let option = random.pick(&["last", "threshold", "window", "standstill", "least"]);
                format!("{measure}:{signal},{option}={}", edge_number(random))
            }
            _ => format!("{measure}:{signal}"),
        }
    }

    /// Writes `profile`.
    fn profile(&mut self, random: &mut SplitMix64) {
        self.begin("profile", random);
        self.add_times(true, random);
        self.add_once_in(2, &["--json"], random);
        let signals = format!("{},{}", self.signal(random), self.signal(random));
        self.add(&["--signals", &signals]);
        if once_in(2, random) {
            let window = self.pace.duration(random.choose(&[1.0, 3.0, 10.0, 100.0])).to_string();
            self.add(&["--threshold", &edge_number(random), "--window", &window]);
        }
        if once_in(3, random) {
            self.add(&["--standstill", &edge_number(random)]);
        }
        self.add_once_in(3, &["--falling"], random);
        self.add_once_in(3, &["--plot", "out.svg"], random);
    }

    /// Adds options that limit the number of steps. A short run plan of the patch may be left as it is, unless the
    /// steps are fixed.
    fn add_times(&mut self, is_fixed: bool, random: &mut SplitMix64) {
        if !is_fixed && self.pace.is_short() && once_in(2, random) {
            return;
        }
        let step = self.pace.step;
        let length = step * random.pick(&[1.0, 10.0, 100.0, 300.0]);
        let adaptive = length.min(self.pace.longest_adaptive).to_string();
        match random.below(10) {
            0 if !is_fixed => {
                let tolerance = random.pick(&["1", "1e-3", "1e-6", "1e-9", "1e-12", "1e-13"]);
                self.add(&["--for", &adaptive, "--tol", tolerance]);
            }
            1 if !is_fixed => self.add(&["--for", &adaptive, "--step", "auto"]),
            _ => {
                let every = random.choose(&[step, length]);
                let texts = [length, step, every].map(|seconds| seconds.to_string());
                self.add(&["--for", &texts[0], "--step", &texts[1], "--every", &texts[2]]);
            }
        }
    }
}
