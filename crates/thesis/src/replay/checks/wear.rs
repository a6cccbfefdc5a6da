//! The wear tests of chapter 5, as the table of Fig 5.5 lists them.

use super::super::finding::Finding;
use super::super::given::Given;
use super::{Check, CheckError};

pub(super) const CHECKS: &[Check] = &[Check { name: "wear-test", run: wear_test }];

/// Oscillations of tests 1 ... 26. The scan keeps four of the five 64s of tests 13 ... 17, and shows the last entry, 256, in another
/// column; the distances fix both.
const OSCILLATIONS: [u32; 26] =
    [1, 1, 2, 2, 4, 4, 8, 8, 16, 16, 32, 32, 64, 64, 64, 64, 64, 128, 128, 128, 128, 128, 128, 128, 128, 256];

/// Centimetres of an oscillation: one turn of 40 mm each way.
const DISTANCE: u32 = 8;

/// Oscillations up to the end of a test, or the distance in cm.
fn wear_test(given: &Given) -> Result<Finding, CheckError> {
    let factor = given.word("of", &[("count", 1), ("distance", DISTANCE)])?;
    let tests = given.number("test")? as usize;
    Ok(Finding::Number(f64::from(factor * OSCILLATIONS.iter().take(tests).sum::<u32>())))
}
