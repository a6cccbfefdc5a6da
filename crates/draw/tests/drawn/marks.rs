//! What a reader goes by: dots where a cord branches, arrows that hang on one line, texts that nothing runs through.

use std::collections::BTreeSet;

use super::{lies_on, overlap};
use patchcord_draw::plot::{Area, Label, Stroke};
use patchcord_draw::schematic::{Diagram, Net, Point, Schematic};

/// Looks at the dots and arrows of a diagram.
pub fn check(drawn: &Diagram, what: &str) {
    for net in &drawn.nets {
        let from = &drawn.symbols[net.from].symbol.name;
        assert_eq!(whole(&net.route.dots), whole(&branchings(net)), "{what}: dots of the cord from {from}");
        let others = drawn.nets.iter().filter(|other| !std::ptr::eq(*other, net));
        for line in others.flat_map(|other| &other.route.lines) {
            let is_dotted = net.route.dots.iter().any(|dot| lies_on(*dot, line));
            assert!(!is_dotted, "{what}: a dot of the cord from {from} on {line:?}");
        }
        for arrow in &net.route.arrows {
            let on_own = net.route.lines.iter().any(|line| lies_on(*arrow, line) && line[0].1 == line[1].1);
            assert!(on_own, "{what}: an arrow of the cord from {from} hangs nowhere");
            let all = drawn.nets.iter().flat_map(|net| &net.route.lines);
            let mut uprights = all.filter(|[top, bottom]| top.0 == bottom.0);
            let is_near = |line: &[Point; 2]| {
                (line[0].0 - arrow.0).abs() < 6.0 && (line[0].1..=line[1].1).contains(&arrow.1)
            };
            assert!(!uprights.any(is_near), "{what}: an arrow of the cord from {from} on a crossing");
        }
    }
}

fn whole(places: &[Point]) -> BTreeSet<(i64, i64)> {
    places.iter().map(|at| ((at.0 * 100.0) as i64, (at.1 * 100.0) as i64)).collect()
}

/// Places from which the lines of a net go on in three or four directions.
fn branchings(net: &Net) -> Vec<Point> {
    let lines = &net.route.lines;
    let xs: BTreeSet<_> = lines.iter().flatten().map(|at| at.0.to_bits()).collect();
    let ys: BTreeSet<_> = lines.iter().flatten().map(|at| at.1.to_bits()).collect();
    let places = xs.iter().flat_map(|x| ys.iter().map(|y| (f64::from_bits(*x), f64::from_bits(*y))));
    places.filter(|at| directions(*at, lines) > 2).collect()
}

fn directions(at: Point, lines: &[[Point; 2]]) -> usize {
    let near = [(-0.25, 0.0), (0.25, 0.0), (0.0, -0.25), (0.0, 0.25)];
    let goes = |by: &(f64, f64)| {
        let there = (at.0 + by.0, at.1 + by.1);
        lines.iter().any(|line| lies_on(at, line) && lies_on(there, line))
    };
    near.iter().filter(|by| goes(by)).count()
}

/// No line, edge, flag, dot or arrow runs through a text of the sheet.
pub fn nothing_runs_through_texts(drawn: &Schematic, what: &str) {
    let marks = drawn.drawing().marks;
    let labels = marks.iter().filter_map(|mark| match mark {
        Stroke::Text(label) if !label.text.is_empty() => Some(label),
        _ => None,
    });
    for label in labels {
        let through = marks.iter().find(|mark| runs_through(mark, label));
        assert!(through.is_none(), "{what}: \"{}\" is run through by {through:?}", label.text);
    }
}

/// Height of capital letters, in ems.
const CAPITALS: f64 = 0.73;

fn runs_through(mark: &Stroke, label: &Label) -> bool {
    let Area { left, right, .. } = label.area();
    let (top, bottom) = (label.at.1 - CAPITALS * label.size, label.at.1);
    let area = Area { left, top, right, bottom };
    let cut = |points: &[Point]| points.windows(2).any(|line| cuts(line[0], line[1], &area));
    match mark {
        Stroke::Line { points, .. } => cut(points),
        Stroke::Area { corners, .. } => cut(&[corners.as_slice(), &corners[..1]].concat()),
        Stroke::Disc { centre, radius, .. } if *radius < 5.0 => overlap(&about(*centre, *radius), &area),
        Stroke::Disc { .. } | Stroke::Text(_) => false,
        Stroke::Ring { centre, radius, .. } => rounds(*centre, *radius, &area),
    }
}

fn about(centre: Point, radius: f64) -> Area {
    Area {
        left: centre.0 - radius,
        top: centre.1 - radius,
        right: centre.0 + radius,
        bottom: centre.1 + radius,
    }
}

/// Whether a circle passes through an area.
fn rounds(centre: Point, radius: f64, area: &Area) -> bool {
    let nearest = (centre.0.clamp(area.left, area.right), centre.1.clamp(area.top, area.bottom));
    let corners = [area.left, area.right].map(|x| [area.top, area.bottom].map(|y| (x, y)));
    let far = |at: &Point| (at.0 - centre.0).hypot(at.1 - centre.1);
    far(&nearest) < radius && corners.iter().flatten().any(|corner| far(corner) > radius)
}

/// Whether a line passes through an area: what the four sides leave of it.
fn cuts(from: Point, to: Point, area: &Area) -> bool {
    let (mut begin, mut end) = (0.0_f64, 1.0_f64);
    for (at, way, low, high) in
        [(from.0, to.0 - from.0, area.left, area.right), (from.1, to.1 - from.1, area.top, area.bottom)]
    {
        if way == 0.0 && !(low..=high).contains(&at) {
            return false;
        }
        if way != 0.0 {
            let (one, other) = ((low - at) / way, (high - at) / way);
            (begin, end) = (begin.max(one.min(other)), end.min(one.max(other)));
        }
    }
    begin < end
}

/// Squares of this side are counted as used or empty.
const SQUARE: f64 = 40.0;

/// The share of a diagram in which something stands.
pub fn used_share(drawn: &Diagram) -> f64 {
    let lines = drawn.nets.iter().flat_map(|net| &net.route.lines);
    let lines = lines.map(|[from, to]| Area { left: from.0, top: from.1, right: to.0, bottom: to.1 });
    let areas: Vec<Area> = drawn.symbols.iter().map(|placed| placed.area).chain(lines).collect();
    let squares = |low: f64, high: f64| (low / SQUARE) as i64..=(high / SQUARE) as i64;
    let used: BTreeSet<_> = areas
        .iter()
        .flat_map(|area| {
            squares(area.left, area.right)
                .flat_map(move |x| squares(area.top, area.bottom).map(move |y| (x, y)))
        })
        .collect();
    let span = |axis: fn(&(i64, i64)) -> i64| {
        let places = || used.iter().map(axis);
        (places().max().unwrap() - places().min().unwrap() + 1) as f64
    };
    used.len() as f64 / (span(|at| at.0) * span(|at| at.1))
}
