//! The axes of velocity profiles: velocity (vertical) against command (horizontal).

use crate::plot::{Axis, Channel, Marker, Picture};
use patchcord_analysis::format::QuantityFormat;

/// The axes of a velocity profile with the displays that scale values for them.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::format::QuantityFormat;
/// use patchcord_draw::ProfilePlane;
/// use patchcord_draw::plot::Axis;
///
/// let axis = |label: &str, divisions: usize| Axis::fit(label, "mm/s", [0.0, 20.0], divisions);
/// let plane = ProfilePlane {
///     command_axis: (axis("v_i", 10), QuantityFormat::new("m/s", 0.02)),
///     velocity_axis: (axis("v_o", 8), QuantityFormat::new("m/s", 0.02)),
/// };
/// let line = plane.line("v_o", [(0.0, 0.0), (0.01, 0.02)]);
/// assert!((line.points[1].0 - 10.0).abs() < 1e-9, "10 mm/s");
/// let picture = plane.picture("Profile", vec![line], [(0.01, "1".to_owned())], None);
/// assert_eq!(picture.markers[0].label, "1");
/// ```
pub struct ProfilePlane {
    /// The axis of the command and the display of its values.
    pub command_axis: (Axis, QuantityFormat),
    /// The axis of the velocity and the display of its values.
    pub velocity_axis: (Axis, QuantityFormat),
}

impl ProfilePlane {
    /// Returns a line through points (command, velocity).
    pub fn line(&self, name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Channel {
        let scaled = |(x, y): (f64, f64)| (self.command_axis.1.value(x), self.velocity_axis.1.value(y));
        Channel::line(name, points.into_iter().map(scaled).collect())
    }

    /// Returns a picture with markers at the given commands. `note` is printed below the title.
    pub fn picture(
        &self,
        title: impl Into<String>,
        channels: Vec<Channel>,
        markers: impl IntoIterator<Item = (f64, String)>,
        note: Option<&str>,
    ) -> Picture {
        let marker = |(at, label): (f64, String)| Marker { at: self.command_axis.1.value(at), label };
        let markers = markers.into_iter().map(marker).collect();
        Picture {
            channels,
            markers,
            note: note.map(str::to_owned),
            ..Picture::new(title, self.command_axis.0.clone(), self.velocity_axis.0.clone())
        }
    }
}
