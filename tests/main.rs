//! Tests of the whole program: the command, the pages of docs, the shipped patches.

mod cli;
#[path = "../crates/core/tests/common/mod.rs"]
mod common;
mod docs;
#[path = "../crates/draw/tests/drawn/mod.rs"]
mod drawn;
mod imports;
#[path = "../crates/core/tests/known/mod.rs"]
mod known;
mod lessons;
mod problems;
mod shipped_patches;
