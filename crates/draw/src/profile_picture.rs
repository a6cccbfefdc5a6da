//! The picture of a velocity profile: its points as markers, its sections as bars below the curve.

use std::ops::Range;

use crate::picture_data::Quantity;
use crate::plane::ProfilePlane;
use crate::plot::{Axis, Channel, Picture};
use crate::scope::axis;
use patchcord_analysis::instruments::{RampDirection, VelocityProfile};

/// A signal of a velocity profile.
#[derive(Debug, Clone, Copy)]
pub struct ProfileSignal<'a> {
    /// The name.
    pub name: &'a str,
    /// The text of the unit.
    pub unit: &'a str,
    /// The samples.
    pub values: &'a [f64],
}

impl<'a> ProfileSignal<'a> {
    /// Returns a range of the samples as a quantity along an axis.
    fn quantity(&self, samples: Range<usize>) -> Quantity<'a> {
        Quantity { name: self.name, unit: self.unit, values: self.values[samples].to_vec() }
    }
}

/// The distance of the bars below the lowest velocity, as a share of the range of the velocity. The
/// same distance is left below the bars for their labels.
const BAR_DISTANCE: f64 = 0.08;
/// Points closer to each other than this share of the largest command share a marker.
const MERGE_DISTANCE: f64 = 0.02;
/// The largest command that is drawn, relative to the upper critical velocity.
const MAX_COMMAND: f64 = 2.0;
/// The number of points of a bar; its label is at the middle one.
const BAR_POINTS: usize = 41;

/// Returns the picture of the velocity against the command, with the points and sections of a profile.
///
/// The samples are those in the direction of the profile, up to twice the upper critical velocity. If
/// one signal has fewer samples than the other, only the common samples are drawn. `note` is printed
/// below the title.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::{Criterion, ProfileCriterion, RampDirection, velocity_profile};
/// use patchcord_draw::{ProfileSignal, profile_picture};
///
/// // The command rises by 0.5 per second to 3. The velocity oscillates at 50 Hz from t = 2 s to 4 s.
/// let time: Vec<f64> = (0..6001).map(|index| 1e-3 * f64::from(index)).collect();
/// let command: Vec<f64> = time.iter().map(|t| 0.5 * t).collect();
/// let swing = |t: f64| if (2.0..4.0).contains(&t) { 0.3 * (100.0 * std::f64::consts::PI * t).sin() } else { 0.0 };
/// let velocity: Vec<f64> = time.iter().map(|t| 0.5 * t + swing(*t)).collect();
/// let criterion = ProfileCriterion::usual(Criterion { threshold: 0.1, window: 0.04 });
/// let profile = velocity_profile(&time, &command, &velocity, criterion, RampDirection::Rising)?;
///
/// let signal = |name, values| ProfileSignal { name, unit: "mm/s", values };
/// let (command, velocity) = (signal("v_i", &command[..]), signal("v_o", &velocity[..]));
/// let picture = profile_picture("Profile", command, velocity, &profile, None);
/// let labels: Vec<&str> = picture.markers.iter().map(|marker| marker.label.as_str()).collect();
/// assert_eq!(labels, ["2", "5"], "oscillation begins and ends");
/// # Ok::<(), patchcord_analysis::instruments::ProfileError>(())
/// ```
pub fn profile_picture(
    title: impl Into<String>,
    command: ProfileSignal<'_>,
    velocity: ProfileSignal<'_>,
    profile: &VelocityProfile,
    note: Option<&str>,
) -> Picture {
    let samples = shown(&command.values[..command.values.len().min(velocity.values.len())], profile);
    let (along, mut up) = (command.quantity(samples.clone()), velocity.quantity(samples));
    let points: Vec<_> = along.values.iter().copied().zip(up.values.iter().copied()).collect();
    let range = up.values.iter().fold([0.0_f64; 2], |[low, high], value| [low.min(*value), high.max(*value)]);
    let below = BAR_DISTANCE * (range[1] - range[0]);
    let bars = range[0] - below;
    // The axis must include the labels below the bars.
    up.values.push(range[0] - 2.0 * below);
    let plane = ProfilePlane {
        command_axis: axis(&[&along], Axis::HORIZONTAL_DIVISIONS),
        velocity_axis: axis(&[&up], Axis::VERTICAL_DIVISIONS),
    };
    let whole = plane.line(velocity.name, points);
    let channels = [whole].into_iter().chain(sections(profile, bars, &plane)).collect();
    plane.picture(title, channels, markers(profile), note)
}

/// Returns the range of the samples that are drawn.
fn shown(command: &[f64], profile: &VelocityProfile) -> Range<usize> {
    let samples = profile.direction.samples(command);
    let max_command = profile.points[4].map_or(f64::INFINITY, |point| MAX_COMMAND * point.command.abs());
    let is_drawn = |sample: &usize| command[*sample].abs() <= max_command;
    match profile.direction {
        RampDirection::Rising => 0..samples.clone().rfind(is_drawn).map_or(samples.end, |last| last + 1),
        RampDirection::Falling => samples.clone().find(is_drawn).unwrap_or(samples.start)..samples.end,
    }
}

/// Returns a bar for each section of the profile, with its letter in the middle.
fn sections(profile: &VelocityProfile, height: f64, plane: &ProfilePlane) -> impl Iterator<Item = Channel> {
    let named =
        profile.sections.iter().zip(VelocityProfile::SECTION_LETTERS).zip(profile.direction.section_names());
    let found = named.filter_map(|((section, letter), name)| Some((section.ok()?, letter, name)));
    found.map(move |(section, letter, name)| {
        let [begin, end] = section.command;
        let command_at = |index: usize| begin + (end - begin) * index as f64 / (BAR_POINTS - 1) as f64;
        let bar =
            plane.line(format!("{letter} {name}"), (0..BAR_POINTS).map(|index| (command_at(index), height)));
        Channel { labels: vec![(BAR_POINTS / 2, letter.to_string())], ..bar }
    })
}

/// Returns the commands and numbers of the points of the profile. Points that nearly coincide share one.
fn markers(profile: &VelocityProfile) -> Vec<(f64, String)> {
    let commands = |index: usize| profile.points[index].ok().map(|point| point.command);
    let largest = (0..5).filter_map(commands).fold(0.0, |largest: f64, command| largest.max(command.abs()));
    let mut markers: Vec<(f64, String)> = Vec::new();
    for (number, command) in (0..5).filter_map(|index| Some((index + 1, commands(index)?))) {
        match markers.last_mut().filter(|(at, _)| (command - *at).abs() <= MERGE_DISTANCE * largest) {
            Some((_, label)) => *label += &format!(", {number}"),
            None => markers.push((command, number.to_string())),
        }
    }
    markers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Format, Size};
    use patchcord_analysis::instruments::{MissingPointError, ProfilePoint, ProfileSection};

    fn point(command: f64) -> Result<ProfilePoint, MissingPointError> {
        Ok(ProfilePoint { time: 1.0, command, coincides_with: None })
    }

    fn picture(upper: f64, direction: RampDirection) -> Picture {
        let section = ProfileSection {
            time: [0.0, 1.0],
            command: [1e-3, 4e-3],
            cycles: 3,
            swing: None,
            frequency: None,
        };
        let quiet = Err(MissingPointError::NoStickSlip);
        let profile = VelocityProfile {
            points: [point(1e-3), point(1.01e-3), quiet, quiet, point(upper)],
            sections: [
                Err(MissingPointError::Coincide(1, 2)),
                Ok(section),
                Err(MissingPointError::NoStickSlip),
                Ok(section),
            ],
            jump: None,
            direction,
        };
        // The command reverses at 5 mm/s.
        let values = [0.0, 1e-3, 5e-3, 2e-3];
        let drawn = |name| ProfileSignal { name, unit: "m/s", values: &values };
        profile_picture("Profile", drawn("v_i"), drawn("v_o"), &profile, None)
    }

    #[test]
    fn nearly_coinciding_points_share_a_marker() {
        let markers: Vec<_> = picture(4e-3, RampDirection::Rising)
            .markers
            .into_iter()
            .map(|marker| (marker.at, marker.label))
            .collect();
        assert_eq!(markers, [(1.0, "1, 2".to_owned()), (4.0, "5".to_owned())]);
    }

    #[test]
    fn sections_are_bars_below_the_velocity() {
        let picture = picture(4e-3, RampDirection::Rising);
        let names: Vec<_> = picture.channels.iter().map(|channel| channel.name.as_str()).collect();
        assert_eq!(names, ["v_o", "B oscillation grows", "D oscillation dies away"]);
        assert_eq!(picture.channels[0].points, [(0.0, 0.0), (1.0, 1.0), (5.0, 5.0)]);
        let bar = &picture.channels[1];
        assert_eq!((bar.points[0].0, bar.points[BAR_POINTS - 1].0), (1.0, 4.0));
        assert!(bar.points.iter().all(|point| point.1 < 0.0));
        assert_eq!(bar.labels, [(BAR_POINTS / 2, "B".to_owned())]);
    }

    #[test]
    fn a_falling_profile_shows_the_return() {
        let picture = picture(2.5e-3, RampDirection::Falling);
        assert_eq!(picture.channels[0].points, [(5.0, 5.0), (2.0, 2.0)]);
        let names: Vec<_> = picture.channels[1..].iter().map(|channel| channel.name.as_str()).collect();
        assert_eq!(names, ["B oscillation dies away", "D oscillation grows"]);
        let later = self::picture(1.5e-3, RampDirection::Falling);
        assert_eq!(later.channels[0].points, [(2.0, 2.0)]);
    }

    #[test]
    fn an_empty_profile_gives_an_empty_picture() {
        let profile = VelocityProfile {
            direction: RampDirection::Rising,
            points: [Err(MissingPointError::Sticks); 5],
            sections: [Err(MissingPointError::Sticks); 4],
            jump: None,
        };
        fn drawn(values: &[f64]) -> ProfileSignal<'_> {
            ProfileSignal { name: "v", unit: "m/s", values }
        }
        for direction in [RampDirection::Rising, RampDirection::Falling] {
            let profile = VelocityProfile { direction, ..profile.clone() };
            let count = |along: &[f64], up: &[f64]| {
                let picture = profile_picture("Profile", drawn(along), drawn(up), &profile, None);
                crate::plot::render(std::slice::from_ref(&picture), Format::Svg, Size::default()).unwrap();
                picture.channels[0].points.len()
            };
            assert_eq!([count(&[], &[]), count(&[], &[1.0]), count(&[1.0], &[])], [0; 3]);
            assert_eq!([count(&[1.0], &[1.0]), count(&[0.0], &[0.0]), count(&[2.0, 2.0], &[1.0])], [1; 3]);
        }
    }

    #[test]
    fn samples_far_beyond_the_last_point_are_omitted() {
        assert_eq!(picture(2e-3, RampDirection::Rising).channels[0].points, [(0.0, 0.0), (1.0, 1.0)]);
        assert_eq!(picture(-2e-3, RampDirection::Rising).channels[0].points.len(), 2);
    }
}
