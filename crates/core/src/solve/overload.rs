//! Overload lamps: which lit, when, how far the amplifier was asked to go, and what caused it.

use crate::ir::Program;
use crate::trace::Overload;

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
    let elements: Vec<usize> = lit.iter().map(|lamp| lamp.element).collect();
    let told = lit.iter().zip(causes(&program.readers, &elements)).map(|(lamp, cause)| Overload {
        element: program.name(lamp.element).to_owned(),
        time: lamp.time,
        peak: lamp.peak,
        caused_by: cause.map(|cause| program.name(elements[cause]).to_owned()),
    });
    told.collect()
}

/// For each lamp, in the order in which they lit: the first before it from which a chain of cords leads to it.
fn causes(readers: &[Vec<usize>], lit: &[usize]) -> Vec<Option<usize>> {
    let mut first = vec![None; readers.len()];
    for (lamp, element) in lit.iter().enumerate() {
        flood(readers, *element, lamp, &mut first);
    }
    let before_itself = |(lamp, element): (usize, &usize)| first[*element].filter(|cause| *cause < lamp);
    lit.iter().enumerate().map(before_itself).collect()
}

/// Marks what a lamp's amplifier drives. Where an earlier lamp has been, it has been everywhere from there on.
fn flood(readers: &[Vec<usize>], from: usize, lamp: usize, first: &mut [Option<usize>]) {
    let mut open = vec![from];
    while let Some(element) = open.pop() {
        for reader in &readers[element] {
            if first[*reader].is_none() {
                first[*reader] = Some(lamp);
                open.push(*reader);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cause_is_the_earliest_lamp_upstream() {
        // 0 drives 1 drives 2, and 3 drives 2.
        let readers = [vec![1], vec![2], vec![], vec![2]];
        assert_eq!(causes(&readers, &[0, 1, 2, 3]), [None, Some(0), Some(0), None]);
        assert_eq!(causes(&readers, &[3, 1, 0, 2]), [None, None, None, Some(0)]);
        assert_eq!(causes(&readers, &[2, 1, 0]), [None, None, None]);
    }

    #[test]
    fn in_a_ring_the_first_lamp_causes_the_others() {
        let ring = [vec![1], vec![2], vec![0]];
        assert_eq!(causes(&ring, &[1, 0, 2]), [None, Some(0), Some(0)]);
    }

    #[test]
    fn a_long_chain_of_lamps_is_walked_once() {
        let length = 200_000;
        let readers: Vec<_> =
            (0..length).map(|at| if at + 1 < length { vec![at + 1] } else { vec![] }).collect();
        let lit: Vec<_> = (0..length).rev().collect();
        assert!(causes(&readers, &lit).iter().all(Option::is_none));
    }
}
