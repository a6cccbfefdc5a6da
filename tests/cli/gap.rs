//! `patchcord gap`

use serde_json::Value;

use super::{code, errors, json, out, patchcord};

const SLIDE: &str = "crates/ident/tests/slide.json";

#[test]
fn the_check_of_data_is_a_table_a_record() {
    let told = patchcord(&["gap", SLIDE, "--check"]);
    assert_eq!((code(&told), errors(&told).as_str()), (0, ""));
    let text = out(&told);
    for part in [
        "crates/ident/tests/slide.json: nothing wrong\nA table that a motor pushes\n",
        "to fit: M, f\n",
        "train: slide.csv, 0 ... 5 s, 251 samples every 20 ms\n",
        "test: slide.csv, 5.02 ... 8 s, 150 samples every 20 ms\n",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let force = text.lines().find(|line| line.starts_with("force")).unwrap();
    assert!(force.contains("drive F") && force.contains("1 mN"), "{force}");
    let position = text.lines().find(|line| line.starts_with("position")).unwrap();
    assert!(
        position.contains("signal x") && position.contains("white") && position.contains("10 µm"),
        "{position}"
    );
    assert!(text.contains("would be tried at F: actuator-lag, backlash, "), "{text}");
    assert!(text.contains("The patch has no place for leak, load-dependent-friction, overflow.\n"), "{text}");
    let friction = text.lines().find(|line| line.starts_with("coulomb-friction")).unwrap();
    assert!(friction.contains("A1  Fc ") && friction.ends_with(" N"), "{friction}");
}

/// Beside what the patch fits itself the same effect does not show, whatever the data.
#[test]
fn the_check_tells_from_which_strength_on_an_effect_would_show() {
    let told = json(&patchcord(&["gap", SLIDE, "--check", "--json", "--threads", "1"]));
    let limits = told["limits"].as_array().unwrap();
    let of = |name: &str| limits.iter().find(|own| own["name"] == name).unwrap();
    let [friction, viscous] = ["coulomb-friction", "viscous-friction"].map(of);
    assert_eq!((&friction["seen"], &friction["unit"]), (&Value::Bool(true), &"N".into()));
    // A force of 3 N moves the table; what is read to 0.2 mm tells a hundredth of it.
    assert!(friction["value"].as_f64().unwrap() < 0.03, "{friction}");
    // Below the end of its range the patch's own f makes up for it.
    assert!(viscous["value"].as_f64().unwrap() > 1.0, "{viscous}");
    assert!(told["leaves"].as_f64().unwrap() > 100.0, "{}", told["leaves"]);
    assert_eq!(told["left_out"], serde_json::json!([]));
    let again = json(&patchcord(&["gap", SLIDE, "--check", "--json", "--threads", "2"]));
    assert_eq!(again["limits"], told["limits"], "whatever the threads");
}

#[test]
fn the_check_tells_which_effects_would_not_show_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let here = std::env::current_dir().unwrap().display().to_string();
    let [patch, data] =
        ["base.json", "slide.csv"].map(|file| format!("\"{here}/crates/ident/tests/{file}\""));
    let asked = std::fs::read_to_string(SLIDE).unwrap();
    let asked = asked.replace("\"base.json\"", &patch).replace("\"slide.csv\"", &data);
    let noisy = folder.path().join("noisy.json");
    std::fs::write(&noisy, asked.replace("\"sigma\": 0.2,", "\"sigma\": 300,")).unwrap();
    let told = patchcord(&["gap", noisy.to_str().unwrap(), "--check"]);
    assert_eq!((code(&told), errors(&told).as_str()), (0, ""));
    let untold = "No strength in its range would show of saturation at F; needs: a drive that asks for less and for more than L.\n";
    assert!(out(&told).contains(untold), "{}", out(&told));
}

#[test]
fn effects_of_ones_own_are_checked_with_the_data() {
    let folder = tempfile::tempdir().unwrap();
    let asked = ["gap", SLIDE, "--check", "--effects", folder.path().to_str().unwrap()];
    let own = std::fs::read_to_string("patches/effects/saturation.json").unwrap();
    std::fs::write(folder.path().join("weak-motor.json"), &own).unwrap();
    assert!(out(&patchcord(&asked)).contains("time-delay, weak-motor\n"));
    std::fs::write(folder.path().join("weak-motor.json"), own.replace("\"drive\"", "\"drove\"")).unwrap();
    let told = patchcord(&asked);
    assert_eq!((code(&told), out(&told).as_str()), (1, ""));
    assert!(errors(&told).contains("weak-motor.json:"), "{}", errors(&told));
    std::fs::write(folder.path().join("weaker.json"), "{").unwrap();
    let both = json(&patchcord(&[&asked[..], &["--json"]].concat()));
    let files = both["diagnostics"].as_array().unwrap().iter().map(|own| own["file"].as_str().unwrap());
    let files: std::collections::BTreeSet<&str> =
        files.map(|file| file.rsplit('/').next().unwrap()).collect();
    let wanted = ["weak-motor.json", "weaker.json"].into();
    assert_eq!((both["ok"].as_bool(), files), (Some(false), wanted));
}

#[test]
fn the_page_shows_what_is_printed() {
    let page = std::fs::read_to_string("docs/gap.md").unwrap();
    let mut shown = page.split("```text\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    assert_eq!(shown.next().unwrap(), out(&patchcord(&["gap", SLIDE, "--check"])));
    let (command, printed) = shown.next().unwrap().split_once('\n').unwrap();
    let arguments: Vec<_> = command.strip_prefix("$ patchcord ").unwrap().split(' ').collect();
    assert_eq!(printed, out(&patchcord(&arguments)));
}

#[test]
fn the_document_has_what_the_table_has() {
    let told = json(&patchcord(&["gap", SLIDE, "--check", "--json"]));
    assert_eq!(
        (&told["ok"], &told["fit"][0], told["diagnostics"].as_array().unwrap().len()),
        (&Value::Bool(true), &"M".into(), 0)
    );
    let train = &told["records"][0];
    assert_eq!(
        (&train["part"], &train["samples"], &train["missing"]),
        (&"train".into(), &251.into(), &0.into())
    );
    let [force, position] = [0, 1].map(|place| &train["columns"][place]);
    assert_eq!(
        (&force["drive"], &position["signal"], &position["unit"]),
        (&"F".into(), &"x".into(), &"m".into())
    );
    let near = |value: &Value, wanted: f64| (value.as_f64().unwrap() / wanted - 1.0).abs();
    assert!(near(&position["noise"]["sigma"], 2e-4) < 0.12, "{position}");
    assert!(near(&position["step"], 1e-5) < 1e-6, "{position}");
    assert_eq!(position["power_below"].as_array().unwrap().len(), 3);
    assert_eq!(told["effects"][0], serde_json::json!({"name": "actuator-lag", "junctions": ["F"]}));
    assert_eq!(told["nameless"], serde_json::json!([]));
    assert_eq!(told["nowhere"], serde_json::json!(["leak", "load-dependent-friction", "overflow"]));
}

#[test]
fn a_wrong_experiment_is_told_with_its_place_and_nothing_else() {
    let bad = "crates/ident/tests/bad/constant-column-output.json";
    let told = patchcord(&["gap", bad, "--check"]);
    assert_eq!((code(&told), out(&told).as_str()), (1, ""));
    assert!(errors(&told).contains(&format!("{bad}:4:20")), "{}", errors(&told));
    assert!(errors(&told).ends_with(&format!("\n{bad}: 1 error\n")), "{}", errors(&told));
    let document = json(&patchcord(&["gap", bad, "--check", "--json"]));
    assert_eq!((&document["ok"], &document["experiment"]), (&Value::Bool(false), &bad.into()));
    assert_eq!(document["diagnostics"][0]["code"], "constant-column");
}

#[test]
fn a_wrong_patch_is_told_beside_the_experiment() {
    let told = patchcord(&["gap", "crates/ident/tests/bad/bad-patch-wrong.json", "--check", "--json"]);
    assert_eq!(code(&told), 1);
    let document = json(&told);
    let codes = [0, 1].map(|place| document["diagnostics"][place]["code"].as_str().unwrap());
    assert_eq!(codes, ["bad-patch", "unknown-kind"]);
    assert!(errors(&told).contains("did you mean \"summer\"?"), "{}", errors(&told));
}

#[test]
fn warnings_are_told_and_stop_nothing() {
    let told = patchcord(&["gap", "crates/ident/tests/bad/sampling-gap.json", "--check"]);
    assert_eq!(code(&told), 0);
    assert!(errors(&told).starts_with("warning[sampling-gap]"), "{}", errors(&told));
    assert!(
        out(&told).contains("no errors, 1 warning") && out(&told).contains("of them missing"),
        "{}",
        out(&told)
    );
}

#[test]
fn what_is_not_there_is_named() {
    let told = patchcord(&["gap", "no/such.json", "--check", "--json"]);
    assert_eq!(code(&told), 1);
    assert!(json(&told)["error"].as_str().unwrap().starts_with("cannot read no/such.json"));
    assert_eq!(code(&patchcord(&["gap", SLIDE, "--check", "--out", "found"])), 2, "a check writes nothing");
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn what_is_missing_is_named_and_written_as_a_patch() {
    let folder = tempfile::tempdir().unwrap();
    let out_folder = folder.path().join("found");
    let stale = out_folder.join("recovered.json");
    std::fs::create_dir(&out_folder).unwrap();
    std::fs::write(&stale, "of an earlier search").unwrap();
    std::fs::write(
        out_folder.join("report.json"),
        r#"{"verdict": "unknown-effect", "recovered": "elsewhere/found/recovered.json"}"#,
    )
    .unwrap();
    let effects = folder.path().join("effects");
    std::fs::create_dir(&effects).unwrap();
    let bias = std::fs::read_to_string("patches/effects/constant-bias.json").unwrap();
    // In records as long as these the setting leaves 0 ... 1.
    let no_setting = bias.replace("0.5 + 0.005 * b / sum", "R / T / 2000");
    let [one, other] = ["T", "R"].map(|name| {
        let reach = if name == "T" { "sample" } else { "record" };
        format!("\"{name}\": {{\"reach\": \"{reach}\", \"range\": [0.9, 1.1], \"start\": [1]}}")
    });
    let from = no_setting.find("\"b\": {").unwrap();
    let to = from + no_setting[from..].find('}').unwrap();
    let no_setting = format!("{}{one}, {other}{}", &no_setting[..from], &no_setting[to + 1..]);
    std::fs::write(effects.join("no-setting.json"), no_setting).unwrap();
    let told = patchcord(&[
        "gap",
        "crates/ident/tests/hidden/saturation/experiment.json",
        "--effects",
        effects.to_str().unwrap(),
        "--out",
        out_folder.to_str().unwrap(),
    ]);
    assert_eq!((code(&told), errors(&told).as_str()), (0, ""));
    let text = out(&told);
    let removed = format!("removed {}, which an earlier search had left\n", stale.display());
    assert!(text.contains(&removed) && !stale.exists(), "{text}");
    assert!(text.lines().next().unwrap().ends_with("saturation at u is missing"), "{text}");
    let untried = "no-setting at I1 is not tried: error[setting-outside]: ";
    assert!(text.contains(untried), "{text}");
    let augmented = out_folder.join("augmented.json");
    let ran = patchcord(&["run", augmented.to_str().unwrap()]);
    assert!(code(&ran) == 0 && out(&ran).contains("no overload"), "{}{}", out(&ran), errors(&ran));
    let fitted = patchcord(&["check", out_folder.join("fitted.json").to_str().unwrap()]);
    assert_eq!(code(&fitted), 0, "{}", errors(&fitted));
    let report = std::fs::read_to_string(out_folder.join("report.json")).unwrap();
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!((&report["verdict"], &report["effects"][0]["name"]), (&"named".into(), &"saturation".into()));
    let keys = std::fs::read_to_string("docs/gap-report.md").unwrap();
    for own in ["", "/effects/0", "/rivals/0", "/rounds/0", "/where/0", "/where/0/records/0", "/other_starts"]
    {
        let told = report.pointer(own).and_then(Value::as_object).unwrap();
        let untold = told.keys().find(|key| !keys.contains(&format!("`{key}`")));
        assert!(untold.is_none(), "docs/gap-report.md does not tell {untold:?} of {own}");
    }
    assert_eq!(report["patch"], Value::from(augmented.display().to_string()));
    let page = std::fs::read_to_string(out_folder.join("report.html")).unwrap();
    let rivals: Vec<&Value> =
        report["rivals"].as_array().unwrap().iter().filter(|rival| rival["step"] == 1).collect();
    let places: std::collections::HashSet<_> =
        rivals.iter().map(|rival| (rival["name"].as_str(), rival["junction"].as_str())).collect();
    let untold = format!("\nand {} more behind these\n", places.len() - 8);
    assert!(text.contains(&untold), "{untold}{text}");
    let rivals = rivals.len();
    // Every effect that was tried stands on the page, and pictures do; and what was not, and what to do about it.
    assert!(page.contains(untried));
    assert_eq!(report["left_out"].as_array().unwrap().len(), 2);
    let solver = &report["solver"];
    assert!(solver["steps"].as_u64().unwrap() >= 1, "{solver}");
    assert!(solver["error"].as_f64().unwrap() < solver["wanted"].as_f64().unwrap(), "{solver}");
    let why = report["left_out"][0]["why"].as_str().unwrap();
    assert!(why.contains("help: "), "{why}");
    assert!(page.contains("<p class=\"verdict\">saturation at u is missing</p>"));
    assert!(page.contains("<p>The solver takes "), "how finely it stepped");
    assert!(page.contains("<p>The patch has no place for "), "what was not tried at all");
    let tried = format!(" effects tried in {rivals} ways</h2>");
    assert!(page.contains("<h2>Round 1: ") && page.contains(&tried), "{tried}");
    let best = &report["where"][0];
    let curves = best["curves"].as_array().unwrap();
    let is_over_time = best["best_against"] == "time";
    let told_apart = page.matches("<tr").count() - page.matches("<tr>").count();
    let more_than_chance = |own: &&Value| {
        let strength = |of: &str| own[of]["correlation"].as_f64().unwrap().abs();
        strength("itself").max(strength("size")) > own["chance"].as_f64().unwrap()
    };
    let correlated = report["correlations"].as_array().unwrap().iter().filter(more_than_chance).count();
    assert_eq!(
        told_apart,
        3 - usize::from(is_over_time) + correlated,
        "the best effect, the best junction, the best curve, what the residuals go with"
    );
    let rounds = report["rounds"].as_array().unwrap();
    assert_eq!(
        (rounds.len(), &rounds[0]["best"], &rounds[0]["taken"]),
        (1, &"saturation".into(), &true.into())
    );
    let white = |when: &str| report["gap"][when]["from_white"].as_f64().unwrap();
    assert!(white("before") > 4.0 && white("after") < 4.0);
    let pictures = 8 + best["records"].as_array().unwrap().len() + curves.len();
    assert_eq!(page.matches("<svg class=\"picture\"").count(), pictures);
    assert!(!page.contains("NaN"));
    let told = format!("the gap is best explained at {}", best["junction"].as_str().unwrap());
    assert!(text.contains(&told) && text.contains(best["best_against"].as_str().unwrap()), "{text}");
    // What has a name needs no curve.
    assert!(!stale.exists() && report["recovered"].is_null());
}

#[test]
fn nothing_that_no_search_has_left_is_written_over() {
    let report = r#"{"verdict": "nothing-missing", "patch": "fitted.json"}"#;
    for (name, beside) in [
        ("report.html", None),
        ("augmented.json", None),
        ("augmented.json", Some(report)),
        ("recovered.json", Some(report)),
        ("separate.csv", Some(report)),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let own = folder.path().join(name);
        std::fs::write(&own, "mine").unwrap();
        beside.into_iter().for_each(|text| std::fs::write(folder.path().join("report.json"), text).unwrap());
        let told = patchcord(&["gap", SLIDE, "--out", folder.path().to_str().unwrap()]);
        let said = format!("{name} is there already, and no search has left it");
        assert!(code(&told) == 2 && errors(&told).contains(&said), "{}", errors(&told));
        assert_eq!(std::fs::read_to_string(&own).unwrap(), "mine");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1 + beside.iter().count());
    }
}

#[test]
fn nothing_of_the_experiment_is_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for (from, to) in [("slide.csv", "slide.csv"), ("base.json", "augmented.json")] {
        std::fs::copy(format!("crates/ident/tests/{from}"), at(to)).unwrap();
    }
    let experiment = std::fs::read_to_string(SLIDE).unwrap().replace("base.json", "augmented.json");
    std::fs::write(at("report.json"), &experiment).unwrap();
    std::fs::write(at("slide.json"), &experiment).unwrap();
    let refused = |file: &str, what: &str| {
        let told = patchcord(&["gap", at(file).to_str().unwrap(), "--out", folder.path().to_str().unwrap()]);
        assert!(code(&told) == 2 && errors(&told).contains(what), "{}", errors(&told));
    };
    refused("report.json", "report.json is the experiment itself");
    refused("slide.json", "augmented.json is the patch itself");
    assert_eq!(std::fs::read_to_string(at("report.json")).unwrap(), experiment);
    // What an earlier search left to be measured may have been.
    let measured = std::fs::read(at("slide.csv")).unwrap();
    std::fs::write(at("separate.csv"), &measured).unwrap();
    std::fs::copy("crates/ident/tests/base.json", at("base.json")).unwrap();
    let again = experiment.replace("augmented.json", "base.json").replace("slide.csv", "separate.csv");
    std::fs::write(at("again.json"), again).unwrap();
    refused("again.json", "separate.csv is a record itself");
    assert_eq!(std::fs::read(at("separate.csv")).unwrap(), measured);
    let table = r#""points": {"csv": "separate.csv", "x": "t", "y": "force"}"#;
    let patch = std::fs::read_to_string("crates/ident/tests/base.json").unwrap();
    let own = r#""kind": "step", "scale": "force", "height": "gear * F_step""#;
    assert!(patch.contains(own));
    std::fs::write(
        at("base.json"),
        patch.replace(own, &format!(r#""kind": "table", "scale": "force", {table}"#)),
    )
    .unwrap();
    std::fs::write(at("again.json"), experiment.replace("augmented.json", "base.json")).unwrap();
    refused("again.json", "separate.csv is a table of the patch itself");
    let [out, effects] = [folder.path(), &at("../").join(folder.path().file_name().unwrap())];
    let [out, effects] = [out, effects].map(|path| path.to_str().unwrap());
    let told = patchcord(&["gap", SLIDE, "--effects", effects, "--out", out]);
    assert!(errors(&told).contains(" is the folder of effects itself"), "{}", errors(&told));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn where_nothing_is_missing_what_would_have_shown_is_a_table() {
    let told = patchcord(&["gap", "crates/ident/tests/hidden/nothing/experiment.json"]);
    assert_eq!((code(&told), errors(&told).as_str()), (0, ""));
    let text = out(&told);
    let first = text.lines().next().unwrap();
    assert!(first.contains("nothing is missing that these data would show; the weakest "), "{first}");
    let table =
        text.split("what these data would have shown, every effect where it shows best of all places and values that were tried\n\n").nth(1).unwrap();
    let rows: Vec<&str> = table.lines().skip(1).take_while(|line| !line.is_empty()).collect();
    let friction = rows.iter().find(|row| row.starts_with("coulomb-friction ")).unwrap();
    assert!(friction.contains(" IV ") && friction.contains(" Fc ") && friction.ends_with(" N"), "{friction}");
    let names: Vec<&str> = rows.iter().filter_map(|row| row.split(' ').next()).collect();
    let once: std::collections::HashSet<_> = names.iter().collect();
    assert!(names.len() > 15 && once.len() == names.len(), "{names:?}");
}

#[test]
fn a_seed_that_is_none_is_told_what_is_wanted() {
    for given in ["-1", "abc", "1.5", "18446744073709551616"] {
        let told = patchcord(&["gap", "crates/ident/tests/slide.json", "--seed", given]);
        assert_eq!((code(&told), out(&told).as_str()), (2, ""));
        let wanted = "a whole number from 0 to 18446744073709551615 is wanted";
        assert!(errors(&told).contains(wanted), "{}", errors(&told));
    }
}
