//! Chains of cords: which overload causes another, and whether feedback leads through other elements.
//!
//! `readers` are, for every element, the elements that read its output.

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

/// Whether a chain of cords leads from an element back to it through one of the other elements.
pub(super) fn has_feedback_through(
    readers: &[Vec<usize>],
    element: usize,
    mut others: impl Iterator<Item = usize>,
) -> bool {
    let reached = |graph: &[Vec<usize>]| {
        let mut marks = vec![None; graph.len()];
        mark_downstream(graph, element, 0, &mut marks);
        marks
    };
    let (downstream, upstream) = (reached(readers), reached(&sources(readers)));
    others.any(|other| other != element && downstream[other].is_some() && upstream[other].is_some())
}

/// For every element, the elements whose outputs it reads.
fn sources(readers: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut sources = vec![Vec::new(); readers.len()];
    for (source, readers) in readers.iter().enumerate() {
        readers.iter().for_each(|reader| sources[*reader].push(source));
    }
    sources
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feedback_leads_through_the_elements_of_a_ring_only() {
        // 0, 1 and 2 are a ring. 2 drives 3, and 3 drives itself.
        let readers = [vec![1], vec![2], vec![0, 3], vec![3]];
        let through = |element, other: usize| has_feedback_through(&readers, element, [other].into_iter());
        assert!(through(0, 1) && through(0, 2) && through(1, 0));
        assert!(!through(0, 0) && !through(0, 3) && !through(3, 3) && !through(3, 0));
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
