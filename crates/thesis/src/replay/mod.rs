//! The replay of the thesis: its figures drawn again, and its claims compared with our results.
//!
//! A [`Claim`] is one row of `crates/thesis/src/replay/claims`. The row holds the place in the text, a short
//! statement, the printed number with its tolerance, and the check with its arguments. A check is code in
//! `crates/thesis/src/replay/checks`. The verdict follows from the finding of the check. The row also holds the
//! expected verdict, and a reason for every verdict except "reproduced". [`claims_page`] formats all claims as one
//! page.
//!
//! A [`Figure`] (`crates/thesis/src/replay/figures`) is drawn from runs of shipped patches with changed settings, or
//! from theory. [`gallery`] shows figures with their claims. [`differences_page`] shows what the differences from the
//! thesis depend on. [`run_all`] draws figures and examines claims on several threads, and
//! [`run_each`] also passes on each figure as soon as it is finished.
//!
//! # Examples
//!
//! Fig 2.2 with the claims that it illustrates:
//!
//! ```
//! use patchcord_thesis::replay::{ExaminedClaim, figures, ledger};
//!
//! let figure = figures().find(|figure| figure.id == "fig-2-02").ok_or("a figure of the thesis")?;
//! println!("{}\n  {}", figure.heading(), figure.draw()?.reading);
//! for claim in ledger()?.iter().filter(|claim| figure.is_related_to(claim)) {
//!     let examined = ExaminedClaim::new(claim)?;
//!     println!("  {} {}: {}", claim.id, claim.statement, examined.outcome.verdict);
//!     assert_eq!(examined.outcome.verdict, claim.verdict);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod boundary;
mod check_arguments;
mod checks;
mod claim;
mod claims_page;
mod conditions;
mod differences_page;
mod examined_claim;
mod figures;
mod finding;
mod frequency;
mod gallery;
mod ledger;
mod number_table;
mod recipe;
mod reversal;
mod run_all;
mod run_record;
mod series;

pub use check_arguments::{ArgumentError, CheckArguments};
pub use checks::CheckError;
pub use claim::{Claim, ClaimOutcome, ClaimVerdict};
pub use claims_page::claims_page;
pub use differences_page::differences_page;
pub use examined_claim::ExaminedClaim;
pub use figures::{DrawnFigure, Figure, FigureError, Sheet, figures};
pub use finding::{Finding, PrintedNumber, Tolerance};
pub use gallery::{GalleryFigure, gallery};
pub use ledger::{LedgerError, ledger};
pub use number_table::NumberTable;
pub use run_all::{ReplayError, run_all, run_each};
