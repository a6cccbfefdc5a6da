//! Macros: a patch with macros runs like the patch without macros in which they are expanded.

mod expansion;
mod size;

use proptest::prelude::*;
use serde_json::{Map, Value, json};

use crate::common::random::SplitMix64;
use crate::common::{circuit, element, patch, program, random_cases, slideway, voltage, volts};
use expansion::expanded;
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{DrivenJack, MacroBuilder, Patch, PatchBuilder};
use patchcord_core::solve::{self, Machine, RunSettings};

/// Runs a patch with these parameter values for a duration, and returns the name and the bits of every recorded signal.
fn samples(patch: &Patch, changes: &[(&str, f64)], duration: f64) -> Vec<(String, Vec<u64>)> {
    let circuit = circuit(patch, changes);
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let settings = RunSettings::of(&circuit).unwrap().with_duration(duration);
    let trace = solve::run(&program, &settings).unwrap_or_else(|error| panic!("{error}"));
    let bits = |name: &str| trace.values(name).unwrap().iter().map(|value| value.to_bits()).collect();
    settings.record.iter().map(|name| (name.clone(), bits(name))).collect()
}

/// The patch of a document with its macros expanded.
fn without_macros(document: &Value) -> Patch {
    Patch::from_value("expanded.json", &expanded(document)).unwrap_or_else(|report| panic!("{report}"))
}

/// Fig 8.16 with the lag of Fig 8.15 as a macro.
fn slideway_with_a_lag() -> Patch {
    let mut document = slideway().value().clone();
    let elements = document["elements"].as_object_mut().unwrap();
    let lag = ["A2", "PA1", "A1", "B1"].map(|name| (name.to_owned(), elements.shift_remove(name).unwrap()));
    let mut lag: Map<String, Value> = lag.into_iter().collect();
    lag["A2"]["in"] = json!({"x10": ["reference"], "x1": ["in", "B1"]});
    lag["PA1"]["setting"] = "0.001 / T".into();
    elements.insert("L".into(), json!({"kind": "lag-8-15", "in": "X3", "reference": "PA2", "T": "Tc"}));
    elements["PC1"]["in"] = "L".into();
    document["signals"]["memory"]["at"] = "L".into();
    document["macros"] = json!({"lag-8-15": {
        "inputs": {"in": "-100 V times the part of friction lost to velocity", "reference": "a tenth of +100 V"},
        "outputs": {"out": "A1"},
        "settings": {"T": {"unit": "s"}},
        "elements": lag,
    }});
    Patch::from_value("fig-8-16.json", &document).unwrap()
}

#[test]
fn fig_8_16_with_its_lag_as_a_macro_gives_the_same_bits() {
    let (original, patch_with_macros) = (slideway(), slideway_with_a_lag());
    for changes in [&[][..], &[("Tc", 0.025), ("VcL", 5.08e-3)]] {
        let (expected, found) = (samples(&original, changes, 0.3), samples(&patch_with_macros, changes, 0.3));
        assert_eq!(expected.len(), 7);
        assert!(expected == found, "{changes:?}");
    }
    assert_eq!(circuit(&original, &[]).parts(), circuit(&patch_with_macros, &[]).parts());
}

#[test]
fn a_pot_inside_a_macro_can_be_changed_during_a_run() {
    let memory_bits = |patch: &Patch, memory: &str| {
        let program = program(patch, &[("v_start", 1e-3)]);
        let mut machine = Machine::new(&program, 2e-5).unwrap();
        machine.operate(0.01).unwrap();
        machine.set_parameter("Tc", 0.1).unwrap();
        machine.operate(0.02).unwrap();
        voltage(&machine, memory).to_bits()
    };
    assert_eq!(memory_bits(&slideway(), "A1"), memory_bits(&slideway_with_a_lag(), "L.A1"));
}

#[test]
fn nested_macros_run_like_their_expansion() {
    let patch_with_macros = patch("lags-in-macros");
    for changes in [&[][..], &[("T1", 35.0), ("share", 0.3)]] {
        let found = samples(&patch_with_macros, changes, 0.3);
        let names: Vec<_> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["last", "between", "L.B1", "W.sum"]);
        assert!(found == samples(&without_macros(patch_with_macros.value()), changes, 0.3), "{changes:?}");
    }
}

/// The step response of two lags in series is 1 - (T1 exp(-t / T1) - T2 exp(-t / T2)) / (T1 - T2) of the step.
#[test]
fn two_lags_in_series_agree_with_the_closed_solution() {
    let patch_with_macros = volts("two lags")
        .define("lag-8-15", lag())
        .drive("D", "volt", element("step").set("height", 50))
        .element("L1", element("lag-8-15").set("in", "D").set("T", 20))
        .element("L2", element("lag-8-15").set("in", "L1").set("T", "0.05 * T0"))
        .parameter("T0", 1.0, "s", [0.5, 2.0]);
    let program = crate::common::built(patch_with_macros);
    let machine = crate::common::run_for(&program, 1e-4, 0.1);
    let (one, two, time): (f64, f64, f64) = (0.02, 0.05, 0.1);
    let response = 1.0 - (one * (-time / one).exp() - two * (-time / two).exp()) / (one - two);
    // The error of the method is (1e-4 / 0.02)^4 / 120 of the step.
    assert!((voltage(&machine, "L2.A1") - 50.0 * response).abs() < 1e-8, "{}", voltage(&machine, "L2.A1"));
}

/// The macro of the lag of Fig 8.15 with its time constant T in ms.
fn lag() -> MacroBuilder {
    MacroBuilder::new()
        .input("in", "the input of the lag")
        .output("out", "A1")
        .output("minus", "B1")
        .setting("T", "ms", Value::Null)
        .element("A2", element("summer").cords("x1", ["in", "B1"]))
        .element("PA1", element("pot").cord("in", "A2").set("setting", "0.001 / T"))
        .element("A1", element("integrator").cords("x1000", ["PA1"]))
        .element("B1", element("summer").cords("x1", ["A1"]))
}

/// A rod of six cells u' = k (u_left - 2 u + u_right) between a hot and a cold end. `cell` adds one cell.
fn rod(cell: impl Fn(PatchBuilder, &str, &str, &str) -> PatchBuilder) -> PatchBuilder {
    let hot = volts("rod").drive("hot", "volt", element("step").set("height", 80));
    let hot = hot.parameter("k", 5.0, "1/s", [1.0, 10.0]);
    (1..=6).fold(hot, |rod, index| {
        let left = if index == 1 { "hot".to_owned() } else { format!("C{}", index - 1) };
        let right = if index == 6 { "ground".to_owned() } else { format!("C{}", index + 1) };
        cell(rod, &format!("C{index}"), &left, &right)
    })
}

#[test]
fn a_rod_of_six_instances_equals_the_rod_of_elements() {
    let parts = |prefix: &str, left: &str, right: &str| {
        let prefixed = |name: &str| format!("{prefix}{name}");
        [
            (
                prefixed("S"),
                element("summer").set("in", json!({"x1": [left, right, prefixed("I"), prefixed("I")]})),
            ),
            (prefixed("P"), element("pot").set("in", prefixed("S")).set("setting", "k / 10")),
            (prefixed("A"), element("integrator").set("in", json!({"x10": [prefixed("P")]}))),
            (prefixed("I"), element("summer").set("in", json!({"x1": [prefixed("A")]}))),
        ]
    };
    let cell = parts("", "left", "right").into_iter().fold(
        MacroBuilder::new().input("left", "").input("right", "").output("u", "A"),
        |cell, (name, part)| cell.element(&name, part),
    );
    let patch_with_macros = rod(|rod, name, left, right| {
        rod.element(name, element("cell").cord("left", left).cord("right", right))
    });
    let patch_with_macros = program(&patch_with_macros.define("cell", cell).build().unwrap(), &[]);
    let output = |name: &str| if name.starts_with('C') { format!("{name}.A") } else { name.to_owned() };
    let plain = crate::common::built(rod(|rod, name, left, right| {
        parts(&format!("{name}."), &output(left), &output(right))
            .into_iter()
            .fold(rod, |rod, (name, part)| rod.element(&name, part))
    }));
    let (patch_with_macros, plain) =
        (crate::common::run_for(&patch_with_macros, 1e-3, 0.5), crate::common::run_for(&plain, 1e-3, 0.5));
    let volts =
        |machine: &Machine<'_>| machine.states().iter().map(|volts| volts.to_bits()).collect::<Vec<_>>();
    assert_eq!(patch_with_macros.states().len(), 6);
    assert_eq!(volts(&patch_with_macros), volts(&plain));
}

#[test]
fn a_patch_with_macros_survives_writing_and_reading() {
    let patch_with_macros = patch("lags-in-macros");
    let again = Patch::parse("again.json", patch_with_macros.text()).unwrap();
    assert_eq!((again.text(), again.value()), (patch_with_macros.text(), patch_with_macros.value()));
    let printed = Patch::from_value("again.json", patch_with_macros.value()).unwrap();
    assert_eq!(printed.value(), patch_with_macros.value());
    assert_eq!(
        printed.elements.keys().collect::<Vec<_>>(),
        patch_with_macros.elements.keys().collect::<Vec<_>>()
    );
}

#[test]
fn a_patch_lists_its_instances_with_members_and_ports() {
    let patch = patch("lags-in-macros");
    assert_eq!(patch.instances.keys().collect::<Vec<_>>(), ["W", "W.first", "W.second", "L"]);
    let lag = ["A2", "PA1", "A1", "B1"];
    let members: Vec<String> = (lag.iter().map(|name| format!("W.first.{name}")))
        .chain(["W.sum".to_owned()])
        .chain(lag.iter().map(|name| format!("W.second.{name}")))
        .collect();
    let outer = &patch.instances["W"];
    assert_eq!((&outer.parent, &patch.instances["W.first"].parent), (&None, &Some("W".to_owned())));
    assert_eq!((outer.macro_name.as_str(), outer.note.as_str()), ("two-lags", "a box of boxes"));
    assert_eq!(outer.members, members);
    assert_eq!(outer.outputs["out"], "W.second.B1");
    assert_eq!(outer.outputs["between"], "W.first.A1");
    assert_eq!(outer.inputs["in"].driver.as_deref(), Some("P"));
    let feed = |element: &str, jack: &str| DrivenJack { element: element.to_owned(), jack: jack.to_owned() };
    assert_eq!(outer.inputs["in"].driven_jacks, [feed("W.first.A2", "x1")]);
    assert_eq!(outer.inputs["level"].driven_jacks, [feed("W.sum", "x1")]);
    assert_eq!(patch.instances["W.second"].inputs["in"].driver.as_deref(), Some("W.sum"));
    assert_eq!(patch.instances["L"].inputs["in"].driver.as_deref(), Some("W.second.B1"));
    assert_eq!(patch.instances["W.second"].settings["T"].value.value.text(), "T * share");
    assert_eq!(patch.macros["lag-8-15"].element_names().collect::<Vec<_>>(), lag);
}

/// A random section of elements and instances. They read `sources` and the outputs of the entries before them.
fn random_section(
    random: &mut SplitMix64,
    macros: &Map<String, Value>,
    sources: &[&str],
    names: &[&str],
) -> Value {
    let mut sources: Vec<String> = sources.iter().map(|name| (*name).to_owned()).collect();
    let mut section = Map::new();
    for index in 0..2 + random.below(4) {
        let name = format!("E{index}");
        let kinds: Vec<String> = macros.keys().cloned().collect();
        let choice = random.below(if kinds.is_empty() { 3 } else { 5 });
        let setting = match random.below(3) {
            0 => format!("{} / 2", names[random.below(names.len())]),
            1 => format!("{0} * {0}", names[random.below(names.len())]),
            _ => "0.3".to_owned(),
        };
        let entry = match choice {
            0 => json!({"kind": "pot", "in": random.pick(&sources), "setting": setting}),
            1 => json!({"kind": "summer", "in": {"x1": [random.pick(&sources), random.pick(&sources)]}}),
            2 => json!({"kind": "integrator", "in": {"x1": [random.pick(&sources)]}, "initial": setting}),
            _ => {
                let kind = random.pick(&kinds);
                sources.push(format!("{name}.second"));
                let mut instance =
                    json!({"kind": kind, "a": random.pick(&sources[..sources.len() - 1]), "s": setting});
                instance["b"] = random.pick(&sources[..sources.len() - 1]).as_str().into();
                if random.below(2) == 0 {
                    instance.as_object_mut().unwrap().shift_remove("s");
                }
                instance
            }
        };
        section.insert(name.clone(), entry);
        sources.push(name);
    }
    Value::Object(section)
}

/// A random patch document with nested macros, elements and instances.
fn random_document(seed: u64) -> Value {
    let mut random = SplitMix64(seed);
    let mut macros = Map::new();
    for index in 0..1 + random.below(3) {
        let elements = random_section(&mut random, &macros, &["a", "b", "D", "ground"], &["s", "p"]);
        let names: Vec<String> = elements.as_object().unwrap().keys().cloned().collect();
        macros.insert(
            format!("m{index}"),
            json!({
                "inputs": {"a": "", "b": ""},
                "outputs": {"first": random.pick(&names), "second": random.pick(&names)},
                "settings": {"s": {"unit": "1", "default": 0.25}},
                "elements": elements,
            }),
        );
    }
    let elements = random_section(&mut random, &macros, &["D", "+100"], &["p", "p"]);
    json!({
        "patchcord": 1,
        "parameters": {"p": {"value": 0.7, "unit": "1", "range": [0.1, 1]}},
        "scales": {"volt": {"per_volt": 1, "unit": "V"}},
        "drives": {"D": {"kind": "sine", "scale": "volt", "amplitude": 50, "frequency": 2}},
        "macros": macros,
        "elements": elements,
        "signals": {"out": {"at": "E0", "scale": "volt"}},
        "run": {"for": 0.2, "step": 1e-2},
    })
}

/// The bits of every element's voltage after a run.
fn voltages(patch: &Patch) -> Result<Vec<(String, u64)>, String> {
    let circuit = Circuit::new(patch).map_err(|report| report.to_string())?;
    let program = Program::new(&circuit).map_err(|report| report.to_string())?;
    let machine = crate::common::run_for(&program, 1e-2, 0.2);
    let read = |name: &str| voltage(&machine, name).to_bits();
    Ok(circuit.elements().iter().map(|element| (element.name.clone(), read(&element.name))).collect())
}

proptest! {
    #![proptest_config(random_cases(150))]

    #[test]
    fn random_macros_run_like_their_expansion(seed in any::<u64>()) {
        let document = random_document(seed);
        let patch_with_macros = Patch::from_value("patch_with_macros.json", &document).unwrap();
        let found = voltages(&patch_with_macros);
        prop_assert!(found.is_ok(), "{}\n{document:#}", found.unwrap_err());
        prop_assert_eq!(found, voltages(&without_macros(&document)));
    }
}
