//! The velocity profile of a slideway explained: points 1 to 5 and sections A to D of the thesis (4.5, Fig 4.8).

use super::critical_velocity::{Criterion, NoCriticalVelocity, REST, critical_velocity, first_largest};
use super::cut::at;
use super::cycles::{Cycle, CyclesError, cycles};
use super::steadiness::Steadiness;
use super::stick::{StickError, stick_end};
use super::window::samples_in;

/// What a velocity profile shows, while the command rises.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityProfile {
    /// 1: it breaks away, and the velocity jumps. 2: oscillation begins, the lower critical velocity. 3: stick-slip begins.
    /// 4: stick-slip ends. 5: oscillation ends, the upper critical velocity.
    pub points: [Result<ProfilePoint, Absent>; 5],
    /// A: smooth sliding behind the jump. B: oscillation that grows. C: stick-slip. D: oscillation that dies away.
    pub sections: [Result<Section, Absent>; 4],
    /// The velocity to which it jumps at point 1.
    pub jump: Option<f64>,
}

/// A point of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfilePoint {
    /// In seconds.
    pub time: f64,
    /// In the unit of the command.
    pub command: f64,
    /// The point, 1 to 5, with which it coincides.
    pub coincides: Option<usize>,
}

/// A section of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// When it begins and ends, in seconds.
    pub time: [f64; 2],
    /// From which command to which.
    pub command: [f64; 2],
    /// How many cycles lie in it.
    pub cycles: usize,
    /// The largest swing of a cycle, of the velocity less the command, peak to peak.
    pub swing: Option<f64>,
    /// The frequencies of its first and its last cycle, in Hz.
    pub frequency: Option<[f64; 2]>,
}

/// Why a point or a section is not there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Absent {
    /// Nothing moves.
    #[error("it never begins to slide")]
    Sticks,
    /// It does not stand still first, or breaks away without a jump.
    #[error("the velocity comes up to the command without a jump")]
    NoJump,
    /// Four windows of oscillation do not come together.
    #[error("it does not oscillate")]
    Quiet,
    /// It oscillates at the end of the ramp, for less than four windows.
    #[error("the ramp ends before there are cycles enough to tell")]
    TooShort,
    /// What swings at breaking away dies away, and nothing follows.
    #[error("it rings as it breaks away, and does not oscillate after that")]
    RingsOnly,
    /// The velocity stays above standstill.
    #[error("no three cycles in a row come down to standstill")]
    NoStickSlip,
    /// It goes on at the end of the ramp.
    #[error("it goes on up to the end of the ramp")]
    NotEnded,
    /// Its ends are one point.
    #[error("points {0} and {1} coincide")]
    Coincide(usize, usize),
    /// A point at its end is missing.
    #[error("there is no point {0}")]
    NoPoint(usize),
}

/// When a velocity oscillates, and when it stands still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileCriterion {
    /// When it oscillates; see [`Criterion`].
    pub oscillation: Criterion,
    /// A velocity up to this, in the unit of the velocity and above 0, is standstill: a cycle that comes down to it, or goes backward, is
    /// stick-slip. Half of the threshold is as little as what does not count as oscillation.
    pub standstill: f64,
}

/// Why no profile can be read.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// The run is no profile, or the criterion does not go with it.
    #[error(transparent)]
    Unreadable(#[from] NoCriticalVelocity),
    /// Samples lie too far apart.
    #[error(transparent)]
    Cycles(#[from] CyclesError),
    /// The standstill is not above 0.
    #[error("a standstill lies above 0: {0} does not")]
    BadStandstill(f64),
}

/// A cycle of ringing is smaller than this share of the one before: a damping ratio of 0.017 and more.
const RINGS: f64 = 0.9;
/// So many cycles in a row come down to standstill where stick-slip begins and ends: near rest one may by chance.
const IN_A_ROW: usize = 3;

/// Finds the points and sections of a velocity profile. The command goes from rest, or a run, up to its largest value, in either
/// direction; what comes after it is left out.
///
/// * Point 1: the velocity first passes standstill, and is above the command by more than the threshold within a window of that.
/// * Section A: from there to point 2. Where cycles behind the jump shrink, each to less than 0.9 of the one before, until the
///   velocity follows the command for four windows, they are the transient of the jump and belong to A.
/// * Point 2: the first cycle of the oscillation begins. It coincides with point 1 where no such rest comes between.
/// * Point 3: the first three cycles in a row begin that come down to standstill; point 4: the last three end.
/// * Point 5: the rising critical velocity, as [`critical_velocity`] reads it.
/// * Section B ends and section D begins, where there is no stick-slip, in the middle of the cycle with the largest swing.
///
/// # Errors
/// When signals are none, threshold, window or standstill do not go with the run, a cycle has fewer than eight samples, or the
/// command does not rise.
pub fn velocity_profile(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    criterion: ProfileCriterion,
) -> Result<VelocityProfile, ProfileError> {
    let ProfileCriterion { oscillation, standstill } = criterion;
    if !(standstill > 0.0 && standstill.is_finite()) {
        return Err(ProfileError::BadStandstill(standstill));
    }
    let end = critical_velocity(time, command, velocity, oscillation).rising;
    if let Err(error) = end
        && !matches!(error, NoCriticalVelocity::Quiet | NoCriticalVelocity::NotEnded(_))
    {
        return Err(error.into());
    }
    let turn = first_largest(command);
    let direction = command[turn].signum();
    let forward = |values: &[f64]| values[..=turn].iter().map(|value| value * direction).collect();
    let ramp =
        Ramp { time: &time[..=turn], command: forward(command), velocity: forward(velocity), criterion };
    let cycles = match cycles(ramp.time, &ramp.command, &ramp.velocity, oscillation) {
        Err(CyclesError::Quiet) => Vec::new(),
        found => found?,
    };
    Ok(ramp.profile(&cycles, end.map(|command| command * direction))?.turned(direction))
}

/// The way up of a profile, turned forward.
struct Ramp<'a> {
    time: &'a [f64],
    command: Vec<f64>,
    velocity: Vec<f64>,
    criterion: ProfileCriterion,
}

impl Ramp<'_> {
    fn profile(
        &self,
        cycles: &[Cycle],
        end: Result<f64, NoCriticalVelocity>,
    ) -> Result<VelocityProfile, ProfileError> {
        let jump = self.jump();
        let begin = jump.map_or(self.time[0], |(time, _)| time);
        let transient = self.transient(begin, cycles)?;
        let (ringing, oscillating) = cycles.split_at(transient.unwrap_or(0));
        let ringing = transient.map(|_| ringing);
        let first = jump.map(|(time, _)| self.point(time));
        let (points, sections) = match self.why_not(first, ringing, oscillating, end) {
            Some(why) => self.without_oscillation(first, ringing, why),
            None => {
                let points = self.points(first, ringing, oscillating, end.ok());
                (points, self.sections(points, ringing, oscillating))
            }
        };
        Ok(VelocityProfile { points, sections, jump: jump.ok().map(|(_, height)| height) })
    }

    /// Why it does not oscillate; nothing where it does.
    fn why_not(
        &self,
        first: Result<ProfilePoint, Absent>,
        ringing: Option<&[Cycle]>,
        cycles: &[Cycle],
        end: Result<f64, NoCriticalVelocity>,
    ) -> Option<Absent> {
        let lasts = cycles.last().map_or(0.0, |last| last.end - cycles[0].begin);
        let oscillates = lasts >= REST as f64 * self.criterion.oscillation.window;
        match (first, ringing, end) {
            (Err(Absent::Sticks), ..) => Some(Absent::Sticks),
            (.., Ok(_) | Err(NoCriticalVelocity::NotEnded(_))) if oscillates => None,
            (_, Some([_, ..]), _) => Some(Absent::RingsOnly),
            (.., Err(NoCriticalVelocity::NotEnded(_))) => Some(Absent::TooShort),
            _ => Some(Absent::Quiet),
        }
    }

    /// When it breaks away, and the largest velocity that comes of it.
    fn jump(&self) -> Result<(f64, f64), Absent> {
        let ProfileCriterion { oscillation: Criterion { threshold, window }, standstill } = self.criterion;
        let begin = stick_end(self.time, &self.velocity, Some(standstill)).map_err(|error| match error {
            StickError::Sticks => Absent::Sticks,
            _ => Absent::NoJump,
        })?;
        let within = |index: &usize| (begin..=begin + window).contains(&self.time[*index]);
        let samples = || (0..self.time.len()).filter(within);
        if samples().all(|index| self.velocity[index] - self.command[index] <= threshold) {
            return Err(Absent::NoJump);
        }
        Ok((begin, samples().map(|index| self.velocity[index]).fold(0.0, f64::max)))
    }

    /// How many cycles ring out as it breaks away, before it slides smoothly for the first time; nothing where it does not, or
    /// where they are no ringing.
    fn transient(&self, begin: f64, cycles: &[Cycle]) -> Result<Option<usize>, CyclesError> {
        let Ramp { time, command, velocity, criterion: ProfileCriterion { oscillation, .. } } = self;
        let steadiness =
            Steadiness::new(command, velocity, samples_in(time, *oscillation)?, oscillation.threshold);
        let first = time.partition_point(|instant| *instant < begin);
        let Some(rest) = steadiness.first_rest(first..time.len()) else { return Ok(None) };
        let before = cycles.partition_point(|cycle| cycle.begin < time[rest]);
        let rings = cycles[..before].windows(2).all(|pair| pair[1].amplitude < RINGS * pair[0].amplitude);
        Ok(rings.then_some(before))
    }

    fn without_oscillation(
        &self,
        first: Result<ProfilePoint, Absent>,
        ringing: Option<&[Cycle]>,
        why: Absent,
    ) -> Found {
        let begin = first.map_or(self.time[0], |point| point.time);
        let smooth = ringing.map(|cycles| self.section(cycles, [begin, self.end()])).ok_or(why);
        ([first, Err(why), Err(why), Err(why), Err(why)], [smooth, Err(why), Err(why), Err(why)])
    }

    fn points(
        &self,
        first: Result<ProfilePoint, Absent>,
        ringing: Option<&[Cycle]>,
        cycles: &[Cycle],
        end: Option<f64>,
    ) -> [Result<ProfilePoint, Absent>; 5] {
        let window = self.criterion.oscillation.window;
        let begins = match first {
            Ok(jump) if ringing.is_none() && cycles[0].begin <= jump.time + window => {
                ProfilePoint { coincides: Some(1), ..jump }
            }
            _ => self.point(cycles[0].begin),
        };
        let ends = end.map(|command| self.time[self.command.partition_point(|value| *value < command)]);
        let ends = ends.map(|time| self.point(time)).ok_or(Absent::NotEnded);
        let [sticks, slides] = self.stick_slip(cycles, begins, ends);
        [first, Ok(begins), sticks, slides, ends]
    }

    fn sections(
        &self,
        [first, begins, sticks, slides, ends]: [Result<ProfilePoint, Absent>; 5],
        ringing: Option<&[Cycle]>,
        cycles: &[Cycle],
    ) -> [Result<Section, Absent>; 4] {
        let largest = cycles.iter().max_by(|one, other| one.amplitude.total_cmp(&other.amplitude));
        let largest = largest.map_or(self.end(), |cycle| 0.5 * (cycle.begin + cycle.end));
        let at =
            |point: Result<ProfilePoint, Absent>, otherwise: f64| point.map_or(otherwise, |point| point.time);
        let of = |cycles: &[Cycle], begin: f64, end: f64| Ok(self.section(cycles, [begin, end]));
        let smooth = apart(begins, 1, 2)
            .and_then(|()| of(ringing.unwrap_or_default(), at(first, self.time[0]), at(begins, self.end())));
        let grows =
            apart(sticks, 2, 3).and_then(|()| of(cycles, at(begins, self.end()), at(sticks, largest)));
        let sticking = sticks.and_then(|sticks| of(cycles, sticks.time, at(slides, self.end())));
        let dies = match slides {
            Err(Absent::NotEnded) => Err(Absent::NoPoint(4)),
            _ => apart(slides, 4, 5).and_then(|()| of(cycles, at(slides, largest), at(ends, self.end()))),
        };
        [smooth, grows, sticking, dies]
    }

    /// Points 3 and 4.
    fn stick_slip(
        &self,
        cycles: &[Cycle],
        begins: ProfilePoint,
        ends: Result<ProfilePoint, Absent>,
    ) -> [Result<ProfilePoint, Absent>; 2] {
        let sticks = |cycle: &Cycle| cycle.least <= self.criterion.standstill;
        let in_a_row = |row: &[Cycle]| row.iter().all(sticks);
        let Some(first) = cycles.windows(IN_A_ROW).position(in_a_row) else {
            return [Err(Absent::NoStickSlip); 2];
        };
        let last = cycles.windows(IN_A_ROW).rposition(in_a_row).map_or(first, |row| row + IN_A_ROW - 1);
        let begin = match first {
            0 => ProfilePoint { coincides: Some(2), ..begins },
            _ => self.point(cycles[first].begin),
        };
        let end = match ends {
            Ok(ends) if cycles[last].end >= ends.time => Ok(ProfilePoint { coincides: Some(5), ..ends }),
            Err(why) if last + 1 == cycles.len() => Err(why),
            _ => Ok(self.point(cycles[last].end)),
        };
        [Ok(begin), end]
    }

    fn end(&self) -> f64 {
        self.time[self.time.len() - 1]
    }

    fn point(&self, time: f64) -> ProfilePoint {
        ProfilePoint { time, command: at(self.time, &self.command, time), coincides: None }
    }

    fn section(&self, cycles: &[Cycle], time: [f64; 2]) -> Section {
        let is_within = |cycle: &&Cycle| (time[0]..time[1]).contains(&(0.5 * (cycle.begin + cycle.end)));
        let cycles: Vec<_> = cycles.iter().filter(is_within).collect();
        let swings = cycles.iter().map(|cycle| 2.0 * cycle.amplitude);
        Section {
            time,
            command: time.map(|time| at(self.time, &self.command, time)),
            cycles: cycles.len(),
            swing: swings.reduce(f64::max),
            frequency: cycles
                .first()
                .zip(cycles.last())
                .map(|(first, last)| [first.frequency, last.frequency]),
        }
    }
}

/// That a point, which is one of two, does not coincide with the other.
fn apart(point: Result<ProfilePoint, Absent>, one: usize, other: usize) -> Result<(), Absent> {
    match point.ok().and_then(|point| point.coincides) {
        Some(_) => Err(Absent::Coincide(one, other)),
        None => Ok(()),
    }
}

/// Points and sections.
type Found = ([Result<ProfilePoint, Absent>; 5], [Result<Section, Absent>; 4]);

impl VelocityProfile {
    /// The profile in the direction of its command, 1 or -1.
    fn turned(mut self, direction: f64) -> Self {
        self.points.iter_mut().flatten().for_each(|point| point.command *= direction);
        let commands = self.sections.iter_mut().flatten().flat_map(|section| &mut section.command);
        commands.chain(&mut self.jump).for_each(|value| *value *= direction);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruments::sampled;
    use std::f64::consts::TAU;

    const CRITERION: ProfileCriterion =
        ProfileCriterion { oscillation: Criterion { threshold: 0.1, window: 0.04 }, standstill: 0.05 };

    /// The command rises by 0.5 a second, to 3. It sticks up to 0.1, jumps to 0.6 and rings about the command; on top of that it
    /// swings at 50 Hz by a height that follows the command.
    fn read(way: f64, height: impl Fn(f64) -> f64) -> Result<VelocityProfile, ProfileError> {
        let (time, command) = sampled(12_001, 5e-4, |t| way * 0.5 * t);
        let rings = |t: f64| 0.5 * (-30.0 * t).exp() * (TAU * 50.0 * t).cos();
        let (_, velocity) = sampled(12_001, 5e-4, |t| {
            let swing = height(0.5 * t) * (TAU * 50.0 * t).sin();
            way * if t < 0.2 { 0.0 } else { 0.5 * t + rings(t - 0.2) + swing }
        });
        velocity_profile(&time, &command, &velocity, CRITERION)
    }

    /// Grows from 0.5 on, beyond the command between 0.9 and 1.6, and is gone at 2.
    fn whole(command: f64) -> f64 {
        match command {
            ..0.5 => 0.0,
            ..0.9 => 1.0 * (command - 0.5) / 0.4,
            ..1.6 => command + 0.2,
            _ => 1.5 * (1.0 - (command - 1.6) / 0.4).max(0.0),
        }
    }

    fn commands(profile: &VelocityProfile) -> [f64; 5] {
        profile.points.map(|point| point.unwrap().command)
    }

    fn near(got: impl IntoIterator<Item = f64>, wanted: &[f64], within: f64) {
        let got: Vec<f64> = got.into_iter().collect();
        assert!(
            got.iter().zip(wanted).all(|(got, wanted)| (got - wanted).abs() < within),
            "{got:?} {wanted:?}"
        );
        assert_eq!(got.len(), wanted.len());
    }

    #[test]
    fn a_whole_profile_has_all_points_and_sections() {
        let profile = read(1.0, whole).unwrap();
        near(commands(&profile), &[0.1, 0.51, 0.8, 1.6, 1.99], 0.02);
        assert!(profile.points.iter().all(|point| point.unwrap().coincides.is_none()), "{profile:?}");
        near(profile.jump, &[0.6], 0.01);
        let sections = profile.sections.map(|section| section.unwrap());
        for (section, [begin, end]) in sections.iter().zip([[0, 1], [1, 2], [2, 3], [3, 4]]) {
            near(section.command, &[commands(&profile)[begin], commands(&profile)[end]], 1e-12);
        }
        assert!(
            sections[0].cycles < 6 && sections[1..].iter().all(|section| section.cycles > 20),
            "{sections:?}"
        );
        near(sections[2].swing, &[3.6], 0.02);
        near(sections[2].frequency.unwrap(), &[50.0, 50.0], 1.0);
    }

    #[test]
    fn backward_it_is_the_same_with_its_sign() {
        let [forward, backward] = [1.0, -1.0].map(|way| read(way, whole).unwrap());
        near(commands(&backward), &commands(&forward).map(|command| -command), 1e-9);
        assert_eq!(backward.jump, forward.jump.map(|jump| -jump));
    }

    #[test]
    fn a_command_may_begin_on_the_other_side() {
        let (time, command) = sampled(8001, 1e-3, |t| 0.5 * t - 1.0);
        let (_, velocity) =
            sampled(8001, 1e-3, |t| 0.5 * t - 1.0 + if t < 1.0 { (TAU * 50.0 * t).sin() } else { 0.0 });
        let profile = velocity_profile(&time, &command, &velocity, CRITERION).unwrap();
        near([profile.points[4].unwrap().command], &[-0.5], 0.02);
    }

    #[test]
    fn stick_slip_from_the_beginning_makes_points_coincide() {
        let profile = read(1.0, |command| if command < 1.0 { command + 0.2 } else { 0.0 }).unwrap();
        let coincide = profile.points.map(|point| point.unwrap().coincides);
        assert_eq!(coincide[..3], [None, Some(1), Some(2)]);
        let absent = profile.sections.map(|section| section.err());
        assert_eq!(absent[..3], [Some(Absent::Coincide(1, 2)), Some(Absent::Coincide(2, 3)), None]);
    }

    #[test]
    fn without_standstill_oscillation_grows_and_dies_about_its_largest_swing() {
        let profile = read(1.0, |command| 0.4 * (1.0 - ((command - 1.5) / 0.5).powi(2)).max(0.0)).unwrap();
        let absent = profile.points.map(|point| point.err());
        assert_eq!(absent, [None, None, Some(Absent::NoStickSlip), Some(Absent::NoStickSlip), None]);
        let [_, grows, sticks, dies] = profile.sections;
        near([grows.unwrap().command[1], dies.unwrap().command[0]], &[1.5, 1.5], 0.02);
        assert_eq!(sticks, Err(Absent::NoStickSlip));
    }

    #[test]
    fn what_the_run_does_not_show_is_told() {
        let absent = |height: &dyn Fn(f64) -> f64| read(1.0, height).unwrap().points.map(|point| point.err());
        let rings = Some(Absent::RingsOnly);
        assert_eq!(absent(&|_| 0.0), [None, rings, rings, rings, rings]);
        let goes_on = absent(&|command| if command > 1.0 { command + 0.2 } else { 0.0 });
        assert_eq!(goes_on, [None, None, None, Some(Absent::NotEnded), Some(Absent::NotEnded)]);
        let (time, command) = sampled(6001, 1e-3, |t| 0.5 * t);
        let of = |velocity: &[f64]| velocity_profile(&time, &command, velocity, CRITERION).unwrap();
        assert_eq!(of(&vec![0.0; 6001]).points, [Err(Absent::Sticks); 5]);
        let late: Vec<f64> =
            time.iter().map(|t| 0.5 * t + if *t < 5.9 { 0.0 } else { (TAU * 50.0 * t).sin() }).collect();
        assert_eq!(of(&late).points[1..], [Err(Absent::TooShort); 4]);
        let follows = of(&command);
        assert_eq!((follows.points[0], follows.points[4]), (Err(Absent::NoJump), Err(Absent::Quiet)));
        assert_eq!(follows.sections[0].unwrap().command, [0.0, 3.0]);
    }

    #[test]
    fn what_is_no_profile_is_refused() {
        let (time, command) = sampled(6001, 1e-3, |t| 0.5 * t);
        let with = |command: &[f64], criterion| velocity_profile(&time, command, &vec![0.0; 6001], criterion);
        let refused = |command: &[f64]| with(command, CRITERION).unwrap_err();
        assert_eq!(refused(&vec![1.0; 6001]), ProfileError::Unreadable(NoCriticalVelocity::NoRise));
        assert_eq!(refused(&command[1..]), ProfileError::Unreadable(NoCriticalVelocity::NotASignal));
        let still = |standstill| with(&command, ProfileCriterion { standstill, ..CRITERION }).unwrap_err();
        assert_eq!(still(0.0), ProfileError::BadStandstill(0.0));
        assert!(matches!(still(f64::NAN), ProfileError::BadStandstill(_)));
    }
}
