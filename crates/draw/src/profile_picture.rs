//! A velocity profile as a picture: its points as upright lines, its sections as bars along the foot.

use std::ops::Range;

use crate::plane::Plane;
use crate::plot::{Axis, Channel, Picture};
use crate::scope::{Quantity, axis};
use patchcord_analysis::instruments::{VelocityProfile, Way};

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
    fn quantity(&self, samples: Range<usize>) -> Quantity<'a> {
        Quantity { name: self.name, unit: self.unit, values: self.values[samples].to_vec() }
    }
}

/// Bars stand this far below the least velocity, as a share of the velocity's range, with as much again below them.
const BELOW: f64 = 0.08;
/// Points nearer to each other than this share of the ramp have one line.
const NEAR: f64 = 0.02;
/// The ramp is drawn up to so many times the upper critical velocity.
const ENOUGH: f64 = 2.0;
/// Places along a bar at which its name may stand.
const PLACES: usize = 41;

/// Draws the velocity against the command while that goes the profile's way, with the points and sections found in it, up to twice the upper
/// critical velocity or to where the command turns; where one of both has fewer values than the other, as far as there are values of
/// both. `note` is a line of small print.
pub fn profile_picture(
    title: String,
    command: Drawn<'_>,
    velocity: Drawn<'_>,
    profile: &VelocityProfile,
    note: Option<String>,
) -> Picture {
    let samples = shown(&command.values[..command.values.len().min(velocity.values.len())], profile);
    let (along, mut up) = (command.quantity(samples.clone()), velocity.quantity(samples));
    let points: Vec<_> = along.values.iter().copied().zip(up.values.iter().copied()).collect();
    let range =
        up.values.iter().fold([0.0_f64; 2], |[least, most], value| [least.min(*value), most.max(*value)]);
    let below = BELOW * (range[1] - range[0]);
    let bars = range[0] - below;
    // The axis makes room for the names below the bars.
    up.values.push(range[0] - 2.0 * below);
    let plane = Plane { across: axis(&[&along], Axis::ACROSS), upward: axis(&[&up], Axis::UP) };
    let whole = plane.line(velocity.name, points.into_iter());
    let channels = [whole].into_iter().chain(sections(profile, bars, &plane)).collect();
    plane.picture(title, channels, marks(profile), note)
}

/// The samples that are drawn.
fn shown(command: &[f64], profile: &VelocityProfile) -> Range<usize> {
    let samples = profile.way.samples(command);
    let enough = profile.points[4].map_or(f64::INFINITY, |point| ENOUGH * point.command.abs());
    let is_near = |sample: &usize| command[*sample].abs() <= enough;
    match profile.way {
        Way::Rising => 0..samples.clone().rfind(is_near).map_or(samples.end, |last| last + 1),
        Way::Falling => samples.clone().find(is_near).unwrap_or(samples.start)..samples.end,
    }
}

/// A bar for every section that there is, with its letter in the middle.
fn sections(profile: &VelocityProfile, height: f64, plane: &Plane) -> impl Iterator<Item = Channel> {
    let named = profile.sections.iter().zip(VelocityProfile::LETTERS).zip(profile.way.sections());
    let there = named.filter_map(|((section, letter), name)| Some((section.ok()?, letter, name)));
    there.map(move |(section, letter, name)| {
        let [begin, end] = section.command;
        let place = |index: usize| begin + (end - begin) * index as f64 / (PLACES - 1) as f64;
        let bar = plane.line(format!("{letter} {name}"), (0..PLACES).map(|index| (place(index), height)));
        Channel { labels: vec![(PLACES / 2, letter.to_string())], ..bar }
    })
}

/// Where every point is that there is, and its number; those that coincide, or nearly do, share one.
fn marks(profile: &VelocityProfile) -> Vec<(f64, String)> {
    let commands = |index: usize| profile.points[index].ok().map(|point| point.command);
    let largest = (0..5).filter_map(commands).fold(0.0, |largest: f64, command| largest.max(command.abs()));
    let mut marks: Vec<(f64, String)> = Vec::new();
    for (number, command) in (0..5).filter_map(|index| Some((index + 1, commands(index)?))) {
        match marks.last_mut().filter(|(at, _)| (command - *at).abs() <= NEAR * largest) {
            Some((_, label)) => *label += &format!(", {number}"),
            None => marks.push((command, number.to_string())),
        }
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Format, Size};
    use patchcord_analysis::instruments::{Absent, ProfilePoint, Section};

    fn point(command: f64) -> Result<ProfilePoint, Absent> {
        Ok(ProfilePoint { time: 1.0, command, coincides: None })
    }

    fn picture(upper: f64, way: Way) -> Picture {
        let section =
            Section { time: [0.0, 1.0], command: [1e-3, 4e-3], cycles: 3, swing: None, frequency: None };
        let quiet = Err(Absent::NoStickSlip);
        let profile = VelocityProfile {
            points: [point(1e-3), point(1.01e-3), quiet, quiet, point(upper)],
            sections: [Err(Absent::Coincide(1, 2)), Ok(section), Err(Absent::NoStickSlip), Ok(section)],
            jump: None,
            way,
        };
        // It turns at 5 mm/s.
        let values = [0.0, 1e-3, 5e-3, 2e-3];
        let drawn = |name| Drawn { name, unit: "m/s", values: &values };
        profile_picture("It".to_owned(), drawn("v_i"), drawn("v_o"), &profile, None)
    }

    #[test]
    fn points_are_lines_and_those_that_nearly_coincide_share_one() {
        let told: Vec<_> =
            picture(4e-3, Way::Rising).marks.into_iter().map(|mark| (mark.at, mark.label)).collect();
        assert_eq!(told, [(1.0, "1, 2".to_owned()), (4.0, "5".to_owned())]);
    }

    #[test]
    fn sections_are_bars_below_the_velocity() {
        let picture = picture(4e-3, Way::Rising);
        let names: Vec<_> = picture.channels.iter().map(|channel| channel.name.as_str()).collect();
        assert_eq!(names, ["v_o", "B oscillation grows", "D oscillation dies away"]);
        assert_eq!(picture.channels[0].points, [(0.0, 0.0), (1.0, 1.0), (5.0, 5.0)]);
        let bar = &picture.channels[1];
        assert_eq!((bar.points[0].0, bar.points[PLACES - 1].0), (1.0, 4.0));
        assert!(bar.points.iter().all(|point| point.1 < 0.0));
        assert_eq!(bar.labels, [(PLACES / 2, "B".to_owned())]);
    }

    #[test]
    fn falling_the_way_back_is_drawn() {
        let picture = picture(2.5e-3, Way::Falling);
        assert_eq!(picture.channels[0].points, [(5.0, 5.0), (2.0, 2.0)]);
        let names: Vec<_> = picture.channels[1..].iter().map(|channel| channel.name.as_str()).collect();
        assert_eq!(names, ["B oscillation dies away", "D oscillation grows"]);
        let later = self::picture(1.5e-3, Way::Falling);
        assert_eq!(later.channels[0].points, [(2.0, 2.0)]);
    }

    #[test]
    fn what_holds_nothing_is_drawn_empty() {
        let profile = VelocityProfile {
            way: Way::Rising,
            points: [Err(Absent::Sticks); 5],
            sections: [Err(Absent::Sticks); 4],
            jump: None,
        };
        fn drawn(values: &[f64]) -> Drawn<'_> {
            Drawn { name: "v", unit: "m/s", values }
        }
        for way in [Way::Rising, Way::Falling] {
            let profile = VelocityProfile { way, ..profile.clone() };
            let count = |along: &[f64], up: &[f64]| {
                let picture = profile_picture("It".to_owned(), drawn(along), drawn(up), &profile, None);
                crate::plot::render(std::slice::from_ref(&picture), Format::Svg, Size::default()).unwrap();
                picture.channels[0].points.len()
            };
            assert_eq!([count(&[], &[]), count(&[], &[1.0]), count(&[1.0], &[])], [0; 3]);
            assert_eq!([count(&[1.0], &[1.0]), count(&[0.0], &[0.0]), count(&[2.0, 2.0], &[1.0])], [1; 3]);
        }
    }

    #[test]
    fn what_lies_far_beyond_the_last_point_is_left_out() {
        assert_eq!(picture(2e-3, Way::Rising).channels[0].points, [(0.0, 0.0), (1.0, 1.0)]);
        assert_eq!(picture(-2e-3, Way::Rising).channels[0].points.len(), 2);
    }
}
