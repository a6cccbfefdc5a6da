//! Compares the voltages of many random patches without integrators with an enumeration of all linear cases.
//!
//! `cargo bench -p patchcord-core --bench loops` prints a table, and fails if a patch differs. A number as argument is
//! the seed.

#[path = "../tests/common/mod.rs"]
mod common;

use std::process::ExitCode;
use std::time::Instant;

use common::curved_patches::{self, CurvedTally};
use common::static_patches::{Tally, compare_random, random_count, random_patch, random_summers};

fn main() -> ExitCode {
    let seed = std::env::args().find_map(|argument| argument.parse().ok()).unwrap_or(53);
    println!(
        "patches                      number  one solution  refused  rounding decides  different  seconds"
    );
    let static_patches = report("static, 2 to 6 elements", 12_000, |cases| {
        compare_random(seed, cases, |random| {
            let count = random_count(random, 2, 6);
            random_patch(random, count)
        })
    });
    let summers = report("systems of 2 to 8 summers", 4_000, |cases| {
        compare_random(seed + 1, cases, |random| {
            let count = random_count(random, 2, 8);
            random_summers(random, count)
        })
    });
    let start = Instant::now();
    let curved = curved_patches::check_random(seed + 2, 4_000);
    let CurvedTally { solved, refused, wrong } = &curved;
    println!(
        "\nwith products and squares: {solved} solved, {refused} refused, {} wrong, {:.1} s",
        wrong.len(),
        start.elapsed().as_secs_f64()
    );
    wrong.iter().take(5).for_each(|text| println!("{text}\n"));
    if static_patches && summers && wrong.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Prints a row of the table, and the patches that differ. Returns whether there are none.
fn report(what: &str, cases: usize, compare: impl FnOnce(usize) -> Tally) -> bool {
    let start = Instant::now();
    let tally = compare(cases);
    println!(
        "{what:28} {cases:6}  {:12}  {:7}  {:16}  {:9}  {:7.1}",
        tally.equal,
        tally.refused,
        tally.borderline,
        tally.different.len(),
        start.elapsed().as_secs_f64()
    );
    tally.different.iter().take(5).for_each(|text| println!("{text}\n"));
    tally.different.is_empty()
}
