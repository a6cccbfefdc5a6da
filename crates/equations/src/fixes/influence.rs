//! Which elements an equation depends on, so that a change is tested with these equations only.

use std::collections::HashMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::elements::OutputStage;
use patchcord_expr::{Equation, Expression, split_primes};

/// The part of a circuit that a change affects.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Part {
    /// The cords and the laws of these elements.
    Elements(Vec<usize>),
    /// The initial voltage of this element.
    Start(usize),
    /// Everything.
    All,
}

/// For each equation, the elements on which it depends.
pub(super) struct Influence {
    equations: Vec<Reached>,
}

/// The elements on which one equation depends.
struct Reached {
    /// For each element, one more than the highest order of a derivative of its output that matters. 0 if none does.
    orders: Vec<usize>,
    /// For each element, whether its cords and its law matter. Those of an integrator do not if only its output does.
    laws: Vec<bool>,
    /// Whether the equation states an initial value.
    is_initial: bool,
}

impl Influence {
    /// The dependencies of the equations of a circuit.
    pub(super) fn new(circuit: &Circuit) -> Self {
        let names = Names::new(circuit);
        let equations = circuit.equations().iter().map(|placed| names.reached(circuit, &placed.value));
        Influence { equations: equations.collect() }
    }

    /// Whether a change of a part can change whether the wiring solves the equation with this index.
    pub(super) fn affects(&self, part: &Part, equation: usize) -> bool {
        let reached = &self.equations[equation];
        match part {
            Part::Elements(elements) => elements.iter().any(|element| reached.laws[*element]),
            Part::Start(element) => reached.is_initial && reached.orders[*element] > 0,
            Part::All => true,
        }
    }
}

/// What the names of equations stand for.
struct Names<'a> {
    /// The elements of the signals and drives.
    outputs: HashMap<&'a str, usize>,
    /// The equations by the name on their left side. Those of auxiliary quantities are among them.
    definitions: HashMap<&'a str, &'a Equation>,
}

impl<'a> Names<'a> {
    /// The names of a circuit.
    fn new(circuit: &'a Circuit) -> Self {
        let elements = circuit.elements();
        let indices: HashMap<&str, usize> =
            elements.iter().enumerate().map(|(index, element)| (element.name.as_str(), index)).collect();
        let patch = circuit.patch();
        let signals = patch.signals.iter().map(|(name, signal)| (name, &signal.element.value));
        let drives = patch.drives.keys().map(|name| (name, name));
        let outputs = drives
            .chain(signals)
            .filter_map(|(name, element)| Some((name.as_str(), indices.get(element.as_str()).copied()?)));
        let definition = |equation: &'a Equation| match &equation.left().expression {
            Expression::Name(name) => Some((name.as_str(), equation)),
            _ => None,
        };
        let definitions = circuit.equations().iter().filter_map(|placed| definition(&placed.value));
        Names { outputs: outputs.collect(), definitions: definitions.collect() }
    }

    /// The elements on which an equation depends.
    fn reached(&self, circuit: &Circuit, equation: &Equation) -> Reached {
        let count = circuit.elements().len();
        let is_initial = equation.initial_quantity().is_some();
        let mut reached = Reached { orders: vec![0; count], laws: vec![false; count], is_initial };
        for (element, order) in self.quantities(equation) {
            reached.visit(circuit, element, order);
        }
        reached
    }

    /// The outputs that an equation names, also through auxiliary quantities, with the orders of their derivatives.
    fn quantities(&self, equation: &Equation) -> Vec<(usize, usize)> {
        let (mut found, mut known) = (Vec::new(), Vec::new());
        let mut open: Vec<(&str, usize)> = equation.names().into_iter().map(split_primes).collect();
        while let Some((name, order)) = open.pop() {
            if known.contains(&(name, order)) {
                continue;
            }
            known.push((name, order));
            if let Some(element) = self.outputs.get(name) {
                found.push((*element, order));
            } else if let Some(definition) = self.definitions.get(name) {
                let names = definition.right().names().into_iter().map(split_primes);
                open.extend(names.map(|(name, own)| (name, own + order)));
            }
        }
        found
    }
}

impl Reached {
    /// Adds an output with this order of its derivative, and everything on which it depends.
    fn visit(&mut self, circuit: &Circuit, element: usize, order: usize) {
        let mut open = vec![(element, order)];
        while let Some((element, order)) = open.pop() {
            if self.orders[element] > order {
                continue;
            }
            self.orders[element] = order + 1;
            let is_state = circuit.element(element).kind.output == OutputStage::Integrator;
            if is_state && order == 0 {
                continue;
            }
            self.laws[element] = true;
            let inner = if is_state { order - 1 } else { order };
            open.extend(circuit.cords(element).into_iter().map(|(from, _)| (from, inner)));
        }
    }
}

#[cfg(test)]
mod tests {
    use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};

    use super::*;

    /// A mass on a spring with x at B2 and v at A1, and a summer that no signal reads.
    fn spring(equations: &[&str]) -> Patch {
        let pot = ElementBuilder::new("pot").cord("in", "B2").set("setting", 0.4);
        let patch = PatchBuilder::new("spring")
            .scale("one", 1.0, "1")
            .element("A1", ElementBuilder::new("integrator").cords("x10", ["P1"]))
            .element("A2", ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50))
            .element("B2", ElementBuilder::new("inverter").cord("in", "A2"))
            .element("P1", pot)
            .element("S", ElementBuilder::new("summer").cords("x1", ["A1"]))
            .signal("x", "B2", "one", 1.0)
            .signal("v", "A1", "one", 1.0);
        equations.iter().fold(patch, |patch, equation| patch.equation(equation)).build().unwrap()
    }

    /// The elements on whose cords each equation depends.
    fn laws(equations: &[&str]) -> Vec<Vec<String>> {
        let circuit = Circuit::new(&spring(equations)).unwrap();
        let influence = Influence::new(&circuit);
        let elements = circuit.elements();
        let affecting = |equation: usize| -> Vec<String> {
            let affects = |index: &usize| influence.affects(&Part::Elements(vec![*index]), equation);
            (0..elements.len()).filter(affects).map(|index| elements[index].name.clone()).collect()
        };
        (0..equations.len()).map(affecting).collect()
    }

    #[test]
    fn a_derivative_leads_through_as_many_integrators() {
        let found = laws(&["x' = v", "x'' = -4 x", "v = x'", "twice = 2 v", "x + twice' = 0"]);
        assert_eq!(found[0], ["A2", "B2"]);
        assert_eq!(found[1], ["A1", "A2", "B2", "P1"]);
        assert_eq!(found[2], ["A2", "B2"]);
        assert_eq!(found[3], Vec::<String>::new());
        assert_eq!(found[4], ["A1", "B2", "P1"]);
    }

    #[test]
    fn an_initial_voltage_affects_initial_values_only() {
        let circuit = Circuit::new(&spring(&["x' = v", "x(0) = -50", "v(0) = 0"])).unwrap();
        let influence = Influence::new(&circuit);
        let a2 = circuit.elements().iter().position(|element| element.name == "A2").unwrap();
        let affected: Vec<bool> =
            (0..3).map(|equation| influence.affects(&Part::Start(a2), equation)).collect();
        assert_eq!(affected, [false, true, false]);
        assert!(influence.affects(&Part::All, 2));
    }
}
