//! Warnings at the start, with voltages computed by hand.

use super::*;
use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};

/// The warnings about a patch: code, message and hint.
fn warnings(patch: &Patch) -> Vec<(String, String, String)> {
    let circuit = Circuit::new(patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let found = start_warnings(&circuit, &program, || Machine::new(&program, 1e-3).ok());
    let texts = |finding: &Diagnostic| {
        (finding.code.as_str().to_owned(), finding.message.clone(), finding.advice().to_owned())
    };
    found.iter().map(texts).collect()
}

/// The only message about a patch.
fn message(builder: PatchBuilder) -> String {
    let found = warnings(&builder.build().unwrap());
    assert_eq!(found.len(), 1, "{found:?}");
    found[0].1.clone()
}

fn integrator(from: &str, initial: f64) -> ElementBuilder {
    ElementBuilder::new("integrator").cords("x1", [from]).set("initial", initial)
}

/// An undamped mass on a spring from this position in volts: B is the position, and A its rate.
fn spring(position: f64) -> PatchBuilder {
    PatchBuilder::new("spring")
        .element("A", integrator("B", 0.0))
        .element("X", integrator("A", -position))
        .element("B", ElementBuilder::new("summer").cords("x1", ["X"]))
}

#[test]
fn a_state_that_begins_at_its_limit_is_reported() {
    assert_eq!(message(spring(-100.0)), "X begins at 100 V, its limit: any rise overloads it");
    assert_eq!(message(spring(100.0)), "X begins at -100 V, its limit: any fall overloads it");
    assert!(warnings(&spring(99.0).build().unwrap()).is_empty());
}

#[test]
fn a_state_that_moves_outward_at_once_is_reported_with_its_rate() {
    let builder = PatchBuilder::new("outward").element("A", integrator("+100", -100.0));
    assert_eq!(
        message(builder),
        "A begins at -100 V, its limit, and falls by 100 V/s at the start: it is overloaded at once"
    );
}

#[test]
fn the_advice_doubles_the_scale_of_the_state_or_of_its_inverter() {
    let scaled = spring(100.0).scale("length", 0.5, "mm").signal("x", "B", "length", 1.0).build().unwrap();
    assert_eq!(
        warnings(&scaled)[0].2,
        "let 1 V of x at B, which inverts X, represent 2 times as much (\"per_volt\": 1 in place of 0.5 in the scale \
         \"length\"), and adapt the gains"
    );
    let bare = spring(100.0).build().unwrap();
    assert_eq!(
        warnings(&bare)[0].2,
        "make X 2 times smaller: put a pot of 0.5 between A and X, multiply its initial value by 0.5; then multiply by 2 \
         where other amplifiers use it"
    );
}

#[test]
fn a_state_that_decays_from_its_limit_is_not_reported() {
    let decay = PatchBuilder::new("decay").element("A", integrator("A", 100.0)).build().unwrap();
    assert!(warnings(&decay).is_empty());
    // The lag begins where its input holds it: 100 V x the share that is remembered.
    let lag = ElementBuilder::new("lag").cords("x1", ["-100"]).set("time", 0.1).set("initial", 100);
    assert!(warnings(&PatchBuilder::new("lag").element("L", lag).build().unwrap()).is_empty());
}

#[test]
fn shipped_patches_that_begin_at_their_limit_are_not_reported() {
    for file in ["thesis/fig-8-15", "thesis/fig-8-16", "thesis/fig-8-17", "others/nakashima"] {
        let patch = Patch::read(format!("../../patches/{file}.json")).unwrap();
        let found = warnings(&patch);
        assert!(found.is_empty(), "{file}: {found:?}");
    }
}

/// A spring whose position B also drives itself through a pot.
fn looped(share: f64) -> PatchBuilder {
    spring(50.0)
        .element("B", ElementBuilder::new("summer").cords("x1", ["X", "P"]))
        .element("P", ElementBuilder::new("pot").cord("in", "B").set("setting", share))
}

#[test]
fn a_loop_that_shifts_the_start_is_reported_with_its_elements() {
    // B = 50 V - 0.25 B.
    let shifted = "the loop B -> P has no integrator and shifts the start: B begins at 40 V, but without the loop at 50 V";
    assert_eq!(message(looped(0.25)), shifted);
    let scaled = looped(0.25).scale("length", 0.5, "mm").signal("x", "B", "length", -1.0);
    assert!(message(scaled).ends_with("x at B begins at -20 mm, but without the loop at -25 mm"));
    let found = warnings(&looped(0.25).build().unwrap());
    assert_eq!(
        (found[0].0.as_str(), found[0].2.as_str()),
        (
            "loop-shifts-start",
            "take the cord from P out of B, or plug it into an integrator; if the loop is intended, state the equations of \
             the patch"
        )
    );
}

#[test]
fn loops_that_shift_nothing_or_are_intended_are_not_reported() {
    assert!(warnings(&looped(1e-3).build().unwrap()).is_empty());
    let stated = looped(0.25)
        .scale("length", 1, "mm")
        .signal("x", "B", "length", 1.0)
        .parameter("k", 0.8, "1/s2", [0.0, 1.0])
        .equation("x'' = -k x")
        .build()
        .unwrap();
    assert!(warnings(&stated).is_empty());
    // A root needs its loop.
    let root = Patch::read("../../patches/lessons/square-root-and-division.json").unwrap();
    assert!(warnings(&root).is_empty());
}
