//! The time span of a step or of a piece of it, in every lane.

use super::lane::Lane;
use super::step::SIXTH;

/// Begin, middle and end of a span in every lane, in problem seconds.
#[derive(Clone, Copy)]
pub(super) struct Span<V> {
    /// The time halfway.
    pub middle: V,
    /// The time at which the span ends.
    pub end: V,
    /// End minus begin.
    pub length: V,
    /// Half of the length: the distance of the first two stages.
    pub half: V,
    /// A sixth of the length: the weight of the first and the last rate.
    pub sixth: V,
    /// Whether some lanes are idle: their span has length 0.
    has_idle_lanes: bool,
}

impl<V: Lane> Span<V> {
    /// A span that is the same in all lanes.
    #[inline(always)]
    pub(super) fn same(begin: f64, length: f64, end: f64) -> Self {
        let half = 0.5 * length;
        let [middle, end, length, half, sixth] =
            [begin + half, end, length, half, length * SIXTH].map(V::splat);
        Span { middle, end, length, half, sixth, has_idle_lanes: false }
    }

    /// A span that differs from lane to lane.
    #[inline(always)]
    pub(super) fn between(begin: V, end: V) -> Self {
        let length = end.subtract(begin);
        let half = V::splat(0.5).multiply(length);
        Span {
            middle: begin.add(half),
            end,
            length,
            half,
            sixth: length.multiply(V::splat(SIXTH)),
            has_idle_lanes: !length.all(V::splat(0.0), |length, zero| length > zero),
        }
    }

    /// One bit for every lane that is not idle.
    #[inline(always)]
    pub(super) fn moving(&self) -> u64 {
        if !self.has_idle_lanes {
            return u64::MAX;
        }
        V::failing(self.length.is_within(V::splat(f64::NEG_INFINITY), V::splat(0.0), V::TRUE))
    }

    /// `new` in the lanes that move, and `before` in the idle ones.
    #[inline(always)]
    pub(super) fn select_moving(&self, new: V, before: V) -> V {
        if self.has_idle_lanes { V::select_below(V::splat(0.0), self.length, new, before) } else { new }
    }
}
