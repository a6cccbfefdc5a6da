//! The stated equations that the wiring does not solve, as diagnostics with fixes.

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::ir::Program;

use crate::compare::{Agreement, ComparedEquation};
use crate::fixes::{Fix, MOST_FIXES, find_fixes};

/// The codes of equations.
pub mod codes {
    patchcord_core::diagnostic_codes! {
        /// All codes of equations, in the order of the reference page.
        self::ALL;
        NOT_SOLVED "equation-not-solved" Error "The wiring solves another equation than the patch states."
            "`patchcord equations PATCH` prints the equations that the wiring solves";
        SOLVED_AT "equation-solved-at" Warning "The wiring solves an equation for the present values of parameters only."
            "let the settings contain the parameters, so that --set and sweeps change the wiring too";
        NOT_COMPARED "equation-not-compared" Warning "An equation cannot be compared with the wiring."
            "write it for a signal or the derivative of a signal";
    }
}

/// The diagnostics of compared equations, in their order. Each lists at
/// most three single changes after which the wiring solves its equation.
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
    let [mut unsolved, mut solved] = [Vec::new(), Vec::new()];
    for compared in compared {
        match compared.agreement {
            Agreement::Different { .. } => unsolved.push(compared.index),
            Agreement::Solved | Agreement::SolvedIf(_) | Agreement::SolvedAt(_) => {
                solved.push(compared.index)
            }
            Agreement::Undecided(_) => {}
        }
    }
    if unsolved.is_empty() { Vec::new() } else { find_fixes(circuit, program, &unsolved, &solved) }
}

/// The diagnostic of an equation; `None` if the wiring solves it.
fn finding(circuit: &Circuit, compared: &ComparedEquation, fixes: &[Fix]) -> Option<Diagnostic> {
    let span = circuit.equations()[compared.index].span;
    match &compared.agreement {
        Agreement::Different { differences, wired } => {
            let message = format!("the wiring does not solve this equation: {}", differences.join("; "));
            let own = fixes.iter().filter(|fix| fix.solves.contains(&compared.index));
            let descriptions: Vec<&str> = own.take(MOST_FIXES).map(|fix| fix.description.as_str()).collect();
            let remedy = match descriptions.as_slice() {
                [] => String::new(),
                [only] => format!(". This change corrects it: {only}"),
                several => format!(". Any of these changes corrects it: {}", several.join("; or ")),
            };
            let hint = format!("the wiring solves {wired}{remedy}");
            Some(Diagnostic::at(codes::NOT_SOLVED, span, message).hint(hint))
        }
        Agreement::Undecided(reason) => {
            let message = format!("this equation is not compared with the wiring: {reason}");
            Some(Diagnostic::at(codes::NOT_COMPARED, span, message))
        }
        Agreement::SolvedAt(names) => {
            let names = names.join(", ");
            let message = format!("the wiring solves this equation for the present values of {names} only");
            Some(Diagnostic::at(codes::SOLVED_AT, span, message))
        }
        Agreement::Solved | Agreement::SolvedIf(_) => None,
    }
}
