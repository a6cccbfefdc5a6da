//! The audit of amplitude scaling: computer gain = input scale x block gain / output scale (eq. 4-8).

use std::collections::{HashMap, HashSet};

use indexmap::IndexMap;

use super::{Circuit, Cord, Element, SignalPoint};
use crate::elements::{Default, Measure, Transfer};
use crate::patch::Amount;
use patchcord_expr::{Dimension, Scope as _};

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
    let wiring = Wiring::new(circuit);
    let mut rows = Vec::new();
    for output in circuit.signals().iter().filter(|point| point.scale.is_some()) {
        let stretches = wiring.stretches(output.element);
        rows.extend(stretches.iter().filter_map(|stretch| row(circuit, output, stretch)));
    }
    rows
}

/// Linear wiring back to the nearest scaled signal. Several ways between the same two count as one.
struct Stretch<'c> {
    input: &'c SignalPoint,
    gain: f64,
    integrations: usize,
}

/// More integrations than this between two scaled signals are not followed.
const MOST_INTEGRATIONS: usize = 2;

/// The gain on the way to the output through each number of integrators, where there is a way.
type Gains = [Option<f64>; MOST_INTEGRATIONS + 1];

/// What drives an element that is linear in it.
struct Source {
    from: usize,
    gain: f64,
    integrates: bool,
}

impl Source {
    /// The gains from the source on, given those from the element's output on.
    fn before(&self, after: &Gains) -> Gains {
        let mut gains = after.map(|gain| gain.map(|gain| gain * self.gain));
        if self.integrates {
            gains.rotate_right(1);
            gains[0] = None;
        }
        gains
    }
}

fn add(sums: &mut Gains, gains: &Gains) {
    for (sum, gain) in sums.iter_mut().zip(gains) {
        *sum = gain.map(|gain| sum.unwrap_or(0.0) + gain).or(*sum);
    }
}

/// The linear part of a circuit.
struct Wiring<'c> {
    /// What drives each element.
    sources: Vec<Vec<Source>>,
    /// The first scaled signal at each element.
    scaled: Vec<Option<&'c SignalPoint>>,
}

impl<'c> Wiring<'c> {
    fn new(circuit: &'c Circuit) -> Self {
        let elements = circuit.elements().len();
        let mut scaled = vec![None; elements];
        for point in circuit.signals().iter().filter(|point| point.scale.is_some()) {
            scaled[point.element].get_or_insert(point);
        }
        Wiring { sources: (0..elements).map(|element| sources(circuit, element)).collect(), scaled }
    }

    fn stretches(&self, output: usize) -> Vec<Stretch<'c>> {
        let Behind { elements, mut inputs } = Behind::of(self, output);
        let rank: HashMap<usize, usize> = elements.iter().enumerate().map(|(at, one)| (*one, at)).collect();
        let mut reached = vec![Gains::default(); elements.len()];
        reached[0][0] = Some(1.0);
        for (at, element) in elements.iter().enumerate() {
            let after = reached[at];
            for source in &self.sources[*element] {
                let before = source.before(&after);
                if let Some(gains) = inputs.get_mut(&source.from) {
                    add(gains, &before);
                } else if rank[&source.from] > at {
                    add(&mut reached[rank[&source.from]], &before);
                }
            }
        }
        inputs.iter().flat_map(|(element, gains)| self.stretches_from(*element, gains)).collect()
    }

    fn stretches_from(&self, element: usize, gains: &Gains) -> Vec<Stretch<'c>> {
        let Some(input) = self.scaled[element] else { return Vec::new() };
        let stretch = |(integrations, gain): (usize, &Option<f64>)| {
            gain.map(|gain| Stretch { input, gain, integrations })
        };
        gains.iter().enumerate().filter_map(stretch).collect()
    }
}

/// What lies behind an output, back to the nearest scaled signals.
struct Behind {
    /// Elements without a scaled signal (and the output's), each before those that drive it; a cord that closes
    /// a ring goes against the order.
    elements: Vec<usize>,
    /// The elements with scaled signals, in the order in which cords lead to them.
    inputs: IndexMap<usize, Gains>,
}

impl Behind {
    fn of(wiring: &Wiring<'_>, output: usize) -> Self {
        let mut behind = Behind { elements: Vec::new(), inputs: IndexMap::new() };
        let mut seen = HashSet::from([output]);
        let mut open = vec![(output, wiring.sources[output].iter())];
        while let Some((element, sources)) = open.last_mut() {
            match sources.next() {
                None => {
                    behind.elements.push(*element);
                    open.pop();
                }
                Some(Source { from, .. }) if wiring.scaled[*from].is_some() => {
                    behind.inputs.entry(*from).or_default();
                }
                Some(Source { from, .. }) if seen.insert(*from) => {
                    open.push((*from, wiring.sources[*from].iter()));
                }
                Some(_) => {}
            }
        }
        behind.elements.reverse();
        behind
    }
}

fn sources(circuit: &Circuit, element: usize) -> Vec<Source> {
    let cords = circuit.cords(element).into_iter();
    let source = |(from, cord)| {
        let (gain, integrates) = linear_gain(circuit, element, cord)?;
        Some(Source { from, gain, integrates })
    };
    cords.filter_map(source).collect()
}

/// The gain from an input to the output, if the element is linear, and whether it integrates.
fn linear_gain(circuit: &Circuit, element: usize, cord: Cord) -> Option<(f64, bool)> {
    let element = circuit.element(element);
    let main = cord.input == 0;
    let limited = element.settings.iter().zip(element.kind.settings).any(|(value, row)| {
        value.is_some() && row.measure == Measure::Volts && row.default == Default::Absent
    });
    match element.kind.transfer {
        Transfer::Integrating if main && !limited => Some((-cord.gain, true)),
        Transfer::Inverting if main && !limited => Some((-cord.gain, false)),
        Transfer::Share => Some((share(circuit, element)?, false)),
        _ => None,
    }
}

fn share(circuit: &Circuit, element: &Element) -> Option<f64> {
    let setting = element.kind.settings.iter().position(|row| row.measure == Measure::Fraction)?;
    let Amount::Formula(formula) = &element.settings[setting].as_ref()?.value else { return None };
    formula.evaluate(circuit.quantities()).ok()
}

fn row(circuit: &Circuit, output: &SignalPoint, stretch: &Stretch<'_>) -> Option<ScalingRow> {
    let (input_scale, input_unit) = volt(circuit, stretch.input)?;
    let (output_scale, output_unit) = volt(circuit, output)?;
    if input_scale == 0.0 || output_scale == 0.0 {
        return None;
    }
    let integrations = i32::try_from(stretch.integrations).ok()?;
    let per_second = circuit.time_scale().powi(integrations);
    let block_gain = stretch.gain * per_second * output_scale / input_scale;
    let seconds = Dimension::TIME.power(f64::from(integrations));
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
    Some((value * point.factor, circuit.derived_unit(scale).dimension()))
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

    #[test]
    fn an_inverter_is_linear_and_a_curve_is_not() {
        for (kind, gains) in [("inverter", vec![-1.0]), ("absolute", vec![]), ("sin", vec![])] {
            let step = ElementBuilder::new("step").set("height", 1);
            let builder = PatchBuilder::new("curve").scale("volt", 1.0, "V").drive("D", "volt", step);
            let builder = builder.element("E", ElementBuilder::new(kind).cord("in", "D"));
            assert_eq!(gains_at(builder.signal("in", "D", "volt", 1.0), "E"), gains, "{kind}");
        }
    }

    fn summer(from: &[String]) -> ElementBuilder {
        ElementBuilder::new("summer").set("in", serde_json::json!({ "x1": from }))
    }

    fn gains_at(builder: PatchBuilder, last: &str) -> Vec<f64> {
        let builder = builder.signal("out", last, "volt", 1.0);
        let circuit =
            Circuit::new(&builder.build().unwrap(), &[]).unwrap_or_else(|report| panic!("{report}"));
        circuit.scaling().iter().map(|row| row.computer_gain).collect()
    }

    /// A drive behind pairs of summers, each summer driven by both of the pair before.
    fn ladder(pairs: usize) -> PatchBuilder {
        let step = ElementBuilder::new("step").set("height", 1);
        let builder = PatchBuilder::new("ladder").scale("volt", 1.0, "V").drive("D", "volt", step);
        (0..pairs).fold(builder, |builder, at| {
            let from = match at {
                0 => vec!["D".to_owned()],
                _ => vec![format!("A{}", at - 1), format!("B{}", at - 1)],
            };
            builder.element(&format!("A{at}"), summer(&from)).element(&format!("B{at}"), summer(&from))
        })
    }

    #[test]
    fn every_way_of_a_ladder_counts() {
        assert_eq!(gains_at(ladder(24), "A23"), [2f64.powi(23)]);
    }

    #[test]
    fn a_long_chain_is_followed_to_its_end() {
        let step = ElementBuilder::new("step").set("height", 1);
        let builder = PatchBuilder::new("chain").scale("volt", 1.0, "V").drive("S0", "volt", step);
        let chain = (1..=20_000).fold(builder, |builder, at| {
            builder.element(&format!("S{at}"), summer(&[format!("S{}", at - 1)]))
        });
        assert_eq!(gains_at(chain, "S20000"), [1.0]);
    }
}
