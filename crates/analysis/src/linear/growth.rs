//! The loop of integrators behind a motion that grows: the sign error of beginners.
//!
//! Amplifiers invert. A loop with an odd number of inversions opposes a deviation, and one with an even number amplifies
//! it. Some circuits are meant to grow, such as an oscillator with an energy supply, so only a motion that does grow at
//! the operating point is reported, with a loop of positive feedback that can be its cause.

use std::collections::{HashMap, HashSet, VecDeque};

use super::{LinearError, codes, roots};
use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::ir::StateSpace;
use patchcord_expr::format_significant;

/// A loop of positive feedback in a circuit whose motion grows.
#[derive(Debug, Clone, PartialEq)]
pub struct GrowingLoop {
    /// The elements of the loop in the direction of the signal, integrators included. The last one drives the first one.
    pub elements: Vec<String>,
    /// The fastest growth at the operating point, in 1/s.
    pub rate: f64,
}

impl GrowingLoop {
    /// The loop and its growth in words: "the loop A1 -> B1 ... grows, by a factor of e in 0.2 s".
    pub fn description(&self) -> String {
        format!(
            "the loop {} inverts an even number of times, so a deviation grows, by a factor of e in {} s",
            self.elements.join(" -> "),
            format_significant(1.0 / self.rate, 3)
        )
    }

    /// Whether the loop can have caused what an element does at a time in seconds: the element is in the loop or a chain
    /// of cords leads from the loop to it, and the motion has grown by half until then.
    pub fn explains(&self, circuit: &Circuit, element: &str, time: f64) -> bool {
        let all = circuit.elements();
        let Some(element) = all.iter().position(|entry| entry.name == element) else { return false };
        let is_in_loop = |index: usize| self.elements.contains(&all[index].name);
        let (mut open, mut seen) = (vec![element], HashSet::from([element]));
        while let Some(index) = open.pop() {
            if is_in_loop(index) {
                return self.rate * time >= LEAST_GROWTH_EXPONENT;
            }
            open.extend(circuit.cords(index).iter().map(|(from, _)| *from).filter(|from| seen.insert(*from)));
        }
        false
    }
}

/// The loop that amplifies deviations. `None` if there is none, if it is intended, or if the patch states its equations:
/// these are compared with the wiring.
pub fn unintended_growth(circuit: &Circuit, model: &StateSpace) -> Option<GrowingLoop> {
    let patch = circuit.patch();
    if patch.positive_feedback || !patch.equations.is_empty() {
        return None;
    }
    growing_loop(circuit, model).ok()?
}

/// The warning about a loop that amplifies deviations. `None` if there is no [unintended loop](unintended_growth).
pub fn growth_warning(circuit: &Circuit, model: &StateSpace) -> Option<Diagnostic> {
    let growing = unintended_growth(circuit, model)?;
    let entry = circuit.patch().elements.get(growing.elements.first()?)?;
    Some(Diagnostic::at(codes::GROWING_LOOP, entry.span, growing.description()))
}

/// Growth below this share of the natural frequency counts as rounding.
const LEAST_GROWTH: f64 = 1e-6;
/// Growth rate times time from which a growing loop can be the cause of an overload: the motion has grown by half.
const LEAST_GROWTH_EXPONENT: f64 = 0.4;
/// Most integrators of a loop that is looked for. Sign errors make short loops.
const LONGEST_LOOP: usize = 4;
/// Most integrators of a circuit that is searched.
const MAX_STATES: usize = 200;

/// The strongest loop of positive feedback if a motion grows at the operating point of the model. `None` if nothing
/// grows, if no short loop has positive feedback, or if the circuit has more than 200 integrators and lags.
///
/// # Errors
/// Those of [`roots`].
///
/// # Examples
///
/// ```
/// use patchcord_analysis::linear::growing_loop;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::Machine;
///
/// // Two integrators in a loop without an inverter.
/// let [a, b] = ["B", "A"].map(|from| ElementBuilder::new("integrator").cords("x1", [from]));
/// let patch = PatchBuilder::new("saddle").element("A", a).element("B", b).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let model = Machine::new(&program, 1e-3)?.state_space();
/// let found = growing_loop(&circuit, &model)?.expect("the motion grows");
/// assert_eq!(found.elements, ["A", "B"]);
/// assert!((found.rate - 1.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn growing_loop(circuit: &Circuit, model: &StateSpace) -> Result<Option<GrowingLoop>, LinearError> {
    if model.states.is_empty() || model.states.len() > MAX_STATES {
        return Ok(None);
    }
    let rate = roots(model)?.iter().fold(0.0, |fastest: f64, root| match root.real {
        real if real > LEAST_GROWTH * root.natural_frequency() => fastest.max(real),
        _ => fastest,
    });
    if rate == 0.0 {
        return Ok(None);
    }
    let matrix = model.state_matrix();
    let Some(states) = strongest_positive_cycle(&matrix) else { return Ok(None) };
    let names: Vec<&str> = states.iter().map(|state| model.states[*state].name.as_str()).collect();
    Ok(Some(GrowingLoop { elements: elements_of(circuit, &names), rate }))
}

/// The cycle of states with a positive product of gains whose mean gain is largest.
fn strongest_positive_cycle(matrix: &[Vec<f64>]) -> Option<Vec<usize>> {
    let mut best: Option<(f64, Vec<usize>)> = None;
    for start in 0..matrix.len() {
        extend(matrix, &mut vec![start], 1.0, &mut best);
    }
    best.map(|(_, cycle)| cycle)
}

/// Extends a path of states by one, and closes it if it leads back. The first state of a cycle has the least index.
fn extend(matrix: &[Vec<f64>], path: &mut Vec<usize>, gain: f64, best: &mut Option<(f64, Vec<usize>)>) {
    let (start, last) = (path[0], path[path.len() - 1]);
    let closed = gain * matrix[start][last];
    if closed > 0.0 {
        let mean = closed.powf(1.0 / path.len() as f64);
        if best.as_ref().is_none_or(|(strongest, _)| mean > *strongest) {
            *best = Some((mean, path.clone()));
        }
    }
    if path.len() == LONGEST_LOOP {
        return;
    }
    for next in start + 1..matrix.len() {
        if matrix[next][last] != 0.0 && !path.contains(&next) {
            path.push(next);
            extend(matrix, path, gain * matrix[next][last], best);
            path.pop();
        }
    }
}

/// The elements of a loop through these states: from each to the next by the fewest cords.
fn elements_of(circuit: &Circuit, states: &[&str]) -> Vec<String> {
    let elements = circuit.elements();
    let indices: HashMap<&str, usize> =
        elements.iter().enumerate().map(|(index, element)| (element.name.as_str(), index)).collect();
    let mut names = Vec::new();
    for (position, state) in states.iter().enumerate() {
        let next = states[(position + 1) % states.len()];
        names.push((*state).to_owned());
        let between = shortest_path(circuit, [indices[state], indices[next]], |_| true);
        names.extend(between.into_iter().map(|element| elements[element].name.clone()));
    }
    names
}

/// The permitted elements between two elements, in the direction of the signal, by the fewest cords. Empty if there is no
/// path.
pub(super) fn shortest_path(
    circuit: &Circuit,
    [from, to]: [usize; 2],
    is_permitted: impl Fn(usize) -> bool,
) -> Vec<usize> {
    // For each element that was reached against the direction of the signal, the element that it drives.
    let mut driven: HashMap<usize, usize> = HashMap::new();
    let mut open = VecDeque::from([to]);
    while let Some(element) = open.pop_front() {
        for (source, _) in circuit.cords(element) {
            if source == from {
                let path = std::iter::successors(Some(element), |element| driven.get(element).copied());
                return path.take_while(|element| *element != to).collect();
            }
            if source != to && is_permitted(source) && !driven.contains_key(&source) {
                driven.insert(source, element);
                open.push_back(source);
            }
        }
    }
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::ir::Program;
    use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};
    use patchcord_core::solve::Machine;

    fn found(patch: &Patch) -> Option<GrowingLoop> {
        let circuit = Circuit::new(patch).unwrap();
        let program = Program::new(&circuit).unwrap();
        let model = Machine::new(&program, 1e-3).unwrap().state_space();
        growing_loop(&circuit, &model).unwrap()
    }

    /// A mass on a spring with damping. `spring` and `damping` are the outputs that drive the pots.
    fn spring(spring: &str, damping: &str) -> Patch {
        let pot = |from, setting| ElementBuilder::new("pot").cord("in", from).set("setting", setting);
        PatchBuilder::new("spring")
            .element("A1", ElementBuilder::new("integrator").cords("x10", ["PK", "PC"]))
            .element("A2", ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50))
            .element("B1", ElementBuilder::new("inverter").cord("in", "A1"))
            .element("B2", ElementBuilder::new("inverter").cord("in", "A2"))
            .element("PK", pot(spring, 0.4))
            .element("PC", pot(damping, 0.05))
            .build()
            .unwrap()
    }

    #[test]
    fn a_loop_with_an_even_number_of_inversions_is_found() {
        assert_eq!(found(&spring("B2", "A1")), None);
        let saddle = found(&spring("A2", "A1")).unwrap();
        assert_eq!(saddle.elements, ["A1", "A2", "PK"]);
        // s^2 + 0.5 s - 4 = 0
        assert!((saddle.rate - (16.25f64.sqrt() - 0.5) / 2.0).abs() < 1e-9, "{}", saddle.rate);
        let supply = found(&spring("B2", "B1")).unwrap();
        assert_eq!(supply.elements, ["A1", "B1", "PC"]);
        assert!((supply.rate - 0.25).abs() < 1e-9, "{}", supply.rate);
    }

    #[test]
    fn a_growing_loop_explains_what_it_drives_after_some_time() {
        let patch = spring("A2", "A1");
        let circuit = Circuit::new(&patch).unwrap();
        let growing = found(&patch).unwrap();
        // The rate is 1.8/s. B1 is not in the loop, but A1 drives it.
        assert!(growing.explains(&circuit, "A2", 0.5) && growing.explains(&circuit, "B1", 0.5));
        assert!(!growing.explains(&circuit, "A2", 0.1) && !growing.explains(&circuit, "+100", 0.5));
    }

    #[test]
    fn stable_and_oscillating_circuits_have_no_growing_loop() {
        for file in ["heat-rod", "driven-oscillator", "mass-and-spring", "relay-thermostat"] {
            let patch = Patch::read(format!("../../patches/lessons/{file}.json")).unwrap();
            assert_eq!(found(&patch), None, "{file}");
        }
    }

    #[test]
    fn circuits_that_are_meant_to_grow_have_one() {
        for (file, first) in [("van-der-pol", "A1"), ("lorenz", "A1")] {
            let patch = Patch::read(format!("../../patches/lessons/{file}.json")).unwrap();
            let growing = found(&patch).unwrap();
            assert_eq!(growing.elements[0], first, "{file}: {growing:?}");
        }
    }
}
