//! A velocity profile as a picture: its points as upright lines, its sections as bars along the foot.

use super::Display;
use super::critical_velocity::first_largest;
use super::profile::VelocityProfile;
use super::scope::{Quantity, axis};
use crate::plot::{Axis, Channel, Mark, Picture};

/// A signal to draw: name, unit, values.
#[derive(Debug, Clone, Copy)]
pub struct Drawn<'a> {
    /// What it is called.
    pub name: &'a str,
    /// Text of its unit.
    pub unit: &'a str,
    /// A value for each instant.
    pub values: &'a [f64],
}

impl<'a> Drawn<'a> {
    fn quantity(&self, count: usize) -> Quantity<'a> {
        Quantity { name: self.name, unit: self.unit, values: self.values[..count].to_vec() }
    }
}

/// What the sections are called on the picture.
const SECTIONS: [&str; 4] = ["A smooth", "B grows", "C stick-slip", "D dies away"];
/// Bars stand this far below the least velocity, as a share of the velocity's range, with as much again below them.
const BELOW: f64 = 0.08;
/// Points nearer to each other than this share of the ramp have one line.
const NEAR: f64 = 0.02;
/// The ramp is drawn up to so many times the upper critical velocity.
const ENOUGH: f64 = 2.0;
/// Places along a bar at which its name may stand.
const PLACES: usize = 41;

/// Draws the velocity against the command, with the points and sections found in it, up to twice the upper critical velocity or to where
/// the command turns. `note` is a line of small print.
pub fn profile_picture(
    title: String,
    command: Drawn<'_>,
    velocity: Drawn<'_>,
    profile: &VelocityProfile,
    note: Option<String>,
) -> Picture {
    let count = shown(command.values, profile);
    let (along, mut up) = (command.quantity(count), velocity.quantity(count));
    let points = along.values.clone().into_iter().zip(up.values.clone());
    let range =
        up.values.iter().fold([0.0_f64; 2], |[least, most], value| [least.min(*value), most.max(*value)]);
    let below = BELOW * (range[1] - range[0]);
    let bars = range[0] - below;
    // The axis makes room for the names below the bars.
    up.values.push(range[0] - 2.0 * below);
    let (horizontal, across) = axis(&[&along], Axis::ACROSS);
    let (vertical, upward) = axis(&[&up], Axis::UP);
    let scaled = |(x, y): (f64, f64)| (across.value(x), upward.value(y));
    let whole = Channel::line(velocity.name, points.map(scaled).collect());
    Picture {
        title,
        channels: [whole].into_iter().chain(sections(profile, bars, scaled)).collect(),
        horizontal,
        vertical,
        vertical_right: None,
        note,
        marks: marks(profile, &across),
    }
}

/// How many samples are drawn.
fn shown(command: &[f64], profile: &VelocityProfile) -> usize {
    let rising = &command[..=first_largest(command)];
    let enough = profile.points[4].map_or(f64::INFINITY, |point| ENOUGH * point.command.abs());
    rising.iter().rposition(|command| command.abs() <= enough).map_or(rising.len(), |last| last + 1)
}

/// A bar for every section that there is, with its letter in the middle.
fn sections(
    profile: &VelocityProfile,
    height: f64,
    scaled: impl Fn((f64, f64)) -> (f64, f64),
) -> impl Iterator<Item = Channel> {
    let there =
        profile.sections.iter().zip(SECTIONS).filter_map(|(section, name)| Some((section.ok()?, name)));
    there.map(move |(section, name)| {
        let [begin, end] = section.command;
        let place = |index: usize| begin + (end - begin) * index as f64 / (PLACES - 1) as f64;
        let points = (0..PLACES).map(|index| scaled((place(index), height))).collect();
        Channel { labels: vec![(PLACES / 2, name[..1].to_owned())], ..Channel::line(name, points) }
    })
}

/// A line for every point that there is; those that coincide, or nearly do, share one.
fn marks(profile: &VelocityProfile, across: &Display) -> Vec<Mark> {
    let commands = |index: usize| profile.points[index].ok().map(|point| point.command);
    let largest = (0..5).filter_map(commands).fold(0.0, |largest: f64, command| largest.max(command.abs()));
    let mut marks: Vec<(f64, String)> = Vec::new();
    for (number, command) in (0..5).filter_map(|index| Some((index + 1, commands(index)?))) {
        match marks.last_mut().filter(|(at, _)| (command - *at).abs() <= NEAR * largest) {
            Some((_, label)) => *label += &format!(", {number}"),
            None => marks.push((command, number.to_string())),
        }
    }
    marks.into_iter().map(|(at, label)| Mark { at: across.value(at), label }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruments::{Absent, ProfilePoint, Section};

    fn point(command: f64) -> Result<ProfilePoint, Absent> {
        Ok(ProfilePoint { time: 1.0, command, coincides: None })
    }

    fn picture(upper: f64) -> Picture {
        let section =
            Section { time: [0.0, 1.0], command: [1e-3, 4e-3], cycles: 3, swing: None, frequency: None };
        let quiet = Err(Absent::NoStickSlip);
        let profile = VelocityProfile {
            points: [point(1e-3), point(1.01e-3), quiet, quiet, point(upper)],
            sections: [Err(Absent::Coincide(1, 2)), Ok(section), Err(Absent::NoStickSlip), Ok(section)],
            jump: None,
        };
        // It turns at 5 mm/s.
        let values = [0.0, 1e-3, 5e-3, 2e-3];
        let drawn = |name| Drawn { name, unit: "m/s", values: &values };
        profile_picture("It".to_owned(), drawn("v_i"), drawn("v_o"), &profile, None)
    }

    #[test]
    fn points_are_lines_and_those_that_nearly_coincide_share_one() {
        let told: Vec<_> = picture(4e-3).marks.into_iter().map(|mark| (mark.at, mark.label)).collect();
        assert_eq!(told, [(1.0, "1, 2".to_owned()), (4.0, "5".to_owned())]);
    }

    #[test]
    fn sections_are_bars_below_the_velocity() {
        let picture = picture(4e-3);
        let names: Vec<_> = picture.channels.iter().map(|channel| channel.name.as_str()).collect();
        assert_eq!(names, ["v_o", "B grows", "D dies away"]);
        assert_eq!(picture.channels[0].points, [(0.0, 0.0), (1.0, 1.0), (5.0, 5.0)]);
        let bar = &picture.channels[1];
        assert_eq!((bar.points[0].0, bar.points[PLACES - 1].0), (1.0, 4.0));
        assert!(bar.points.iter().all(|point| point.1 < 0.0));
        assert_eq!(bar.labels, [(PLACES / 2, "B".to_owned())]);
    }

    #[test]
    fn what_lies_far_beyond_the_last_point_is_left_out() {
        assert_eq!(picture(2e-3).channels[0].points, [(0.0, 0.0), (1.0, 1.0)]);
        assert_eq!(picture(-2e-3).channels[0].points.len(), 2);
    }
}
