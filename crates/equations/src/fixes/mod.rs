//! Searches for single changes of a patch after which its wiring solves its equations.
//!
//! Candidates are descriptions, sorted by their cost: the mistakes that people make most often come first. Each is first
//! tested numerically, without a new circuit if only cords change, and with the equations that it affects. The change is
//! then made in a copy of the patch, and the equations are compared exactly.

mod candidates;
mod change;
mod document;
mod formula;
mod influence;
mod netlist;
mod panel;
mod quotient;
mod screen;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Edit;

use crate::compare::{Agreement, ComparedEquation, EquationComparer, Standing};
use candidates::{Candidate, candidates};
use change::Change;
pub(crate) use formula::{Product, named_nodes};
use influence::Influence;
use netlist::Rewiring;
use panel::Panel;
pub(crate) use panel::is_free_name;
use screen::{Screen, Trial, Validity};

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

/// A change that was compared exactly.
struct FoundFix {
    fix: Fix,
    /// Whether the wiring then solves the equations for all values of the parameters.
    is_general: bool,
    cost: u32,
}

/// Changes that are returned for an equation at most.
pub(crate) const MAX_FIXES: usize = 3;
/// If a change corrects all equations, changes of a higher cost than this above its own are not tried.
const COST_WINDOW: u32 = 8;
/// Changes that are compared exactly at most, because a comparison takes some milliseconds.
const MAX_COMPARISONS: usize = 100;
/// Largest product of the numbers of tested changes and of elements.
const MAX_TESTED_ELEMENTS: usize = 400_000;
/// Factors of terms from which changes are made at most.
const MAX_FACTORS: usize = 4;
/// Factors of terms between this and its reciprocal are tried.
const MAX_FACTOR: f64 = 1e6;
/// Deviation of a factor from a power of ten by rounding.
const ROUNDING: f64 = 1e-6;

/// Single changes after which the wiring solves equations that it did not solve, and all others as before. Those that
/// correct the most equations come first, then those that do so for all values of the parameters, then the likeliest
/// ones. There are at most three for each equation.
///
/// Each change was made, and the equations were compared again. `compared` are the equations of the circuit, compared
/// with its wiring. If none of them is wrong, the changes correct those that are undecided because of a loop without an
/// integrator, or else those that the wiring solves for the present values of parameters only.
pub fn find_fixes(circuit: &Circuit, program: &Program, compared: &[ComparedEquation]) -> Vec<Fix> {
    let (panel, wiring) = (Panel::new(circuit), Rewiring::default());
    let screen = Screen::new(circuit, Validity::Present);
    let loops = screen.trial(&wiring).closed_loops();
    let Some(goal) = Goal::new(compared, loops > 0) else { return Vec::new() };
    let base = screen.trial(&wiring);
    let tested = circuit.equations().iter().enumerate().map(|(index, placed)| {
        // A test that fails for an equation that the wiring solves is no test.
        !goal.solved.contains(&index) || base.passes(&placed.value)
    });
    let is_tested: Vec<bool> = tested.collect();
    let mut comparer = EquationComparer::new(circuit, program);
    let factors = goal.unsolved.iter().flat_map(|index| comparer.factors(*index)).collect();
    let general = (goal.validity == Validity::General).then(|| Screen::new(circuit, Validity::General));
    let search = Search {
        panel: &panel,
        influence: Influence::new(circuit),
        screen: general.as_ref().unwrap_or(&screen),
        is_tested,
        factors: distinct_factors(factors),
        is_varying: comparer.varying_signals(),
        loops,
        goal,
    };
    search.fixes()
}

/// What a change must achieve.
struct Goal {
    /// The indices of the equations that it must correct.
    unsolved: Vec<usize>,
    /// The indices of the equations that it must not make wrong.
    solved: Vec<usize>,
    /// Whether corrected equations must hold for all values of the parameters.
    validity: Validity,
}

impl Goal {
    /// The goal for compared equations. `None` if there is nothing to correct. `has_loops` is whether the circuit has a
    /// loop without an integrator: a wrong cord may have made it, and so an equation undecided.
    fn new(compared: &[ComparedEquation], has_loops: bool) -> Option<Self> {
        let with = |is_wanted: fn(&Agreement) -> bool| -> Vec<usize> {
            let wanted = compared.iter().filter(|compared| is_wanted(&compared.agreement));
            wanted.map(|compared| compared.index).collect()
        };
        let different = with(|agreement| matches!(agreement, Agreement::Different { .. }));
        let undecided = with(|agreement| matches!(agreement, Agreement::Undecided(_)));
        let solved_at = with(|agreement| matches!(agreement, Agreement::SolvedAt(_)));
        let mut solved = with(Agreement::is_solved);
        let (unsolved, validity) = if !different.is_empty() {
            solved.extend(solved_at);
            (different, Validity::Present)
        } else if has_loops && !undecided.is_empty() {
            solved.extend(solved_at);
            (undecided, Validity::Present)
        } else {
            (solved_at, Validity::General)
        };
        (!unsolved.is_empty()).then_some(Goal { unsolved, solved, validity })
    }
}

/// The work of a search so far.
#[derive(Default)]
struct Work {
    /// The number of changes that were tested numerically.
    tests: usize,
    /// The number of changes that were compared exactly.
    comparisons: usize,
}

/// A search for changes.
struct Search<'a> {
    panel: &'a Panel<'a>,
    goal: Goal,
    influence: Influence,
    screen: &'a Screen<'a>,
    /// For each equation, whether the numerical test is valid: it passes if the wiring solves the equation.
    is_tested: Vec<bool>,
    /// The factors by which terms of the equations are wrong.
    factors: Vec<f64>,
    /// For each signal, whether it varies.
    is_varying: Vec<bool>,
    /// The number of loops without an integrator that no open amplifier opens.
    loops: usize,
}

impl Search<'_> {
    /// The changes that were found, the best ones first.
    fn fixes(&self) -> Vec<Fix> {
        let mut found: Vec<FoundFix> = Vec::new();
        let (mut complete, mut last_cost, mut work) = (0, u32::MAX, Work::default());
        let max_tests = MAX_TESTED_ELEMENTS / self.panel.circuit.elements().len().max(1);
        for Candidate { change, cost } in candidates(self.panel, &self.factors) {
            let is_enough = complete >= MAX_FIXES || cost > last_cost;
            if is_enough || work.tests >= max_tests || work.comparisons >= MAX_COMPARISONS {
                break;
            }
            let Some(fix) = self.fix(&change, cost, &mut work) else { continue };
            if fix.fix.solves.len() == self.goal.unsolved.len() {
                complete += usize::from(fix.is_general);
                last_cost = last_cost.min(cost + COST_WINDOW);
            }
            found.push(fix);
        }
        best(found, self.panel.circuit.equations().len())
    }

    /// A change as a fix. `None` if the wiring then does not solve an equation of those to be corrected, or makes
    /// another one wrong.
    fn fix(&self, change: &Change, cost: u32, work: &mut Work) -> Option<FoundFix> {
        let part = change.part(self.panel);
        let is_affected = |index: &usize| self.influence.affects(&part, *index);
        let unsolved: Vec<usize> = self.goal.unsolved.iter().copied().filter(is_affected).collect();
        let solved: Vec<usize> = self.goal.solved.iter().copied().filter(is_affected).collect();
        if unsolved.is_empty() {
            return None;
        }
        work.tests += 1;
        let (edits, circuit) = match change.rewiring(self.panel) {
            Some(rewiring) => {
                self.test(&self.screen.trial(&rewiring), &unsolved, &solved)?;
                self.changed(change)?
            }
            None => {
                let (edits, circuit) = self.changed(change)?;
                self.test_changed(&circuit, &unsolved, &solved)?;
                (edits, circuit)
            }
        };
        work.comparisons += 1;
        let program = Program::new(&circuit).ok()?;
        let (solves, is_general) = self.solves(&circuit, &program, &unsolved)?;
        let description = change.description(self.panel);
        Some(FoundFix { fix: Fix { description, edits, solves }, is_general, cost })
    }

    /// Tests a wiring numerically. `None` if it cannot solve any equation of those to be corrected, if it cannot solve
    /// another one, or if it has more loops without an integrator: no correction makes one.
    fn test(&self, trial: &Trial<'_, '_>, unsolved: &[usize], solved: &[usize]) -> Option<()> {
        let equations = self.panel.circuit.equations();
        let passes = |index: &usize| !self.is_tested[*index] || trial.passes(&equations[*index].value);
        let is_possible =
            trial.closed_loops() <= self.loops && unsolved.iter().any(passes) && solved.iter().all(passes);
        is_possible.then_some(())
    }

    /// Tests a changed circuit numerically, as [`Search::test`].
    fn test_changed(&self, circuit: &Circuit, unsolved: &[usize], solved: &[usize]) -> Option<()> {
        let wiring = Rewiring::default();
        let screen = Screen::new(circuit, self.goal.validity);
        let trial = screen.trial(&wiring);
        self.test(&trial, unsolved, solved)
    }

    /// The edits of the document for a change, and the circuit after it. `None` if the changed patch has errors.
    fn changed(&self, change: &Change) -> Option<(Vec<Edit>, Circuit)> {
        let (circuit, edits) = (self.panel.circuit, change.edits(self.panel)?);
        let patch = circuit.patch().with_edits(circuit.patch().file(), &edits).ok()?;
        let parameters = circuit.parameters().map(|(name, _, value)| (name.to_owned(), value));
        Some((edits, Circuit::with_parameters(&patch, parameters).ok()?))
    }

    /// The equations that a changed wiring solves, of those to be corrected, and whether it solves them for all values
    /// of the parameters. `None` if there is none, if the wiring does not solve another equation any more, or if a signal
    /// does not vary any more: a signal that is 0 solves many equations, but no correction makes one.
    fn solves(&self, circuit: &Circuit, program: &Program, unsolved: &[usize]) -> Option<(Vec<usize>, bool)> {
        let mut comparer = EquationComparer::new(circuit, program);
        let permits_present = self.goal.validity == Validity::Present;
        let (mut solves, mut is_general) = (Vec::new(), true);
        for index in unsolved {
            let standing = comparer.standing(*index);
            if standing == Standing::Solved || (standing == Standing::SolvedAt && permits_present) {
                solves.push(*index);
                is_general &= standing == Standing::Solved;
            }
        }
        if solves.is_empty() {
            return None;
        }
        let is_solved =
            |index: &usize| matches!(comparer.standing(*index), Standing::Solved | Standing::SolvedAt);
        if !self.goal.solved.iter().all(is_solved) {
            return None;
        }
        let mut varying = self.is_varying.iter().zip(comparer.varying_signals());
        varying.all(|(before, after)| !before || after).then_some((solves, is_general))
    }
}

/// The best changes: at most three for each equation, in the order in which they are listed.
fn best(mut found: Vec<FoundFix>, equations: usize) -> Vec<Fix> {
    found.sort_by_key(|FoundFix { fix, is_general, cost }| {
        (std::cmp::Reverse(fix.solves.len()), !is_general, *cost)
    });
    let mut counts = vec![0; equations];
    let fixes = found.into_iter().map(|found| found.fix).filter(|fix| {
        let is_wanted = fix.solves.iter().any(|equation| counts[*equation] < MAX_FIXES);
        fix.solves.iter().for_each(|equation| counts[*equation] += 1);
        is_wanted
    });
    fixes.collect()
}

/// The factors from which changes are made, each without its reciprocal. Powers of ten are tried anyway.
fn distinct_factors(factors: Vec<f64>) -> Vec<f64> {
    let mut distinct: Vec<f64> = Vec::new();
    for factor in factors {
        let power = factor.log10();
        let is_power = (power - power.round()).abs() < ROUNDING;
        let is_tried = factor > 0.0 && power.abs() <= MAX_FACTOR.log10() && !is_power;
        let is_known = |known: &f64| (known.log10().abs() - power.abs()).abs() < ROUNDING;
        if is_tried && !distinct.iter().any(is_known) && distinct.len() < MAX_FACTORS {
            distinct.push(factor);
        }
    }
    distinct
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_distinct_and_no_powers_of_ten() {
        assert_eq!(distinct_factors(vec![2.0, 10.0, 0.5, 0.001, 2.0, 1.0, 3.0]), [2.0, 3.0]);
        assert_eq!(distinct_factors(vec![-2.0, 0.0, f64::NAN, f64::INFINITY, 3e6]), Vec::<f64>::new());
        assert_eq!(distinct_factors((2..10).map(f64::from).collect()).len(), MAX_FACTORS);
    }

    /// A change of this cost that solves some equations.
    fn found(description: &str, solves: &[usize], is_general: bool, cost: u32) -> FoundFix {
        let fix = Fix { description: description.to_owned(), edits: Vec::new(), solves: solves.to_vec() };
        FoundFix { fix, is_general, cost }
    }

    #[test]
    fn changes_that_correct_more_come_first_and_general_ones_before_others() {
        let fixes = best(
            vec![
                found("one equation", &[0], true, 5),
                found("both, at present only", &[0, 1], false, 10),
                found("both", &[0, 1], true, 20),
                found("both, usual", &[0, 1], true, 12),
                found("the second", &[1], true, 1),
            ],
            2,
        );
        let descriptions: Vec<&str> = fixes.iter().map(|fix| fix.description.as_str()).collect();
        assert_eq!(descriptions, ["both, usual", "both", "both, at present only"]);
    }
}
