//! Chains of cords: which overload causes another, and whether an element has feedback.
//!
//! `readers` are, for every element, the elements that read its output.

use petgraph::algo::kosaraju_scc;
use petgraph::graph::DiGraph;

/// For each lamp in the order in which they lit: the position in that order of the first earlier lamp from which a
/// chain of cords leads to it; `None` for the first overload of a chain. `readers` are the elements that read each
/// element, `lit` the elements of the lamps.
pub(super) fn causes(readers: &[Vec<usize>], lit: &[usize]) -> Vec<Option<usize>> {
    let mut first_cause = vec![None; readers.len()];
    for (lamp, element) in lit.iter().enumerate() {
        mark_downstream(readers, *element, lamp, &mut first_cause);
    }
    let earlier_cause =
        |(lamp, element): (usize, &usize)| first_cause[*element].filter(|cause| *cause < lamp);
    lit.iter().enumerate().map(earlier_cause).collect()
}

/// Marks all elements downstream of a lamp's amplifier with the position of that lamp. The search ends at an element
/// that an earlier lamp has marked, because all elements downstream of it are marked, too.
fn mark_downstream(readers: &[Vec<usize>], amplifier: usize, lamp: usize, first_cause: &mut [Option<usize>]) {
    let mut pending = vec![amplifier];
    while let Some(element) = pending.pop() {
        for reader in &readers[element] {
            if first_cause[*reader].is_none() {
                first_cause[*reader] = Some(lamp);
                pending.push(*reader);
            }
        }
    }
}

/// For every element, whether a chain of cords leads from it back to it through another one of the given elements.
/// `through` may list elements more than once.
pub(super) fn feedback_through(readers: &[Vec<usize>], through: impl Iterator<Item = usize>) -> Vec<bool> {
    let mut is_through = vec![false; readers.len()];
    through.for_each(|element| is_through[element] = true);
    let cords = readers
        .iter()
        .enumerate()
        .flat_map(|(from, readers)| readers.iter().map(move |reader| (from as u32, *reader as u32)));
    let mut has_feedback = vec![false; readers.len()];
    // Chains lead from an element to another and back if both are in one strongly connected component.
    for members in kosaraju_scc(&DiGraph::<(), ()>::from_edges(cords)) {
        let count = members.iter().filter(|member| is_through[member.index()]).count();
        for member in members {
            has_feedback[member.index()] = count > usize::from(is_through[member.index()]);
        }
    }
    has_feedback
}

/// Whether a chain of cords leads from an element back to it.
pub(super) fn is_in_feedback(readers: &[Vec<usize>], element: usize) -> bool {
    let (mut is_reached, mut pending) = (vec![false; readers.len()], vec![element]);
    while let Some(from) = pending.pop() {
        for reader in &readers[from] {
            if !std::mem::replace(&mut is_reached[*reader], true) {
                pending.push(*reader);
            }
        }
    }
    is_reached[element]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feedback_leads_through_the_elements_of_a_ring_only() {
        // 0, 1 and 2 are a ring. 2 drives 3, and 3 drives itself.
        let readers = [vec![1], vec![2], vec![0, 3], vec![3]];
        let through = |others: &[usize]| feedback_through(&readers, others.iter().copied());
        assert_eq!(through(&[0]), [false, true, true, false]);
        assert_eq!(through(&[1, 1]), [true, false, true, false]);
        assert_eq!(through(&[0, 2, 3]), [true, true, true, false]);
        assert_eq!(through(&[3]), [false; 4]);
        assert_eq!(feedback_through(&[vec![], vec![]], [0, 1].into_iter()), [false; 2]);
    }

    #[test]
    fn the_elements_of_a_ring_are_in_feedback() {
        // 0, 1 and 2 are a ring. 2 drives 3, 3 drives 4, and 4 drives itself.
        let readers = [vec![1], vec![2], vec![0, 3], vec![4], vec![4]];
        let found = [0, 1, 2, 3, 4].map(|element| is_in_feedback(&readers, element));
        assert_eq!(found, [true, true, true, false, true]);
    }

    #[test]
    fn the_earliest_lamp_upstream_is_the_cause() {
        // 0 drives 1 drives 2, and 3 drives 2.
        let readers = [vec![1], vec![2], vec![], vec![2]];
        assert_eq!(causes(&readers, &[0, 1, 2, 3]), [None, Some(0), Some(0), None]);
        assert_eq!(causes(&readers, &[3, 1, 0, 2]), [None, None, None, Some(0)]);
        assert_eq!(causes(&readers, &[2, 1, 0]), [None, None, None]);
    }

    #[test]
    fn the_first_lamp_of_a_ring_causes_the_others() {
        let ring = [vec![1], vec![2], vec![0]];
        assert_eq!(causes(&ring, &[1, 0, 2]), [None, Some(0), Some(0)]);
    }

    #[test]
    fn each_element_of_a_long_chain_is_marked_once() {
        let length = 200_000;
        let readers: Vec<_> =
            (0..length).map(|index| if index + 1 < length { vec![index + 1] } else { vec![] }).collect();
        let lit: Vec<_> = (0..length).rev().collect();
        assert!(causes(&readers, &lit).iter().all(Option::is_none));
    }
}
