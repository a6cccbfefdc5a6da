//! The schematic as a JSON value.

use patchcord_core::document::json_value;
use serde::Serialize;
use serde_json::Value;

use super::diagram::{Diagram, Net, PlacedSymbol};
use super::layout::Point;
use super::sheet::{OpenedMacro, Schematic};

impl Schematic {
    /// Returns the symbols with their positions and the nets with their lines.
    ///
    /// Positions are `[x, y]` in pixels from the upper left corner.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_draw::schematic::Schematic;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("Decay")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50))
    ///     .element("P1", ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.5))
    ///     .run(1.0, 1e-3)
    ///     .build()?;
    /// let json = Schematic::new(&Circuit::new(&patch)?, "", "", &|_| None)?.to_json();
    /// assert_eq!(json["symbols"][0]["name"], "A1");
    /// assert_eq!(json["nets"][0]["to"][0]["name"], "P1");
    /// # Ok(())
    /// # }
    /// ```
    pub fn to_json(&self) -> Value {
        let drawing = self.drawing();
        json_value(&SchematicSummary {
            width: drawing.width,
            height: drawing.height,
            symbols: symbols(&self.main),
            nets: nets(&self.main),
            macros: self.macros.iter().map(MacroSummary::new).collect(),
        })
    }
}

/// The content of a schematic.
#[derive(Serialize)]
struct SchematicSummary<'a> {
    /// The width of the sheet in pixels.
    width: f64,
    /// The height of the sheet in pixels.
    height: f64,
    /// The symbols of the main diagram, in its order.
    symbols: Vec<SymbolSummary<'a>>,
    /// The nets of the main diagram, in its order.
    nets: Vec<NetSummary<'a>>,
    /// Every macro of the circuit, opened once; empty if all instances are expanded.
    macros: Vec<MacroSummary<'a>>,
}

/// An opened macro.
#[derive(Serialize)]
struct MacroSummary<'a> {
    /// The name of the macro.
    name: &'a str,
    /// The instance whose settings, signals and voltages are shown.
    instance: &'a str,
    /// The symbols, with their names in the macro.
    symbols: Vec<SymbolSummary<'a>>,
    /// The nets inside the macro.
    nets: Vec<NetSummary<'a>>,
}

/// A symbol with its position.
#[derive(Serialize)]
struct SymbolSummary<'a> {
    /// The name of the element, instance or port.
    name: &'a str,
    /// The kind of the element, such as "summer", or the name of the macro.
    kind: &'a str,
    /// The name of the shape, such as "amplifier".
    symbol: &'a str,
    /// The anchor in pixels.
    at: Point,
    /// The area with all texts in pixels: left, top, right, bottom.
    area: [f64; 4],
    /// The switching position; `None` if the element does not switch or voltages are not drawn.
    position: Option<&'a str>,
    /// The outputs from the top down.
    outputs: Vec<OutputSummary<'a>>,
    /// The names of signals at elements inside an instance that are not among its outputs.
    inside: &'a [String],
    /// All texts of the symbol, in the order in which they are drawn.
    texts: Vec<&'a str>,
}

/// An output of a symbol.
#[derive(Serialize)]
struct OutputSummary<'a> {
    /// The name of the output port; empty if there is one output only.
    port: &'a str,
    /// The start of the cord in pixels.
    at: Point,
    /// The names of the signals at the output.
    signals: &'a [String],
    /// The voltage in volts of the machine; `None` if voltages are not drawn.
    volts: Option<f64>,
}

/// A net: the output that drives it, and the connected inputs.
#[derive(Serialize)]
struct NetSummary<'a> {
    /// The output that drives the net.
    from: NetSource<'a>,
    /// The connected inputs.
    to: Vec<NetReader<'a>>,
    /// The horizontal and vertical lines, each with its two ends in pixels.
    lines: &'a [[Point; 2]],
    /// The points at which the net branches, in pixels.
    dots: &'a [Point],
}

/// The output that drives a net.
#[derive(Serialize)]
struct NetSource<'a> {
    /// The name of the symbol.
    name: &'a str,
    /// The name of the output port; empty unless the symbol is an instance of a macro.
    port: &'a str,
    /// The start of the cord in pixels.
    at: Point,
}

/// An input that is connected to a net.
#[derive(Serialize)]
struct NetReader<'a> {
    /// The name of the symbol.
    name: &'a str,
    /// The key of the jack in the patch file, such as `x10`.
    jack: String,
    /// The end of the cord in pixels.
    at: Point,
}

impl<'a> MacroSummary<'a> {
    /// Returns the summary of an opened macro.
    fn new(opened: &'a OpenedMacro) -> MacroSummary<'a> {
        MacroSummary {
            name: &opened.of,
            instance: &opened.instance,
            symbols: symbols(&opened.diagram),
            nets: nets(&opened.diagram),
        }
    }
}

impl<'a> SymbolSummary<'a> {
    /// Returns the summary of a symbol.
    fn new(placed: &'a PlacedSymbol) -> SymbolSummary<'a> {
        let (symbol, area) = (&placed.symbol, placed.area);
        let outputs = symbol.outputs.iter().zip(&placed.outputs).map(|(output, at)| OutputSummary {
            port: &output.port,
            at: *at,
            signals: &output.signals,
            volts: output.volts,
        });
        SymbolSummary {
            name: &symbol.name,
            kind: &symbol.kind,
            symbol: symbol.shape,
            at: placed.at,
            area: [area.left, area.top, area.right, area.bottom],
            position: symbol.position,
            outputs: outputs.collect(),
            inside: &symbol.inside,
            texts: placed.labels().map(|label| label.text.as_str()).collect(),
        }
    }
}

/// Returns the symbols of a diagram in its order.
fn symbols(diagram: &Diagram) -> Vec<SymbolSummary<'_>> {
    diagram.symbols.iter().map(SymbolSummary::new).collect()
}

/// Returns the nets of a diagram in its order.
fn nets(diagram: &Diagram) -> Vec<NetSummary<'_>> {
    diagram.nets.iter().map(|net| net_summary(diagram, net)).collect()
}

/// Returns a net with the names and the jacks of its symbols.
fn net_summary<'a>(diagram: &'a Diagram, net: &'a Net) -> NetSummary<'a> {
    let from = &diagram.symbols[net.from];
    let reader = |(reader, jack): &(usize, usize)| {
        let reader = &diagram.symbols[*reader];
        NetReader { name: &reader.symbol.name, jack: jack_key(reader, *jack), at: reader.inputs[*jack] }
    };
    NetSummary {
        from: NetSource {
            name: &from.symbol.name,
            port: &from.symbol.outputs[net.output].port,
            at: from.outputs[net.output],
        },
        to: net.to.iter().map(reader).collect(),
        lines: &net.route.lines,
        dots: &net.route.dots,
    }
}

/// Returns the key of a jack in the patch file, such as `x10`.
pub(super) fn jack_key(placed: &PlacedSymbol, jack: usize) -> String {
    let jack = &placed.symbol.jacks[jack];
    jack.gain.map_or_else(|| jack.input.clone(), |gain| format!("{}{gain}", jack.input))
}
