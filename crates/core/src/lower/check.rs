//! Checks that need the operations of the program: coefficients, and loops in initial condition.
//!
//! First the coefficients are computed. If they are valid, the body is evaluated in initial condition until all modes
//! have settled. Finally the changes of parameters in the run plan are checked.

use std::collections::HashSet;

use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::dry_run;
use crate::circuit::Circuit;
use crate::document::{Code, Diagnostic};
use crate::ir::{
    InvalidCoefficient, LoopFault, Program, Scratch, Solutions, Sources, describe_solutions, remedy,
};

/// Maximum number of changes of mode in initial condition. Modes that have not settled by then never do.
const MAX_SETTLING_ROUNDS: usize = 1000;

/// The faults of coefficients and loops. A program can run only if there are none.
///
/// An invalid coefficient is reported alone, because every voltage that follows from it would be wrong as well. Else
/// the list has the loops first, then an element whose mode does not settle, then the changes of parameters.
pub(super) fn findings(circuit: &Circuit, program: &Program) -> Vec<Diagnostic> {
    let parameters: Vec<f64> = program.parameters.iter().map(|parameter| parameter.value).collect();
    let coefficients = program.prepare(&parameters);
    if let Some(InvalidCoefficient { coefficient, value, fault }) =
        program.first_invalid_coefficient(&coefficients)
    {
        let (value, violation) = (fault.value_text(value), fault.describe(value));
        let message = format!("{} is {value}, {violation}", coefficient.label);
        let hint = Some("look for a wrong power of ten, here or in a scale".to_owned());
        return vec![Diagnostic { code: Code::NOT_FINITE, span: coefficient.span, message, hint }];
    }
    let initial = solve_initial_condition(program, &parameters, &coefficients);
    let loops = initial.faults.iter().map(|fault| diagnostic(circuit, program, fault));
    let unsettled = initial.unsettled.and_then(|element| unsettled(circuit, program, element));
    loops.chain(unsettled).chain(dry_run::findings(circuit, program)).collect()
}

/// The faults in initial condition.
struct InitialCondition {
    /// The loops that do not have exactly one solution, without those that only follow from another fault.
    faults: Vec<LoopFault>,
    /// Index of the element whose mode changed last, if modes still change after the last round; `None` if all settled.
    unsettled: Option<usize>,
}

/// Initial values of states, delayed, sampled and stepped values, in this order. They are in volts, and in the order of
/// the lists of the program.
fn initial_values(program: &Program, coefficients: &[f64]) -> [Vec<f64>; 4] {
    let coefficient = |index: u32| coefficients[index as usize];
    [
        program.lowered.states.iter().map(|state| coefficient(state.initial)).collect(),
        program.lowered.delays.iter().map(|delay| coefficient(delay.initial)).collect(),
        program.lowered.sampled.iter().map(|sampled| coefficient(sampled.initial)).collect(),
        program.initial_levels(coefficients),
    ]
}

/// Evaluates the body in initial condition until the modes have settled.
///
/// Each round evaluates all voltages and then makes the changes of mode that are due. The faults are those of the last
/// round, because the modes of earlier rounds are not those of the run.
fn solve_initial_condition(program: &Program, parameters: &[f64], coefficients: &[f64]) -> InitialCondition {
    let [mut states, delayed, sampled, levels] = initial_values(program, coefficients);
    let mut modes: Vec<f64> = program.lowered.modes.iter().map(|mode| mode.initial).collect();
    let (mut registers, mut scratch) = (vec![0.0; program.lowered.body.len()], Scratch::new(program));
    let mut unsettled = None;
    for _ in 0..MAX_SETTLING_ROUNDS {
        let from = Sources {
            parameters,
            coefficients,
            states: &states,
            modes: &modes,
            time: 0.0,
            tables: &program.tables,
            delayed: &delayed,
            sampled: &sampled,
            levels: &levels,
        };
        scratch.faults.clear();
        program.evaluate(&from, &mut registers, &mut scratch);
        unsettled = None;
        program.change_modes(&registers, &mut modes, &mut states, |mode, _| {
            unsettled = Some(program.lowered.modes[mode].element);
        });
        if unsettled.is_none() {
            break;
        }
    }
    InitialCondition { faults: root_causes(scratch.faults), unsettled }
}

/// The faults that are not consequences of others. A loop behind a faulty one has no voltages either, so its solution
/// is not a number. If all faults are of this kind, all are kept.
fn root_causes(mut faults: Vec<LoopFault>) -> Vec<LoopFault> {
    let is_consequence = |fault: &LoopFault| fault.solutions == Solutions::NotANumber;
    if !faults.iter().all(is_consequence) {
        faults.retain(|fault| !is_consequence(fault));
    }
    faults
}

/// Reports an element with a mode that does not settle, with the members of the loop that leads back to it at once.
/// Such an element is a relay that switches itself back through the loop. `None` if there is no such loop.
fn unsettled(circuit: &Circuit, program: &Program, element: usize) -> Option<Diagnostic> {
    let members = loop_through(program, element)?;
    let names: Vec<_> = members.iter().map(|member| program.name(*member)).collect();
    let message = format!(
        "the loop {} has no integrator and no position of {} satisfies it: it switches without end",
        names.join(", "),
        program.name(element)
    );
    let hint = Some("put an integrator or a lag into the loop, or invert it once more".to_owned());
    Some(Diagnostic { code: Code::LOOP_WITHOUT_SOLUTION, span: circuit.element(element).span, message, hint })
}

/// The members of the loop through an element in which everything acts in the same instant: without states and delay
/// lines. `None` if there is no such loop. The members are in the order of the circuit.
fn loop_through(program: &Program, element: usize) -> Option<Vec<usize>> {
    let states = program.lowered.states.iter().map(|state| state.element);
    let with_memory: HashSet<usize> =
        states.chain(program.lowered.delays.iter().map(|delay| delay.element)).collect();
    let cords = program.lowered.readers.iter().enumerate().flat_map(|(from, readers)| {
        readers
            .iter()
            .filter(|reader| !with_memory.contains(reader))
            .map(move |reader| (from as u32, *reader as u32))
    });
    let at_once = DiGraph::<(), ()>::from_edges(cords);
    let node = NodeIndex::new(element);
    let mut members = kosaraju_scc(&at_once).into_iter().find(|members| members.contains(&node))?;
    members.sort_unstable();
    let is_loop = members.len() > 1 || at_once.contains_edge(node, node);
    is_loop.then(|| members.into_iter().map(NodeIndex::index).collect())
}

/// The diagnostic for a loop without exactly one solution. Its position is that of the element that opens the loop.
fn diagnostic(circuit: &Circuit, program: &Program, fault: &LoopFault) -> Diagnostic {
    let (entry, solutions) = (&program.lowered.loops[fault.index], fault.solutions);
    let opener = entry.openers().next().and_then(|name| program.element(name));
    let (code, hint) = remedy(entry, solutions);
    let message = format!(
        "the loop {} has no integrator and {}",
        entry.members.join(", "),
        describe_solutions(entry, solutions)
    );
    let span = opener.and_then(|opener| circuit.element(opener).span);
    Diagnostic { code, span, message, hint: Some(hint.to_owned()) }
}
