//! From parameters to a patch, a run, and the critical velocity.

use std::ops::Range;

use super::document::{Asked, MULTIPLES, template};
use super::error::ChainError;
use super::parameters::Parameters;
use super::ramp::Ramp;
use super::settings::Settings;
use patchcord_analysis::instruments::{
    Absent, Criterion, CriticalVelocity, NoCriticalVelocity, ProfileCriterion, Way, critical_velocity,
    velocity_profile, with_unit,
};
use patchcord_core::circuit::{Circuit, Element};
use patchcord_core::ir::Program;
use patchcord_core::patch::{Amount, Patch};
use patchcord_core::solve::{self, RunSettings};
use patchcord_core::trace::Trace;

/// A slideway on the machine: its circuit, the run under a velocity command that rises and falls, and what was read.
#[derive(Debug)]
pub struct Simulation {
    /// What the circuit was set by.
    pub parameters: Parameters,
    /// How many times scale set B its scales are: as little as leaves every amplifier below 100 V.
    pub multiple: f64,
    /// The circuit; its patch is a patch like any other, and a run of it is this run.
    pub circuit: Circuit,
    /// The command.
    pub ramp: Ramp,
    /// What was recorded.
    pub trace: Trace,
    /// When it counted as oscillating.
    pub criterion: Criterion,
    /// At which command oscillation ends while it rises, and begins while it falls, in m/s.
    pub critical: CriticalVelocity,
    /// The same with half of the threshold, and with twice as much: how much hangs on it.
    pub nearby: [CriticalVelocity; 2],
}

/// A potentiometer with its setting.
#[derive(Debug, Clone, PartialEq)]
pub struct Pot {
    /// Its address.
    pub name: String,
    /// Its setting, 0 ... 1.
    pub setting: f64,
    /// The formula that it follows from.
    pub formula: String,
}

/// So often the command is made to rise longer, and not at all where the motion cannot die away by then.
const MOST_LONGER: i32 = 3;

/// What the critical velocity is read from.
pub(super) const COMMAND: &str = "v_i";
pub(super) const VELOCITY: &str = "v_o";

impl Simulation {
    /// Runs the circuit of Fig 8.16 with these parameters. The command rises until oscillation has ended, unless `v_turn` is set or so
    /// little damps the table that no end of it is in sight ([`Simulation::dies_in`]); the scales are such that no amplifier is
    /// overloaded. Of what is set only the command counts, not what would set these parameters.
    ///
    /// # Errors
    /// Where no scales take the parameters, or the run cannot be made.
    pub fn new(title: &str, parameters: &Parameters, settings: &Settings) -> Result<Self, ChainError> {
        let template = template();
        let mut ramp = Ramp::first(template, parameters, settings)?;
        let mut scale = Asked { template, title, parameters, ramp: &ramp, settings }.first_scale();
        let mut left = MOST_LONGER;
        loop {
            let asked = Asked { template, title, parameters, ramp: &ramp, settings };
            let made = Simulation::at(&asked, MULTIPLES[scale])?;
            match made.critical.rising {
                _ if made.is_overloaded() => scale = made.larger_scale(&asked, scale)?,
                Err(NoCriticalVelocity::NotEnded(_))
                    if settings.value("v_turn").is_none()
                        && ramp.turn + made.dies_in() < ramp.latest_turn(left) =>
                {
                    (ramp, left) = (ramp.longer(), left - 1);
                }
                _ => return made.if_read(),
            }
        }
    }

    fn at(asked: &Asked<'_>, multiple: f64) -> Result<Self, ChainError> {
        let Asked { parameters, ramp, settings, .. } = *asked;
        let circuit = Circuit::new(&asked.patch(multiple)?, &[])?;
        // After an overload nothing counts, and its limits are slow to follow.
        let run =
            RunSettings { backend: settings.backend, hold_on_overload: true, ..RunSettings::of(&circuit)? };
        let trace = solve::run(&Program::new(&circuit)?, &run).map_err(|stopped| stopped.error)?;
        let criterion = settings.criterion(parameters)?;
        let read =
            |factor: f64| read(&trace, Criterion { threshold: factor * criterion.threshold, ..criterion });
        let (critical, nearby) = (read(1.0), [read(0.5), read(2.0)]);
        Ok(Simulation {
            parameters: *parameters,
            multiple,
            circuit,
            ramp: *ramp,
            trace,
            criterion,
            critical,
            nearby,
        })
    }

    /// A run with an overload is no result.
    fn is_overloaded(&self) -> bool {
        self.trace.overloads().next().is_some()
    }

    /// The next larger scales that take the parameters.
    fn larger_scale(&self, asked: &Asked<'_>, scale: usize) -> Result<usize, ChainError> {
        let larger = scale + 1;
        if MULTIPLES.get(larger).is_some_and(|multiple| asked.check(*multiple).is_ok()) {
            return Ok(larger);
        }
        let element = self.trace.overloads().next().map_or_else(String::new, |lit| lit.element.clone());
        Err(ChainError::Overload { element, velocity_per_volt: self.velocity_per_volt() })
    }

    /// The run, if its critical velocity can be read: there is one, or none, or it lies beyond the turn.
    fn if_read(self) -> Result<Self, ChainError> {
        match self.critical.rising {
            Ok(_) | Err(NoCriticalVelocity::Quiet | NoCriticalVelocity::NotEnded(_)) => Ok(self),
            Err(error) => Err(ChainError::Unread(error)),
        }
    }

    /// What a volt of velocity stands for, in m/s.
    pub fn velocity_per_volt(&self) -> f64 {
        self.trace.track(COMMAND).map_or(f64::NAN, |track| track.per_volt)
    }

    /// How long the motion at the end of the rise takes at least to get below the threshold, in s: 2 M / f x ln(swing / threshold). Beyond
    /// VcL only the viscous coefficient damps it, and a swing that comes down below VcL lasts longer; where the command ends below VcL,
    /// nothing is said (0).
    pub fn dies_in(&self) -> f64 {
        let Parameters { mass, damping, limit, .. } = self.parameters;
        let swing = self.swing(self.last_of_rise()).min(2.0 * self.ramp.top());
        if self.ramp.top() <= limit || swing <= self.criterion.threshold {
            return 0.0;
        }
        2.0 * mass / damping * (swing / self.criterion.threshold).ln()
    }

    /// Whether it only rings as it breaks away while the command rises, and does not oscillate after that: what is read as the rising
    /// critical velocity is where that ringing ends.
    pub fn only_rings(&self) -> bool {
        let [command, velocity] = [COMMAND, VELOCITY].map(|name| self.trace.values(name).unwrap_or_default());
        let criterion = ProfileCriterion::usual(self.criterion);
        let profile = velocity_profile(&self.trace.time, &command, &velocity, criterion, Way::Rising);
        let rings = profile.is_ok_and(|profile| profile.points[4] == Err(Absent::RingsOnly));
        rings && self.critical.rising.is_ok()
    }

    /// The samples of the last window of the rise.
    fn last_of_rise(&self) -> Range<usize> {
        let end = self.trace.time.partition_point(|time| *time <= self.ramp.turn);
        let begin = self.trace.time.partition_point(|time| *time < self.ramp.turn - self.criterion.window);
        begin..end
    }

    /// The least velocity within the last window of the rise.
    fn least_at_turn(&self) -> f64 {
        let velocity = self.trace.values(VELOCITY).unwrap_or_default();
        velocity[self.last_of_rise()].iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// By how much the velocity less the command swings within some samples, peak to peak.
    fn swing(&self, samples: Range<usize>) -> f64 {
        let [command, velocity] = [COMMAND, VELOCITY].map(|name| self.trace.values(name).unwrap_or_default());
        let off = samples.map(|sample| velocity[sample] - command[sample]);
        let ends = off
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], off| [least.min(off), most.max(off)]);
        ends[1] - ends[0]
    }

    /// What the reader should know of an oscillation that is only ringing, or whose end is not seen.
    pub(super) fn note(&self) -> Option<String> {
        if self.only_rings() {
            let told = "it rings as it breaks away, and does not oscillate after that: while the command rises, what is read is where \
                        that ringing ends";
            return Some(told.to_owned());
        }
        let Err(NoCriticalVelocity::NotEnded(top)) = self.critical.rising else { return None };
        let (top, damping) = (with_unit(top, "m/s"), with_unit(self.parameters.damping, "N s/m"));
        let time = self.dies_in();
        let why = match time {
            0.0 => return None,
            time if time.is_finite() => format!("takes {} at least to damp it", with_unit(time, "s")),
            _ => "never damps it".to_owned(),
        };
        let goes_on = format!("oscillation goes on at a command of {top}, beyond VcL");
        // What comes down below VcL is not damped by f alone.
        Some(if self.least_at_turn() > self.parameters.limit {
            format!("{goes_on}; f = {damping} {why}")
        } else {
            format!("{goes_on}, and comes down below VcL, where there is solid friction")
        })
    }

    /// By how much the command changes within a window, in m/s: what a critical velocity is known to at best.
    pub fn resolution(&self) -> f64 {
        self.ramp.rate * self.criterion.window
    }

    /// Its patch.
    pub fn patch(&self) -> &Patch {
        self.circuit.patch()
    }

    /// The potentiometers and how they are set.
    pub fn pots(&self) -> Vec<Pot> {
        let elements = self.circuit.elements();
        elements.into_iter().filter_map(|element| self.pot(element)).collect()
    }

    fn pot(&self, element: &Element) -> Option<Pot> {
        let rows = element.kind.settings.iter().zip(&element.settings);
        let (_, given) = rows.into_iter().find(|(row, _)| row.name == "setting")?;
        let Amount::Formula(formula) = &given.as_ref()?.value else { return None };
        let setting = formula.evaluate(self.circuit.quantities()).ok()?;
        let part = element.kind.parts.first().map(|takes| self.circuit.part_names(&element.name, takes.part));
        let parts = part.filter(|names| !names.is_empty()).map(|names| names.join(", "));
        let name = parts.unwrap_or_else(|| element.name.clone());
        Some(Pot { name, setting, formula: formula.text().to_owned() })
    }
}

fn read(trace: &Trace, criterion: Criterion) -> CriticalVelocity {
    let values = |name| trace.values(name).unwrap_or_default();
    critical_velocity(&trace.time, &values(COMMAND), &values(VELOCITY), criterion)
}
