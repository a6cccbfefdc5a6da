//! The plane of velocity profiles: a velocity upward against its command across.

use crate::plot::{Axis, Channel, Mark, Picture};
use patchcord_analysis::instruments::Display;

/// Both axes with the scales that lead to them.
pub struct Plane {
    /// The axis of the command, and how its values are displayed.
    pub across: (Axis, Display),
    /// The axis of the velocity, and how its values are displayed.
    pub upward: (Axis, Display),
}

impl Plane {
    /// A line through commands and velocities.
    pub fn line(&self, name: impl Into<String>, points: impl Iterator<Item = (f64, f64)>) -> Channel {
        let scaled = |(x, y): (f64, f64)| (self.across.1.value(x), self.upward.1.value(y));
        Channel::line(name, points.map(scaled).collect())
    }

    /// A picture with upright lines at commands.
    pub fn picture(
        &self,
        title: String,
        channels: Vec<Channel>,
        marks: impl IntoIterator<Item = (f64, String)>,
        note: Option<String>,
    ) -> Picture {
        let mark = |(at, label): (f64, String)| Mark { at: self.across.1.value(at), label };
        let marks = marks.into_iter().map(mark).collect();
        Picture { channels, marks, note, ..Picture::new(title, self.across.0.clone(), self.upward.0.clone()) }
    }
}
