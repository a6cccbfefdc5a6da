//! The study, replayed: its figures drawn again, and the ledger of claims, number by number beside what we get.
//!
//! A [`Claim`] is a row of `crates/thesis/src/replay/claims`: where it stands, what it says in a few words, the number as printed, how
//! near the text itself says it is, and the check that decides it with its arguments. A check is code
//! (`crates/thesis/src/replay/checks`); the verdict follows from what it finds, and the row holds the verdict that is expected, with the
//! reason for every one but "reproduced". [`page`] writes it all down.
//!
//! A [`Figure`] (`crates/thesis/src/replay/figures`) is drawn from runs of shipped patches with settings of its own, or from theory.
//! [`gallery`] shows figures beside the claims that they bear on, [`differences`] what the differences depend on.

mod boundary;
mod checks;
mod claim;
mod conditions;
mod differences;
mod examined;
mod figures;
mod finding;
mod frequency;
mod gallery;
mod given;
mod ledger;
mod page;
mod performance;
mod recipe;
mod reversal;
mod table;

pub use checks::CheckError;
pub use claim::{Claim, Outcome, Verdict};
pub use differences::differences;
pub use examined::Examined;
pub use figures::{Drawn, Figure, FigureError, Sheet, figures};
pub use finding::{Finding, Printed, Within};
pub use gallery::{Exhibit, gallery};
pub use given::{Given, GivenError};
pub use ledger::{LedgerError, ledger};
pub use page::page;
pub use performance::{ReplayError, perform};
pub use table::Table;
