//! The patch panel by its data: every cord of the circuit, one jack each, on as many parts as the machine has.

mod common;

use std::collections::BTreeSet;

use patchcord::circuit::Circuit;
use patchcord::machines::Part;
use patchcord::schematic::{Board, Point};

fn board(circuit: &Circuit) -> Board {
    Board::new(circuit, "").unwrap_or_else(|error| panic!("{error}"))
}

/// A point to the tenth of a pixel, to be kept in a set.
fn place(at: Point) -> (i64, i64) {
    ((10.0 * at.0).round() as i64, (10.0 * at.1).round() as i64)
}

#[test]
fn every_cord_has_two_jacks_of_its_own() {
    for patch in ["relay-oscillator", "stick-slip-brake", "delay-line"]
        .map(common::patch)
        .into_iter()
        .chain([common::slideway()])
    {
        let circuit = common::circuit(&patch, &[]);
        let board = board(&circuit);
        let cords: usize = (0..circuit.elements().len()).map(|element| circuit.cords(element).len()).sum();
        assert_eq!(board.cords.len(), cords, "{}", patch.file());
        let outputs: BTreeSet<_> =
            board.modules.iter().flat_map(|module| &module.outputs).map(|at| place(*at)).collect();
        let inputs: BTreeSet<_> =
            board.modules.iter().flat_map(|module| &module.inputs).map(|(_, at)| place(*at)).collect();
        let mut taken = BTreeSet::new();
        for cord in &board.cords {
            assert!(
                outputs.contains(&place(cord.ends[0])) && inputs.contains(&place(cord.ends[1])),
                "{cord:?}"
            );
            assert!(cord.ends.iter().all(|end| taken.insert(place(*end))), "{cord:?} shares a jack");
        }
    }
}

#[test]
fn the_1451_shows_all_its_parts() {
    let circuit = common::circuit(&common::slideway(), &[]);
    let board = board(&circuit);
    let parts: usize = Part::ALL.iter().filter_map(|part| circuit.machine().count(*part)).sum();
    // Three references, two drives and a key switch stand beside the parts.
    assert_eq!(board.modules.len(), parts + 6);
    let names: Vec<&str> = board.modules.iter().map(|module| module.name.as_str()).collect();
    for name in ["A6", "DZ PB1", "PB2", "PB3", "D1D2", "U D3D4", "D5D6", "M1", "KS1", "+100"] {
        assert_eq!(names.iter().filter(|other| **other == name).count(), 1, "{name} among {names:?}");
    }
}

#[test]
fn modules_stand_side_by_side_on_the_sheet() {
    let circuit = common::circuit(&common::slideway(), &[]);
    let board = board(&circuit);
    let drawing = board.drawing();
    for (index, module) in board.modules.iter().enumerate() {
        let [(left, top), (right, bottom)] = module.corners;
        assert!(left > 0.0 && top > 0.0 && right < drawing.width && bottom < drawing.height, "{module:?}");
        let apart = |other: &patchcord::schematic::Module| {
            let [(l, t), (r, b)] = other.corners;
            r <= left || right <= l || b <= top || bottom <= t
        };
        assert!(board.modules[index + 1..].iter().all(apart), "{module:?}");
        for at in module.inputs.iter().map(|(_, at)| at).chain(&module.outputs) {
            assert!(left < at.0 && at.0 < right && top < at.1 && at.1 < bottom, "{module:?}");
        }
    }
}
