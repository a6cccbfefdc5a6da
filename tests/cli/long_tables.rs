//! Tables of runs with more samples than stay in memory.

use std::fs;

use serde_json::Value;

use super::run_errors::DIVISION;
use super::{json, patchcord, path, spring};

/// The table and the document of a run without pictures, which passes its samples on, and the same with pictures.
fn both_ways(file: &str, options: &[&str]) -> [(Vec<u8>, Value); 2] {
    let folder = tempfile::tempdir().unwrap();
    let [csv, svg] = ["out.csv", "out.svg"].map(|name| path(&folder, name));
    let run = |more: &[&str]| {
        let ran = patchcord(&[&["run", file, "--json", "--csv", &csv], options, more].concat());
        let mut document = json(&ran);
        document.as_object_mut().unwrap().remove("files");
        (fs::read(&csv).unwrap(), document)
    };
    [run(&[]), run(&["--plot", &svg])]
}

/// The number of rows, with those of units and names.
fn line_count(table: &[u8]) -> usize {
    table.iter().filter(|byte| **byte == b'\n').count()
}

#[test]
fn a_table_does_not_depend_on_pictures() {
    let (_folder, file) = spring();
    for options in [&["--repeat", "3"][..], &[], &["--every", "7e-4"], &["--tol", "1e-6"]] {
        let [streamed, whole] = both_ways(&file, options);
        assert!(streamed.0 == whole.0, "{options:?}");
        assert_eq!(streamed.1, whole.1, "{options:?}");
        assert!(streamed.1["samples"].as_u64().unwrap() > 3000 && line_count(&streamed.0) > 3000);
    }
}

#[test]
fn a_table_up_to_an_error_does_not_depend_on_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "division.json");
    fs::write(&file, DIVISION).unwrap();
    for options in [&["--every", "1e-4"][..], &["--every", "1e-4", "--repeat", "2"]] {
        let [streamed, whole] = both_ways(&file, options);
        assert!(streamed.0 == whole.0, "{options:?}");
        assert_eq!(streamed.1, whole.1, "{options:?}");
        assert_eq!((&streamed.1["ok"], line_count(&streamed.0) > 3000), (&false.into(), true));
    }
}
