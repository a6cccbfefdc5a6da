//! One ramp of a velocity profile, transformed so that both ramps are read by the same code.
//!
//! A negative command is mirrored. A falling ramp is reversed in time, so the command always rises from rest.
//! Results are transformed back to the original time and sign.

use super::super::critical_velocity::{
    Criterion, CriticalVelocityError, REST_WINDOWS, critical_samples, largest_of,
};
use super::super::cut::at;
use super::super::cycles::{Cycle, CyclesError, cycles};
use super::super::steadiness::Steadiness;
use super::super::stick::{StickError, stick_end};
use super::super::window::samples_in;
use super::{
    MissingPointError, ProfileCriterion, ProfileError, ProfilePoint, ProfileSection, RampDirection,
    VelocityProfile,
};

/// One ramp of a profile, transformed so that the command is positive and rises with time.
pub(super) struct RampReader {
    /// Transformed time of every sample, in seconds; negative for a falling ramp.
    time: Vec<f64>,
    /// Transformed command of every sample.
    command: Vec<f64>,
    /// Transformed velocity of every sample.
    velocity: Vec<f64>,
    /// The criterion for oscillation and standstill.
    pub criterion: ProfileCriterion,
    /// The ramp that is read.
    pub direction: RampDirection,
    /// The original sign of the command, 1 or -1.
    sign: f64,
    /// The cycles in order of transformed time.
    pub cycles: Vec<Cycle>,
    /// The transformed time at which oscillation ends (rising) or begins (falling), or why there is none.
    pub end: Result<f64, CriticalVelocityError>,
}

/// In ringing each cycle is smaller than this fraction of the previous one: a damping ratio of at least 0.017.
const RINGING_DECAY: f64 = 0.9;

/// The cycles of a ramp, split into ringing, short bouts and oscillation.
pub(super) struct CycleSplit {
    /// The number of cycles before the velocity first slides smoothly, if they are ringing and not oscillation. None if
    /// the velocity never slides smoothly or oscillates before.
    pub ringing: Option<usize>,
    /// The number of cycles before the oscillation.
    pub first: usize,
}

impl RampReader {
    /// Cuts one ramp out of a run and transforms it.
    ///
    /// # Errors
    /// If the run is no profile, the criterion is unusable with it, or command and velocity stay below standstill.
    pub(super) fn new(
        time: &[f64],
        command: &[f64],
        velocity: &[f64],
        criterion: ProfileCriterion,
        direction: RampDirection,
    ) -> Result<Self, ProfileError> {
        let end = match direction.select(critical_samples(time, command, velocity, criterion.oscillation)?) {
            Err(error) if !is_reported_by_points(error) => return Err(error.into()),
            end => end.map(|sample| time[sample]),
        };
        let samples = direction.samples(command);
        check_motion(criterion.standstill, [&command[samples.clone()], &velocity[samples.clone()]])?;
        let sign = command[direction.select([samples.end - 1, samples.start])].signum();
        let [time, command, velocity] =
            [(time, 1.0), (command, sign), (velocity, sign)].map(|(values, sign)| {
                values[samples.clone()].iter().map(|value| value * sign).collect::<Vec<_>>()
            });
        let cycles = match cycles(&time, &command, &velocity, criterion.oscillation) {
            Err(CyclesError::NoOscillation) => Vec::new(),
            found => found?,
        };
        let mut ramp = RampReader { time, command, velocity, criterion, direction, sign, cycles, end };
        if direction == RampDirection::Falling {
            ramp.reverse_time();
        }
        Ok(ramp)
    }

    /// Reverses time: the last sample becomes the first, and times change their sign.
    fn reverse_time(&mut self) {
        self.time.iter_mut().for_each(|time| *time = -*time);
        for values in [&mut self.time, &mut self.command, &mut self.velocity] {
            values.reverse();
        }
        self.cycles.iter_mut().for_each(|cycle| (cycle.begin, cycle.end) = (-cycle.end, -cycle.begin));
        self.cycles.reverse();
        self.end = self.end.map(|time| -time);
    }

    /// The profile of this ramp, in the original time and sign.
    pub(super) fn profile(&self) -> VelocityProfile {
        let jump = self.jump();
        let (points, sections) = self.points_with_sections(jump.map(|(time, _)| self.point(time)));
        let jump = jump.ok().map(|(_, height)| height * self.sign);
        let points = points.map(|point| point.map(|point| self.original_point(point)));
        let sections = sections.map(|section| section.map(|section| self.original_section(section)));
        VelocityProfile { direction: self.direction, points, sections, jump }
    }

    /// The time of breaking away, and the largest velocity within a window after it.
    fn jump(&self) -> Result<(f64, f64), MissingPointError> {
        let ProfileCriterion { oscillation: Criterion { threshold, window }, standstill } = self.criterion;
        let begin = stick_end(&self.time, &self.velocity, Some(standstill)).map_err(|error| match error {
            StickError::Sticks => MissingPointError::Sticks,
            _ => self.direction.select([MissingPointError::NoJump, MissingPointError::NoRest]),
        })?;
        let within = |index: &usize| (begin..=begin + window).contains(&self.time[*index]);
        let samples = || (0..self.time.len()).filter(within);
        if samples().all(|index| self.velocity[index] - self.command[index] <= threshold) {
            return Err(self.direction.select([MissingPointError::NoJump, MissingPointError::NoSlip]));
        }
        Ok((begin, samples().map(|index| self.velocity[index]).fold(0.0, f64::max)))
    }

    /// Separates ringing after the jump and short bouts from the oscillation. `jump` is the time of breaking away.
    pub(super) fn split_cycles(&self, jump: Option<f64>) -> CycleSplit {
        let all_oscillation = CycleSplit { ringing: None, first: 0 };
        let Some(rest) = self.first_rest(jump.unwrap_or(self.begin())) else { return all_oscillation };
        let ringing = self.cycles.partition_point(|cycle| cycle.begin < rest);
        let (before, after) = self.cycles.split_at(ringing);
        let shrinks = before.windows(2).all(|pair| pair[1].amplitude < RINGING_DECAY * pair[0].amplitude);
        if self.is_long_enough(before) && !(shrinks && self.direction == RampDirection::Rising) {
            return all_oscillation;
        }
        let short = bouts(after).take_while(|bout| !self.is_long_enough(bout)).map(<[_]>::len).sum::<usize>();
        CycleSplit { ringing: Some(ringing), first: ringing + short }
    }

    /// The first time, from `begin` on, after which the velocity follows the command for four windows.
    fn first_rest(&self, begin: f64) -> Option<f64> {
        let oscillation = self.criterion.oscillation;
        let span = samples_in(&self.time, oscillation).ok()?;
        let steadiness = Steadiness::new(&self.command, &self.velocity, span, oscillation.threshold);
        let first = self.time.partition_point(|instant| *instant < begin);
        steadiness.first_rest(first..self.time.len()).map(|rest| self.time[rest])
    }

    /// Whether the run ends during the falling ramp before the velocity follows the command.
    pub(super) fn is_cut_off(&self) -> bool {
        self.command[0] > self.criterion.standstill && self.first_rest(self.begin()) != Some(self.begin())
    }

    /// Whether these adjoining cycles together last for at least four windows, so that they are an oscillation.
    pub(super) fn is_long_enough(&self, bout: &[Cycle]) -> bool {
        let [Some(first), Some(last)] = [bout.first(), bout.last()] else { return false };
        last.end - first.begin >= REST_WINDOWS as f64 * self.criterion.oscillation.window
    }

    /// The first transformed time.
    pub(super) fn begin(&self) -> f64 {
        self.time[0]
    }

    /// The last transformed time.
    pub(super) fn finish(&self) -> f64 {
        self.time[self.time.len() - 1]
    }

    /// The transformed command at a transformed time.
    pub(super) fn command(&self, time: f64) -> f64 {
        at(&self.time, &self.command, time)
    }

    /// The point of the profile at a transformed time.
    pub(super) fn point(&self, time: f64) -> ProfilePoint {
        ProfilePoint { time, command: self.command(time), coincides_with: None }
    }

    /// A point in the original time and sign.
    fn original_point(&self, point: ProfilePoint) -> ProfilePoint {
        let time = point.time * self.direction.select([1.0, -1.0]);
        ProfilePoint { time, command: point.command * self.sign, ..point }
    }

    /// A section in the original time and sign.
    fn original_section(&self, section: ProfileSection) -> ProfileSection {
        let command = section.command.map(|command| command * self.sign);
        let backward = |[first, last]: [f64; 2]| [last, first];
        match self.direction {
            RampDirection::Rising => ProfileSection { command, ..section },
            RampDirection::Falling => ProfileSection {
                time: backward(section.time).map(|time| -time),
                command: backward(command),
                frequency: section.frequency.map(backward),
                ..section
            },
        }
    }
}

/// Groups of adjoining cycles. Between two groups the velocity slides steadily.
pub(super) fn bouts(cycles: &[Cycle]) -> impl Iterator<Item = &[Cycle]> {
    cycles.chunk_by(|cycle, next| cycle.end == next.begin)
}

/// An error if neither command nor velocity exceeds standstill.
fn check_motion(standstill: f64, values: [&[f64]; 2]) -> Result<(), ProfileError> {
    let reached = values.map(largest_of).into_iter().fold(0.0, f64::max);
    if reached > standstill { Ok(()) } else { Err(ProfileError::Motionless { standstill, reached }) }
}

/// Whether the missing points already report this reason, so that the profile can still be read.
fn is_reported_by_points(error: CriticalVelocityError) -> bool {
    use CriticalVelocityError::{NoOscillation, NotBegun, NotEnded};
    matches!(error, NoOscillation | NotEnded(_) | NotBegun)
}
