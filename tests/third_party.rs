//! THIRD-PARTY-LICENSES agrees with Cargo.lock.

use std::collections::BTreeSet;
use std::fs;

/// The packages of Cargo.lock that are from a registry, each as its name and its version.
fn locked_packages() -> BTreeSet<String> {
    let lock = fs::read_to_string("Cargo.lock").unwrap();
    let value = |package: &str, key: &str| {
        let value = package.lines().find_map(|line| line.strip_prefix(key)).unwrap();
        value.trim_matches('"').to_owned()
    };
    let packages = lock.split("[[package]]\n").skip(1).filter(|package| package.contains("\nsource = "));
    packages
        .map(|package| format!("{} {}", value(package, "name = "), value(package, "version = ")))
        .collect()
}

/// The lines of a section of the file, up to the next empty line.
fn section<'p>(page: &'p str, heading: &str) -> Vec<&'p str> {
    let lines = page.lines().skip_while(|line| !line.starts_with(heading)).skip(2);
    lines.take_while(|line| !line.is_empty()).collect()
}

#[test]
fn the_list_of_licences_has_the_packages_of_the_lock_file() {
    let page = fs::read_to_string("THIRD-PARTY-LICENSES").unwrap();
    let [inside, outside] = ["Packages in binaries", "Packages of Cargo.lock in no binary"]
        .map(|heading| section(&page, heading));
    let packages = inside.iter().chain(&outside).filter_map(|line| line.split(" | ").next());
    let listed: BTreeSet<String> = packages.map(str::to_owned).collect();
    let locked = locked_packages();
    let differences: Vec<&String> = listed.symmetric_difference(&locked).collect();
    assert!(differences.is_empty(), "run .ci/third-party-licenses.py: {differences:?}");
    assert!(inside.len() > 100 && inside.len() + outside.len() == locked.len());
}

#[test]
fn every_package_in_a_binary_has_a_licence_and_a_text() {
    let page = fs::read_to_string("THIRD-PARTY-LICENSES").unwrap();
    for row in section(&page, "Packages in binaries") {
        let cells: Vec<&str> = row.split(" | ").collect();
        let &[_, licence, texts] = cells.as_slice() else { panic!("{row}") };
        let is_known = |number: &str| page.contains(&format!("\nText {number}: "));
        let has_texts = texts.split(", ").all(is_known) || texts.starts_with("none in the package: ");
        assert!(licence != "None" && has_texts, "{row}");
    }
}
