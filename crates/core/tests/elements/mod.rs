//! Tests of every kind of element and drive, with one module for each kind.
//!
//! A module has at least three tests. `law` compares random inputs and settings with a formula, `overload` tests the
//! behaviour at ±100 V, and `modes` tests initial condition, operate and hold.

mod bench;

mod absolute;
mod backlash;
mod chirp;
mod comparator;
mod cos;
mod dead_zone;
mod delay;
mod diode_dead_zone;
mod diode_lower_of;
mod diode_upper_of;
mod exp;
mod free_pot;
mod function_generator;
mod integrator;
mod inverter;
mod key_switch;
mod lag;
mod log;
mod multiplier;
mod noise;
mod open_amplifier;
mod pot;
mod pulse;
mod ramp;
mod relay;
mod sin;
mod sine;
mod square;
mod step;
mod summer;
mod table;
mod track_hold;
mod triangle;

use std::fs;

use patchcord_core::elements::REGISTRY;

/// Modules of this folder that do not belong to a kind.
const HELPERS: [&str; 2] = ["mod", "bench"];

/// The folder of the modules.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/elements");

#[test]
fn every_kind_has_a_module_with_the_three_tests() {
    for kind in REGISTRY {
        let module = kind.name.replace('-', "_");
        let text = fs::read_to_string(format!("{FOLDER}/{module}.rs"));
        let text = text.unwrap_or_else(|_| panic!("{} needs a module tests/elements/{module}.rs", kind.name));
        for test in ["law", "overload", "modes"] {
            assert!(text.contains(&format!("fn {test}(")), "{module}.rs has no test `{test}`");
        }
        let line = format!("\nmod {module};\n");
        assert!(include_str!("mod.rs").contains(&line), "mod.rs lacks the line `mod {module};`");
    }
}

#[test]
fn every_module_belongs_to_a_kind() {
    for entry in fs::read_dir(FOLDER).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let stem = name.strip_suffix(".rs").unwrap_or(&name);
        let is_expected =
            HELPERS.contains(&stem) || REGISTRY.iter().any(|kind| kind.name.replace('-', "_") == stem);
        assert!(is_expected, "there is no kind for tests/elements/{name}");
    }
}
