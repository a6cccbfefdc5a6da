//! Sign errors in correct patches that state no equations: is each that makes a motion grow reported?
//!
//!     cargo bench --bench growth                    every sign error in each of 200 patches
//!     cargo bench --bench growth -- --patches 50    fewer patches
//!     cargo bench --bench growth -- --patch 31      one patch
//!
//! The patches are those of the benchmark `mistakes` of patchcord-equations, without their equations. Patches whose motion
//! grows already are left out. A sign error is a cord from the inverse of its output, or an inverter in a cord. It counts
//! if a motion grows at initial condition then: a root of the linearised circuit is on the right of the imaginary axis.
//! The warning `growing-loop` must report at least 95 % of these errors. The errors that it does not report are printed.

#[path = "../../crates/equations/benches/mistakes/document.rs"]
#[allow(dead_code, reason = "two benchmarks share the file")]
mod document;
#[path = "../../crates/core/tests/common/files.rs"]
#[allow(dead_code, reason = "the tests of several crates share the file")]
mod files;
#[path = "../../crates/equations/benches/mistakes/inverters.rs"]
mod inverters;
#[path = "../../crates/equations/benches/mistakes/patches.rs"]
#[allow(dead_code, reason = "two benchmarks share the file")]
mod patches;
#[path = "../../crates/core/tests/common/random.rs"]
#[allow(dead_code, reason = "the tests of several crates share the file")]
mod random;
mod sign_errors;
#[path = "../../crates/equations/benches/mistakes/variation.rs"]
mod variation;

use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

use patchcord::linear::{check_size, growth_warning, roots};
use patchcord::patch::{Edit, Patch};
use patchcord::solve::Machine;
use serde_json::json;

use patches::{compiled, correct_patches};
use sign_errors::sign_errors;

/// The required share of the sign errors that are reported.
const TARGET: f64 = 0.95;
/// The step of a patch without one, in seconds.
const DEFAULT_STEP: f64 = 1e-3;
/// Growth below this share of the natural frequency is rounding.
const ROUNDING: f64 = 1e-6;

/// The options of the command line.
struct Options {
    /// The number of correct patches.
    patches: usize,
    /// The number of the only patch. `None` for all patches.
    patch: Option<usize>,
}

/// What the check finds about the growth of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Growth {
    /// No motion grows.
    None,
    /// A motion grows, and the warning reports it.
    Reported,
    /// A motion grows, and there is no warning.
    Silent,
}

/// The numbers of sign errors.
#[derive(Default)]
struct Counts {
    /// All of them.
    errors: usize,
    /// Those after which a motion grows.
    growing: usize,
    /// Those of them that are reported.
    reported: usize,
}

/// Reads the command line.
fn options() -> Result<Options, Box<dyn Error>> {
    let mut options = Options { patches: 200, patch: None };
    let mut words = std::env::args().skip(1).filter(|word| word != "--bench");
    while let Some(option) = words.next() {
        let value = words.next().ok_or_else(|| format!("{option} needs a number"))?;
        match option.as_str() {
            "--patches" => options.patches = value.parse()?,
            "--patch" => options.patch = Some(value.parse()?),
            _ => return Err(format!("{option} is unknown: use --patches or --patch").into()),
        }
    }
    Ok(options)
}

/// The growth of the motion of a patch at initial condition. `None` if the patch has errors or cannot be linearised.
fn growth(patch: &Patch) -> Option<Growth> {
    let (circuit, program) = compiled(patch)?;
    check_size(&program).ok()?;
    let step = circuit.run_plan().step.as_ref().map_or(DEFAULT_STEP, |step| step.value);
    let model = Machine::new(&program, step).ok()?.state_space();
    let is_growing = roots(&model).ok()?.iter().any(|root| root.real > ROUNDING * root.natural_frequency());
    Some(match (is_growing, growth_warning(&circuit, &model)) {
        (false, _) => Growth::None,
        (true, Some(_)) => Growth::Reported,
        (true, None) => Growth::Silent,
    })
}

/// A patch without its equations, in which no growth is intended.
fn without_equations(patch: &Patch) -> Option<Patch> {
    let edits = [Edit::new("equations", json!([])), Edit::new("positive_feedback", false)];
    patch.with_edits(patch.file(), &edits).ok()
}

/// Makes all sign errors in a patch, and prints those that are not reported.
fn count(number: usize, name: &str, patch: &Patch, counts: &mut Counts) {
    for error in sign_errors(patch) {
        let Some(growth) = error.patch(patch).as_ref().and_then(growth) else { continue };
        counts.errors += 1;
        counts.growing += usize::from(growth != Growth::None);
        counts.reported += usize::from(growth == Growth::Reported);
        if growth == Growth::Silent {
            println!("patch {number}, {name}: {}", error.description);
        }
    }
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let options = options()?;
    let start = Instant::now();
    let (mut counts, mut examined) = (Counts::default(), 0);
    for (number, correct) in correct_patches(options.patches).patches.iter().enumerate() {
        if options.patch.is_some_and(|patch| patch != number) {
            continue;
        }
        let Some(patch) = without_equations(&correct.patch) else { continue };
        if growth(&patch) == Some(Growth::None) {
            examined += 1;
            count(number, &correct.name, &patch, &mut counts);
        }
    }
    let Counts { errors, growing, reported } = counts;
    let share = reported as f64 / growing.max(1) as f64;
    println!("patches without growth: {examined}, in {:.1} s", start.elapsed().as_secs_f64());
    println!("sign errors: {errors}; a motion grows after {growing}; reported: {reported}");
    println!("share: {:.1} %", 100.0 * share);
    Ok(if growing > 0 && share >= TARGET { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
