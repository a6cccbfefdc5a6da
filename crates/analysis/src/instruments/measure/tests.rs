//! Unit tests of `measure`.

use super::*;
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;

fn parse(text: &str) -> Result<Measure, MeasureError> {
    let patch = Patch::read("../../patches/thesis/fig-8-16.json").unwrap();
    Measure::parse(text, Program::new(&Circuit::new(&patch).unwrap()).unwrap().signals())
}

fn columns(text: &str) -> Vec<(String, String)> {
    parse(text).unwrap().columns().into_iter().map(|column| (column.name, column.unit)).collect()
}

fn column(name: &str, unit: &str) -> (String, String) {
    (name.to_owned(), unit.to_owned())
}

#[test]
fn columns_are_named_by_the_request() {
    assert_eq!(columns("peak:v_o"), [column("peak:v_o", "m/s")]);
    assert_eq!(columns(" frequency: x_error, last=0.5 "), [column("frequency:x_error,last=0.5", "Hz")]);
    let [rising, falling] =
        ["critical_velocity_rising", "critical_velocity_falling"].map(|name| column(name, "m/s"));
    assert_eq!(columns("critical_velocity"), [rising, falling]);
    assert_eq!(columns("profile:standstill=1e-5")[4], column("profile_5:standstill=1e-5", "m/s"));
    assert_eq!(
        columns("friction_loop"),
        [column("friction_loop_area", "W"), column("friction_loop_work", "J")]
    );
    assert_eq!(columns("overload"), [column("overload", ""), column("overload_time", "s")]);
}

#[test]
fn bad_requests_return_errors_with_hints() {
    let cases = [
        ("peek:v_o", "there is no measure \"peek\"; did you mean \"peak\"?"),
        ("", "there is no measure \"\"; known here: voltmeter, "),
        ("peak", "peak reads one signal: write peak:SIGNAL"),
        ("overload:v_o", "overload reads no signal: write overload"),
        ("peak:v_o,v_i", "peak reads one signal: write peak:SIGNAL"),
        ("peak:v_p", "peak needs the signal \"v_p\", which the patch does not have; did you mean \"v_"),
        ("peak:v_o,last=2", "peak has no option \"last\"; it has none"),
        ("amplitude:v_o,lst=2", "amplitude has no option \"lst\"; did you mean \"last\"?"),
        ("amplitude:v_o,last=-2", "\"last\" of amplitude must be a positive number, got \"-2\""),
        (
            "amplitude:v_o,last=10 kg",
            "the value of \"last\" of amplitude: \"10 kg\" is in kg, but s is expected",
        ),
        ("amplitude:v_o,last=soon", "the value of \"last\" of amplitude: \"soon\" is not a number"),
        ("stick_end:threshold=1ms", "the value of \"threshold\" of stick_end: \"1ms\" is in ms, but m/s is"),
        ("critical_velocity:v_i", "critical_velocity reads two signals, the commanded"),
        (
            "friction_loop:v_o",
            "friction_loop reads two signals, a velocity and a force: write friction_loop:v_o,",
        ),
        ("friction_loop:x_error,spring_force", "friction_loop needs a velocity, but x_error in m is none"),
        ("friction_loop:v_o,v_i", "friction_loop needs a force, but v_i in m/s is none"),
        ("profile:standstill=0", "\"standstill\" of profile must be a positive number"),
        ("critical_velocity:v_i,x_error", "critical_velocity compares v_i in m/s and x_error in m"),
        ("critical_velocity:x_error,x_error", "critical_velocity has no default threshold for signals in m"),
    ];
    for (text, expected) in cases {
        let error = parse(text).unwrap_err().to_string();
        assert!(error.starts_with(expected) && !error.ends_with(':'), "{text}: {error}");
    }
}

#[test]
fn options_may_have_units() {
    let options = |text: &str| parse(text).unwrap().options;
    assert_eq!(options("amplitude:v_o,last=10ms"), [Some(0.01)]);
    assert_eq!(options("amplitude:v_o,last=10ms"), options("amplitude:v_o,last=0.01"));
    assert_eq!(
        options("critical_velocity:threshold=0.5 mm/s,window=50 ms"),
        options("critical_velocity:threshold=5e-4,window=0.05")
    );
    assert_eq!(options("friction_loop:threshold=0.5mm/s,last=1s"), [Some(5e-4), Some(1.0)]);
    assert_eq!(parse("amplitude:v_o,last=10ms").unwrap().text(), "amplitude:v_o,last=10ms");
}
