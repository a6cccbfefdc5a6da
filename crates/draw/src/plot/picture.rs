use super::Axis;

/// One scope picture: what is on the screen, as data.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The heading; may be empty.
    pub title: String,
    /// The axis along the foot of the screen.
    pub horizontal: Axis,
    /// The axis at the left, on which channels are read unless they say otherwise.
    pub vertical: Axis,
    /// The axis at the right, for channels whose unit or range differs.
    pub vertical_right: Option<Axis>,
    /// The traces, in the order in which they are drawn and coloured.
    pub channels: Vec<Channel>,
    /// One line under the title, such as the settings of the run.
    pub note: Option<String>,
    /// Places along the foot at which something happened, drawn as thin upright lines with labels.
    pub marks: Vec<Mark>,
    /// Stretches along the foot that stand out, from where to where: the screen is darker there.
    pub spans: Vec<[f64; 2]>,
}

/// A place along the foot of the screen at which something happened.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Where, in the unit of the horizontal axis.
    pub at: f64,
    /// What, in few words; left out where there is no room for it.
    pub label: String,
}

/// One trace on the screen.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// What the legend calls the trace.
    pub name: String,
    /// The points in the units of the axes; a point that is not finite lifts the pen.
    pub points: Vec<(f64, f64)>,
    /// Whether the trace is read on [`Picture::vertical_right`]; without that
    /// axis it is read on [`Picture::vertical`].
    pub right: bool,
    /// Indices of points at which the pen is lifted and a new line starts.
    pub breaks: Vec<usize>,
    /// Indices of points, and what is written beside them; left out where there is no room for it.
    pub labels: Vec<(usize, String)>,
    /// Whether the points are dots that no line joins, as measurements are.
    pub dots: bool,
    /// By how much each point may be off, up and down: a band behind a line, a bar through a dot. Empty where that is not told.
    pub errors: Vec<f64>,
    /// Whether the trace stands behind the others, grey and small.
    pub faint: bool,
}

impl Channel {
    /// A line through points, read at the left.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Channel {
        Channel {
            name: name.into(),
            points,
            right: false,
            breaks: vec![],
            labels: vec![],
            dots: false,
            errors: vec![],
            faint: false,
        }
    }

    /// Points that no line joins, read at the left.
    pub fn dots(name: impl Into<String>, points: Vec<(f64, f64)>) -> Channel {
        Channel { dots: true, ..Channel::line(name, points) }
    }
}

impl Picture {
    /// A picture with nothing on its screen yet.
    pub fn new(title: impl Into<String>, horizontal: Axis, vertical: Axis) -> Picture {
        let (vertical_right, channels, note, marks, spans) = (None, vec![], None, vec![], vec![]);
        Picture { title: title.into(), horizontal, vertical, vertical_right, channels, note, marks, spans }
    }

    /// The vertical axis on which a channel is read.
    pub(super) fn axis_of(&self, channel: &Channel) -> &Axis {
        match &self.vertical_right {
            Some(right) if channel.right => right,
            _ => &self.vertical,
        }
    }

    /// Every axis of the picture.
    pub(super) fn axes(&self) -> impl Iterator<Item = &Axis> {
        [&self.horizontal, &self.vertical].into_iter().chain(&self.vertical_right)
    }
}
