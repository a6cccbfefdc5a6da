//! The ledger of claims: what the study says, number by number, beside what we get.
//!
//! A [`Claim`] is a row of `src/replay/claims`: where it stands, what it says in a few words, the number as printed, how
//! near the text itself says it is, and the check that decides it with its arguments. A check is code
//! (`src/replay/checks`); the verdict follows from what it finds, and the row holds the verdict that is expected, with the
//! reason for every one but "reproduced". [`page`] writes it all down.

mod checks;
mod claim;
mod finding;
mod given;
mod ledger;
mod page;

pub use checks::CheckError;
pub use claim::{Claim, Outcome, Verdict};
pub use finding::{Finding, Printed, Within};
pub use given::{Given, GivenError};
pub use ledger::{Chapter, LedgerError, ledger};
pub use page::page;
