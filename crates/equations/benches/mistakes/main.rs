//! Random mistakes in correct patches: are they detected, and do the first changes name the cause?
//!
//!     cargo bench -p patchcord-equations --bench mistakes                       one mistake in each of 200 patches
//!     cargo bench -p patchcord-equations --bench mistakes -- --seed 7           other mistakes
//!     cargo bench -p patchcord-equations --bench mistakes -- --patches 50       fewer patches
//!     cargo bench -p patchcord-equations --bench mistakes -- --seed 7 --case 31 one case
//!
//! The correct patches are the same for every seed. A case is printed if its mistake is not detected, or if the first
//! change does not name the cause. A table follows. The benchmark fails if a share is below its target, or if a correct
//! patch has a finding.
//!
//! Each part of the benchmark is a module. Its function `report` prints the results and returns whether they are good.

mod document;
#[path = "../../../core/tests/common/files.rs"]
#[allow(dead_code, reason = "the tests of several crates share the file")]
mod files;
mod formula;
mod inverters;
mod mistake;
mod patches;
#[path = "../../../core/tests/common/random.rs"]
#[allow(dead_code, reason = "the tests of several crates share the file")]
mod random;
mod stated;
mod variation;

use std::error::Error;
use std::process::ExitCode;

/// The options of the command line.
pub(crate) struct Options {
    /// The seed of the mistakes.
    pub seed: u64,
    /// The number of correct patches.
    pub patches: usize,
    /// The number of the only case. `None` for all cases.
    pub case: Option<usize>,
}

/// Reads the command line.
fn options() -> Result<Options, Box<dyn Error>> {
    let mut options = Options { seed: 54, patches: 200, case: None };
    let mut words = std::env::args().skip(1).filter(|word| word != "--bench");
    while let Some(option) = words.next() {
        let value = words.next().ok_or_else(|| format!("{option} needs a number"))?;
        match option.as_str() {
            "--seed" => options.seed = value.parse()?,
            "--patches" => options.patches = value.parse()?,
            "--case" => options.case = Some(value.parse()?),
            _ => return Err(format!("{option} is unknown: use --seed, --patches or --case").into()),
        }
    }
    Ok(options)
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let options = options()?;
    Ok(if stated::report(&options) { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
