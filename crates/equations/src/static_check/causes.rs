//! Why outputs are not compared: they depend on an amplifier that is overloaded, or on an element outside its range.

use std::collections::BTreeMap;

use patchcord_core::ir::{Loop, Op, Program, Register};

use super::tolerances::Tolerances;
use super::wired::Wired;
use crate::operating_point::{OVERLOAD, out_of_range};

/// Share of an amplifier's inputs by which its output differs from their sum if its diodes conduct.
const DIODES_CONDUCT: f64 = 1e-6;

/// The elements of one kind of fault, and the outputs that depend on them.
pub(super) struct Causes {
    /// The clause for each register at which a cause begins.
    clauses: BTreeMap<Register, String>,
    /// For each number of derivatives and each register, the register of the cause on which the derivative depends.
    /// Empty if there is no cause.
    layers: Vec<Vec<Option<Register>>>,
}

impl Causes {
    /// The overloaded amplifiers. `deepest` is the largest number of derivatives.
    pub(super) fn overloads(wired: &Wired<'_>, deepest: usize) -> Self {
        let program = wired.program;
        let name = |element: usize| &program.element_outputs()[element].name;
        let clause = |element: usize| format!("{} is overloaded", name(element));
        let lamps = program.lamps().iter().filter(|lamp| wired.volts(lamp.demand).abs() > OVERLOAD);
        let lamps = lamps.map(|lamp| (lamp.output, clause(lamp.element)));
        let states = program.state_laws().iter().zip(&wired.point.states);
        let states = states.filter(|(_, volts)| volts.abs() > OVERLOAD);
        let states =
            states.map(|(law, _)| (program.element_outputs()[law.element].register, clause(law.element)));
        Self::new(program, lamps.chain(states).collect(), deepest)
    }

    /// The networks whose inputs are outside their range, and the amplifiers that their diodes limit.
    pub(super) fn limits(wired: &Wired<'_>, tolerances: &Tolerances<'_>, deepest: usize) -> Self {
        let program = wired.program;
        let outputs = program.element_outputs();
        let limited = (0..outputs.len()).filter(|element| has_conducting_diodes(wired, tolerances, *element));
        let limited = limited.map(|element| {
            (outputs[element].register, format!("{} is limited by its diodes", outputs[element].name))
        });
        let ranged = out_of_range(program, &wired.voltages).into_iter();
        let ranged = ranged.map(|register| (register, "a network is outside its range".to_owned()));
        let mut causes = Self::new(program, limited.chain(ranged).collect(), deepest);
        causes.name_networks(program);
        causes
    }

    /// The causes that begin at some registers, with the outputs that depend on them.
    fn new(program: &Program, clauses: BTreeMap<Register, String>, deepest: usize) -> Self {
        let mut layers: Vec<Vec<Option<Register>>> = Vec::new();
        let begins = |register: Register, from: Option<Register>| {
            from.or_else(|| clauses.contains_key(&register).then_some(register))
        };
        if !clauses.is_empty() {
            let states = program.state_laws();
            layers.push(spread(program, &vec![None; states.len()], &begins));
            for order in 1..=deepest {
                let rates: Vec<Option<Register>> =
                    states.iter().map(|state| layers[order - 1][state.demand.index()]).collect();
                layers.push(spread(program, &rates, &begins));
            }
        }
        Causes { clauses, layers }
    }

    /// Names the network of every input outside its range: the first output that depends on it.
    fn name_networks(&mut self, program: &Program) {
        let Some(layer) = self.layers.first() else { return };
        for (register, clause) in &mut self.clauses {
            let outputs = program.element_outputs().iter();
            let dependent = outputs.filter(|output| layer[output.register.index()] == Some(*register));
            let first = dependent.min_by_key(|output| output.register);
            if let Some(network) = first.filter(|output| output.register != *register) {
                *clause = format!("{} is outside its range", network.name);
            }
        }
    }

    /// The clause of the cause on which a derivative of a register depends. `None` if there is none.
    pub(super) fn behind(&self, register: Register, order: usize) -> Option<&str> {
        let cause = self.layers.get(order)?[register.index()]?;
        self.clauses.get(&cause).map(String::as_str)
    }
}

/// Whether the diodes of a summer change its output: it is not the sum of its inputs.
fn has_conducting_diodes(wired: &Wired<'_>, tolerances: &Tolerances<'_>, element: usize) -> bool {
    if wired.circuit.element(element).kind.name != "summer" {
        return false;
    }
    let Some(lamp) = wired.program.lamps().iter().find(|lamp| lamp.element == element) else { return false };
    let inputs = tolerances.inputs(element, 0);
    let sum: f64 = inputs.iter().sum();
    let size: f64 = inputs.iter().map(|input| input.abs()).sum();
    (wired.volts(lamp.demand) + sum).abs() > DIODES_CONDUCT * (1.0 + size)
}

/// What every register gets from the registers that it reads: that of the first one which has any. `states` has what the
/// states have. `visit` gets a register with what it has so far, and returns what it has.
pub(super) fn spread<T: Copy + PartialEq>(
    program: &Program,
    states: &[Option<T>],
    visit: &dyn Fn(Register, Option<T>) -> Option<T>,
) -> Vec<Option<T>> {
    let mut spreading = Spreading { program, states, visit, found: vec![None; program.body().len()] };
    let mut at = 0;
    while at < program.body().len() {
        at = match program.body()[at] {
            Op::Tear { index, .. } => spreading.close(&program.loops()[index as usize]),
            _ => spreading.read(at),
        };
    }
    spreading.found
}

/// A spreading in progress.
struct Spreading<'s, T> {
    program: &'s Program,
    states: &'s [Option<T>],
    visit: &'s dyn Fn(Register, Option<T>) -> Option<T>,
    /// What the registers have so far.
    found: Vec<Option<T>>,
}

impl<T: Copy + PartialEq> Spreading<'_, T> {
    /// Lets a register read its operands. Returns the index that follows.
    fn read(&mut self, at: usize) -> usize {
        let from = match self.program.body()[at] {
            Op::State(state) => self.states[state as usize],
            op => op.operands().find_map(|register| self.found[register.index()]),
        };
        self.found[at] = (self.visit)(Register(at as u32), from);
        at + 1
    }

    /// Lets all registers of a loop read each other. Returns the index that follows.
    fn close(&mut self, entry: &Loop) -> usize {
        let tears = |found: &[Option<T>]| -> Vec<Option<T>> {
            entry.tears.iter().map(|tear| found[tear.result.index()]).collect()
        };
        let mut before = None;
        // What a tear has can reach every other one, but not more often than there are tears.
        for _ in 0..=entry.tears.len() {
            for tear in &entry.tears {
                let from = self.found[tear.result.index()];
                self.found[tear.register.index()] = (self.visit)(tear.register, from);
            }
            for at in entry.operations.clone() {
                self.read(at);
            }
            let after = tears(&self.found);
            if before.as_ref() == Some(&after) {
                break;
            }
            before = Some(after);
        }
        entry.operations.end
    }
}
