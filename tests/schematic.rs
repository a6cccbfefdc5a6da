//! Schematics by their data: every element and every cord is drawn, nothing runs into anything else.

mod common;
mod drawn;

use common::element;
use drawn::{check, schematic};
use patchcord::patch::{Patch, PatchBuilder};
use patchcord::plot::{Format, Theme, render_drawing};
use proptest::prelude::*;

fn stems() -> Vec<String> {
    let entries = std::fs::read_dir("tests/patches").unwrap().map(|entry| entry.unwrap().path());
    let patches = entries.filter(|path| path.extension().is_some_and(|ending| ending == "json"));
    let mut stems: Vec<_> =
        patches.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    stems.sort();
    stems
}

#[test]
fn patches_of_the_tests_are_drawn_rightly() {
    assert!(stems().len() >= 7);
    for stem in stems() {
        let circuit = common::circuit(&common::patch(&stem), &[]);
        check(&circuit, &stem);
    }
}

#[test]
fn the_final_circuit_is_drawn_rightly() {
    let circuit = common::circuit(&common::slideway(), &[]);
    let drawn = schematic(&circuit);
    check(&circuit, "fig-8-16");
    let dead_zone = drawn.symbols.iter().find(|placed| placed.symbol.name == "DZ").unwrap();
    let texts: Vec<_> = dead_zone.labels().map(|label| label.text.as_str()).collect();
    assert!(["DZ", "0.2537", "PB1 PB2 D1D2"].iter().all(|text| texts.contains(text)), "{texts:?}");
    let v_o = drawn.symbols.iter().find(|placed| placed.symbol.name == "B3").unwrap();
    assert_eq!(v_o.symbol.signals, ["v_o"]);
}

#[test]
fn the_same_circuit_gives_the_same_bytes() {
    let circuit = common::circuit(&common::slideway(), &[]);
    let bytes = |format| render_drawing(&schematic(&circuit).drawing(), format, Theme::Light).unwrap();
    for format in [Format::Svg, Format::Png] {
        assert!(bytes(format) == bytes(format));
    }
    let text = String::from_utf8(bytes(Format::Svg)).unwrap();
    roxmltree::Document::parse(&text).unwrap();
}

/// Integrators, summers and pots; cords that go back lead into integrators only.
fn random_patch(kinds: &[u8], cords: &[(u16, u16)]) -> Patch {
    let count = kinds.len();
    let name = |index: usize| format!("E{index}");
    let mut builder = PatchBuilder::new("random").run(1.0, 1e-3);
    for (index, kind) in kinds.iter().enumerate() {
        let (first, second) = cords[index];
        let earlier = |pick: u16| match usize::from(pick) % (index + 1) {
            0 => "+100".to_owned(),
            other => name(other - 1),
        };
        let any = |pick: u16| name(usize::from(pick) % count);
        let made = match kind % 4 {
            0 => element("integrator").cords("x1", [&any(first)]).cords("x10", [&any(second)]),
            1 => element("summer").cords("x1", [&earlier(first), &earlier(second)]).cords("x10", ["-100"]),
            2 => element("pot").cord("in", &earlier(first)).set("setting", 0.5),
            _ => element("multiplier")
                .set("mode", "sum-of-squares")
                .cord("a", &earlier(first))
                .cord("b", &earlier(second)),
        };
        builder = builder.element(&name(index), made);
    }
    builder.build().unwrap_or_else(|report| panic!("{report}"))
}

proptest! {
    #![proptest_config(common::random_cases(40))]

    #[test]
    fn random_circuits_are_drawn_rightly(
        kinds in prop::collection::vec(any::<u8>(), 1..40),
        cords in prop::collection::vec(any::<(u16, u16)>(), 40),
    ) {
        let circuit = common::circuit(&random_patch(&kinds, &cords), &[]);
        check(&circuit, "random");
    }
}

#[test]
fn a_large_circuit_is_drawn() {
    let kinds: Vec<u8> = (0..300_u32).map(|index| (index * 7 % 11) as u8).collect();
    let cords: Vec<(u16, u16)> = (0..300_u16).map(|index| (index * 31 + 7, index * 57 + 3)).collect();
    let circuit = common::circuit(&random_patch(&kinds, &cords), &[]);
    check(&circuit, "large");
}
