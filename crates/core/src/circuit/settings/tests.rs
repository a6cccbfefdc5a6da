//! Unit tests of `settings`.

use crate::circuit::Circuit;
use crate::document::{Code, Report};
use crate::ir::Program;
use crate::patch::{ElementBuilder, PatchBuilder};
use crate::solve::Machine;

/// The circuit of a pot with this setting between a reference and a summer, or the report on it.
fn pot_at(builder: PatchBuilder, setting: &str) -> Result<Circuit, Box<Report>> {
    let pot = ElementBuilder::new("pot").cord("in", "+100").set("setting", setting);
    let summer = ElementBuilder::new("summer").cords("x1", ["P"]);
    let patch = builder.element("P", pot).element("S", summer).scale("volt", 1.0, "V");
    Circuit::new(&patch.signal("s", "S", "volt", 1.0).build().unwrap())
}

#[test]
fn a_setting_that_exceeds_1_by_rounding_is_accepted() {
    let circuit = pot_at(PatchBuilder::new("full"), "0.1 * 3 / 0.3").unwrap();
    let program = Program::new(&circuit).unwrap();
    assert_eq!(Machine::new(&program, 1e-3).unwrap().voltage("P").unwrap(), 100.0 * (0.1 * 3.0 / 0.3));
}

#[test]
fn the_range_check_of_a_setting_follows_scales_that_depend_on_scales() {
    let builder = PatchBuilder::new("scales")
        .parameter("k", 1.0, "1", [0.5, 3.0])
        .scale("a", "b", "1")
        .scale("b", "k * c", "1")
        .scale("c", 0.5, "1");
    let warnings = pot_at(builder, "a").unwrap().warnings();
    assert_eq!(warnings.findings.len(), 1, "{warnings}");
    assert_eq!(warnings.findings[0].message, "\"setting\" of P would be 1.5 at k = 3");
}

#[test]
fn only_a_pot_in_front_of_an_integrator_may_be_set_to_a_rate() {
    let codes = |last: ElementBuilder, kind: &str, setting: &str| {
        let builder = PatchBuilder::new("rates").parameter("w", 0.5, "1/s", [0.1, 1.0]);
        let pot = ElementBuilder::new(kind).cord("in", "+100").set("setting", setting);
        let pot = if kind == "pot" { pot } else { pot.cord("end", "ground") };
        let patch = builder.element("P", pot).element("A", last.cords("x1", ["P"]));
        let report = Circuit::new(&patch.record(["A"]).build().unwrap()).err();
        report.map_or(vec![], |report| report.findings.iter().map(|finding| finding.code).collect())
    };
    let lag = || ElementBuilder::new("lag").set("time", 1);
    assert_eq!(codes(lag(), "pot", "0.5"), []);
    assert!(codes(lag(), "pot", "w").contains(&Code::UNIT_MISMATCH));
    let integrator = || ElementBuilder::new("integrator");
    assert_eq!(codes(integrator(), "pot", "w"), []);
    assert!(codes(integrator(), "free-pot", "w").contains(&Code::UNIT_MISMATCH));
}

#[test]
fn a_time_is_a_pure_number_only_if_no_unit_contains_a_time() {
    let codes = |scale: &str| -> Vec<Code> {
        let line = ElementBuilder::new("delay").cord("in", "+100").set("delay", "2 * tau");
        let patch = PatchBuilder::new("delay").parameter("tau", 0.5, "1", [0.1, 1.0]).element("L", line);
        let patch = patch.scale("y", 1.0, scale).signal("y", "L", "y", 1.0);
        let report = Circuit::new(&patch.build().unwrap()).err();
        report.map_or(vec![], |report| report.findings.iter().map(|finding| finding.code).collect())
    };
    for scale in ["1", "V", "mm"] {
        assert_eq!(codes(scale), []);
    }
    assert_eq!(codes("m/s"), [Code::UNIT_MISMATCH]);
}

#[test]
fn a_rate_in_front_of_an_inverter_is_moved_behind_it() {
    let patch = PatchBuilder::new("rate")
        .parameter("w", 0.5, "1/s", [0.1, 1.0])
        .element("P", ElementBuilder::new("pot").cord("in", "A").set("setting", "w"))
        .element("B", ElementBuilder::new("inverter").cord("in", "P"))
        .element("A", ElementBuilder::new("integrator").cords("x1", ["B"]));
    let report = Circuit::new(&patch.record(["A"]).build().unwrap()).unwrap_err();
    let finding = report.findings.iter().find(|finding| finding.code == Code::UNIT_MISMATCH).unwrap();
    assert_eq!(finding.message, "w is in 1/s, but a pure number is expected here");
    let hint = finding.hint.as_deref().unwrap();
    assert!(hint.starts_with("a pot that drives an integrator may be set to a rate"), "{hint}");
}

/// The cord that is missing is the fault, not the unit.
#[test]
fn a_pot_whose_output_nothing_uses_may_be_set_to_a_rate() {
    let codes = |signal: &str| -> Vec<Code> {
        let patch = PatchBuilder::new("missing cord")
            .parameter("w", 0.5, "1/s", [0.1, 1.0])
            .scale("volt", 1.0, "V")
            .element("P", ElementBuilder::new("pot").cord("in", "A").set("setting", "w"))
            .element("A", ElementBuilder::new("integrator").cords("x1", ["+100"]))
            .signal("s", signal, "volt", 1.0);
        let findings = match Circuit::new(&patch.build().unwrap()) {
            Ok(circuit) => circuit.warnings().findings,
            Err(report) => report.findings,
        };
        findings.iter().map(|finding| finding.code).collect()
    };
    assert_eq!(codes("A"), [Code::UNUSED_ELEMENT]);
    assert_eq!(codes("P"), [Code::UNIT_MISMATCH]);
}

/// The hints for settings outside 0 ... 1 of a mass on a spring. x'' = -k x with 64 mm, 10 mm/s per V; `position` is the
/// unit of the position, and `divisor` a factor of the setting of the spring.
fn spring_hints(position: &str, divisor: f64) -> Vec<String> {
    let pot = |from: &str, setting: &str| ElementBuilder::new("pot").cord("in", from).set("setting", setting);
    let spring = format!("k * position / velocity / {divisor}");
    let patch = PatchBuilder::new("spring")
        .parameter("k", 40.0, "1/s2", [10.0, 50.0])
        .scale("position", 1.0, position)
        .scale("velocity", 10.0, "mm/s")
        .element("PK", pot("B", &spring))
        .element("V", ElementBuilder::new("integrator").cords("x10", ["PK"]))
        .element("PV", pot("V", "velocity / position / 10"))
        .element("X", ElementBuilder::new("integrator").cords("x10", ["PV"]))
        .element("B", ElementBuilder::new("inverter").cord("in", "X"))
        .signal("x", "B", "position", 1.0);
    let report = Circuit::new(&patch.build().unwrap()).err();
    let findings = report.map_or(vec![], |report| report.findings);
    let outside = findings.into_iter().filter(|finding| finding.code == Code::SETTING_OUTSIDE);
    outside.filter_map(|finding| finding.hint).collect()
}

#[test]
fn a_wrong_unit_of_a_scale_is_named_behind_settings_outside_their_range() {
    assert!(spring_hints("mm", 10.0).is_empty());
    // With 1 m per V, the setting of the spring is 400, and that behind the velocity 0.001.
    let expected = "is the unit of a scale wrong? All settings are within 0 ... 1 if 1 V of the scale \
                    position is 0.001 m in place of 1 m, or if 1 V of the scale velocity is 10000 mm/s in place \
                    of 10 mm/s";
    assert_eq!(spring_hints("m", 10.0), [expected]);
    // A missing divisor of 10 is no wrong unit.
    let expected = "divide it by 10 and use an input with 10 times the gain, or rescale";
    assert_eq!(spring_hints("mm", 1.0), [expected]);
}

#[test]
fn an_angle_is_no_number_of_volts() {
    let initial = |value: &str| {
        let patch = PatchBuilder::new("pendulum")
            .parameter("a0", 30.0, "deg", [0.0, 90.0])
            .scale("angle", 1.0, "deg")
            .element("A", ElementBuilder::new("integrator").cords("x1", ["A"]).set("initial", value));
        Circuit::new(&patch.signal("a", "A", "angle", 1.0).build().unwrap())
    };
    let report = initial("-a0").unwrap_err();
    assert_eq!(report.findings[0].code, Code::UNIT_MISMATCH);
    assert_eq!(report.findings[0].message, "-a0 is an angle, but a number of volts is expected here");
    assert_eq!(report.findings[0].hint.as_deref(), Some("divide it by the scale angle to get volts"));
    for right in ["-a0 / angle", "50 * sin(a0)", "-30", "a0 / (pi / 180)"] {
        assert!(initial(right).is_ok(), "{right}");
    }
}

/// The circuit of a chain of pots, each set to a rate, that drives an amplifier of this kind.
fn chain(length: usize, kind: &str) -> Result<Circuit, Box<Report>> {
    let pot = |at: usize| {
        let driver = if at == 0 { "+100".to_owned() } else { format!("P{}", at - 1) };
        ElementBuilder::new("pot").cord("in", &driver).set("setting", "w")
    };
    let builder = PatchBuilder::new("chain").parameter("w", 0.5, "1/s", [0.1, 1.0]).scale("volt", 1.0, "V");
    let builder = (0..length).fold(builder, |builder, at| builder.element(&format!("P{at}"), pot(at)));
    let last = format!("P{}", length - 1);
    let builder = builder.element("A", ElementBuilder::new(kind).cords("x1", [last.as_str()]));
    Circuit::new(&builder.signal("a", "A", "volt", 1.0).build().unwrap())
}

#[test]
fn every_pot_of_a_chain_that_drives_an_integrator_may_be_set_to_a_rate() {
    chain(3000, "integrator").unwrap_or_else(|report| panic!("{report}"));
    assert_eq!(chain(3, "summer").unwrap_err().findings.len(), 3);
}

/// The faults of a patch over the ranges of its parameters: element, setting, value, and the values of the parameters.
fn faults(builder: PatchBuilder) -> Vec<(String, &'static str, Option<f64>, Vec<f64>)> {
    let circuit = Circuit::new(&builder.build().unwrap()).unwrap_or_else(|report| panic!("{report}"));
    let fault = |fault: crate::circuit::RangeFault| {
        let values = fault.parameters.into_iter().map(|(_, value)| value).collect();
        (fault.element, fault.setting, fault.value, values)
    };
    circuit.range_faults().into_iter().map(fault).collect()
}

#[test]
fn voltages_leave_their_ranges_without_a_warning() {
    let integrator = ElementBuilder::new("integrator").cords("x1", ["A"]).set("initial", "x0 / x");
    let patch = PatchBuilder::new("decay")
        .parameter("x0", 80.0, "mm", [-150.0, 90.0])
        .scale("x", 1.0, "mm")
        .element("A", integrator)
        .signal("x", "A", "x", 1.0);
    assert_eq!(faults(patch.clone()), [("A".to_owned(), "initial", Some(-150.0), vec![-150.0])]);
    let warnings = Circuit::new(&patch.build().unwrap()).unwrap().warnings();
    assert!(warnings.findings.iter().all(|finding| finding.code != Code::SETTING_RANGE), "{warnings}");
}

#[test]
fn limits_stay_in_order_over_the_ranges() {
    let limited = |low: f64| {
        let limit = serde_json::json!({"lower": "a", "upper": "b"});
        let summer = ElementBuilder::new("summer").cords("x1", ["S"]).set("limit", limit);
        PatchBuilder::new("limits")
            .parameter("a", -10.0, "1", [-20.0, 5.0])
            .parameter("b", 10.0, "1", [low, 20.0])
            .element("S", summer)
            .record(["S"])
    };
    assert_eq!(faults(limited(6.0)), []);
    // The upper limit must be above the lower one.
    let expected = ("S".to_owned(), "limit.lower", Some(0.0), vec![5.0, 5.0]);
    assert_eq!(faults(limited(5.0)), [expected]);
}

#[test]
fn the_levels_of_a_drive_add_up_to_at_most_100_volts() {
    let driven = |drive: ElementBuilder| {
        PatchBuilder::new("drive")
            .parameter("F", 20.0, "N", [10.0, 40.0])
            .parameter("r", 5.0, "N/s", [-10.0, 10.0])
            .scale("force", 0.5, "N")
            .drive("D", "force", drive)
            .signal("d", "D", "force", 1.0)
            .run(4.0, 1e-3)
    };
    let sine = |offset: f64| {
        ElementBuilder::new("sine").set("amplitude", "F").set("frequency", 1).set("offset", offset)
    };
    // 40 N and 10 N are 80 V and 20 V.
    assert_eq!(faults(driven(sine(10.0))), []);
    assert_eq!(faults(driven(sine(-15.0))), [("D".to_owned(), "amplitude", Some(110.0), vec![40.0])]);
    // 10 N/s for 4 s from 20 N are 60 N.
    let ramp = ElementBuilder::new("ramp").set("start", 20).set("rate", "r");
    assert_eq!(faults(driven(ramp)), [("D".to_owned(), "start", Some(120.0), vec![-10.0])]);
    // At present 5 N/s for 4 s from -40 N count as 120 V, which is the limit then.
    let ramp = ElementBuilder::new("ramp").set("start", -40).set("rate", "r");
    assert_eq!(faults(driven(ramp)), [("D".to_owned(), "start", Some(160.0), vec![-10.0])]);
}

#[test]
fn a_check_measures_by_how_much_a_rule_is_broken() {
    let pot = ElementBuilder::new("pot").cord("in", "+100").set("setting", "a / b");
    let patch = PatchBuilder::new("pot")
        .parameter("a", 1.0, "1", [0.0, 3.0])
        .parameter("c", 1.0, "1", [0.0, 3.0])
        .parameter("b", 2.0, "1", [0.0, 4.0])
        .element("P", pot)
        .record(["P"]);
    let circuit = Circuit::new(&patch.build().unwrap()).unwrap();
    let checks = circuit.range_checks();
    assert_eq!(checks.len(), 1);
    assert_eq!(checks[0].parameters(), [0, 2]);
    assert_eq!(checks[0].excess(&[(0, 3.0)]), 0.5);
    assert_eq!(checks[0].excess(&[(0, -3.0), (2, 2.0)]), -1.5);
    assert_eq!(checks[0].excess(&[(0, 3.0), (2, 3.0)]), 0.0);
    assert_eq!(checks[0].excess(&[(2, 0.0)]), f64::INFINITY);
    let ranges = |low: f64| [Some((0.0, 3.0)), None, Some((low, 4.0))];
    assert_eq!(checks[0].fault(&ranges(3.0)), None);
    let fault = checks[0].fault(&ranges(0.0)).unwrap();
    // With a at its present value, there is no value at b = 0 either.
    assert_eq!((fault.value, fault.parameters), (None, vec![("b".to_owned(), 0.0)]));
}

#[test]
fn a_warning_names_only_the_parameters_that_must_change() {
    let message = |k: [f64; 2], m: [f64; 2]| {
        let builder = PatchBuilder::new("ranges").parameter("k", 1.0, "1", k).parameter("m", 2.0, "1", m);
        let warnings = pot_at(builder, "k / m").unwrap().warnings();
        assert_eq!(warnings.findings.len(), 1, "{warnings}");
        warnings.findings[0].message.clone()
    };
    // At the present m = 2, the setting is above 1 at k = 3 already, and at the middle of the range of k it is not.
    assert_eq!(message([0.5, 3.0], [1.0, 11.0]), "\"setting\" of P would be 1.5 at k = 3");
    // Neither of the two is enough alone.
    assert_eq!(message([0.5, 1.5], [1.0, 11.0]), "\"setting\" of P would be 1.5 at k = 1.5, m = 1");
    // The middle of the range of k is wrong too, but the message names its end.
    assert_eq!(message([1.0, 9.0], [1.9, 2.5]), "\"setting\" of P would be 4.5 at k = 9");
}
