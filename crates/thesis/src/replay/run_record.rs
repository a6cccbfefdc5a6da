//! Finished runs of the shipped circuits, and the numbers that are read from them.
//!
//! A run with an overloaded amplifier does not obey the equations, so every reading of a number refuses it.

use super::recipe::BoxError;
use patchcord_analysis::format::format_quantity;
use patchcord_analysis::instruments::{
    Criterion, CriticalVelocity, CriticalVelocityError, Measure, MeasureValue, critical_velocity,
    overload_demand, parameter_line, signal_faults,
};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Program, SignalInfo};
use patchcord_core::patch::Patch;
use patchcord_core::trace::Trace;
use patchcord_draw::picture;
use patchcord_draw::plot::Picture;

/// A finished run with its circuit.
#[derive(Debug)]
pub(super) struct ReplayedRun {
    /// The circuit that was run.
    circuit: Circuit,
    /// The recorded signals.
    pub record: RunRecord,
}

impl ReplayedRun {
    /// Makes a finished run from its circuit and its recording.
    pub(super) fn new(circuit: Circuit, record: RunRecord) -> ReplayedRun {
        ReplayedRun { circuit, record }
    }

    /// The patch that was run.
    pub(super) fn patch(&self) -> &Patch {
        self.circuit.patch()
    }

    /// Returns the parameters with their values in one line.
    pub(super) fn settings(&self) -> String {
        parameter_line(&self.circuit)
    }

    /// Draws the pictures that the patch specifies, with the settings as a note.
    ///
    /// # Errors
    /// If a signal of a picture is not recorded or cannot be drawn.
    pub(super) fn pictures(&self) -> Result<Vec<Picture>, BoxError> {
        let specs = &self.patch().pictures;
        let settings = self.settings();
        let faults = signal_faults(&self.circuit, &self.record.trace);
        let drawn = specs.iter().map(|spec| picture(&self.record.trace, spec, Some(&settings), &faults));
        Ok(drawn.collect::<Result<_, _>>()?)
    }

    /// Returns the run.
    ///
    /// # Errors
    /// If an amplifier was overloaded.
    pub(super) fn without_overload(self) -> Result<ReplayedRun, BoxError> {
        self.record.reject_overload()?;
        Ok(self)
    }
}

/// The recorded signals of a run.
#[derive(Debug)]
pub(super) struct RunRecord {
    /// Names and units of the signals, in the order of the program.
    signals: Vec<SignalInfo>,
    /// The samples, and the overloads.
    pub trace: Trace,
}

impl RunRecord {
    /// Makes a recording from a trace and the signals of its program, by which measures are parsed.
    pub(super) fn new(program: &Program, trace: Trace) -> RunRecord {
        RunRecord { signals: program.signals().to_vec(), trace }
    }

    /// Returns the samples of a signal in its unit. "t" is time, in s.
    ///
    /// # Errors
    /// If the signal is not recorded.
    pub(super) fn values(&self, signal: &str) -> Result<Vec<f64>, BoxError> {
        if signal == "t" {
            return Ok(self.trace.time.clone());
        }
        self.trace.values(signal).ok_or_else(|| format!("{signal} is not recorded").into())
    }

    /// Returns the points of one signal against another. Each signal is divided by the number next to its name, which
    /// is the unit of its axis.
    ///
    /// # Errors
    /// If one of the signals is not recorded.
    pub(super) fn points(&self, along: (&str, f64), up: (&str, f64)) -> Result<Vec<(f64, f64)>, BoxError> {
        let [along_values, up_values] = [self.values(along.0)?, self.values(up.0)?];
        Ok(along_values.iter().zip(&up_values).map(|(x, y)| (x / along.1, y / up.1)).collect())
    }

    /// Returns the points of the curve of one signal against another, from every step of the run. Each signal is divided
    /// by the number next to its name, which is the unit of its axis.
    ///
    /// # Errors
    /// If the run did not follow the curve.
    pub(super) fn curve(&self, along: (&str, f64), up: (&str, f64)) -> Result<Vec<(f64, f64)>, BoxError> {
        let missing = || format!("the curve of {} against {} was not followed", up.0, along.0);
        let curve = self.trace.curve(along.0, up.0).ok_or_else(missing)?;
        Ok(curve.values(0).zip(curve.values(1)).map(|(x, y)| (x / along.1, y / up.1)).collect())
    }

    /// Returns the critical velocities of the profile in m/s, by the usual criterion: swings above 0.25 mm/s within
    /// 0.04 s are oscillation.
    ///
    /// # Errors
    /// If an amplifier was overloaded.
    pub(super) fn critical_velocity(&self) -> Result<CriticalVelocity, BoxError> {
        self.critical_velocity_by(Criterion::USUAL)
    }

    /// Returns the critical velocities of the profile in m/s, by another criterion.
    ///
    /// The velocity command is `v_i` and the output velocity `v_o`; both must be recorded.
    ///
    /// # Errors
    /// If an amplifier was overloaded.
    pub(super) fn critical_velocity_by(&self, criterion: Criterion) -> Result<CriticalVelocity, BoxError> {
        self.reject_overload()?;
        let (command, velocity) = (self.values("v_i")?, self.values("v_o")?);
        Ok(critical_velocity(&self.trace.time, &command, &velocity, criterion))
    }

    /// Returns the number that a measure reads, such as "frequency:v_o,last=1". If it reads several, the first is
    /// returned.
    ///
    /// # Errors
    /// If the measure reads no number, or if an amplifier was overloaded. The error states the reason.
    pub(super) fn measure(&self, text: &str) -> Result<f64, BoxError> {
        self.reject_overload()?;
        let cells = Measure::parse(text, &self.signals)?.read(&self.trace);
        match cells.into_iter().next() {
            Some(Ok(MeasureValue::Number(number))) => Ok(number),
            Some(Err(reason)) => Err(format!("{text}: {reason}").into()),
            _ => Err(format!("{text} is not a number").into()),
        }
    }

    /// Refuses runs with an overloaded amplifier. Their signals do not obey the equations, so no number may be read
    /// from them.
    fn reject_overload(&self) -> Result<(), BoxError> {
        self.overload_text().map_or(Ok(()), |overload| Err(overload.into()))
    }

    /// Describes the overload lamps that lit. `None` if there was no overload.
    pub(super) fn overload_text(&self) -> Option<String> {
        let first = self.trace.overloads().next()?;
        let more = match self.trace.overloads().count() - 1 {
            0 => String::new(),
            more => format!(", and {more} more"),
        };
        let demand = overload_demand(first);
        Some(format!("overload: {} from {:.3} s on, {demand}{more}", first.element, first.time))
    }
}

/// Formats a critical velocity, or the reason why there is none.
pub(super) fn format_critical_velocity(velocity: Result<f64, CriticalVelocityError>) -> String {
    velocity.map_or_else(|none| none.to_string(), |velocity| format_quantity(velocity, "m/s"))
}
