//! docs/sweep.md shows the output of its command.

use std::fs;
use std::process::Command;

const PAGE: &str = "docs/sweep.md";
const MARKS: [&str; 2] = ["<!-- rows -->\n```\n", "```\n<!-- end of rows -->"];

/// The command of the page's example, joined to one line.
fn command(page: &str) -> Vec<String> {
    let from = page.find("    patchcord sweep").unwrap();
    let lines = page[from..].lines().take_while(|line| !line.trim().is_empty());
    let text: String = lines.map(|line| line.trim().trim_end_matches('\\').to_owned() + " ").collect();
    text.split_whitespace().skip(1).map(str::to_owned).collect()
}

/// Whether two tables are equal up to rounding errors.
fn are_equal(one: &str, other: &str) -> bool {
    let cells = |table: &str| table.split_inclusive([',', '\n']).map(str::to_owned).collect::<Vec<_>>();
    let number = |cell: &str| cell.trim_end_matches([',', '\n']).parse::<f64>();
    let (one, other) = (cells(one), cells(other));
    let alike = |(one, other): (&String, &String)| match (number(one), number(other)) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-9 * b.abs(),
        _ => one == other,
    };
    one.len() == other.len() && one.iter().zip(&other).all(alike)
}

#[test]
#[ignore = "takes several seconds: nine runs of 8 s"]
fn the_page_shows_the_rows_of_its_command() {
    let page = fs::read_to_string(PAGE).unwrap();
    let ran = Command::new(env!("CARGO_BIN_EXE_patchcord")).args(command(&page)).output().unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let found = String::from_utf8(ran.stdout).unwrap();
    let (before, rest) = page.split_once(MARKS[0]).unwrap();
    let (stored, after) = rest.split_once(MARKS[1]).unwrap();
    if std::env::var_os("PATCHCORD_BLESS").is_some() {
        fs::write(PAGE, format!("{before}{}{found}{}{after}", MARKS[0], MARKS[1])).unwrap();
    } else {
        assert!(
            are_equal(stored, &found),
            "{PAGE} is stale: PATCHCORD_BLESS=1 cargo test -p patchcord rewrites it\n{found}"
        );
    }
}
