//! One way of a command, as a way up: what falls is read backward in time.

use super::super::critical_velocity::{Criterion, NoCriticalVelocity, REST, critical_samples, largest_of};
use super::super::cut::at;
use super::super::cycles::{Cycle, CyclesError, cycles};
use super::super::steadiness::Steadiness;
use super::super::stick::{StickError, stick_end};
use super::super::window::samples_in;
use super::{Absent, ProfileCriterion, ProfileError, ProfilePoint, Section, VelocityProfile, Way};

/// One way of a profile, turned so that time goes on while the command rises, forward.
pub(super) struct Ramp {
    time: Vec<f64>,
    command: Vec<f64>,
    velocity: Vec<f64>,
    pub criterion: ProfileCriterion,
    pub way: Way,
    /// The direction of the command, 1 or -1.
    direction: f64,
    /// Its cycles, one after the other.
    pub cycles: Vec<Cycle>,
    /// When oscillation ends.
    pub end: Result<f64, NoCriticalVelocity>,
}

/// A cycle of ringing is smaller than this share of the one before: a damping ratio of 0.017 and more.
const RINGS: f64 = 0.9;

/// Cycles up to the first rest, and behind it.
pub(super) struct Beginning {
    /// How many there are before the velocity slides smoothly for the first time, where they are no oscillation; nothing where it does not
    /// slide smoothly, or oscillates before.
    pub ringing: Option<usize>,
    /// How many there are before oscillation begins.
    pub first: usize,
}

impl Ramp {
    pub fn new(
        time: &[f64],
        command: &[f64],
        velocity: &[f64],
        criterion: ProfileCriterion,
        way: Way,
    ) -> Result<Self, ProfileError> {
        let end = match way.of(critical_samples(time, command, velocity, criterion.oscillation)?) {
            Err(error) if !is_told_by_points(error) => return Err(error.into()),
            end => end.map(|sample| time[sample]),
        };
        let samples = way.samples(command);
        check_reach(criterion.standstill, [&command[samples.clone()], &velocity[samples.clone()]])?;
        let direction = command[way.of([samples.end - 1, samples.start])].signum();
        let [time, command, velocity] =
            [(time, 1.0), (command, direction), (velocity, direction)].map(|(values, sign)| {
                values[samples.clone()].iter().map(|value| value * sign).collect::<Vec<_>>()
            });
        let cycles = match cycles(&time, &command, &velocity, criterion.oscillation) {
            Err(CyclesError::Quiet) => Vec::new(),
            found => found?,
        };
        let mut ramp = Ramp { time, command, velocity, criterion, way, direction, cycles, end };
        if way == Way::Falling {
            ramp.turn_back();
        }
        Ok(ramp)
    }

    /// What comes last comes first.
    fn turn_back(&mut self) {
        self.time.iter_mut().for_each(|time| *time = -*time);
        for values in [&mut self.time, &mut self.command, &mut self.velocity] {
            values.reverse();
        }
        self.cycles.iter_mut().for_each(|cycle| (cycle.begin, cycle.end) = (-cycle.end, -cycle.begin));
        self.cycles.reverse();
        self.end = self.end.map(|time| -time);
    }

    pub fn profile(&self) -> VelocityProfile {
        let jump = self.jump();
        let (points, sections) = self.found(jump.map(|(time, _)| self.point(time)));
        let jump = jump.ok().map(|(_, height)| height * self.direction);
        let points = points.map(|point| point.map(|point| self.turned_point(point)));
        let sections = sections.map(|section| section.map(|section| self.turned_section(section)));
        VelocityProfile { way: self.way, points, sections, jump }
    }

    /// When it breaks away, and the largest velocity that comes of it.
    fn jump(&self) -> Result<(f64, f64), Absent> {
        let ProfileCriterion { oscillation: Criterion { threshold, window }, standstill } = self.criterion;
        let begin = stick_end(&self.time, &self.velocity, Some(standstill)).map_err(|error| match error {
            StickError::Sticks => Absent::Sticks,
            _ => self.way.of([Absent::NoJump, Absent::NoRest]),
        })?;
        let within = |index: &usize| (begin..=begin + window).contains(&self.time[*index]);
        let samples = || (0..self.time.len()).filter(within);
        if samples().all(|index| self.velocity[index] - self.command[index] <= threshold) {
            return Err(self.way.of([Absent::NoJump, Absent::NoSlip]));
        }
        Ok((begin, samples().map(|index| self.velocity[index]).fold(0.0, f64::max)))
    }

    /// What is ringing behind the jump, or too short, and what oscillates.
    pub fn beginning(&self, jump: Option<f64>) -> Beginning {
        let oscillates = Beginning { ringing: None, first: 0 };
        let Some(rest) = self.first_rest(jump.unwrap_or(self.begin())) else { return oscillates };
        let ringing = self.cycles.partition_point(|cycle| cycle.begin < rest);
        let (before, behind) = self.cycles.split_at(ringing);
        let shrinks = before.windows(2).all(|pair| pair[1].amplitude < RINGS * pair[0].amplitude);
        if self.lasts(before) && !(shrinks && self.way == Way::Rising) {
            return oscillates;
        }
        let short = bouts(behind).take_while(|bout| !self.lasts(bout)).map(<[_]>::len).sum::<usize>();
        Beginning { ringing: Some(ringing), first: ringing + short }
    }

    /// When, from an instant on, the velocity first follows the command for four windows.
    fn first_rest(&self, begin: f64) -> Option<f64> {
        let oscillation = self.criterion.oscillation;
        let span = samples_in(&self.time, oscillation).ok()?;
        let steadiness = Steadiness::new(&self.command, &self.velocity, span, oscillation.threshold);
        let first = self.time.partition_point(|instant| *instant < begin);
        steadiness.first_rest(first..self.time.len()).map(|rest| self.time[rest])
    }

    /// Whether the run ends while the command falls, and the velocity does not follow it there.
    pub fn is_cut_off(&self) -> bool {
        self.command[0] > self.criterion.standstill && self.first_rest(self.begin()) != Some(self.begin())
    }

    /// Whether cycles that go on from one to the next last for four windows.
    pub fn lasts(&self, bout: &[Cycle]) -> bool {
        let [Some(first), Some(last)] = [bout.first(), bout.last()] else { return false };
        last.end - first.begin >= REST as f64 * self.criterion.oscillation.window
    }

    pub fn begin(&self) -> f64 {
        self.time[0]
    }

    pub fn finish(&self) -> f64 {
        self.time[self.time.len() - 1]
    }

    pub fn command(&self, time: f64) -> f64 {
        at(&self.time, &self.command, time)
    }

    pub fn point(&self, time: f64) -> ProfilePoint {
        ProfilePoint { time, command: self.command(time), coincides: None }
    }

    /// A point on the run's own clock, in the command's own direction.
    fn turned_point(&self, point: ProfilePoint) -> ProfilePoint {
        let time = point.time * self.way.of([1.0, -1.0]);
        ProfilePoint { time, command: point.command * self.direction, ..point }
    }

    fn turned_section(&self, section: Section) -> Section {
        let command = section.command.map(|command| command * self.direction);
        let backward = |[first, last]: [f64; 2]| [last, first];
        match self.way {
            Way::Rising => Section { command, ..section },
            Way::Falling => Section {
                time: backward(section.time).map(|time| -time),
                command: backward(command),
                frequency: section.frequency.map(backward),
                ..section
            },
        }
    }
}

/// Cycles that go on from one to the next: between two of these the velocity has rested.
pub(super) fn bouts(cycles: &[Cycle]) -> impl Iterator<Item = &[Cycle]> {
    cycles.chunk_by(|cycle, next| cycle.end == next.begin)
}

/// That command or velocity passes standstill somewhere.
fn check_reach(standstill: f64, values: [&[f64]; 2]) -> Result<(), ProfileError> {
    let reached = values.map(largest_of).into_iter().fold(0.0, f64::max);
    if reached > standstill { Ok(()) } else { Err(ProfileError::StandsStill { standstill, reached }) }
}

/// Whether it is the points that tell why there is no critical velocity.
fn is_told_by_points(error: NoCriticalVelocity) -> bool {
    use NoCriticalVelocity::{NotBegun, NotEnded, Quiet};
    matches!(error, Quiet | NotEnded(_) | NotBegun)
}
