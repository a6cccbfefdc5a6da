//! Shipped patches with wrong scales are rescaled: peaks from 50 to 95 V, the same equations and the same signals. With
//! another time scale, all voltages stay.

use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Diagnostic};
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};
use patchcord_core::solve::{RunSettings, run};
use patchcord_core::trace::Trace;
use patchcord_equations::{RescaleOptions, RescaledOutput, RescaledPatch, compare_equations, rescale_patch};
use serde_json::{Value, json};

/// Largest difference of a signal, as a share of its peak.
const TOLERANCE: f64 = 1e-9;
/// The same for patches with open amplifiers. Their errors depend on the scales.
const OPEN_TOLERANCE: f64 = 1e-5;
/// Largest difference of a peak that was measured again, in volts.
const ROUNDING: f64 = 1e-6;

/// A shipped patch whose scales are multiplied by a factor.
pub(crate) struct Case {
    file: &'static str,
    factor: f64,
    /// The scales that are multiplied; all that are numbers if empty.
    scales: &'static [&'static str],
    /// All outputs that cannot peak from 50 to 95 V.
    exceptions: &'static [&'static str],
}

/// A case in which all scales are multiplied.
pub(crate) const fn case(file: &'static str, factor: f64, exceptions: &'static [&'static str]) -> Case {
    Case { file, factor, scales: &[], exceptions }
}

/// The cases. A factor below 1 causes overloads.
const CASES: &[Case] = &[
    case("lessons/driven-oscillator", 5.0, &[]),
    case("lessons/driven-oscillator", 0.2, &[]),
    case("lessons/mass-and-spring", 2.0, &["M2"]),
    case("lessons/lorenz", 2.0, &[]),
    case("lessons/lorenz", 0.5, &[]),
    case("lessons/mathieu", 5.0, &[]),
    case("lessons/predator-and-prey", 2.0, &[]),
    case("lessons/van-der-pol", 0.2, &["M2"]),
    case("lessons/bouncing-ball", 5.0, &[]),
    case("lessons/projectile", 2.0, &[]),
    case("lessons/relay-thermostat", 5.0, &[]),
    case("lessons/square-root-and-division", 1.0, &[]),
    case("lessons/stick-slip", 5.0, &[]),
    case("lessons/two-phase-oscillator", 5.0, &[]),
    case("measured/emps", 5.0, &[]),
    case("measured/emps-asymmetric", 5.0, &[]),
    case("others/singh", 5.0, &["v_i", "A4"]),
    case("thesis/fig-8-04", 5.0, &["v_i"]),
    case("thesis/fig-8-07", 5.0, &["v_i", "x_i", "A1", "B4"]),
    case("thesis/fig-8-09", 5.0, &["B2"]),
    case("thesis/fig-8-11", 5.0, &["x_i", "B4"]),
    Case {
        file: "thesis/fig-8-16",
        factor: 5.0,
        scales: &["position", "force", "velocity", "acceleration"],
        exceptions: &["x_i", "B4"],
    },
    case("thesis/fig-8-16-lag-last", 2.0, &["x_i", "A6", "B4", "B5", "B2", "X1"]),
];

/// A shipped patch.
pub(crate) fn shipped(file: &str) -> Patch {
    Patch::read(format!("../../patches/{file}.json")).unwrap_or_else(|error| panic!("{error}"))
}

/// The patch of a case.
pub(crate) fn misscaled(case: &Case) -> Patch {
    let patch = shipped(case.file);
    let is_listed = |name: &str| case.scales.is_empty() || case.scales.contains(&name);
    let edits: Vec<Edit> = patch
        .scales
        .keys()
        .filter(|name| is_listed(name))
        .filter_map(|name| {
            let number = patch.value()["scales"][name.as_str()]["per_volt"].as_f64()?;
            Some(Edit::at(["scales", name.as_str(), "per_volt"], json!(number * case.factor)))
        })
        .collect();
    patch.with_edits(patch.file(), &edits).unwrap_or_else(|error| panic!("{error}"))
}

/// The patch with other scales or another time scale.
pub(crate) fn rescaled(patch: &Patch, time: Option<f64>) -> RescaledPatch {
    rescale_patch(patch, &RescaleOptions { time }).unwrap_or_else(|error| panic!("{}: {error}", patch.file()))
}

/// The circuit of a patch, and its program.
pub(crate) fn compiled(patch: &Patch) -> (Circuit, Program) {
    let circuit = Circuit::new(patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    (circuit, program)
}

/// The record of these signals, drives and elements.
fn trace(patch: &Patch, names: &[String]) -> Trace {
    let (circuit, program) = compiled(patch);
    let settings = RunSettings::of(&circuit).unwrap().with_signals(names.iter().cloned());
    run(&program, &settings).unwrap_or_else(|stopped| panic!("{stopped}"))
}

/// The names of the signals and drives of a patch.
pub(crate) fn signals(patch: &Patch) -> Vec<String> {
    patch.signals.keys().chain(patch.drives.keys()).cloned().collect()
}

/// Checks that two patches have the same signals in physical units up to a time.
pub(crate) fn check_same_signals(one: &Patch, other: &Patch, until: f64, tolerance: f64) {
    let names = signals(one);
    let [one, other] = [one, other].map(|patch| trace(patch, &names));
    for name in names {
        let [first, second] = [&one, &other].map(|trace| trace.values(&name).unwrap());
        let peak = first.iter().fold(0.0, |peak: f64, value| peak.max(value.abs()));
        let samples = one.time.iter().zip(first.iter().zip(&second)).filter(|(time, _)| **time <= until);
        for (time, (first, second)) in samples {
            let difference = (first - second).abs();
            assert!(difference <= tolerance * peak, "{name}: {first} and {second} at {time} s");
        }
    }
}

/// Checks that the wiring of a patch solves every equation that it solved before.
fn check_equations(before: &Patch, after: &Patch) {
    let solved = |patch: &Patch| {
        let (circuit, program) = compiled(patch);
        let compared = compare_equations(&circuit, &program).into_iter();
        compared.map(|equation| equation.agreement.is_solved()).collect::<Vec<bool>>()
    };
    assert_eq!(solved(before), solved(after), "{}", before.file());
}

/// Checks that names, order and notes stay.
fn check_same_names(before: &Patch, after: &Patch) {
    let names = |section: &Value| -> Vec<(String, Value)> {
        let entries = section.as_object().into_iter().flatten();
        entries.map(|(name, entry)| (name.clone(), entry["note"].clone())).collect()
    };
    for section in ["scales", "drives", "elements", "signals", "macros", "parameters"] {
        assert_eq!(names(&before.value()[section]), names(&after.value()[section]), "{section}");
    }
    for key in ["title", "note", "equations", "run", "pictures", "time_scale"] {
        assert_eq!(before.value().get(key), after.value().get(key), "{key}");
    }
}

/// The sorted names of the outputs that do not peak from 50 to 95 V.
fn outside_range(rescaled: &RescaledPatch) -> Vec<&str> {
    let outside = rescaled.outputs.iter().filter(|output| !output.is_good());
    let mut names: Vec<&str> = outside.map(|output| output.output.as_str()).collect();
    names.sort_unstable();
    names
}

#[test]
fn shipped_patches_with_wrong_scales_use_the_range_of_their_amplifiers() {
    for case in CASES {
        let (patch, label) = (misscaled(case), format!("{} x {}", case.file, case.factor));
        let rescaled = rescaled(&patch, None);
        let mut exceptions = case.exceptions.to_vec();
        exceptions.sort_unstable();
        assert_eq!(outside_range(&rescaled), exceptions, "{label}: {:?}", rescaled.outputs);
        let is_overload = |output: &&RescaledOutput| output.after > 100.0 + ROUNDING;
        assert_eq!(rescaled.outputs.iter().find(is_overload), None, "{label}");
        check_same_names(&patch, &rescaled.patch);
        check_equations(&patch, &rescaled.patch);
    }
}

#[test]
fn the_signals_stay_in_physical_units() {
    for case in CASES {
        let patch = misscaled(case);
        let rescaled = rescaled(&patch, None);
        let has_open = patch.elements.values().any(|entry| entry.kind.name == "open-amplifier");
        let tolerance = if has_open { OPEN_TOLERANCE } else { TOLERANCE };
        let end = trace(&rescaled.patch, &signals(&patch)).time.last().copied().unwrap();
        assert!(rescaled.compared_states > 0, "{}", case.file);
        // Only the motion of Lorenz amplifies the rounding of numbers.
        let is_lorenz = case.file == "lessons/lorenz";
        let Some(until) = rescaled.agrees_until else {
            // The patch overloads, so the shipped one, which does not, is compared.
            assert!(case.factor < 1.0, "{}", case.file);
            let until = if is_lorenz { 0.1 * end } else { end };
            check_same_signals(&shipped(case.file), &rescaled.patch, until, tolerance);
            continue;
        };
        assert!(until >= end || is_lorenz, "{}: {until} s of {end} s", case.file);
        assert!(until > 0.3 * end, "{}: {until} s of {end} s", case.file);
        check_same_signals(&patch, &rescaled.patch, until, tolerance);
    }
}

/// An exact comparison of the patches would need an amplification above 1e9.
#[test]
fn open_amplifiers_may_have_the_largest_amplification() {
    let names = ["A2", "A3", "A4"];
    let lesson = shipped("lessons/square-root-and-division");
    let edits = names.map(|name| Edit::at(["elements", name, "amplification"], json!(1e9)));
    let patch = lesson.with_edits(lesson.file(), &edits).unwrap_or_else(|error| panic!("{error}"));
    let rescaled = rescaled(&patch, None);
    assert!(!rescaled.changes.is_empty());
    for name in names {
        let element = &rescaled.patch.value()["elements"][name];
        assert_eq!(element["amplification"].as_f64(), Some(1e9), "{name}");
    }
    check_equations(&patch, &rescaled.patch);
    check_same_signals(&patch, &rescaled.patch, rescaled.agrees_until.unwrap(), OPEN_TOLERANCE);
}

#[test]
fn a_patch_with_good_scales_stays_as_it_is() {
    let patch = misscaled(&CASES[0]);
    let once = rescaled(&patch, None);
    let again = rescaled(&once.patch, None);
    assert_eq!((again.patch.text(), again.changes.len(), again.runs), (once.patch.text(), 0, 1));
}

#[test]
fn formulas_of_scales_stay_formulas() {
    let patch = misscaled(&CASES[0]);
    let rescaled = rescaled(&patch, None);
    // Only the scales change: all settings are formulas of them.
    assert!(rescaled.changes.iter().all(|change| change.setting == "per_volt"), "{:?}", rescaled.changes);
    assert_eq!(rescaled.patch.value()["elements"], patch.value()["elements"]);
}

#[test]
fn the_instances_of_a_macro_change_together() {
    let patch = misscaled(&case("lessons/heat-rod", 5.0, &[]));
    let rescaled = rescaled(&patch, None);
    assert_eq!(outside_range(&rescaled), ["B7"], "{:?}", rescaled.outputs);
    check_same_names(&patch, &rescaled.patch);
    check_equations(&patch, &rescaled.patch);
}

/// Patches for other time scales, each with a factor.
const TIMES: &[(&str, f64)] = &[
    ("lessons/mass-and-spring", 10.0),
    ("lessons/mass-and-spring", 0.1),
    ("lessons/mass-and-spring", 3.0),
    ("lessons/driven-oscillator", 10.0),
    ("lessons/driven-oscillator", 0.1),
    ("lessons/driven-oscillator", 3.0),
    ("lessons/lorenz", 10.0),
    ("lessons/lorenz", 0.1),
    ("lessons/van-der-pol", 10.0),
    ("lessons/van-der-pol", 0.1),
    ("lessons/bouncing-ball", 10.0),
    ("lessons/bouncing-ball", 0.1),
    ("lessons/stick-slip", 10.0),
    ("lessons/stick-slip", 0.1),
    ("lessons/heat-rod", 10.0),
    ("lessons/relay-thermostat", 10.0),
    ("thesis/fig-8-04", 10.0),
    ("thesis/fig-8-17", 10.0),
    ("thesis/fig-8-17", 3.0),
];

#[test]
fn another_time_scale_keeps_all_voltages_and_scales() {
    for (file, time) in TIMES {
        let patch = shipped(file);
        let rescaled = rescaled(&patch, Some(*time));
        let label = format!("{file} x {time}");
        assert_eq!(rescaled.patch.value()["scales"], patch.value()["scales"], "{label}");
        let expected = patch.time_scale * time;
        assert!((rescaled.time_scale / expected - 1.0).abs() < 1e-12, "{label}: {}", rescaled.time_scale);
        check_equations(&patch, &rescaled.patch);
        let warnings = compiled(&rescaled.patch).0.warnings();
        let is_about_time = |finding: &Diagnostic| finding.code == Code::UNUSED_TIME_SCALE;
        assert!(!warnings.findings.iter().any(is_about_time), "{label}: {warnings}");
        let names: Vec<String> = patch.drives.keys().chain(patch.elements.keys()).cloned().collect();
        // The inverter B7 of the rod is behind a pot, so its voltage is a rate per machine second, too.
        let stays = |name: &String| {
            let is_pot = patch.elements.get(name).is_some_and(|entry| entry.kind.name == "pot");
            !is_pot && (*file != "lessons/heat-rod" || name != "B7")
        };
        let names: Vec<String> = names.into_iter().filter(stays).collect();
        let [before, after] = [&patch, &rescaled.patch].map(|patch| trace(patch, &names));
        let agrees = rescaled.agrees_until.unwrap();
        let end = before.time.last().copied().unwrap();
        // Only the motion of Lorenz amplifies the rounding of numbers. It does so for products earlier than for signals.
        let is_lorenz = *file == "lessons/lorenz";
        assert!(agrees >= end || (is_lorenz && agrees > 0.3 * end), "{label}: {agrees} s of {end} s");
        let until = if is_lorenz { 0.8 * agrees } else { agrees };
        for name in &names {
            let [one, other] = [&before, &after].map(|trace| &trace.track(name).unwrap().volts);
            let peak = one.iter().fold(0.0, |peak: f64, volts| peak.max(volts.abs()));
            let samples = before.time.iter().zip(one.iter().zip(other)).filter(|(time, _)| **time <= until);
            for (time, (one, other)) in samples {
                assert!((one - other).abs() <= TOLERANCE * peak, "{label}: {name} at {time} s");
            }
        }
    }
}

#[test]
fn formulas_contain_the_new_time_scale() {
    let rescaled = rescaled(&shipped("lessons/mass-and-spring"), Some(10.0));
    let elements = &rescaled.patch.value()["elements"];
    assert_eq!(elements["P1"]["setting"], "k / m * position / velocity / time_scale");
    assert_eq!(elements["A2"]["in"], json!({"x1": ["A1"]}));
    let warnings = Circuit::new(&rescaled.patch).unwrap().warnings();
    assert_eq!(warnings.warning_count(), 0, "{warnings}");
}

#[test]
fn a_cord_without_a_pot_gets_one_if_the_machine_lacks_the_gain() {
    let rescaled = rescaled(&shipped("lessons/driven-oscillator"), Some(3.0));
    let elements = &rescaled.patch.value()["elements"];
    assert_eq!(elements["A2"]["in"], json!({"x10": ["PT_A2_1"]}));
    let pot = &elements["PT_A2_1"];
    assert_eq!((&pot["in"], &pot["setting"]), (&json!("B1"), &json!("1 / time_scale")));
    assert!(rescaled.changes.iter().any(|change| change.setting == "new pot" && change.name == "PT_A2_1"));
}

/// The message of a patch that cannot be rescaled.
fn failure(patch: &Patch, time: Option<f64>) -> String {
    rescale_patch(patch, &RescaleOptions { time }).unwrap_err().to_string()
}

#[test]
fn what_cannot_be_rescaled_is_an_error() {
    let patch = shipped("thesis/fig-8-04");
    for (time, shown) in [(0.0, "0"), (-2.0, "-2"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        assert_eq!(
            failure(&patch, Some(time)),
            format!("the factor of the time must be positive, got {shown}")
        );
    }
    assert_eq!(
        failure(&patch, Some(0.1)),
        "A3 (line 50) would need an input with a gain of 10000, which solartron-1451 does not have: state another \
         \"machine\", or change the scales less"
    );
    let text = r#"{"patchcord": 1, "elements": {"A1": {"kind": "integrator", "in": {"x1": ["ground"]}}},
        "run": {"for": 1, "step": 0.1}}"#;
    let patch = Patch::parse("zero.json", text).unwrap();
    let message = failure(&patch, None);
    assert!(
        message.starts_with("there is nothing to scale: all amplifiers have 0 V in the whole run."),
        "{message}"
    );
    let text = text.replace(r#""run": {"for": 1, "step": 0.1}"#, r#""run": {}"#);
    let patch = Patch::parse("no-run.json", &text).unwrap();
    assert!(failure(&patch, None).starts_with("the patch cannot be run: "), "{}", failure(&patch, None));
}

#[test]
fn an_amplifier_between_references_says_why_it_stays() {
    let text = r#"{"patchcord": 1, "elements": {
        "B1": {"kind": "absolute", "in": "+100"},
        "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 2}},
        "signals": {"b": {"at": "B1"}, "a": {"at": "A1"}}, "run": {"for": 1, "step": 0.1}}"#;
    let rescaled = rescaled(&Patch::parse("fixed.json", text).unwrap(), None);
    let [b1, a1] = &rescaled.outputs[..] else { panic!("there are two amplifiers") };
    assert_eq!(b1.reason.as_deref(), Some("its inputs without pots and its settings fix its scale"));
    assert!((b1.after - 100.0).abs() < ROUNDING && a1.is_good(), "{a1:?}");
    // A signal without a scale keeps its values by its factor.
    let document = rescaled.patch.value();
    let written = [&document["signals"]["a"]["factor"], &document["elements"]["A1"]["initial"]];
    let [factor, initial] = written.map(|value| value.as_f64().unwrap());
    assert!((factor * initial - 2.0).abs() < 1e-9);
}

#[test]
fn a_hold_at_an_overload_does_not_hide_the_peaks() {
    let rescaled_with = |hold: bool| {
        let text = format!(
            r#"{{"patchcord": 1, "elements": {{"B1": {{"kind": "inverter", "in": "A1"}},
                "A1": {{"kind": "integrator", "in": {{"x10": ["B1"]}}, "initial": 8}}}},
                "run": {{"for": 1, "step": 0.001, "hold_on_overload": {hold}}}}}"#
        );
        rescaled(&Patch::parse("growth.json", &text).unwrap(), None)
    };
    let [free, held] = [false, true].map(rescaled_with);
    assert_eq!(outside_range(&held), [""; 0]);
    assert_eq!((held.outputs, held.runs), (free.outputs, free.runs));
}
