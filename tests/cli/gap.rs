//! `patchcord gap`

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{code, errors, json, out, patchcord, patchcord_with_progress};
use crate::common::files::assert_up_to_date;

const SLIDE: &str = "examples/05_missing_effect/slide.experiment.json";
/// The patch of [`SLIDE`].
const SLIDE_PATCH: &str = "examples/05_missing_effect/slide.json";

#[test]
fn the_check_prints_a_table_per_record() {
    let output = patchcord(&["gap", SLIDE, "--check"]);
    assert_eq!((code(&output), errors(&output).as_str()), (0, ""));
    let text = out(&output);
    for part in [
        "examples/05_missing_effect/slide.experiment.json: nothing wrong\nA table that a motor pushes\n",
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
    assert!(text.contains("to be tried at F: actuator-lag, backlash, "), "{text}");
    assert!(text.contains("The patch has no place for leak, load-dependent-friction, overflow.\n"), "{text}");
    let friction = text.lines().find(|line| line.starts_with("coulomb-friction")).unwrap();
    assert!(friction.contains("A1  Fc ") && friction.ends_with(" N"), "{friction}");
}

/// An effect that the patch already has is not detectable with any data.
#[test]
fn the_check_reports_the_weakest_detectable_strength() {
    let output = json(&patchcord(&["gap", SLIDE, "--check", "--json", "--threads", "1"]));
    let limits = output["limits"].as_array().unwrap();
    let limit_of = |name: &str| limits.iter().find(|limit| limit["name"] == name).unwrap();
    let [friction, viscous] = ["coulomb-friction", "viscous-friction"].map(limit_of);
    assert_eq!((&friction["seen"], &friction["unit"]), (&Value::Bool(true), &"N".into()));
    // A force of 3 N moves the table; readings to 0.2 mm resolve a hundredth of it.
    assert!(friction["value"].as_f64().unwrap() < 0.03, "{friction}");
    // Below the end of its range, the fitted f of the patch compensates for it.
    assert!(viscous["value"].as_f64().unwrap() > 1.0, "{viscous}");
    assert!(output["leaves"].as_f64().unwrap() > 100.0, "{}", output["leaves"]);
    assert_eq!(output["left_out"], serde_json::json!([]));
    let again = json(&patchcord(&["gap", SLIDE, "--check", "--json", "--threads", "2"]));
    assert_eq!(again["limits"], output["limits"], "independent of the number of threads");
}

#[test]
fn the_check_reports_undetectable_effects() {
    let folder = tempfile::tempdir().unwrap();
    let here = std::env::current_dir().unwrap().display().to_string();
    let [patch, data] =
        ["slide.json", "slide.csv"].map(|file| format!("\"{here}/examples/05_missing_effect/{file}\""));
    let arguments = std::fs::read_to_string(SLIDE).unwrap();
    let arguments = arguments.replace("\"slide.json\"", &patch).replace("\"slide.csv\"", &data);
    let noisy = folder.path().join("noisy.json");
    std::fs::write(&noisy, arguments.replace("\"sigma\": 0.2,", "\"sigma\": 300,")).unwrap();
    let output = patchcord(&["gap", noisy.to_str().unwrap(), "--check"]);
    assert_eq!((code(&output), errors(&output).as_str()), (0, ""));
    let undetectable = "Not detectable at any strength in its range: saturation at F; needs: a drive with \
                        commands below and above L.\n";
    assert!(out(&output).contains(undetectable), "{}", out(&output));
}

#[test]
fn effects_of_a_folder_are_checked_with_the_data() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["gap", SLIDE, "--check", "--effects", folder.path().to_str().unwrap()];
    let effect = std::fs::read_to_string("patches/effects/saturation.json").unwrap();
    std::fs::write(folder.path().join("weak-motor.json"), &effect).unwrap();
    assert!(out(&patchcord(&arguments)).contains("time-delay, weak-motor\n"));
    std::fs::write(folder.path().join("weak-motor.json"), effect.replace("\"drive\"", "\"drove\"")).unwrap();
    let output = patchcord(&arguments);
    assert_eq!((code(&output), out(&output).as_str()), (1, ""));
    assert!(errors(&output).contains("weak-motor.json:"), "{}", errors(&output));
    std::fs::write(folder.path().join("weaker.json"), "{").unwrap();
    let both = json(&patchcord(&[&arguments[..], &["--json"]].concat()));
    let files =
        both["diagnostics"].as_array().unwrap().iter().map(|diagnostic| diagnostic["file"].as_str().unwrap());
    let files: std::collections::BTreeSet<&str> =
        files.map(|file| file.rsplit('/').next().unwrap()).collect();
    let expected = ["weak-motor.json", "weaker.json"].into();
    assert_eq!((both["ok"].as_bool(), files), (Some(false), expected));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn the_page_shows_the_output() {
    let page = std::fs::read_to_string("docs/gap.md").unwrap();
    let mut parts = page.split("```text\n");
    let mut fresh = parts.next().unwrap().to_owned();
    for part in parts {
        let (shown, rest) = part.split_once("```").unwrap();
        let command = shown.lines().next().and_then(|line| line.strip_prefix("$ patchcord "));
        let output = match command {
            Some(command) => {
                let arguments: Vec<_> = command.split(' ').collect();
                format!("$ patchcord {command}\n{}", out(&patchcord(&arguments)))
            }
            None => out(&patchcord(&["gap", SLIDE, "--check"])),
        };
        fresh += &format!("```text\n{output}```{rest}");
    }
    assert_up_to_date("docs/gap.md", fresh.as_bytes(), "patchcord");
}

#[test]
fn the_document_has_the_data_of_the_table() {
    let output = json(&patchcord(&["gap", SLIDE, "--check", "--json"]));
    assert_eq!(
        (&output["ok"], &output["fit"][0], output["diagnostics"].as_array().unwrap().len()),
        (&Value::Bool(true), &"M".into(), 0)
    );
    let train = &output["records"][0];
    assert_eq!(
        (&train["part"], &train["samples"], &train["missing"]),
        (&"train".into(), &251.into(), &0.into())
    );
    let [force, position] = [0, 1].map(|index| &train["columns"][index]);
    assert_eq!(
        (&force["drive"], &position["signal"], &position["unit"]),
        (&"F".into(), &"x".into(), &"m".into())
    );
    let near = |value: &Value, expected: f64| (value.as_f64().unwrap() / expected - 1.0).abs();
    assert!(near(&position["noise"]["sigma"], 2e-4) < 0.12, "{position}");
    assert!(near(&position["step"], 1e-5) < 1e-6, "{position}");
    assert_eq!(position["power_below"].as_array().unwrap().len(), 3);
    assert_eq!(output["effects"][0], serde_json::json!({"name": "actuator-lag", "junctions": ["F"]}));
    assert_eq!(output["nameless"], serde_json::json!([]));
    assert_eq!(output["nowhere"], serde_json::json!(["leak", "load-dependent-friction", "overflow"]));
}

#[test]
fn a_wrong_experiment_is_reported_with_its_place() {
    let bad = "crates/ident/tests/bad/constant-column-output.json";
    let output = patchcord(&["gap", bad, "--check"]);
    assert_eq!((code(&output), out(&output).as_str()), (1, ""));
    assert!(errors(&output).contains(&format!("{bad}:4:20")), "{}", errors(&output));
    assert!(errors(&output).ends_with(&format!("\n{bad}: 1 error\n")), "{}", errors(&output));
    let document = json(&patchcord(&["gap", bad, "--check", "--json"]));
    assert_eq!((&document["ok"], &document["experiment"]), (&Value::Bool(false), &bad.into()));
    assert_eq!(document["diagnostics"][0]["code"], "constant-column");
}

#[test]
fn errors_of_the_patch_follow_those_of_the_experiment() {
    let output = patchcord(&["gap", "crates/ident/tests/bad/bad-patch-wrong.json", "--check", "--json"]);
    assert_eq!(code(&output), 1);
    let document = json(&output);
    let codes = [0, 1].map(|index| document["diagnostics"][index]["code"].as_str().unwrap());
    assert_eq!(codes, ["bad-patch", "unknown-kind"]);
    assert!(errors(&output).contains("did you mean \"summer\"?"), "{}", errors(&output));
}

#[test]
fn warnings_do_not_stop_the_check() {
    let output = patchcord(&["gap", "crates/ident/tests/bad/sampling-gap.json", "--check"]);
    assert_eq!(code(&output), 0);
    assert!(errors(&output).starts_with("warning[sampling-gap]"), "{}", errors(&output));
    assert!(
        out(&output).contains("no errors, 1 warning") && out(&output).contains("of them missing"),
        "{}",
        out(&output)
    );
}

#[test]
fn a_missing_file_is_reported() {
    let output = patchcord(&["gap", "no/such.json", "--check", "--json"]);
    assert_eq!(code(&output), 1);
    assert!(json(&output)["error"].as_str().unwrap().starts_with("cannot read no/such.json"));
    assert_eq!(code(&patchcord(&["gap", SLIDE, "--check", "--out", "found"])), 2, "a check writes nothing");
}

/// The beginning of the line on an effect that the search below does not try.
const UNTRIED: &str = "no-setting at I1 is not tried: error[setting-outside]: ";

/// The results of a search in the data of a machine whose drive u saturates.
struct SaturationSearch {
    /// The folder with the files of the search.
    folder: PathBuf,
    /// The printed text.
    text: String,
    /// The document report.json.
    report: Value,
    /// The page report.html.
    page: String,
}

impl SaturationSearch {
    /// Searches with the effects of one folder and reads the files that are written into the other.
    fn run(effects: &Path, folder: PathBuf) -> Self {
        let arguments = [
            "gap",
            "crates/ident/tests/hidden/saturation/experiment.json",
            "--effects",
            effects.to_str().unwrap(),
            "--out",
            folder.to_str().unwrap(),
        ];
        let output = patchcord_with_progress("0.005", &arguments);
        assert_eq!(code(&output), 0, "{}", errors(&output));
        check_progress(&errors(&output));
        let report = std::fs::read_to_string(folder.join("report.json")).unwrap();
        let report = serde_json::from_str(&report).unwrap();
        let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
        SaturationSearch { folder, text: out(&output), report, page }
    }

    /// The rivals of the first step in the report.
    fn first_rivals(&self) -> Vec<&Value> {
        let rivals = self.report["rivals"].as_array().unwrap();
        rivals.iter().filter(|rival| rival["step"] == 1).collect()
    }
}

/// Asserts that the progress is printed. Which phases it reports depends on the speed of the machine.
fn check_progress(lines: &str) {
    assert!(!lines.is_empty() && lines.lines().all(|line| line.starts_with("gap: ")), "{lines}");
}

/// The effect constant-bias with another setting. With records as long as those of the search it is outside 0 ... 1.
fn effect_with_a_setting_outside() -> String {
    let bias = std::fs::read_to_string("patches/effects/constant-bias.json").unwrap();
    let no_setting = bias.replace("0.5 + 0.005 * b / sum", "R / T / 2000");
    let [one, other] = ["T", "R"].map(|name| {
        let reach = if name == "T" { "sample" } else { "record" };
        format!("\"{name}\": {{\"reach\": \"{reach}\", \"range\": [0.9, 1.1], \"start\": [1]}}")
    });
    let from = no_setting.find("\"b\": {").unwrap();
    let to = from + no_setting[from..].find('}').unwrap();
    format!("{}{one}, {other}{}", &no_setting[..from], &no_setting[to + 1..])
}

/// Writes the report of an earlier search into a folder, and the patch that the report names. Returns the path of the
/// patch.
fn write_earlier_search(folder: &Path) -> PathBuf {
    let stale = folder.join("recovered.json");
    std::fs::write(&stale, "of an earlier search").unwrap();
    std::fs::write(
        folder.join("report.json"),
        r#"{"verdict": "unknown-effect", "recovered": "elsewhere/found/recovered.json"}"#,
    )
    .unwrap();
    stale
}

/// Asserts that the printed text has the verdict, the files, the effects and the place.
fn check_text(search: &SaturationSearch, stale: &Path) {
    let text = &search.text;
    let removed = format!("removed {}, written by an earlier search\n", stale.display());
    assert!(text.contains(&removed) && !stale.exists(), "{text}");
    assert!(text.lines().next().unwrap().ends_with("saturation at u is missing"), "{text}");
    assert!(text.contains(UNTRIED), "{text}");
    let rivals = search.first_rivals();
    let places: HashSet<_> =
        rivals.iter().map(|rival| (rival["name"].as_str(), rival["junction"].as_str())).collect();
    let omitted = format!("\nand {} more\n", places.len() - 8);
    assert!(text.contains(&omitted), "{omitted}{text}");
    let best = &search.report["where"][0];
    let output = format!("the gap is best explained at {}", best["junction"].as_str().unwrap());
    assert!(text.contains(&output) && text.contains(best["best_against"].as_str().unwrap()), "{text}");
}

/// Asserts that the patch with the effect runs, that the patch with fitted parameters is valid, and that the report
/// names the former.
fn check_patches(search: &SaturationSearch) {
    let augmented = search.folder.join("augmented.json");
    let ran = patchcord(&["run", augmented.to_str().unwrap()]);
    assert!(code(&ran) == 0 && out(&ran).contains("no overload"), "{}{}", out(&ran), errors(&ran));
    let fitted = patchcord(&["check", search.folder.join("fitted.json").to_str().unwrap()]);
    assert_eq!(code(&fitted), 0, "{}", errors(&fitted));
    assert_eq!(search.report["patch"], Value::from(augmented.display().to_string()));
}

/// Asserts the verdict and the numbers of a report.
fn check_report(report: &Value) {
    assert_eq!((&report["verdict"], &report["effects"][0]["name"]), (&"named".into(), &"saturation".into()));
    assert_eq!(report["left_out"].as_array().unwrap().len(), 2);
    let why = report["left_out"][0]["why"].as_str().unwrap();
    assert!(why.contains("help: "), "{why}");
    let solver = &report["solver"];
    assert!(solver["steps"].as_u64().unwrap() >= 1, "{solver}");
    assert!(solver["error"].as_f64().unwrap() < solver["wanted"].as_f64().unwrap(), "{solver}");
    let rounds = report["rounds"].as_array().unwrap();
    assert_eq!(
        (rounds.len(), &rounds[0]["best"], &rounds[0]["taken"]),
        (1, &"saturation".into(), &true.into())
    );
    let white = |when: &str| report["gap"][when]["from_white"].as_f64().unwrap();
    assert!(white("before") > 4.0 && white("after") < 4.0);
    // A named effect needs no curve.
    assert!(report["recovered"].is_null());
}

/// Asserts that docs/gap-report.md describes all keys of a report.
fn check_keys(report: &Value) {
    let keys = std::fs::read_to_string("docs/gap-report.md").unwrap();
    for pointer in
        ["", "/effects/0", "/rivals/0", "/rounds/0", "/where/0", "/where/0/records/0", "/other_starts"]
    {
        let output = report.pointer(pointer).and_then(Value::as_object).unwrap();
        let missing = output.keys().find(|key| !keys.contains(&format!("`{key}`")));
        assert!(missing.is_none(), "docs/gap-report.md does not describe {missing:?} of {pointer}");
    }
}

/// Asserts that the page lists every effect that was tried, pictures, and effects that were not tried with advice.
fn check_page(search: &SaturationSearch) {
    let page = &search.page;
    assert!(page.contains(UNTRIED));
    assert!(page.contains("<p class=\"verdict\">saturation at u is missing</p>"));
    assert!(page.contains("<p>The solver takes "), "the step of the solver");
    assert!(page.contains("<p>The patch has no place for "), "effects without a place");
    let tried = format!(" effects tried in {} ways</h2>", search.first_rivals().len());
    assert!(page.contains("<h2>Round 1: ") && page.contains(&tried), "{tried}");
    let best = &search.report["where"][0];
    let [records, curves] = ["records", "curves"].map(|key| best[key].as_array().unwrap().len());
    assert_eq!(page.matches("<svg class=\"picture\"").count(), 8 + records + curves);
    assert!(!page.contains("NaN"));
}

/// Asserts that the page highlights as many rows as the report has best and significant values.
fn check_highlighted_rows(search: &SaturationSearch) {
    let SaturationSearch { report, page, .. } = search;
    let is_over_time = report["where"][0]["best_against"] == "time";
    let highlighted = page.matches("<tr").count() - page.matches("<tr>").count();
    let exceeds_chance = |correlation: &&Value| {
        let strength = |part: &str| correlation[part]["correlation"].as_f64().unwrap().abs();
        strength("itself").max(strength("size")) > correlation["chance"].as_f64().unwrap()
    };
    let correlated = report["correlations"].as_array().unwrap().iter().filter(exceeds_chance).count();
    assert_eq!(
        highlighted,
        3 - usize::from(is_over_time) + correlated,
        "the best effect, junction and curve, and the correlations of the residuals"
    );
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_missing_effect_is_named_and_written_as_a_patch() {
    let folder = tempfile::tempdir().unwrap();
    let [effects, results] = ["effects", "found"].map(|name| folder.path().join(name));
    std::fs::create_dir(&effects).unwrap();
    std::fs::create_dir(&results).unwrap();
    std::fs::write(effects.join("no-setting.json"), effect_with_a_setting_outside()).unwrap();
    let stale = write_earlier_search(&results);
    let search = SaturationSearch::run(&effects, results);
    check_text(&search, &stale);
    check_patches(&search);
    check_report(&search.report);
    check_keys(&search.report);
    check_page(&search);
    check_highlighted_rows(&search);
    assert!(!stale.exists());
}

#[test]
fn only_files_of_an_earlier_search_are_overwritten() {
    let report = r#"{"verdict": "nothing-missing", "patch": "fitted.json"}"#;
    for (name, earlier) in [
        ("report.html", None),
        ("augmented.json", None),
        ("augmented.json", Some(report)),
        ("recovered.json", Some(report)),
        ("separate.csv", Some(report)),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(name);
        std::fs::write(&file, "mine").unwrap();
        earlier.into_iter().for_each(|text| std::fs::write(folder.path().join("report.json"), text).unwrap());
        let output = patchcord(&["gap", SLIDE, "--out", folder.path().to_str().unwrap()]);
        let message = format!("{name} exists and was not written by a search");
        assert!(code(&output) == 2 && errors(&output).contains(&message), "{}", errors(&output));
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1 + earlier.iter().count());
    }
}

#[test]
fn a_marker_names_the_files_of_a_killed_search() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let refused = || {
        let output = patchcord(&["gap", SLIDE, "--out", folder.path().to_str().unwrap()]);
        assert_eq!(code(&output), 2);
        errors(&output)
    };
    write("augmented.json", "of a killed search");
    write("separate.csv", "mine");
    assert!(refused().contains("augmented.json exists and was not written by a search"));
    let head = "# A search is replacing these files. If it was killed, the next search replaces them.\n";
    write(".patchcord-gap-unfinished", &format!("{head}augmented.json\nfitted.json\n"));
    assert!(refused().contains("separate.csv exists and was not written by a search"));
}

/// The limit of 12 or 24 kB permits the patches, but not the report.
#[cfg(unix)]
#[test]
#[ignore = "takes several seconds: two whole searches"]
fn a_killed_search_leaves_no_part_of_its_files_and_does_not_block_the_next() {
    let folder = tempfile::tempdir().unwrap();
    let experiment = "crates/ident/tests/hidden/saturation/experiment.json";
    let names = || {
        let entries = std::fs::read_dir(folder.path()).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect::<Vec<_>>()
    };
    let program = assert_cmd::cargo::cargo_bin("patchcord");
    let killed = std::process::Command::new("sh")
        .args(["-c", "ulimit -f 24; exec \"$0\" gap \"$1\" --out \"$2\""])
        .args([program.as_os_str(), std::ffi::OsStr::new(experiment), folder.path().as_os_str()])
        .output()
        .unwrap();
    assert_eq!(killed.status.code(), None, "{}", errors(&killed));
    assert!(!names().is_empty());
    assert!(names().iter().all(|name| name.starts_with(".patchcord-")), "{:?}", names());
    let output = patchcord(&["gap", experiment, "--out", folder.path().to_str().unwrap()]);
    assert_eq!(code(&output), 0, "{}", errors(&output));
    assert!(names().iter().all(|name| !name.starts_with('.')), "{:?}", names());
    assert!(names().iter().any(|name| name == "report.json"));
}

#[test]
fn files_of_the_experiment_are_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for file in ["slide.csv", "slide.json"] {
        std::fs::copy(format!("examples/05_missing_effect/{file}"), at(file)).unwrap();
    }
    std::fs::copy(SLIDE_PATCH, at("augmented.json")).unwrap();
    let own = std::fs::read_to_string(SLIDE).unwrap();
    let experiment = own.replace("slide.json", "augmented.json");
    std::fs::write(at("report.json"), &own).unwrap();
    std::fs::write(at("slide.experiment.json"), &experiment).unwrap();
    let check = |file: &str, what: &str| {
        let output =
            patchcord(&["gap", at(file).to_str().unwrap(), "--out", folder.path().to_str().unwrap()]);
        assert!(code(&output) == 2 && errors(&output).contains(what), "{}", errors(&output));
    };
    check("report.json", "report.json is the experiment itself");
    check("slide.experiment.json", "augmented.json is the patch itself");
    assert_eq!(std::fs::read_to_string(at("report.json")).unwrap(), own);
    // A drive that an earlier search proposed may be the data of this one.
    let measured = std::fs::read(at("slide.csv")).unwrap();
    std::fs::write(at("separate.csv"), &measured).unwrap();
    std::fs::copy(SLIDE_PATCH, at("base.json")).unwrap();
    let again = experiment.replace("augmented.json", "base.json").replace("slide.csv", "separate.csv");
    std::fs::write(at("again.json"), again).unwrap();
    check("again.json", "separate.csv is a record itself");
    assert_eq!(std::fs::read(at("separate.csv")).unwrap(), measured);
    let table = r#""points": {"csv": "separate.csv", "x": "t", "y": "force"}"#;
    let patch = std::fs::read_to_string(SLIDE_PATCH).unwrap();
    let drive = r#""kind": "step", "scale": "force", "height": "F_step""#;
    assert!(patch.contains(drive));
    std::fs::write(
        at("base.json"),
        patch.replace(drive, &format!(r#""kind": "table", "scale": "force", {table}"#)),
    )
    .unwrap();
    std::fs::write(at("again.json"), experiment.replace("augmented.json", "base.json")).unwrap();
    check("again.json", "separate.csv is a table of the patch itself");
    let [out, effects] = [folder.path(), &at("../").join(folder.path().file_name().unwrap())];
    let [out, effects] = [out, effects].map(|path| path.to_str().unwrap());
    let output = patchcord(&["gap", SLIDE, "--effects", effects, "--out", out]);
    assert!(errors(&output).contains(" is the folder of effects itself"), "{}", errors(&output));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn without_a_missing_effect_the_detection_limits_are_printed() {
    let output = patchcord(&["gap", "crates/ident/tests/hidden/nothing/experiment.json"]);
    assert_eq!((code(&output), errors(&output).as_str()), (0, ""));
    let text = out(&output);
    let first = text.lines().next().unwrap();
    assert!(
        first.contains("no missing effect is detectable in these data; the smallest detectable "),
        "{first}"
    );
    let heading = "weakest effects that these data would have shown, each at the place and values where it \
                   is easiest to detect\n\n";
    let table = text.split(heading).nth(1).unwrap();
    let rows: Vec<&str> = table.lines().skip(1).take_while(|line| !line.is_empty()).collect();
    let friction = rows.iter().find(|row| row.starts_with("coulomb-friction ")).unwrap();
    assert!(friction.contains(" IV ") && friction.contains(" Fc ") && friction.ends_with(" N"), "{friction}");
    let names: Vec<&str> = rows.iter().filter_map(|row| row.split(' ').next()).collect();
    let once: HashSet<_> = names.iter().collect();
    assert!(names.len() > 15 && once.len() == names.len(), "{names:?}");
}

#[test]
fn a_wrong_seed_returns_an_error() {
    for given in ["-1", "abc", "1.5", "18446744073709551616"] {
        let output = patchcord(&["gap", SLIDE, "--seed", given]);
        assert_eq!((code(&output), out(&output).as_str()), (2, ""));
        let expected = "must be an integer from 0 to 18446744073709551615";
        assert!(errors(&output).contains(expected), "{}", errors(&output));
    }
}
