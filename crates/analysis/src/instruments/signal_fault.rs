//! The signals that an overload makes wrong, and from when.
//!
//! An overloaded amplifier does not obey its equation. Its output is wrong from then on, and so is every output to
//! which a chain of cords leads. A new initial condition ends this.

use patchcord_core::circuit::Circuit;
use patchcord_core::machines::REFERENCE;
use patchcord_core::trace::{Overload, Trace};

/// A recorded signal whose values are wrong from a moment on in one run.
#[derive(Debug, Clone, PartialEq)]
pub struct SignalFault {
    /// Name of the signal.
    pub signal: String,
    /// Index of the run, from 0.
    pub repetition: usize,
    /// The moment, in seconds of the recorder's clock.
    pub time: f64,
    /// The cause: "A3 over 100 V".
    pub cause: String,
}

/// The recorded signals that overloads make wrong: for each run and signal the first overload at the amplifier of the
/// signal or upstream of it.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::signal_faults;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // S1 needs 1000 V/s times t and is overloaded from t = 0.1 s on. B1 reads it.
/// let ramp = ElementBuilder::new("integrator").cords("x1", ["-100"]);
/// let summer = ElementBuilder::new("summer").cords("x10", ["A1"]);
/// let patch = PatchBuilder::new("overload").element("A1", ramp).element("S1", summer);
/// let patch = patch.element("B1", ElementBuilder::new("inverter").cord("in", "S1")).run(0.5, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let trace = run(&Program::new(&circuit)?, &RunSettings::of(&circuit)?)?;
///
/// let faults = signal_faults(&circuit, &trace);
/// let signals: Vec<&str> = faults.iter().map(|fault| fault.signal.as_str()).collect();
/// assert_eq!(signals, ["S1", "B1"], "A1 is right");
/// assert_eq!(faults[1].cause, "S1 over 100 V");
/// assert!((faults[1].time - 0.1).abs() < 1e-2);
/// # Ok(())
/// # }
/// ```
pub fn signal_faults(circuit: &Circuit, trace: &Trace) -> Vec<SignalFault> {
    let signals = recorded_signals(circuit, trace);
    let mut faults = Vec::new();
    for (repetition, run) in trace.repetitions.iter().enumerate() {
        let first = first_overloads(circuit, &run.overloads);
        for (signal, element) in &signals {
            faults.extend(first[*element].map(|overload| SignalFault {
                signal: (*signal).to_owned(),
                repetition,
                time: overload.time,
                cause: format!("{} over {REFERENCE} V", overload.element),
            }));
        }
    }
    faults
}

/// The names of the recorded signals, each with the index of its element. Derivatives are left out.
fn recorded_signals<'t>(circuit: &Circuit, trace: &'t Trace) -> Vec<(&'t str, usize)> {
    let tracks = trace.tracks.iter().filter(|track| track.derivative.is_none());
    let element = |name: &str| {
        let mut points = circuit.signals().iter();
        points.find(|point| point.name == name).map(|point| point.element)
    };
    tracks.filter_map(|track| Some((track.name.as_str(), element(&track.name)?))).collect()
}

/// For every element, the first overload at the element or upstream of it. `overloads` are those of one run in order
/// of time.
fn first_overloads<'t>(circuit: &Circuit, overloads: &'t [Overload]) -> Vec<Option<&'t Overload>> {
    let elements = circuit.elements();
    let mut first = vec![None; elements.len()];
    if overloads.is_empty() {
        return first;
    }
    let readers = readers(circuit, elements.len());
    for overload in overloads {
        let mut pending: Vec<usize> =
            elements.iter().position(|element| element.name == overload.element).into_iter().collect();
        while let Some(element) = pending.pop() {
            if first[element].is_none() {
                first[element] = Some(overload);
                pending.extend(&readers[element]);
            }
        }
    }
    first
}

/// For each of the elements, the indices of the elements that read its output.
fn readers(circuit: &Circuit, count: usize) -> Vec<Vec<usize>> {
    let mut readers = vec![Vec::new(); count];
    for reader in 0..count {
        circuit.cords(reader).into_iter().for_each(|(from, _)| readers[from].push(reader));
    }
    readers
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    use patchcord_core::trace::{Demand, Repetition, Track};

    fn overload(element: &str, time: f64) -> Overload {
        Overload { element: element.to_owned(), time, demand: Demand::Peak(120.0), caused_by: None }
    }

    #[test]
    fn the_first_overload_upstream_counts_in_each_run() {
        let inverter = |from: &str| ElementBuilder::new("inverter").cord("in", from);
        let patch = PatchBuilder::new("chain").element("B1", inverter("+100")).element("B2", inverter("B1"));
        let circuit = Circuit::new(&patch.element("B3", inverter("B2")).build().unwrap()).unwrap();
        let runs = [vec![], vec![overload("B2", 1.0), overload("B1", 2.0)]];
        let trace = Trace {
            tracks: ["B1", "B2", "B3"].map(|name| Track::new(name, "V", 1.0)).to_vec(),
            repetitions: runs
                .map(|overloads| Repetition { overloads, ..Repetition::default() })
                .into_iter()
                .collect(),
            ..Trace::default()
        };
        let faults: Vec<_> = signal_faults(&circuit, &trace)
            .into_iter()
            .map(|fault| (fault.signal, fault.repetition, fault.time, fault.cause))
            .collect();
        let expected = [("B1", 2.0, "B1"), ("B2", 1.0, "B2"), ("B3", 1.0, "B2")];
        let expected = expected
            .map(|(signal, time, element)| (signal.to_owned(), 1, time, format!("{element} over 100 V")));
        assert_eq!(faults, expected);
    }
}
