//! What to change so that an overload does not occur, in numbers.

use super::rescaling::{Rescaling, element_index, reduction, scale_change, scaled_signal, smaller_output};
use patchcord_core::circuit::Circuit;
use patchcord_core::trace::{Overload, Trace};

/// Factor for an output of which it is not known how large it must be.
const FACTOR_WITHOUT_DEMAND: f64 = 2.0;

/// The voltage that some amplifiers need.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Need {
    /// The largest known demand, in volts.
    volts: f64,
    /// Whether all demands are known.
    is_known: bool,
}

impl Need {
    /// The need of the amplifiers of some overloads.
    fn of<'o>(overloads: impl Iterator<Item = &'o Overload>) -> Need {
        overloads.fold(Need { volts: 0.0, is_known: true }, |need, overload| {
            match overload.peak().filter(|volts| volts.is_finite()) {
                Some(volts) => Need { volts: need.volts.max(volts), ..need },
                None => Need { is_known: false, ..need },
            }
        })
    }

    /// The factor by which the outputs have to be smaller.
    fn factor(self) -> f64 {
        let known = reduction(self.volts);
        if self.is_known { known } else { known.max(FACTOR_WITHOUT_DEMAND) }
    }
}

/// The remedy for the first overload of a run, as a sentence without a full stop. `None` if there is no overload.
///
/// If a signal with a scale is at the amplifier, one volt must represent more. The factor is round, so that the largest
/// demand of all overloaded amplifiers with this scale is at most 95 V. Otherwise the gains must be smaller. The demand
/// of an integrator that is driven against its limit is not known. Then the factor is 2, and the run has to be repeated.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::overload_remedy;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// // S needs 10 x 36 V.
/// let pot = ElementBuilder::new("pot").cord("in", "+100").set("setting", 0.36);
/// let summer = ElementBuilder::new("summer").cords("x10", ["P"]);
/// let patch = PatchBuilder::new("overload").scale("speed", 2, "mm/s").element("P", pot).element("S", summer);
/// let circuit = Circuit::new(&patch.signal("v", "S", "speed", 1.0).run(1.0, 0.1).build()?)?;
/// let trace = run(&Program::new(&circuit)?, &RunSettings::of(&circuit)?)?;
/// assert_eq!(
///     overload_remedy(&circuit, &trace).as_deref(),
///     Some(
///         "let 1 V of v at S represent 4 times as much (\"per_volt\": 8 in place of 2 in the scale \"speed\"), and \
///          adapt the gains"
///     )
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn overload_remedy(circuit: &Circuit, trace: &Trace) -> Option<String> {
    let first = trace.overloads().next()?;
    let element = element_index(circuit, &first.element)?;
    let Some(signal) = scaled_signal(circuit, element) else {
        let need = Need::of(trace.overloads().filter(|overload| overload.element == first.element));
        let change = smaller_output(circuit, element, need.factor());
        return Some(if need.is_known { change } else { format!("{change}; {}", unknown(&first.element)) });
    };
    let has_same_scale = |overload: &&Overload| scale_of(circuit, &overload.element) == Some(signal.1);
    let need = Need::of(trace.overloads().filter(has_same_scale));
    let change = scale_change(circuit, element, signal, Rescaling::Enlarge(need.factor()));
    Some(match need.is_known {
        true => format!("{change}, and adapt the gains"),
        false => format!("{change}, and adapt the gains; {}", unknown(&first.element)),
    })
}

/// The scale of the signal at an element.
fn scale_of(circuit: &Circuit, name: &str) -> Option<usize> {
    Some(scaled_signal(circuit, element_index(circuit, name)?)?.1)
}

/// The end of a remedy whose factor is a guess.
fn unknown(element: &str) -> String {
    format!(
        "the voltage that {element} needs is not known, so repeat the run and the change until no lamp lights"
    )
}
