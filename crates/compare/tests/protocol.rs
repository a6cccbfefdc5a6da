//! docs/panel-protocol.md has every command and every event of a comparison, and its limits.

use std::collections::BTreeSet;

use patchcord_compare::command::Command;
use patchcord_compare::limits;

use crate::files::text;

/// The part of the page below a heading of the comparison.
fn section(heading: &str) -> String {
    let page = text("docs/panel-protocol.md");
    let comparison = page.split("\n## The comparison with measured data\n").nth(1).unwrap();
    let section = comparison.split(&format!("\n### {heading}\n")).nth(1).unwrap();
    section.split("\n##").next().unwrap().to_owned()
}

/// The first cells of the table below a heading, without backquotes.
fn rows(heading: &str) -> BTreeSet<String> {
    let section = section(heading);
    let cells = section.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    cells.map(str::to_owned).collect()
}

#[test]
fn the_page_has_every_command() {
    // The message about an unknown word lists all that are known.
    let message = serde_json::from_str::<Command>("\"?\"").unwrap_err().to_string();
    let known = message.split("one of ").nth(1).unwrap();
    let known = known.split('`').skip(1).step_by(2).map(str::to_owned).collect::<BTreeSet<_>>();
    assert!(known.contains("search"), "{known:?}");
    assert_eq!(rows("Commands of a comparison"), known);
}

#[test]
fn the_page_has_every_event() {
    let source = text("crates/compare/src/event.rs");
    let body = source.split("pub enum Event {").nth(1).unwrap().split("\n}\n").next().unwrap();
    let variants = body.lines().filter_map(|line| line.strip_prefix("    "));
    let variants = variants.filter(|line| line.starts_with(|letter: char| letter.is_ascii_uppercase()));
    // All names are one word.
    let names = variants.map(|line| {
        line.chars().take_while(char::is_ascii_alphabetic).collect::<String>().to_ascii_lowercase()
    });
    let names: BTreeSet<String> = names.collect();
    assert!(names.contains("columns") && names.contains("refused"), "{names:?}");
    assert_eq!(rows("Events of a comparison"), names);
}

#[test]
fn the_page_has_the_limits() {
    let section = section("Limits of a comparison");
    let numbers = [
        format!("{} MB, {} commands", limits::MAX_REQUEST_BYTES / 1_000_000, limits::MAX_COMMANDS),
        format!("{} characters", limits::MAX_NAME_CHARACTERS),
        format!("{} MB |", limits::MAX_PATCH_BYTES / 1_000_000),
        limits::MAX_ELEMENTS.to_string(),
        limits::MAX_FINDINGS.to_string(),
    ];
    for number in numbers {
        assert!(section.contains(&number), "{number}");
    }
    assert_eq!(limits::MAX_CELLS, 1_000_000);
    assert!(section.contains("| 1,000,000 |"));
}
