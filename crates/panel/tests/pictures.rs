//! The pictures of the gallery: the curves of the first picture of each patch, as the engine computes them.
//!
//! `PATCHCORD_BLESS=1 cargo test -p patchcord-panel pictures` rewrites them.

mod path;

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;
use std::{env, fs, thread};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{RunSettings, run};
use patchcord_draw::plot::{Channel, Exposure, Picture, Strokes, strokes, thin};
use patchcord_panel::patches::{PATCHES, ShippedPatch};

use path::{Point, UNITS, curve, polygon};

/// Width and height of a picture, in half pixels.
const SIZE: [f64; 2] = [320.0, 192.0];
/// Width of the empty border, in half pixels.
const BORDER: f64 = 12.0;
/// The colours of the curves: red, green and blue.
const COLOURS: [[u8; 3]; 2] = [[0x7d, 0xf0, 0xb0], [0xff, 0xc6, 0x6b]];
/// The colour of the screen.
const SCREEN: [u8; 3] = [0x0b, 0x16, 0x13];
/// The largest size of a picture, in bytes. All pictures together are sent when the gallery opens.
const MAX_SIZE: usize = 5500;
/// The thickness of a curve, in half pixels.
const THICKNESS: f64 = 2.0;
/// Number of columns in which a curve against time keeps its extremes.
const COLUMNS: usize = 320;
/// The width of the columns of a dense curve against time, in half pixels. Their strokes touch each other.
const COLUMN: f64 = THICKNESS;
/// Distance that the parabolas of a curve keep from it, in half pixels.
const TOLERANCE: f64 = 0.3;
/// Distance that the lines of a dense curve against time keep from it, in half pixels.
const COARSE_TOLERANCE: f64 = 0.6;

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
    // A curve against a signal comes from all steps, because the samples would be the corners of a polygon.
    let settings = settings.with_curves(circuit.drawn_curves());
    let trace = run(&program, &settings).unwrap_or_else(|stopped| panic!("{}: {stopped}", shipped.path));
    let specs = circuit.picture_specs(patch.signals.keys());
    let mut picture =
        patchcord_draw::picture(&trace, &specs[0], None, &[]).unwrap_or_else(|error| panic!("{error}"));
    picture.channels.truncate(COLOURS.len());
    picture
}

/// A curve of a picture: the points of its lines in half pixels, and their times.
struct Curve {
    /// The lines between breaks and gaps.
    lines: Vec<Vec<Point>>,
    /// The times of the points of each line.
    times: Vec<Vec<f64>>,
}

impl Curve {
    /// Adds the path of the curve with its times.
    fn expose(&self, exposure: &mut Exposure) {
        for (line, times) in self.lines.iter().zip(&self.times) {
            for (ends, times) in line.windows(2).zip(times.windows(2)) {
                exposure.add(ends[0], ends[1], (times[1] - times[0]).abs());
            }
        }
    }
}

/// The curves of all channels. Channels of one axis have one scale.
fn curves(picture: &Picture) -> Vec<Curve> {
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
    let curves = channels.iter().map(|channel| {
        let up = &up[usize::from(channel.right)];
        let place = |(x, y): Point| (SIZE[0] / 2.0 + across.offset(x), SIZE[1] / 2.0 - up.offset(y));
        let time = |index: usize| channel.times.get(index).copied().unwrap_or(channel.points[index].0);
        let pieces = pieces(channel);
        Curve {
            lines: pieces
                .iter()
                .map(|piece| channel.points[piece.clone()].iter().copied().map(place).collect())
                .collect(),
            times: pieces.iter().map(|piece| piece.clone().map(time).collect()).collect(),
        }
    });
    curves.collect()
}

/// The ranges of the points of a channel between its breaks and the points that are not finite.
fn pieces(channel: &Channel) -> Vec<Range<usize>> {
    let mut ends: Vec<usize> = channel.breaks.iter().copied().chain([0, channel.points.len()]).collect();
    ends.sort_unstable();
    let is_finite =
        |index: &usize| channel.points[*index].0.is_finite() && channel.points[*index].1.is_finite();
    let mut pieces = Vec::new();
    for ends in ends.windows(2) {
        let finite: Vec<usize> = (ends[0]..ends[1]).filter(is_finite).collect();
        let chunks = finite.chunk_by(|index, next| index + 1 == *next);
        pieces.extend(chunks.map(|chunk| chunk[0]..chunk[0] + chunk.len()));
    }
    pieces
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

/// Whether the x of a line only rises or only falls.
fn is_against_time(line: &[Point]) -> bool {
    line.is_sorted_by(|one, next| one.0 <= next.0) || line.is_sorted_by(|one, next| one.0 >= next.0)
}

/// A line with what is visible of it.
fn thinned(line: &[Point]) -> Vec<Point> {
    if is_against_time(line) { thin(line, 0.0, SIZE[0], COLUMNS) } else { line.to_vec() }
}

/// A line from the lowest to the highest point of each column, or back if that is shorter.
fn in_columns(line: &[Point]) -> Vec<Point> {
    let column = |point: &Point| (point.0 / COLUMN).floor();
    let mut points: Vec<Point> = Vec::new();
    for chunk in line.chunk_by(|one, next| column(one) == column(next)) {
        let heights = || chunk.iter().map(|point| point.1);
        let (high, low) =
            (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
        let is_near_low = points.last().is_some_and(|last| (last.1 - low).abs() < (last.1 - high).abs());
        let ends = if is_near_low { [low, high] } else { [high, low] };
        points.extend(ends.map(|y| ((column(&chunk[0]) + 0.5) * COLUMN, y)));
    }
    points
}

/// A share of a colour on the screen, as SVG writes it.
fn mixed(colour: [u8; 3], share: f64) -> String {
    let part = |index: usize| {
        let (full, screen) = (f64::from(colour[index]), f64::from(SCREEN[index]));
        (screen + share * (full - screen)).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", part(0), part(1), part(2))
}

/// The SVG elements of a curve. A dense one against time has shades by the share of time, another dense one is
/// translucent. All others are round and opaque.
fn elements(shown: &Curve, colour: [u8; 3]) -> String {
    let expose = |exposure: &mut Exposure| shown.expose(exposure);
    let round = |lines: &[Vec<Point>]| lines.iter().map(|line| curve(line, TOLERANCE)).collect::<Vec<_>>();
    let full = mixed(colour, 1.0);
    let fine: Vec<Vec<Point>> = shown.lines.iter().map(|line| thinned(line)).collect();
    match strokes(&fine, THICKNESS, expose) {
        Strokes::Opaque(_) => element(&full, &round(&shown.lines).concat()),
        Strokes::Translucent(opacity, strokes) => {
            let paths: Vec<_> = round(&strokes).iter().map(|data| format!("<path d=\"{data}\"/>")).collect();
            format!("<g stroke=\"{full}\" stroke-opacity=\"{opacity}\">\n{}\n</g>\n", paths.join("\n"))
        }
        Strokes::Shades(_) => shaded(shown, colour),
    }
}

/// The SVG elements of a dense curve against time, one for each shade.
fn shaded(shown: &Curve, colour: [u8; 3]) -> String {
    let columns: Vec<Vec<Point>> = shown.lines.iter().map(|line| in_columns(line)).collect();
    let Strokes::Shades(shades) = strokes(&columns, THICKNESS, |exposure| shown.expose(exposure)) else {
        panic!("a curve that is dense is dense in columns as well")
    };
    let visible = shades.iter().filter(|shade| !shade.lines.is_empty());
    let data = |lines: &[Vec<Point>]| -> String {
        lines.iter().map(|line| polygon(&simplified(line, COARSE_TOLERANCE))).collect()
    };
    visible.map(|shade| element(&mixed(colour, shade.share), &data(&shade.lines))).collect()
}

/// The SVG element of a path.
fn element(colour: &str, data: &str) -> String {
    format!("<path stroke=\"{colour}\" d=\"{data}\"/>\n")
}

/// The picture of a patch in the gallery. The screen is dark as those of the scopes, so it suits light and dark pages.
fn drawn(shipped: &ShippedPatch) -> String {
    let [across, up] = SIZE.map(|length| UNITS * length);
    let mut svg = String::new();
    writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {across} {up}\">\n\
         <rect width=\"{across}\" height=\"{up}\" fill=\"{}\"/>\n\
         <g fill=\"none\" stroke-width=\"{}\" stroke-linejoin=\"round\" stroke-linecap=\"round\">",
        SIZE[0] / 2.0,
        SIZE[1] / 2.0,
        mixed(SCREEN, 1.0),
        UNITS * THICKNESS,
    )
    .unwrap();
    for (shown, colour) in curves(&first_picture(shipped)).iter().zip(COLOURS) {
        svg += &elements(shown, colour);
    }
    svg + "</g>\n</svg>\n"
}

/// Compares the stored picture of a patch with a new one, or stores the new one if PATCHCORD_BLESS is set.
fn check(shipped: &ShippedPatch) {
    let stem = shipped.path.trim_end_matches(".json");
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("page/pictures/{stem}.svg"));
    let fresh = drawn(shipped);
    assert!(fresh.len() < MAX_SIZE, "{stem}: {} bytes", fresh.len());
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
fn a_dense_picture_shows_where_it_is_dense() {
    let shipped = PATCHES.iter().find(|shipped| shipped.path == "thesis/fig-8-16.json").unwrap();
    let shown = &curves(&first_picture(shipped))[0];
    let elements = elements(shown, COLOURS[0]);
    let colours: Vec<&str> = elements.lines().filter_map(|line| line.split('"').nth(1)).collect();
    assert!((4..=6).contains(&colours.len()), "{colours:?}");
    // The last one is the colour of the curve, with the line of steady sliding.
    assert_eq!(colours.last(), Some(&"#7df0b0"));
    let green = |colour: &&str| u8::from_str_radix(&colour[3..5], 16).unwrap();
    assert!(colours.is_sorted_by(|one, next| green(one) < green(next)), "{colours:?}");
}

#[test]
fn pieces_end_at_breaks_and_gaps() {
    let points = [0.0, 1.0, 2.0, f64::NAN, 4.0, 5.0, 6.0].map(|x| (x, 1.0));
    let channel = Channel { breaks: vec![0, 5], ..Channel::line("x", points.to_vec()) };
    assert_eq!(pieces(&channel), [0..3, 4..5, 5..7]);
}

#[test]
fn columns_have_the_extremes_of_a_line() {
    let line = [(0.1, 5.0), (0.9, 9.0), (1.5, 7.0), (2.2, 8.0), (3.9, 2.0), (4.0, 3.0)];
    assert_eq!(in_columns(&line), [(1.0, 5.0), (1.0, 9.0), (3.0, 8.0), (3.0, 2.0), (5.0, 3.0), (5.0, 3.0)]);
}

#[test]
fn a_line_keeps_its_corners_only() {
    let line: Vec<Point> = (0..=20).map(|x| (f64::from(x), f64::from(10 - (x - 10_i32).abs()))).collect();
    assert_eq!(simplified(&line, 0.5), [(0.0, 0.0), (10.0, 10.0), (20.0, 0.0)]);
}
