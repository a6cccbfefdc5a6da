//! Cords and links of the panel connect the jacks that the circuit connects.

use std::collections::BTreeSet;

use super::{PatchPanel, slideway};
use crate::schematic_checks::{CordKey, cords_of};
use patchcord_core::circuit::Circuit;
use patchcord_draw::plot::{Ink, Primitive};
use patchcord_draw::schematic::{Board, Cord, Point};

/// Rounds a point to tenths of a pixel, as a key of a set.
fn rounded(point: Point) -> (i64, i64) {
    ((10.0 * point.0).round() as i64, (10.0 * point.1).round() as i64)
}

pub(super) fn every_cord_is_drawn_exactly_once(boards: &[PatchPanel]) {
    for (file, circuit, board) in boards {
        let key = |cord: &Cord| {
            (cord.from.clone(), cord.to.clone(), cord.input.clone(), cord.gain.map(|gain| gain.to_string()))
        };
        let mut drawn: Vec<CordKey> = board.cords.iter().map(key).collect();
        drawn.sort();
        assert_eq!(drawn, cords_of(circuit), "{file}");
        let lines = board.drawing().primitives.into_iter().filter(
            |primitive| matches!(primitive, Primitive::Line { ink: Ink::Cord(_), points, .. } if points.len() > 1),
        );
        assert_eq!(lines.count(), drawn.len(), "{file}");
    }
}

pub(super) fn every_cord_ends_in_its_jacks(boards: &[PatchPanel]) {
    for (file, circuit, board) in boards {
        for cord in &board.cords {
            assert_eq!(shown_connection(board, cord), expected_connection(circuit, cord), "{file}");
            assert_eq!(
                [cord.points.first(), cord.points.last()].map(|at| at.map(|at| rounded(*at))),
                cord.ends.map(|at| Some(rounded(at)))
            );
        }
        let ends = || board.cords.iter().flat_map(|cord| cord.ends.map(rounded));
        assert_eq!(ends().collect::<BTreeSet<_>>().len(), ends().count(), "{file}: a shared jack");
    }
}

/// Returns the driving element, the reading element and the jack label of a cord from the panel.
fn shown_connection(board: &Board, cord: &Cord) -> [String; 3] {
    let from = board.modules.iter().find(|module| module.outputs.contains(&cord.ends[0])).unwrap();
    let mut jacks = board
        .modules
        .iter()
        .flat_map(|module| module.inputs.iter().map(move |(label, at)| (module, label, at)));
    let (to, label, _) = jacks.find(|(.., at)| **at == cord.ends[1]).unwrap();
    let owner = to.note.split("of ").nth(1).unwrap_or(&to.name);
    let first = |words: &str| words.split(' ').next().unwrap().replace('−', "-");
    [first(&from.name), first(owner), label.clone()]
}

/// Returns the expected names and label from the data of the cord.
fn expected_connection(circuit: &Circuit, cord: &Cord) -> [String; 3] {
    let kind = circuit.elements().into_iter().find(|element| element.name == cord.to).unwrap().kind.name;
    let gains = circuit.machine().summer_gains;
    let label = match (kind, cord.input.as_str()) {
        ("diode-lower-of", _) => "cathode".to_owned(),
        ("diode-upper-of", _) => "anode".to_owned(),
        ("inverter", _) if !gains.is_empty() => "1".to_owned(),
        _ => jack_label(cord),
    };
    [cord.from.clone(), cord.to.clone(), label]
}

/// Returns the label of the jack of a cord.
fn jack_label(cord: &Cord) -> String {
    match (cord.input.as_str(), cord.gain) {
        ("x", Some(gain)) => gain.to_string(),
        (input, Some(gain)) => format!("{} {gain}", input.trim_end_matches("_x")),
        ("bias_plus", None) => "+VB".to_owned(),
        ("bias_minus", None) => "−VB".to_owned(),
        (input, None) => input.to_owned(),
    }
}

#[test]
fn each_potentiometer_of_the_dead_zone_has_its_bias_and_its_setting() {
    let (_, board) = slideway();
    for (name, jacks, note) in
        [("PB1", ["in", "+VB"], "0.2537 of DZ"), ("PB2", ["in", "−VB"], "0.2537 of DZ")]
    {
        let module = board.modules.iter().find(|module| module.name == name).unwrap();
        assert!(module.inputs.iter().map(|(label, _)| label).eq(jacks), "{module:?}");
        assert_eq!(module.note, note);
    }
}

#[test]
fn dead_zone_and_limiter_are_linked() {
    let (_, board) = slideway();
    let module = |name: &str| board.modules.iter().find(|module| module.name == name).unwrap();
    let cord = board.cords.iter().find(|cord| cord.from == "DZ").unwrap();
    assert!(module("DZ D1D2").outputs.contains(&cord.ends[0]));
    let input = |name: &str, jack: usize| module(name).inputs[jack].1;
    let output = |name: &str, jack: usize| module(name).outputs[jack];
    let junction = module("B2").inputs.iter().find(|(label, _)| label == "SJ").unwrap().1;
    let expected = [
        ("DZ", [input("PB1", 0), input("PB2", 0)]),
        ("DZ", [output("PB1", 0), input("DZ D1D2", 0)]),
        ("DZ", [output("PB2", 0), input("DZ D1D2", 1)]),
        ("B2", [output("B2", 1), input("PB3", 0)]),
        ("B2", [output("−100", 0), input("PB3", 1)]),
        ("B2", [output("PB3", 0), input("D5D6", 0)]),
        ("B2", [output("D5D6", 0), junction]),
    ];
    assert!(board.links.iter().map(|link| (link.of.as_str(), link.ends)).eq(expected));
    let adjustment = board.lists[0].rows.iter().find(|row| row.name == "PB3").unwrap();
    assert_eq!(adjustment.text, "turn until B2 stops at 10 V");
}
