//! Overload lamps: which lit, when, how far the amplifier was asked to go, and what caused it.

use crate::program::Program;

/// An overload lamp that lit. Lamps stay lit until the next initial condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Overload {
    /// The amplifier.
    pub element: String,
    /// When it was first asked for more than 100 V, in problem seconds.
    pub time: f64,
    /// The largest voltage, without sign, that it was asked for.
    pub peak: f64,
    /// The overload that caused it: the earliest among the amplifiers from which a chain of cords leads here.
    pub caused_by: Option<String>,
}

/// A lamp while the machine runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lit {
    pub element: usize,
    pub time: f64,
    pub peak: f64,
}

/// The lamps in the order in which they lit, first causes told from consequences.
pub(super) fn history(program: &Program, lamps: &[Option<Lit>]) -> Vec<Overload> {
    let mut lit: Vec<Lit> = lamps.iter().flatten().copied().collect();
    lit.sort_by(|a, b| a.time.total_cmp(&b.time));
    let told = lit.iter().enumerate().map(|(index, lamp)| Overload {
        element: program.name(lamp.element).to_owned(),
        time: lamp.time,
        peak: lamp.peak,
        caused_by: cause(program, &lit[..index], lamp).map(|cause| program.name(cause.element).to_owned()),
    });
    told.collect()
}

fn cause(program: &Program, earlier: &[Lit], lamp: &Lit) -> Option<Lit> {
    earlier.iter().copied().find(|cause| reaches(program, cause.element, lamp.element))
}

/// Whether a chain of cords leads from one element to another.
fn reaches(program: &Program, from: usize, to: usize) -> bool {
    let mut seen = vec![false; program.readers.len()];
    let mut open = vec![from];
    while let Some(element) = open.pop() {
        for reader in &program.readers[element] {
            if *reader == to {
                return true;
            }
            if !std::mem::replace(&mut seen[*reader], true) {
                open.push(*reader);
            }
        }
    }
    false
}
