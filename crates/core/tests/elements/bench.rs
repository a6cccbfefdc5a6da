//! A test bench for one element E. The voltages of its drives a, b and c are parameters, which can be set in every
//! mode.

use std::ops::Range;

use serde_json::json;

use crate::common::{built, check_derivatives, element, run_for, voltage, volts};
use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, PatchBuilder};
use patchcord_core::solve::{Machine, MachineMode};

/// The range of output voltages.
pub(super) const ANY: Range<f64> = -100.0..100.0;

/// The names of the drives, which are also the names of their parameters.
const DRIVES: [&str; 3] = ["a", "b", "c"];

/// The output of an amplifier for a demanded voltage.
pub(super) fn clip(volts: f64) -> f64 {
    volts.clamp(-100.0, 100.0)
}

/// A patch with these drives.
fn drives(names: &[&str]) -> PatchBuilder {
    names.iter().fold(volts("bench"), |builder, name| {
        let drive = element("step").set("height", *name);
        builder.parameter(name, 0.0, "V", [-100.0, 100.0]).drive(name, "volt", drive)
    })
}

/// The program of an element on the bench. The diode pairs "high" and "low" give 10 V more and less than a.
pub(super) fn bench(element: ElementBuilder) -> Program {
    let pair = |kind| crate::common::element(kind).set("in", json!(["a", "a"])).set("drop", 10);
    let builder = drives(&DRIVES).element("high", pair("diode-lower-of"));
    built(builder.element("low", pair("diode-upper-of")).element("E", element))
}

/// The program of a drive on the bench, in volts.
pub(super) fn bench_drive(drive: ElementBuilder) -> Program {
    built(drives(&DRIVES).drive("E", "volt", drive))
}

/// A machine in initial condition with these voltages of a, b, c.
pub(super) fn at<'p>(program: &'p Program, volts: &[f64]) -> Machine<'p> {
    let mut machine = run_for(program, 1e-3, 0.0);
    machine.initial_condition().unwrap();
    apply(&mut machine, volts);
    machine
}

/// Sets the voltages of a, b, c.
pub(super) fn apply(machine: &mut Machine<'_>, volts: &[f64]) {
    for (name, volts) in DRIVES.iter().zip(volts) {
        machine.set_parameter(name, *volts).unwrap_or_else(|error| panic!("{error}"));
    }
}

/// The output of the element on the bench.
pub(super) fn out(machine: &Machine<'_>) -> f64 {
    voltage(machine, "E")
}

/// The output of an element in initial condition with these voltages of a, b, c.
pub(super) fn output(element: ElementBuilder, volts: &[f64]) -> f64 {
    out(&at(&bench(element), volts))
}

/// Whether two voltages are equal up to rounding.
pub(super) fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-12 * (1.0 + found.abs().max(expected.abs()))
}

/// Asserts that the output is equal to `expected` up to rounding.
pub(super) fn assert_out(machine: &Machine<'_>, expected: f64, when: &str) {
    assert!(near(out(machine), expected), "{when}: {}, expected {expected}", out(machine));
}

/// Asserts the behaviour of an overloaded amplifier. Its output stops at ±100 V, its lamp stays lit after its inputs
/// fall to 0, and the overload's peak is the demanded voltage.
pub(super) fn stops_at_100_volts(element: ElementBuilder, volts: &[f64], demand: f64) {
    let program = bench(element);
    let mut machine = at(&program, volts);
    assert_overload(&machine, demand);
    machine.operate(2e-3).unwrap();
    apply(&mut machine, &[0.0; 3]);
    assert!(machine.is_overloaded(), "the lamp stays lit");
    machine.initial_condition().unwrap();
    assert!(!machine.is_overloaded(), "the lamp goes out in initial condition");
}

/// Asserts that a drive with an initial demand above 100 V is overloaded.
pub(super) fn drive_stops_at_100_volts(drive: ElementBuilder, demand: f64) {
    assert_overload(&at(&bench_drive(drive), &[]), demand);
}

/// Asserts that E is overloaded at t = 0 with this demanded voltage.
fn assert_overload(machine: &Machine<'_>, demand: f64) {
    assert_eq!(out(machine), 100f64.copysign(demand));
    let overloads = machine.overloads();
    let [lamp] = overloads.as_slice() else { panic!("expected one lamp: {overloads:?}") };
    assert_eq!((lamp.element.as_str(), lamp.time, lamp.caused_by.as_deref()), ("E", 0.0, None));
    assert!(near(lamp.peak().unwrap(), demand.abs()), "{lamp:?}");
}

/// Asserts that a network without an amplifier follows its formula beyond 100 V and lights no lamp.
pub(super) fn has_no_lamp(element: ElementBuilder, volts: &[f64], expected: f64) {
    let program = bench(element);
    let mut machine = at(&program, volts);
    machine.operate(2e-3).unwrap();
    assert_out(&machine, expected, "beyond the limits");
    assert!(!machine.is_overloaded(), "{:?}", machine.overloads());
}

/// Asserts that an element without memory follows its inputs in initial condition, operate and hold. Each case has
/// input voltages and the expected output.
pub(super) fn computes_in_every_mode(element: ElementBuilder, cases: [(&[f64], f64); 3]) {
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

/// Asserts that a drive has its value of t = 0 in initial condition, and that its time stops in hold and then
/// continues.
pub(super) fn waits_in_hold(drive: ElementBuilder, law: impl Fn(f64) -> f64) {
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

/// Compares exact derivatives through an element with differences. They are by the state of an integrator that replaces
/// a, by the voltage of b, and by parameters (name, value, unit, range).
pub(super) fn has_exact_derivatives(
    tested: ElementBuilder,
    initial: f64,
    parameters: &[(&str, f64, &str, [f64; 2])],
) {
    let integrator = element("integrator").cords("x1", ["E"]).set("initial", initial);
    let builder = parameters.iter().fold(drives(&["b"]), |builder, (name, value, unit, range)| {
        builder.parameter(name, *value, unit, *range)
    });
    let program = built(builder.element("a", integrator).element("E", tested));
    check_derivatives(&program, 1e-3, &[0.0, 0.1, 0.3]);
}
