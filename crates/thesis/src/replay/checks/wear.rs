//! The wear tests of the table in Fig 5.5 (chapter 5).

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::{Check, CheckError};

/// The check of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[Check { name: "wear-test", run: wear_test }];

/// Oscillations of tests 1 ... 26. The scan preserves four of the five 64s of tests 13 ... 17, and shows the last
/// entry, 256, in another column. The printed distances determine both.
const OSCILLATIONS: [u32; 26] =
    [1, 1, 2, 2, 4, 4, 8, 8, 16, 16, 32, 32, 64, 64, 64, 64, 64, 128, 128, 128, 128, 128, 128, 128, 128, 256];

/// Sliding distance of an oscillation in cm: one revolution of 40 mm in each direction.
const DISTANCE: u32 = 8;

/// Number of oscillations up to the end of test `test`, or the distance in cm; `of` selects count or distance.
///
/// Arguments: `of` (`count` or `distance`) and `test`, 1 ... 26. Claims 5-006, 5-007, 5-008 and 5-010 ... 5-012 compare
/// the sums with the columns of the table. The table has a slip at tests 10 and 11 (64 and 96 instead of 62 and 94).
fn wear_test(given: &CheckArguments) -> Result<Finding, CheckError> {
    let factor = given.choice("of", &[("count", 1), ("distance", DISTANCE)])?;
    let tests = given.number("test")? as usize;
    Ok(Finding::Number(f64::from(factor * OSCILLATIONS.iter().take(tests).sum::<u32>())))
}
