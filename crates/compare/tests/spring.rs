//! A mass on a spring, released at 50 mm: the whole way from the data to the missing friction.
//!
//! The mass is 1 kg and the simulated spring has no friction, so the position is 50 mm cos(sqrt(k) t). The data are those
//! of k = 16 N/m with friction, and of noise of 0.5 mm.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use patchcord_compare::{Comparison, ComparisonOptions};
use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Patch;
use patchcord_ident::{Experiment, GivenFiles};
use serde_json::{Value, json};

use crate::files::{
    begin, compared, comparison, event, events, example, numbers, refusal, request, rms, turn,
};

/// The patch and the data.
fn files() -> (String, String) {
    (example("spring.json"), example("measured.csv"))
}

/// A comparison that fits k, with the events of its beginning.
fn spring() -> (Comparison, Vec<Value>) {
    let (patch, data) = files();
    compared(&patch, &data, &json!({"fit": ["k"]}))
}

/// The times and the positions of the data, in s and mm.
fn samples() -> Vec<[f64; 2]> {
    let data = example("measured.csv");
    let rows = data.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()));
    let row = |line: &str| {
        let (time, position) = line.split_once(',').unwrap();
        [time, position].map(|number| number.parse().unwrap())
    };
    rows.map(row).collect()
}

/// The position without friction, in mm.
fn closed(stiffness: f64, time: f64) -> f64 {
    50.0 * (stiffness.sqrt() * time).cos()
}

/// The root mean square of the difference between the data and the closed solution, in mm.
fn closed_rms(stiffness: f64) -> f64 {
    let differences = samples().into_iter().map(|[time, position]| position - closed(stiffness, time));
    rms(&differences.collect::<Vec<_>>())
}

/// The only output of an event with curves.
fn output(curves: &Value) -> &Value {
    assert_eq!((&curves["event"], &curves["overload"]), (&json!("curves"), &Value::Null), "{curves}");
    &curves["outputs"][0]
}

#[test]
fn the_columns_have_a_suggested_experiment() {
    let (patch, data) = files();
    let columns = event(&mut comparison(), &begin(&patch, &data));
    assert_eq!((&columns["file"], &columns["rows"]), (&json!("measured.csv"), &json!(401)));
    assert_eq!(columns["columns"][0], json!({"name": "t", "unit": "s", "least": 0.0, "most": 8.0}));
    assert_eq!((&columns["columns"][1]["name"], &columns["columns"][1]["unit"]), (&json!("x"), &json!("mm")));
    assert_eq!(columns["signals"], json!([{"name": "x", "unit": "mm"}, {"name": "v", "unit": "mm/s"}]));
    assert_eq!((&columns["drives"], &columns["notes"]), (&json!([]), &json!([])));
    let stiffness = json!({"name": "k", "unit": "N/m", "value": 40.0, "low": 1.0, "high": 100.0});
    assert_eq!(columns["parameters"][0], stiffness);
    let experiment = json!({"time": "t", "outputs": {"x": "x"}, "fit": ["k", "m"]});
    assert_eq!(columns["experiment"], experiment);
}

#[test]
fn the_curves_are_the_data_and_the_closed_solution() {
    let (_, events) = spring();
    assert_eq!((events.len(), &events[0]["event"]), (2, &json!("comparison")), "{events:?}");
    assert_eq!(events[0]["warnings"], json!([]));
    let output = output(&events[1]);
    assert_eq!(
        (&output["signal"], &output["unit"], &output["offset"]),
        (&json!("x"), &json!("mm"), &Value::Null)
    );
    let [first, second] = [0, 1].map(|record| output["records"][record]["test"].as_bool().unwrap());
    assert!(!first && second);
    let [time, measured, simulated, residual] =
        ["time", "measured", "simulated", "residual"].map(|key| numbers(output, key));
    let samples = samples();
    assert_eq!(time.len(), samples.len());
    for (index, [expected_time, expected]) in samples.into_iter().enumerate() {
        assert!((time[index] - expected_time).abs() < 1e-9, "{index}");
        assert!((measured[index] - expected).abs() < 1e-3, "{index}: the digits of a curve");
        // A tenth of the noise. The validation data continue the run of the training data.
        assert!((simulated[index] - closed(40.0, expected_time)).abs() < 0.06, "{index}");
        assert!((residual[index] - (measured[index] - simulated[index])).abs() < 2e-3, "{index}");
    }
    assert!((output["rms"].as_f64().unwrap() - closed_rms(40.0)).abs() < 0.02, "{}", output["rms"]);
    assert!((0.35..0.7).contains(&output["noise"].as_f64().unwrap()), "{}", output["noise"]);
}

#[test]
fn the_residual_follows_the_knob() {
    let (mut comparison, _) = spring();
    for stiffness in [25.0, 20.0, 16.0, 40.0] {
        let curves = event(&mut comparison, &turn("k", stiffness));
        let shown = output(&curves)["rms"].as_f64().unwrap();
        assert!((shown - closed_rms(stiffness)).abs() < 0.02, "{stiffness}: {shown}");
    }
    // Other parameters keep their values: k = 40 N/m and 2.5 kg move as k = 16 N/m and 1 kg.
    let curves = event(&mut comparison, &turn("m", 2.5));
    assert!((output(&curves)["rms"].as_f64().unwrap() - closed_rms(16.0)).abs() < 0.02);
}

#[test]
fn the_fit_begins_at_the_present_values_and_sets_the_best_ones() {
    let (mut comparison, begun) = spring();
    let before = output(&begun[1])["rms"].as_f64().unwrap();
    let fitted = events(&mut comparison, &json!({"command": "fit"}));
    let stiffness = fitted[0]["parameters"]["k"].as_f64().unwrap();
    assert_eq!((fitted[0]["event"].as_str(), fitted.len()), (Some("fitted"), 2), "{fitted:?}");
    // The least squares of a cosine of any amplitude and phase.
    assert!((stiffness - 16.216).abs() < 0.05, "{stiffness}");
    let after = output(&fitted[1])["rms"].as_f64().unwrap();
    assert!((after - closed_rms(stiffness)).abs() < 0.02 && after < before - 5.0, "{before} {after}");
    // The mass is not fitted. With 4 times the mass the stiffness is 4 times as large.
    event(&mut comparison, &turn("m", 4.0));
    let fitted = events(&mut comparison, &json!({"command": "fit"}));
    let heavier = fitted[0]["parameters"]["k"].as_f64().unwrap();
    assert!((heavier / stiffness - 4.0).abs() < 0.02, "{heavier}");
}

/// The experiment of a comparison, read as `patchcord gap` does.
#[test]
fn the_saved_experiment_is_the_same() {
    let (patch_text, data) = files();
    let (_, events) = spring();
    let text = events[0]["experiment"].as_str().unwrap();
    let first = [
        r#"  "title": "Mass on a spring, compared with measured.csv","#,
        r#"  "patch": "p.json","#,
        r#"  "data": "measured.csv","#,
    ];
    assert_eq!(text.lines().skip(1).take(3).collect::<Vec<_>>(), first, "{text}");
    let patch = Patch::parse("p.json", &patch_text).unwrap();
    let files = GivenFiles { patch: &patch, data: &[("measured.csv", data.as_str())] };
    let experiment = Experiment::parse_given(&files, "e.json", text).unwrap();
    assert_eq!(
        (experiment.fit.as_slice(), experiment.outputs[0].signal.as_str()),
        (["k".to_owned()].as_slice(), "x")
    );
}

#[test]
fn the_search_finds_the_friction_and_rejects_the_other_effects() {
    let search = request(&[json!({"command": "search", "seed": 1})]);
    let (mut comparison, _) = spring();
    let mut partial: Vec<Value> = Vec::new();
    let last =
        comparison.request(&search, &mut |text: &str| partial.push(serde_json::from_str(text).unwrap()));
    let response: Value = serde_json::from_str(&last).unwrap();
    let found = &response["events"][0];

    assert_eq!((&found["event"], &found["verdict"]), (&json!("found"), &json!("named")), "{found}");
    assert_eq!(found["sentence"], "viscous-friction at A1 is missing");
    assert!(found["before"].as_f64().unwrap() > 10.0 && (found["after"].as_f64().unwrap() - 1.0).abs() < 0.1);
    let [stiffness, friction] = [0, 1].map(|index| &found["parameters"][index]);
    assert_eq!((&stiffness["name"], &stiffness["of"]), (&json!("k"), &json!("the patch")));
    assert_eq!((&friction["unit"], &friction["of"]), (&json!("1/s"), &json!("viscous-friction at A1")));
    let [value, low, high] = ["value", "low", "high"].map(|key| stiffness[key].as_f64().unwrap());
    assert!((value - 16.0).abs() < 0.05 && low < value && value < high, "{stiffness}");
    let report = found["report"].as_str().unwrap();
    assert!(report.contains("<h1>Mass on a spring, compared with measured.csv</h1>"));
    assert!(report.contains("viscous-friction") && report.contains("fitted.json") && !report.contains("<a "));

    let before = Patch::parse("p.json", &example("spring.json")).unwrap();
    let after = Patch::parse("p.json", found["patch"]["text"].as_str().unwrap()).unwrap();
    assert!(Circuit::new(&after).is_ok());
    let added: Vec<&str> = after
        .elements
        .keys()
        .map(String::as_str)
        .filter(|name| !before.elements.contains_key(*name))
        .collect();
    assert!(!added.is_empty());
    assert_eq!(found["patch"]["elements"], json!(added));
    let fitted = Patch::parse("p.json", found["fitted"].as_str().unwrap()).unwrap();
    assert!(fitted.elements.len() == before.elements.len() && fitted.parameters["k"].value < 17.0);

    let progress: Vec<&Value> = partial.iter().map(|response| &response["events"][0]).collect();
    assert!(partial.iter().all(|response| response["partial"] == true && response["id"] == 7));
    assert!(progress.iter().all(|event| event["event"] == "progress") && progress.len() < 500);
    assert_eq!(progress[0]["phase"], "fitting the patch");
    let rejected: Vec<&str> = progress
        .iter()
        .flat_map(|event| event["rejected"].as_array().unwrap())
        .map(|candidate| candidate["effect"].as_str().unwrap())
        .collect();
    assert!(
        rejected.contains(&"coulomb-friction at A1") && rejected.contains(&"quadratic-drag at A1"),
        "{rejected:?}"
    );

    // The same request gives the same response.
    assert_eq!(comparison.request(&search, &mut |_: &str| ()), last);
}

#[test]
fn a_fit_and_a_search_can_be_cancelled() {
    let cancel = Arc::new(AtomicBool::new(false));
    let options =
        ComparisonOptions { threads: Some(2), cancel: Arc::clone(&cancel), ..ComparisonOptions::default() };
    let mut comparison = Comparison::new(options);
    let (patch, data) = files();
    let experiment = json!({"outputs": {"x": "x"}, "fit": ["k"]});
    let commands = [
        begin(&patch, &data),
        json!({"command": "compare", "experiment": experiment}),
        json!({"command": "search"}),
    ];
    let text = comparison.request(&request(&commands), &mut |_: &str| cancel.store(true, Ordering::Relaxed));
    let response: Value = serde_json::from_str(&text).unwrap();
    let names: Vec<&str> =
        response["events"].as_array().unwrap().iter().map(|event| event["event"].as_str().unwrap()).collect();
    assert_eq!(names, ["columns", "comparison", "curves", "refused"]);
    assert_eq!(response["events"][3]["message"], "cancelled");
    // The flag still stands, so a fit does not begin. It changes no value.
    let before = event(&mut comparison, &turn("k", 25.0));
    assert_eq!(refusal(&mut comparison, &json!({"command": "fit"})), "cancelled");
    let nothing = json!({"command": "simulate", "parameters": {}});
    assert_eq!(event(&mut comparison, &nothing), before);
}
