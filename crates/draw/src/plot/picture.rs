//! A scope picture as data.

use std::ops::Range;
use std::sync::Arc;

use super::Axis;

/// A scope picture: axes, channels and texts.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::{Axis, Channel, Picture};
///
/// let points = vec![(0.0, 0.0), (1.0, 2.0), (2.0, 1.0)];
/// let horizontal = Axis::fit("t", "s", points.iter().map(|point| point.0), Axis::HORIZONTAL_DIVISIONS);
/// let vertical = Axis::fit("x", "mm", points.iter().map(|point| point.1), Axis::VERTICAL_DIVISIONS);
/// let channels = vec![Channel::line("x", points)];
/// let picture = Picture { channels, ..Picture::new("Position", horizontal, vertical) };
/// assert_eq!((picture.title.as_str(), picture.channels.len()), ("Position", 1));
/// assert!(picture.vertical_right.is_none() && picture.markers.is_empty());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The title; may be empty.
    pub title: String,
    /// The horizontal axis.
    pub horizontal: Axis,
    /// The left vertical axis. Channels use it unless [`Channel::right`] is set.
    pub vertical: Axis,
    /// The right vertical axis, for channels with another unit or range; `None` if there is none.
    pub vertical_right: Option<Axis>,
    /// The channels. Their order sets the colours and the order of drawing.
    pub channels: Vec<Channel>,
    /// A line under the title, such as the settings of the run.
    pub note: Option<String>,
    /// A line under the note in a strong colour, such as why curves are wrong.
    pub warning: Option<String>,
    /// Events, drawn as dashed vertical lines with labels.
    pub markers: Vec<Marker>,
    /// Highlighted ranges `[from, to]` of the horizontal axis; the screen is darker there.
    pub spans: Vec<[f64; 2]>,
    /// Whether one unit has the same length along the horizontal and the left axis. The screen is then smaller than
    /// the picture permits. Logarithmic axes have no equal scales.
    pub equal_scales: bool,
}

/// An event on the horizontal axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Marker {
    /// The position in the unit of the horizontal axis.
    pub at: f64,
    /// A short label. It is omitted if it does not fit.
    pub label: String,
}

/// One trace on the screen.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::Channel;
///
/// let model = Channel::line("model", vec![(0.0, 1.0), (1.0, 2.0)]);
/// let measured = Channel { errors: vec![0.1, 0.1], ..Channel::dots("measured", vec![(0.0, 1.1), (1.0, 1.9)]) };
/// assert!(!model.dots && measured.dots);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The name in the legend.
    pub name: String,
    /// The points in the units of the axes. A point that is not finite interrupts the line.
    pub points: Vec<(f64, f64)>,
    /// Whether the trace uses [`Picture::vertical_right`]. If that axis is `None`, the trace uses
    /// [`Picture::vertical`].
    pub right: bool,
    /// The time of each point in seconds; empty if the horizontal axis is the time. A dense trace is darker where it
    /// stays longer.
    pub times: Arc<[f64]>,
    /// Indices of points at which a new line starts.
    pub breaks: Vec<usize>,
    /// Indices of points and the labels next to them. A label is omitted if it does not fit.
    pub labels: Vec<(usize, String)>,
    /// Whether the points are drawn as separate dots, as for measurements.
    pub dots: bool,
    /// The error of each point, up and down, in the unit of the axis; empty if it is not known. It is
    /// drawn as a band behind a line or as a bar through a dot.
    pub errors: Vec<f64>,
    /// Whether the trace is drawn thin and grey behind the others.
    pub faint: bool,
    /// Ranges of points that are wrong. The trace is pale there.
    pub wrong: Vec<Range<usize>>,
}

impl Channel {
    /// Returns a line through points that uses the left axis.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Channel {
        Channel {
            name: name.into(),
            points,
            times: Arc::default(),
            right: false,
            breaks: vec![],
            labels: vec![],
            dots: false,
            errors: vec![],
            faint: false,
            wrong: vec![],
        }
    }

    /// Returns separate dots that use the left axis.
    pub fn dots(name: impl Into<String>, points: Vec<(f64, f64)>) -> Channel {
        Channel { dots: true, ..Channel::line(name, points) }
    }
}

impl Picture {
    /// Returns a picture without channels.
    pub fn new(title: impl Into<String>, horizontal: Axis, vertical: Axis) -> Picture {
        Picture {
            title: title.into(),
            horizontal,
            vertical,
            vertical_right: None,
            channels: vec![],
            note: None,
            warning: None,
            markers: vec![],
            spans: vec![],
            equal_scales: false,
        }
    }

    /// Returns the vertical axis that a channel uses.
    pub(super) fn axis_of(&self, channel: &Channel) -> &Axis {
        match &self.vertical_right {
            Some(right) if channel.right => right,
            _ => &self.vertical,
        }
    }

    /// Returns every axis of the picture.
    pub(super) fn axes(&self) -> impl Iterator<Item = &Axis> {
        [&self.horizontal, &self.vertical].into_iter().chain(&self.vertical_right)
    }
}
