//! When stretches begin and end that are gone in one piece.

use super::lane::Lane;
use super::step::SIXTH;

/// A stretch of every lane.
#[derive(Clone, Copy)]
pub(super) struct Span<V> {
    pub middle: V,
    pub end: V,
    pub length: V,
    pub half: V,
    /// The share of its length for which the first rate counts, and the last.
    pub sixth: V,
    /// Whether some lanes rest: their stretch has no length.
    some_rest: bool,
}

impl<V: Lane> Span<V> {
    /// The same in all lanes.
    #[inline(always)]
    pub fn same(begin: f64, length: f64, end: f64) -> Self {
        let half = 0.5 * length;
        let [middle, end, length, half, sixth] =
            [begin + half, end, length, half, length * SIXTH].map(V::splat);
        Span { middle, end, length, half, sixth, some_rest: false }
    }

    /// Another in every lane.
    #[inline(always)]
    pub fn between(begin: V, end: V) -> Self {
        let length = end.subtract(begin);
        let half = V::splat(0.5).multiply(length);
        Span {
            middle: begin.add(half),
            end,
            length,
            half,
            sixth: length.multiply(V::splat(SIXTH)),
            some_rest: !length.all(V::splat(0.0), |length, zero| length > zero),
        }
    }

    /// A bit for every lane that does not rest.
    #[inline(always)]
    pub fn moving(&self) -> u64 {
        if !self.some_rest {
            return u64::MAX;
        }
        V::failing(self.length.lies_between(V::splat(f64::NEG_INFINITY), V::splat(0.0), V::TRUE))
    }

    /// What is new in lanes that move, and what was before in those that rest.
    #[inline(always)]
    pub fn gone(&self, new: V, before: V) -> V {
        if self.some_rest { V::select_below(V::splat(0.0), self.length, new, before) } else { new }
    }
}
