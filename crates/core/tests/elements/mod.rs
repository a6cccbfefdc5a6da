//! Every kind of element and drive on the bench, one module a kind.
//!
//! A module has at least three tests: `law` (random inputs and settings against a plain formula), `overload` (what
//! it does at ±100 V) and `modes` (what it gives in initial condition, and what it does in hold).

mod bench;

mod absolute;
mod backlash;
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
mod ramp;
mod relay;
mod sin;
mod sine;
mod step;
mod summer;
mod table;
mod track_hold;
mod triangle;

use std::fs;

use patchcord_core::elements::REGISTRY;

/// Files of this folder that are no kind's module.
const COMMON: [&str; 2] = ["mod", "bench"];

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/elements");

#[test]
fn every_kind_has_its_module() {
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
fn every_module_has_its_kind() {
    for entry in fs::read_dir(FOLDER).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let stem = name.strip_suffix(".rs").unwrap_or(&name);
        let known = COMMON.contains(&stem) || REGISTRY.iter().any(|kind| kind.name.replace('-', "_") == stem);
        assert!(known, "there is no kind for tests/elements/{name}");
    }
}
