//! Formats the amplifiers whose output stays small in a run, as text and as JSON.

use serde::Serialize;

use patchcord::circuit::Circuit;
use patchcord::expr::format_significant;
use patchcord::instruments::{LOW_PEAK, low_peak_remedy, low_peaks};
use patchcord::trace::Trace;

/// Number of amplifiers that are listed. The others are counted.
const MAX_LISTED: usize = 5;

/// The amplifiers with low peaks, the lowest first, and the remedy for this one, in two lines. Empty if there is none, or
/// if an overload comes first: its curves are wrong.
pub(super) fn low_peaks_text(circuit: &Circuit, trace: &Trace) -> String {
    let low = low_peaks(circuit, trace);
    let Some(first) = low.first().filter(|_| trace.overloads().next().is_none()) else {
        return String::new();
    };
    let listed: Vec<String> = low
        .iter()
        .take(MAX_LISTED)
        .map(|peak| format!("{} {} V", peak.element, format_significant(peak.volts, 2)))
        .collect();
    let more = match low.len() - listed.len() {
        0 => String::new(),
        more => format!(", and {more} more"),
    };
    let remedy = low_peak_remedy(circuit, trace, first);
    format!("peaks below {LOW_PEAK} V: {}{more}\n  = help: {remedy}\n", listed.join(", "))
}

/// An amplifier with a low peak for `--json`, in volts.
#[derive(Serialize)]
pub(super) struct LowPeakDocument<'a> {
    element: &'a str,
    peak: f64,
}

impl<'a> LowPeakDocument<'a> {
    /// The documents of all amplifiers with low peaks, the lowest first.
    pub(super) fn all(circuit: &Circuit, trace: &'a Trace) -> Vec<Self> {
        let low = low_peaks(circuit, trace).into_iter();
        low.map(|peak| LowPeakDocument { element: &peak.element, peak: peak.volts }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord::patch::{ElementBuilder, PatchBuilder};
    use patchcord::trace::{AmplifierPeak, Repetition};

    /// A circuit of integrators A1 to A7, and a trace in which they have these peaks.
    fn peaks(volts: &[f64]) -> (Circuit, Trace) {
        let names: Vec<String> = (1..=7).map(|number| format!("A{number}")).collect();
        let integrator =
            |name: &String| ElementBuilder::new("integrator").cords("x1", ["+100", name.as_str()]);
        let builder = PatchBuilder::new("integrators");
        let builder = names.iter().fold(builder, |builder, name| builder.element(name, integrator(name)));
        let peak =
            |(element, volts): (&String, &f64)| AmplifierPeak { element: element.clone(), volts: *volts };
        let amplifier_peaks = names.iter().zip(volts).map(peak).collect();
        let trace = Trace { amplifier_peaks, repetitions: vec![Repetition::default()], ..Trace::default() };
        (Circuit::new(&builder.build().unwrap()).unwrap(), trace)
    }

    #[test]
    fn at_most_five_amplifiers_are_listed_and_the_lowest_has_a_remedy() {
        let (circuit, trace) = peaks(&[4.0, 50.0, 0.9, 0.0, 6.0]);
        assert_eq!(
            low_peaks_text(&circuit, &trace),
            "peaks below 5 V: A3 0.9 V, A1 4 V\n  = help: make A3 100 times larger: give +100 a gain of 100 in place of 1; \
             then divide by 100 where other amplifiers use it\n"
        );
        let (circuit, trace) = peaks(&[1.0, 2.0, 3.0, 4.0, 0.5, 0.25, 4.999]);
        let text = low_peaks_text(&circuit, &trace);
        let listed = "peaks below 5 V: A6 0.25 V, A5 0.5 V, A1 1 V, A2 2 V, A3 3 V, and 2 more\n";
        assert!(text.starts_with(listed), "{text}");
        let (circuit, trace) = peaks(&[5.0, 100.0, 0.0]);
        assert_eq!(low_peaks_text(&circuit, &trace), "");
    }
}
