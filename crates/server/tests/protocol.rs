//! docs/panel-protocol.md has every command, every event and the limits of both sessions, and the layout of a frame.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use patchcord_compare::{command::Command as CompareCommand, limits as compare_limits};
use patchcord_panel::{command::Command as PanelCommand, limits as panel_limits};

/// The end of the row about the values in a request.
const VALUES: &str = "count | 500,000 |";

/// The text of a file of the repository.
fn text(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)).unwrap()
}

/// The part of the page below a heading, up to the next one.
fn section(heading: &str) -> String {
    let page = text("docs/panel-protocol.md");
    let section = page.split(&format!("# {heading}\n")).nth(1).unwrap_or_else(|| panic!("no {heading}"));
    section.split("\n#").next().unwrap().to_owned()
}

/// The first cells of the table below a heading, without backquotes.
fn rows(heading: &str) -> BTreeSet<String> {
    let section = section(heading);
    let cells = section.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    cells.map(str::to_owned).collect()
}

/// The names of all commands, from the message about an unknown one, which lists them.
fn known_commands(error: &serde_json::Error) -> BTreeSet<String> {
    let message = error.to_string();
    let known = message.split("one of ").nth(1).unwrap();
    known.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// A name of a variant as the protocol has it: "static-check" for "StaticCheck".
fn kebab_case(name: &str) -> String {
    let words = name.chars().flat_map(|letter| {
        let hyphen = letter.is_ascii_uppercase().then_some('-');
        hyphen.into_iter().chain([letter.to_ascii_lowercase()])
    });
    words.collect::<String>().trim_start_matches('-').to_owned()
}

/// The names of all events of a crate, from its source.
fn known_events(source: &str) -> BTreeSet<String> {
    let source = text(source);
    let body = source.split("pub enum Event {").nth(1).unwrap().split("\n}\n").next().unwrap();
    let variants = body.lines().filter_map(|line| line.strip_prefix("    "));
    let variants = variants.filter(|line| line.starts_with(|letter: char| letter.is_ascii_uppercase()));
    let name = |line: &str| line.chars().take_while(char::is_ascii_alphanumeric).collect::<String>();
    variants.map(|line| kebab_case(&name(line))).collect()
}

/// Checks that the table below a heading has each of these texts.
fn assert_limits(heading: &str, limits: &[String]) {
    let section = section(heading);
    for limit in limits {
        assert!(section.contains(limit), "{heading}: {limit}");
    }
}

/// A number of bytes in MB.
fn megabytes(bytes: usize) -> String {
    assert_eq!(bytes % 1_000_000, 0);
    format!("{} MB", bytes / 1_000_000)
}

#[test]
fn the_page_has_every_command() {
    let known = known_commands(&serde_json::from_str::<PanelCommand>("\"?\"").unwrap_err());
    assert!(known.contains("advance") && known.len() > 20, "{known:?}");
    assert_eq!(rows("Commands"), known);
    let known = known_commands(&serde_json::from_str::<CompareCommand>("\"?\"").unwrap_err());
    assert!(known.contains("search"), "{known:?}");
    assert_eq!(rows("Commands of a comparison"), known);
}

#[test]
fn the_page_has_every_event() {
    let known = known_events("crates/panel/src/event.rs");
    assert!(known.contains("static-check") && known.contains("refused"), "{known:?}");
    assert_eq!(rows("Events"), known);
    let known = known_events("crates/compare/src/event.rs");
    assert!(known.contains("columns") && known.contains("refused"), "{known:?}");
    assert_eq!(rows("Events of a comparison"), known);
}

#[test]
fn the_page_has_the_limits_of_a_panel() {
    use panel_limits::{
        MAX_COMMANDS, MAX_DELAY_BYTES, MAX_ELEMENTS, MAX_FINDINGS, MAX_LOOSE_CORDS, MAX_NAME_CHARACTERS,
        MAX_PATCH_BYTES, MAX_REQUEST_BYTES, MAX_TABLE_BYTES,
    };
    let rows = [
        format!("| a request | {}, {MAX_COMMANDS} commands |", megabytes(MAX_REQUEST_BYTES)),
        format!("| a name in a command | {MAX_NAME_CHARACTERS} characters |"),
        format!("| the text of a patch | {} |", megabytes(MAX_PATCH_BYTES)),
        format!("macros are expanded | {MAX_ELEMENTS} |"),
        format!("| loose cords | {MAX_LOOSE_CORDS} |"),
        format!("| findings in an event | {MAX_FINDINGS} |"),
        format!("equal steps times elements, {} |", megabytes(MAX_TABLE_BYTES)),
        format!("| the past that delays store | {}; ", megabytes(MAX_DELAY_BYTES)),
        VALUES.to_owned(),
        "| cords into elements | 20,000 |".to_owned(),
        "| points of all tables and curves | 1,000,000 |".to_owned(),
    ];
    assert_eq!(
        (panel_limits::MAX_VALUES, panel_limits::MAX_CORDS, panel_limits::MAX_POINTS),
        (500_000, 20_000, 1_000_000)
    );
    assert_limits("Limits", &rows);
}

#[test]
fn the_page_has_the_limits_of_a_comparison() {
    use compare_limits::{
        MAX_COMMANDS, MAX_ELEMENTS, MAX_FINDINGS, MAX_NAME_CHARACTERS, MAX_PATCH_BYTES, MAX_REQUEST_BYTES,
    };
    let rows = [
        format!("| a request | {}, {MAX_COMMANDS} commands |", megabytes(MAX_REQUEST_BYTES)),
        format!("| the name of a file | {MAX_NAME_CHARACTERS} characters |"),
        format!("| the text of a patch | {} |", megabytes(MAX_PATCH_BYTES)),
        format!("macros are expanded | {MAX_ELEMENTS} |"),
        format!("| findings in a message | {MAX_FINDINGS} |"),
        VALUES.to_owned(),
        "| cells of the data file | 1,000,000 |".to_owned(),
    ];
    assert_eq!(compare_limits::MAX_CELLS, 1_000_000);
    assert_limits("Limits of a comparison", &rows);
}

#[test]
fn the_page_has_the_layout_of_a_frame() {
    let source = text("crates/panel/src/frame.rs");
    let layout = source.lines().skip_while(|line| *line != "//! ```text").skip(1);
    let layout = layout.take_while(|line| *line != "//! ```");
    let layout: Vec<&str> = layout.map(|line| line.trim_start_matches("//!").trim()).collect();
    assert!(layout.len() > 20, "{layout:?}");
    let page = section("A frame");
    for line in layout {
        assert!(page.contains(line), "{line}");
    }
}
