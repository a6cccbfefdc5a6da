/// The candidate that `wanted` was most probably meant to be, or `None` if all are far from it.
///
/// Near means: alike but for the case of the letters, or at most one letter in three (and never
/// more than three) added, missing, exchanged or swapped with its neighbour. Of several equally
/// near candidates the first one is taken.
pub fn nearest<'a>(wanted: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = allowed_edits(wanted);
    let length = wanted.chars().count();
    candidates
        .into_iter()
        .filter(|candidate| candidate.chars().count().abs_diff(length) <= allowed)
        .map(|candidate| (closeness(wanted, candidate), candidate))
        .filter(|((edits, _), _)| *edits <= allowed)
        .min_by_key(|(closeness, _)| *closeness)
        .map(|(_, candidate)| candidate)
}

fn allowed_edits(wanted: &str) -> usize {
    match wanted.chars().count() {
        0 | 1 => 0,
        length => (length / 3).clamp(1, 3),
    }
}

fn closeness(wanted: &str, candidate: &str) -> (usize, usize) {
    let without_case = edits(&wanted.to_lowercase(), &candidate.to_lowercase());
    (without_case, edits(wanted, candidate))
}

/// The number of edits (letter added, removed, exchanged, or two neighbours swapped).
fn edits(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut last_letter = None;
    let mut before: Vec<usize> = Vec::new();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for letter in from.chars() {
        let next = next_row(letter, last_letter, &to, &before, &row);
        before = std::mem::replace(&mut row, next);
        last_letter = Some(letter);
    }
    row.last().copied().unwrap_or(0)
}

fn next_row(
    letter: char,
    last_letter: Option<char>,
    to: &[char],
    before: &[usize],
    row: &[usize],
) -> Vec<usize> {
    let mut next = vec![row[0] + 1];
    for (column, &target) in to.iter().enumerate() {
        let exchanged = row[column] + usize::from(letter != target);
        let mut fewest = exchanged.min(row[column + 1] + 1).min(next[column] + 1);
        if column > 0 && last_letter == Some(target) && letter == to[column - 1] {
            fewest = fewest.min(before[column - 1] + 1);
        }
        next.push(fewest);
    }
    next
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_edits() {
        assert_eq!(edits("", ""), 0);
        assert_eq!(edits("", "abc"), 3);
        assert_eq!(edits("kitten", "sitting"), 3);
        assert_eq!(edits("velocity", "veloctiy"), 1);
    }

    #[test]
    fn finds_the_near_and_refuses_the_far() {
        let names = ["velocity", "force", "Fs"];
        assert_eq!(nearest("velocty", names), Some("velocity"));
        assert_eq!(nearest("FORCE", names), Some("force"));
        assert_eq!(nearest("fs", names), Some("Fs"));
        assert_eq!(nearest("temperature", names), None);
        assert_eq!(nearest("x", names), None);
        assert_eq!(nearest("", names), None);
    }
}
