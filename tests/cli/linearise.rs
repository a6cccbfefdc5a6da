//! `patchcord linearise`.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::{FIG_8_16, code, errors, json, out, patchcord, path};

pub(super) const FIG_8_04: &str = "patches/thesis/fig-8-04.json";

#[test]
fn the_page_shows_what_the_command_prints() {
    let page = fs::read_to_string("docs/linearise.md").unwrap();
    let shown: Vec<&str> =
        page.split("```text\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let commands = [
        "linearise patches/thesis/fig-8-04.json",
        "linearise patches/lessons/van-der-pol.json --set x0=0",
        "linearise patches/thesis/fig-8-04.json --from v_i --to v_o --hz 25:40",
    ];
    for command in commands {
        assert!(page.contains(&format!("    patchcord {command}\n")), "{command}");
        let printed = out(&patchcord(&command.split(' ').collect::<Vec<_>>()));
        assert!(shown.iter().any(|block| printed.contains(block)), "{command}\n{printed}");
    }
    assert_eq!(shown.len(), commands.len());
}

#[test]
fn a_response_is_printed_drawn_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let (svg, csv) = (path(&folder, "bode.svg"), path(&folder, "bode.csv"));
    let arguments = [
        "linearise",
        FIG_8_04,
        "--from",
        "v_i",
        "--to",
        "v_o",
        "--hz",
        "10:100",
        "--plot",
        &svg,
        "--csv",
        &csv,
    ];
    let done = patchcord(&arguments);
    assert_eq!((code(&done), errors(&done).as_str()), (0, ""));
    assert!(
        out(&done).contains("v_o from v_i") && out(&done).contains(&format!("wrote {csv}\nwrote {svg}\n"))
    );
    let picture = fs::read_to_string(&svg).unwrap();
    for part in ["Bode plot: v_o from v_i", "frequency, Hz", "phase of v_o against v_i, degrees", "31.57 Hz"]
    {
        assert!(picture.contains(part), "{part}");
    }
    let table = fs::read_to_string(&csv).unwrap();
    assert!(table.contains("\nfrequency,ratio,decibels,phase\n10.0,"), "{table}");
}

#[test]
fn with_several_drives_the_common_drive_must_be_specified() {
    let oscillator = "patches/lessons/driven-oscillator.json";
    let text = out(&patchcord(&["linearise", oscillator, "--from", "x", "--to", "v"]));
    assert!(text.contains("\nv from x, moved by push\n"), "{text}");
    let between = ["linearise", FIG_8_04, "--from", "spring_force", "--to", "v_o"];
    let failed = patchcord(&between);
    assert_eq!(code(&failed), 2);
    let expected = "spring_force is not a drive; known here: v_i, x_i; between two signals, --by specifies their common drive";
    assert!(errors(&failed).contains(expected), "{}", errors(&failed));
    let document = json(&patchcord(&[&between[..], &["--by", "x_i", "--json"]].concat()));
    assert_eq!(
        (&document["response"]["by"], &document["response"]["from"]),
        (&"x_i".into(), &"spring_force".into())
    );
}

#[test]
fn json_is_one_document() {
    let document = json(&patchcord(&["linearise", FIG_8_04, "--from", "v_i", "--to", "v_o", "--json"]));
    let number = |value: &Value| value.as_f64().unwrap();
    assert_eq!(document["ok"], true);
    let root = &document["roots"][0];
    assert!((number(&root["natural_frequency"]) - (17.86e6f64 / 454.0).sqrt()).abs() < 1e-9);
    assert_eq!((&root["stability"], &root["time_constant"]), (&"stable".into(), &Value::Null));
    let point = &document["operating_point"];
    assert_eq!((&point["equilibrium"], &point["kinks"]), (&false.into(), &serde_json::json!([])));
    assert_eq!(point["states"][0]["name"], "A1");
    assert_eq!(number(&document["state_matrix"][0][1]), -100.0);
    assert_eq!(document["response"]["points"][0].as_array().unwrap().len(), 3);
    let held = json(&patchcord(&["linearise", "patches/thesis/fig-8-16-coulomb.json", "--json"]));
    assert_eq!(held["operating_point"]["states"][1]["held"], "brake");
    assert_eq!(held["operating_point"]["moving"], serde_json::json!(["v_i"]));
}

#[test]
fn limits_of_the_linear_model_are_reported() {
    let rest = out(&patchcord(&["linearise", "patches/thesis/fig-8-16-coulomb.json"]));
    for part in ["all rates are 0, but v_i moves", "A3: held, omitted from the roots", "A3: at a kink"] {
        assert!(rest.contains(part), "{part}\n{rest}");
    }
    let delayed = out(&patchcord(&["linearise", "crates/core/tests/patches/delay-line.json", "--at", "3"]));
    assert!(
        delayed.contains("at t = 3 s")
            && delayed.contains("the loop through D2 has infinitely many characteristic roots"),
        "{delayed}"
    );
}

#[test]
fn a_large_state_matrix_is_printed_without_zeros() {
    let folder = tempfile::tempdir().unwrap();
    let patch = path(&folder, "row.json");
    let lag = |n: usize| {
        let from = if n == 0 { "+100".to_owned() } else { format!("L{}", n - 1) };
        (format!("L{n}"), serde_json::json!({"kind": "lag", "in": {"x1": [from]}, "time": 0.5}))
    };
    let elements: serde_json::Map<_, _> = (0..50).map(lag).collect();
    let text = serde_json::json!({"patchcord": 1, "machine": "unlimited", "elements": elements}).to_string();
    fs::write(&patch, text).unwrap();
    let text = out(&patchcord(&["linearise", &patch]));
    assert!(text.contains("L1       L0 -2, L1 -2\n") && text.contains("and 10 more: see --json"), "{text}");
    assert!(text.contains("  -2     50      2"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() < 100));
}

#[test]
fn a_patch_with_too_many_states_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "many.json");
    let element =
        |n: usize| (format!("I{n}"), serde_json::json!({"kind": "integrator", "in": {"x1": ["+100"]}}));
    let elements: serde_json::Map<_, _> = (0..501).map(element).collect();
    fs::write(&file, serde_json::json!({"patchcord": 1, "elements": elements}).to_string()).unwrap();
    let refused = patchcord(&["linearise", &file]);
    let expected = "the linear model has 501 states, delay lines and drives and 502002 derivatives; at most 500 and \
                    5000000 are allowed";
    assert_eq!(code(&refused), 1);
    assert!(errors(&refused).contains(expected), "{}", errors(&refused));
}

#[test]
fn wrong_options_give_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    let copy = path(&folder, "patch.svg");
    fs::copy(FIG_8_04, &copy).unwrap();
    for (patch, options, expected) in [
        (FIG_8_04, "--from v_o --to v_i", "v_o is not a drive; did you mean \"v_i\"?"),
        (FIG_8_04, "--from v_i --to nothing", "the patch has no signal nothing; known here: x_error"),
        (FIG_8_04, "--from v_i", "--to"),
        (FIG_8_04, "--plot bode.svg", "--from"),
        (FIG_8_04, "--at -1", "must be a time of at least 0 s"),
        (FIG_8_04, "--at soon", "\"soon\" is not a number: give the value in s"),
        (FIG_8_04, "--at 1e15", "give an earlier time with --at"),
        (FIG_8_04, "--at 1e-9", "give a later time with --at"),
        (FIG_8_04, "--from v_i --to v_o --hz 5", "write LOW:HIGH"),
        (FIG_8_04, "--from v_i --to v_o --hz 5:x", "\"x\" is not a number: give the value in Hz"),
        (FIG_8_04, "--from v_i --to v_o --hz 5:1", "got 5 to 1 Hz"),
        (
            FIG_8_04,
            "--from v_i --to v_o --hz 1e-300:1e300",
            "within 1e-100 ... 1e100 Hz, got 1e-300 to 1e300",
        ),
        (FIG_8_04, "--from v_i --to v_o --hz -5:1", "got -5 to 1 Hz"),
        (FIG_8_04, "--from v_i --to v_o --plot bode.gif", ".svg or .png"),
        (&copy, &format!("--from v_i --to v_o --plot {copy}"), "the patch itself"),
        ("crates/core/tests/patches/delay-line.json", "--from sine --to late --hz 1:1e9", "turn the phase"),
    ] {
        let failed =
            patchcord(&[&["linearise", patch], &options.split(' ').collect::<Vec<_>>()[..]].concat());
        assert_eq!(code(&failed), 2, "{options}: {}", errors(&failed));
        assert!(errors(&failed).contains(expected), "{}", errors(&failed));
    }
    assert!(fs::read_to_string(&copy).unwrap().starts_with('{') && !Path::new("bode.svg").exists());
}

#[test]
fn a_signal_without_influence_gives_exit_code_1() {
    let failed = patchcord(&["linearise", FIG_8_04, "--from", "v_i", "--to", "x_i", "--json"]);
    assert_eq!(code(&failed), 1);
    assert!(
        json(&failed)["error"]
            .as_str()
            .unwrap()
            .starts_with("x_i does not depend on v_i at this operating point")
    );
    // Inside the dead zone the slideway does not depend on the command.
    let unmoved = patchcord(&["linearise", FIG_8_16, "--from", "v_i", "--to", "v_o"]);
    assert_eq!(code(&unmoved), 1, "{}", out(&unmoved));
}
