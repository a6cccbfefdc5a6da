//! `patchcord replay`: reproduced figures of the thesis and their claims.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

use super::{code, errors, json, out, patchcord, path};
use crate::common::files::assert_up_to_date;
use patchcord::draw::plot::Format;
use patchcord::patch::Patch;
use patchcord::thesis::replay::{Sheet, differences_page, figures, run_all};

/// The longest time until the first figure of a replay is printed.
const LONGEST_FIGURE: Duration = Duration::from_secs(120);

#[test]
fn without_a_name_the_figures_are_listed() {
    let listed = patchcord(&["replay"]);
    assert_eq!(code(&listed), 0);
    assert!(out(&listed).contains("fig-8-24"), "{}", out(&listed));
    let ids = json(&patchcord(&["replay", "--json"]));
    assert_eq!(ids["figures"].as_array().unwrap().len(), figures().count());
}

#[test]
fn a_figure_has_a_picture_a_patch_and_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let into = path(&folder, "out");
    let output = patchcord(&["replay", "fig-8-24", "--out", &into]);
    assert_eq!(code(&output), 0, "{}", errors(&output));
    assert!(out(&output).contains("oscillation ends at 7.924 mm/s"), "{}", out(&output));
    let written = |name: &str| fs::read_to_string(path(&folder, &format!("out/{name}"))).unwrap();
    assert!(roxmltree::Document::parse(&written("fig-8-24.svg")).is_ok());
    let page = written("fig-8-24.html");
    for part in ["src=\"fig-8-24.svg\"", "href=\"fig-8-24.json\"", "8-122.a", "Fig 8.24: "] {
        assert!(page.contains(part), "{part}");
    }
    let again =
        patchcord(&["run", &path(&folder, "out/fig-8-24.json"), "--plot", &path(&folder, "again.svg")]);
    assert_eq!(code(&again), 0, "{}", errors(&again));
    // The command also checks the steps, and may follow the curve with other points of it.
    let pictures = [written("fig-8-24.svg"), fs::read_to_string(path(&folder, "again.svg")).unwrap()];
    let [(before, curve, after), (other_before, other, other_after)] =
        pictures.each_ref().map(|svg| parts(svg));
    assert!(before == other_before && after == other_after);
    assert!(curve.iter().all(|point| distance(*point, &other) < 8.0));
    assert!(other.iter().all(|point| distance(*point, &curve) < 8.0));
}

/// The text before the curve of a picture, the points of all its strokes in tenths of a pixel, and the text after it.
fn parts(svg: &str) -> (&str, Vec<[f64; 2]>, &str) {
    let (before, rest) = svg.split_once("<polyline").unwrap();
    let (strokes, end) = rest.rsplit_once("points=\"").unwrap();
    let (last, after) = end.split_once('"').unwrap();
    let point = |text: &str| {
        let (x, y) = text.split_once(',').unwrap();
        [x, y].map(|number| number.parse().unwrap())
    };
    let strokes =
        strokes.split("points=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).chain([last]);
    (before, strokes.flat_map(|points| points.split_whitespace().map(point)).collect(), after)
}

/// The distance of a point from the lines between points.
fn distance(point: [f64; 2], line: &[[f64; 2]]) -> f64 {
    let to_chord = |chord: &[[f64; 2]]| {
        let along = [0, 1].map(|axis| chord[1][axis] - chord[0][axis]);
        let offset = [0, 1].map(|axis| point[axis] - chord[0][axis]);
        let length = along[0] * along[0] + along[1] * along[1];
        let share = ((along[0] * offset[0] + along[1] * offset[1]) / length.max(1e-9)).clamp(0.0, 1.0);
        (offset[0] - share * along[0]).hypot(offset[1] - share * along[1])
    };
    line.windows(2).map(to_chord).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_replay_that_is_killed_keeps_the_finished_figures() {
    let folder = tempfile::tempdir().unwrap();
    let [into, shown] = ["out", "shown.txt"].map(|name| path(&folder, name));
    let mut command = Command::new(env!("CARGO_BIN_EXE_patchcord"));
    command.args(["replay", "all", "--out", &into]).stdout(fs::File::create(&shown).unwrap());
    let mut child = command.stderr(Stdio::null()).spawn().unwrap();
    // A figure is printed after its files are written.
    let is_printed = || fs::read(&shown).unwrap().starts_with(b"Fig 2.2: ");
    let start = Instant::now();
    while !is_printed() && start.elapsed() < LONGEST_FIGURE && child.try_wait().unwrap().is_none() {
        thread::sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(is_printed(), "no figure is printed within {LONGEST_FIGURE:?}");
    let picture = fs::read_to_string(path(&folder, "out/fig-2-02.svg")).unwrap();
    assert!(roxmltree::Document::parse(&picture).is_ok());
    assert!(!fs::exists(path(&folder, "out/index.html")).unwrap(), "the replay was not killed in time");
}

#[test]
fn no_file_is_written_twice() {
    let folder = tempfile::tempdir().unwrap();
    let (into, plot) = (path(&folder, "out"), path(&folder, "out/fig-4-10.svg"));
    let twice = patchcord(&["replay", "fig-4-10", "--out", &into, "--plot", &plot]);
    assert_eq!((code(&twice), out(&twice).as_str()), (2, ""));
    assert!(errors(&twice).contains("fig-4-10.svg would be written twice"), "{}", errors(&twice));
    assert!(!fs::exists(&into).unwrap());
    let second = patchcord(&["replay", "fig-4-10", "--out", &into, "--plot", &path(&folder, "out/b.png")]);
    assert_eq!(code(&second), 0, "{}", errors(&second));
    let names = ["b.png", "fig-4-10.svg", "fig-4-10.html"]
        .map(|name| fs::metadata(path(&folder, &format!("out/{name}"))));
    assert!(names.iter().all(Result::is_ok));
}

#[test]
fn a_figure_is_found_by_any_of_its_names() {
    let folder = tempfile::tempdir().unwrap();
    let into = path(&folder, "out");
    let replayed = patchcord(&["replay", "8.14", "Fig 4.8", "fig-8-26", "--out", &into, "--json"]);
    assert!(fs::exists(path(&folder, "out/figures.html")).unwrap());
    let document = json(&replayed);
    let figures = document["figures"].as_array().unwrap();
    assert_eq!(figures.len(), 3);
    for command in figures.iter().flat_map(|figure| figure["commands"].as_array().unwrap()) {
        let words = command.as_str().unwrap().split(' ').skip(1);
        let in_folder = |word: &str| match word.starts_with("fig-") {
            true => path(&folder, &format!("out/{word}")),
            false => word.to_owned(),
        };
        let words: Vec<_> = words.map(in_folder).collect();
        let typed = patchcord(&words.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(code(&typed), 0, "{command}: {}", errors(&typed));
    }
}

#[test]
fn the_document_has_figures_and_claims() {
    let document = json(&patchcord(&["replay", "fig-8-05", "--json"]));
    let figure = &document["figures"][0];
    assert_eq!((&figure["id"], &figure["number"]), (&"fig-8-05".into(), &"Fig 8.5".into()));
    let claims = document["claims"].as_array().unwrap();
    let claim = claims.iter().find(|claim| claim["id"] == "8-032").unwrap();
    for key in ["where", "says", "got", "difference", "verdict", "why"] {
        assert!(claim[key].is_string(), "{key}");
    }
    assert_eq!(claim["verdict"], "reproduced");
}

#[test]
fn wrong_requests_return_errors() {
    let error = |arguments: &[&str]| {
        let output = patchcord(&[&["replay"], arguments].concat());
        assert_eq!(code(&output), 2);
        errors(&output)
    };
    assert!(error(&["fig-8-42"]).contains("there is no figure fig-8-42; did you mean"));
    let file = "fig-8-16.json is a file, where the name of a figure is expected; write fig-8-16 for";
    assert!(error(&["fig-8-16.json"]).contains(file));
    assert!(error(&["my/spring.json"]).contains("`patchcord run` runs a patch"));
    assert!(error(&["nothing"]).contains("there is no figure nothing; `patchcord replay` lists the figures"));
    assert!(error(&["fig-8-24", "fig-8-25", "--plot", "x.svg"]).contains("--plot draws only one figure"));
    assert!(error(&["fig-8-24", "--plot", "x.jpg"]).contains("x.jpg"));
    assert!(error(&["--out", "x"]).contains("no figure is specified"));
}

#[test]
#[ignore = "takes two minutes: every figure"]
fn every_figure_is_drawn_with_a_reading_and_patches_that_check() {
    let figures: Vec<_> = figures().collect();
    assert!(figures.len() >= 60);
    let (drawn, _) = run_all(&figures, &[], 2, |_, _| ()).unwrap_or_else(|error| panic!("{error}"));
    assert_up_to_date(
        "docs/differences.md",
        differences_page(figures.iter().copied().zip(&drawn)).as_bytes(),
        "cli replay",
    );
    for (figure, drawn) in figures.into_iter().zip(&drawn) {
        let output = format!("{} {}", drawn.settings, drawn.reading);
        assert!(!drawn.reading.is_empty() && !drawn.settings.is_empty(), "{}", figure.id);
        assert!(!output.contains("NaN") && !output.contains("inf"), "{}: {output}", figure.id);
        assert!(drawn.render(Format::Svg).unwrap().len() > 1000, "{}", figure.id);
        if let Sheet::Pictures(pictures) = &drawn.sheet {
            let channels = pictures.iter().flat_map(|picture| &picture.channels);
            assert!(channels.map(|channel| channel.points.len()).min().unwrap() > 0, "{}", figure.id);
        }
        for patch in &drawn.patches {
            assert!(patch.file().starts_with(figure.id), "{}", patch.file());
            let read = Patch::parse(patch.file(), patch.text()).unwrap();
            patchcord::circuit::Circuit::new(&read).unwrap_or_else(|report| panic!("{report}"));
            let is_named = |command: &String| command.contains(patch.file());
            assert!(drawn.commands.iter().any(is_named), "{}", figure.id);
        }
        if let Some(table) = &drawn.table {
            assert!(table.rows.iter().all(|row| row.len() == table.head.len()), "{}", figure.id);
        }
    }
}
