//! The correct patches: the shipped ones with equations, those of the tests, and random variants of both.

use std::collections::HashSet;
use std::path::Path;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};
use patchcord_equations::{Detail, EquationListing, InitialValue, compare_equations, text};
use patchcord_expr::split_primes;
use serde_json::json;

use crate::files::{json_files_in, repository_path};
use crate::random::SplitMix64;
use crate::variation::varied;

/// Folders with patches that state their equations.
const FOLDERS: [&str; 6] = [
    "patches/lessons",
    "patches/thesis",
    "patches/problems",
    "patches/others",
    "patches/measured",
    "crates/equations/tests/patches",
];

/// Laws of free motion that shipped patches do not state, because a stop or a brake acts too. Without them, a mistake
/// in such a law cannot be detected.
const FURTHER_LAWS: [(&str, &str); 4] = [
    ("patches/lessons/bouncing-ball", "vy' = -g"),
    ("patches/measured/emps-asymmetric", "M v' = net_force - dry_friction sign(v)"),
    ("patches/measured/emps-friction", "M v' = net_force - dry_friction sign(v)"),
    ("patches/thesis/fig-8-16-coulomb", "M v_o' = spring_force - f v_o - friction_level sign(v_o)"),
];

/// A patch with fewer equations is left out.
const MIN_EQUATIONS: usize = 2;
/// Probabilities with which numbers of a variant change. The attempts take them in turn.
const SHARES: [f64; 4] = [1.0, 0.5, 0.3, 0.15];
/// Variants of one patch that are tried in a round at most.
const MAX_ATTEMPTS: usize = 60;

/// A correct patch: its wiring solves its equations, and no warning applies.
pub(crate) struct CorrectPatch {
    /// Its file without the ending, and the number of the variant.
    pub name: String,
    /// The patch. Its equations include the initial values.
    pub patch: Patch,
}

/// The correct patches.
pub(crate) struct Collection {
    /// The patches: first the unchanged ones, then the variants.
    pub patches: Vec<CorrectPatch>,
    /// Variants that were left out because their wiring does not solve the equations. The reason is a gain or a setting
    /// without a formula, which fits one choice of scales.
    pub unsolved_variants: usize,
}

/// What the comparison finds about a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    /// The wiring solves the equations, and there is no warning.
    Correct,
    /// There is no warning, but the wiring does not solve an equation, or only for the present parameters.
    Unsolved,
    /// There is an error or a warning.
    Invalid,
}

/// The circuit and the program of a patch; `None` if it has errors.
pub(crate) fn compiled(patch: &Patch) -> Option<(Circuit, Program)> {
    let circuit = Circuit::new(patch).ok()?;
    let program = Program::new(&circuit).ok()?;
    Some((circuit, program))
}

/// This number of correct patches, or fewer if there are not enough variants. They are the same in every run.
pub(crate) fn correct_patches(count: usize) -> Collection {
    let bases = bases();
    let unchanged = bases
        .iter()
        .map(|(name, patch)| CorrectPatch { name: name.clone(), patch: with_initial_values(patch) });
    let mut collection = Collection { patches: unchanged.take(count).collect(), unsolved_variants: 0 };
    let mut known: HashSet<String> = bases.iter().map(|(_, patch)| patch.text().to_owned()).collect();
    for round in 1.. {
        let count_before = collection.patches.len();
        for (index, (name, base)) in bases.iter().enumerate() {
            if collection.patches.len() == count {
                return collection;
            }
            let mut random = SplitMix64(1000 * round + index as u64);
            if let Some(patch) = variant(base, &mut random, &mut known, &mut collection.unsolved_variants) {
                collection.patches.push(CorrectPatch { name: format!("{name}, variant {round}"), patch });
            }
        }
        if collection.patches.len() == count_before {
            break;
        }
    }
    collection
}

/// The patches from which variants are made, each with its name. They state no initial values except those of their
/// documents.
fn bases() -> Vec<(String, Patch)> {
    let files = FOLDERS.iter().flat_map(|folder| json_files_in(&repository_path(folder)));
    files.filter_map(|file| base(&file)).collect()
}

/// The correct patch of a file, with its name. `None` if the file is no patch, or if the patch has too few equations or
/// is not correct.
fn base(file: &Path) -> Option<(String, Patch)> {
    let patch = Patch::read(file).ok()?;
    if patch.equations.len() < MIN_EQUATIONS {
        return None;
    }
    let relative = file.strip_prefix(repository_path("")).unwrap_or(file);
    let name = relative.with_extension("").display().to_string();
    let further = FURTHER_LAWS.iter().filter(|(of, _)| *of == name).map(|(_, law)| *law);
    let patch = further.fold(patch, |patch, law| with_equation(&patch, law).unwrap_or(patch));
    (verdict(&patch) == Verdict::Correct).then_some((name, patch))
}

/// Whether a patch is correct.
fn verdict(patch: &Patch) -> Verdict {
    let Some((circuit, program)) = compiled(patch) else { return Verdict::Invalid };
    if !circuit.warnings().findings.is_empty() {
        return Verdict::Invalid;
    }
    let is_solved =
        compare_equations(&circuit, &program).iter().all(|compared| compared.agreement.is_solved());
    if is_solved { Verdict::Correct } else { Verdict::Unsolved }
}

/// A random correct variant that is not known yet. `None` if no attempt gives one. `unsolved` counts the variants whose
/// wiring does not solve the equations.
fn variant(
    base: &Patch,
    random: &mut SplitMix64,
    known: &mut HashSet<String>,
    unsolved: &mut usize,
) -> Option<Patch> {
    for share in SHARES.into_iter().cycle().take(MAX_ATTEMPTS) {
        let Some(changed) = varied(base, share, random) else { continue };
        match verdict(&changed) {
            Verdict::Correct => {
                if known.insert(changed.text().to_owned()) {
                    return Some(with_initial_values(&changed));
                }
            }
            Verdict::Unsolved => *unsolved += 1,
            Verdict::Invalid => {}
        }
    }
    None
}

/// A patch with an equation for the initial value of every state that is a signal, so that a wrong initial value can be
/// detected. Equations that the patch has stay.
fn with_initial_values(patch: &Patch) -> Patch {
    let Some((circuit, program)) = compiled(patch) else { return patch.clone() };
    let listing = EquationListing::new(&circuit, &program, Detail::Signals);
    listing.initial.iter().fold(patch.clone(), |patch, initial| {
        let extended = with_initial_value(&patch, initial);
        // Equations have no numbers with units, so some initial values cannot be stated.
        extended.filter(|extended| verdict(extended) == Verdict::Correct).unwrap_or(patch)
    })
}

/// A patch that states an initial value. `None` if it states that value already, or if the quantity is not a signal.
fn with_initial_value(patch: &Patch, initial: &InitialValue) -> Option<Patch> {
    let quantity = text(&initial.quantity);
    let mut stated = patch.equations.iter().filter_map(|placed| placed.value.initial_quantity());
    if !patch.signals.contains_key(split_primes(&quantity).0) || stated.any(|stated| stated == quantity) {
        return None;
    }
    with_equation(patch, &format!("{quantity}(0) = {}", text(&initial.value)))
}

/// A patch with a further equation.
fn with_equation(patch: &Patch, equation: &str) -> Option<Patch> {
    let mut equations = patch.value()["equations"].as_array().cloned().unwrap_or_default();
    equations.push(json!(equation));
    patch.with_edits(patch.file(), &[Edit::at(["equations"], equations)]).ok()
}
