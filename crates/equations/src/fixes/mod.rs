//! Searches for single changes of a patch after which its wiring solves its equations.
//!
//! Each candidate is made in a copy of the patch, and all equations are compared again. Candidates are tried in the order
//! of their cost: the mistakes that people make most often come first.

mod candidates;
mod screen;

use patchcord_core::circuit::{Circuit, EvaluationStep};
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};

use crate::compare::{Agreement, EquationComparer, compare_equations};
use candidates::candidates;
use screen::Screen;

/// A change of a patch.
#[derive(Debug, Clone)]
pub struct Fix {
    /// The change as a command, such as "plug B1 into P1 in place of A2".
    pub description: String,
    /// The change of the document.
    pub edits: Vec<Edit>,
    /// The indices of the equations that the wiring solves after the change and did not solve before, in rising order.
    pub solves: Vec<usize>,
}

/// A change with its place in the order of the search.
struct Candidate {
    description: String,
    edits: Vec<Edit>,
    /// How unusual the mistake is that the change mends.
    cost: u32,
}

/// Changes that are returned for an equation at most.
pub(crate) const MOST_FIXES: usize = 3;
/// If a change mends all equations, changes of a higher cost than this above its own are not tried.
const COST_WINDOW: u32 = 8;
/// Changes that are compared exactly at most, because a comparison takes some milliseconds.
const MAX_COMPARISONS: usize = 600;
/// Changes that are tried at most.
const MOST_TRIALS: usize = 1500;

/// Single changes after which the wiring solves equations that it did not solve, and all others as before. Those that
/// mend the most equations come first, then the likeliest ones. There are at most three for each equation.
///
/// Each change was made, and all equations were compared again. `unsolved` are the indices of the equations that the
/// wiring does not solve, and `solved` those of the equations that it solves.
pub fn find_fixes(circuit: &Circuit, program: &Program, unsolved: &[usize], solved: &[usize]) -> Vec<Fix> {
    let target = Target { circuit, unsolved, solved, is_varying: EquationComparer::new(circuit, program).varying_signals() };
    let mut candidates = candidates(circuit);
    candidates.sort_by_key(|candidate| candidate.cost);
    let mut fixes: Vec<Fix> = Vec::new();
    let (mut complete, mut dearest, mut comparisons) = (0, u32::MAX, 0);
    for candidate in candidates.into_iter().take(MOST_TRIALS) {
        if complete >= MOST_FIXES || candidate.cost > dearest || comparisons >= MAX_COMPARISONS {
            break;
        }
        let solves = solved_by(&target, &candidate, &mut comparisons);
        if !solves.is_empty() {
            let Candidate { description, edits, cost } = candidate;
            if solves.len() == unsolved.len() {
                complete += 1;
                dearest = dearest.min(cost + COST_WINDOW);
            }
            fixes.push(Fix { description, edits, solves });
        }
    }
    // The sort is stable: among equals, the likelier change comes first.
    fixes.sort_by_key(|fix| std::cmp::Reverse(fix.solves.len()));
    let mut counts = vec![0; circuit.equations().len()];
    fixes.retain(|fix| {
        let is_wanted = fix.solves.iter().any(|equation| counts[*equation] < MOST_FIXES);
        fix.solves.iter().for_each(|equation| counts[*equation] += 1);
        is_wanted
    });
    fixes
}

/// What a change must achieve.
struct Target<'a> {
    circuit: &'a Circuit,
    /// The indices of the equations that the wiring does not solve.
    unsolved: &'a [usize],
    /// The indices of the equations that it solves.
    solved: &'a [usize],
    /// For each signal, whether it varies.
    is_varying: Vec<bool>,
}

/// The unsolved equations that the wiring solves after a change. Empty if it then does not solve another one, or if a
/// signal does not vary any more: a signal that is 0 solves many equations, but no correction makes one.
///
/// `comparisons` counts the changes that are compared exactly.
fn solved_by(target: &Target<'_>, candidate: &Candidate, comparisons: &mut usize) -> Vec<usize> {
    let patch = target.circuit.patch();
    let Ok(changed) = patch.with_edits(patch.file(), &candidate.edits) else { return Vec::new() };
    let Some((circuit, program)) = compiled(target.circuit, &changed) else { return Vec::new() };
    if let Some(screen) = Screen::new(&circuit, &program) {
        let fails = |index: &usize| !screen.passes(&circuit.equations()[*index].value);
        if target.unsolved.iter().all(fails) || target.solved.iter().any(fails) {
            return Vec::new();
        }
    }
    *comparisons += 1;
    let compared = compare_equations(&circuit, &program);
    let is_solved = |index: &usize| {
        let agreement = &compared[*index].agreement;
        matches!(agreement, Agreement::Solved | Agreement::SolvedIf(_) | Agreement::SolvedAt(_))
    };
    if target.solved.iter().any(|index| !is_solved(index)) || !target.unsolved.iter().any(is_solved) {
        return Vec::new();
    }
    let is_varying = EquationComparer::new(&circuit, &program).varying_signals();
    if target.is_varying.iter().zip(is_varying).any(|(before, after)| *before && !after) {
        return Vec::new();
    }
    target.unsolved.iter().copied().filter(is_solved).collect()
}

/// A changed patch with the parameters of a circuit. `None` if it has errors, or more loops without an integrator: no
/// correction makes one, and the proof that it has one solution takes long.
fn compiled(circuit: &Circuit, changed: &Patch) -> Option<(Circuit, Program)> {
    let parameters = circuit.parameters().map(|(name, _, value)| (name.to_owned(), value));
    let changed = Circuit::with_parameters(changed, parameters).ok()?;
    if loop_count(&changed) > loop_count(circuit) {
        return None;
    }
    let program = Program::new(&changed).ok()?;
    Some((changed, program))
}

/// Number of loops without an integrator.
fn loop_count(circuit: &Circuit) -> usize {
    circuit.evaluation_order().iter().filter(|step| matches!(step, EvaluationStep::Loop { .. })).count()
}
