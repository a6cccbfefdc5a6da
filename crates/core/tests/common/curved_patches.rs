//! Random patches without integrators that contain products and squares.
//!
//! No enumeration gives all their solutions. So the laws of all elements are checked at the solver's solution, and a
//! search from many random voltages looks for a second one.

use super::random::SplitMix64;
use super::static_patches::{Eliminated, eliminate, random_count};
use super::{element, run_for, voltage, volts};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, PatchBuilder};

/// Number of random voltages from which a second solution is searched.
const STARTS: usize = 40;
/// Maximum number of steps of a search.
const MAX_STEPS: usize = 40;

/// The law of an element, by the indices of its inputs. The index after the last element is +100 V.
enum Law {
    /// -gain x (sum of factor x input).
    Sum { gain: f64, terms: Vec<(f64, usize)> },
    /// a b / 100 V.
    Product(usize, usize),
    /// (max(a, 0)^2 + max(b, 0)^2) / 100 V.
    Squares(usize, usize),
    /// |a|.
    Absolute(usize),
}

impl Law {
    /// What the inputs demand of the output, divided by the gain of an open amplifier.
    fn demand(&self, outputs: &[f64]) -> f64 {
        let at = |index: usize| outputs.get(index).copied().unwrap_or(100.0);
        match self {
            Law::Sum { terms, .. } => -terms.iter().map(|(factor, from)| factor * at(*from)).sum::<f64>(),
            Law::Product(a, b) => at(*a) * at(*b) / 100.0,
            Law::Squares(a, b) => (at(*a).max(0.0).powi(2) + at(*b).max(0.0).powi(2)) / 100.0,
            Law::Absolute(a) => at(*a).abs(),
        }
    }

    /// The amplification by which the demand is multiplied.
    fn gain(&self) -> f64 {
        if let Law::Sum { gain, .. } = self { *gain } else { 1.0 }
    }

    /// The difference between an output and its law, in volts at the inputs of the amplifier.
    fn residual(&self, output: f64, outputs: &[f64]) -> f64 {
        let (demand, limit) = (self.demand(outputs), 100.0 / self.gain());
        output / self.gain() - demand.clamp(-limit, limit)
    }
}

/// A patch with the laws of its elements.
struct CurvedPatch {
    builder: PatchBuilder,
    laws: Vec<Law>,
}

/// Name of an element, or of the reference.
fn name(index: usize, count: usize) -> String {
    if index == count { "+100".to_owned() } else { format!("E{index}") }
}

/// A random patch. Every other element is an open amplifier or a summer.
fn random_patch(random: &mut SplitMix64, count: usize) -> CurvedPatch {
    let (mut builder, mut laws) = (volts("curved"), Vec::new());
    for index in 0..count {
        let (entry, law) = random_element(random, count);
        builder = builder.element(&name(index, count), entry);
        laws.push(law);
    }
    CurvedPatch { builder, laws }
}

/// A random element with its law.
fn random_element(random: &mut SplitMix64, count: usize) -> (ElementBuilder, Law) {
    let mut cord = || random.uniform(0.0, count as f64 + 0.5) as usize;
    let (a, b) = (cord(), cord());
    let multiplier = |mode: &str| {
        element("multiplier").set("mode", mode).cord("a", &name(a, count)).cord("b", &name(b, count))
    };
    match random.uniform(0.0, 8.0) as usize {
        0 => (multiplier("product"), Law::Product(a, b)),
        1 | 2 => (multiplier("sum-of-squares"), Law::Squares(a, b)),
        3 => (element("absolute").cord("in", &name(a, count)), Law::Absolute(a)),
        kind => {
            let gain = if kind < 6 { 1e6 } else { 1.0 };
            let mut terms: Vec<(f64, usize)> = Vec::new();
            let mut entry = element(if kind < 6 { "open-amplifier" } else { "summer" });
            for factor in [0.3, 0.5, 1.0, 2.0] {
                if random.uniform(0.0, 1.0) < 0.5 || (factor == 2.0 && terms.is_empty()) {
                    let from = random.uniform(0.0, count as f64 + 0.5) as usize;
                    terms.push((factor, from));
                    entry = entry.cords(&format!("x{factor}"), [name(from, count)]);
                }
            }
            (entry, Law::Sum { gain, terms })
        }
    }
}

impl CurvedPatch {
    /// The largest difference between an output and its law.
    fn violation(&self, outputs: &[f64]) -> f64 {
        let residuals = self.laws.iter().zip(outputs).map(|(law, output)| law.residual(*output, outputs));
        residuals.map(f64::abs).fold(0.0, f64::max)
    }

    /// A solution that Newton's method reaches from these outputs; `None` if it reaches none.
    fn solution_from(&self, mut outputs: Vec<f64>) -> Option<Vec<f64>> {
        let count = outputs.len();
        for _ in 0..MAX_STEPS {
            let residuals = |outputs: &[f64]| -> Vec<f64> {
                self.laws.iter().zip(outputs).map(|(law, output)| law.residual(*output, outputs)).collect()
            };
            let here = residuals(&outputs);
            let is_solved = here.iter().all(|residual| residual.abs() < 1e-12);
            let step = 1e-7;
            let columns: Vec<Vec<f64>> = (0..count)
                .map(|index| {
                    let mut moved = outputs.clone();
                    moved[index] += step;
                    residuals(&moved).iter().zip(&here).map(|(there, here)| (there - here) / step).collect()
                })
                .collect();
            let row =
                |index: usize| columns.iter().map(|column| column[index]).chain([here[index]]).collect();
            let Eliminated::One(change) = eliminate((0..count).map(row).collect()) else { return None };
            if is_solved {
                // Where two solutions meet, small residuals do not mean a solution.
                return change.iter().all(|change| change.abs() < 1e-6).then_some(outputs);
            }
            for (output, change) in outputs.iter_mut().zip(&change) {
                *output = (*output - change).clamp(-100.0, 100.0);
            }
        }
        None
    }
}

/// Numbers of results.
#[derive(Debug, Default)]
pub(crate) struct CurvedTally {
    /// Patches that the solver accepted.
    pub solved: usize,
    /// Patches that it refused.
    pub refused: usize,
    /// Descriptions of the patches with a violated law or a second solution.
    pub wrong: Vec<String>,
}

/// Solves random patches of 2 to 6 elements and checks the voltages.
pub(crate) fn check_random(seed: u64, cases: usize) -> CurvedTally {
    let mut random = SplitMix64(seed);
    let mut tally = CurvedTally::default();
    for _ in 0..cases {
        let count = random_count(&mut random, 2, 6);
        let patch = random_patch(&mut random, count);
        let built = patch.builder.clone().build().unwrap_or_else(|report| panic!("{report}"));
        let circuit = Circuit::new(&built).unwrap_or_else(|report| panic!("{report}"));
        let Ok(program) = Program::new(&circuit) else {
            tally.refused += 1;
            continue;
        };
        tally.solved += 1;
        let machine = run_for(&program, 1e-3, 0.0);
        let outputs: Vec<f64> = (0..count).map(|index| voltage(&machine, &name(index, count))).collect();
        let violation = patch.violation(&outputs);
        let starts = (0..STARTS).map(|_| (0..count).map(|_| random.uniform(-100.0, 100.0)).collect());
        let other = starts.collect::<Vec<Vec<f64>>>().into_iter().find_map(|start| {
            let found = patch.solution_from(start)?;
            found.iter().zip(&outputs).any(|(a, b)| (a - b).abs() > 1e-3).then_some(found)
        });
        if violation.is_nan() || violation > 1e-9 || other.is_some() {
            tally.wrong.push(format!(
                "{outputs:?}, a law violated by {violation:e} V, another solution: {other:?}\n{}",
                built.text()
            ));
        }
    }
    tally
}
