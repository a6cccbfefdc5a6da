//! The simulation of a slideway: from parameters to a patch, to a run, and to the critical velocity.
//!
//! The scales of the circuit start at the smallest set that takes all values. They are enlarged if an amplifier is
//! overloaded. The command is extended if oscillation has not ended at its maximum.

use std::ops::Range;

use super::document::{MULTIPLES, PatchRequest, template};
use super::error::ChainError;
use super::parameters::Parameters;
use super::ramp::Ramp;
use super::settings::Settings;
use patchcord_analysis::format::format_quantity;
use patchcord_analysis::instruments::{
    Criterion, CriticalVelocity, CriticalVelocityError, MissingPointError, ProfileCriterion, RampDirection,
    critical_velocity, velocity_profile,
};
use patchcord_core::circuit::{Circuit, Element};
use patchcord_core::ir::Program;
use patchcord_core::patch::{Amount, Patch};
use patchcord_core::solve::{self, RunSettings};
use patchcord_core::trace::Trace;

/// A slideway on the machine: its circuit, the run under a velocity command that rises and falls, and the critical
/// velocities read from it.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::chain::{Inputs, Parameters, Settings, Simulation};
/// use patchcord_thesis::slideway::units::{KGF, POISE};
///
/// let inputs = Inputs::of_thesis(0.34 * POISE, 450.0 * KGF, 20e6);
/// let parameters = Parameters::of_design(&inputs.design()?)?;
/// let simulation = Simulation::new(&inputs.title(), &parameters, &Settings::default())?;
///
/// // Oscillation ends at a higher command than the one at which it begins again.
/// assert!(simulation.critical.rising? > simulation.critical.falling?);
/// // The patch can be run alone, and its settings are those of the potentiometers.
/// assert_eq!(simulation.patch().file(), "slideway.json");
/// assert!(simulation.pots().iter().all(|pot| (0.0..=1.0).contains(&pot.setting)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Simulation {
    /// The parameters of the circuit.
    pub parameters: Parameters,
    /// Ratio of the scales to scale set B: the smallest of `MULTIPLES` with which no amplifier exceeds 100 V.
    pub multiple: f64,
    /// The circuit. A run of its patch reproduces this run.
    pub circuit: Circuit,
    /// The velocity command.
    pub ramp: Ramp,
    /// The recorded signals.
    pub trace: Trace,
    /// The criterion of oscillation.
    pub criterion: Criterion,
    /// The command in m/s at which oscillation ends while the command rises, and begins while it falls.
    pub critical: CriticalVelocity,
    /// The critical velocity with half the threshold and with twice the threshold, as a measure of its sensitivity.
    pub nearby_thresholds: [CriticalVelocity; 2],
}

/// A potentiometer with its setting.
#[derive(Debug, Clone, PartialEq)]
pub struct PotSetting {
    /// Its name on the machine, such as "PA3"; two names if the element takes two potentiometers.
    pub name: String,
    /// Setting, 0 ... 1.
    pub setting: f64,
    /// The formula in the patch that gives the setting.
    pub formula: String,
}

/// Maximum number of extensions of the rise. None is made if the motion cannot die away within them.
const MAX_EXTENSIONS: i32 = 3;

/// Signal of the velocity command.
pub(super) const COMMAND: &str = "v_i";
/// Signal of the output velocity.
pub(super) const VELOCITY: &str = "v_o";

impl Simulation {
    /// Runs the circuit of Fig 8.16 with these parameters.
    ///
    /// The command rises until oscillation has ended. It is not extended if `v_turn` is set, or if the damping is too
    /// small for oscillation to end within the permitted extensions ([`Simulation::min_decay_time`]). The scales are
    /// chosen so that no amplifier is overloaded. Only the velocity command is taken from the parameters that
    /// `settings` sets.
    ///
    /// # Errors
    /// If no scales take the parameters, the run fails, or the critical velocity cannot be read.
    pub fn new(title: &str, parameters: &Parameters, settings: &Settings) -> Result<Self, ChainError> {
        let template = template();
        let mut ramp = Ramp::initial(template, parameters, settings)?;
        let mut scale = PatchRequest { template, title, parameters, ramp: &ramp, settings }.first_scale();
        let mut extensions_left = MAX_EXTENSIONS;
        loop {
            let request = PatchRequest { template, title, parameters, ramp: &ramp, settings };
            let simulation = Simulation::at_scale(&request, MULTIPLES[scale])?;
            match simulation.critical.rising {
                _ if simulation.is_overloaded() => scale = simulation.larger_scale(&request, scale)?,
                Err(CriticalVelocityError::NotEnded(_))
                    if settings.value("v_turn").is_none()
                        && ramp.turn + simulation.min_decay_time() < ramp.turn_after(extensions_left) =>
                {
                    (ramp, extensions_left) = (ramp.extended(), extensions_left - 1);
                }
                _ => return simulation.require_reading(),
            }
        }
    }

    /// One run, with scales that are `multiple` times scale set B.
    fn at_scale(request: &PatchRequest<'_>, multiple: f64) -> Result<Self, ChainError> {
        let PatchRequest { parameters, ramp, settings, .. } = *request;
        let circuit = Circuit::new(&request.patch(multiple)?)?;
        // The run holds at an overload: results after it are invalid, and amplifiers at their limits are slow to
        // simulate.
        let run = RunSettings::of(&circuit)?.with_backend(settings.backend).with_hold_on_overload();
        let trace = solve::run(&Program::new(&circuit)?, &run).map_err(|stopped| stopped.error)?;
        let criterion = settings.criterion(parameters)?;
        let read =
            |factor: f64| read(&trace, Criterion { threshold: factor * criterion.threshold, ..criterion });
        let (critical, nearby_thresholds) = (read(1.0), [read(0.5), read(2.0)]);
        Ok(Simulation {
            parameters: *parameters,
            multiple,
            circuit,
            ramp: *ramp,
            trace,
            criterion,
            critical,
            nearby_thresholds,
        })
    }

    /// Whether an amplifier was overloaded, which makes the run invalid.
    fn is_overloaded(&self) -> bool {
        self.trace.overloads().next().is_some()
    }

    /// The next larger scales that take the parameters, as an index into [`MULTIPLES`].
    fn larger_scale(&self, request: &PatchRequest<'_>, scale: usize) -> Result<usize, ChainError> {
        let larger = scale + 1;
        if MULTIPLES.get(larger).is_some_and(|multiple| request.check(*multiple).is_ok()) {
            return Ok(larger);
        }
        let element =
            self.trace.overloads().next().map_or_else(String::new, |overload| overload.element.clone());
        Err(ChainError::Overload { element, velocity_per_volt: self.velocity_per_volt() })
    }

    /// The simulation, if its rising critical velocity is known: a value, no oscillation, or no end before the turn.
    fn require_reading(self) -> Result<Self, ChainError> {
        match self.critical.rising {
            Ok(_) | Err(CriticalVelocityError::NoOscillation | CriticalVelocityError::NotEnded(_)) => {
                Ok(self)
            }
            Err(error) => Err(ChainError::Unread(error)),
        }
    }

    /// The velocity in m/s that one volt represents.
    pub fn velocity_per_volt(&self) -> f64 {
        self.trace.track(COMMAND).map_or(f64::NAN, |track| track.per_volt)
    }

    /// The minimum time in s in which the motion at the end of the rise decays below the threshold: 2 M / f x
    /// ln(swing / threshold).
    ///
    /// Only the viscous coefficient f damps the motion above VcL. A swing that reaches below VcL lasts longer. The
    /// result is 0 if the command ends below VcL or the swing is already below the threshold.
    pub fn min_decay_time(&self) -> f64 {
        let Parameters { mass, damping, limit, .. } = self.parameters;
        let swing = self.swing(self.last_rise_window()).min(2.0 * self.ramp.top());
        if self.ramp.top() <= limit || swing <= self.criterion.threshold {
            return 0.0;
        }
        2.0 * mass / damping * (swing / self.criterion.threshold).ln()
    }

    /// Whether the table only rings as it breaks away while the command rises, and does not oscillate later.
    ///
    /// The rising critical velocity is then the command at which this ringing ends.
    pub fn is_ringing_only(&self) -> bool {
        let [command, velocity] = [COMMAND, VELOCITY].map(|name| self.trace.values(name).unwrap_or_default());
        let criterion = ProfileCriterion::usual(self.criterion);
        let profile =
            velocity_profile(&self.trace.time, &command, &velocity, criterion, RampDirection::Rising);
        let only_rings = profile.is_ok_and(|profile| profile.points[4] == Err(MissingPointError::RingsOnly));
        only_rings && self.critical.rising.is_ok()
    }

    /// The samples of the last window of the rise.
    fn last_rise_window(&self) -> Range<usize> {
        let end = self.trace.time.partition_point(|time| *time <= self.ramp.turn);
        let begin = self.trace.time.partition_point(|time| *time < self.ramp.turn - self.criterion.window);
        begin..end
    }

    /// The minimum velocity within the last window of the rise, in m/s.
    fn min_velocity_at_turn(&self) -> f64 {
        let velocity = self.trace.values(VELOCITY).unwrap_or_default();
        velocity[self.last_rise_window()].iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The peak-to-peak swing in m/s of velocity minus command within a range of samples.
    fn swing(&self, samples: Range<usize>) -> f64 {
        let [command, velocity] = [COMMAND, VELOCITY].map(|name| self.trace.values(name).unwrap_or_default());
        let errors = samples.map(|sample| velocity[sample] - command[sample]);
        let [min, max] = errors
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[min, max], error| [min.min(error), max.max(error)]);
        max - min
    }

    /// A warning if the oscillation is only ringing, or if its end is not seen. `None` otherwise.
    pub(super) fn note(&self) -> Option<String> {
        if self.is_ringing_only() {
            let note = "it rings as it breaks away, and does not oscillate after that: the rising critical velocity is \
                        the command at which this ringing ends";
            return Some(note.to_owned());
        }
        let Err(CriticalVelocityError::NotEnded(top)) = self.critical.rising else { return None };
        let (top, damping) = (format_quantity(top, "m/s"), format_quantity(self.parameters.damping, "N s/m"));
        let time = self.min_decay_time();
        let decay = match time {
            0.0 => return None,
            time if time.is_finite() => format!("needs at least {} to damp it", format_quantity(time, "s")),
            _ => "never damps it".to_owned(),
        };
        let continues = format!("oscillation continues at a command of {top}, above VcL");
        // A swing that reaches below VcL is not damped by f alone.
        Some(if self.min_velocity_at_turn() > self.parameters.limit {
            format!("{continues}; f = {damping} {decay}")
        } else {
            format!("{continues}, and velocity falls below VcL, where solid friction acts")
        })
    }

    /// The change of the command within a window, in m/s. This is the best possible accuracy of a critical velocity.
    pub fn resolution(&self) -> f64 {
        self.ramp.rate * self.criterion.window
    }

    /// The patch of the circuit.
    pub fn patch(&self) -> &Patch {
        self.circuit.patch()
    }

    /// The potentiometers with their settings, in the order of the elements.
    pub fn pots(&self) -> Vec<PotSetting> {
        let elements = self.circuit.elements();
        elements.into_iter().filter_map(|element| self.pot(element)).collect()
    }

    /// The setting of an element. `None` if the element has no setting that is a formula.
    fn pot(&self, element: &Element) -> Option<PotSetting> {
        let rows = element.kind.settings.iter().zip(&element.settings);
        let (_, value) = rows.into_iter().find(|(row, _)| row.name == "setting")?;
        let Amount::Formula(formula) = &value.as_ref()?.value else { return None };
        let setting = formula.evaluate(self.circuit.quantities()).ok()?;
        let names =
            element.kind.parts.first().map(|takes| self.circuit.part_names(&element.name, takes.part));
        let joined = names.filter(|names| !names.is_empty()).map(|names| names.join(", "));
        let name = joined.unwrap_or_else(|| element.name.clone());
        Some(PotSetting { name, setting, formula: formula.text().to_owned() })
    }
}

/// The critical velocities of a trace of [`COMMAND`] and [`VELOCITY`].
fn read(trace: &Trace, criterion: Criterion) -> CriticalVelocity {
    let values = |name| trace.values(name).unwrap_or_default();
    critical_velocity(&trace.time, &values(COMMAND), &values(VELOCITY), criterion)
}
