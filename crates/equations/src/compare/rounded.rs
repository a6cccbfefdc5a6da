//! Terms that differ by the rounding of a setting inside of a function.
//!
//! A setting in front of a root or a sine is inside of the function in normal form, so sqrt(0.9999 x) and sqrt(x) are two
//! terms there. They are one term if their values agree as well as the factors of a term that is right.

use std::collections::BTreeSet;

use super::corners::equal_between_corners;
use super::points::{MIN_POINTS, Point, points};
use super::terms::{DifferenceKind, TOLERANCE, TermDifference};
use crate::symbolic::{Fraction, value};

/// The differences without the pairs of a missing term and an additional one that have the same values. `point` is any of
/// the points.
pub(super) fn without_rounded(found: Vec<TermDifference>, point: Point<'_>) -> Vec<TermDifference> {
    let mut removed = BTreeSet::new();
    for (index, missing) in found.iter().enumerate() {
        if missing.kind != DifferenceKind::Missing {
            continue;
        }
        let is_partner = |other: &usize| {
            let extra = &found[*other];
            extra.kind == DifferenceKind::Extra
                && !removed.contains(other)
                && have_same_values([&missing.stated, &extra.wired], point)
        };
        let partner = (0..found.len()).find(is_partner);
        removed.extend(partner.into_iter().flat_map(|other| [index, other]));
    }
    let rest = found.into_iter().enumerate().filter(|(index, _)| !removed.contains(index));
    rest.map(|(_, difference)| difference).collect()
}

/// Whether two terms with functions have the same values at all points and between all corners, up to the rounding of a
/// setting.
fn have_same_values(terms: [&Fraction; 2], point: Point<'_>) -> bool {
    if terms.iter().any(|term| term.depth() == 0) {
        return false;
    }
    let mut compared = 0;
    for point in points(point) {
        let [one, other] = terms.map(|term| value(term, &point));
        let size = one.abs().max(other.abs());
        if !size.is_finite() || size == 0.0 {
            continue;
        }
        if (one - other).abs() > TOLERANCE * size {
            return false;
        }
        compared += 1;
    }
    compared >= MIN_POINTS && equal_between_corners(point, terms, TOLERANCE)
}
