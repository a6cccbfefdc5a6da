//! The kernel: what a program comes to while its modes stand and no amplifier is overloaded.
//!
//! Signs, gains, potentiometers and formulas are gathered into factors, which a prologue of its own works out once a
//! run; what is left are sums of voltages times factors, and what is no sum. A kernel gives the rates, the voltages
//! that are recorded, and what has to be watched: as long as every watched voltage stays within its bounds, the
//! kernel tells the same as the program. It is folded for one set of modes.
//!
//! Every backend runs the same operations in the same order, each rounded once, and gives the same bits.

mod backend;
mod bounds;
mod code;
mod fold;
mod form;
mod frame;
mod lane;
#[cfg(feature = "native")]
mod native;
#[cfg(not(feature = "native"))]
#[path = "no_native.rs"]
mod native;
mod node;
mod store;
#[cfg(test)]
mod tests;

pub use backend::Backend;
pub(crate) use frame::{Frame, Look, Met, Steps};
pub(crate) use native::Native;
pub(crate) use store::{Folded, Kernels};

use std::collections::HashMap;

use crate::program::{Op, Program, Register, Sources};
use code::{Code, Instruction, Slot};
use fold::Terms;
use form::{Atom, Factor};
use node::{Node, Operand, needed};

/// A program folded for one set of modes.
#[derive(Debug, Clone)]
pub(crate) struct Kernel {
    /// What its factors are worked out by, from the program's coefficients.
    early: Vec<Op>,
    /// What stands in the first slots.
    factors: Vec<Factor>,
    /// Numbers that must lie between two others, or the kernel does not hold with these coefficients.
    still: Vec<[Factor; 3]>,
    pub layout: Layout,
    /// What the rates need.
    moving: Code,
    /// What is watched in the middle of a step too, beyond that.
    middle: Code,
    /// What is watched or recorded at its end, beyond that.
    ending: Code,
    pub rates: Vec<Slot>,
    pub kept: Vec<Slot>,
    pub seen: Vec<Slot>,
    /// Which of these may turn within a quiet stretch: not what stands still or goes straight on in time.
    turning: Vec<usize>,
    pub watches: Vec<Watch>,
    /// So many of the watches are looked at in the middle of a step.
    watched_in_middle: usize,
}

/// Where the slots begin of what is given to a kernel; after these stand the results of its operations.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Layout {
    pub states: usize,
    pub time: usize,
    pub kept: usize,
    pub noise: usize,
    pub all: usize,
}

/// A voltage that is watched: slope x voltage + room must not fall below 0, slope and room being numbers of a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Watch {
    pub slot: Slot,
    pub what: Watched,
}

/// What a voltage is watched for.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Watched {
    /// A corner where it is 0.
    Corner,
    /// A corner at the next point of a table below it, or above it, whose watch comes next.
    Points { table: u32, above: bool },
    /// It must stay above the number in a slot.
    Above(Slot),
    /// It must stay below it.
    Below(Slot),
    /// Its size must; it is watched without sign.
    Size(Slot),
}

impl Kernel {
    /// The kernel of a program in these modes, which also gives the voltages of these registers. Programs with loops
    /// and delay lines have none.
    pub fn new(program: &Program, modes: &[f64], seen: &[Register]) -> Option<Kernel> {
        let can_be = program.loops.is_empty() && program.delays.is_empty();
        can_be.then(|| Layouter::new(fold::folded(program, modes, seen), program).kernel())
    }

    /// What stands in a slot whatever the parameters are.
    #[cfg(feature = "native")]
    fn number(&self, slot: Slot) -> Option<f64> {
        match self.factors.get(slot as usize) {
            Some(Factor::Number(value)) => Some(*value),
            _ => None,
        }
    }

    /// The factors from a program's coefficients; none where an amplifier that stands still is overloaded.
    pub fn factors(&self, program: &Program, coefficients: &[f64]) -> Option<Vec<f64>> {
        let from = Sources { coefficients, tables: &program.tables, ..Sources::none() };
        let mut registers: Vec<f64> = Vec::with_capacity(self.early.len());
        for op in &self.early {
            registers.push(op.apply(&from, |register| registers[register.index()]));
        }
        let value = |factor: &Factor| match factor {
            Factor::Number(value) => *value,
            Factor::Early(register) => registers[register.index()],
        };
        let holds = |[of, low, high]: &[Factor; 3]| value(low) <= value(of) && value(of) <= value(high);
        self.still.iter().all(holds).then(|| self.factors.iter().map(value).collect())
    }
}

/// Gives everything its slot.
struct Layouter {
    folded: Terms,
    factors: Vec<Factor>,
    places: HashMap<(bool, u64), Slot>,
    layout: Layout,
    /// Where every atom stands.
    slots: Vec<Slot>,
    /// How many operations one after the other lead to every atom.
    depths: Vec<u32>,
}

impl Layouter {
    fn new(folded: Terms, program: &Program) -> Self {
        let mut layouter = Layouter {
            factors: Vec::new(),
            places: HashMap::new(),
            layout: Layout::default(),
            slots: Vec::new(),
            depths: Vec::new(),
            folded,
        };
        layouter.measure_depths();
        layouter.list_factors();
        layouter.place(program);
        layouter
    }

    fn measure_depths(&mut self) {
        for node in &self.folded.nodes {
            let depth = |operand| match operand {
                Operand::Factor(_) => 0,
                Operand::Atom(atom) => self.depths[atom as usize] + 1,
            };
            self.depths.push(node.operands().into_iter().map(depth).max().unwrap_or(0));
        }
    }

    fn list_factors(&mut self) {
        let folded = &self.folded;
        let outputs = folded.rates.iter().chain(&folded.kept).chain(&folded.seen).copied();
        let bounds = folded.bounds.all.iter().flat_map(|(_, low, high)| [*low, *high].map(Operand::Factor));
        let points = folded.points.iter().map(|(_, place)| *place);
        let all = outputs.chain(bounds).chain(points);
        let all = all.chain(folded.nodes.iter().flat_map(Node::operands));
        for operand in all {
            if let Operand::Factor(factor) = operand {
                let next = self.factors.len() as Slot;
                if *self.places.entry(factor.key()).or_insert(next) == next {
                    self.factors.push(factor);
                }
            }
        }
    }

    fn place(&mut self, program: &Program) {
        let states = self.factors.len();
        let time = states + program.states.len();
        let kept = time + 1;
        let noise = kept + program.kept.len();
        let mut next = noise + program.noises.len();
        for node in &self.folded.nodes {
            self.slots.push(match node {
                Node::State(index) => states as Slot + index,
                Node::Time => time as Slot,
                Node::Kept(index) => kept as Slot + index,
                Node::Noise(index) => noise as Slot + index,
                _ => {
                    next += 1;
                    next as Slot - 1
                }
            });
        }
        self.layout = Layout { states, time, kept, noise, all: next };
    }

    fn operand(&self, operand: Operand) -> Slot {
        match operand {
            Operand::Factor(factor) => self.factor(factor),
            Operand::Atom(atom) => self.slots[atom as usize],
        }
    }

    fn factor(&self, factor: Factor) -> Slot {
        self.places[&factor.key()]
    }

    fn kernel(self) -> Kernel {
        let folded = &self.folded;
        let watch = |what, slot| Watch { slot, what };
        let corners = folded.corners.iter().map(|atom| watch(Watched::Corner, self.slots[*atom as usize]));
        let points = folded.points.iter().flat_map(|(table, place)| {
            [false, true].map(|above| watch(Watched::Points { table: *table, above }, self.operand(*place)))
        });
        let mut watches: Vec<Watch> = corners.chain(points).collect();
        let mut watched_in_middle = watches.len();
        for (index, (atom, low, high)) in folded.bounds.all.iter().enumerate() {
            let bounds = self.bounds(*low, *high);
            watches.extend(bounds.into_iter().map(|what| watch(what, self.slots[*atom as usize])));
            if index < folded.bounds.guards {
                watched_in_middle = watches.len();
            }
        }
        let [moving, middle, ending] = self.parts();
        let slots = |operands: &[Operand]| operands.iter().map(|operand| self.operand(*operand)).collect();
        Kernel {
            layout: self.layout,
            moving,
            middle,
            ending,
            rates: slots(&folded.rates),
            kept: slots(&folded.kept),
            seen: slots(&folded.seen),
            turning: (0..folded.seen.len()).filter(|index| self.may_turn(folded.seen[*index])).collect(),
            watches,
            watched_in_middle,
            still: folded.bounds.still.clone(),
            early: self.folded.early.ops,
            factors: self.factors,
        }
    }

    fn may_turn(&self, operand: Operand) -> bool {
        let Operand::Atom(atom) = operand else { return false };
        match &self.folded.nodes[atom as usize] {
            Node::Time => false,
            Node::Sum(form) => form.terms.iter().any(|(atom, _)| self.may_turn(Operand::Atom(*atom))),
            _ => true,
        }
    }

    /// What has to be watched of a voltage between two numbers.
    fn bounds(&self, low: Factor, high: Factor) -> Vec<Watched> {
        match (low, high) {
            (Factor::Number(low), Factor::Number(number)) if low == -number => {
                vec![Watched::Size(self.factor(high))]
            }
            (Factor::Number(f64::NEG_INFINITY), _) => vec![Watched::Below(self.factor(high))],
            (_, Factor::Number(f64::INFINITY)) => vec![Watched::Above(self.factor(low))],
            _ => vec![Watched::Above(self.factor(low)), Watched::Below(self.factor(high))],
        }
    }

    /// The operations by when they are needed.
    fn parts(&self) -> [Code; 3] {
        let folded = &self.folded;
        let atoms = |atoms: &[Atom]| atoms.iter().map(|atom| Operand::Atom(*atom)).collect::<Vec<_>>();
        let bound: Vec<Atom> = folded.bounds.all.iter().map(|(atom, ..)| *atom).collect();
        let points = folded.points.iter().map(|(_, place)| *place);
        let wanted = [
            folded.rates.clone(),
            atoms(&folded.corners)
                .into_iter()
                .chain(points)
                .chain(atoms(&bound[..folded.bounds.guards]))
                .collect(),
            atoms(&bound[folded.bounds.guards..])
                .into_iter()
                .chain(folded.kept.clone())
                .chain(folded.seen.clone())
                .collect(),
        ];
        let mut done = vec![false; folded.nodes.len()];
        wanted.map(|operands| {
            let mut code = Code::default();
            let needed = needed(&folded.nodes, operands.into_iter());
            for (at, node) in folded.nodes.iter().enumerate() {
                if needed[at] && !std::mem::replace(&mut done[at], true) {
                    self.emit(node, self.slots[at], &mut code);
                }
            }
            code
        })
    }

    fn emit(&self, node: &Node, out: Slot, code: &mut Code) {
        let of = |operand: &Operand| self.operand(*operand);
        let instruction = match node {
            Node::State(_) | Node::Time | Node::Kept(_) | Node::Noise(_) => return,
            Node::Sum(form) => {
                let constant = self.factor(form.constant);
                // What comes last is added last, so that it is waited for but once.
                let mut terms = form.terms.clone();
                terms.sort_by_key(|(atom, _)| self.depths[*atom as usize]);
                let terms =
                    terms.into_iter().map(|(atom, factor)| (self.factor(factor), self.slots[atom as usize]));
                let first = code.terms.len() as u32;
                match form.terms[..] {
                    [(atom, factor)] => {
                        let (factor, a) = (self.factor(factor), self.slots[atom as usize]);
                        if form.constant.is(0.0) {
                            Instruction::Scaled { out, factor, a }
                        } else {
                            Instruction::Line { out, constant, factor, a }
                        }
                    }
                    _ => {
                        code.terms.extend(terms);
                        Instruction::Sum { out, constant, first, count: form.terms.len() as u32 }
                    }
                }
            }
            Node::Multiply(a, b) => Instruction::Multiply { out, a: of(a), b: of(b) },
            Node::Divide(a, b) => Instruction::Divide { out, a: of(a), b: of(b) },
            Node::Minimum(a, b) => Instruction::Minimum { out, a: of(a), b: of(b) },
            Node::Maximum(a, b) => Instruction::Maximum { out, a: of(a), b: of(b) },
            Node::Absolute(a) => Instruction::Absolute { out, a: of(a) },
            Node::Select { left, right, then, otherwise } => Instruction::Select {
                out,
                left: of(left),
                right: of(right),
                then: of(then),
                otherwise: of(otherwise),
            },
            Node::Call(function, a, b) => Instruction::Call { out, function: *function, a: of(a), b: of(b) },
            Node::Table(table, a) => Instruction::Table { out, table: *table, a: of(a) },
        };
        code.instructions.push(instruction);
    }
}
