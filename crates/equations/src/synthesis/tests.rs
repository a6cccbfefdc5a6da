//! Tests with hand-made plans.

mod documents;
mod exponents;
mod faults;
mod formulas;
mod operations;
mod polarities;
mod scales;
mod thesis;

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::machines;
use patchcord_core::patch::Problem;
use patchcord_core::solve::Machine;
use patchcord_expr::Unit;

use super::{ScaleOptions, Scales, Synthesis, choose_scales, synthesise};
use crate::graph::{Node, NodeId, Operation, Plan, PlannedQuantity, Sum, Term};
use crate::peaks::Ranges;
use crate::symbolic::{Fraction, SymbolEntry, SymbolKind, Symbols};
use crate::testing::reading::read_with;

/// The machine without limits, and the time scale that the synthesis chooses.
fn options() -> ScaleOptions {
    ScaleOptions { machine: machines::DEFAULT_MACHINE, time_scale: None, keeps_maxima: true }
}

/// A problem with a hand-made plan and ranges.
struct Sketch {
    problem: Problem,
    circuit: Circuit,
    plan: Plan,
    ranges: Ranges,
}

impl Sketch {
    /// A problem without a plan.
    fn new(text: &str) -> Self {
        let problem = Problem::parse("problem.json", text).unwrap_or_else(|report| panic!("{report}"));
        let circuit = Circuit::new(&problem.patch).unwrap_or_else(|report| panic!("{report}"));
        let mut symbols = Symbols::default();
        for (index, (name, parameter, _)) in circuit.parameters().enumerate() {
            let (kind, dimension) = (SymbolKind::Parameter(index), parameter.unit.dimension());
            symbols.add(SymbolEntry { name: name.to_owned(), primes: 0, kind, dimension }, true);
        }
        let plan = Plan { symbols, nodes: Vec::new(), quantities: Vec::new() };
        let ranges = Ranges { nodes: Vec::new(), rates: Vec::new() };
        Sketch { problem, circuit, plan, ranges }
    }

    /// An expression of parameters.
    fn read(&self, text: &str) -> Fraction {
        read_with(text, &|name| self.plan.symbols.find(name, 0).unwrap_or_else(|| panic!("{name}")))
    }

    /// A weighted sum of nodes, by their indices.
    fn sum(&self, terms: &[(&str, u32)]) -> Sum {
        let terms = terms.iter().map(|(coefficient, node)| (NodeId(*node), self.read(coefficient)));
        Sum { terms: terms.collect::<BTreeMap<_, _>>() }
    }

    /// A node times a coefficient.
    fn term(&self, coefficient: &str, node: u32) -> Term {
        Term { coefficient: self.read(coefficient), node: NodeId(node) }
    }

    /// Adds a node with its range and its largest rate in SI units.
    fn node(&mut self, name: &str, unit: &str, range: [f64; 2], rate: f64, operation: Operation) {
        let dimension = Unit::parse(unit).unwrap().dimension();
        self.plan.nodes.push(Node { name: name.to_owned(), dimension, operation });
        self.ranges.nodes.push(range);
        self.ranges.rates.push(rate);
    }

    /// Adds an integral with its initial value and its rate.
    fn integral(&mut self, name: &str, unit: &str, peaks: [f64; 2], initial: &str, rate: &[(&str, u32)]) {
        let operation = Operation::Integral { initial: self.read(initial), rate: self.sum(rate) };
        self.node(name, unit, [-peaks[0], peaks[0]], peaks[1], operation);
    }

    /// Adds a constant quantity of a pure number.
    fn constant(&mut self, name: &str, value: f64) {
        let initial = Fraction::number(value);
        let operation = Operation::Integral { initial, rate: Sum::default() };
        self.node(name, "1", [value, value], 0.0, operation);
    }

    /// Makes all nodes with the names of declared quantities these quantities.
    fn with_quantities(mut self) -> Self {
        for (index, node) in self.plan.nodes.iter().enumerate() {
            let is_declared = self.problem.quantities.contains_key(&node.name);
            if is_declared && !matches!(node.operation, Operation::Drive(_)) {
                let node_id = NodeId(index as u32);
                self.plan.quantities.push(PlannedQuantity { name: node.name.clone(), node: node_id });
            }
        }
        self
    }

    /// The chosen scales.
    fn scales(&self) -> Scales {
        choose_scales(&self.plan, &self.problem, &self.circuit, &self.ranges, &options())
    }

    /// The patch with these scales.
    fn synthesis_with(&self, scales: &Scales, options: &ScaleOptions) -> Synthesis {
        let made = synthesise(&self.plan, &self.problem, &self.circuit, &self.ranges, scales, options);
        made.unwrap_or_else(|faults| panic!("{faults:?}"))
    }

    /// The patch with the chosen scales.
    fn synthesis(&self) -> Synthesis {
        self.synthesis_with(&self.scales(), &options())
    }

    /// The messages of the faults of the synthesis.
    fn faults(&self, options: &ScaleOptions) -> Vec<String> {
        let scales = choose_scales(&self.plan, &self.problem, &self.circuit, &self.ranges, options);
        let made = synthesise(&self.plan, &self.problem, &self.circuit, &self.ranges, &scales, options);
        made.unwrap_err().into_iter().map(|fault| fault.message).collect()
    }
}

/// The values of quantities, in SI units, and the rates of integrators in initial condition.
struct Reading {
    circuit: Circuit,
    /// The voltage of each signal of the patch.
    volts: Vec<f64>,
    /// The rate of each state in volts per problem second, with the name of its element.
    rates: Vec<(String, f64)>,
}

impl Reading {
    /// Patches a circuit and sets it to initial condition. No amplifier may be overloaded.
    fn of(synthesis: &Synthesis) -> Self {
        let text = synthesis.patch.text();
        let circuit = Circuit::new(&synthesis.patch).unwrap_or_else(|report| panic!("{report}\n{text}"));
        let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}\n{text}"));
        let machine = Machine::new(&program, 1e-4).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert!(!machine.is_overloaded(), "{text}");
        let volts = |signal: &patchcord_core::patch::Signal| machine.voltage(&signal.element.value).unwrap();
        let volts = circuit.patch().signals.values().map(volts).collect();
        let states = program.states().into_iter().map(str::to_owned);
        let rates = states.zip(machine.rates().iter().copied()).collect();
        Reading { circuit, volts, rates }
    }

    /// The value of a signal per volt of its element, in SI units.
    fn per_volt(&self, name: &str) -> f64 {
        let signal = &self.circuit.patch().signals[name];
        let scale = self.circuit.derived_index(&signal.scale.as_ref().unwrap().value).unwrap();
        let unit = self.circuit.derived_unit(scale).factor();
        signal.factor * self.circuit.per_volt(scale).unwrap() * unit
    }

    /// The value of a quantity in SI units.
    fn value(&self, name: &str) -> f64 {
        let index = self.circuit.patch().signals.get_index_of(name).unwrap();
        self.volts[index] * self.per_volt(name)
    }

    /// The rate of a quantity that is read at an integrator, or at its inverter, in SI units.
    fn rate(&self, name: &str) -> f64 {
        let element = &self.circuit.patch().signals[name].element.value;
        let rate = |element: &str| self.rates.iter().find(|(name, _)| name == element).map(|(_, rate)| *rate);
        let of_inverter = || {
            let entry = &self.circuit.patch().elements[element];
            Some(-rate(&entry.plugs[0].from.value)?)
        };
        rate(element).or_else(of_inverter).unwrap() * self.per_volt(name)
    }
}

/// Fails if two numbers differ by more than a millionth.
#[track_caller]
fn assert_close(found: f64, expected: f64) {
    let difference = (found - expected).abs();
    assert!(difference <= 1e-6 * expected.abs().max(1e-9), "{found} instead of {expected}");
}
