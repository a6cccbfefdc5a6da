//! The manual pages.

use std::fs;
use std::process::{Command, Stdio};

use super::{code, errors, out, patchcord, path};

/// The first word of each line in a section of a help text.
fn listed(help: &str, section: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| *line != section).skip(1).take_while(|line| !line.is_empty());
    lines.filter_map(|line| line.split_whitespace().next().map(str::to_owned)).collect()
}

/// The commands that the help text lists.
fn commands() -> Vec<String> {
    let mut commands = listed(&out(&patchcord(&["--help"])), "Commands:");
    commands.retain(|command| command != "help");
    assert!(commands.len() >= 7, "{commands:?}");
    commands
}

/// The text of a page without the escapes of hyphens.
fn plain(page: &str) -> String {
    page.replace("\\-", "-")
}

#[test]
fn the_page_of_patchcord_lists_every_command() {
    let page = out(&patchcord(&["man"]));
    assert!(page.contains(".TH patchcord 1"), "{page}");
    for section in ["NAME", "SYNOPSIS", "DESCRIPTION", "SUBCOMMANDS"] {
        assert!(page.contains(&format!(".SH {section}\n")), "{section}");
    }
    for command in commands() {
        assert!(plain(&page).contains(&format!("patchcord-{command}(1)")), "{command}");
    }
}

#[test]
fn a_synopsis_shows_the_values_of_options() {
    let page = plain(&out(&patchcord(&["man", "run"])));
    let synopsis = page.split(".SH SYNOPSIS\n").nth(1).unwrap().lines().next().unwrap();
    for part in ["[--for <SECONDS>] ", "[--set <NAME=VALUE>] ", "[--json] ", " <PATCH>"] {
        assert!(synopsis.contains(part), "{part}: {synopsis}");
    }
}

#[test]
fn the_page_of_a_command_lists_all_its_options() {
    for command in commands() {
        let page = plain(&out(&patchcord(&["man", &command])));
        let help = out(&patchcord(&[&command, "--help"]));
        let options = help.split_whitespace().filter(|word| word.starts_with("--"));
        for option in options.map(|option| option.trim_matches([',', '.', ')', ']', ':'])) {
            assert!(page.contains(option), "{command} has no {option}: {page}");
        }
    }
}

#[test]
fn all_pages_are_written_into_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let pages = path(&folder, "share/man1");
    let made = patchcord(&["man", "--out", &pages]);
    assert_eq!((code(&made), errors(&made).as_str()), (0, ""));
    assert_eq!(fs::read_dir(&pages).unwrap().count(), 1 + commands().len());
    let page = fs::read_to_string(format!("{pages}/patchcord-run.1")).unwrap();
    assert_eq!(page, out(&patchcord(&["man", "run"])));
}

/// Skipped if groff is not installed.
#[test]
fn groff_formats_all_pages_without_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let pages = path(&folder, "man1");
    assert_eq!(code(&patchcord(&["man", "--out", &pages])), 0);
    for entry in fs::read_dir(&pages).unwrap() {
        let page = entry.unwrap().path();
        let mut groff = Command::new("groff");
        let set = groff.args(["-man", "-Tascii", "-ww", "-z"]).arg(&page);
        let Ok(set) = set.stdin(Stdio::null()).output() else { return };
        assert_eq!((code(&set), errors(&set).as_str()), (0, ""), "{}", page.display());
    }
}
