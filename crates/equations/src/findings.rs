//! The stated equations that the wiring does not solve, as diagnostics with fixes.

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::ir::Program;

use crate::compare::{Agreement, ComparedEquation};
use crate::fixes::{Fix, MAX_FIXES, find_fixes};

/// The codes of equations and of problems.
pub mod codes {
    patchcord_core::diagnostic_codes! {
        /// All codes of equations and of problems, in the order of the reference page.
        self::ALL;
        NOT_SOLVED "equation-not-solved" Error "The wiring solves another equation than the patch states."
            "`patchcord equations PATCH` prints the equations that the wiring solves";
        SOLVED_AT "equation-solved-at" Warning "The wiring solves an equation for the present values of parameters only."
            "let the settings contain the parameters, so that --set and sweeps change the wiring too";
        NOT_COMPARED "equation-not-compared" Warning "An equation cannot be compared with the wiring."
            "write it for a signal or the derivative of a signal";
        NO_SOLUTION "no-solution" Error "A quantity of a problem has no value at some time of the run."
            "check the equations, the parameters and the initial values, or end the run earlier";
        UNBOUNDED "unbounded" Error "A quantity of a problem becomes infinite, or exceeds 1e60 in SI units."
            "look for a term with the wrong sign, or end the run earlier";
        ZERO_DIVISOR "zero-divisor" Error "A divisor of a problem reaches 0 in the run."
            "multiply the equation by the divisor, or end the run earlier";
        LONG_SOLUTION "long-solution" Error "The numerical solution of a problem takes too many evaluations."
            "end the run earlier, or leave out the fastest motion";
        EXCEEDED_MAXIMUM "exceeded-maximum" Warning "A quantity of a problem exceeds its \"maximum\", so its scale follows from its peak."
            "state a larger \"maximum\"";
        SHORTENED_STEP "shortened-step" Warning "The step of a problem is too long, so its patch has a shorter one."
            "state the shorter step, or a \"tolerance\" in its place";
        NO_CIRCUIT "no-circuit" Error "A part of a problem has no circuit with these values and scales."
            "give the quantity another \"maximum\", or write the equation in another form";
        MISSING_PARTS "missing-parts" Warning "A scaled patch needs more parts than its machine has."
            "`patchcord check` and `patchcord run` refuse the patch: scale the problem with --machine unlimited, or write it with fewer equations, products and functions";
    }
}

/// The diagnostics of compared equations, in their order. Each lists at most three single changes after which the wiring
/// solves its equation.
pub fn equation_findings(
    circuit: &Circuit,
    program: &Program,
    compared: &[ComparedEquation],
) -> Vec<Diagnostic> {
    findings_with_fixes(circuit, compared, &equation_fixes(circuit, program, compared))
}

/// The same for changes that were found before by [`equation_fixes`].
pub fn findings_with_fixes(
    circuit: &Circuit,
    compared: &[ComparedEquation],
    fixes: &[Fix],
) -> Vec<Diagnostic> {
    compared.iter().filter_map(|compared| finding(circuit, compared, fixes)).collect()
}

/// The single changes after which the wiring solves compared equations that it does not solve. The likeliest comes
/// first. Empty if it solves them all.
pub fn equation_fixes(circuit: &Circuit, program: &Program, compared: &[ComparedEquation]) -> Vec<Fix> {
    if compared.iter().all(|compared| compared.agreement.is_solved()) {
        Vec::new()
    } else {
        find_fixes(circuit, program, compared)
    }
}

/// The diagnostic of an equation; `None` if the wiring solves it.
fn finding(circuit: &Circuit, compared: &ComparedEquation, fixes: &[Fix]) -> Option<Diagnostic> {
    let span = circuit.equations()[compared.index].span;
    let remedy = remedy(compared, fixes);
    match &compared.agreement {
        Agreement::Different { differences, wired } => {
            let message = format!("the wiring does not solve this equation: {}", differences.join("; "));
            let hint = format!("the wiring solves {wired}{}", remedy.unwrap_or_default());
            Some(Diagnostic::at(codes::NOT_SOLVED, span, message).hint(hint))
        }
        Agreement::Undecided(reason) => {
            let message = format!("this equation is not compared with the wiring: {reason}");
            Some(with_remedy(Diagnostic::at(codes::NOT_COMPARED, span, message), remedy))
        }
        Agreement::SolvedAt(names) => {
            let names = names.join(", ");
            let message = format!("the wiring solves this equation for the present values of {names} only");
            Some(with_remedy(Diagnostic::at(codes::SOLVED_AT, span, message), remedy))
        }
        Agreement::Solved | Agreement::SolvedIf(_) | Agreement::SolvedNumerically(_) => None,
    }
}

/// The changes after which the wiring solves an equation, as a sentence that follows a hint. `None` if there are none.
fn remedy(compared: &ComparedEquation, fixes: &[Fix]) -> Option<String> {
    let own = fixes.iter().filter(|fix| fix.solves.contains(&compared.index));
    let descriptions: Vec<&str> = own.take(MAX_FIXES).map(|fix| fix.description.as_str()).collect();
    match descriptions.as_slice() {
        [] => None,
        [only] => Some(format!(". This change corrects it: {only}")),
        several => Some(format!(". Any of these changes corrects it: {}", several.join("; or "))),
    }
}

/// A diagnostic with the advice of its code, followed by changes that correct the equation.
fn with_remedy(diagnostic: Diagnostic, remedy: Option<String>) -> Diagnostic {
    let hint = remedy.map(|remedy| format!("{}{remedy}", diagnostic.advice()));
    diagnostic.maybe_hint(hint)
}
