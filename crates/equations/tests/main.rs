//! Integration tests of the equations: derived, stated and compared.
//!
//! The patches in `tests/patches/bad` and `tests/patches/traps` have mistakes. Their reports are next to them.
//! `PATCHCORD_BLESS=1 cargo test -p patchcord-equations` rewrites the reports.

mod bad;
mod compare;
#[path = "../../core/tests/common/files.rs"]
#[allow(dead_code, reason = "the tests of several crates share the file")]
mod files;
mod implicit;
mod listed_numbers;
mod listing;
mod mistakes;
mod parameters;
mod problem_files;
mod rescale;
mod rescaled_settings;
mod rod;
mod round_trip;
mod scale;
mod static_check;
mod textbook;
mod thresholds;
