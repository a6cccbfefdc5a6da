//! Legibility: dots at branches, arrows on one line only, and nothing across texts.

use std::collections::BTreeSet;

use super::{is_on, overlap};
use patchcord_draw::plot::{Area, Label, Primitive};
use patchcord_draw::schematic::{Diagram, Net, Point, Schematic};

/// Checks the dots and arrows of a diagram.
pub(crate) fn check(diagram: &Diagram, case: &str) {
    for net in &diagram.nets {
        let from = &diagram.symbols[net.from].symbol.name;
        assert_eq!(
            rounded(&net.route.dots),
            rounded(&branch_points(net)),
            "{case}: dots of the cord from {from}"
        );
        let others = diagram.nets.iter().filter(|other| !std::ptr::eq(*other, net));
        for line in others.flat_map(|other| &other.route.lines) {
            let is_dotted = net.route.dots.iter().any(|dot| is_on(*dot, line));
            assert!(!is_dotted, "{case}: a dot of the cord from {from} on {line:?}");
        }
        for arrow in &net.route.arrows {
            let on_own = net.route.lines.iter().any(|line| is_on(*arrow, line) && line[0].1 == line[1].1);
            assert!(on_own, "{case}: an arrow of the cord from {from} is on no line of it");
            let all = diagram.nets.iter().flat_map(|net| &net.route.lines);
            let mut verticals = all.filter(|[top, bottom]| top.0 == bottom.0);
            let is_near = |line: &[Point; 2]| {
                (line[0].0 - arrow.0).abs() < 6.0 && (line[0].1..=line[1].1).contains(&arrow.1)
            };
            assert!(!verticals.any(is_near), "{case}: an arrow of the cord from {from} on a crossing");
        }
    }
}

/// Rounds points to hundredths of a pixel, as keys of a set.
fn rounded(points: &[Point]) -> BTreeSet<(i64, i64)> {
    points.iter().map(|at| ((at.0 * 100.0) as i64, (at.1 * 100.0) as i64)).collect()
}

/// Returns the points from which the lines of a net continue in three or four directions.
fn branch_points(net: &Net) -> Vec<Point> {
    let lines = &net.route.lines;
    let xs: BTreeSet<_> = lines.iter().flatten().map(|at| at.0.to_bits()).collect();
    let ys: BTreeSet<_> = lines.iter().flatten().map(|at| at.1.to_bits()).collect();
    let points = xs.iter().flat_map(|x| ys.iter().map(|y| (f64::from_bits(*x), f64::from_bits(*y))));
    points.filter(|at| directions(*at, lines) > 2).collect()
}

/// Returns the number of directions in which lines continue from a point.
fn directions(at: Point, lines: &[[Point; 2]]) -> usize {
    let near = [(-0.25, 0.0), (0.25, 0.0), (0.0, -0.25), (0.0, 0.25)];
    let continues = |by: &(f64, f64)| {
        let next = (at.0 + by.0, at.1 + by.1);
        lines.iter().any(|line| is_on(at, line) && is_on(next, line))
    };
    near.iter().filter(|by| continues(by)).count()
}

/// Checks that no line, edge, flag, dot or arrow crosses a text of the sheet.
pub(crate) fn nothing_crosses_texts(schematic: &Schematic, case: &str) {
    let primitives = schematic.drawing().primitives;
    for label in primitives.iter().filter_map(Primitive::label).filter(|label| !label.text.is_empty()) {
        let crossing = primitives.iter().find(|primitive| crosses_text(primitive, label));
        assert!(crossing.is_none(), "{case}: \"{}\" is crossed by {crossing:?}", label.text);
    }
}

/// The height of capital letters in ems, for the font of the drawings.
const CAPITALS: f64 = 0.73;

/// Whether a primitive crosses the capital letters of a label.
fn crosses_text(primitive: &Primitive, label: &Label) -> bool {
    let Area { left, right, .. } = label.area();
    let (top, bottom) = (label.at.1 - CAPITALS * label.size, label.at.1);
    let area = Area { left, top, right, bottom };
    let cut = |points: &[Point]| points.windows(2).any(|line| cuts(line[0], line[1], &area));
    match primitive {
        Primitive::Line { points, .. } => cut(points),
        Primitive::Area { corners, .. } => cut(&[corners.as_slice(), &corners[..1]].concat()),
        Primitive::Disc { centre, radius, .. } if *radius < 5.0 => {
            overlap(&Area::around(*centre, *radius), &area)
        }
        Primitive::Ring { centre, radius, .. } => circle_crosses(*centre, *radius, &area),
        _ => false,
    }
}

/// Whether a circle passes through an area.
fn circle_crosses(centre: Point, radius: f64, area: &Area) -> bool {
    let nearest = (centre.0.clamp(area.left, area.right), centre.1.clamp(area.top, area.bottom));
    let corners = [area.left, area.right].map(|x| [area.top, area.bottom].map(|y| (x, y)));
    let far = |at: &Point| (at.0 - centre.0).hypot(at.1 - centre.1);
    far(&nearest) < radius && corners.iter().flatten().any(|corner| far(corner) > radius)
}

/// Whether a line passes through an area (Liang and Barsky clipping).
fn cuts(from: Point, to: Point, area: &Area) -> bool {
    let (mut begin, mut end) = (0.0_f64, 1.0_f64);
    for (at, extent, low, high) in
        [(from.0, to.0 - from.0, area.left, area.right), (from.1, to.1 - from.1, area.top, area.bottom)]
    {
        if extent == 0.0 && !(low..=high).contains(&at) {
            return false;
        }
        if extent != 0.0 {
            let (one, other) = ((low - at) / extent, (high - at) / extent);
            (begin, end) = (begin.max(one.min(other)), end.min(one.max(other)));
        }
    }
    begin < end
}

/// The side in pixels of the squares that are counted as used or empty.
const SQUARE: f64 = 40.0;

/// Returns the fraction of the squares of a diagram that are used.
pub(crate) fn used_fraction(diagram: &Diagram) -> f64 {
    let lines = diagram.nets.iter().flat_map(|net| &net.route.lines);
    let lines = lines.map(|[from, to]| Area { left: from.0, top: from.1, right: to.0, bottom: to.1 });
    let areas: Vec<Area> = diagram.symbols.iter().map(|placed| placed.area).chain(lines).collect();
    let squares = |low: f64, high: f64| (low / SQUARE) as i64..=(high / SQUARE) as i64;
    let used: BTreeSet<_> = areas
        .iter()
        .flat_map(|area| {
            squares(area.left, area.right)
                .flat_map(move |x| squares(area.top, area.bottom).map(move |y| (x, y)))
        })
        .collect();
    let span = |axis: fn(&(i64, i64)) -> i64| {
        let points = || used.iter().map(axis);
        (points().max().unwrap() - points().min().unwrap() + 1) as f64
    };
    used.len() as f64 / (span(|at| at.0) * span(|at| at.1))
}
