//! `patchcord check` with `--test` and `--scaling`.

use std::fs;

use super::{code, errors, json, out, patchcord, path, spring_with};

const SPRING: &str = "patches/lessons/mass-and-spring.json";
const LORENZ: &str = "patches/lessons/lorenz.json";
/// A gain of 1 in place of 10 in front of the integrator of the velocity.
const WRONG_GAIN: &str = "crates/equations/tests/patches/traps/g1.json";

/// The words of the first line that begins with a word.
fn line<'a>(text: &'a str, first: &str) -> Vec<&'a str> {
    let lines = text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let mut found = lines.filter(|words| words.first() == Some(&first));
    found.next().unwrap_or_else(|| panic!("{first} has no line:\n{text}"))
}

#[test]
fn a_correct_patch_agrees_at_test_values() {
    let checked = patchcord(&["check", SPRING, "--test", "x=2 cm", "--test", "v=300"]);
    let text = out(&checked);
    assert_eq!(code(&checked), 0, "{text}{}", errors(&checked));
    assert!(text.contains("static check at x = 20 mm, v = 300 mm/s:\n"), "{text}");
    assert!(text.ends_with("\nno difference\n") && !text.contains("DIFFERENT"), "{text}");
    // 20 mm and 300 mm/s are 20 V and 30 V; v' = -k/m x = -800 mm/s2.
    assert_eq!(&line(&text, "A1")[..7], ["A1", "30.0000", "30.0000", "v", "300", "300", "mm/s"]);
    assert_eq!(&line(&text, "B1")[..7], ["B1", "20.0000", "20.0000", "x", "20", "20", "mm"]);
    assert_eq!(&line(&text, "A1'")[..7], ["A1'", "-80.0000", "-80.0000", "v'", "-800", "-800", "mm/s2"]);
    assert!(text.contains("from its inputs") && text.contains("- position"), "{text}");
}

#[test]
fn a_wrong_gain_is_found_with_its_correction() {
    let checked = patchcord(&["check", WRONG_GAIN, "--test", "x=20", "--test", "x'=300"]);
    let text = out(&checked);
    assert_eq!(code(&checked), 1, "{text}");
    assert!(text.starts_with("static check at x = 20 mm, x' = 300 mm/s:\n"), "{text}");
    let derivative = line(&text, "A1'");
    assert_eq!(&derivative[..7], ["A1'", "-80.0000", "-8.0000", "v'", "-800", "-80", "mm/s2"]);
    assert_eq!(derivative[7], "DIFFERENT");
    assert_eq!(text.matches("DIFFERENT").count(), 1, "{text}");
    let conclusion = "1 difference, the first at A1' (velocity)\n\
                      most likely correction: plug P1 into x10 of A1 in place of x1\n";
    assert!(text.ends_with(conclusion), "{text}");
    assert!(errors(&checked).contains("equation-not-solved"), "{}", errors(&checked));

    let checked = patchcord(&["check", WRONG_GAIN, "--test", "x=20", "--json"]);
    assert_eq!(code(&checked), 1);
    let document = json(&checked);
    assert_eq!(
        (&document["ok"], &document["diagnostics"][0]["code"]),
        (&false.into(), &"equation-not-solved".into())
    );
    let check = &document["static_check"];
    assert_eq!(check["first_difference"], "A1'");
    assert_eq!(check["correction"], "plug P1 into x10 of A1 in place of x1");
    let rows = check["rows"].as_array().unwrap();
    let differing: Vec<_> = rows.iter().filter(|row| row["differs"] == true).collect();
    assert_eq!(differing.len(), 1);
    assert_eq!((&differing[0]["element"], &differing[0]["unit"]), (&"A1".into(), &"V/s".into()));
}

#[test]
fn random_values_follow_from_the_seed() {
    let random = |arguments: &[&str]| {
        let checked = patchcord(&[&["check", SPRING, "--test", "random"], arguments].concat());
        assert_eq!(code(&checked), 0, "{}{}", out(&checked), errors(&checked));
        out(&checked)
    };
    let first = random(&[]);
    assert!(first.contains("no difference") && !first.contains("overload"), "{first}");
    assert_eq!(first, random(&["--seed", "1"]));
    assert_ne!(first, random(&["--seed", "2"]));
}

/// The static checks of the shipped patches, at the initial condition and at random values.
#[test]
fn shipped_patches_agree_with_their_equations() {
    let patches = [
        "lessons/mass-and-spring",
        "lessons/lorenz",
        "lessons/van-der-pol",
        "lessons/driven-oscillator",
        "lessons/predator-and-prey",
        "lessons/heat-rod",
        "lessons/mathieu",
        "lessons/square-root-and-division",
        "thesis/fig-8-04",
        "thesis/fig-8-16",
        "problems/three-masses",
    ];
    let mut failures = Vec::new();
    for patch in patches {
        let file = format!("patches/{patch}.json");
        for test in [&["initial"][..], &["random"], &["random", "--seed", "2"], &["random", "--seed", "3"]] {
            let checked = patchcord(&[&["check", file.as_str(), "--test"], test].concat());
            if code(&checked) != 0 {
                failures.push(format!("{patch} {test:?}:\n{}{}", out(&checked), errors(&checked)));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn wrong_test_values_are_refused_with_a_hint() {
    let cases: &[(&[&str], &str)] = &[
        (&["--test", "pressure=1"], "--test: there is no quantity pressure; known here: v, x"),
        (
            &["--test", "total=1"],
            "--test: total follows from the outputs of integrators and cannot be set; set v, x",
        ),
        (&["--test", "x=3 kg"], "--test x: \"3 kg\" is in kg, but mm is expected"),
        (&["--test", "x'=3 mm"], "--test x': \"3 mm\" is in mm, but mm/s is expected"),
        (&["--test", "x=1", "--test", "A2=1"], "--test: x and A2 set the same output; give one of them"),
        (&["--test", "x"], "write NAME=VALUE, such as x=0.5, or random, or initial"),
        (&["--test", "x=fast"], "\"fast\" is not a number"),
        (&["--test", "random", "--test", "x=1"], "--test random and --test initial exclude other values"),
        (&["--test", "x=1", "--seed", "2"], "--seed applies to --test random only"),
    ];
    for (arguments, message) in cases {
        let failed = patchcord(&[&["check", SPRING], *arguments].concat());
        assert_eq!(code(&failed), 2, "{arguments:?}: {}", out(&failed));
        assert!(errors(&failed).contains(message), "{arguments:?}: {}", errors(&failed));
    }
}

#[test]
fn an_overload_at_test_values_is_marked() {
    let checked = patchcord(&["check", SPRING, "--test", "x=200"]);
    assert_eq!(code(&checked), 0, "{}", errors(&checked));
    let text = out(&checked);
    assert!(line(&text, "B1").contains(&"overload,"), "{text}");
    let conclusion = "overload at these values: use smaller test values\n8 rows not compared\n\
                      no difference in the other rows\n";
    assert!(text.ends_with(conclusion), "{text}");
    assert!(text.contains("not compared: A2 is overloaded"), "{text}");
    let document = json(&patchcord(&["check", SPRING, "--test", "x=200", "--json"]));
    let rows = document["static_check"]["rows"].as_array().unwrap();
    let row = |name: &str| rows.iter().find(|row| row["element"] == name).unwrap();
    assert_eq!(row("B1")["not_compared"], "A2 is overloaded");
    assert!(row("A1")["not_compared"].is_null());
}

/// The amplifier A2 of x is overloaded itself, and the rows behind it are not compared.
#[test]
fn an_overloaded_row_names_its_overload_once() {
    let text = out(&patchcord(&["check", SPRING, "--test", "x=200"]));
    let own = text.lines().find(|line| line.starts_with("A2 ")).unwrap_or_else(|| panic!("{text}"));
    assert!(own.contains("overload, test value") && !own.contains("not compared"), "{text}");
    assert!(line(&text, "B1").contains(&"compared:"), "{text}");
}

/// The first patch has notes with several clauses.
#[test]
fn a_table_has_the_first_clause_of_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "spring.json");
    assert_eq!(code(&patchcord(&["new", &file])), 0);
    let text = out(&patchcord(&["check", &file, "--test", "x=20"]));
    assert_eq!(line(&text, "A1").last(), Some(&"velocity"), "{text}");
    assert_eq!(line(&text, "P2").last(), Some(&"damping"), "{text}");
    let long = text.lines().find(|line| line.starts_with("A2 ")).unwrap_or_else(|| panic!("{text}"));
    assert!(long.ends_with("position with the opposite sign, becaus…"), "{text}");
    let document = json(&patchcord(&["check", &file, "--test", "x=20", "--json"]));
    let rows = document["static_check"]["rows"].as_array().unwrap();
    let note = rows.iter().find(|row| row["element"] == "P2").map(|row| &row["note"]);
    assert_eq!(note, Some(&"damping; divided by 10 for the same reason".into()));
}

/// Derivatives of voltages are in machine time, and those of quantities in problem time.
#[test]
fn the_heading_of_derivatives_relates_the_two_times() {
    let heading = |patch: &str| {
        let text = out(&patchcord(&["check", patch, "--test", "initial"]));
        text.lines().find(|line| line.starts_with("derivatives in")).map(str::to_owned)
    };
    assert_eq!(heading(SPRING).as_deref(), Some("derivatives in V/s of machine time:"));
    let slow = "derivatives in V/s of machine time (0.1 machine seconds per problem second):";
    assert_eq!(heading("patches/lessons/van-der-pol.json").as_deref(), Some(slow));
}

/// The Lorenz equations have pure numbers, and -1e-7 V is rounded to 0 V.
#[test]
fn pure_numbers_have_no_unit_and_0_has_no_sign() {
    let text = out(&patchcord(&["check", LORENZ, "--test", "x=0.5", "--test", "y=-1e-6"]));
    assert!(text.contains("\nstatic check at x = 0.5, y = -1e-6:\n"), "{text}");
    assert_eq!(&line(&text, "A2")[..5], ["A2", "0.0000", "0.0000", "y", "-1e-6"], "{text}");
    assert!(!text.contains("-0.0000"), "{text}");
}

#[test]
fn without_equations_there_are_wired_values_only() {
    let (_folder, file) = spring_with("", "");
    let checked = patchcord(&["check", &file, "--test", "A2=-20"]);
    let text = out(&checked);
    assert_eq!(code(&checked), 0, "{}", errors(&checked));
    assert_eq!(&line(&text, "B1")[..3], ["B1", "20.0000", "x"]);
    assert!(text.ends_with("the patch states no equations, so there are no expected values\n"), "{text}");
}

#[test]
fn derivatives_are_printed_with_the_voltages() {
    let text = out(&patchcord(&["check", SPRING, "--voltages"]));
    // 80 V through P1 = 0.4 into x10 of A1, and 0 V into A2.
    assert_eq!(line(&text, "element"), ["element", "kind", "volts", "V/s"]);
    assert_eq!(line(&text, "A1"), ["A1", "integrator", "0.0000", "-320.0000"]);
    assert_eq!(line(&text, "A2"), ["A2", "integrator", "-80.0000", "0.0000"]);
    assert_eq!(line(&text, "B1"), ["B1", "inverter", "80.0000"]);
    let document = json(&patchcord(&["check", SPRING, "--json"]));
    let voltages = document["voltages"].as_array().unwrap();
    let entry = |name: &str| voltages.iter().find(|entry| entry["element"] == name).unwrap();
    assert!((entry("A1")["rate"].as_f64().unwrap() + 320.0).abs() < 1e-9);
    assert!(entry("B1")["rate"].is_null() && document["static_check"].is_null());
}

/// A velocity scale in m/s in place of mm/s: the wiring does not solve an equation, and a scale has a warning.
#[test]
fn a_wrong_patch_has_its_voltages_and_warnings_too() {
    let wrong_unit = "crates/equations/tests/patches/traps/g6c.json";
    let checked = patchcord(&["check", wrong_unit, "--voltages"]);
    assert_eq!(code(&checked), 1);
    // 50 V through P1 = 40 x 1e-3 / 10 / 10 into x10 of A1.
    let text = out(&checked);
    assert_eq!(line(&text, "A1"), ["A1", "integrator", "0.0000", "-0.2000"]);
    assert_eq!(line(&text, "B1"), ["B1", "summer", "50.0000"]);
    let report = errors(&checked);
    assert!(report.ends_with("g6c.json: 1 error, 1 warning\n"), "{report}");
    assert_eq!(report.matches("warning[scale-mismatch]").count(), 1, "{report}");

    let document = json(&patchcord(&["check", wrong_unit, "--json"]));
    let codes: Vec<_> =
        document["diagnostics"].as_array().unwrap().iter().map(|finding| &finding["code"]).collect();
    assert_eq!(codes, ["equation-not-solved", "scale-mismatch"]);
    let voltages = document["voltages"].as_array().unwrap();
    let rate = voltages.iter().find(|entry| entry["element"] == "A1").unwrap()["rate"].as_f64().unwrap();
    assert!((rate + 0.2).abs() < 1e-9, "{rate}");
}

#[test]
fn the_equations_decide_about_gains() {
    let right = patchcord(&["check", SPRING, "--scaling"]);
    let text = out(&right);
    assert!(text.contains("nothing wrong\n") && text.contains("m x'' = -k x"), "{text}");
    let wrong = patchcord(&["check", WRONG_GAIN, "--scaling"]);
    assert_eq!(code(&wrong), 1);
    let text = out(&wrong);
    assert!(text.contains("-90.00 %") && !text.contains("nothing wrong"), "{text}");
}

#[test]
fn wrong_gains_are_not_called_right_without_equations() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "slow.json");
    let text = fs::read_to_string(WRONG_GAIN).unwrap();
    let text = text.replace("\"equations\": [\n    \"m x'' = -k x\",\n    \"x' = v\"\n  ],\n", "");
    let text = text.replace("\"in\": {\"x10\": [\"A1\"]}", "\"in\": {\"x1\": [\"A1\"]}");
    fs::write(&file, text).unwrap();
    let checked = patchcord(&["check", &file, "--scaling"]);
    let text = out(&checked);
    assert_eq!(code(&checked), 0, "{}", errors(&checked));
    assert!(text.contains("slow.json: no errors, 1 warning, 1 wrong gain\n"), "{text}");
    assert!(
        text.contains("-90.00 %") && text.contains("not decided: the patch states no equations\n"),
        "{text}"
    );
}
