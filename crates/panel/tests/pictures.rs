//! The pictures of the gallery: the curves of the first picture of each patch, as the engine computes them.
//!
//! `PATCHCORD_BLESS=1 cargo test -p patchcord-panel pictures` rewrites them.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs, thread};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{RunSettings, run};
use patchcord_draw::plot::{Channel, Picture, thin};
use patchcord_panel::patches::{PATCHES, ShippedPatch};

/// Width and height of a picture, in half pixels.
const SIZE: [f64; 2] = [320.0, 192.0];
/// Width of the empty border, in half pixels.
const BORDER: f64 = 12.0;
/// The colours of the curves.
const COLOURS: [&str; 2] = ["#7df0b0", "#ffc66b"];
/// The largest size of the curves of a picture, in bytes. All pictures together are sent when the gallery opens.
const MAX_CURVES: usize = 2600;
/// Number of columns in which a curve against time keeps its extremes.
const COLUMNS: usize = 160;
/// Distance that the simplest line keeps from all points, in half pixels.
const TOLERANCE: f64 = 0.6;

/// A point in half pixels.
type Point = (f64, f64);

/// A range of values, and the value of half a pixel.
struct Scale {
    /// The value in the middle.
    middle: f64,
    /// The value of half a pixel; 0 if all values are equal.
    per_unit: f64,
}

impl Scale {
    /// The scale at which finite values fill a length.
    fn of(values: impl Iterator<Item = f64>, length: f64) -> Scale {
        let finite = values.filter(|value| value.is_finite());
        let (low, high) = finite
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        if low > high {
            return Scale { middle: 0.0, per_unit: 0.0 };
        }
        Scale { middle: f64::midpoint(low, high), per_unit: (high - low) / (length - 2.0 * BORDER) }
    }

    /// The distance of a value from the middle, in half pixels.
    fn offset(&self, value: f64) -> f64 {
        if self.per_unit > 0.0 { (value - self.middle) / self.per_unit } else { 0.0 }
    }
}

/// The first picture of a patch.
fn first_picture(shipped: &ShippedPatch) -> Picture {
    let patch = Patch::parse(shipped.path, shipped.text).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let settings = RunSettings::of(&circuit).unwrap_or_else(|error| panic!("{error}"));
    let trace = run(&program, &settings).unwrap_or_else(|stopped| panic!("{}: {stopped}", shipped.path));
    let specs = circuit.picture_specs(patch.signals.keys());
    let mut picture =
        patchcord_draw::picture(&trace, &specs[0], None, &[]).unwrap_or_else(|error| panic!("{error}"));
    picture.channels.truncate(COLOURS.len());
    picture
}

/// The lines of all channels, in half pixels. Channels of one axis have one scale.
fn lines(picture: &Picture) -> Vec<Vec<Vec<Point>>> {
    let channels = &picture.channels;
    let points = |right| {
        let channels = channels.iter().filter(move |channel| channel.right == right);
        channels.flat_map(|channel| &channel.points)
    };
    let all = channels.iter().flat_map(|channel| &channel.points);
    let mut across = Scale::of(all.map(|point| point.0), SIZE[0]);
    let mut up = [false, true].map(|right| Scale::of(points(right).map(|point| point.1), SIZE[1]));
    if picture.equal_scales {
        across.per_unit = across.per_unit.max(up[0].per_unit);
        up[0].per_unit = across.per_unit;
    }
    let lines = channels.iter().map(|channel| {
        let up = &up[usize::from(channel.right)];
        let place = |(x, y): Point| (SIZE[0] / 2.0 + across.offset(x), SIZE[1] / 2.0 - up.offset(y));
        pieces(channel).map(|piece| piece.iter().copied().map(place).collect()).collect()
    });
    lines.collect()
}

/// The pieces of a channel between its breaks and the points that are not finite.
fn pieces(channel: &Channel) -> impl Iterator<Item = &[Point]> {
    let mut ends: Vec<usize> = channel.breaks.iter().copied().chain([0, channel.points.len()]).collect();
    ends.sort_unstable();
    let ranges: Vec<_> = ends.windows(2).map(|ends| ends[0]..ends[1]).collect();
    let runs = ranges.into_iter().map(move |range| &channel.points[range]);
    let is_gap = |point: &Point| !(point.0.is_finite() && point.1.is_finite());
    runs.flat_map(move |run| run.split(is_gap)).filter(|piece| !piece.is_empty())
}

/// The square of the distance of a point from the line between two points.
fn squared_distance(point: Point, from: Point, to: Point) -> f64 {
    let (along, off) = ((to.0 - from.0, to.1 - from.1), (point.0 - from.0, point.1 - from.1));
    let length = along.0 * along.0 + along.1 * along.1;
    let share = (off.0 * along.0 + off.1 * along.1) / length;
    let share = if length > 0.0 { share.clamp(0.0, 1.0) } else { 0.0 };
    let rest = (off.0 - share * along.0, off.1 - share * along.1);
    rest.0 * rest.0 + rest.1 * rest.1
}

/// The points of a line that are necessary to stay within a distance of all points, by the method of Douglas and
/// Peucker.
fn simplified(line: &[Point], tolerance: f64) -> Vec<Point> {
    let last = line.len() - 1;
    let mut kept = vec![false; line.len()];
    (kept[0], kept[last]) = (true, true);
    let mut spans = vec![(0, last)];
    while let Some((from, to)) = spans.pop() {
        let distances =
            (from + 1..to).map(|index| (squared_distance(line[index], line[from], line[to]), index));
        let farthest = distances.max_by(|one, other| one.0.total_cmp(&other.0));
        if let Some((distance, index)) = farthest
            && distance > tolerance * tolerance
        {
            kept[index] = true;
            spans.extend([(from, index), (index, to)]);
        }
    }
    line.iter().zip(kept).filter_map(|(point, is_kept)| is_kept.then_some(*point)).collect()
}

/// The data of an SVG path along a line, in whole half pixels.
fn path(line: &[Point]) -> String {
    let mut rounded: Vec<(i64, i64)> =
        line.iter().map(|(x, y)| ((x + 0.5).floor() as i64, (y + 0.5).floor() as i64)).collect();
    rounded.dedup();
    let mut data = format!("M{} {}", rounded[0].0, rounded[0].1);
    let mut command = "l";
    for ends in rounded.windows(2) {
        let (x, y) = (ends[1].0 - ends[0].0, ends[1].1 - ends[0].1);
        // A minus sign separates two numbers. After a command no separator is needed.
        let separator = if command == " " && x < 0 { "" } else { command };
        let between = if y < 0 { "" } else { " " };
        write!(data, "{separator}{x}{between}{y}").unwrap();
        command = " ";
    }
    data
}

/// The data of the paths of all channels, together at most of the largest size. Lines whose points have rising x keep
/// the extremes of each column; others lose detail everywhere.
fn paths(channels: &[Vec<Vec<Point>>]) -> Vec<String> {
    let is_rising = |line: &Vec<Point>| line.is_sorted_by(|one, next| one.0 <= next.0);
    let is_falling = |line: &Vec<Point>| line.is_sorted_by(|one, next| one.0 >= next.0);
    let keeps_extremes = channels.iter().flatten().all(|line| is_rising(line) || is_falling(line));
    let (mut columns, mut tolerance) = (COLUMNS, TOLERANCE);
    loop {
        let draw = |line: &Vec<Point>| {
            let thinned = if keeps_extremes { thin(line, 0.0, SIZE[0], columns) } else { line.clone() };
            path(&simplified(&thinned, tolerance))
        };
        let paths: Vec<String> = channels.iter().map(|lines| lines.iter().map(draw).collect()).collect();
        if paths.iter().map(String::len).sum::<usize>() <= MAX_CURVES {
            return paths;
        }
        if keeps_extremes {
            columns = columns * 4 / 5;
        } else {
            tolerance *= 1.25;
        }
    }
}

/// The picture of a patch in the gallery. The screen is dark as those of the scopes, so it suits light and dark pages.
fn drawn(shipped: &ShippedPatch) -> String {
    let paths = paths(&lines(&first_picture(shipped)));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {} {}\">\n\
         <rect width=\"{}\" height=\"{}\" fill=\"#0b1613\"/>\n\
         <g fill=\"none\" stroke-width=\"2\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n",
        SIZE[0] / 2.0,
        SIZE[1] / 2.0,
        SIZE[0],
        SIZE[1],
        SIZE[0],
        SIZE[1],
    );
    for (data, colour) in paths.iter().zip(COLOURS) {
        writeln!(svg, "<path stroke=\"{colour}\" d=\"{data}\"/>").unwrap();
    }
    svg + "</g>\n</svg>\n"
}

/// Compares the stored picture of a patch with a new one, or stores the new one if PATCHCORD_BLESS is set.
fn check(shipped: &ShippedPatch) {
    let stem = shipped.path.trim_end_matches(".json");
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("page/pictures/{stem}.svg"));
    let fresh = drawn(shipped);
    assert!(fresh.len() < 3000, "{stem}: {} bytes", fresh.len());
    if env::var_os("PATCHCORD_BLESS").is_some() {
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(&file, &fresh).unwrap();
    }
    let stored = fs::read_to_string(&file).unwrap_or_default();
    let file = file.display();
    assert!(stored == fresh, "{file} is stale: PATCHCORD_BLESS=1 cargo test -p patchcord-panel rewrites it");
}

#[test]
fn every_patch_of_the_gallery_has_its_picture() {
    thread::scope(|scope| {
        for shipped in PATCHES {
            scope.spawn(|| check(shipped));
        }
    });
}

#[test]
fn a_line_keeps_its_corners_only() {
    let line: Vec<Point> = (0..=20).map(|x| (f64::from(x), f64::from(10 - (x - 10_i32).abs()))).collect();
    assert_eq!(simplified(&line, 0.5), [(0.0, 0.0), (10.0, 10.0), (20.0, 0.0)]);
    assert_eq!(path(&simplified(&line, 0.5)), "M0 0l10 10 10-10");
    assert_eq!(path(&[(3.0, 4.0)]), "M3 4");
}
