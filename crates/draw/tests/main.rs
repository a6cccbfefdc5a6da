//! Tests of schematics and patch panels.

mod board;
mod bode;
#[path = "../../core/tests/common/mod.rs"]
mod common;
mod schematic;
mod schematic_checks;
