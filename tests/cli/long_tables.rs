//! Tables of runs with more samples than stay in memory.

use std::fs;

use serde_json::Value;

#[cfg(target_os = "linux")]
use super::limits::run_with_memory;
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

/// Positions in a picture.
#[cfg(target_os = "linux")]
type Points = Vec<(f64, f64)>;

/// The curves in a file of pictures: the positions of the points of each. Each picture has one, and a dense one
/// consists of strokes in several shades.
#[cfg(target_os = "linux")]
fn curves(svg: &str) -> Vec<Points> {
    let mut curves = Vec::new();
    let point = |text: &str| {
        let (x, y) = text.split_once(',').unwrap();
        (x.parse::<f64>().unwrap(), y.parse::<f64>().unwrap())
    };
    for picture in svg.split("<svg ") {
        let strokes = picture.split("points=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
        curves.push(strokes.flat_map(|points| points.split_whitespace().map(point)).collect::<Points>());
    }
    curves.retain(|points| points.len() > 1000);
    curves
}

/// The samples and their pictures would take 400 MB.
#[cfg(target_os = "linux")]
#[test]
fn the_memory_of_a_run_with_pictures_against_time_does_not_grow_with_its_rows() {
    let (folder, file) = spring();
    let [long, svg] = ["long.svg", "short.svg"].map(|name| path(&folder, name));
    let options = ["--for", "3000", "--record", "x,A1,A2", "--json", "--plot"];
    let ran = run_with_memory(160_000, &file, &[&options[..], &[long.as_str()][..]].concat());
    assert_eq!(json(&ran)["samples"], 3_000_001);
    // A tenth of the samples is few enough to be kept. The picture is the same to a pixel, which has ten units.
    let fewer = [&["run", file.as_str(), "--every", "0.01"][..], &options[..], &[svg.as_str()][..]].concat();
    assert_eq!(json(&patchcord(&fewer))["samples"], 300_001);
    let [long, short] = [long, svg].map(|svg| curves(&fs::read_to_string(svg).unwrap()));
    assert_eq!((long.len(), short.len()), (3, 3));
    for (long, short) in long.iter().zip(&short) {
        let range = |points: &[(f64, f64)]| {
            let bound = |value: fn(&(f64, f64)) -> f64| {
                points.iter().map(value).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                    [low.min(value), high.max(value)]
                })
            };
            [bound(|point| point.0), bound(|point| point.1)]
        };
        let pairs = range(long).into_iter().flatten().zip(range(short).into_iter().flatten());
        pairs.for_each(|(long, short)| assert!((long - short).abs() < 10.0, "{long} {short}"));
    }
}
