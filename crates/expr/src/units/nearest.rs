//! Suggestions for misspelt names by edit distance.

use strsim::osa_distance;

/// Returns the candidate that is most similar to `wanted`; `None` if no candidate is similar.
///
/// A candidate is similar if it differs only in upper and lower case, or by few edits. An edit adds,
/// removes or exchanges a letter, or swaps two neighbours. One edit in three letters is permitted,
/// at most three in all; a name of one letter permits none. Of equally similar candidates the first
/// one is returned.
///
/// # Examples
///
/// ```
/// use patchcord_expr::nearest;
///
/// let names = ["velocity", "force", "Fs"];
/// assert_eq!(nearest("velocty", names), Some("velocity"));
/// assert_eq!(nearest("FORCE", names), Some("force"));
/// assert_eq!(nearest("temperature", names), None);
/// ```
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

/// Returns the number of edits at which a candidate still counts as similar.
fn allowed_edits(wanted: &str) -> usize {
    match wanted.chars().count() {
        0 | 1 => 0,
        length => (length / 3).clamp(1, 3),
    }
}

/// Returns the sort key of a candidate: its edits without regard to case, then its edits.
fn closeness(wanted: &str, candidate: &str) -> (usize, usize) {
    let without_case = osa_distance(&wanted.to_lowercase(), &candidate.to_lowercase());
    (without_case, osa_distance(wanted, candidate))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_similar_names_only() {
        let names = ["velocity", "force", "Fs"];
        assert_eq!(nearest("velocty", names), Some("velocity"));
        assert_eq!(nearest("veloctiy", names), Some("velocity"));
        assert_eq!(nearest("FORCE", names), Some("force"));
        assert_eq!(nearest("fs", names), Some("Fs"));
        assert_eq!(nearest("temperature", names), None);
        assert_eq!(nearest("x", names), None);
        assert_eq!(nearest("", names), None);
    }
}
