//! How long the scaling of a problem takes.
//!
//!     cargo bench -p patchcord-equations --bench scaling
//!
//! The benchmark fails if the circuit of Fig 8.16 takes 1 s or more, or a rod of 100 states 5 s or more.

#[path = "../../tests/rod.rs"]
mod rod;

use std::process::ExitCode;
use std::time::Instant;

use patchcord_core::patch::Problem;
use patchcord_equations::{ScaleOptions, scale_problem};

/// The slideway of Fig 8.16.
const SLIDEWAY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../problems/slideway.json");
/// The run of the rod, up to its straight profile.
const RUN: &str = r#"{"for": 20000, "step": 0.2, "every": 10000}"#;

/// The seconds that the scaling of a problem takes.
fn seconds(problem: &Problem) -> f64 {
    let start = Instant::now();
    scale_problem(problem, &ScaleOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    start.elapsed().as_secs_f64()
}

fn main() -> ExitCode {
    let slideway = Problem::read(SLIDEWAY).unwrap_or_else(|error| panic!("{error}"));
    let cases = [("Fig 8.16", slideway, 1.0), ("rod of 100 states", rod::rod(100, RUN), 5.0)];
    let mut is_fast = true;
    for (name, problem, most) in cases {
        let seconds = seconds(&problem);
        println!("{name:20} {seconds:.3} s (less than {most} s)");
        is_fast &= seconds < most;
    }
    if is_fast { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
