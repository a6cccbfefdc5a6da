//! The schematic as a JSON value.

use serde_json::{Value, json};

use super::diagram::{Diagram, Net, PlacedSymbol};
use super::layout::Point;
use super::sheet::{Opened, Schematic};
use super::symbol::Outlet;

impl Schematic {
    /// Symbols with their places and nets with their lines, in pixels from the upper left corner.
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

fn opened(opened: &Opened) -> Value {
    json!({
        "name": opened.of,
        "instance": opened.instance,
        "symbols": opened.diagram.symbols_json(),
        "nets": opened.diagram.nets_json(),
    })
}

impl Diagram {
    fn symbols_json(&self) -> Value {
        self.symbols.iter().map(symbol).collect()
    }

    fn nets_json(&self) -> Value {
        self.nets.iter().map(|net| self.net(net)).collect()
    }

    fn net(&self, net: &Net) -> Value {
        let to = net.to.iter().map(|(reader, jack)| {
            let reader = &self.symbols[*reader];
            json!({"name": reader.symbol.name, "jack": jack_name(reader, *jack), "at": place(reader.inputs[*jack])})
        });
        let from = &self.symbols[net.from];
        let port = &from.symbol.outlets[net.outlet].port;
        json!({
            "from": {"name": from.symbol.name, "port": port, "at": place(from.outputs[net.outlet])},
            "to": to.collect::<Value>(),
            "lines": net.route.lines.iter().map(|line| json!([place(line[0]), place(line[1])])).collect::<Value>(),
            "dots": net.route.dots.iter().map(|dot| place(*dot)).collect::<Value>(),
        })
    }
}

fn symbol(placed: &PlacedSymbol) -> Value {
    let symbol = &placed.symbol;
    let outlet = |(outlet, at): (&Outlet, &Point)| json!({"port": outlet.port, "at": place(*at), "signals": outlet.signals, "volts": outlet.volts});
    json!({
        "name": symbol.name,
        "kind": symbol.kind,
        "symbol": symbol.shape,
        "at": place(placed.at),
        "area": [placed.area.left, placed.area.top, placed.area.right, placed.area.bottom],
        "position": symbol.position,
        "outputs": symbol.outlets.iter().zip(&placed.outputs).map(outlet).collect::<Value>(),
        "inside": symbol.inside,
        "texts": placed.labels().map(|label| json!(label.text)).collect::<Value>(),
    })
}

fn jack_name(placed: &PlacedSymbol, jack: usize) -> String {
    let jack = &placed.symbol.jacks[jack];
    jack.gain.map_or_else(|| jack.input.to_owned(), |gain| format!("{}{gain}", jack.input))
}

fn place(at: Point) -> Value {
    json!([at.0, at.1])
}
