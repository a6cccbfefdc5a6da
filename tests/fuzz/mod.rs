//! Random inputs of every kind for the command, and the rules that every answer obeys.
//!
//! A case is a folder of files, a list of arguments, and the standard streams. It is made from a seed: a shipped
//! document is changed, or a circuit is composed from the table of elements. Some inputs and outputs are pipes, devices
//! or folders, and some patches have up to 10,000 elements. The command runs with a limit of time and of memory. Its
//! answer is then judged: no panic, no number that is not finite, no incomplete file, no error without a message.
//!
//! `tests/fuzz_cases.rs` runs a fixed part in every run of the tests. `cargo bench --bench fuzz` runs more cases.

#![allow(dead_code, reason = "the test and the benchmark use different parts")]

pub(crate) mod case;
mod changes;
pub(crate) mod command_lines;
pub(crate) mod corpus;
mod csv_damage;
pub(crate) mod document;
mod edge_values;
mod experiment_case;
pub(crate) mod judgement;
pub(crate) mod large_patch;
pub(crate) mod mutation;
mod number_text;
pub(crate) mod other_commands;
mod pace;
mod patch_case;
pub(crate) mod problem_case;
mod random_patch;
pub(crate) mod random_problem;
pub(crate) mod runner;
pub(crate) mod special_case;
pub(crate) mod special_files;
pub(crate) mod streams;
mod sweep_damage;
pub(crate) mod trials;
