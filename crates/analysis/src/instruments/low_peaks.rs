//! Amplifiers whose output stays small, so that noise and offsets of a real machine dominate it.

use std::collections::HashMap;

use super::rescaling::{
    Rescaling, element_index, enlargement, inverted_by, larger_output, scale_change, scaled_signal,
};
use patchcord_core::circuit::{Circuit, Element, SignalPoint};
use patchcord_core::elements::{Family, OutputStage};
use patchcord_core::trace::{AmplifierPeak, Trace};

/// Peak in volts below which an amplifier is poorly used: a twentieth of full scale.
pub const LOW_PEAK: f64 = 5.0;
/// Peak in volts up to which an output counts as constantly 0 V.
const ZERO_PEAK: f64 = 1e-6;
/// Smallest factor for which all signals of a scale change together. With a smaller one, another signal of the scale
/// uses the range.
const LEAST_SHARED_FACTOR: f64 = 10.0;

/// The amplifiers whose output peaks below 5 V in a run and is not constantly 0 V, in the order of their peaks.
///
/// The run has to find the [peaks](patchcord_core::solve::RunSettings::with_amplifier_peaks). Drives, pots, relays and
/// networks of diodes do not count.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::low_peaks;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// // dx/dt = -x, from 2 V. S is 10 times as large.
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 2);
/// let summer = ElementBuilder::new("summer").cords("x10", ["A1"]);
/// let patch = PatchBuilder::new("decay").element("A1", decay).element("S", summer).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let trace = run(&Program::new(&circuit)?, &RunSettings::of(&circuit)?.with_amplifier_peaks())?;
/// let low: Vec<_> = low_peaks(&circuit, &trace).iter().map(|peak| (&peak.element[..], peak.volts)).collect();
/// assert_eq!(low, [("A1", 2.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn low_peaks<'t>(circuit: &Circuit, trace: &'t Trace) -> Vec<&'t AmplifierPeak> {
    let elements: HashMap<&str, &Element> =
        circuit.elements().into_iter().map(|element| (element.name.as_str(), element)).collect();
    let is_low = |peak: &&AmplifierPeak| {
        (ZERO_PEAK..LOW_PEAK).contains(&peak.volts)
            && elements.get(peak.element.as_str()).is_some_and(|element| is_amplifier(element))
    };
    let mut low: Vec<&AmplifierPeak> = trace.amplifier_peaks.iter().filter(is_low).collect();
    low.sort_by(|one, other| one.volts.total_cmp(&other.volts));
    low
}

/// Whether an element is an amplifier, and no drive.
fn is_amplifier(element: &Element) -> bool {
    element.kind.family == Family::Computing && element.kind.output != OutputStage::Passive
}

/// How to bring an amplifier with a low peak between 50 and 95 V, as a sentence without a full stop. For an amplifier that
/// only inverts another one with a low peak, it is the remedy of the other.
///
/// If a signal with a scale is at the amplifier, one volt must represent less. If another signal with this scale needs
/// the range, the signal gets a scale of its own. Without a scale, the gains must be larger.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::{low_peak_remedy, low_peaks};
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 2);
/// let patch = PatchBuilder::new("decay").scale("length", 0.4, "mm").element("A1", decay).run(1.0, 1e-3);
/// let circuit = Circuit::new(&patch.signal("x", "A1", "length", 1.0).build()?)?;
/// let trace = run(&Program::new(&circuit)?, &RunSettings::of(&circuit)?.with_amplifier_peaks())?;
/// assert_eq!(
///     low_peak_remedy(&circuit, &trace, low_peaks(&circuit, &trace)[0]),
///     "let 1 V of x at A1 represent 1/40 as much (\"per_volt\": 0.01 in place of 0.4 in the scale \"length\"), and \
///      adapt the gains"
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn low_peak_remedy(circuit: &Circuit, trace: &Trace, low: &AmplifierPeak) -> String {
    let Some(element) = element_index(circuit, &low.element).map(|index| origin(circuit, trace, index))
    else {
        return String::new();
    };
    let factor = enlargement(low.volts);
    let Some((point, scale)) = scaled_signal(circuit, element) else {
        return larger_output(circuit, element, factor);
    };
    let shared = enlargement(largest_with_scale(circuit, trace, scale).max(low.volts));
    let change = scale_change(circuit, element, (point, scale), Rescaling::Reduce(shared.min(factor)));
    if shared >= LEAST_SHARED_FACTOR {
        return format!("{change}, and adapt the gains");
    }
    own_scale(circuit, (point, scale), factor)
}

/// The remedy for a signal whose scale other signals need.
fn own_scale(circuit: &Circuit, (point, scale): (&SignalPoint, usize), factor: f64) -> String {
    let (name, _) = circuit.derived(scale);
    format!(
        "give {} a scale of its own, in which 1 V represents 1/{factor} of 1 V in \"{name}\", and adapt the gains",
        point.name
    )
}

/// The amplifier behind amplifiers that only invert it, if its peak is low too.
fn origin(circuit: &Circuit, trace: &Trace, element: usize) -> usize {
    let mut origin = element;
    // A ring of inverters has no origin.
    for _ in 0..circuit.elements().len() {
        let source = inverted_by(circuit, origin).filter(|source| {
            let is_low = peak(circuit, trace, *source).is_some_and(|volts| volts < LOW_PEAK);
            is_low && is_amplifier(circuit.element(*source))
        });
        match source {
            Some(source) => origin = source,
            None => break,
        }
    }
    origin
}

/// The peak of an element in volts; `None` if it has none.
fn peak(circuit: &Circuit, trace: &Trace, element: usize) -> Option<f64> {
    let name = &circuit.element(element).name;
    trace.amplifier_peaks.iter().find(|peak| peak.element == *name).map(|peak| peak.volts)
}

/// The largest peak in volts of the amplifiers and drives whose signals have a scale; 0 if there is none.
fn largest_with_scale(circuit: &Circuit, trace: &Trace, scale: usize) -> f64 {
    let points = circuit.signals().iter().filter(|point| point.scale == Some(scale));
    points.filter_map(|point| peak(circuit, trace, point.element)).fold(0.0, f64::max)
}
