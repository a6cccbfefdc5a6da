//! The audit of amplitude scaling: computer gain = input scale x block gain / output scale (eq. 4-8).

use super::{Circuit, SignalPoint};
use crate::elements::{Default, Jacks, Measure, Output};
use crate::patch::{Amount, Dimension, Scope as _};

/// A stretch of wiring between two scaled signals, held against eq. 4-8.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalingRow {
    /// The element whose output is the output signal.
    pub element: String,
    /// Signal at the beginning of the stretch.
    pub input: String,
    /// Signal at its end.
    pub output: String,
    /// Gain of the wiring in volts per volt; through an integrator in volts per machine second per volt.
    pub computer_gain: f64,
    /// One volt of the input signal, in SI, its factor counted.
    pub input_scale: f64,
    /// One volt of the output signal, in SI, its factor counted.
    pub output_scale: f64,
    /// The physical gain that the wiring stands for: computer gain x output scale / input scale.
    pub block_gain: f64,
    /// Unit of the block gain.
    pub unit: String,
    /// What the block gain is in the patch's own quantities ("K", "1 / M", "1"), where it can be told by unit.
    pub block: Option<String>,
    /// Computer gain that eq. 4-8 asks for with that block.
    pub wanted: Option<f64>,
}

impl ScalingRow {
    /// How far the wiring is from eq. 4-8, as a share of what is asked for.
    pub fn difference(&self) -> Option<f64> {
        self.wanted.map(|wanted| self.computer_gain / wanted - 1.0)
    }
}

/// Every stretch of linear wiring between scaled signals, in the order of the signals at its end.
pub(super) fn audit(circuit: &Circuit) -> Vec<ScalingRow> {
    let mut rows = Vec::new();
    for output in circuit.signals().iter().filter(|point| point.scale.is_some()) {
        let mut walk = Walk { circuit, path: Vec::new(), found: Vec::new() };
        walk.back(output.element, 1.0, 0);
        rows.extend(walk.found.into_iter().filter_map(|stretch| row(circuit, output, &stretch)));
    }
    rows
}

/// Linear wiring back to the nearest scaled signal.
struct Stretch {
    input: SignalPoint,
    gain: f64,
    integrations: i32,
}

struct Walk<'c> {
    circuit: &'c Circuit,
    path: Vec<usize>,
    found: Vec<Stretch>,
}

impl Walk<'_> {
    /// Follows the cords into an element, given the gain and integrations from its output on.
    fn back(&mut self, element: usize, gain: f64, integrations: i32) {
        if self.path.contains(&element) {
            return;
        }
        self.path.push(element);
        for (from, cord) in self.circuit.cords(element) {
            let Some((own, integrates)) = self.linear_gain(element, cord) else { continue };
            let (gain, integrations) = (gain * own, integrations + i32::from(integrates));
            match scaled_signal(self.circuit, from) {
                Some(input) => self.note(input, gain, integrations),
                None => self.back(from, gain, integrations),
            }
        }
        self.path.pop();
    }

    /// Several ways between the same two signals count as one.
    fn note(&mut self, input: &SignalPoint, gain: f64, integrations: i32) {
        let same =
            |stretch: &&mut Stretch| stretch.input.name == input.name && stretch.integrations == integrations;
        match self.found.iter_mut().find(same) {
            Some(stretch) => stretch.gain += gain,
            None => self.found.push(Stretch { input: input.clone(), gain, integrations }),
        }
    }

    /// The gain from an input to the output, if the element is linear, and whether it integrates.
    fn linear_gain(&self, element: usize, cord: super::Cord) -> Option<(f64, bool)> {
        let element = self.circuit.element(element);
        let main = cord.input == 0;
        let gains = element.kind.inputs[0].jacks == Jacks::Gains;
        let limited = element.settings.iter().zip(element.kind.settings).any(|(value, row)| {
            value.is_some() && row.measure == Measure::Volts && row.default == Default::Absent
        });
        let fraction = element.kind.settings.iter().position(|row| row.measure == Measure::Fraction);
        match (element.kind.output, fraction) {
            (Output::Integrator, _) if main => Some((-cord.gain, true)),
            (Output::Amplifier, _) if main && gains && !limited => Some((-cord.gain, false)),
            (Output::Passive, Some(setting)) if element.kind.inputs.len() == 1 => Some((
                self.setting(element.settings.get(setting)?.as_ref().map(|placed| &placed.value)?)?,
                false,
            )),
            _ => None,
        }
    }

    fn setting(&self, amount: &Amount) -> Option<f64> {
        match amount {
            Amount::Formula(formula) => formula.evaluate(self.circuit.quantities()).ok(),
            _ => None,
        }
    }
}

fn scaled_signal(circuit: &Circuit, element: usize) -> Option<&SignalPoint> {
    circuit.signals().iter().find(|point| point.element == element && point.scale.is_some())
}

fn row(circuit: &Circuit, output: &SignalPoint, stretch: &Stretch) -> Option<ScalingRow> {
    let (input_scale, input_unit) = volt(circuit, &stretch.input)?;
    let (output_scale, output_unit) = volt(circuit, output)?;
    if input_scale == 0.0 || output_scale == 0.0 {
        return None;
    }
    let per_second = circuit.time_scale().powi(stretch.integrations);
    let block_gain = stretch.gain * per_second * output_scale / input_scale;
    let seconds = Dimension::TIME.power(f64::from(stretch.integrations));
    let dimension = output_unit.over(input_unit).over(seconds);
    let block = Block::find(circuit, dimension, block_gain);
    let wanted = block
        .as_ref()
        .map(|block| input_scale * block.value * block_gain.signum() / output_scale / per_second);
    Some(ScalingRow {
        element: circuit.element(output.element).name.clone(),
        input: stretch.input.name.clone(),
        output: output.name.clone(),
        computer_gain: stretch.gain,
        input_scale,
        output_scale,
        block_gain,
        unit: if dimension.is_none() { "1".to_owned() } else { dimension.to_string() },
        block: block.map(|block| block.name),
        wanted,
    })
}

/// One volt of a signal in SI, and its dimension.
fn volt(circuit: &Circuit, point: &SignalPoint) -> Option<(f64, Dimension)> {
    let scale = point.scale?;
    let value = circuit.quantities().per_volt(scale)?;
    Some((value * point.factor, circuit.scale_unit(scale).dimension()))
}

/// A physical gain made of the patch's parameters.
struct Block {
    name: String,
    value: f64,
    dimension: Dimension,
}

/// A block gain this near to the wiring's agrees with it.
const NEAR: f64 = 1e-6;

impl Block {
    /// What agrees with the gain: 1, a parameter, its reciprocal, a quotient or product of two. Else the one
    /// of the first three that is nearest.
    fn find(circuit: &Circuit, dimension: Dimension, gain: f64) -> Option<Block> {
        let singles = Block::singles(circuit);
        let unity = Block { name: "1".to_owned(), value: 1.0, dimension: Dimension::NONE };
        let away = |block: &Block| (gain.abs() / block.value).ln().abs();
        let fits = |block: &Block| block.dimension == dimension && block.value > 0.0;
        let pair = Block::pairs(&singles).into_iter().filter(fits).find(|pair| away(pair) < NEAR);
        let nearest =
            [unity].into_iter().chain(singles).filter(fits).min_by(|a, b| away(a).total_cmp(&away(b)));
        match nearest {
            Some(nearest) if pair.is_none() || away(&nearest) < NEAR => Some(nearest),
            _ => pair,
        }
    }

    fn singles(circuit: &Circuit) -> Vec<Block> {
        let quantities = circuit.quantities();
        let mut singles = Vec::new();
        for (name, ..) in circuit.parameters() {
            let (Some(value), Some(dimension)) = (quantities.value(name), quantities.dimension(name)) else {
                continue;
            };
            singles.push(Block { name: name.to_owned(), value, dimension });
            let dimension = Dimension::NONE.over(dimension);
            singles.push(Block { name: format!("1 / {name}"), value: 1.0 / value, dimension });
        }
        singles
    }

    fn pairs(singles: &[Block]) -> Vec<Block> {
        let plain: Vec<_> = singles.iter().filter(|block| !block.name.starts_with("1 /")).collect();
        let mut pairs = Vec::new();
        for first in &plain {
            for second in plain.iter().filter(|second| second.name != first.name) {
                pairs.push(Block {
                    name: format!("{} / {}", first.name, second.name),
                    value: first.value / second.value,
                    dimension: first.dimension.over(second.dimension),
                });
                pairs.push(Block {
                    name: format!("{} * {}", first.name, second.name),
                    value: first.value * second.value,
                    dimension: first.dimension.times(second.dimension),
                });
            }
        }
        pairs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::{ElementBuilder, Patch, PatchBuilder};

    /// Position and velocity of a mass, with a pot between them that should stand for k / m.
    fn patch(setting: &str) -> Patch {
        PatchBuilder::new("spring")
            .time_scale(10.0)
            .parameter("k", 40.0, "N/m", [1.0, 100.0])
            .parameter("m", 2.0, "kg", [1.0, 10.0])
            .scale("position", 1.0, "mm")
            .scale("velocity", 20.0, "mm/s")
            .element("A1", ElementBuilder::new("integrator").cords("x10", ["P1"]))
            .element("A2", ElementBuilder::new("integrator").cords("x1", ["P2"]))
            .element(
                "P2",
                ElementBuilder::new("pot")
                    .cord("in", "A1")
                    .set("setting", "velocity / position / 10 / time_scale"),
            )
            .element("P1", ElementBuilder::new("pot").cord("in", "A2").set("setting", setting))
            .signal("v", "A1", "velocity", 1.0)
            .signal("x", "A2", "position", -1.0)
            .build()
            .unwrap()
    }

    fn row(setting: &str, output: &str) -> ScalingRow {
        let circuit = Circuit::new(&patch(setting), &[]).unwrap_or_else(|report| panic!("{report}"));
        circuit.scaling().into_iter().find(|row| row.output == output).unwrap()
    }

    #[test]
    fn a_gain_that_is_off_is_found() {
        let right = row("k / m * position / velocity / 10 / time_scale", "v");
        assert_eq!(right.block.as_deref(), Some("k / m"));
        assert!(right.difference().unwrap().abs() < 1e-12);
        assert!((right.block_gain - 20.0).abs() < 1e-9, "{right:?}");
    }

    #[test]
    fn integrating_velocity_into_position_has_a_block_gain_of_1() {
        // The pot in front of A2 lacks a factor of 10 on purpose: the wiring gives a tenth of what is asked for.
        let row = row("k / m * position / velocity / 10 / time_scale", "x");
        assert_eq!(row.block.as_deref(), Some("1"));
        assert!((row.difference().unwrap() + 0.9).abs() < 1e-9, "{row:?}");
    }
}
