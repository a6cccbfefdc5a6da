//! Builds graphs of theory and of results: curves and dots, with axes that contain them.
//!
//! A [`Graph`] collects channels and markers, and then becomes a picture. Axes without a given range take it from the
//! points.

use super::super::recipe::BoxError;
use super::super::series::min_max;
use crate::slideway::SlidewayError;
use patchcord_draw::plot::{Axis, Channel, Marker, Picture};

/// A graph under construction.
pub(super) struct Graph {
    /// The heading.
    title: String,
    /// The horizontal axis.
    across: AxisScale,
    /// The vertical axis at the left.
    up: AxisScale,
    /// The vertical axis at the right. `None` if all curves share one axis.
    right: Option<AxisScale>,
    /// Curves and sets of dots, in the order in which they were added, which also sets their colours.
    channels: Vec<Channel>,
    /// Vertical lines with a text.
    markers: Vec<Marker>,
    /// A line of text below the graph.
    note: Option<String>,
}

/// The scale of one axis.
struct AxisScale {
    /// What the axis shows, such as "velocity".
    label: String,
    /// Its unit; empty for a pure number.
    unit: String,
    /// Whether it is logarithmic. Points at or below 0 are then not shown.
    logarithmic: bool,
    /// Its range. `None` if it follows from the points.
    ends: Option<(f64, f64)>,
    /// The number of divisions of the range. `None` if it is chosen for round numbers. It counts only together with a
    /// range.
    divisions: Option<usize>,
}

impl AxisScale {
    /// Makes a linear axis without a given range.
    fn new((label, unit): (&str, &str)) -> AxisScale {
        AxisScale {
            label: label.to_owned(),
            unit: unit.to_owned(),
            logarithmic: false,
            ends: None,
            divisions: None,
        }
    }

    /// Makes the axis for these values. A logarithmic axis without a range extends to whole decades.
    fn axis(&self, values: impl Iterator<Item = f64>, divisions: usize) -> Axis {
        let (label, unit) = (self.label.clone(), self.unit.clone());
        let values: Vec<f64> = match self.ends {
            Some((low, high)) => vec![low, high],
            None => values.collect(),
        };
        if let (Some((low, high)), Some(divisions)) = (self.ends, self.divisions) {
            return Axis { label, unit, low, high, divisions, logarithmic: self.logarithmic };
        }
        if !self.logarithmic {
            return Axis::fit_tight(label, unit, values, divisions);
        }
        if let Some((low, high)) = self.ends {
            return Axis::logarithmic(label, unit, low, high);
        }
        let (min, max) = min_max(values.into_iter().filter(|value| *value > 0.0));
        let decade = |value: f64, round: fn(f64) -> f64| 10f64.powf(round(value.log10()));
        Axis::logarithmic(label, unit, decade(min, f64::floor), decade(max, f64::ceil))
    }
}

impl Graph {
    /// Makes an empty graph. `across` and `up` are label and unit of the horizontal and of the vertical axis.
    pub(super) fn new(title: &str, across: (&str, &str), up: (&str, &str)) -> Graph {
        let (across, up) = (AxisScale::new(across), AxisScale::new(up));
        let (right, channels, markers) = (None, Vec::new(), Vec::new());
        Graph { title: title.to_owned(), across, up, right, channels, markers, note: None }
    }

    /// Adds a second vertical axis at the right, with label and unit.
    pub(super) fn right_axis(mut self, scale: (&str, &str)) -> Graph {
        self.right = Some(AxisScale::new(scale));
        self
    }

    /// Makes the horizontal or the vertical axis logarithmic.
    pub(super) fn logarithmic(mut self, across: bool, up: bool) -> Graph {
        (self.across.logarithmic, self.up.logarithmic) = (across, up);
        self
    }

    /// Sets the range of the horizontal axis.
    pub(super) fn x_range(mut self, low: f64, high: f64) -> Graph {
        self.across.ends = Some((low, high));
        self
    }

    /// Sets the range of the horizontal axis, and its number of equal divisions.
    pub(super) fn x_divisions(mut self, low: f64, high: f64, divisions: usize) -> Graph {
        self.across.divisions = Some(divisions);
        self.x_range(low, high)
    }

    /// Sets the range of the vertical axis.
    pub(super) fn y_range(mut self, low: f64, high: f64) -> Graph {
        self.up.ends = Some((low, high));
        self
    }

    /// Sets the range of the axis at the right, if there is one.
    pub(super) fn right_range(mut self, low: f64, high: f64) -> Graph {
        if let Some(right) = &mut self.right {
            right.ends = Some((low, high));
        }
        self
    }

    /// Adds a curve.
    pub(super) fn line(mut self, name: impl Into<String>, points: Vec<(f64, f64)>) -> Graph {
        self.channels.push(Channel::line(name, points));
        self
    }

    /// Adds a curve that belongs to the axis at the right.
    pub(super) fn right_line(mut self, name: impl Into<String>, points: Vec<(f64, f64)>) -> Graph {
        self.channels.push(Channel { right: true, ..Channel::line(name, points) });
        self
    }

    /// Adds points that are not joined by a line.
    pub(super) fn dots(mut self, name: impl Into<String>, points: Vec<(f64, f64)>) -> Graph {
        self.channels.push(Channel::dots(name, points));
        self
    }

    /// Adds a text next to a point of the channel that was added last. `point` is its index.
    pub(super) fn label(mut self, point: usize, text: impl Into<String>) -> Graph {
        if let Some(channel) = self.channels.last_mut() {
            channel.labels.push((point, text.into()));
        }
        self
    }

    /// Adds a vertical line at a value of the horizontal axis.
    pub(super) fn marker(mut self, at: f64, label: impl Into<String>) -> Graph {
        self.markers.push(Marker { at, label: label.into() });
        self
    }

    /// Sets the note below the graph.
    pub(super) fn note(mut self, note: impl Into<String>) -> Graph {
        self.note = Some(note.into());
        self
    }

    /// Returns the finished picture.
    pub(super) fn picture(self) -> Picture {
        let points = || self.channels.iter().flat_map(|channel| channel.points.iter().copied());
        let heights = |right: bool| {
            let read = self.channels.iter().filter(move |channel| channel.right == right);
            read.flat_map(|channel| channel.points.iter().map(|(_, y)| *y))
        };
        let horizontal = self.across.axis(points().map(|(x, _)| x), Axis::HORIZONTAL_DIVISIONS);
        let vertical = self.up.axis(heights(false), Axis::VERTICAL_DIVISIONS);
        let vertical_right =
            self.right.as_ref().map(|scale| scale.axis(heights(true), Axis::VERTICAL_DIVISIONS));
        let (channels, markers, note) = (self.channels, self.markers, self.note);
        Picture { channels, markers, note, vertical_right, ..Picture::new(self.title, horizontal, vertical) }
    }
}

/// Evaluates a law at each value and returns the points of its curve.
pub(super) fn sample_curve(
    across: impl Iterator<Item = f64>,
    law: impl Fn(f64) -> Result<f64, SlidewayError>,
) -> Result<Vec<(f64, f64)>, BoxError> {
    across.map(|x| Ok((x, law(x)?))).collect()
}

/// Returns `count` numbers from `low` to `high` inclusive, equally spaced.
pub(super) fn linspace(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |index| low + (high - low) * index as f64 / (count - 1) as f64)
}

/// Returns `count` numbers from `low` to `high` inclusive, with a constant ratio between neighbours. Both ends must
/// be positive.
pub(super) fn geomspace(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    linspace(low.ln(), high.ln(), count).map(f64::exp)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_contain_what_is_drawn() {
        let squares = linspace(0.0, 5.0, 11).map(|x| (x, x * x)).collect();
        let picture = Graph::new("squares", ("x", "m"), ("y", "m2")).line("x2", squares).picture();
        assert_eq!((picture.horizontal.low, picture.horizontal.high), (0.0, 5.0));
        assert!(picture.vertical.high >= 25.0 && picture.vertical.unit == "m2");
    }

    #[test]
    fn logarithmic_axes_end_at_decades() {
        let points = geomspace(0.03, 40.0, 5).map(|x| (x, x)).collect();
        let picture =
            Graph::new("", ("x", ""), ("y", "")).logarithmic(true, false).line("", points).picture();
        assert_eq!((picture.horizontal.low, picture.horizontal.high), (0.01, 100.0));
        assert!(!picture.vertical.logarithmic);
    }

    #[test]
    fn curves_at_the_right_have_a_separate_axis() {
        let graph = Graph::new("", ("x", ""), ("y", ""))
            .right_axis(("z", ""))
            .line("y", vec![(0.0, 1.0), (1.0, 2.0)]);
        let picture = graph.right_line("z", vec![(0.0, 100.0), (1.0, 400.0)]).picture();
        assert_eq!(picture.vertical.high, 2.0);
        assert_eq!(picture.vertical_right.map(|axis| axis.high), Some(400.0));
    }
}
