//! What can only be told once the operations are there: coefficients and loops in initial condition.

use std::collections::HashSet;

use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::dry_run;
use crate::circuit::Circuit;
use crate::document::{Code, Diagnostic, told};
use crate::ir::{Loop, LoopFault, Program, Scratch, Solutions, Sources, Unfit, remedy, tell};

/// Modes that have not settled after so many rounds never will.
const MOST_SETTLING: usize = 1000;

/// The coefficients and loops that cannot be used; a program without any can be run.
pub(super) fn findings(circuit: &Circuit, program: &Program) -> Vec<Diagnostic> {
    let parameters: Vec<f64> = program.parameters.iter().map(|slot| slot.value).collect();
    let coefficients = program.prepare(&parameters);
    if let Some(Unfit { coefficient, value, fault }) = program.first_unfit(&coefficients) {
        let message = format!("{} comes to {}, {}", coefficient.label, told(value), fault.describe(value));
        let hint = Some("look for a wrong power of ten, here or in a scale".to_owned());
        return vec![Diagnostic { code: Code::NotFinite, span: coefficient.span, message, hint }];
    }
    let rest = at_rest(program, &parameters, &coefficients);
    let loops =
        rest.faults.iter().map(|fault| diagnostic(circuit, &program.loops[fault.index], fault.solutions));
    let restless = rest.restless.and_then(|element| restless(circuit, program, element));
    loops.chain(restless).chain(dry_run::findings(circuit, program)).collect()
}

/// What is found in initial condition.
struct Rest {
    /// Loops that cannot be solved.
    faults: Vec<LoopFault>,
    /// An element whose mode does not settle.
    restless: Option<usize>,
}

/// States, and what is delayed, kept and held, before anything has happened.
fn standing(program: &Program, coefficients: &[f64]) -> [Vec<f64>; 4] {
    let coefficient = |index: u32| coefficients[index as usize];
    [
        program.states.iter().map(|state| coefficient(state.initial)).collect(),
        program.delays.iter().map(|delay| coefficient(delay.initial)).collect(),
        program.kept.iter().map(|kept| coefficient(kept.initial)).collect(),
        program.first_levels(coefficients),
    ]
}

/// Works out initial condition until the modes have settled.
fn at_rest(program: &Program, parameters: &[f64], coefficients: &[f64]) -> Rest {
    let [mut states, delayed, kept, levels] = standing(program, coefficients);
    let mut modes: Vec<f64> = program.modes.iter().map(|mode| mode.initial).collect();
    let (mut registers, mut scratch) = (vec![0.0; program.body.len()], Scratch::new(program));
    let mut restless = None;
    for _ in 0..MOST_SETTLING {
        let from = Sources {
            parameters,
            coefficients,
            states: &states,
            modes: &modes,
            time: 0.0,
            tables: &program.tables,
            delayed: &delayed,
            kept: &kept,
            levels: &levels,
        };
        scratch.faults.clear();
        program.evaluate(&from, &mut registers, &mut scratch);
        restless = None;
        program.change_modes(&registers, &mut modes, &mut states, |mode, _| {
            restless = Some(program.modes[mode].element);
        });
        if restless.is_none() {
            break;
        }
    }
    Rest { faults: causes(scratch.faults), restless }
}

/// Behind a loop that has no voltage others have none either: the first is the cause.
fn causes(mut faults: Vec<LoopFault>) -> Vec<LoopFault> {
    let consequence = |fault: &LoopFault| fault.solutions == Solutions::NotANumber;
    if !faults.iter().all(consequence) {
        faults.retain(|fault| !consequence(fault));
    }
    faults
}

/// A relay that no position suits: with the members of the loop that lead from it back to it at once.
fn restless(circuit: &Circuit, program: &Program, element: usize) -> Option<Diagnostic> {
    let members = loop_through(program, element)?;
    let names: Vec<_> = members.iter().map(|member| program.name(*member)).collect();
    let message = format!(
        "the loop {} has no integrator and no position of {} satisfies it: it switches without end",
        names.join(", "),
        program.name(element)
    );
    let hint = Some("put an integrator or a lag into the loop, or invert it once more".to_owned());
    Some(Diagnostic { code: Code::LoopWithoutSolution, span: circuit.element(element).span, message, hint })
}

/// The members of the loop through an element that acts within the same instant: without states and delay
/// lines. `None` where there is no such loop.
fn loop_through(program: &Program, element: usize) -> Option<Vec<usize>> {
    let states = program.states.iter().map(|state| state.element);
    let remembering: HashSet<usize> =
        states.chain(program.delays.iter().map(|delay| delay.element)).collect();
    let cords = program.readers.iter().enumerate().flat_map(|(from, readers)| {
        readers
            .iter()
            .filter(|reader| !remembering.contains(reader))
            .map(move |reader| (from as u32, *reader as u32))
    });
    let at_once = DiGraph::<(), ()>::from_edges(cords);
    let own = NodeIndex::new(element);
    let mut members = kosaraju_scc(&at_once).into_iter().find(|members| members.contains(&own))?;
    members.sort_unstable();
    let closed = members.len() > 1 || at_once.contains_edge(own, own);
    closed.then(|| members.into_iter().map(NodeIndex::index).collect())
}

fn diagnostic(circuit: &Circuit, entry: &Loop, solutions: Solutions) -> Diagnostic {
    let element = circuit.elements().into_iter().find(|element| element.name == entry.opened());
    let (code, hint) = remedy(entry, solutions);
    let message =
        format!("the loop {} has no integrator and {}", entry.members.join(", "), tell(entry, solutions));
    let span = element.and_then(|element| element.span);
    Diagnostic { code, span, message, hint: Some(hint.to_owned()) }
}
