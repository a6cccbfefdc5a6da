//! A sweep that is killed and continued writes the same bytes as an uninterrupted one.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{fs, thread};

use crate::common::random::SplitMix64;

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
    fs::metadata(file).map_or(0, |metadata| metadata.len())
}

#[test]
#[ignore = "takes several seconds"]
fn ten_kills_do_not_change_the_result() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, killed] = ["whole.csv", "killed.csv"].map(|name| folder.path().join(name));
    assert!(command(&whole).status().unwrap().success());
    let wanted = fs::read(&whole).unwrap();
    let rows =
        wanted.split(|byte| *byte == b'\n').filter(|line| line.first().is_some_and(u8::is_ascii_digit));
    assert_eq!(rows.count(), RUNS);
    let mut random = SplitMix64(816);
    let mut cut_short = 0;
    for _ in 0..KILLS {
        // Kill after a random number of rows; later kills allow more rows.
        let until = length(&killed) + (random.uniform(0.0, 1.0) * wanted.len() as f64 / KILLS as f64) as u64;
        let mut child = command(&killed).spawn().unwrap();
        while length(&killed) < until && child.try_wait().unwrap().is_none() {
            thread::sleep(Duration::from_micros(100));
        }
        thread::sleep(Duration::from_micros(random.uniform(0.0, 3000.0) as u64));
        child.kill().unwrap();
        child.wait().unwrap();
        let found = fs::read(&killed).unwrap_or_default();
        assert!(wanted.starts_with(&found), "the written rows differ");
        cut_short += usize::from(!found.is_empty() && found.len() < wanted.len());
    }
    assert!(cut_short > KILLS / 2, "{cut_short}");
    assert!(command(&killed).status().unwrap().success());
    assert!(fs::read(&killed).unwrap() == wanted, "the bytes differ");
    // Another call has nothing to do.
    assert!(command(&killed).status().unwrap().success());
    assert!(fs::read(&killed).unwrap() == wanted);
}
