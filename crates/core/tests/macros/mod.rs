//! Macros: a patch that uses them runs as the patch in which they are written out.

mod size;
mod written_out;

use proptest::prelude::*;
use serde_json::{Map, Value, json};

use crate::common::{circuit, element, patch, program, random_cases, slideway, voltage, volts};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Feed, MacroBuilder, Patch, PatchBuilder};
use patchcord_core::solve::{self, Machine, RunSettings};
use written_out::written_out;

/// Runs a patch as it asks to be run, with parameters changed: names and bits of all samples.
fn samples(patch: &Patch, changes: &[(&str, f64)], duration: f64) -> Vec<(String, Vec<u64>)> {
    let circuit = circuit(patch, changes);
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let settings = RunSettings::of(&circuit).unwrap().lasting(duration);
    let trace = solve::run(&program, &settings).unwrap_or_else(|error| panic!("{error}"));
    let bits = |name: &str| trace.values(name).unwrap().iter().map(|value| value.to_bits()).collect();
    settings.record.iter().map(|name| (name.clone(), bits(name))).collect()
}

fn plain(document: &Value) -> Patch {
    Patch::from_value("written-out.json", &written_out(document)).unwrap_or_else(|report| panic!("{report}"))
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
        "inputs": {"in": "-100 V times the share that velocity takes", "reference": "a tenth of +100 V"},
        "outputs": {"out": "A1"},
        "settings": {"T": {"unit": "s"}},
        "elements": lag,
    }});
    Patch::from_value("fig-8-16.json", &document).unwrap()
}

#[test]
fn fig_8_16_with_its_lag_in_a_box_gives_the_same_bits() {
    let (whole, boxed) = (slideway(), slideway_with_a_lag());
    for changes in [&[][..], &[("Tc", 0.025), ("VcL", 5.08e-3)]] {
        let (expected, found) = (samples(&whole, changes, 0.3), samples(&boxed, changes, 0.3));
        assert_eq!(expected.len(), 7);
        assert!(expected == found, "{changes:?}");
    }
    assert_eq!(circuit(&whole, &[]).parts(), circuit(&boxed, &[]).parts());
}

#[test]
fn a_pot_inside_a_box_turns_while_the_machine_runs() {
    let turned = |patch: &Patch, memory: &str| {
        let program = program(patch, &[("v_start", 1e-3)]);
        let mut machine = Machine::new(&program, 2e-5).unwrap();
        machine.operate(0.01).unwrap();
        machine.set("Tc", 0.1).unwrap();
        machine.operate(0.02).unwrap();
        voltage(&machine, memory).to_bits()
    };
    assert_eq!(turned(&slideway(), "A1"), turned(&slideway_with_a_lag(), "L.A1"));
}

#[test]
fn macros_in_macros_are_what_is_written_out() {
    let boxed = patch("lags-in-macros");
    for changes in [&[][..], &[("T1", 35.0), ("share", 0.3)]] {
        let found = samples(&boxed, changes, 0.3);
        let names: Vec<_> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["last", "between", "L.B1", "W.sum"]);
        assert!(found == samples(&plain(boxed.value()), changes, 0.3), "{changes:?}");
    }
}

/// Two lags after each other: 1 - (T1 exp(-t / T1) - T2 exp(-t / T2)) / (T1 - T2) of the step.
#[test]
fn two_lags_answer_a_step_as_the_closed_solution() {
    let boxed = volts("two lags")
        .define("lag-8-15", lag())
        .drive("D", "volt", element("step").set("height", 50))
        .element("L1", element("lag-8-15").set("in", "D").set("T", 20))
        .element("L2", element("lag-8-15").set("in", "L1").set("T", "0.05 * T0"))
        .parameter("T0", 1.0, "s", [0.5, 2.0]);
    let program = crate::common::built(boxed);
    let machine = crate::common::ran(&program, 1e-4, 0.1);
    let (one, two, time): (f64, f64, f64) = (0.02, 0.05, 0.1);
    let share = 1.0 - (one * (-time / one).exp() - two * (-time / two).exp()) / (one - two);
    // The order of the stepper leaves (1e-4 / 0.02)^4 / 120 of a lag's way.
    assert!((voltage(&machine, "L2.A1") - 50.0 * share).abs() < 1e-8, "{}", voltage(&machine, "L2.A1"));
}

fn lag() -> MacroBuilder {
    MacroBuilder::new()
        .input("in", "what is lagged")
        .output("out", "A1")
        .output("minus", "B1")
        .setting("T", "ms", Value::Null)
        .element("A2", element("summer").cords("x1", ["in", "B1"]))
        .element("PA1", element("pot").cord("in", "A2").set("setting", "0.001 / T"))
        .element("A1", element("integrator").cords("x1000", ["PA1"]))
        .element("B1", element("summer").cords("x1", ["A1"]))
}

/// A rod of six cells between a hot and a cold end: u' = k (u_left - 2 u + u_right).
fn rod(cell: impl Fn(PatchBuilder, &str, &str, &str) -> PatchBuilder) -> PatchBuilder {
    let hot = volts("rod").drive("hot", "volt", element("step").set("height", 80));
    let hot = hot.parameter("k", 5.0, "1/s", [1.0, 10.0]);
    (1..=6).fold(hot, |rod, at| {
        let left = if at == 1 { "hot".to_owned() } else { format!("C{}", at - 1) };
        let right = if at == 6 { "ground".to_owned() } else { format!("C{}", at + 1) };
        cell(rod, &format!("C{at}"), &left, &right)
    })
}

#[test]
fn a_rod_of_six_boxes_is_the_rod_written_out() {
    let parts = |around: &str, left: &str, right: &str| {
        let own = |name: &str| format!("{around}{name}");
        [
            (own("S"), element("summer").set("in", json!({"x1": [left, right, own("I"), own("I")]}))),
            (own("P"), element("pot").set("in", own("S")).set("setting", "k / 10")),
            (own("A"), element("integrator").set("in", json!({"x10": [own("P")]}))),
            (own("I"), element("summer").set("in", json!({"x1": [own("A")]}))),
        ]
    };
    let cell = parts("", "left", "right").into_iter().fold(
        MacroBuilder::new().input("left", "").input("right", "").output("u", "A"),
        |cell, (name, part)| cell.element(&name, part),
    );
    let boxed = rod(|rod, name, left, right| {
        rod.element(name, element("cell").cord("left", left).cord("right", right))
    });
    let boxed = program(&boxed.define("cell", cell).build().unwrap(), &[]);
    let output = |name: &str| if name.starts_with('C') { format!("{name}.A") } else { name.to_owned() };
    let plain = crate::common::built(rod(|rod, name, left, right| {
        parts(&format!("{name}."), &output(left), &output(right))
            .into_iter()
            .fold(rod, |rod, (name, part)| rod.element(&name, part))
    }));
    let (boxed, plain) = (crate::common::ran(&boxed, 1e-3, 0.5), crate::common::ran(&plain, 1e-3, 0.5));
    let volts =
        |machine: &Machine<'_>| machine.states().iter().map(|volts| volts.to_bits()).collect::<Vec<_>>();
    assert_eq!(boxed.states().len(), 6);
    assert_eq!(volts(&boxed), volts(&plain));
}

#[test]
fn a_patch_with_macros_reads_and_writes_as_the_same_text() {
    let boxed = patch("lags-in-macros");
    let again = Patch::parse("again.json", boxed.text()).unwrap();
    assert_eq!((again.text(), again.value()), (boxed.text(), boxed.value()));
    let printed = Patch::from_value("again.json", boxed.value()).unwrap();
    assert_eq!(printed.value(), boxed.value());
    assert_eq!(printed.elements.keys().collect::<Vec<_>>(), boxed.elements.keys().collect::<Vec<_>>());
}

#[test]
fn what_belongs_together_is_told_beside_the_elements() {
    let patch = patch("lags-in-macros");
    assert_eq!(patch.instances.keys().collect::<Vec<_>>(), ["W", "W.first", "W.second", "L"]);
    let lag = ["A2", "PA1", "A1", "B1"];
    let members: Vec<String> = (lag.iter().map(|name| format!("W.first.{name}")))
        .chain(["W.sum".to_owned()])
        .chain(lag.iter().map(|name| format!("W.second.{name}")))
        .collect();
    let outer = &patch.instances["W"];
    assert_eq!((&outer.around, &patch.instances["W.first"].around), (&None, &Some("W".to_owned())));
    assert_eq!((outer.of.as_str(), outer.note.as_str()), ("two-lags", "a box of boxes"));
    assert_eq!(outer.members, members);
    assert_eq!(outer.outputs["out"], "W.second.B1");
    assert_eq!(outer.outputs["between"], "W.first.A1");
    assert_eq!(outer.inputs["in"].driver.as_deref(), Some("P"));
    let feed = |element: &str, jack: &str| Feed { element: element.to_owned(), jack: jack.to_owned() };
    assert_eq!(outer.inputs["in"].feeds, [feed("W.first.A2", "x1")]);
    assert_eq!(outer.inputs["level"].feeds, [feed("W.sum", "x1")]);
    assert_eq!(patch.instances["W.second"].inputs["in"].driver.as_deref(), Some("W.sum"));
    assert_eq!(patch.instances["L"].inputs["in"].driver.as_deref(), Some("W.second.B1"));
    assert_eq!(patch.instances["W.second"].settings["T"].value.value.text(), "T * share");
    assert_eq!(patch.macros["lag-8-15"].parts().collect::<Vec<_>>(), lag);
}

/// Numbers that look like chance (xorshift).
struct Dice(u64);

impl Dice {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end.max(1) as u64) as usize
    }

    fn one_of(&mut self, items: &[String]) -> String {
        items[self.below(items.len())].clone()
    }
}

/// A section of elements and instances that read what stands before them: `sources`, and each other's outputs.
fn random_section(dice: &mut Dice, macros: &Map<String, Value>, sources: &[&str], names: &[&str]) -> Value {
    let mut sources: Vec<String> = sources.iter().map(|name| (*name).to_owned()).collect();
    let mut section = Map::new();
    for at in 0..2 + dice.below(4) {
        let name = format!("E{at}");
        let held: Vec<String> = macros.keys().cloned().collect();
        let choice = dice.below(if held.is_empty() { 3 } else { 5 });
        let setting = match dice.below(3) {
            0 => format!("{} / 2", names[dice.below(names.len())]),
            1 => format!("{0} * {0}", names[dice.below(names.len())]),
            _ => "0.3".to_owned(),
        };
        let entry = match choice {
            0 => json!({"kind": "pot", "in": dice.one_of(&sources), "setting": setting}),
            1 => json!({"kind": "summer", "in": {"x1": [dice.one_of(&sources), dice.one_of(&sources)]}}),
            2 => json!({"kind": "integrator", "in": {"x1": [dice.one_of(&sources)]}, "initial": setting}),
            _ => {
                let of = dice.one_of(&held);
                sources.push(format!("{name}.second"));
                let mut made =
                    json!({"kind": of, "a": dice.one_of(&sources[..sources.len() - 1]), "s": setting});
                made["b"] = dice.one_of(&sources[..sources.len() - 1]).into();
                if dice.below(2) == 0 {
                    made.as_object_mut().unwrap().shift_remove("s");
                }
                made
            }
        };
        section.insert(name.clone(), entry);
        sources.push(name);
    }
    Value::Object(section)
}

/// A patch of random macros that hold each other, and of elements and instances of them.
fn random_document(seed: u64) -> Value {
    let mut dice = Dice(seed | 1);
    let mut macros = Map::new();
    for at in 0..1 + dice.below(3) {
        let elements = random_section(&mut dice, &macros, &["a", "b", "D", "ground"], &["s", "p"]);
        let names: Vec<String> = elements.as_object().unwrap().keys().cloned().collect();
        macros.insert(
            format!("m{at}"),
            json!({
                "inputs": {"a": "", "b": ""},
                "outputs": {"first": dice.one_of(&names), "second": dice.one_of(&names)},
                "settings": {"s": {"unit": "1", "default": 0.25}},
                "elements": elements,
            }),
        );
    }
    let elements = random_section(&mut dice, &macros, &["D", "+100"], &["p", "p"]);
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

/// The bits of every voltage after a run.
fn voltages(patch: &Patch) -> Result<Vec<(String, u64)>, String> {
    let circuit = Circuit::new(patch, &[]).map_err(|report| report.to_string())?;
    let program = Program::new(&circuit).map_err(|report| report.to_string())?;
    let machine = crate::common::ran(&program, 1e-2, 0.2);
    let read = |name: &str| voltage(&machine, name).to_bits();
    Ok(circuit.elements().iter().map(|element| (element.name.clone(), read(&element.name))).collect())
}

proptest! {
    #![proptest_config(random_cases(150))]

    #[test]
    fn every_patch_of_macros_runs_as_written_out(seed in any::<u64>()) {
        let document = random_document(seed);
        let boxed = Patch::from_value("boxed.json", &document).unwrap();
        let found = voltages(&boxed);
        prop_assert!(found.is_ok(), "{}\n{document:#}", found.unwrap_err());
        prop_assert_eq!(found, voltages(&plain(&document)));
    }
}
