//! The tests of a block of rows, compiled for the widest registers of the processor.
//!
//! [`Survey`] tests all rows together and finds the extremes of their columns. If a row is out of bounds, [`Search`]
//! finds the first such row.

use pulp::NullaryFnOnce;

use super::{RowLayout, Rows, VECTOR_LENGTH, Vector};
use crate::kernel::lane::Lane;

/// Finds the least and largest value of every column in some rows. Returns whether all are within their bounds.
pub(super) struct Survey<'a> {
    /// The layout of the rows.
    pub columns: &'a RowLayout,
    /// The rows; `least` and `most` are overwritten.
    pub rows: &'a mut Rows,
    /// Number of rows that are tested, after the row of the beginning.
    pub steps: u64,
}

impl NullaryFnOnce for Survey<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let Survey { columns, rows: Rows { numbers, lows, highs, least, most, .. }, steps } = self;
        let width = columns.width / VECTOR_LENGTH;
        let rows = &numbers[width..][..width * steps as usize];
        let mut is_quiet = true;
        for at in 0..columns.checked_vectors() {
            let [mut low, mut high, mut sum] = [f64::INFINITY, f64::NEG_INFINITY, 0.0].map(Vector::splat);
            for row in rows.chunks_exact(width) {
                let value = row[at];
                low = Vector::select_below(value, low, value, low);
                high = Vector::select_below(high, value, value, high);
                // The sum is NaN if any value is. The minimum and maximum would lose it.
                sum = sum.add(value);
            }
            let [infinite, none] = [f64::INFINITY, f64::NAN].map(Vector::splat);
            let high_if_all_are = Vector::select_below(sum, infinite, high, none);
            is_quiet &= low.all_at_least(lows[at]) & highs[at].all_at_least(high_if_all_are);
            (least[at], most[at]) = (low, high);
        }
        is_quiet
    }
}

/// Counts the steps before the first one that is out of bounds. A value that is not a number is out of bounds.
pub(super) struct Search<'a> {
    /// The layout of the rows.
    pub columns: &'a RowLayout,
    /// The rows, which are only read.
    pub rows: &'a Rows,
    /// Number of rows that are searched, after the row of the beginning.
    pub steps: u64,
}

impl NullaryFnOnce for Search<'_> {
    type Output = u64;

    #[inline(always)]
    fn call(self) -> u64 {
        let Search { columns, rows, steps } = self;
        for step in 0..steps {
            let mut is_inside = Vector::TRUE;
            let checked_vectors = rows.row(columns, step + 1)[..columns.checked_vectors()].iter();
            for ((value, low), high) in checked_vectors.zip(&rows.lows).zip(&rows.highs) {
                is_inside = value.is_within(*low, *high, is_inside);
            }
            if !is_inside.all_at_least(Vector::TRUE) {
                return step;
            }
        }
        steps
    }
}
