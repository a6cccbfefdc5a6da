//! Names of scales, signals and elements.
//!
//! The scale and the signal of a quantity have the same name: that of the quantity, with `_dot` and so on in place of
//! primes. Other scales have a name from their expression if it is short. Elements are numbered by their type, as on the
//! machines: A1 for an integrator, B1 for a summer, P1 for a pot.

use std::collections::{BTreeMap, BTreeSet};

use patchcord_core::document::{MAX_NAME_CHARACTERS, Span};
use patchcord_core::patch::{check_output_name, check_quantity_name};
use patchcord_expr::split_primes;

use super::input::Input;
use super::short_names::short_name;
use super::unknown::is_chosen;
use crate::graph::{FunctionKind, NodeId, Operation};

/// Letters at the end of a long name that are kept: they contain the order of a derivative.
const LAST_PART: usize = 10;

/// Derivatives up to this order have a name with one d for each dot.
const MOST_DOTS: usize = 3;

/// The names of the scales and signals.
#[derive(Debug)]
pub(super) struct ScaleNames {
    /// The name of each quantity of the plan, in the order of the plan.
    quantities: Vec<String>,
    /// The name of the scale of each node; `None` if formulas contain an expression instead.
    nodes: Vec<Option<String>>,
    /// All names that elements cannot have.
    taken: BTreeSet<String>,
}

impl ScaleNames {
    /// The names for a plan.
    pub(super) fn new(input: &Input<'_>) -> Self {
        let patch = &input.problem.patch;
        let declared = input.plan.quantities.iter().map(|quantity| &quantity.name);
        let unprimed = declared.filter(|name| split_primes(name).1 == 0);
        let mut taken: BTreeSet<String> =
            patch.parameters.keys().chain(patch.drives.keys()).chain(unprimed).cloned().collect();
        let mut quantities = Vec::new();
        for quantity in &input.plan.quantities {
            let name = match split_primes(&quantity.name) {
                (name, 0) => name.to_owned(),
                (name, order) => unique(&derivative_name(name, order), &mut taken),
            };
            quantities.push(name);
        }
        let mut names = ScaleNames { quantities, nodes: Vec::new(), taken };
        names.nodes = input.plan.ids().map(|id| names.name_of(input, id)).collect();
        names
    }

    /// The name of the scale of a node, which is added to the taken ones.
    fn name_of(&mut self, input: &Input<'_>, id: NodeId) -> Option<String> {
        if let Operation::Drive(name) = input.operation(id) {
            return Some(name.clone());
        }
        if let Some(label) = input.labels(id).first() {
            let index = input.plan.quantities.iter().position(|quantity| quantity.name == *label)?;
            return Some(self.quantities[index].clone());
        }
        if !is_chosen(input, id) {
            return None;
        }
        let expression = input.plan.node(id).name.as_str();
        let short = if expression == "t" { Some("time".to_owned()) } else { short_name(expression) };
        if let Some(name) = short {
            return Some(unique(&name, &mut self.taken));
        }
        let stem = stem(input.operation(id));
        let free = (1..).map(|number| format!("{stem}_{number}")).find(|name| is_free(name, &self.taken));
        self.taken.extend(free.clone());
        free
    }

    /// The name of the scale of a node. `None` if formulas contain an expression instead.
    pub(super) fn of_node(&self, id: NodeId) -> Option<String> {
        self.nodes.get(id.0 as usize)?.clone()
    }

    /// The name of the scale and the signal of a quantity, by its index in the plan.
    pub(super) fn of_quantity(&self, index: usize) -> &str {
        &self.quantities[index]
    }

    /// The names for the elements.
    pub(super) fn elements(&self) -> ElementNames {
        ElementNames { taken: self.taken.clone(), last: BTreeMap::new(), renamed: BTreeMap::new() }
    }

    /// The names for the elements of a draft again, with numbers in this order of the elements.
    pub(super) fn numbered<'d>(&self, drafted: impl Iterator<Item = &'d String>) -> ElementNames {
        let mut names = self.elements();
        let letter = |name: &String| name.chars().next().unwrap_or_default();
        let renamed = drafted.map(|name| (name.clone(), names.next(letter(name)))).collect();
        ElementNames { renamed, ..self.elements() }
    }
}

/// The name of a derivative without primes: `x_dot`, `x_ddot`, `x_d4`.
pub(super) fn derivative_name(name: &str, order: usize) -> String {
    match order {
        1..=MOST_DOTS => format!("{name}_{}ot", "d".repeat(order)),
        _ => format!("{name}_d{order}"),
    }
}

/// A name, or the name with the first number with which it is not taken. It is taken from now on. The middle of a name
/// that is too long is left out.
fn unique(name: &str, taken: &mut BTreeSet<String>) -> String {
    let numbered = (2..).map(|number| shortened(name, &format!("_{number}")));
    let found = std::iter::once(shortened(name, "")).chain(numbered).find(|name| is_free(name, taken));
    let found = found.unwrap_or_else(|| name.to_owned());
    taken.insert(found.clone());
    found
}

/// A name with an ending that is at most as long as a patch permits. Names that formulas use are ASCII.
fn shortened(name: &str, ending: &str) -> String {
    let excess = (name.len() + ending.len()).saturating_sub(MAX_NAME_CHARACTERS);
    let last_part = name.len() - name.len().min(LAST_PART);
    let before = last_part.saturating_sub(excess);
    format!("{}{}{ending}", &name[..before], &name[last_part..])
}

/// Whether a name is valid for scales, signals and elements, and not taken.
fn is_free(name: &str, taken: &BTreeSet<String>) -> bool {
    let span = Span::default();
    !taken.contains(name)
        && check_quantity_name(name, span, "scale").is_none()
        && check_output_name(name, span, "signal").is_none()
}

/// The stem of the name of an unnamed scale.
fn stem(operation: &Operation) -> &'static str {
    match operation {
        Operation::Integral { .. } => "integral",
        Operation::Limited { .. } => "limited",
        Operation::Quotient { .. } => "quotient",
        Operation::Root(_) => "root",
        Operation::Zero(_) => "solution",
        Operation::Switch { .. } => "switch",
        Operation::Curve { .. } => "curve",
        Operation::Function { kind, .. } => match kind {
            FunctionKind::Sin => "sine",
            FunctionKind::Cos => "cosine",
            FunctionKind::Exp => "power",
            FunctionKind::Ln => "logarithm",
        },
        _ => "sum",
    }
}

/// The names of elements, numbered by their type.
#[derive(Debug)]
pub(super) struct ElementNames {
    /// The names that elements cannot have.
    taken: BTreeSet<String>,
    /// The last number of each letter.
    last: BTreeMap<char, u32>,
    /// The final names of elements, by the names that they would have in the order in which they are made.
    renamed: BTreeMap<String, String>,
}

impl ElementNames {
    /// The next name with this letter.
    pub(super) fn next(&mut self, letter: char) -> String {
        loop {
            let last = self.last.entry(letter).or_default();
            *last += 1;
            let name = format!("{letter}{last}");
            if self.taken.insert(name.clone()) {
                return self.renamed.get(&name).cloned().unwrap_or(name);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_are_too_long_are_shortened() {
        let longest = "x".repeat(MAX_NAME_CHARACTERS);
        let mut taken = BTreeSet::from([longest.clone()]);
        let names = [1, 1, 2, 4].map(|order| unique(&derivative_name(&longest, order), &mut taken));
        let endings = ["xxxxxx_dot", "xxx_dot_2", "xxxxx_ddot", "xxxxxxx_d4"];
        for (name, ending) in names.iter().zip(endings) {
            assert!(name.len() == MAX_NAME_CHARACTERS && name.ends_with(ending), "{name}");
        }
        assert_eq!(taken.len(), 5);
        assert!(unique(&longest, &mut taken).ends_with("xx_2"));
    }

    #[test]
    fn a_taken_name_gets_the_first_number() {
        let mut taken = BTreeSet::from(["x_dot".to_owned(), "x_dot_2".to_owned()]);
        assert_eq!(unique("x_dot", &mut taken), "x_dot_3");
        assert_eq!(unique("x_ddot", &mut taken), "x_ddot");
    }
}
