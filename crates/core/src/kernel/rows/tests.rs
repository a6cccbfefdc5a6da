//! Unit tests of `rows`.

use proptest::prelude::*;

use super::*;

/// A layout with one voltage that has a safe interval, also in the middle of a step, and one tracked voltage.
fn columns() -> RowLayout {
    RowLayout {
        ends: vec![0, 1],
        firsts: vec![0],
        followed: 3..3,
        safe_intervals: vec![(0, 0), (2, 0)],
        turning: 3,
        of_time: None,
        states: Vec::new(),
        tracked: vec![1],
        rates: VECTOR_LENGTH,
        sampled: VECTOR_LENGTH,
        scheduled: VECTOR_LENGTH,
        sampled_slots: 0..0,
        width: VECTOR_LENGTH,
    }
}

fn number() -> impl Strategy<Value = f64> {
    let rare = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, 1.0f64.next_up(), 1e300];
    let common = [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 5e-324];
    prop_oneof![1 => prop::sample::select(rare.to_vec()), 60 => prop::sample::select(common.to_vec())]
}

/// The expected result, row by row: the number of rows before the first one that is out of bounds or not a number,
/// and the extremes of every column in these.
fn one_by_one(rows: &[[f64; 3]]) -> (u64, [[f64; 2]; 3]) {
    let is_quiet = |[end, tracked, middle]: &&[f64; 3]| {
        (-1.0..=1.0).contains(end) && (-1.0..=1.0).contains(middle) && !tracked.is_nan()
    };
    let quiet = rows.iter().take_while(is_quiet);
    let mut extremes = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    let mut taken = 0;
    for row in quiet {
        taken += 1;
        for ([least, most], value) in extremes.iter_mut().zip(row) {
            *least = if value < least { *value } else { *least };
            *most = if value > most { *value } else { *most };
        }
    }
    (taken, extremes)
}

proptest! {
    #[test]
    fn rows_are_judged_as_one_by_one(rows in prop::collection::vec(prop::array::uniform3(number()), 1..60)) {
        let (columns, mut all) = (columns(), Rows::default());
        all.allocate(&columns);
        all.update_safe_intervals(&columns, &[-1.0], &[1.0]);
        for (place, row) in rows.iter().enumerate() {
            (0..).zip(row).for_each(|(column, value)| put(&mut all.numbers[place + 1..], column, *value));
        }
        let taken = all.check(&columns, rows.len() as u64);
        let recorded: Vec<_> = (0..3).map(|column| [take(&all.least, column), take(&all.most, column)]).collect();
        let (expected, extremes) = one_by_one(&rows);
        prop_assert_eq!(taken, expected);
        let bits = |all: &[[f64; 2]]| all.as_flattened().iter().map(|one| one.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&recorded), bits(&extremes));
    }
}
