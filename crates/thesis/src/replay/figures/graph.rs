//! Graphs of what theory says: curves and dots, with axes that hold them.

use super::super::recipe::Problem;
use crate::slideway::SlidewayError;
use patchcord_draw::plot::{Axis, Channel, Mark, Picture};

/// A graph that is being drawn.
pub(super) struct Graph {
    title: String,
    across: Scale,
    up: Scale,
    right: Option<Scale>,
    channels: Vec<Channel>,
    marks: Vec<Mark>,
    note: Option<String>,
}

/// What is read on an axis.
struct Scale {
    label: String,
    unit: String,
    logarithmic: bool,
    /// Its ends; those of the points where there are none.
    ends: Option<(f64, f64)>,
    /// How many divisions there are between them; as many as make round numbers where it is not told.
    divisions: Option<usize>,
}

impl Scale {
    fn new((label, unit): (&str, &str)) -> Scale {
        Scale {
            label: label.to_owned(),
            unit: unit.to_owned(),
            logarithmic: false,
            ends: None,
            divisions: None,
        }
    }

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
            return Axis::snug(label, unit, values.into_iter(), divisions);
        }
        if let Some((low, high)) = self.ends {
            return Axis::ratios(label, unit, low, high);
        }
        let above_zero = || values.iter().copied().filter(|value| *value > 0.0);
        let least = above_zero().fold(f64::INFINITY, f64::min);
        let most = above_zero().fold(0.0, f64::max);
        let decade = |value: f64, round: fn(f64) -> f64| 10f64.powf(round(value.log10()));
        Axis::ratios(label, unit, decade(least, f64::floor), decade(most, f64::ceil))
    }
}

impl Graph {
    /// An empty graph; label and unit of what is read along its foot, and at its side.
    pub fn new(title: &str, across: (&str, &str), up: (&str, &str)) -> Graph {
        let (across, up) = (Scale::new(across), Scale::new(up));
        let (right, channels, marks) = (None, Vec::new(), Vec::new());
        Graph { title: title.to_owned(), across, up, right, channels, marks, note: None }
    }

    /// A second scale at the right: label and unit of what is read there.
    pub fn right(mut self, scale: (&str, &str)) -> Graph {
        self.right = Some(Scale::new(scale));
        self
    }

    /// Equal lengths are equal ratios, along the foot, at the side.
    pub fn logarithmic(mut self, across: bool, up: bool) -> Graph {
        (self.across.logarithmic, self.up.logarithmic) = (across, up);
        self
    }

    /// The foot goes from one value to another, whatever the curves do.
    pub fn across(mut self, low: f64, high: f64) -> Graph {
        self.across.ends = Some((low, high));
        self
    }

    /// The foot goes from one value to another in so many equal divisions.
    pub fn divided(mut self, low: f64, high: f64, divisions: usize) -> Graph {
        self.across.divisions = Some(divisions);
        self.across(low, high)
    }

    /// The side goes from one value to another, whatever the curves do.
    pub fn up(mut self, low: f64, high: f64) -> Graph {
        self.up.ends = Some((low, high));
        self
    }

    /// The scale at the right goes from one value to another.
    pub fn right_ends(mut self, low: f64, high: f64) -> Graph {
        if let Some(right) = &mut self.right {
            right.ends = Some((low, high));
        }
        self
    }

    /// One more curve.
    pub fn line(mut self, name: impl Into<String>, points: Vec<(f64, f64)>) -> Graph {
        self.channels.push(Channel::line(name, points));
        self
    }

    /// One more curve, read at the right.
    pub fn right_line(mut self, name: impl Into<String>, points: Vec<(f64, f64)>) -> Graph {
        self.channels.push(Channel { right: true, ..Channel::line(name, points) });
        self
    }

    /// More points that no line joins.
    pub fn dots(mut self, name: impl Into<String>, points: Vec<(f64, f64)>) -> Graph {
        self.channels.push(Channel::dots(name, points));
        self
    }

    /// Text beside a point of the channel drawn last.
    pub fn label(mut self, point: usize, text: impl Into<String>) -> Graph {
        if let Some(channel) = self.channels.last_mut() {
            channel.labels.push((point, text.into()));
        }
        self
    }

    /// An upright line at a value along the foot.
    pub fn mark(mut self, at: f64, label: impl Into<String>) -> Graph {
        self.marks.push(Mark { at, label: label.into() });
        self
    }

    /// A line of small print.
    pub fn note(mut self, note: impl Into<String>) -> Graph {
        self.note = Some(note.into());
        self
    }

    /// The picture of it.
    pub fn picture(self) -> Picture {
        let points = || self.channels.iter().flat_map(|channel| channel.points.iter().copied());
        let heights = |right: bool| {
            let read = self.channels.iter().filter(move |channel| channel.right == right);
            read.flat_map(|channel| channel.points.iter().map(|(_, y)| *y))
        };
        let horizontal = self.across.axis(points().map(|(x, _)| x), Axis::ACROSS);
        let vertical = self.up.axis(heights(false), Axis::UP);
        let vertical_right = self.right.as_ref().map(|scale| scale.axis(heights(true), Axis::UP));
        let (channels, marks, note) = (self.channels, self.marks, self.note);
        Picture { channels, marks, note, vertical_right, ..Picture::new(self.title, horizontal, vertical) }
    }
}

/// The points of a curve.
pub(super) fn curve(
    across: impl Iterator<Item = f64>,
    law: impl Fn(f64) -> Result<f64, SlidewayError>,
) -> Result<Vec<(f64, f64)>, Problem> {
    across.map(|x| Ok((x, law(x)?))).collect()
}

/// So many numbers from one to another, both among them, equally far apart.
pub(super) fn evenly(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |index| low + (high - low) * index as f64 / (count - 1) as f64)
}

/// So many numbers from one to another, both among them and above 0, each the same multiple of the one before.
pub(super) fn by_ratio(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    evenly(low.ln(), high.ln(), count).map(f64::exp)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_hold_what_is_drawn() {
        let squares = evenly(0.0, 5.0, 11).map(|x| (x, x * x)).collect();
        let picture = Graph::new("squares", ("x", "m"), ("y", "m2")).line("x2", squares).picture();
        assert_eq!((picture.horizontal.low, picture.horizontal.high), (0.0, 5.0));
        assert!(picture.vertical.high >= 25.0 && picture.vertical.unit == "m2");
    }

    #[test]
    fn logarithmic_axes_go_by_decades() {
        let points = by_ratio(0.03, 40.0, 5).map(|x| (x, x)).collect();
        let picture =
            Graph::new("", ("x", ""), ("y", "")).logarithmic(true, false).line("", points).picture();
        assert_eq!((picture.horizontal.low, picture.horizontal.high), (0.01, 100.0));
        assert!(!picture.vertical.logarithmic);
    }

    #[test]
    fn what_is_read_at_the_right_has_an_axis_of_its_own() {
        let graph =
            Graph::new("", ("x", ""), ("y", "")).right(("z", "")).line("y", vec![(0.0, 1.0), (1.0, 2.0)]);
        let picture = graph.right_line("z", vec![(0.0, 100.0), (1.0, 400.0)]).picture();
        assert_eq!(picture.vertical.high, 2.0);
        assert_eq!(picture.vertical_right.map(|axis| axis.high), Some(400.0));
    }
}
