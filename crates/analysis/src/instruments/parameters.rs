//! Formats the parameters of a circuit as one line of text.

use crate::format::QuantityFormat;
use patchcord_core::circuit::Circuit;

/// The parameters as one line, "k 45 MN/m, m 400 kg". Omits parameters that are 0 both in the patch and as set.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::parameter_line;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // dx/dt = -k x, from x = 50 V
/// let integrator = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
/// let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
/// let patch = PatchBuilder::new("Decay").parameter("k", 0.5, "1", [0.0, 1.0]).run(1.0, 1e-3).record(["A1"]);
/// let patch = patch.element("A1", integrator).element("P1", pot).build()?;
/// let circuit = Circuit::new(&patch)?;
/// assert_eq!(parameter_line(&circuit), "k 0.5");
/// # Ok(())
/// # }
/// ```
pub fn parameter_line(circuit: &Circuit) -> String {
    let shown = circuit.parameters().filter(|(_, parameter, value)| *value != 0.0 || parameter.value != 0.0);
    let texts = shown.map(|(name, parameter, value)| {
        format!("{name} {}", QuantityFormat::new(parameter.unit.text(), value).text(value))
    });
    texts.collect::<Vec<_>>().join(", ")
}
