//! `patchcord slideway`, and docs/slideway.md, which shows its output.

use std::fs;

use super::{code, errors, json, out, patchcord, path};
use crate::common::pages::assert_part_up_to_date;

pub(super) const SLIDEWAY: [&str; 7] = ["slideway", "--oil", "0.34", "--weight", "450", "--stiffness", "20"];

fn slideway(more: &[&str]) -> std::process::Output {
    patchcord(&[&SLIDEWAY[..], more].concat())
}

#[test]
fn the_page_shows_the_output() {
    let shown = slideway(&[]);
    assert_eq!((code(&shown), errors(&shown).as_str()), (0, ""));
    let indented = out(&shown)
        .lines()
        .map(|line| format!("    {line}").trim_end().to_owned() + "\n")
        .collect::<String>();
    assert_part_up_to_date("docs/slideway.md", "command", &indented, "patchcord");
    let page = fs::read_to_string("docs/slideway.md").unwrap();
    assert!(page.contains(&format!(
        "\n    patchcord {} --plot slideway.svg --out slideway.json\n",
        SLIDEWAY.join(" ")
    )));
}

#[test]
fn json_is_one_document_in_si_units() {
    let document = json(&slideway(&["--json", "--threshold", "0.5"]));
    assert_eq!(document["ok"], true);
    assert_eq!(document["inputs"]["viscosity"], 0.034);
    assert_eq!(document["criterion"]["threshold"], 5e-4);
    let rising = document["critical_velocity"]["rising"]["value"].as_f64().unwrap();
    assert!((0.012..0.02).contains(&rising), "{rising}");
    let half = document["with_half_the_threshold"]["rising"]["value"].as_f64().unwrap();
    assert!(half > rising);
    let fs = &document["parameters"][3];
    assert_eq!((&fs["name"], &fs["unit"], &fs["from"]), (&"Fs".into(), &"N".into(), &"eq 12-9".into()));
    assert!(fs["other"]["value"].as_f64().unwrap() < fs["value"].as_f64().unwrap());
    let advice = document["advice"].as_array().unwrap();
    assert_eq!(advice.len(), 7);
    assert!(advice.iter().all(|advice| advice["verdict"] == "confirmed"), "{advice:?}");
    assert_eq!(advice[4]["eq_93_9_printed"]["value"], serde_json::Value::Null);
    assert!(advice[4]["eq_93_9_printed"]["because"].as_str().unwrap().contains("it never oscillates"));
    assert!(document["predictions"]["routh_hurwitz"]["value"].as_f64().unwrap() < rising);
    assert_eq!(document["files"].as_array().unwrap().len(), 0);
}

#[test]
#[ignore = "takes ten seconds"]
fn the_written_patch_reproduces_the_simulation() {
    let folder = tempfile::tempdir().unwrap();
    let [patch, plot] = ["slideway.json", "slideway.png"].map(|name| path(&folder, name));
    let report = json(&slideway(&["--out", &patch, "--plot", &plot, "--tol", "1e-7", "--json"]));
    assert_eq!(report["files"], serde_json::json!([patch, plot]));
    assert!(fs::read(&plot).unwrap().starts_with(b"\x89PNG"));
    assert!(out(&patchcord(&["check", &patch])).contains("nothing wrong\n"));
    let run = json(&patchcord(&["run", &patch, "--json"]));
    let times = ["for", "step", "tolerance", "every"];
    assert!(times.iter().all(|time| run["run"][time] == report["run"][time]), "{}", report["run"]);
    assert_eq!(run["run"]["tolerance"], 1e-7);
    let measured = out(&patchcord(&["sweep", &patch, "--vary", "K=20e6", "--measure", "critical_velocity"]));
    let cells: Vec<_> = measured.lines().last().unwrap().split(',').collect();
    for (cell, ramp) in cells[1..3].iter().zip(["rising", "falling"]) {
        assert_eq!(
            cell.parse::<f64>().unwrap(),
            report["critical_velocity"][ramp]["value"].as_f64().unwrap()
        );
    }
}

#[test]
fn wrong_inputs_return_errors_with_the_option_that_helps() {
    let cases: [(&[&str], &str); 20] = [
        (
            &["--set", "M=20"],
            "M = 20 kg is below the range of the circuit of Fig 8.16, 180 ... 4000 kg: it is set by --set M",
        ),
        (&["--set", "v_turn=4000"], "0 ... 3600 s: it is set by --set v_turn"),
        (&["--ridge-height", "1e-6"], "height of a ridge must be within 0.001 ... 100000, got 0.000001 "),
        (&["--ridge-height", "1e-6"], ": change --ridge-height\n"),
        (&["--ridge-width", "1e9"], "width of a ridge must be within 0.001 ... 100000, got 1000000000 "),
        (&["--ridge-width", "1e9"], ": change --ridge-width\n"),
        (&["--ridge-width", "50000"], ": change --ridge-width or --ridge-height\n"),
        (&["--set", "q=1"], "the circuit of Fig 8.16 has no parameter q; known here: M, K, f, Fs, VcL, Tc"),
        (&["--set", "v_turn=-1"], "the velocity command must rise"),
        (&["--set", "v_rate=0.1"], "give a higher --threshold, or a lower v_rate with --set"),
        (&["--window", "100"], "exceeds the run of 32 s: give a shorter --window"),
        (&["--every", "0.02"], "give a shorter --every or a longer --window"),
        (
            &["--area", "1"],
            "weight / area must be within 0.0001 ... 8, got 450 kgf/cm2: change --weight or --area",
        ),
        (&["--by", "100"], "must be less than 100 %"),
        (&["--area", "700kg"], "\"700kg\" is in kg, but cm2 is expected"),
        (&["--set", "VcL=3s"], "--set VcL: \"3s\" is in s, but m/s is expected"),
        (&["--ridge-height", "-1"], "must be a positive number"),
        (&["--step", "1e-9"], "at most 1e10 are allowed: give a longer --step\n"),
        (&["--step", "1e-5", "--tol", "1e-6"], "cannot be used with"),
        (&["--plot", "a.gif"], "unknown picture format"),
    ];
    for (more, wanted) in cases {
        let failed = slideway(more);
        assert_eq!((code(&failed), out(&failed).as_str()), (2, ""), "{more:?}");
        assert!(errors(&failed).contains(wanted), "{more:?}: {}", errors(&failed));
        let document = json(&slideway(&[more, &["--json"]].concat()));
        assert_eq!(document["ok"], false, "{more:?}");
    }
    let of = |oil: &str, weight: &str, stiffness: &str| {
        errors(&patchcord(&["slideway", "--oil", oil, "--weight", weight, "--stiffness", stiffness]))
    };
    assert!(
        of("1e-5", "450", "20")
            .contains("viscosity must be within 0.001 ... 1000, got 0.00001 P: change --oil")
    );
    assert!(
        of("0.3", "20", "20").contains("M = 20 kg is below")
            && of("0.3", "20", "20").contains(": --weight takes 180 ... 4000 kgf\n")
    );
    assert!(of("0.3", "450", "200").contains("5 ... 178 MN/m: --stiffness takes 5 ... 178 kN/mm\n"));
    assert!(of("0.3", "450", "20e6").contains("K = 2.000e7 MN/m is above the range"));
    assert!(errors(&patchcord(&["slideway", "--oil", "0.3"])).contains("--weight <KGF>"));
}

/// With the polar additive there is only ringing after the first slip.
#[test]
fn ringing_is_no_oscillation_that_advice_could_lower() {
    let folder = tempfile::tempdir().unwrap();
    let plot = path(&folder, "polar.svg");
    let polar = out(&slideway(&["--polar", "--plot", &plot]));
    assert_eq!(polar.matches("nothing to lower: it only rings\n").count(), 7, "{polar}");
    assert!(
        polar.contains("\nnote: it rings as it breaks away, and does not oscillate after that"),
        "{polar}"
    );
    assert!(fs::read_to_string(&plot).unwrap().contains("the command rises, ringing ends at 0.4644 mm/s"));
    let fast = out(&slideway(&["--set", "v_rate=4e-3"]));
    assert!(fast.contains("cannot be read: the command is too fast for half the threshold\n"), "{fast}");
}

#[test]
fn a_run_that_ends_in_overload_is_no_result() {
    let folder = tempfile::tempdir().unwrap();
    let patch = path(&folder, "slideway.json");
    let overloaded = slideway(&["--step", "0.05", "--out", &patch]);
    assert_eq!((code(&overloaded), out(&overloaded).as_str()), (1, ""));
    assert!(errors(&overloaded).contains(" is overloaded even at 25.4 mm/s a volt"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    let picture = slideway(&["--plot", &path(&folder, "a.svg"), "--out", &path(&folder, "a.svg")]);
    assert!(code(&picture) == 2 && errors(&picture).contains("--out writes a patch"));
    let nowhere = slideway(&["--out", &path(&folder, "none/a.json")]);
    assert!(code(&nowhere) == 1 && errors(&nowhere).contains("no such folder"));
}
