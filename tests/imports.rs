//! Dependencies between crates, and between the top-level modules of each crate, have one direction.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::docs::sources;

/// The crates in order. Each may depend on earlier ones, except that [`INDEPENDENT`] crates do not depend on each
/// other.
const CRATES: [&str; 6] = ["expr", "core", "analysis", "draw", "ident", "thesis"];
/// Crates that do not depend on each other.
const INDEPENDENT: [&str; 2] = ["ident", "thesis"];

/// The top-level modules of each crate in order. Each may import earlier ones.
const MODULES: [(&str, &[&str]); 6] = [
    ("expr", &["function", "units", "formula"]),
    (
        "core",
        &[
            "output",
            "machines",
            "grid",
            "divided_differences",
            "delay_line",
            "document",
            "ir",
            "elements",
            "patch",
            "circuit",
            "lower",
            "trace",
            "kernel",
            "solve",
            "run_settings",
        ],
    ),
    ("analysis", &["format", "parallel", "instruments", "linear", "sweep"]),
    (
        "draw",
        &["html", "plot", "family", "scope", "plane", "profile_picture", "sensitivity", "bode", "schematic"],
    ),
    (
        "ident",
        &["statistics", "data", "effects", "fit", "residuals", "localise", "design", "search", "report"],
    ),
    ("thesis", &["slideway", "chain", "replay"]),
];

/// The top-level module and the code of every source file of a crate.
fn modules(folder: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    sources(folder, &mut found);
    found.retain(|path| path.file_stem().is_some_and(|stem| stem != "tests"));
    let module = |path: &Path| {
        let top = path.strip_prefix(folder).unwrap().iter().next().unwrap();
        Path::new(top).file_stem().unwrap().to_str().unwrap().to_owned()
    };
    found.iter().map(|path| (module(path), code(&fs::read_to_string(path).unwrap()))).collect()
}

/// The source without comments and unit tests.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default().to_owned() + "\n").collect()
}

/// The modules of the same crate that a source imports.
fn imported(source: &str) -> BTreeSet<&str> {
    let is_word = |letter: char| letter.is_alphanumeric() || letter == '_';
    let rest = source.split("crate::").skip(1);
    rest.map(|rest| rest.split(|letter| !is_word(letter)).next().unwrap_or_default()).collect()
}

#[test]
fn modules_import_only_earlier_ones() {
    for (name, order) in MODULES {
        let found = modules(Path::new(&format!("crates/{name}/src")));
        let place = |module: &str| order.iter().position(|known| *known == module);
        for (module, source) in found.iter().filter(|(module, _)| module != "lib") {
            let own = place(module).unwrap_or_else(|| panic!("{name}: MODULES does not list {module}"));
            for other in imported(source).into_iter().filter(|other| other != module) {
                let Some(theirs) = place(other) else { continue };
                assert!(theirs < own, "{name}: {module} must not import {other}");
            }
        }
    }
}

/// The types that a source imports from modules of its own crate, each with the module at the top that has it.
fn imported_types(source: &str) -> BTreeMap<&str, &str> {
    let is_apart = |letter: char| !letter.is_alphanumeric() && letter != '_';
    let paths = source.split("use crate::").skip(1).filter_map(|rest| rest.split(';').next());
    let types = paths.flat_map(|path| {
        let mut words = path.split(is_apart);
        let module = words.next().unwrap_or_default();
        words.filter(|word| word.starts_with(char::is_uppercase)).map(move |word| (word, module))
    });
    types.collect()
}

/// The type that a line begins an implementation for, by its name.
fn implemented(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("impl")?;
    let own = rest.split_once(" for ").map_or_else(|| after_generics(rest), |(_, own)| own);
    own.trim_start().split(|letter: char| !letter.is_alphanumeric() && letter != '_').next()
}

/// What comes after the parameters in angle brackets with which a text may begin.
fn after_generics(text: &str) -> &str {
    let mut depth = 0;
    let end = text.char_indices().find(|(_, letter)| {
        depth += match letter {
            '<' => 1,
            '>' => -1,
            _ => 0,
        };
        depth == 0
    });
    end.map_or("", |(at, _)| text[at..].trim_start_matches('>'))
}

/// Types of core that a later module constructs, because it needs a circuit: module and type.
const CONSTRUCTED_ABOVE: [(&str, &str); 2] = [("lower", "Program"), ("run_settings", "RunSettings")];

/// If a module adds methods to a type of another, the other can call upwards without an import.
#[test]
fn methods_belong_to_the_module_of_their_type() {
    for (name, _) in MODULES {
        for (module, source) in modules(Path::new(&format!("crates/{name}/src"))) {
            let types = imported_types(&source);
            for own in source.lines().filter_map(implemented) {
                let of = types.get(own).copied().unwrap_or(module.as_str());
                let is_known = CONSTRUCTED_ABOVE.contains(&(module.as_str(), own));
                assert!(
                    of == module || is_known,
                    "{name}: {module} must not add methods to {own}, a type of {of}"
                );
            }
        }
    }
}

#[test]
fn implementations_are_recognised() {
    assert_eq!(implemented("impl Outcome {"), Some("Outcome"));
    assert_eq!(implemented("impl<'a> Task<'a> {"), Some("Task"));
    assert_eq!(implemented("impl<T: Into<f64>> From<T> for Value {"), Some("Value"));
    assert_eq!(implemented("    impl Outcome {"), None);
    let source = "use crate::fit::model::{Knob, begun};\nuse crate::search::Outcome;\n";
    assert_eq!(imported_types(source), BTreeMap::from([("Knob", "fit"), ("Outcome", "search")]));
}

#[test]
fn crates_depend_only_on_earlier_ones() {
    let output = std::process::Command::new(env!("CARGO"))
        .args(["metadata", "--format-version=1", "--no-deps", "--offline"])
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    for (own, name) in CRATES.iter().enumerate() {
        let packages = metadata["packages"].as_array().unwrap();
        let package = packages.iter().find(|package| package["name"] == format!("patchcord-{name}")).unwrap();
        for dependency in package["dependencies"].as_array().unwrap() {
            let Some(other) = dependency["name"].as_str().unwrap().strip_prefix("patchcord-") else {
                continue;
            };
            let theirs = CRATES.iter().position(|known| *known == other).unwrap();
            let are_independent = INDEPENDENT.contains(name) && INDEPENDENT.contains(&other);
            assert!(theirs < own && !are_independent, "{name} must not depend on {other}");
        }
    }
}
