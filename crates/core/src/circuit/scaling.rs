//! The audit of amplitude scaling: computer gain = input scale x block gain / output scale (eq. 4-8).
//!
//! The audit follows the linear wiring from every scaled signal back to the nearest scaled signals. It computes the
//! gain of this wiring and the physical gain (block gain) that it represents with these scales. Then it looks for a
//! parameter, a reciprocal, a product or a quotient of parameters with this value. This is an identification, not a
//! proof: only equations say which gain is right. The exception is a signal and its integral, whose units require a
//! block gain of 1.

mod block;
mod integrals;

use std::collections::{HashMap, HashSet};

use indexmap::IndexMap;

use super::{Circuit, Cord, Element, SignalPoint};
use crate::elements::{SettingDefault, SettingQuantity, Transfer};
use crate::patch::Amount;
use block::Blocks;
use integrals::{counts_turns, without_parameters};
pub(super) use integrals::{integral_warnings, time_scale_warning};
use patchcord_expr::Dimension;

/// The linear wiring between two scaled signals, compared with eq. 4-8.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::ScalingRow;
///
/// let row = ScalingRow {
///     element: "A2".to_owned(),
///     input: "v".to_owned(),
///     output: "x".to_owned(),
///     integrations: 1,
///     computer_gain: -10.0,
///     input_scale: 0.02,
///     output_scale: 0.001,
///     block_gain: -0.5,
///     unit: "1".to_owned(),
///     block: Some("1".to_owned()),
///     expected_gain: Some(-20.0),
/// };
/// // The gain of the wiring is half of the one that the scales require.
/// assert_eq!(row.relative_error(), Some(-0.5));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ScalingRow {
    /// Name of the element whose output is the output signal.
    pub element: String,
    /// Name of the signal at the start of the wiring.
    pub input: String,
    /// Name of the signal at the end of the wiring.
    pub output: String,
    /// Number of integrators in the wiring.
    pub integrations: usize,
    /// Gain of the wiring in volts per volt. With n integrators, in volts per volt per machine second to the power of
    /// n.
    pub computer_gain: f64,
    /// Value of one volt of the input signal in SI units, including the factor of the signal.
    pub input_scale: f64,
    /// Value of one volt of the output signal in SI units, including the factor of the signal.
    pub output_scale: f64,
    /// The physical gain of the wiring: computer gain x output scale / input scale. With n integrators it is multiplied
    /// by the time scale to the power of n.
    pub block_gain: f64,
    /// Unit of the block gain; "1" if it is a pure number.
    pub unit: String,
    /// An expression of the parameters with the size and the unit of the block gain, such as "K", "1 / M" or "1". `None`
    /// if there is none. It is "1" for a signal and its integral, also if the block gain has another size.
    pub block: Option<String>,
    /// The computer gain that eq. 4-8 requires if the output is the integral of the input, as their units say. Its sign
    /// is that of the computer gain. `None` for all other wiring.
    pub expected_gain: Option<f64>,
}

impl ScalingRow {
    /// The relative deviation of the computer gain from the expected one; 0 if they agree.
    pub fn relative_error(&self) -> Option<f64> {
        self.expected_gain.map(|expected| self.computer_gain / expected - 1.0)
    }
}

/// All linear wiring between scaled signals, in the order of the output signals.
pub(super) fn audit(circuit: &Circuit) -> Vec<ScalingRow> {
    let (wiring, blocks) = (Wiring::new(circuit), Blocks::new(circuit));
    let fixed = without_parameters(Wiring::new(circuit), circuit);
    let mut rows = Vec::new();
    for output in circuit.signals().iter().filter(|point| point.scale.is_some()) {
        // Both have the same paths. The gain of a fixed one is not a number if it depends on a parameter.
        let paths = wiring.paths_to(output.element).into_iter().zip(fixed.paths_to(output.element));
        rows.extend(paths.filter_map(|(path, fixed)| row(circuit, &blocks, output, [&path, &fixed])));
    }
    rows
}

/// The linear wiring from a scaled signal to an output. Parallel paths with the same number of integrators are added.
struct SignalPath<'c> {
    /// The scaled signal at the start of the wiring.
    input: &'c SignalPoint,
    /// Gain per machine second to the power of the number of integrators.
    gain: f64,
    /// Number of integrators.
    integrations: usize,
}

/// Number of integrators between two scaled signals at most. Paths with more are ignored: acceleration, speed and
/// position need two.
const MAX_INTEGRATIONS: usize = 2;

/// The gains to the output: the entry n is the sum over the paths with n integrators. `None` if there is no such path.
type Gains = [Option<f64>; MAX_INTEGRATIONS + 1];

/// An element that drives another one through a linear input.
struct LinearDriver {
    /// Index of the driving element.
    from: usize,
    /// Gain from the driver's output to the driven element's output.
    gain: f64,
    /// Whether the driven element integrates.
    integrates: bool,
}

impl LinearDriver {
    /// The gains from the driver's output, for given gains from the driven element's output.
    fn gains_from_driver(&self, after: &Gains) -> Gains {
        let mut gains = after.map(|gain| gain.map(|gain| gain * self.gain));
        if self.integrates {
            gains.rotate_right(1);
            gains[0] = None;
        }
        gains
    }
}

/// Adds gains of parallel paths.
fn add(sums: &mut Gains, gains: &Gains) {
    for (sum, gain) in sums.iter_mut().zip(gains) {
        *sum = gain.map(|gain| sum.unwrap_or(0.0) + gain).or(*sum);
    }
}

/// The linear part of a circuit.
struct Wiring<'c> {
    /// For each element, its linear drivers.
    drivers: Vec<Vec<LinearDriver>>,
    /// For each element, the first scaled signal at its output.
    scaled: Vec<Option<&'c SignalPoint>>,
}

impl<'c> Wiring<'c> {
    /// Collects the linear drivers and the scaled signals of all elements. If an output has several scaled signals, the
    /// first one counts.
    fn new(circuit: &'c Circuit) -> Self {
        let elements = circuit.elements().len();
        let mut scaled = vec![None; elements];
        for point in circuit.signals().iter().filter(|point| point.scale.is_some()) {
            scaled[point.element].get_or_insert(point);
        }
        Wiring { drivers: (0..elements).map(|element| linear_drivers(circuit, element)).collect(), scaled }
    }

    /// The paths from the nearest scaled signals to an element's output.
    ///
    /// The gains are propagated from the output back, in the order of the region. Cords that close a loop are left out.
    fn paths_to(&self, output: usize) -> Vec<SignalPath<'c>> {
        let UpstreamRegion { elements, mut inputs } = UpstreamRegion::new(self, output);
        let rank: HashMap<usize, usize> =
            elements.iter().enumerate().map(|(rank, element)| (*element, rank)).collect();
        let mut gains_to_output = vec![Gains::default(); elements.len()];
        gains_to_output[0][0] = Some(1.0);
        for (element_rank, element) in elements.iter().enumerate() {
            let after = gains_to_output[element_rank];
            for driver in &self.drivers[*element] {
                let before = driver.gains_from_driver(&after);
                if let Some(gains) = inputs.get_mut(&driver.from) {
                    add(gains, &before);
                } else if rank[&driver.from] > element_rank {
                    add(&mut gains_to_output[rank[&driver.from]], &before);
                }
            }
        }
        inputs.iter().flat_map(|(element, gains)| self.paths_from(*element, gains)).collect()
    }

    /// The paths from the scaled signal at an element, one for each number of integrators.
    fn paths_from(&self, element: usize, gains: &Gains) -> Vec<SignalPath<'c>> {
        let Some(input) = self.scaled[element] else { return Vec::new() };
        let path = |(integrations, gain): (usize, &Option<f64>)| {
            gain.map(|gain| SignalPath { input, gain, integrations })
        };
        gains.iter().enumerate().filter_map(path).collect()
    }
}

/// The elements upstream of an output, back to the nearest scaled signals.
struct UpstreamRegion {
    /// The output's element, which is the first one, and the elements without a scaled signal. Each comes before its
    /// drivers, except for cords that close a loop.
    elements: Vec<usize>,
    /// The elements with scaled signals, in the order in which cords lead to them. Their gains are empty at first.
    inputs: IndexMap<usize, Gains>,
}

impl UpstreamRegion {
    /// Finds the region by a depth-first search. It uses no recursion, because chains can have many thousand elements.
    fn new(wiring: &Wiring<'_>, output: usize) -> Self {
        let mut region = UpstreamRegion { elements: Vec::new(), inputs: IndexMap::new() };
        let mut visited = HashSet::from([output]);
        let mut stack = vec![(output, wiring.drivers[output].iter())];
        while let Some((element, drivers)) = stack.last_mut() {
            match drivers.next() {
                None => {
                    region.elements.push(*element);
                    stack.pop();
                }
                Some(LinearDriver { from, .. }) if wiring.scaled[*from].is_some() => {
                    region.inputs.entry(*from).or_default();
                }
                Some(LinearDriver { from, .. }) if visited.insert(*from) => {
                    stack.push((*from, wiring.drivers[*from].iter()));
                }
                Some(_) => {}
            }
        }
        region.elements.reverse();
        region
    }
}

/// The linear drivers of an element. Cords into inputs that are not linear are left out.
fn linear_drivers(circuit: &Circuit, element: usize) -> Vec<LinearDriver> {
    let cords = circuit.cords(element).into_iter();
    let driver = |(from, cord)| {
        let (gain, integrates) = linear_gain(circuit, element, cord)?;
        Some(LinearDriver { from, gain, integrates })
    };
    cords.filter_map(driver).collect()
}

/// The gain from an input to the output, and whether the element integrates. `None` if the input is not linear.
///
/// An element with an adjustable limit is not linear. The limits of every amplifier at ±100 V do not count.
fn linear_gain(circuit: &Circuit, element: usize, cord: Cord) -> Option<(f64, bool)> {
    let element = circuit.element(element);
    let is_main_input = cord.input == 0;
    let is_limited = element.settings.iter().zip(element.kind.settings).any(|(value, row)| {
        value.is_some() && row.quantity == SettingQuantity::Volts && row.default == SettingDefault::Absent
    });
    match element.kind.transfer {
        Transfer::Integrating if is_main_input && !is_limited => Some((-cord.gain, true)),
        Transfer::Inverting if is_main_input && !is_limited => Some((-cord.gain, false)),
        Transfer::Share => Some((pot_setting(circuit, element)?, false)),
        _ => None,
    }
}

/// The setting of a pot. `None` if it cannot be evaluated.
fn pot_setting(circuit: &Circuit, element: &Element) -> Option<f64> {
    let setting = element.kind.settings.iter().position(|row| row.quantity == SettingQuantity::Fraction)?;
    let Amount::Formula(formula) = &element.settings[setting].as_ref()?.value else { return None };
    formula.evaluate(circuit.quantities()).ok()
}

/// The physical gain of a path, with the factors between it and the computer gain.
struct PhysicalGain {
    /// Value of one volt at the start of the path in SI units.
    input_scale: f64,
    /// Value of one volt at the end of the path in SI units.
    output_scale: f64,
    /// The time scale to the power of the number of integrators.
    time_factor: f64,
    /// The block gain in SI units.
    block_gain: f64,
    /// The dimension of the block gain.
    dimension: Dimension,
}

/// The physical gain of a path to an output. `None` if a scale is 0 or has no value.
fn physical_gain(circuit: &Circuit, output: &SignalPoint, path: &SignalPath<'_>) -> Option<PhysicalGain> {
    let (input_scale, input_unit) = value_per_volt(circuit, path.input)?;
    let (output_scale, output_unit) = value_per_volt(circuit, output)?;
    if input_scale == 0.0 || output_scale == 0.0 {
        return None;
    }
    let integrations = i32::try_from(path.integrations).ok()?;
    let time_factor = circuit.time_scale().powi(integrations);
    let block_gain = path.gain * time_factor * output_scale / input_scale;
    let seconds = Dimension::TIME.power(f64::from(integrations));
    let dimension = output_unit.over(input_unit).over(seconds);
    Some(PhysicalGain { input_scale, output_scale, time_factor, block_gain, dimension })
}

/// The row of a path. `fixed` is the same path, whose gain is not a number if it depends on a parameter. `None` if a
/// scale is 0 or has no value.
fn row(
    circuit: &Circuit,
    blocks: &Blocks,
    output: &SignalPoint,
    [path, fixed]: [&SignalPath<'_>; 2],
) -> Option<ScalingRow> {
    let PhysicalGain { input_scale, output_scale, time_factor, block_gain, dimension } =
        physical_gain(circuit, output, path)?;
    let found = blocks.find(dimension, block_gain);
    let can_be_integral = path.integrations > 0 && dimension.is_dimensionless() && block_gain != 0.0;
    let is_without_name = !fixed.gain.is_nan() && !counts_turns(block_gain.abs());
    let is_integral = can_be_integral && found.as_ref().map_or(is_without_name, |name| name == "1");
    let expected_gain = is_integral.then(|| input_scale * block_gain.signum() / output_scale / time_factor);
    Some(ScalingRow {
        element: circuit.element(output.element).name.clone(),
        input: path.input.name.clone(),
        output: output.name.clone(),
        integrations: path.integrations,
        computer_gain: path.gain,
        input_scale,
        output_scale,
        block_gain,
        unit: if dimension.is_dimensionless() { "1".to_owned() } else { dimension.to_string() },
        block: if is_integral { Some("1".to_owned()) } else { found },
        expected_gain,
    })
}

/// The value of one volt of a signal in SI units, with its dimension.
fn value_per_volt(circuit: &Circuit, point: &SignalPoint) -> Option<(f64, Dimension)> {
    let scale = point.scale?;
    let value = circuit.quantities().per_volt(scale)?;
    Some((value * point.factor, circuit.derived_unit(scale).dimension()))
}

#[cfg(test)]
mod tests;
