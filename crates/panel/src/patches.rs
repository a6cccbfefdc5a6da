//! The patches of the repository, as texts in the program, and the gallery that lists them.
//!
//! Their files are in the folders `patches` and `examples` of the repository, outside of this crate. The crate is built
//! as a part of the repository and is not published, so its tables may include them from there.

use patchcord_core::patch::Patch;
use serde_json::{Map, Value, json};

use crate::wiring;

/// A patch of the repository.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShippedPatch {
    /// Its path in the folder `patches`, or that of an example in the repository: "lessons/lorenz.json". This is its
    /// address below `patches/`.
    pub path: &'static str,
    /// What it shows, in one line. For a patch that needs data of others, also which.
    pub line: &'static str,
    /// Its text, as it is in the file.
    pub text: &'static str,
}

/// Measured data for a shipped patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShippedData {
    /// The path of the patch in [`PATCHES`].
    pub patch: &'static str,
    /// The path of the CSV file in the repository, which is its address below `patches/`.
    pub path: &'static str,
    /// Its text, as it is in the file.
    pub text: &'static str,
    /// The text of the experiment that compares the patch with the data.
    experiment: &'static str,
}

/// The name of a group of the gallery.
const EXAMPLES: &str = "Examples with measured data";

/// The folders of the table, and the names of their groups in the gallery.
const GROUPS: [(&str, &str); 6] = [
    ("lessons/", "Lessons"),
    ("thesis/", "Figures of the thesis"),
    ("others/", "Machines of others"),
    ("problems/", "Problems with known solutions"),
    ("examples/05_missing_effect/", EXAMPLES),
    ("measured/", EXAMPLES),
];

/// The table of patches with these paths and lines, in these folders of the repository.
macro_rules! patches {
    ($($folder:literal: [$($path:literal => $line:literal),* $(,)?]),* $(,)?) => {
        &[$($(ShippedPatch {
            path: $path,
            line: $line,
            text: include_str!(concat!("../../../", $folder, $path)),
        }),*),*]
    };
}

/// The table of measured data: the folder in the repository, the name of the patch, that of the data, and that of the
/// experiment.
macro_rules! measured {
    ($($folder:literal: $patch:literal, $data:literal, $experiment:literal);* $(;)?) => {
        &[$(ShippedData {
            patch: concat!($folder, $patch),
            path: concat!($folder, $data),
            text: include_str!(concat!("../../../", $folder, $data)),
            experiment: include_str!(concat!("../../../", $folder, $experiment)),
        }),*]
    };
}

/// All lessons, figures, machines of others, problems and patches for measured data, in the order of the gallery.
/// Lessons have the order and the lines of docs/lessons.md.
pub const PATCHES: &[ShippedPatch] = patches![
    "patches/": [
        "lessons/mass-and-spring.json" => "two integrators in a ring, scaling, the error of a time step",
        "lessons/driven-oscillator.json" => "a drive, damping, resonance",
        "lessons/two-phase-oscillator.json" => "diodes that limit an amplitude",
        "lessons/van-der-pol.json" => "multipliers, a limit cycle, machine time",
        "lessons/lorenz.json" => "chaos, and which of its results are reliable",
        "lessons/mathieu.json" => "a drive that changes a coefficient",
        "lessons/predator-and-prey.json" => "a problem outside mechanics",
        "lessons/bouncing-ball.json" => "impacts: an integrator whose output is reversed",
        "lessons/projectile.json" => "four multipliers and a root: drag; a run of several phases",
        "lessons/square-root-and-division.json" => "amplifiers that compute an inverse function",
        "lessons/heat-rod.json" => "a macro used six times; space divided into cells",
        "lessons/relay-thermostat.json" => "a relay with hysteresis; a slow problem on a fast machine",
        "lessons/stick-slip.json" => "true friction: an integrator with a brake",
        "thesis/fig-4-07.json" => "Fig 4.7: the table oscillates where friction falls with velocity",
        "thesis/fig-8-04.json" => "Fig 8.4: a mass on a spring, driven by a step, decays as the equation says",
        "thesis/fig-8-05.json" => "Fig 8.5: two biased diodes make a dead zone",
        "thesis/fig-8-06.json" => "Fig 8.6: the bias of the diodes sets the width of the dead zone",
        "thesis/fig-8-07.json" => "Fig 8.7: the table stops away from its command, as with constant friction",
        "thesis/fig-8-09.json" => "Fig 8.9: friction falls along a straight line to a constant level",
        "thesis/fig-8-11.json" => "Fig 8.11: the table sticks and slips below a critical velocity",
        "thesis/fig-8-14.json" => "Fig 8.14: a multiplier makes friction fall along a square law",
        "thesis/fig-8-15.json" => "Fig 8.15: friction follows velocity with a lag, which a sine shows",
        "thesis/fig-8-16.json" => "Fig 8.16: friction has a memory, and the profile is that of Fig 8.24",
        "thesis/fig-8-16-coulomb.json" => "Fig 8.16 with a brake, which holds the table at rest exactly",
        "thesis/fig-8-16-lag-last.json" => "Fig 8.16 with the lag after the multiplier, which the author tried",
        "thesis/fig-8-16-both.json" => "Fig 8.16 twice: the dead zone and the brake follow the same command",
        "thesis/fig-8-17.json" => "Fig 8.17: the blocks of Fig 8.16, with one or two elements each",
        "others/nakashima.json" => "relays that apply friction, and multipliers as electronic pots",
        "others/singh.json" => "one slip as a linear equation, without friction that holds the table",
        "problems/dry-friction.json" => "half cycles about two centres, each smaller by the same amount",
        "problems/bouncing-ball.json" => "parabolas whose durations are a geometric series",
        "problems/saturated-integrator.json" => "an integral that stays at a limit until its input reverses",
        "problems/relay-oscillator.json" => "exponentials between two levels, with a known period",
        "problems/three-masses.json" => "three modes with known frequencies",
    ],
    "": [
        "examples/05_missing_effect/spring.json" => "a spring without damping, and measurements of one with damping",
        "examples/05_missing_effect/slide.json" => "the measured force is the drive, and the position sensor has an offset",
    ],
    "patches/": [
        "measured/emps.json" => "a slide without friction; it needs the public data DATA_EMPS.mat (docs/measured.md)",
        "measured/emps-friction.json" =>
            "the same friction in both directions; it needs the public data DATA_EMPS.mat (docs/measured.md)",
        "measured/emps-asymmetric.json" =>
            "friction by direction; it needs the public data DATA_EMPS_PULSES.mat (docs/measured.md)",
        "measured/cascaded-tanks.json" =>
            "tanks that do not overflow; it needs the public data dataBenchmark.csv (docs/measured.md)",
    ],
];

/// The data for those patches of [`PATCHES`] whose measurements are in the repository.
pub const DATA: &[ShippedData] = measured![
    "examples/05_missing_effect/": "spring.json", "measured.csv", "spring.experiment.json";
    "examples/05_missing_effect/": "slide.json", "slide.csv", "slide.experiment.json";
];

/// The gallery as a document: for each patch its path, title, line, group, picture, machine, duration in problem
/// seconds, note and source. For a patch with measured data also the path of the data and the experiment; otherwise both
/// are null.
///
/// # Panics
/// Never: a test makes the gallery.
pub fn gallery() -> Value {
    PATCHES.iter().map(entry).collect()
}

/// The entry of a patch in the gallery.
fn entry(shipped: &ShippedPatch) -> Value {
    let patch = Patch::parse(shipped.path, shipped.text).expect("the file is a patch");
    let group = GROUPS.iter().find(|(folder, _)| shipped.path.starts_with(folder));
    let data = DATA.iter().find(|data| data.patch == shipped.path);
    json!({
        "path": shipped.path,
        "title": patch.title,
        "line": shipped.line,
        "group": group.map_or("", |(_, name)| *name),
        "picture": picture(shipped.path),
        "machine": wiring::machine(&patch).title,
        "duration": patch.run.longest_repetition(),
        "note": patch.note,
        "source": patch.source,
        "data": data.map(|data| data.path),
        "experiment": data.map(experiment),
    })
}

/// The experiment of measured data as a comparison takes it: without the names of the files. A column that is only
/// named becomes an object with its name.
fn experiment(data: &ShippedData) -> Map<String, Value> {
    let mut experiment: Map<String, Value> =
        serde_json::from_str(data.experiment).expect("the file is an experiment");
    experiment.retain(|key, _| key != "patch" && key != "data");
    for kind in ["drives", "outputs"] {
        let columns = experiment.get_mut(kind).and_then(Value::as_object_mut);
        for column in columns.into_iter().flat_map(Map::values_mut).filter(|column| column.is_string()) {
            *column = json!({ "column": column.take() });
        }
    }
    experiment
}

/// The path of the picture of a patch among the pages.
fn picture(path: &str) -> String {
    format!("pictures/{}.svg", path.trim_end_matches(".json"))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};

    use super::*;
    use crate::pages::PAGES;

    /// The paths in the table that begin with this folder.
    fn listed(folder: &str) -> Vec<&'static str> {
        PATCHES.iter().map(|patch| patch.path).filter(|path| path.starts_with(folder)).collect()
    }

    /// The folder of the repository in which the files of a group are.
    fn on_disk(folder: &str) -> PathBuf {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let is_example = folder.starts_with("examples/");
        if is_example { root.join(folder) } else { root.join("patches").join(folder) }
    }

    /// The names of the files in the folder of a group, in alphabetical order, with the folder in front.
    fn files(folder: &str) -> Vec<String> {
        let entries = fs::read_dir(on_disk(folder)).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<_> = entries.map(|name| format!("{folder}{}", name.to_str().unwrap())).collect();
        names.sort();
        names
    }

    #[test]
    fn the_table_has_all_patches_of_its_folders() {
        let is_patch = |name: &String| name.ends_with(".json") && !name.ends_with(".experiment.json");
        for (folder, _) in GROUPS {
            let mut listed = listed(folder);
            listed.sort_unstable();
            assert_eq!(listed, files(folder).into_iter().filter(is_patch).collect::<Vec<_>>());
        }
    }

    #[test]
    fn the_table_of_data_has_every_experiment_of_the_examples() {
        let experiments = files("examples/05_missing_effect/");
        let experiments = experiments.iter().filter(|name| name.ends_with(".experiment.json")).count();
        assert_eq!((DATA.len(), experiments), (2, 2));
        for data in DATA {
            assert!(PATCHES.iter().any(|patch| patch.path == data.patch), "{}", data.patch);
            let document: Value = serde_json::from_str(data.experiment).unwrap();
            for (key, path) in [("patch", data.patch), ("data", data.path)] {
                assert_eq!(document[key].as_str(), path.rsplit('/').next());
            }
        }
    }

    #[test]
    fn the_gallery_has_the_experiments_of_measured_data() {
        let gallery = gallery();
        let entry =
            |path: &str| gallery.as_array().unwrap().iter().find(|entry| entry["path"] == path).unwrap();
        let spring = entry("examples/05_missing_effect/spring.json");
        assert_eq!(spring["data"], "examples/05_missing_effect/measured.csv");
        let expected = json!({
            "title": "A mass on a spring, released at 50 mm", "outputs": {"x": {"column": "x"}}, "fit": ["k"]
        });
        assert_eq!(spring["experiment"], expected);
        let slide = entry("examples/05_missing_effect/slide.json");
        let expected = json!({
            "title": "A table that a motor pushes", "time": "t", "drives": {"F": {"column": "force"}},
            "outputs": {"x": {"column": "position", "sigma": 0.2, "unit": "mm", "offset": true}},
            "fit": ["M", "f"], "train": [0, 5], "test": [5, 8]
        });
        assert_eq!(slide["experiment"], expected);
        let lesson = entry("lessons/lorenz.json");
        assert_eq!((&lesson["data"], &lesson["experiment"]), (&Value::Null, &Value::Null));
    }

    #[test]
    fn a_patch_for_data_of_others_names_them() {
        let page = fs::read_to_string("../../docs/measured.md").unwrap();
        let needing = PATCHES.iter().filter(|patch| patch.path.starts_with("measured/"));
        for patch in needing {
            let (_, rest) = patch.line.split_once("it needs the public data ").unwrap();
            let name = rest.strip_suffix(" (docs/measured.md)").unwrap();
            assert!(page.contains(&format!("`{name}`")), "{name}");
            // The data are not part of the repository.
            assert!(DATA.iter().all(|data| data.patch != patch.path), "{}", patch.path);
        }
    }

    #[test]
    fn groups_are_together_and_in_order() {
        let grouped: Vec<_> = GROUPS.iter().flat_map(|(folder, _)| listed(folder)).collect();
        assert_eq!(grouped, listed(""));
    }

    #[test]
    fn lessons_have_the_order_and_the_lines_of_their_page() {
        let page = fs::read_to_string("../../docs/lessons.md").unwrap();
        let rows = page.lines().filter_map(|line| line.strip_prefix("| [")?.strip_suffix(" |"));
        let rows = rows.map(|row| {
            let (name, rest) = row.split_once("](#").unwrap();
            (format!("lessons/{name}.json"), rest.split_once(" | ").unwrap().1)
        });
        let lessons = PATCHES.iter().filter(|patch| patch.path.starts_with("lessons/"));
        let lessons: Vec<_> = lessons.map(|patch| (patch.path.to_owned(), patch.line)).collect();
        assert_eq!(rows.collect::<Vec<_>>(), lessons);
    }

    #[test]
    fn the_gallery_has_an_entry_for_every_patch() {
        let gallery = gallery();
        let entries = gallery.as_array().unwrap();
        assert_eq!(entries.len(), PATCHES.len());
        for entry in entries {
            for key in ["path", "title", "line", "group", "picture", "machine", "source"] {
                // The patches of examples are ours, and have no other source.
                let is_own = key == "source" && entry["data"].is_string();
                assert!(is_own || entry[key] != "", "{key} of {}", entry["path"]);
            }
            assert!(entry["duration"].as_f64().unwrap() > 0.0, "{}", entry["path"]);
            assert!(PAGES.iter().any(|page| page.path == entry["picture"]), "{}", entry["picture"]);
        }
        assert!(entries[0]["machine"].as_str().unwrap().starts_with("Solartron 1451"));
    }
}
