//! The stated equations of a patch in the output of `patchcord check`: whether the wiring solves them.

use serde::Serialize;

use patchcord::circuit::Circuit;
use patchcord::equations::{Agreement, ComparedEquation};

/// A line about the equations of a patch, and one for each that holds under a condition.
pub(super) fn equation_lines(circuit: &Circuit, compared: &[ComparedEquation]) -> String {
    let solved =
        compared.iter().filter(|compared| !matches!(compared.agreement, Agreement::Undecided(_))).count();
    let states = state_text(compared);
    let mut text = match (solved, compared.len()) {
        (_, 0) => return String::new(),
        (1, 1) => format!("the wiring solves its equation{states}\n"),
        (solved, all) if solved == all => format!("the wiring solves its {all} equations{states}\n"),
        (solved, all) => {
            format!(
                "the wiring solves {solved} of its {all} equations{states}; the others are not compared\n"
            )
        }
    };
    for compared in compared {
        if let Agreement::SolvedIf(conditions) = &compared.agreement {
            let equation = circuit.equations()[compared.index].value.text();
            text += &format!("  {equation}  if {}\n", conditions.join(" and "));
        }
    }
    text
}

/// The number of equations that were compared at states of the machine, in parentheses. Empty if there are none.
fn state_text(compared: &[ComparedEquation]) -> String {
    let states = compared.iter().filter_map(|compared| match compared.agreement {
        Agreement::SolvedNumerically(states) => Some(states),
        _ => None,
    });
    let states: Vec<usize> = states.collect();
    match (states.iter().min(), states.iter().max()) {
        (Some(least), Some(most)) if least == most => {
            format!(" ({} compared at {least} states)", states.len())
        }
        (Some(least), Some(most)) => format!(" ({} compared at {least} to {most} states)", states.len()),
        _ => String::new(),
    }
}

/// A stated equation and whether the wiring solves it.
#[derive(Serialize)]
pub(super) struct EquationDocument<'a> {
    text: &'a str,
    /// "always", "within ranges and limits", "at compared states", "for the present parameters" or "not compared".
    solved: &'static str,
    /// The conditions of ranges and limits, the number of states, or the names of the parameters; the reason if it is not
    /// compared.
    details: Vec<String>,
}

impl<'a> EquationDocument<'a> {
    /// All stated equations of a circuit.
    pub(super) fn all(circuit: &'a Circuit, compared: &[ComparedEquation]) -> Vec<Self> {
        let document = |compared: &ComparedEquation| {
            let (solved, details) = match &compared.agreement {
                Agreement::SolvedIf(conditions) => ("within ranges and limits", conditions.clone()),
                Agreement::SolvedNumerically(states) => ("at compared states", vec![states.to_string()]),
                Agreement::SolvedAt(parameters) => ("for the present parameters", parameters.clone()),
                Agreement::Undecided(reason) => ("not compared", vec![reason.clone()]),
                _ => ("always", Vec::new()),
            };
            EquationDocument { text: circuit.equations()[compared.index].value.text(), solved, details }
        };
        compared.iter().map(document).collect()
    }
}
