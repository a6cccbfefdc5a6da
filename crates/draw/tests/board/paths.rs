//! Cords have clear paths and colours: they avoid texts, jacks and each other.

use super::{PatchPanel, slideway};
use patchcord_draw::plot::{Ink, Label, Primitive};
use patchcord_draw::schematic::{Board, Cord, Module, Point};

/// Whether two points are closer than a distance.
fn near(one: Point, other: Point, distance: f64) -> bool {
    (one.0 - other.0).hypot(one.1 - other.1) < distance
}

/// Whether two cords end at one module.
fn share_a_module(board: &Board, one: &Cord, other: &Cord) -> bool {
    let at = |module: &Module, cord: &Cord| module.jacks().any(|jack| cord.ends.contains(&jack));
    board.modules.iter().any(|module| at(module, one) && at(module, other))
}

pub(super) fn cords_of_one_output_share_a_colour_and_neighbours_differ(boards: &[PatchPanel]) {
    for (file, _, board) in boards {
        for (index, cord) in board.cords.iter().enumerate() {
            for other in &board.cords[index + 1..] {
                let is_near = cord.ends.iter().any(|one| other.ends.iter().any(|end| near(*one, *end, 30.0)));
                if cord.from == other.from {
                    assert_eq!(cord.colour, other.colour, "{file}");
                } else if is_near || share_a_module(board, cord, other) {
                    assert_ne!(cord.colour, other.colour, "{file}: {} and {}", cord.from, other.from);
                }
            }
        }
    }
}

pub(super) fn cords_avoid_texts(boards: &[PatchPanel]) {
    let mut crossed = Vec::new();
    for (file, _, board) in boards {
        let primitives = board.drawing().primitives;
        let texts: Vec<_> = primitives.iter().filter_map(Primitive::label).collect();
        for cord in &board.cords {
            let on = |label: &&&Label| {
                let area = label.area();
                cord.points
                    .iter()
                    .any(|(x, y)| (area.left..area.right).contains(x) && (area.top..area.bottom).contains(y))
            };
            let texts = texts.iter().filter(on).map(|label| label.text.clone());
            crossed.extend(texts.map(|text| format!("{file}: {} to {} over {text}", cord.from, cord.to)));
        }
    }
    assert!(crossed.is_empty(), "{crossed:#?}");
}

/// Returns the paths of cords and links with a name for each.
fn paths(board: &Board) -> Vec<(String, [Point; 2], Vec<Point>)> {
    let cords = board.cords.iter();
    let cords = cords.map(|cord| (format!("{} to {}", cord.from, cord.to), cord.ends, dense(&cord.points)));
    let links = board.links.iter();
    let links = links.map(|link| (format!("link of {}", link.of), link.ends, dense(&link.points)));
    cords.chain(links).collect()
}

/// Returns points on a line at most two pixels apart.
fn dense(points: &[Point]) -> Vec<Point> {
    let mut dense = vec![points[0]];
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let count = ((to.0 - from.0).hypot(to.1 - from.1) / 2.0).ceil().max(1.0);
        let point =
            |fraction: f64| (from.0 + fraction * (to.0 - from.0), from.1 + fraction * (to.1 - from.1));
        dense.extend((1..=count as usize).map(|index| point(index as f64 / count)));
    }
    dense
}

pub(super) fn cords_overlap_for_short_sections_only(boards: &[PatchPanel]) {
    let mut covered = Vec::new();
    for (file, _, board) in boards {
        let paths = paths(board);
        for (index, (name, ends, path)) in paths.iter().enumerate() {
            for (other, others, other_path) in &paths[index + 1..] {
                let shared = |at: &Point| ends.contains(at);
                let is_free = |at: &&Point| !others.iter().any(|end| shared(end) && near(*end, **at, 24.0));
                let on = |at: &&Point| other_path.iter().any(|point| near(**at, *point, 4.0));
                let length = 2 * path.iter().filter(is_free).filter(on).count();
                if length > 40 {
                    covered.push(format!("{file}: {name} on {other} for {length} px"));
                }
            }
        }
    }
    assert!(covered.is_empty(), "{covered:#?}");
}

pub(super) fn no_cord_covers_another_jack(boards: &[PatchPanel]) {
    let mut covered = Vec::new();
    for (file, _, board) in boards {
        for (name, ends, path) in paths(board) {
            for module in &board.modules {
                let others = module.jacks().filter(|jack| !ends.contains(jack));
                let hidden = others.filter(|jack| path.iter().any(|at| near(*at, *jack, 6.0)));
                covered.extend(hidden.map(|jack| format!("{file}: {name} over {}, {jack:?}", module.name)));
            }
        }
    }
    assert!(covered.is_empty(), "{covered:#?}");
}

#[test]
fn jacks_and_plugs_are_in_front_of_all_cords() {
    let (_, board) = slideway();
    let primitives = board.drawing().primitives;
    let is_cord = |primitive: &Primitive| matches!(primitive, Primitive::Line { ink: Ink::Cord(_), .. });
    let is_jack =
        |primitive: &Primitive| matches!(primitive, Primitive::Ring { .. } | Primitive::Disc { .. });
    assert!(primitives.iter().rposition(is_cord) < primitives.iter().position(is_jack));
}
