//! From a problem to its plan.

use std::collections::{BTreeMap, HashMap, HashSet};

use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Diagnostic, Placed, formula_diagnostic};
use patchcord_core::patch::Problem;
use patchcord_expr::{Equation, FormulaError};

use super::builder::{Builder, NameKind};
use super::constants::Constants;
use super::expressions::Reader;
use super::finish::Draft;
use super::initial::InitialValues;
use super::joint::{Joint, coupled, solved_together, without};
use super::matching::{Matching, matched};
use super::trees::{Occurrence, occurrences};
use super::undetermined::faults;
use super::unknowns::{Unknown, Unknowns, laws};
use crate::graph::{NodeId, Operation, Plan, Sum};
use crate::notation::primed;
use crate::symbolic::Fraction;

/// The plan of a problem. `circuit` is the circuit of its patch.
///
/// # Errors
/// If the equations do not determine every quantity, a state has no initial value, or the machine has no elements for
/// an expression. The list has all faults of one kind, with their positions in the text of the problem.
pub(crate) fn plan(problem: &Problem, circuit: &Circuit) -> Result<Plan, Vec<Diagnostic>> {
    let unknowns = Unknowns::new(problem, circuit);
    refuse(unknowns.derivative_faults(problem, circuit))?;
    let mut constants = Constants::new(circuit);
    constants.add_quantities(circuit, &unknowns);
    let matching = matched(circuit, &unknowns, &constants);
    refuse(faults(problem, circuit, &unknowns, &matching))?;
    let laws = paired(circuit, &unknowns, &matching, &constants);
    let implicit: Vec<&str> =
        laws.iter().filter(|law| law.is_implicit).map(|law| law.name.as_str()).collect();
    let initial = InitialValues { problem, circuit, constants: &constants };
    let (initials, findings) = initial.all(&unknowns, &implicit);
    refuse(findings)?;
    let builder = Builder::new(problem, circuit, &constants);
    let mut planner = Planner { problem, circuit, builder, names: BTreeMap::new() };
    planner.reserve_all(&unknowns, &laws);
    let rates = planner.read(&laws, &initials)?;
    planner.integrate(&unknowns, &initials, &rates);
    planner.draft(&unknowns, &laws).finished()
}

/// Fails if there are faults.
fn refuse(faults: Vec<Diagnostic>) -> Result<(), Vec<Diagnostic>> {
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

/// An equation and the unknown that it determines.
struct Law<'a> {
    /// The unknown.
    unknown: &'a Unknown,
    /// Its name with primes.
    name: String,
    /// The index of the equation.
    equation: usize,
    /// Whether the equation is not linear in the unknown.
    is_implicit: bool,
}

/// The equations with the unknowns that they determine.
fn paired<'a>(
    circuit: &Circuit,
    unknowns: &'a Unknowns,
    matching: &Matching,
    constants: &Constants,
) -> Vec<Law<'a>> {
    let law = |(equation, placed): (usize, &Placed<Equation>)| {
        let unknown = &unknowns.all[matching.of_equation[equation]?];
        let name = unknown.name();
        let is_implicit = occurrences(&placed.value, &name, constants).contains(&Occurrence::Nonlinear);
        Some(Law { unknown, name, equation, is_implicit })
    };
    laws(circuit).filter_map(law).collect()
}

/// Makes the nodes of the quantities.
struct Planner<'a> {
    /// The problem.
    problem: &'a Problem,
    /// The circuit of the problem.
    circuit: &'a Circuit,
    /// Makes the nodes.
    builder: Builder<'a>,
    /// The nodes of the quantities, by name with primes.
    names: BTreeMap<String, NodeId>,
}

impl<'a> Planner<'a> {
    /// Makes a node for every state, every algebraic quantity, and every highest derivative that needs one.
    fn reserve_all(&mut self, unknowns: &Unknowns, laws: &[Law<'_>]) {
        let counts = self.counts();
        let implicit = laws.iter().filter(|law| law.is_implicit).map(|law| law.name.as_str());
        let implicit: HashSet<&str> = implicit.collect();
        for unknown in &unknowns.all {
            let name = unknown.name();
            for primes in 0..unknown.order {
                self.reserve(primed(&unknown.base, primes));
            }
            let needs_node = match unknown.order {
                0 => self.builder.constants.named(&name).is_none(),
                _ => implicit.contains(name.as_str()) || counts.get(name.as_str()) > Some(&1),
            };
            if needs_node || unknown.is_declared {
                self.reserve(name);
            }
        }
    }

    /// The number of equations that contain each name.
    fn counts(&self) -> HashMap<&'a str, usize> {
        let mut counts = HashMap::new();
        for (_, placed) in laws(self.circuit) {
            for name in placed.value.names() {
                *counts.entry(name).or_default() += 1;
            }
        }
        counts
    }

    /// Makes the node of a quantity.
    fn reserve(&mut self, name: String) {
        let is_declared = self.problem.quantities.contains_key(&name);
        let kind = if is_declared { NameKind::Declared } else { NameKind::Implied };
        let node = self.builder.reserve(&name, kind);
        self.names.insert(name, node);
    }

    /// Reads the equations. Returns the highest derivative of each state, by the name of the derivative. `starts` has the
    /// values near which implicit equations are solved.
    ///
    /// # Errors
    /// All expressions that no elements compute.
    fn read(
        &mut self,
        laws: &[Law<'_>],
        starts: &BTreeMap<String, Fraction>,
    ) -> Result<BTreeMap<String, Sum>, Vec<Diagnostic>> {
        let (mut rates, mut findings) = (self.joint_solutions(laws)?, Vec::new());
        for law in laws {
            // A constant that only equations name has no node.
            let has_no_node = law.unknown.order == 0 && !self.names.contains_key(&law.name);
            if has_no_node || rates.contains_key(&law.name) {
                continue;
            }
            let circuit = self.circuit;
            let placed = &circuit.equations()[law.equation];
            let mut reader = self.reader(placed.value.text());
            let operation = match law.is_implicit {
                true => reader.implicit_solution(&placed.value, &law.name, starts.get(&law.name)),
                false => reader.linear_solution(&placed.value, &law.name).map(Operation::Sum),
            };
            match operation {
                Ok(operation) => {
                    let value = self.define(law, operation);
                    rates.insert(law.name.clone(), value);
                }
                Err(error) => findings.push(formula_diagnostic(Code::BAD_FORMULA, placed, error)),
            }
        }
        refuse(findings)?;
        Ok(rates)
    }

    /// Reads the expressions of an equation with this text.
    fn reader(&mut self, text: &'a str) -> Reader<'_, 'a> {
        Reader { builder: &mut self.builder, names: &self.names, text }
    }

    /// Solves the equations that share their unknowns with constant factors. Returns the values of these unknowns, by
    /// name.
    ///
    /// # Errors
    /// Equations that do not determine their unknowns.
    fn joint_solutions(&mut self, laws: &[Law<'_>]) -> Result<BTreeMap<String, Sum>, Vec<Diagnostic>> {
        let equations = self.circuit.equations();
        let pairs: Vec<(&Equation, &str)> =
            laws.iter().map(|law| (&equations[law.equation].value, law.name.as_str())).collect();
        let (mut values, mut findings) = (BTreeMap::new(), Vec::new());
        for group in coupled(&pairs, self.builder.constants) {
            let group: Vec<&Law<'_>> = group.into_iter().map(|index| &laws[index]).collect();
            match self.joint_solution(&group) {
                Ok(Some(sums)) => {
                    for (law, sum) in group.iter().zip(sums) {
                        let value = self.define(law, Operation::Sum(sum));
                        values.insert(law.name.clone(), value);
                    }
                }
                Ok(None) => {}
                Err(fault) => findings.push(*fault),
            }
        }
        refuse(findings)?;
        Ok(values)
    }

    /// The unknowns of a group of equations. `None` if each equation is to be solved for its own unknown: it has a fault,
    /// the formulas would be too long, or the equations only set quantities equal to each other.
    ///
    /// # Errors
    /// If the equations do not determine their unknowns.
    fn joint_solution(&mut self, group: &[&Law<'_>]) -> Result<Option<Vec<Sum>>, Box<Diagnostic>> {
        let circuit = self.circuit;
        let (mut nodes, mut residuals) = (Vec::new(), Vec::new());
        for law in group {
            let equation = &circuit.equations()[law.equation].value;
            let residual = self.reader(equation.text()).residual(equation);
            let (Some(node), Ok(residual)) = (self.names.get(&law.name).copied(), residual) else {
                return Ok(None);
            };
            nodes.push(node);
            residuals.push(residual);
        }
        match solved_together(&residuals, &nodes, self.builder.constants) {
            Joint::Solved(values) => Ok(Some(values)),
            Joint::TooLong => Ok(None),
            Joint::Singular => {
                let is_equality = |residual: &Sum| without(residual, &nodes).terms.is_empty();
                if residuals.iter().all(is_equality) { Ok(None) } else { Err(Box::new(self.singular(group))) }
            }
        }
    }

    /// The fault of equations that do not determine their unknowns.
    fn singular(&self, group: &[&Law<'_>]) -> Diagnostic {
        let placed = &self.circuit.equations()[group[0].equation];
        let names: Vec<&str> = group.iter().map(|law| law.name.as_str()).collect();
        let message = format!("{} equations do not determine {}", names.len(), names.join(", "));
        let hint = "the same combination of these is in several of the equations: change one of them, or a parameter";
        let range = placed.value.range_of(names[0]).unwrap_or_default();
        formula_diagnostic(
            Code::BAD_FORMULA,
            placed,
            FormulaError { range, message, hint: Some(hint.to_owned()) },
        )
    }

    /// Gives the node of an unknown its operation, if it has a node. Returns the value of the unknown.
    fn define(&mut self, law: &Law<'_>, operation: Operation) -> Sum {
        match (self.names.get(&law.name), operation) {
            (Some(node), operation) => {
                self.builder.define(*node, operation);
                Sum::node(*node)
            }
            (None, Operation::Sum(value)) => value,
            (None, operation) => Sum::node(self.builder.add(operation)),
        }
    }

    /// Makes the chains of integrals.
    fn integrate(
        &mut self,
        unknowns: &Unknowns,
        initials: &BTreeMap<String, Fraction>,
        rates: &BTreeMap<String, Sum>,
    ) {
        for unknown in &unknowns.all {
            for primes in 0..unknown.order {
                let [name, derivative] = [primes, primes + 1].map(|primes| primed(&unknown.base, primes));
                let node_of = |name: &str| self.names.get(name).copied();
                let rate = rates.get(&derivative).cloned().or_else(|| node_of(&derivative).map(Sum::node));
                if let (Some(node), Some(rate), Some(initial)) = (node_of(&name), rate, initials.get(&name)) {
                    self.builder.define(node, Operation::Integral { initial: initial.clone(), rate });
                }
            }
        }
    }

    /// The nodes, as they are before equal ones are joined.
    fn draft(self, unknowns: &Unknowns, laws: &[Law<'_>]) -> Draft<'a> {
        let declared = self.problem.quantities.keys().cloned();
        let states = unknowns.all.iter().flat_map(|unknown| {
            let last = if unknown.order == 0 { 1 } else { unknown.order };
            (0..last).map(move |primes| primed(&unknown.base, primes))
        });
        let implied = states.filter(|name| !self.problem.quantities.contains_key(name));
        let quantities = declared.chain(implied);
        let quantities = quantities.filter_map(|name| Some((self.names.get(&name).copied()?, name)));
        let equations =
            laws.iter().filter_map(|law| Some((self.names.get(&law.name).copied()?, law.equation)));
        Draft {
            problem: self.problem,
            circuit: self.circuit,
            constants: self.builder.constants,
            quantities: quantities.map(|(node, name)| (name, node)).collect(),
            equations: equations.collect(),
            entries: self.builder.entries,
            angles: self.builder.angles,
        }
    }
}
