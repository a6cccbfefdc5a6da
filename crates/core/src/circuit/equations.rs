//! Checks the equations of a patch: their names, their definitions and their dimensions.
//!
//! An equation can name signals, drives, parameters, the time `t` and *auxiliary quantities*. An auxiliary quantity is a
//! name that is nothing else and stands alone on the left of one equation, such as `F_s` in `F_s = k x`. Its dimension
//! is that of the right side.
//!
//! An equation such as `x(0) = x0` states the initial value of a signal by parameters. The module `initial` has its
//! rules.
//!
//! The checks run in the order in which they need each other: names, initial values, left sides, auxiliary quantities,
//! dimensions. A check stays silent about an equation in which an earlier one has found a fault.

mod initial;
mod names;
mod notations;
mod scope;

use std::collections::{HashMap, HashSet};

use indexmap::IndexMap;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::Circuit;
use crate::document::{Code, Diagnostic, Placed, dimension_diagnostic, formula_diagnostic};
use crate::patch::{Patch, is_time_dimensionless};
use names::{NameChecker, how_to_add};
use patchcord_expr::{Dimension, Equation, Expression, FormulaError, Node, Scope, split_primes};
pub use scope::EquationScope;

/// The auxiliary quantities with their dimensions. `None` if the dimension is not known because of a fault.
pub(super) type Auxiliaries = IndexMap<String, Option<Dimension>>;

/// Checks the equations of a patch. Returns its auxiliary quantities.
pub(super) fn check(patch: &Patch, findings: &mut Vec<Diagnostic>) -> Auxiliaries {
    let definitions = definitions(patch);
    let auxiliaries = definitions.keys().map(|name| (name.clone(), None)).collect();
    let mut checker = EquationChecker {
        patch,
        definitions,
        auxiliaries,
        is_sound: vec![true; patch.equations.len()],
        is_time_dimensionless: is_time_dimensionless(patch),
    };
    checker.check_names(findings);
    checker.check_initial_values(findings);
    checker.check_left_sides(findings);
    checker.derive_auxiliaries(findings);
    checker.check_dimensions(findings);
    checker.auxiliaries
}

/// The auxiliary quantities, each with the index of the first equation that defines it. A derivative or an initial
/// value on the left defines none.
fn definitions(patch: &Patch) -> IndexMap<String, usize> {
    let mut definitions = IndexMap::new();
    for (index, placed) in patch.equations.iter().enumerate() {
        if let Expression::Name(name) = &placed.value.left().expression
            && split_primes(name).0 == name
            && !scope::is_taken(patch, name)
            && !patch.unread_names().can_include(name)
        {
            definitions.entry(name.clone()).or_insert(index);
        }
    }
    definitions
}

/// Checks the equations of one patch.
struct EquationChecker<'a> {
    /// The patch, for its equations and their names.
    patch: &'a Patch,
    /// The auxiliary quantities with the indices of their equations.
    definitions: IndexMap<String, usize>,
    /// The auxiliary quantities with the dimensions that are known so far.
    auxiliaries: Auxiliaries,
    /// For each equation, whether no check has found a fault in it.
    is_sound: Vec<bool>,
    /// Whether times count as pure numbers.
    is_time_dimensionless: bool,
}

impl EquationChecker<'_> {
    /// The names that the equations can use, with the dimensions that are known so far.
    fn scope(&self) -> EquationScope<'_> {
        EquationScope::new(self.patch, &self.auxiliaries, self.is_time_dimensionless)
    }

    /// Reports unknown and ambiguous names, names of elements and scales, and primes after names that have no
    /// derivative.
    fn check_names(&mut self, findings: &mut Vec<Diagnostic>) {
        let scope = self.scope();
        let checker = NameChecker { patch: self.patch, scope: &scope };
        let is_sound = self.patch.equations.iter().map(|placed| checker.check(placed, findings)).collect();
        self.is_sound = is_sound;
    }

    /// Reports initial values in wrong places and those that depend on other names than parameters.
    fn check_initial_values(&mut self, findings: &mut Vec<Diagnostic>) {
        for (placed, is_sound) in self.patch.equations.iter().zip(&mut self.is_sound) {
            if *is_sound && let Some(error) = initial::fault(self.patch, &placed.value) {
                *is_sound = false;
                findings.push(formula_diagnostic(Code::BAD_FORMULA, placed, error));
            }
        }
    }

    /// Reports equations with the same left side. Left sides without a name, such as 0, may be the same.
    fn check_left_sides(&mut self, findings: &mut Vec<Diagnostic>) {
        let mut first_indices = HashMap::new();
        for (index, placed) in self.patch.equations.iter().enumerate() {
            let left = placed.value.left();
            if left.names().is_empty() {
                continue;
            }
            let mut form = String::new();
            push_form(left, &mut form);
            if *first_indices.entry(form).or_insert(index) != index {
                self.is_sound[index] = false;
                findings.push(repeated_left_side(placed));
            }
        }
    }

    /// Derives the dimensions of the auxiliary quantities, each after those on its right side. Reports quantities that
    /// depend on themselves.
    ///
    /// Each strongly connected component of the graph of definitions comes after those on which it depends. A component
    /// with several members, or with an edge to itself, is a circular definition.
    fn derive_auxiliaries(&mut self, findings: &mut Vec<Diagnostic>) {
        let graph = self.definition_graph();
        for mut members in kosaraju_scc(&graph) {
            members.sort_unstable();
            let first = members[0];
            if members.len() > 1 || graph.contains_edge(first, first) {
                findings.push(self.circular_definition(&members));
                continue;
            }
            let equation = self.definitions[first.index()];
            let placed = &self.patch.equations[equation];
            if !self.has_dimensions(equation, placed.value.right()) {
                continue;
            }
            let dimension = placed.value.right_dimension(&self.scope());
            match dimension {
                Ok(dimension) => self.auxiliaries[first.index()] = Some(dimension.or_dimensionless()),
                Err(error) => findings.push(dimension_diagnostic(&self.scope(), placed, error)),
            }
        }
    }

    /// The graph of the auxiliary quantities, with an edge to every one on the right side of another's definition.
    fn definition_graph(&self) -> DiGraph<(), ()> {
        let mut graph = DiGraph::new();
        for _ in &self.definitions {
            graph.add_node(());
        }
        for (quantity, equation) in self.definitions.values().enumerate() {
            for name in self.patch.equations[*equation].value.right().names() {
                if let Some(used) = self.definitions.get_index_of(split_primes(name).0) {
                    graph.update_edge(NodeIndex::new(quantity), NodeIndex::new(used), ());
                }
            }
        }
        graph
    }

    /// The diagnostic for auxiliary quantities that depend on themselves or on each other, at the first of them.
    fn circular_definition(&self, members: &[NodeIndex]) -> Diagnostic {
        let entries = members.iter().filter_map(|index| self.definitions.get_index(index.index()));
        let names: Vec<&str> = entries.map(|(name, _)| name.as_str()).collect();
        let first = names[0];
        let message = match names.as_slice() {
            [only] => format!("the auxiliary quantity {only} depends on itself"),
            names => format!("the auxiliary quantities {} depend on each other", names.join(", ")),
        };
        let placed = &self.patch.equations[self.definitions[first]];
        let hint = format!("{}, or define {first} by other quantities", how_to_add(self.patch, first));
        let range = placed.value.left().range.clone();
        formula_diagnostic(Code::BAD_FORMULA, placed, FormulaError { range, message, hint: Some(hint) })
    }

    /// Reports equations whose sides or terms differ in dimension.
    ///
    /// The definition of an auxiliary quantity needs no comparison: its left side has the dimension of the right one.
    fn check_dimensions(&self, findings: &mut Vec<Diagnostic>) {
        let scope = self.scope();
        let definitions: HashSet<usize> = self.definitions.values().copied().collect();
        for (index, placed) in self.patch.equations.iter().enumerate() {
            let equation = &placed.value;
            let is_checkable =
                [equation.left(), equation.right()].into_iter().all(|side| self.has_dimensions(index, side));
            if is_checkable
                && !definitions.contains(&index)
                && let Err(error) = equation.dimension_check(&scope)
            {
                findings.push(dimension_diagnostic(&scope, placed, error));
            }
        }
    }

    /// Whether an equation has no fault so far, and all names on one of its sides have a dimension. The lack of a
    /// dimension follows from a fault that was reported.
    fn has_dimensions(&self, equation: usize, side: &Node) -> bool {
        let scope = self.scope();
        self.is_sound[equation] && side.names().into_iter().all(|name| scope.dimension(name).is_some())
    }
}

/// The diagnostic for an equation with the left side of an earlier one.
fn repeated_left_side(placed: &Placed<Equation>) -> Diagnostic {
    let range = placed.value.left().range.clone();
    let message = "another equation has the same left side".to_owned();
    let hint = Some("remove one of the two, or write it for another quantity".to_owned());
    formula_diagnostic(Code::DUPLICATE_NAME, placed, FormulaError { range, message, hint })
}

/// Adds a text to `form` that is the same for all spellings of an expression, such as `m x` and `m*(x)`.
fn push_form(node: &Node, form: &mut String) {
    let mut push_operands = |name: &str, operands: &[&Node]| {
        form.push_str(name);
        form.push('(');
        for operand in operands {
            push_form(operand, form);
            form.push(',');
        }
        form.push(')');
    };
    match &node.expression {
        Expression::Number(value) => push_operands(&value.to_string(), &[]),
        Expression::Name(name) => push_operands(name, &[]),
        Expression::Negate(inner) => push_operands("-", &[inner]),
        Expression::Binary(operator, left, right) => push_operands(&format!("{operator:?}"), &[left, right]),
        Expression::Call(callee, arguments) => {
            push_operands(callee.name(), &arguments.iter().collect::<Vec<_>>());
        }
        Expression::Apply(name, arguments) => push_operands(name, &arguments.iter().collect::<Vec<_>>()),
    }
}

impl Circuit {
    /// The equations that the wiring is meant to solve, in the order of the patch.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("decay")
    ///     .parameter("T", 1.0, "s", [0.1, 10.0])
    ///     .scale("position", 2.0, "mm")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1"]))
    ///     .signal("x", "A1", "position", 1.0)
    ///     .equation("T x' = -x")
    ///     .build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// assert_eq!(circuit.equations()[0].value.names(), ["T", "x'", "x"]);
    /// # Ok(())
    /// # }
    /// ```
    pub fn equations(&self) -> &[Placed<Equation>] {
        &self.patch.equations
    }

    /// The names that the equations can use, with their dimensions.
    pub fn equation_scope(&self) -> EquationScope<'_> {
        EquationScope::new(&self.patch, &self.auxiliaries, self.is_time_dimensionless())
    }

    /// The dimension of a name in an equation. The name may have primes, or be an initial value such as `x'(0)`. `None`
    /// if the equations cannot use the name.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_expr::Dimension;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("spring")
    ///     .parameter("k", 2.0, "N/mm", [0.0, 10.0])
    ///     .scale("position", 2.0, "mm")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1"]))
    ///     .signal("x", "A1", "position", 1.0)
    ///     .equation("F_s = k x")
    ///     .build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let speed = Dimension::LENGTH.over(Dimension::TIME);
    /// assert_eq!(circuit.equation_dimension("x'"), Some(speed));
    /// assert_eq!(circuit.equation_dimension("x'(0)"), Some(speed));
    /// assert_eq!(circuit.equation_dimension("F_s"), Some(Dimension::FORCE));
    /// assert_eq!(circuit.equation_dimension("A1"), None);
    /// # Ok(())
    /// # }
    /// ```
    pub fn equation_dimension(&self, name: &str) -> Option<Dimension> {
        self.equation_scope().dimension(name)
    }

    /// Names of the auxiliary quantities: names that are nothing else and stand alone on the left of an equation.
    pub fn auxiliary_quantities(&self) -> impl Iterator<Item = &str> {
        self.auxiliaries.keys().map(String::as_str)
    }

    /// Whether times count as pure numbers in the equations.
    ///
    /// This is so if the unit of no parameter and of no scale contains a time. The volt does not count, because it is
    /// the unit of the machine.
    pub fn is_time_dimensionless(&self) -> bool {
        is_time_dimensionless(&self.patch)
    }
}

#[cfg(test)]
mod tests;
