//! docs/panel-protocol.md has every command, every event and the layout of a frame.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use patchcord_panel::command::Command;

/// The text of a file of the repository.
fn text(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)).unwrap()
}

/// The first cells of the table below a heading, without backquotes.
fn rows(page: &str, heading: &str) -> BTreeSet<String> {
    let section = page.split(&format!("\n## {heading}\n")).nth(1).unwrap();
    let section = section.split("\n## ").next().unwrap();
    let cells = section.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    cells.map(str::to_owned).collect()
}

#[test]
fn the_page_has_every_command() {
    // The message about an unknown word lists all that are known.
    let message = serde_json::from_str::<Command>("\"?\"").unwrap_err().to_string();
    let known = message.split("one of ").nth(1).unwrap();
    let known = known.split('`').skip(1).step_by(2).map(str::to_owned).collect::<BTreeSet<_>>();
    assert!(known.contains("advance") && known.len() > 20, "{known:?}");
    assert_eq!(rows(&text("docs/panel-protocol.md"), "Commands"), known);
}

#[test]
fn the_page_has_every_event() {
    let source = text("crates/panel/src/event.rs");
    let body = source.split("pub enum Event {").nth(1).unwrap().split("\n}\n").next().unwrap();
    let variants = body.lines().filter_map(|line| line.strip_prefix("    "));
    let variants = variants.filter(|line| line.starts_with(|letter: char| letter.is_ascii_uppercase()));
    let names = variants.map(|line| {
        let name: String = line.chars().take_while(char::is_ascii_alphanumeric).collect();
        let words = name.split_inclusive(|_: char| true).map(|letter| match letter {
            upper if upper.chars().all(char::is_uppercase) => format!("-{}", upper.to_lowercase()),
            lower => lower.to_owned(),
        });
        words.collect::<String>().trim_start_matches('-').to_owned()
    });
    assert_eq!(rows(&text("docs/panel-protocol.md"), "Events"), names.collect());
}

#[test]
fn the_page_has_the_layout_of_a_frame() {
    let source = text("crates/panel/src/frame.rs");
    let layout = source.lines().skip_while(|line| *line != "//! ```text").skip(1);
    let layout =
        layout.take_while(|line| *line != "//! ```").map(|line| line.trim_start_matches("//!").trim());
    let page = text("docs/panel-protocol.md");
    for line in layout {
        assert!(page.contains(line), "{line}");
    }
}
