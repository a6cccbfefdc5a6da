//! Projects the points of a channel onto the screen and draws its trace.
//!
//! The points are split at breaks and gaps, projected, thinned to the resolution of the picture, and
//! clipped at the screen. All lengths are in picture units; an ordinary picture is 900 units wide.

use std::borrow::Cow;

use super::clip::{Area, Line, clip};
use super::colour::Colour;
use super::surface::Surface;
use super::thin::{drop_repeats, is_finite, is_monotonic, thin};
use super::{Channel, Exposure, Picture, PlotError, Strokes, palette, strokes};

/// The thickness of a trace.
const LINE_WIDTH: f64 = 1.6;

/// The radius of a dot. A line of one point is drawn as a disc with its thickness as radius.
pub(super) const DOT_RADIUS: f64 = 4.0;

/// The thickness of a faint trace.
const FAINT_LINE_WIDTH: f64 = 1.0;
/// The radius of a faint dot.
const FAINT_DOT_RADIUS: f64 = 2.2;

/// The thickness of the line in the legend.
const LEGEND_LINE_WIDTH: f64 = 2.4;

/// The resolution to which a trace is thinned; points closer than half a pixel are not visible.
const POINTS_PER_PIXEL: f64 = 2.0;

/// Positions are clamped to this magnitude, in picture units. It prevents overflow of distant points
/// and is large enough to keep the directions of lines.
const MAX_COORDINATE: f64 = 1e7;

/// Points outside the screen by at most this distance are drawn, because ranges may be exceeded by
/// the rounding of the data.
const EDGE_TOLERANCE: f64 = 0.25;

/// Returns the visible lines of a channel, in picture units. `unit` is the pixels per picture unit.
pub(super) fn lines(picture: &Picture, channel: &Channel, screen: Area, unit: f64) -> Vec<Line> {
    let projection = Projection { picture, channel, screen };
    let resolution = unit * POINTS_PER_PIXEL;
    let window = screen.grown(EDGE_TOLERANCE);
    segments(&channel.points, channel)
        .into_iter()
        .map(|segment| projection.thinned(segment, resolution))
        .flat_map(|segment| clip(&segment, window))
        .collect()
}

/// Returns the parts of a channel with their colours: the correct points, and in a pale colour the wrong ones.
pub(super) fn parts(channel: &Channel, colour: Colour) -> Vec<(Cow<'_, Channel>, Colour)> {
    if channel.wrong.is_empty() {
        return vec![(Cow::Borrowed(channel), colour)];
    }
    let mut is_wrong = vec![false; channel.points.len()];
    for range in &channel.wrong {
        is_wrong.get_mut(range.clone()).unwrap_or_default().fill(true);
    }
    // The correct part includes the first wrong point of a line, so that the line has no gap.
    let is_joint = |index: usize| index > 0 && !is_wrong[index - 1] && !channel.breaks.contains(&index);
    let correct = with_points(channel, |index| !is_wrong[index] || is_joint(index));
    let wrong = with_points(channel, |index| is_wrong[index]);
    vec![(Cow::Owned(wrong), palette::wrong(colour)), (Cow::Owned(correct), colour)]
}

/// Returns a channel in which the points that are not selected are gaps.
fn with_points(channel: &Channel, is_selected: impl Fn(usize) -> bool) -> Channel {
    let gap = (f64::NAN, f64::NAN);
    let points = channel.points.iter().enumerate();
    let points = points.map(|(index, point)| if is_selected(index) { *point } else { gap });
    Channel { points: points.collect(), ..channel.clone() }
}

/// Draws the lines, or dots, of the channel of a projection in a colour. Dense lines have shades or are translucent, so
/// that their density is visible.
pub(super) fn draw(
    projection: &Projection<'_>,
    lines: &[Line],
    colour: Colour,
    surface: &mut dyn Surface,
) -> Result<(), PlotError> {
    let channel = projection.channel;
    let width = width(channel);
    if channel.dots || channel.faint {
        return draw_opaque(lines, width, colour, surface);
    }
    match strokes(lines, width, |exposure| projection.expose(exposure)) {
        Strokes::Opaque(lines) => draw_opaque(lines, width, colour, surface),
        Strokes::Translucent(opacity, strokes) => {
            strokes.iter().try_for_each(|stroke| surface.translucent_line(stroke, width, colour, opacity))
        }
        Strokes::Shades(shades) => shades.iter().try_for_each(|shade| {
            draw_opaque(&shade.lines, width, palette::mixed_with_screen(colour, shade.share), surface)
        }),
    }
}

/// Draws lines, or dots, without the colours below them.
fn draw_opaque(
    lines: &[Line],
    width: f64,
    colour: Colour,
    surface: &mut dyn Surface,
) -> Result<(), PlotError> {
    lines.iter().try_for_each(|line| surface.line(line, width, colour))
}

/// Returns the thickness of a line, or the radius of a dot.
fn width(channel: &Channel) -> f64 {
    match (channel.dots, channel.faint) {
        (true, false) => DOT_RADIUS,
        (true, true) => FAINT_DOT_RADIUS,
        (false, false) => LINE_WIDTH,
        (false, true) => FAINT_LINE_WIDTH,
    }
}

/// Returns the thickness and the points of the sample of a trace in the legend.
///
/// The sample starts at the given position and is `length` long.
pub(super) fn legend_sample(channel: &Channel, (x, y): (f64, f64), length: f64) -> (f64, Line) {
    match (channel.dots, channel.faint) {
        (true, _) => (width(channel), vec![(x + length / 2.0, y)]),
        (false, true) => (FAINT_LINE_WIDTH, vec![(x, y), (x + length, y)]),
        (false, false) => (LEGEND_LINE_WIDTH, vec![(x, y), (x + length, y)]),
    }
}

/// Splits the points of a channel at its breaks and at points that are not finite.
///
/// If the channel is drawn as dots, every finite point is a segment.
pub(super) fn segments<'a>(points: &'a [(f64, f64)], channel: &Channel) -> Vec<&'a [(f64, f64)]> {
    if channel.dots {
        return points.chunks(1).filter(|point| is_finite(point[0])).collect();
    }
    let mut starts: Vec<usize> = channel
        .breaks
        .iter()
        .copied()
        .filter(|index| *index < points.len())
        .chain([0, points.len()])
        .collect();
    starts.sort_unstable();
    starts
        .windows(2)
        .flat_map(|ends| points[ends[0]..ends[1]].split(|point| !is_finite(*point)))
        .filter(|segment| !segment.is_empty())
        .collect()
}

/// The projection from the units of the axes to positions on the screen.
pub(super) struct Projection<'a> {
    /// The picture, for its axes.
    pub picture: &'a Picture,
    /// The channel, for the choice of its vertical axis.
    pub channel: &'a Channel,
    /// The screen in picture units.
    pub screen: Area,
}

impl Projection<'_> {
    /// Returns the position of a point in picture units.
    pub(super) fn project(&self, point: (f64, f64)) -> (f64, f64) {
        let x = self.picture.horizontal.fraction(point.0);
        let y = self.picture.axis_of(self.channel).fraction(point.1);
        (
            (self.screen.left + x * self.screen.width()).clamp(-MAX_COORDINATE, MAX_COORDINATE),
            (self.screen.bottom - y * self.screen.height()).clamp(-MAX_COORDINATE, MAX_COORDINATE),
        )
    }

    /// Adds the path of the channel with its times. Without times, x is the time.
    fn expose(&self, exposure: &mut Exposure) {
        let Channel { points, times, breaks, .. } = self.channel;
        let mut begins = vec![false; points.len()];
        for index in breaks.iter().filter(|index| **index < points.len()) {
            begins[*index] = true;
        }
        for (index, ends) in points.windows(2).enumerate() {
            if !begins[index + 1] && is_finite(ends[0]) && is_finite(ends[1]) {
                let even = (ends[1].0 - ends[0].0).abs();
                let seconds = times.get(index..index + 2).map_or(even, |times| times[1] - times[0]);
                exposure.add(self.project(ends[0]), self.project(ends[1]), seconds);
            }
        }
    }

    /// Returns the projected points without those that add nothing visible.
    fn thinned(&self, segment: &[(f64, f64)], resolution: f64) -> Line {
        let projected: Line = segment.iter().map(|point| self.project(*point)).collect();
        if is_monotonic(segment) {
            let columns = (self.screen.width() * resolution) as usize;
            thin(&projected, self.screen.left, self.screen.right, columns)
        } else {
            drop_repeats(&projected, (1.0 / resolution, 1.0 / resolution))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Axis;

    const SCREEN: Area = Area { left: 0.0, top: 0.0, right: 100.0, bottom: 100.0 };

    fn drawn(points: Vec<(f64, f64)>, breaks: Vec<usize>) -> Vec<Line> {
        let axis = || Axis::fit("x", "", [0.0, 10.0], 10);
        let channels = vec![Channel { breaks, ..Channel::line("", points) }];
        let picture = Picture { channels, ..Picture::new("", axis(), axis()) };
        lines(&picture, &picture.channels[0], SCREEN, 1.0)
    }

    #[test]
    fn points_are_projected_by_the_axes() {
        let lines = drawn(vec![(0.0, 0.0), (5.0, 10.0), (10.0, 5.0)], vec![]);
        assert_eq!(lines, [[(0.0, 100.0), (50.0, 0.0), (100.0, 50.0)]]);
    }

    #[test]
    fn breaks_and_gaps_split_the_line() {
        let points: Vec<(f64, f64)> = (0..10).map(|n| (f64::from(n), 5.0)).collect();
        assert_eq!(drawn(points.clone(), vec![3, 0, 7, 99, 3]).len(), 3);
        let mut gaps = points;
        gaps[4].1 = f64::NAN;
        gaps[8].0 = f64::INFINITY;
        let lengths: Vec<usize> = drawn(gaps, vec![]).iter().map(Vec::len).collect();
        assert_eq!(lengths, [4, 3, 1]);
    }

    #[test]
    fn dots_are_not_joined() {
        let picture = |channel| {
            let axis = || Axis::fit("x", "", [0.0, 10.0], 10);
            Picture { channels: vec![channel], ..Picture::new("", axis(), axis()) }
        };
        let points = vec![(0.0, 0.0), (f64::NAN, 1.0), (10.0, 10.0)];
        let picture = picture(Channel::dots("", points));
        let drawn = lines(&picture, &picture.channels[0], SCREEN, 1.0);
        assert_eq!(drawn, [[(0.0, 100.0)], [(100.0, 0.0)]]);
    }

    #[test]
    fn wrong_points_are_pale_and_joined_to_the_correct_ones() {
        let points: Vec<(f64, f64)> = (0..8).map(|n| (f64::from(n), 5.0)).collect();
        let line = Channel { breaks: vec![0, 4], wrong: vec![2..4, 4..8], ..Channel::line("", points) };
        let black = Colour(0, 0, 0);
        let parts = parts(&line, black);
        let finite = |channel: &Channel| channel.points.iter().filter(|point| is_finite(**point)).count();
        assert_eq!(parts.iter().map(|(part, _)| finite(part)).collect::<Vec<_>>(), [6, 3]);
        assert!(parts[0].1 != black && parts[1].1 == black);
        let correct = Channel { wrong: vec![], ..line.clone() };
        assert_eq!(super::parts(&correct, black).len(), 1);
    }

    #[test]
    fn a_trace_along_the_edge_is_drawn() {
        assert_eq!(drawn(vec![(0.0, 10.000001), (10.0, 10.000001)], vec![]).len(), 1);
    }

    #[test]
    fn distant_points_keep_the_direction() {
        let lines = drawn(vec![(5.0, 5.0), (5.0, f64::MAX)], vec![]);
        assert_eq!(lines, [[(50.0, 50.0), (50.0, -EDGE_TOLERANCE)]]);
    }

    #[test]
    fn spikes_of_long_records_are_drawn() {
        let mut points: Vec<(f64, f64)> = (0..200_000).map(|n| (f64::from(n) * 5e-5, 1.0)).collect();
        points[123_456].1 = 9.0;
        let lines = drawn(points, vec![]);
        assert!(lines[0].len() < 1000);
        assert!(lines[0].iter().any(|at| (at.1 - 10.0).abs() < 1e-9));
    }
}
