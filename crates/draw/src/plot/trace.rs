use super::clip::{Area, clipped};
use super::surface::Surface;
use super::thin::{drop_repeats, is_finite, is_one_way, thin};
use super::{Channel, Picture, PlotError, palette};

/// Thickness of a trace.
const WIDTH: f64 = 1.6;

/// Radius of a dot: a line of one point is a disc as wide as its thickness to either side.
pub(super) const DOT: f64 = 4.0;

/// The same of what stands behind.
const FAINT_WIDTH: f64 = 1.0;
const FAINT_DOT: f64 = 2.2;

/// Thickness of the sample of a trace in the legend.
const SAMPLE_WIDTH: f64 = 2.4;

/// Points closer than half a pixel add nothing to a trace.
const POINTS_PER_PIXEL: f64 = 2.0;

/// Positions are held this near to the screen, in picture units, so that far
/// points do not overflow while directions stay right.
const FAR: f64 = 1e7;

/// Points this near outside the edge are still drawn: ranges are only as exact
/// as the rounding of the data.
const TOLERANCE: f64 = 0.25;

/// Points joined without lifting the pen.
pub(super) type Line = Vec<(f64, f64)>;

/// The lines of a channel on the screen, in picture units.
pub(super) fn lines(picture: &Picture, channel: &Channel, screen: Area, unit: f64) -> Vec<Line> {
    let onto = Projection { picture, channel, screen };
    let fineness = unit * POINTS_PER_PIXEL;
    let window = Area {
        left: screen.left - TOLERANCE,
        top: screen.top - TOLERANCE,
        right: screen.right + TOLERANCE,
        bottom: screen.bottom + TOLERANCE,
    };
    runs(&channel.points, channel)
        .into_iter()
        .map(|run| onto.thinned(run, fineness))
        .flat_map(|run| clipped(&run, window))
        .collect()
}

/// Draws the lines, or dots, of a channel in its colour.
pub(super) fn draw(
    lines: &[Line],
    (index, channel): (usize, &Channel),
    surface: &mut dyn Surface,
) -> Result<(), PlotError> {
    let colour = palette::channel(index, channel);
    lines.iter().try_for_each(|line| surface.line(line, width(channel), colour))
}

fn width(channel: &Channel) -> f64 {
    match (channel.dots, channel.faint) {
        (true, false) => DOT,
        (true, true) => FAINT_DOT,
        (false, false) => WIDTH,
        (false, true) => FAINT_WIDTH,
    }
}

/// The sample of a trace in the legend: from a place along a line that it is as long as, its thickness and the points.
pub(super) fn sample(channel: &Channel, (x, y): (f64, f64), length: f64) -> (f64, Line) {
    match (channel.dots, channel.faint) {
        (true, _) => (width(channel), vec![(x + length / 2.0, y)]),
        (false, true) => (FAINT_WIDTH, vec![(x, y), (x + length, y)]),
        (false, false) => (SAMPLE_WIDTH, vec![(x, y), (x + length, y)]),
    }
}

/// The stretches of points of a channel drawn without lifting the pen.
pub(super) fn runs<'a>(points: &'a [(f64, f64)], channel: &Channel) -> Vec<&'a [(f64, f64)]> {
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
        .filter(|run| !run.is_empty())
        .collect()
}

/// The way from the units of the axes to the screen.
pub(super) struct Projection<'a> {
    pub picture: &'a Picture,
    pub channel: &'a Channel,
    pub screen: Area,
}

impl Projection<'_> {
    pub(super) fn place(&self, point: (f64, f64)) -> (f64, f64) {
        let across = self.picture.horizontal.fraction(point.0);
        let up = self.picture.axis_of(self.channel).fraction(point.1);
        (
            (self.screen.left + across * self.screen.width()).clamp(-FAR, FAR),
            (self.screen.bottom - up * self.screen.height()).clamp(-FAR, FAR),
        )
    }

    /// The points on the screen, without those that would not be seen.
    fn thinned(&self, run: &[(f64, f64)], fineness: f64) -> Line {
        let placed: Line = run.iter().map(|point| self.place(*point)).collect();
        if is_one_way(run) {
            let columns = (self.screen.width() * fineness) as usize;
            thin(&placed, self.screen.left, self.screen.right, columns)
        } else {
            drop_repeats(&placed, (1.0 / fineness, 1.0 / fineness))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Axis;

    const SCREEN: Area = Area { left: 0.0, top: 0.0, right: 100.0, bottom: 100.0 };

    fn drawn(points: Vec<(f64, f64)>, breaks: Vec<usize>) -> Vec<Line> {
        let axis = || Axis::fit("x", "", [0.0, 10.0].into_iter(), 10);
        let channels = vec![Channel { breaks, ..Channel::line("", points) }];
        let picture = Picture { channels, ..Picture::new("", axis(), axis()) };
        lines(&picture, &picture.channels[0], SCREEN, 1.0)
    }

    #[test]
    fn points_land_where_the_axes_say() {
        let lines = drawn(vec![(0.0, 0.0), (5.0, 10.0), (10.0, 5.0)], vec![]);
        assert_eq!(lines, [[(0.0, 100.0), (50.0, 0.0), (100.0, 50.0)]]);
    }

    #[test]
    fn breaks_and_gaps_lift_the_pen() {
        let points: Vec<(f64, f64)> = (0..10).map(|n| (f64::from(n), 5.0)).collect();
        assert_eq!(drawn(points.clone(), vec![3, 0, 7, 99, 3]).len(), 3);
        let mut gaps = points;
        gaps[4].1 = f64::NAN;
        gaps[8].0 = f64::INFINITY;
        let lengths: Vec<usize> = drawn(gaps, vec![]).iter().map(Vec::len).collect();
        assert_eq!(lengths, [4, 3, 1]);
    }

    #[test]
    fn no_line_joins_dots() {
        let picture = |channel| {
            let axis = || Axis::fit("x", "", [0.0, 10.0].into_iter(), 10);
            Picture { channels: vec![channel], ..Picture::new("", axis(), axis()) }
        };
        let points = vec![(0.0, 0.0), (f64::NAN, 1.0), (10.0, 10.0)];
        let picture = picture(Channel::dots("", points));
        let drawn = lines(&picture, &picture.channels[0], SCREEN, 1.0);
        assert_eq!(drawn, [[(0.0, 100.0)], [(100.0, 0.0)]]);
    }

    #[test]
    fn a_trace_along_the_edge_is_drawn() {
        assert_eq!(drawn(vec![(0.0, 10.000001), (10.0, 10.000001)], vec![]).len(), 1);
    }

    #[test]
    fn far_points_keep_the_direction() {
        let lines = drawn(vec![(5.0, 5.0), (5.0, f64::MAX)], vec![]);
        assert_eq!(lines, [[(50.0, 50.0), (50.0, -TOLERANCE)]]);
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
