//! A sweep that is killed and gone on with ends with the bytes of one that never was.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{fs, thread};

use crate::common::dice::Dice;

const RUNS: usize = 1500;
const KILLS: usize = 10;

fn command(out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_patchcord"));
    command.args(["sweep", "patches/lessons/mass-and-spring.json", "--for", "3", "--step", "1e-4"]);
    command.args(["--vary", &format!("k=10:90:{}", RUNS / 3), "--vary", "m=1,2,4", "--measure", "peak:v"]);
    command.args(["--measure", "voltmeter:x", "--threads", "2", "--out"]).arg(out);
    command.stdout(Stdio::null()).stderr(Stdio::inherit());
    command
}

fn length(file: &Path) -> u64 {
    fs::metadata(file).map_or(0, |there| there.len())
}

#[test]
#[ignore = "takes several seconds"]
fn killed_at_ten_instants_it_ends_with_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, killed] = ["whole.csv", "killed.csv"].map(|name| folder.path().join(name));
    assert!(command(&whole).status().unwrap().success());
    let wanted = fs::read(&whole).unwrap();
    let rows =
        wanted.split(|byte| *byte == b'\n').filter(|line| line.first().is_some_and(u8::is_ascii_digit));
    assert_eq!(rows.count(), RUNS);
    let mut dice = Dice(816);
    let mut cut_short = 0;
    for _ in 0..KILLS {
        // An instant somewhere on the way, the more rows the later.
        let until = length(&killed) + (dice.even(0.0, 1.0) * wanted.len() as f64 / KILLS as f64) as u64;
        let mut child = command(&killed).spawn().unwrap();
        while length(&killed) < until && child.try_wait().unwrap().is_none() {
            thread::sleep(Duration::from_micros(100));
        }
        thread::sleep(Duration::from_micros(dice.even(0.0, 3000.0) as u64));
        child.kill().unwrap();
        child.wait().unwrap();
        let found = fs::read(&killed).unwrap_or_default();
        assert!(wanted.starts_with(&found), "what was written differs");
        cut_short += usize::from(!found.is_empty() && found.len() < wanted.len());
    }
    assert!(cut_short > KILLS / 2, "{cut_short}");
    assert!(command(&killed).status().unwrap().success());
    assert!(fs::read(&killed).unwrap() == wanted, "the bytes differ");
    // Done, it has nothing left to do.
    assert!(command(&killed).status().unwrap().success());
    assert!(fs::read(&killed).unwrap() == wanted);
}
