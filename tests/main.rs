//! End-to-end tests: the command line, the pages in docs, the lessons and the shipped patches.

mod cli;
#[path = "../crates/core/tests/common/mod.rs"]
mod common;
mod docs;
mod fuzz;
mod fuzz_cases;
mod imports;
#[path = "../crates/core/tests/known_problems/mod.rs"]
mod known_problems;
mod lessons;
mod problems;
mod scaled_problems;
#[path = "../crates/draw/tests/schematic_checks/mod.rs"]
mod schematic_checks;
mod shipped_patches;
mod third_party;
mod wording;
