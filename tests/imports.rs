//! Dependencies between crates, and between the top-level modules of each crate, have one direction.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::docs::sources;

/// The crates in order. Each may depend on earlier ones, except that [`INDEPENDENT`] crates do not depend on each
/// other.
const CRATES: [&str; 11] =
    ["expr", "core", "equations", "analysis", "draw", "ident", "compare", "panel", "server", "thesis", "web"];
/// Crates that do not depend on each other.
const INDEPENDENT: [&str; 2] = ["ident", "thesis"];

/// The top-level modules of each crate in order. Each may import earlier ones.
const MODULES: [(&str, &[&str]); 11] = [
    ("expr", &["number_text", "function", "units", "formula"]),
    (
        "core",
        &[
            "output",
            "machines",
            "grid",
            "divided_differences",
            "low_discrepancy",
            "multiply_add",
            "parabola",
            "chords",
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
    (
        "equations",
        &[
            "notation",
            "symbolic",
            "graph",
            "derive",
            "operating_point",
            "writing",
            "compare",
            "fixes",
            "findings",
            "static_check",
            "scaling_audit",
            "listing",
            "positions",
            "peaks",
            "plan",
            "synthesis",
            "scaled",
            "rescale",
        ],
    ),
    ("analysis", &["format", "parallel", "instruments", "linear", "sweep"]),
    (
        "draw",
        &[
            "html",
            "plot",
            "envelope",
            "picture_data",
            "picture_samples",
            "family",
            "faults",
            "scope",
            "plane",
            "profile_picture",
            "sensitivity",
            "bode",
            "schematic",
        ],
    ),
    (
        "panel",
        &[
            "limits", "pages", "one_file", "scope", "command", "frame", "event", "compiled", "wiring",
            "patches", "places", "document", "view", "session",
        ],
    ),
    (
        "server",
        &[
            "limits",
            "token",
            "names",
            "headers",
            "browsers",
            "worker",
            "engines",
            "service",
            "reasons",
            "socket",
            "host",
            "routes",
            "connections",
            "server",
        ],
    ),
    (
        "ident",
        &["statistics", "data", "effects", "fit", "residuals", "localise", "design", "search", "report"],
    ),
    (
        "compare",
        &[
            "command",
            "limits",
            "event",
            "message",
            "experiment",
            "suggestion",
            "columns",
            "whole_runs",
            "curves",
            "searching",
            "found",
            "session",
        ],
    ),
    ("thesis", &["slideway", "chain", "replay"]),
    ("web", &[]),
];

/// The top-level module and the code of every source file of a crate.
fn modules(folder: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    sources(folder, &mut found);
    let is_test =
        |path: &Path| path.with_extension("").iter().any(|part| part == "tests" || part == "testing");
    found.retain(|path| !is_test(path.strip_prefix(folder).unwrap()));
    let read = |path: &PathBuf| {
        let inside = path.strip_prefix(folder).unwrap();
        let source = code(&fs::read_to_string(path).unwrap());
        (top_module(inside), from_root(&source, depth(inside)))
    };
    found.iter().map(read).collect()
}

/// The top-level module of a source file. The path is relative to the folder `src`.
fn top_module(path: &Path) -> String {
    let top = path.iter().next().unwrap();
    Path::new(top).file_stem().unwrap().to_str().unwrap().to_owned()
}

/// The number of modules in the path of a source file's module: 1 for `grid.rs` and `fit/mod.rs`, 2 for `fit/model.rs`.
fn depth(path: &Path) -> usize {
    path.iter().count() - usize::from(path.ends_with("mod.rs"))
}

/// The source of a module at this depth in which a path through the root of the crate begins with `crate::`. With depth
/// 2, `super::super::` leads to the root.
fn from_root(source: &str, depth: usize) -> String {
    source.replace(&"super::".repeat(depth), "crate::")
}

/// The source without comments and unit tests. If the unit tests have their own file, the code after their declaration
/// belongs to the module.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default().to_owned() + "\n").collect()
}

/// The paths in the text after `crate::`: the whole text, or the members of a group such as `{a::b, c::{D, E}};`.
fn paths(rest: &str) -> Vec<&str> {
    let Some(group) = rest.strip_prefix('{') else { return vec![rest] };
    let (mut depth, mut start, mut members) = (1, 0, Vec::new());
    for (index, letter) in group.char_indices() {
        depth += match letter {
            '{' => 1,
            '}' => -1,
            _ => 0,
        };
        if depth == 0 || (depth == 1 && letter == ',') {
            members.push(group[start..index].trim());
            start = index + 1;
        }
        if depth == 0 {
            break;
        }
    }
    members.retain(|member| !member.is_empty());
    members
}

/// The names in a path, in order.
fn names(path: &str) -> impl Iterator<Item = &str> {
    path.split(|letter: char| !letter.is_alphanumeric() && letter != '_')
}

/// What a source imports from its own crate: the first name of every path that begins with `crate::`.
fn imported(source: &str) -> BTreeSet<&str> {
    let rests = source.split("crate::").skip(1);
    rests.flat_map(paths).filter_map(|path| names(path).next()).collect()
}

/// Checks that a module imports only earlier ones. `order` lists the modules. A name in the root of a crate belongs to
/// an unknown module, so it must not be imported from there.
fn check_imports(order: &[&str], module: &str, source: &str) -> Result<(), String> {
    let position = |name: &str| order.iter().position(|known| *known == name);
    let own_position = position(module).ok_or_else(|| format!("MODULES does not list {module}"))?;
    for other in imported(source).into_iter().filter(|other| *other != module) {
        let imported = position(other)
            .ok_or_else(|| format!("{module} must import {other} from its module, not from the root"))?;
        if imported > own_position {
            return Err(format!("{module} must not import {other}"));
        }
    }
    Ok(())
}

#[test]
fn modules_import_only_earlier_ones() {
    for (name, order) in MODULES {
        let found = modules(Path::new(&format!("crates/{name}/src")));
        for (module, source) in found.iter().filter(|(module, _)| module != "lib") {
            check_imports(order, module, source).unwrap_or_else(|fault| panic!("{name}: {fault}"));
        }
    }
}

#[test]
fn imports_in_groups_and_from_the_root_are_checked() {
    let check = |source: &str| check_imports(&["data", "fit", "search"], "fit", source);
    assert_eq!(check("use crate::data::{Record, Noise};\nuse crate::fit::model::Model;"), Ok(()));
    assert_eq!(check("use crate::{data::Record, fit::{Model, Problem}};"), Ok(()));
    let upward = Err("fit must not import search".to_owned());
    assert_eq!(check("let outcome = crate::search::search();"), upward);
    assert_eq!(check("use crate::{\n    data::{Record, Noise},\n    search::Outcome,\n};"), upward);
    let from_root = Err("fit must import Outcome from its module, not from the root".to_owned());
    assert_eq!(check("use crate::Outcome;"), from_root);
    assert_eq!(check("use crate::{data::Record, Outcome};"), from_root);
    assert!(check("use crate::*;").is_err());
}

#[test]
fn imports_through_super_are_checked() {
    let check = |path: &str, source: &str| {
        let path = Path::new(path);
        check_imports(&["data", "fit", "search"], &top_module(path), &from_root(source, depth(path)))
    };
    let upward = Err("fit must not import search".to_owned());
    assert_eq!(check("fit/mod.rs", "use super::search::Outcome;"), upward);
    assert_eq!(check("fit/model.rs", "use super::super::search::Outcome;"), upward);
    assert_eq!(check("fit/model.rs", "use super::search::Outcome;"), Ok(()));
    assert_eq!(check("fit/mod.rs", "use super::data::Record;"), Ok(()));
}

#[test]
fn code_after_the_declaration_of_tests_is_checked() {
    let declared = "#[cfg(test)]\nmod tests;\nuse crate::search::Outcome; // a comment\n";
    assert_eq!(code(declared), "#[cfg(test)]\nmod tests;\nuse crate::search::Outcome; \n");
    assert_eq!(code("use crate::data;\n#[cfg(test)]\nmod tests {\n}\n"), "use crate::data;\n");
}

/// The types that a source imports from modules of its own crate, each with the module at the top that has it.
fn imported_types(source: &str) -> BTreeMap<&str, &str> {
    let imports = source.split("use crate::").skip(1).filter_map(|rest| rest.split(';').next());
    let types = imports.flat_map(paths).flat_map(|path| {
        let mut names = names(path);
        let module = names.next().unwrap_or_default();
        names.filter(|name| name.starts_with(char::is_uppercase)).map(move |name| (name, module))
    });
    types.collect()
}

/// The type that a line begins an implementation for, by its name.
fn implemented(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("impl")?;
    let implementor =
        rest.split_once(" for ").map_or_else(|| after_generics(rest), |(_, implementor)| implementor);
    names(implementor.trim_start()).next()
}

/// The text after the parameters in angle brackets with which a text may begin.
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
const CONSTRUCTED_ABOVE: [(&str, &str); 3] =
    [("lower", "ElementLaws"), ("lower", "Program"), ("run_settings", "RunSettings")];

/// If a module adds methods to a type of another, the other can call upwards without an import.
#[test]
fn methods_belong_to_the_module_of_their_type() {
    for (name, _) in MODULES {
        for (module, source) in modules(Path::new(&format!("crates/{name}/src"))) {
            let types = imported_types(&source);
            for implementor in source.lines().filter_map(implemented) {
                assert!(implementor != "crate", "{name}: {module} must import a type to add methods to it");
                let home = types.get(implementor).copied().unwrap_or(module.as_str());
                let is_known = CONSTRUCTED_ABOVE.contains(&(module.as_str(), implementor));
                assert!(
                    home == module || is_known,
                    "{name}: {module} must not add methods to {implementor}, a type of {home}"
                );
            }
        }
    }
}

#[test]
fn implementations_are_recognised() {
    assert_eq!(implemented("impl Outcome {"), Some("Outcome"));
    assert_eq!(implemented("impl<'a> FitProblem<'a> {"), Some("FitProblem"));
    assert_eq!(implemented("impl<T: Into<f64>> From<T> for Value {"), Some("Value"));
    assert_eq!(implemented("    impl Outcome {"), None);
    let source = "use crate::fit::model::{FitParameter, start};\nuse crate::search::Outcome;\n";
    let types = BTreeMap::from([("FitParameter", "fit"), ("Outcome", "search")]);
    assert_eq!(imported_types(source), types);
    assert_eq!(imported_types("use crate::{fit::model::FitParameter, search::{Outcome}};"), types);
}

/// The module of the command that writes files. It refuses to write a file that the command has read.
const WRITER: &str = "src/cli/outputs.rs";

/// Ways to write, create, rename or remove a file.
const WRITING: [&str; 9] = [
    "fs::write",
    "fs::copy",
    "fs::rename",
    "create_dir",
    "remove_file",
    "File::create",
    "OpenOptions",
    "write_atomic",
    "write_new(",
];

#[test]
fn one_module_of_the_command_writes_all_files() {
    let mut found = Vec::new();
    sources(Path::new("src"), &mut found);
    assert!(found.iter().any(|path| path == Path::new(WRITER)));
    for path in found.iter().filter(|path| *path != Path::new(WRITER)) {
        let source = code(&fs::read_to_string(path).unwrap());
        let writes = WRITING.iter().find(|way| source.contains(**way));
        assert!(writes.is_none(), "{}: only {WRITER} may use {writes:?}", path.display());
    }
}

#[test]
fn crates_depend_only_on_earlier_ones() {
    let output = std::process::Command::new(env!("CARGO"))
        .args(["metadata", "--format-version=1", "--no-deps", "--offline"])
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    for package in packages {
        let name = package["name"].as_str().unwrap();
        let is_listed = CRATES.iter().any(|known| name.strip_prefix("patchcord-") == Some(*known));
        assert!(is_listed || name == "patchcord", "CRATES does not list {name}");
    }
    for (position, name) in CRATES.iter().enumerate() {
        let package = packages.iter().find(|package| package["name"] == format!("patchcord-{name}")).unwrap();
        for dependency in package["dependencies"].as_array().unwrap() {
            let dependency = dependency["name"].as_str().unwrap();
            assert!(dependency != "patchcord", "{name} must not depend on the facade");
            let Some(other) = dependency.strip_prefix("patchcord-") else { continue };
            let other_position = CRATES.iter().position(|known| *known == other).unwrap();
            let are_independent = INDEPENDENT.contains(name) && INDEPENDENT.contains(&other);
            assert!(other_position < position && !are_independent, "{name} must not depend on {other}");
        }
    }
}
