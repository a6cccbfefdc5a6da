//! One element, called E, between drives a, b and c whose voltages are parameters and can be set in every mode.

use std::ops::Range;

use serde_json::json;

use crate::common::{built, check_derivatives, element, ran, voltage, volts};
use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, PatchBuilder};
use patchcord_core::solve::{Machine, MachineMode};

/// Every voltage that an output can have.
pub const ANY: Range<f64> = -100.0..100.0;

/// The drives.
const DRIVES: [&str; 3] = ["a", "b", "c"];

/// What an amplifier makes of a voltage that it is asked for.
pub fn clip(volts: f64) -> f64 {
    volts.clamp(-100.0, 100.0)
}

/// A patch with the drives a, b, c.
fn drives(names: &[&str]) -> PatchBuilder {
    names.iter().fold(volts("bench"), |builder, name| {
        let drive = element("step").set("height", *name);
        builder.parameter(name, 0.0, "V", [-100.0, 100.0]).drive(name, "volt", drive)
    })
}

/// An element on the bench. Diode pairs called high and low give 10 V more and less than a: up to 110 V.
pub fn bench(element: ElementBuilder) -> Program {
    let pair = |kind| crate::common::element(kind).set("in", json!(["a", "a"])).set("drop", 10);
    let builder = drives(&DRIVES).element("high", pair("diode-lower-of"));
    built(builder.element("low", pair("diode-upper-of")).element("E", element))
}

/// A drive on the bench, in volts.
pub fn bench_drive(drive: ElementBuilder) -> Program {
    built(drives(&DRIVES).drive("E", "volt", drive))
}

/// A machine in initial condition, with voltages of a, b, c.
pub fn at<'p>(program: &'p Program, volts: &[f64]) -> Machine<'p> {
    let mut machine = ran(program, 1e-3, 0.0);
    machine.initial_condition().unwrap();
    apply(&mut machine, volts);
    machine
}

/// Sets the voltages of a, b, c.
pub fn apply(machine: &mut Machine<'_>, volts: &[f64]) {
    for (name, volts) in DRIVES.iter().zip(volts) {
        machine.set(name, *volts).unwrap_or_else(|error| panic!("{error}"));
    }
}

/// The output of the element on the bench.
pub fn out(machine: &Machine<'_>) -> f64 {
    voltage(machine, "E")
}

/// What an element gives in initial condition, with voltages of a, b, c.
pub fn output(element: ElementBuilder, volts: &[f64]) -> f64 {
    out(&at(&bench(element), volts))
}

/// Whether two voltages are the same but for rounding.
pub fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-12 * (1.0 + found.abs().max(expected.abs()))
}

/// Asserts that the output is what is expected but for rounding.
pub fn assert_out(machine: &Machine<'_>, expected: f64, when: &str) {
    assert!(near(out(machine), expected), "{when}: {} instead of {expected}", out(machine));
}

/// An amplifier asked for too much: it stops at ±100 V, its lamp lights and stays lit when its inputs fall to 0,
/// and the history tells what was asked for.
pub fn stops_at_100_volts(element: ElementBuilder, volts: &[f64], asked: f64) {
    let program = bench(element);
    let mut machine = at(&program, volts);
    tells_overload(&machine, asked);
    machine.operate(2e-3).unwrap();
    apply(&mut machine, &[0.0; 3]);
    assert!(machine.is_overloaded(), "the lamp stays lit");
    machine.initial_condition().unwrap();
    assert!(!machine.is_overloaded(), "the lamp goes out in initial condition");
}

/// A drive that begins beyond 100 V.
pub fn drive_stops_at_100_volts(drive: ElementBuilder, asked: f64) {
    tells_overload(&at(&bench_drive(drive), &[]), asked);
}

fn tells_overload(machine: &Machine<'_>, asked: f64) {
    assert_eq!(out(machine), 100f64.copysign(asked));
    let told = machine.overloads();
    let [lamp] = told.as_slice() else { panic!("one lamp lights: {told:?}") };
    assert_eq!((lamp.element.as_str(), lamp.time, lamp.caused_by.as_deref()), ("E", 0.0, None));
    assert!(near(lamp.peak, asked.abs()), "{lamp:?}");
}

/// A network without an amplifier: it gives what its law says, beyond 100 V as well, and has no lamp.
pub fn has_no_lamp(element: ElementBuilder, volts: &[f64], expected: f64) {
    let program = bench(element);
    let mut machine = at(&program, volts);
    machine.operate(2e-3).unwrap();
    assert_out(&machine, expected, "beyond the limits");
    assert!(!machine.is_overloaded(), "{:?}", machine.overloads());
}

/// An element without memory follows its inputs in initial condition, in operation and in hold: three sets of
/// voltages, and what the law makes of each.
pub fn computes_in_every_mode(element: ElementBuilder, cases: [(&[f64], f64); 3]) {
    let [initial, operating, held] = cases;
    let program = bench(element);
    let mut machine = at(&program, initial.0);
    assert_out(&machine, initial.1, "in initial condition");
    machine.operate(3e-3).unwrap();
    apply(&mut machine, operating.0);
    assert_out(&machine, operating.1, "in operation");
    machine.hold();
    apply(&mut machine, held.0);
    assert_eq!(machine.mode(), MachineMode::Hold);
    assert_out(&machine, held.1, "in hold");
}

/// A drive stands at its value of t = 0 in initial condition; in hold its time stops, and runs on from there.
pub fn waits_in_hold(drive: ElementBuilder, law: impl Fn(f64) -> f64) {
    let program = bench_drive(drive);
    let mut machine = at(&program, &[]);
    assert_out(&machine, law(0.0), "in initial condition");
    machine.operate(0.37).unwrap();
    machine.hold();
    apply(&mut machine, &[50.0]);
    assert_out(&machine, law(0.37), "in hold");
    machine.operate(0.21).unwrap();
    assert_out(&machine, law(0.58), "after hold");
}

/// Exact derivatives through an element, by the state of an integrator that stands in the place of a, by the
/// voltage of b, and by parameters: name, value, unit, range.
pub fn has_exact_derivatives(
    element_of: ElementBuilder,
    initial: f64,
    parameters: &[(&str, f64, &str, [f64; 2])],
) {
    let integrator = element("integrator").cords("x1", ["E"]).set("initial", initial);
    let builder = parameters.iter().fold(drives(&["b"]), |builder, (name, value, unit, range)| {
        builder.parameter(name, *value, unit, *range)
    });
    let program = built(builder.element("a", integrator).element("E", element_of));
    check_derivatives(&program, 1e-3, &[0.0, 0.1, 0.3]);
}
