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
