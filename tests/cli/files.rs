//! The files of a run: tables, pictures, folders, and errors when they cannot be written.

use std::fs;
use std::path::Path;

use super::run_errors::DIVISION;
use super::sweep::driven;
use super::{FIG_8_16, code, errors, json, out, patchcord, path, spring, spring_with};

#[test]
fn a_run_writes_table_and_picture() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, svg) = (path(&folder, "out.csv"), path(&folder, "out.svg"));
    let ran = patchcord(&["run", FIG_8_16, "--for", "0.5", "--csv", &csv, "--plot", &svg]);
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""));
    assert!(out(&ran).contains("no overload") && out(&ran).contains(&format!("wrote {csv}")));
    let table = fs::read_to_string(&csv).unwrap();
    let lines: Vec<&str> = table.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(lines[0], "t,v_i,x_error,v_o,a_o,spring_force,friction_level,memory");
    assert_eq!(lines.len(), 502);
    assert!(lines[501].starts_with("0.5,"));
    assert!(table.contains("# v_o: m/s\n"));
    let picture = fs::read_to_string(&svg).unwrap();
    assert!(picture.starts_with("<?xml") && picture.contains("v_o, mm/s"));
}

#[test]
fn table_and_picture_in_a_folder_have_the_name_of_the_patch() {
    let folder = tempfile::tempdir().unwrap();
    let inside = path(&folder, "new/results");
    assert_eq!(code(&patchcord(&["run", FIG_8_16, "--for", "0.01", "--out", &inside])), 0);
    for file in ["fig-8-16.csv", "fig-8-16.svg"] {
        assert!(Path::new(&inside).join(file).is_file(), "{file}");
    }
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let files = ["a.csv", "b.csv", "a.png", "b.png"].map(|name| path(&folder, name));
    for (csv, png) in [(&files[0], &files[2]), (&files[1], &files[3])] {
        assert_eq!(code(&patchcord(&["run", FIG_8_16, "--for", "0.3", "--csv", csv, "--plot", png])), 0);
    }
    let bytes = files.each_ref().map(|file| fs::read(file).unwrap());
    assert!(bytes[0] == bytes[1] && bytes[2] == bytes[3]);
}

#[test]
fn unreadable_and_unwritable_files_give_exit_code_1() {
    let wrong: &[&[&str]] = &[
        &["check", "no-such-file.json"],
        &["run", FIG_8_16, "--for", "0.001", "--csv", "no/such/folder/out.csv"],
        &["run", FIG_8_16, "--for", "0.001", "--csv", "patches"],
    ];
    for arguments in wrong {
        let ran = patchcord(arguments);
        assert_eq!(code(&ran), 1, "{arguments:?}");
        let message = errors(&ran);
        assert!(message.starts_with("error: cannot") && !message.contains("os error"), "{message}");
    }
}

#[test]
fn no_file_is_written_twice_or_over_the_patch() {
    let folder = tempfile::tempdir().unwrap();
    let [patch, table, out] = ["a.json", "a.csv", "new"].map(|name| path(&folder, name));
    fs::copy(FIG_8_16, &patch).unwrap();
    let [here, twice] = [path(&folder, ""), path(&folder, "new/a.csv")];
    let roundabout = path(&folder, "../") + folder.path().file_name().unwrap().to_str().unwrap() + "/a.svg";
    let wrong: &[(&[&str], &str)] = &[
        (&["--csv", &patch], "is the patch itself"),
        (&["--out", &here, "--plot", &roundabout], "would be written twice"),
        (&["--csv", &twice, "--out", &out], "would be written twice"),
        (&["--csv", ""], "a value is required"),
    ];
    for (options, message) in wrong {
        let ran = patchcord(&[&["run", &patch, "--for", "0.001"], *options].concat());
        assert_eq!(code(&ran), 2, "{options:?}: {}", errors(&ran));
        assert!(errors(&ran).contains(message), "{}", errors(&ran));
    }
    assert_eq!(fs::read_to_string(&patch).unwrap(), fs::read_to_string(FIG_8_16).unwrap());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(code(&patchcord(&["run", &patch, "--for", "0.001", "--csv", &table])), 0);
}

/// Asserts that a command is refused with this message.
fn check_refused(arguments: &[&str], message: &str) {
    let ran = patchcord(arguments);
    assert_eq!(code(&ran), 2, "{arguments:?}: {}", errors(&ran));
    assert!(errors(&ran).contains(message), "{arguments:?}: {}", errors(&ran));
}

#[test]
fn no_command_writes_a_file_that_it_has_read() {
    let folder = driven();
    let [patch, table, rows] = ["driven.json", "u.csv", "k.csv"].map(|name| path(&folder, name));
    let before = [&patch, &table, &rows].map(|file| fs::read(file).unwrap());
    let roundabout = path(&folder, "../") + folder.path().file_name().unwrap().to_str().unwrap() + "/u.csv";
    let sweep = ["sweep", &patch, "--vary", "k=0.1,0.2", "--measure", "voltmeter:s", "--out"];
    let linearise = ["linearise", &patch, "--from", "u", "--to", "s", "--csv"];
    let run = ["run", &patch, "--csv"];
    for command in [&run[..], &linearise, &sweep] {
        for file in [&table, &roundabout] {
            check_refused(&[command, &[file.as_str()][..]].concat(), "u.csv is a table of the patch itself");
        }
        check_refused(&[command, &[patch.as_str()][..]].concat(), "driven.json is the patch itself");
    }
    let with_rows = ["sweep", &patch, "--rows", &rows, "--measure", "voltmeter:s", "--out", &rows];
    check_refused(&with_rows, "k.csv is the file of --rows itself");
    assert_eq!([&patch, &table, &rows].map(|file| fs::read(file).unwrap()), before);
}

#[test]
fn only_options_for_pictures_take_the_name_of_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let [png, pdf, csv, json, none] =
        ["x.png", "x.PDF", "x.csv", "x.json", "x"].map(|name| path(&folder, name));
    let refused = |given: &str, option: &str, content: &str, drawing: &str, named: &str| {
        format!(
            "error: {given} is the name of a picture, but {option} writes a {content}: use {drawing} for a picture, \
             and {option} {named} for the {content}\n"
        )
    };
    let plot = "--plot FILE.svg or --plot FILE.png";
    let table = |given: &str| refused(given, "--csv", "table", plot, &csv);
    let inside = refused(&png, "--out", "folder", plot, &none);
    let slideway = ["slideway", "--oil", "0.34", "--weight", "450", "--stiffness", "20", "--out", &png];
    let sweep = ["sweep", FIG_8_16, "--vary", "Tc=0.01,0.02", "--measure", "overload", "--out", &png];
    let run = "`patchcord run` with --plot FILE.svg";
    let cases: &[(&[&str], String)] = &[
        (&["run", FIG_8_16, "--csv", &png], table(&png)),
        (&["run", FIG_8_16, "--csv", &pdf], table(&pdf)),
        (&["linearise", FIG_8_16, "--from", "v_i", "--to", "v_o", "--csv", &png], table(&png)),
        (&["run", FIG_8_16, "--out", &png], inside.clone()),
        (&["draw", FIG_8_16, "--out", &png], inside.clone()),
        (&["replay", "fig-8-24", "--out", &png], inside),
        (&slideway, refused(&png, "--out", "patch", plot, &json)),
        (&sweep, refused(&png, "--out", "table", run, &csv)),
    ];
    for (command, message) in cases {
        let ran = patchcord(command);
        assert_eq!((code(&ran), errors(&ran).as_str()), (2, message.as_str()), "{command:?}");
    }
    let message = "the extension must be .svg or .png; --csv of run and linearise writes a table\n";
    check_refused(&["run", FIG_8_16, "--plot", &csv], message);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn results_do_not_replace_a_table_with_the_name_of_the_patch() {
    let folder = driven();
    let [patch, table] = ["driven.json", "driven.csv"].map(|name| path(&folder, name));
    let text = fs::read_to_string(&patch).unwrap();
    fs::write(&patch, text.replace("u.csv", "driven.csv")).unwrap();
    fs::rename(path(&folder, "u.csv"), &table).unwrap();
    let before = fs::read(&table).unwrap();
    check_refused(&["run", &patch, "--out", &path(&folder, "")], "driven.csv is a table of the patch itself");
    assert_eq!(fs::read(&table).unwrap(), before);
    assert_eq!(code(&patchcord(&["run", &patch, "--out", &path(&folder, "results")])), 0);
}

#[cfg(unix)]
#[test]
fn a_file_that_is_read_is_recognised_through_links() {
    let folder = driven();
    let [patch, table] = ["driven.json", "u.csv"].map(|name| path(&folder, name));
    let [symbolic, hard] = ["symbolic.csv", "hard.csv"].map(|name| path(&folder, name));
    std::os::unix::fs::symlink("u.csv", &symbolic).unwrap();
    fs::hard_link(&table, &hard).unwrap();
    for link in [&symbolic, &hard] {
        check_refused(&["run", &patch, "--csv", link], "is a table of the patch itself");
    }
    assert_eq!(fs::read_to_string(&table).unwrap(), "t,u\n0,0\n1,50\n");
}

/// Each command would fail in its run.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_without_write_access_is_reported_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let division = path(&folder, "division.json");
    fs::write(&division, DIVISION).unwrap();
    let [csv, svg] = ["/proc/new.csv", "/proc/new.svg"];
    let commands: &[&[&str]] = &[
        &["run", &division, "--csv", csv],
        &["draw", FIG_8_16, "--values", "1e15", "--plot", svg],
        &["linearise", FIG_8_16, "--at", "1e15", "--from", "v_i", "--to", "v_o", "--csv", csv],
        &["profile", FIG_8_16, "--threshold", "1e9", "--plot", svg],
        &["slideway", "--oil", "0.34", "--weight", "450", "--stiffness", "1e9", "--plot", svg],
        &["sweep", FIG_8_16, "--vary", "Tc=0.01,0.02", "--measure", "overload", "--out", csv],
        &["new", "/proc/new.json"],
    ];
    for arguments in commands {
        let ran = patchcord(arguments);
        assert_eq!(code(&ran), 1, "{arguments:?}: {}", errors(&ran));
        assert!(errors(&ran).contains("error: cannot write /proc/new."), "{}", errors(&ran));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn temporary_files_of_killed_commands_are_removed() {
    let (folder, file) = spring();
    // No process has this number: it is above the largest that Linux permits.
    let left = path(&folder, ".patchcord-4194305-a1b2c3.tmp");
    let own = path(&folder, &format!(".patchcord-{}-a1b2c3.tmp", std::process::id()));
    [&left, &own].into_iter().for_each(|temporary| fs::write(temporary, "half").unwrap());
    assert_eq!(code(&patchcord(&["run", &file, "--for", "0.01", "--csv", &path(&folder, "x.csv")])), 0);
    assert!(!Path::new(&left).exists(), "the process of the file does not exist");
    assert!(Path::new(&own).exists(), "the process of the file is this one");
}

#[test]
fn a_folder_is_created_only_for_valid_patches_and_names_keep_their_dots() {
    let folder = tempfile::tempdir().unwrap();
    let [patch, wrong, out] = ["a.b.json", "wrong.json", "new"].map(|name| path(&folder, name));
    fs::copy(FIG_8_16, &patch).unwrap();
    fs::write(&wrong, "{\"patchcord\": 1, \"elements\": 3}").unwrap();
    assert_eq!(code(&patchcord(&["run", &wrong, "--out", &out])), 1);
    assert!(!Path::new(&out).exists());
    assert_eq!(code(&patchcord(&["run", &patch, "--for", "0.001", "--out", &out])), 0);
    assert!(Path::new(&out).join("a.b.csv").is_file() && Path::new(&out).join("a.b.svg").is_file());
}

#[cfg(unix)]
#[test]
fn a_table_on_standard_output_precedes_the_readings() {
    let (folder, file) = spring();
    let shown = folder.path().join("shown");
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("patchcord"));
    let ran = command
        .args(["run", &file, "--for", "0.002", "--csv", "/dev/stdout"])
        .stdout(fs::File::create(&shown).unwrap())
        .status()
        .unwrap();
    assert!(ran.success());
    let shown = fs::read_to_string(shown).unwrap();
    assert!(shown.starts_with("# t: s\n") && shown.contains("\nwrote /dev/stdout\n"), "{shown}");
    assert!(shown.ends_with("; no overload\n"), "{shown}");
}

#[cfg(unix)]
#[test]
fn a_read_only_file_is_reported_before_the_run() {
    use std::os::unix::fs::PermissionsExt as _;
    let (folder, file) = spring();
    let kept = path(&folder, "kept.csv");
    fs::write(&kept, "old").unwrap();
    fs::set_permissions(&kept, fs::Permissions::from_mode(0o444)).unwrap();
    let ran = patchcord(&["run", &file, "--csv", &kept]);
    assert_eq!((code(&ran), out(&ran).as_str()), (1, ""));
    assert_eq!(errors(&ran), format!("error: cannot write {kept}: it is read-only\n"));
    assert_eq!(fs::read_to_string(&kept).unwrap(), "old");
}

#[test]
fn a_file_in_place_of_a_folder_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "taken");
    fs::write(&file, "").unwrap();
    let below = path(&folder, "taken/new");
    for (requested, why) in
        [(&file, "a file with this name exists".to_owned()), (&below, format!("{file} is a file"))]
    {
        let ran = patchcord(&["run", FIG_8_16, "--for", "0.01", "--out", requested]);
        assert_eq!(
            (code(&ran), errors(&ran)),
            (1, format!("error: cannot create the folder {requested}: {why}\n"))
        );
    }
}

#[test]
fn a_folder_has_a_file_for_each_picture() {
    let (folder, file) = spring_with(
        "\n  \"run\"",
        "\n  \"pictures\": [{\"y\": \"x\"}, {\"x\": \"A1\", \"y\": \"A2\"}],\n  \"run\"",
    );
    let inside = path(&folder, "new");
    let document = json(&patchcord(&["run", &file, "--out", &inside, "--json"]));
    let names = ["spring.csv", "spring.svg", "spring.picture-1.svg", "spring.picture-2.svg"];
    let paths = names.map(|name| Path::new(&inside).join(name).display().to_string());
    assert_eq!(document["files"], serde_json::json!(paths));
    let [sheet, first, second] = [1, 2, 3].map(|index| fs::read_to_string(&paths[index]).unwrap());
    assert!(sheet.contains("x against t") && sheet.contains("A2 against A1"));
    assert!(first.contains("x against t") && !first.contains("A2 against A1"));
    assert!(second.contains("A2 against A1") && second.contains("width=\"900\" height=\"560\""));
    let twice = patchcord(&["run", &file, "--out", &inside, "--plot", &paths[2]]);
    assert!(code(&twice) == 2 && errors(&twice).contains("would be written twice"), "{}", errors(&twice));
}

#[test]
fn options_set_the_size_of_pictures() {
    let (folder, file) = spring();
    let [svg, png] = ["sized.svg", "sized.png"].map(|name| path(&folder, name));
    let sized = ["--width", "400", "--height", "300"];
    assert_eq!(code(&patchcord(&[&["run", &file, "--plot", &svg], &sized[..]].concat())), 0);
    assert!(fs::read_to_string(&svg).unwrap().contains("width=\"400\" height=\"300\""));
    assert_eq!(code(&patchcord(&[&["run", &file, "--plot", &png, "--scale", "2"], &sized[..]].concat())), 0);
    // The header of a PNG file has the width and the height.
    assert_eq!(fs::read(&png).unwrap()[16..24], [0_u8, 0, 3, 32, 0, 0, 2, 88]);
}

#[test]
fn wrong_sizes_are_reported_before_the_run() {
    let (folder, file) = spring();
    let [svg, png] = ["wrong.svg", "wrong.png"].map(|name| path(&folder, name));
    let wrong: &[(&[&str], &str)] = &[
        (&["--plot", &svg, "--width", "20"], "must be an integer from 240 to 4000"),
        (&["--plot", &svg, "--height", "1e3"], "must be an integer from 240 to 4000"),
        (&["--plot", &png, "--scale", "0"], "must be a factor from 0.25 to 10"),
        (&["--plot", &svg, "--scale", "2"], "--scale is for PNG files: also give --plot FILE.png"),
        (&["--width", "400"], "are for pictures: also give --plot FILE or --out DIR"),
        (&["--plot", &png, "--width", "4000", "--height", "4000", "--scale", "10"], "100 million pixels"),
    ];
    for (options, message) in wrong {
        let ran = patchcord(&[&["run", &file], *options].concat());
        assert_eq!((code(&ran), out(&ran).as_str()), (2, ""), "{options:?}");
        assert!(errors(&ran).contains(message), "{}", errors(&ran));
    }
    assert!(!Path::new(&svg).exists() && !Path::new(&png).exists());
}

/// The ramp reaches 100 V after 1 s, and the circuit of x does not read it.
#[test]
fn overloads_are_marked_in_pictures() {
    let before = "0.394784176}\n  },\n  \"signals\": {";
    let after = r#"0.394784176},
    "C1": {"kind": "integrator", "in": {"x1": ["-100"]}}
  },
  "pictures": [{"y": "x"}, {"y": "ramp"}, {"x": "x", "y": "ramp"}],
  "signals": {"ramp": {"at": "C1", "scale": "position"}, "#;
    let (folder, file) = spring_with(before, after);
    let inside = path(&folder, "new");
    assert_eq!(code(&patchcord(&["run", &file, "--out", &inside])), 0);
    let [clean, against_time, against_x] = [1, 2, 3].map(|number| {
        let picture = format!("spring.picture-{number}.svg");
        fs::read_to_string(Path::new(&inside).join(picture)).unwrap()
    });
    assert!(!clean.contains("C1 over 100 V"));
    let warning = "C1 over 100 V from 1 s: curves are wrong where they are pale";
    assert!(against_time.contains(warning) && against_x.contains(warning), "{against_time}");
    assert!(against_time.contains(">\nC1 over 100 V from 1 s\n<"), "the marker has a label");
    // The pale part and the correct part of the curve. The beam returns often, so the pale part has several strokes.
    let parts = |text: &str| {
        let strokes = text.split("<polyline").skip(1).map(|stroke| stroke.split("points=").next().unwrap());
        strokes.collect::<std::collections::BTreeSet<_>>().len()
    };
    assert_eq!([parts(&clean), parts(&against_time), parts(&against_x)], [1, 2, 2]);
}
