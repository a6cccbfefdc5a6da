//! The schematic as a JSON value.

use serde_json::{Value, json};

use super::diagram::{Diagram, Net, PlacedSymbol};
use super::layout::Point;
use super::sheet::{OpenedMacro, Schematic};
use super::symbol::SymbolOutput;

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
        json!({
            "width": drawing.width,
            "height": drawing.height,
            "symbols": self.main.symbols_json(),
            "nets": self.main.nets_json(),
            "macros": self.macros.iter().map(opened).collect::<Value>(),
        })
    }
}

/// Returns an opened macro: its name, the instance that is shown, symbols and nets.
fn opened(opened: &OpenedMacro) -> Value {
    json!({
        "name": opened.of,
        "instance": opened.instance,
        "symbols": opened.diagram.symbols_json(),
        "nets": opened.diagram.nets_json(),
    })
}

impl Diagram {
    /// Returns the symbols in the order of the diagram.
    fn symbols_json(&self) -> Value {
        self.symbols.iter().map(symbol).collect()
    }

    /// Returns the nets in the order of the diagram.
    fn nets_json(&self) -> Value {
        self.nets.iter().map(|net| self.net(net)).collect()
    }

    /// Returns a net: the output that drives it, the connected inputs, the lines and the dots.
    ///
    /// A jack has the key that it has in the patch file. `port` is empty unless the source is an instance of a macro.
    fn net(&self, net: &Net) -> Value {
        let to = net.to.iter().map(|(reader, jack)| {
            let reader = &self.symbols[*reader];
            json!({"name": reader.symbol.name, "jack": jack_name(reader, *jack), "at": point(reader.inputs[*jack])})
        });
        let from = &self.symbols[net.from];
        let port = &from.symbol.outputs[net.output].port;
        json!({
            "from": {"name": from.symbol.name, "port": port, "at": point(from.outputs[net.output])},
            "to": to.collect::<Value>(),
            "lines": net.route.lines.iter().map(|line| json!([point(line[0]), point(line[1])])).collect::<Value>(),
            "dots": net.route.dots.iter().map(|dot| point(*dot)).collect::<Value>(),
        })
    }
}

/// Returns a symbol with its anchor `at` and its `area` as `[left, top, right, bottom]`.
///
/// `position` and `volts` are null if no voltages are drawn. `texts` are all texts of the symbol, in the order in which
/// they are drawn.
fn symbol(placed: &PlacedSymbol) -> Value {
    let symbol = &placed.symbol;
    let output = |(output, at): (&SymbolOutput, &Point)| json!({"port": output.port, "at": point(*at), "signals": output.signals, "volts": output.volts});
    json!({
        "name": symbol.name,
        "kind": symbol.kind,
        "symbol": symbol.shape,
        "at": point(placed.at),
        "area": [placed.area.left, placed.area.top, placed.area.right, placed.area.bottom],
        "position": symbol.position,
        "outputs": symbol.outputs.iter().zip(&placed.outputs).map(output).collect::<Value>(),
        "inside": symbol.inside,
        "texts": placed.labels().map(|label| json!(label.text)).collect::<Value>(),
    })
}

/// Returns the key of a jack in the patch file, such as `x10`.
fn jack_name(placed: &PlacedSymbol, jack: usize) -> String {
    let jack = &placed.symbol.jacks[jack];
    jack.gain.map_or_else(|| jack.input.to_owned(), |gain| format!("{}{gain}", jack.input))
}

/// Returns a position as `[x, y]`.
fn point(at: Point) -> Value {
    json!([at.0, at.1])
}
