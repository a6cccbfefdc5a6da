//! The patches of the repository, as texts in the program, and the gallery that lists them.
//!
//! Their files are in the folder `patches` of the repository, outside of this crate. The crate is built as a part of the
//! repository and is not published, so its table may include them from there.

use patchcord_core::patch::Patch;
use serde_json::{Value, json};

use crate::wiring;

/// A patch of the repository.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShippedPatch {
    /// Its path in the folder `patches`, which is its address below `patches/`: "lessons/lorenz.json".
    pub path: &'static str,
    /// What it shows, in one line.
    pub line: &'static str,
    /// Its text, as it is in the file.
    pub text: &'static str,
}

/// The folders of the table, and the names of their groups in the gallery.
const GROUPS: [(&str, &str); 4] = [
    ("lessons/", "Lessons"),
    ("thesis/", "Figures of the thesis"),
    ("others/", "Machines of others"),
    ("problems/", "Problems with known solutions"),
];

/// The table of patches with these paths and lines.
macro_rules! patches {
    ($($path:literal => $line:literal),* $(,)?) => {
        &[$(ShippedPatch {
            path: $path,
            line: $line,
            text: include_str!(concat!("../../../patches/", $path)),
        }),*]
    };
}

/// All lessons, figures, machines of others and problems, in the order of the gallery. Lessons have the order and the
/// lines of docs/lessons.md.
pub const PATCHES: &[ShippedPatch] = patches![
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
];

/// The gallery as a document: for each patch its path, title, line, group, picture, machine, duration in problem
/// seconds, note and source.
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
    })
}

/// The path of the picture of a patch among the pages.
fn picture(path: &str) -> String {
    format!("pictures/{}.svg", path.trim_end_matches(".json"))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;
    use crate::pages::PAGES;

    /// The paths in the table that begin with this folder.
    fn listed(folder: &str) -> Vec<&'static str> {
        PATCHES.iter().map(|patch| patch.path).filter(|path| path.starts_with(folder)).collect()
    }

    #[test]
    fn the_table_has_all_patches_of_its_folders() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../patches");
        for (folder, _) in GROUPS {
            let entries = fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().file_name());
            let mut found: Vec<_> =
                entries.map(|name| format!("{folder}{}", name.to_str().unwrap())).collect();
            found.sort();
            let mut listed = listed(folder);
            listed.sort_unstable();
            assert_eq!(listed, found);
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
                assert_ne!(entry[key].as_str().unwrap(), "", "{key} of {}", entry["path"]);
            }
            assert!(entry["duration"].as_f64().unwrap() > 0.0, "{}", entry["path"]);
            assert!(PAGES.iter().any(|page| page.path == entry["picture"]), "{}", entry["picture"]);
        }
        assert!(entries[0]["machine"].as_str().unwrap().starts_with("Solartron 1451"));
    }
}
