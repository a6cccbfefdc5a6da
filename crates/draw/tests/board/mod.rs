//! The patch panel shows every cord of the circuit with its jacks on the parts of the machine.

mod connections;
mod modules;
mod paths;

use std::path::PathBuf;
use std::sync::LazyLock;
use std::thread;

use self::connections::{every_cord_ends_in_its_jacks, every_cord_is_drawn_exactly_once};
use self::modules::{all_modules_of_a_row_have_the_same_jacks, every_given_setting_is_on_the_sheet};
use self::paths::{
    cords_avoid_texts, cords_of_one_output_share_a_colour_and_neighbours_differ,
    cords_overlap_for_short_sections_only, no_cord_covers_another_jack,
};
use crate::common::files::{representative_files, shipped_files, test_patch_files};
use patchcord_core::circuit::Circuit;
use patchcord_core::patch::{ElementBuilder, PatchBuilder};
use patchcord_draw::schematic::Board;

/// Returns the panel of a circuit.
fn board(circuit: &Circuit) -> Board {
    Board::new(circuit, "").unwrap_or_else(|error| panic!("{error}"))
}

/// A file, its circuit and its panel.
type PatchPanel = (String, Circuit, Board);

/// Returns the panels of files, in their order. Each is drawn on a thread.
fn boards(files: Vec<PathBuf>) -> Vec<PatchPanel> {
    let panel = |file: PathBuf| {
        let circuit = crate::common::circuit(&crate::common::patch_of(&file), &[]);
        let board = board(&circuit);
        (file.display().to_string(), circuit, board)
    };
    thread::scope(|scope| {
        let panels: Vec<_> = files.into_iter().map(|file| scope.spawn(move || panel(file))).collect();
        panels.into_iter().map(|panel| panel.join().unwrap()).collect()
    })
}

/// The panels of a few patches.
static FEW: LazyLock<Vec<PatchPanel>> =
    LazyLock::new(|| boards([representative_files(), test_patch_files()].concat()));
/// The panels of all shipped patches.
static ALL: LazyLock<Vec<PatchPanel>> = LazyLock::new(|| boards(shipped_files()));

/// The circuit and the panel of the slideway.
fn slideway() -> (&'static Circuit, &'static Board) {
    let panel = FEW.iter().find(|(file, ..)| file.ends_with("fig-8-16.json"));
    panel.map(|(_, circuit, board)| (circuit, board)).unwrap()
}

#[test]
fn the_progress_counts_every_cord() {
    let (circuit, board) = slideway();
    let mut reports = Vec::new();
    let again = Board::with_progress(circuit, "", &mut |done, all| reports.push((done, all)));
    assert_eq!(again.as_ref(), Ok(board));
    let all = reports.len();
    assert!(all >= board.cords.len() + board.links.len());
    assert_eq!(reports, (0..all).map(|done| (done, all)).collect::<Vec<_>>());
}

/// Defines a test of each check on a few panels, and a slow one on all panels.
macro_rules! on_boards {
    ($($check:ident),* $(,)?) => {
        mod few {
            $(#[test]
            fn $check() {
                super::$check(&super::FEW);
            })*
        }
        mod all {
            $(#[test]
            #[ignore = "the boards of all patches take a minute"]
            fn $check() {
                super::$check(&super::ALL);
            })*
        }
    };
}

on_boards!(
    every_cord_is_drawn_exactly_once,
    every_cord_ends_in_its_jacks,
    cords_of_one_output_share_a_colour_and_neighbours_differ,
    cords_avoid_texts,
    cords_overlap_for_short_sections_only,
    no_cord_covers_another_jack,
    every_given_setting_is_on_the_sheet,
    all_modules_of_a_row_have_the_same_jacks,
);

/// A ring of integrators. Each reads its two neighbours and itself, so it has seven cords.
fn ring(cells: usize) -> Circuit {
    let cell = |patch: PatchBuilder, index: usize| {
        let name = |letter: &str, index: usize| format!("{letter}{}", index % cells);
        let pot = |from: String| ElementBuilder::new("pot").cord("in", &from).set("setting", 0.3);
        let [left, right, own] = ["PL", "PR", "PS"].map(|letters| name(letters, index));
        patch
            .element(&name("A", index), ElementBuilder::new("integrator").cords("x1", [&left, &right, &own]))
            .element(&name("S", index), ElementBuilder::new("inverter").cord("in", &name("A", index)))
            .element(&left, pot(name("A", index + cells - 1)))
            .element(&right, pot(name("A", index + 1)))
            .element(&own, pot(name("S", index)))
    };
    let patch = (0..cells).fold(PatchBuilder::new("Ring"), cell).build();
    Circuit::new(&patch.unwrap_or_else(|report| panic!("{report}"))).unwrap()
}

#[test]
fn a_panel_with_more_than_two_hundred_cords_is_complete() {
    let circuit = ring(30);
    let board = board(&circuit);
    assert_eq!(board.cords.len(), 210);
    let panels = [("ring".to_owned(), circuit, board)];
    every_cord_is_drawn_exactly_once(&panels);
    every_cord_ends_in_its_jacks(&panels);
}
