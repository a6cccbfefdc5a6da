//! Random inputs of every kind for the command: no panic, no hang, at most 1 GB of memory.
//!
//!     cargo bench --bench fuzz                            cases for one minute
//!     cargo bench --bench fuzz -- --minutes 60 --seed 7   cases of another seed for an hour
//!     cargo bench --bench fuzz -- --seed 7 --case 816     one case
//!
//! A case that breaks a rule is printed, and its files are written into a folder `fuzz` in the build directory. The
//! file command.txt in it has the command line. The benchmark fails if there is such a case. `tests/fuzz` has the
//! rules.

#[path = "../../crates/core/tests/common/mod.rs"]
mod common;
#[path = "../../tests/fuzz/mod.rs"]
mod fuzz;

use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use fuzz::case::Case;
use fuzz::corpus::Corpus;
use fuzz::trials::{Summary, run_cases};

/// The options of the command line.
struct Options {
    /// The time after which no case begins.
    time: Duration,
    /// The seed of the cases.
    seed: u64,
    /// The number of the only case. `None` for all cases.
    case: Option<u64>,
}

/// Reads the command line.
fn options() -> Result<Options, Box<dyn std::error::Error>> {
    let mut options = Options { time: Duration::from_secs(60), seed: 7, case: None };
    let mut words = std::env::args().skip(1).filter(|word| word != "--bench");
    while let Some(option) = words.next() {
        let value = words.next().ok_or_else(|| format!("{option} needs a number"))?;
        match option.as_str() {
            "--minutes" => options.time = Duration::try_from_secs_f64(60.0 * value.parse::<f64>()?)?,
            "--seed" => options.seed = value.parse()?,
            "--case" => options.case = Some(value.parse()?),
            _ => return Err(format!("{option} is unknown: use --minutes, --seed or --case").into()),
        }
    }
    Ok(options)
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let Options { time, seed, case } = options()?;
    let corpus = Corpus::load(true);
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
    let (start, count) = (Instant::now(), AtomicU64::new(0));
    let next = || {
        let number = count.fetch_add(1, Ordering::Relaxed);
        match case {
            Some(case) => (number == 0).then_some(case),
            None => (start.elapsed() < time).then_some(number),
        }
    };
    let make = |number| Case::new(&corpus, seed, number);
    let summary = run_cases(&seed.to_string(), &make, &kept, &next);
    let Summary { cases, commands, skipped, longest, violations } = summary;
    let broken = violations.len();
    println!("seed {seed}: {cases} cases, {skipped} skipped, {broken} break a rule");
    for (command, [accepted, all]) in commands {
        println!("{command}: {accepted} of {all} accepted");
    }
    println!("the longest command took {:.1} s (case {})", longest.0.as_secs_f64(), longest.1);
    Ok(if violations.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
