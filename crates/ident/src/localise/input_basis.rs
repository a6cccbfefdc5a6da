//! The basis of an unknown input: the linear map from its coefficients to the points of a table in every record.
//!
//! An input over time has a coefficient for each knot. A curve over a signal has the same points in every record. A
//! coarser basis has fewer coefficients, and the others are interpolated between them.

/// The map from the coefficients to the input of every record. The input is piecewise linear between given points.
#[derive(Debug, Clone)]
pub(crate) struct InputBasis {
    /// The number of coefficients in each group. Neighbours in a group are expected to be alike.
    pub groups: Vec<usize>,
    /// The points of the input, for every record, in increasing order.
    pub records: Vec<Vec<BasisPoint>>,
}

/// A point of an input: the time in seconds (for a curve, the voltage), and pairs of a coefficient's index and its
/// weight. The value of the input there is the weighted sum.
pub(crate) type BasisPoint = (f64, Vec<(usize, f64)>);

impl InputBasis {
    /// The input of a record, as points of a table.
    pub(crate) fn points(&self, record: usize, coefficients: &[f64]) -> Vec<[f64; 2]> {
        let value = |terms: &Vec<(usize, f64)>| {
            terms.iter().map(|(index, weight)| weight * coefficients[*index]).sum()
        };
        self.records[record].iter().map(|(time, terms)| [*time, value(terms)]).collect()
    }

    /// A coarser basis: only the coefficients `kept` remain, and the others are interpolated linearly between them. It
    /// is for a basis with one group.
    pub(crate) fn coarsened(&self, kept: &[usize]) -> InputBasis {
        let coarse = |(index, weight): &(usize, f64)| {
            interpolation_weights(kept, *index).map(|(coarse, share)| (coarse, share * weight))
        };
        let point = |(time, terms): &BasisPoint| (*time, terms.iter().flat_map(coarse).collect());
        let records = self.records.iter().map(|points| points.iter().map(point).collect());
        InputBasis { groups: vec![kept.len()], records: records.collect() }
    }

    /// The number of coefficients.
    pub(crate) fn coefficient_count(&self) -> usize {
        self.groups.iter().sum()
    }

    /// The coefficients on which the input of a record depends, in increasing order.
    pub(crate) fn coefficients_of(&self, record: usize) -> Vec<usize> {
        let mut indices: Vec<usize> =
            self.records[record].iter().flat_map(|(_, terms)| terms.iter().map(|term| term.0)).collect();
        indices.sort_unstable();
        indices.dedup();
        indices
    }
}

/// All `count` coefficients from those of a coarser basis: `values` are the coefficients with the indices `kept`.
pub(crate) fn interpolated(kept: &[usize], values: &[f64], count: usize) -> Vec<f64> {
    let value = |index| {
        interpolation_weights(kept, index).iter().map(|(coarse, share)| share * values[*coarse]).sum()
    };
    (0..count).map(value).collect()
}

/// The weights of linear interpolation at `index`: positions in `kept` of its two neighbours, and the share of each.
fn interpolation_weights(kept: &[usize], index: usize) -> [(usize, f64); 2] {
    let next = kept.partition_point(|other| *other < index).clamp(1, kept.len() - 1);
    let [from, to] = [next - 1, next].map(|position| kept[position] as f64);
    let share = (index as f64 - from) / (to - from);
    [(next - 1, 1.0 - share), (next, share)]
}
