//! The schematic as data for a page that draws it and shows voltages at its outputs.
//!
//! A page knows neither symbols nor layout: it draws primitives. The data are compact because the page gets them again
//! after every change of the patch.

use patchcord_core::document::json_value;
use serde::{Serialize, Serializer};
use serde_json::Value;

use super::diagram::{Diagram, Net, PlacedSymbol};
use super::json::jack_key;
use super::layout::Point;
use super::shapes;
use super::sheet::Schematic;
use crate::plot::{Align, Area, Ink, Label, Primitive};

/// The margin around the diagram in pixels.
const MARGIN: f64 = 12.0;

/// Steps of a coordinate per pixel. With fewer, small curves have visible corners.
const STEPS: f64 = 10.0;

impl Schematic {
    /// Returns the main diagram for a page that shows it live: primitives, outputs, inputs and nets.
    ///
    /// The heading, the lists and opened macros are left out, and colours are names of inks. Positions are in pixels
    /// from the upper left corner of the diagram. The primitives of a symbol are arrays:
    ///
    /// ```text
    /// ["line", ink, width, [x, y, ...]]
    /// ["area", ink, [x, y, ...]]
    /// ["ring", ink, width, x, y, radius]
    /// ["disc", ink, x, y, radius]
    /// ["text", ink, size, "start" | "middle" | "end", x, y, text, setting]
    /// ```
    ///
    /// `setting` is the name of the setting whose value ends the text, or null. The name of an output is the one that
    /// the panel uses: "A1", or "L1.out" for an instance. A voltage is written along the line from `from` to `at`.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_draw::schematic::Schematic;
    /// use serde_json::json;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("Decay")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50))
    ///     .element("P1", ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.5))
    ///     .run(1.0, 1e-3)
    ///     .build()?;
    /// let json = Schematic::new(&Circuit::new(&patch)?, "", "", &|_| None)?.to_live_json();
    /// assert_eq!(json["symbols"][0]["outputs"][0]["name"], "A1");
    /// assert_eq!((&json["nets"][0]["from"], &json["nets"][0]["to"]), (&json!("A1"), &json!([["P1", "in"]])));
    /// # Ok(())
    /// # }
    /// ```
    pub fn to_live_json(&self) -> Value {
        let area = content_area(&self.main);
        let origin = Origin((area.left - MARGIN, area.top - MARGIN));
        json_value(&LiveDiagram {
            width: Pixels(area.width() + 2.0 * MARGIN),
            height: Pixels(area.height() + 2.0 * MARGIN),
            symbols: self.main.symbols.iter().map(|placed| LiveSymbol::new(placed, origin)).collect(),
            nets: self.main.nets.iter().map(|net| LiveNet::new(&self.main, net, origin)).collect(),
        })
    }
}

/// A diagram.
#[derive(Serialize)]
struct LiveDiagram<'a> {
    /// The width in pixels.
    width: Pixels,
    /// The height in pixels.
    height: Pixels,
    /// The symbols, in the order of the diagram.
    symbols: Vec<LiveSymbol<'a>>,
    /// The nets, in the order of the diagram.
    nets: Vec<LiveNet<'a>>,
}

/// A symbol.
#[derive(Serialize)]
struct LiveSymbol<'a> {
    /// The name of the element, drive or instance.
    name: &'a str,
    /// The kind of the element, such as "summer", or the name of the macro.
    kind: &'a str,
    /// The area with all texts: left, top, right, bottom.
    area: [Pixels; 4],
    /// The primitives from back to front, without the lines along which the voltages are written.
    primitives: Vec<LivePrimitive<'a>>,
    /// The outputs from the top down.
    outputs: Vec<LiveOutput<'a>>,
    /// The input jacks with cords, from the top down.
    inputs: Vec<LiveInput>,
}

/// An output of a symbol.
#[derive(Serialize)]
struct LiveOutput<'a> {
    /// The name of the output at the panel.
    name: String,
    /// The name of the output port of an instance; empty otherwise.
    port: &'a str,
    /// The edge of the symbol.
    from: [Pixels; 2],
    /// The start of the net.
    at: [Pixels; 2],
}

/// An input jack of a symbol.
#[derive(Serialize)]
struct LiveInput {
    /// The key of the jack in the patch file, such as `x10`.
    jack: String,
    /// The end of the cord.
    at: [Pixels; 2],
}

/// A net.
#[derive(Serialize)]
struct LiveNet<'a> {
    /// The name of the output at the panel.
    from: String,
    /// The connected inputs: name of the element and key of the jack.
    to: Vec<(&'a str, String)>,
    /// The horizontal and vertical lines, each from x, y to x, y.
    lines: Vec<[[Pixels; 2]; 2]>,
    /// The points at which the net branches.
    dots: Vec<[Pixels; 2]>,
    /// The tips of arrows on lines that run back.
    arrows: Vec<[Pixels; 2]>,
}

/// A primitive as an array that begins with its form and its ink.
#[derive(Serialize)]
#[serde(untagged)]
enum LivePrimitive<'a> {
    /// Form, ink, width, coordinates.
    Line(&'static str, &'static str, Pixels, Vec<Pixels>),
    /// Form, ink, coordinates.
    Area(&'static str, &'static str, Vec<Pixels>),
    /// Form, ink, width, centre, radius.
    Ring(&'static str, &'static str, Pixels, Pixels, Pixels, Pixels),
    /// Form, ink, centre, radius.
    Disc(&'static str, &'static str, Pixels, Pixels, Pixels),
    /// Form, ink, em size, alignment, position, text, name of the setting.
    Text(&'static str, &'static str, Pixels, &'static str, Pixels, Pixels, &'a str, Option<&'a str>),
}

/// A coordinate or a length in pixels. Its text is short because it is rounded.
#[derive(Debug, Clone, Copy)]
struct Pixels(f64);

impl Serialize for Pixels {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rounded = (self.0 * STEPS).round() / STEPS;
        if rounded.fract() == 0.0 {
            serializer.serialize_i64(rounded as i64)
        } else {
            serializer.serialize_f64(rounded)
        }
    }
}

/// The point of the sheet that is the upper left corner of the page's drawing.
#[derive(Debug, Clone, Copy)]
struct Origin(Point);

impl Origin {
    /// Returns the coordinates of a point of the sheet.
    fn place(self, (x, y): Point) -> [Pixels; 2] {
        [Pixels(x - self.0.0), Pixels(y - self.0.1)]
    }

    /// Returns the coordinates of points in one list.
    fn place_all(self, points: &[Point]) -> Vec<Pixels> {
        points.iter().flat_map(|at| self.place(*at)).collect()
    }
}

impl<'a> LiveSymbol<'a> {
    /// Returns the data of a symbol.
    fn new(placed: &'a PlacedSymbol, origin: Origin) -> LiveSymbol<'a> {
        let (symbol, area) = (&placed.symbol, placed.area);
        let [left, top] = origin.place((area.left, area.top));
        let [right, bottom] = origin.place((area.right, area.bottom));
        let marked = placed.primitives.iter().zip(setting_names(placed));
        let drawn = marked.filter(|(primitive, _)| stub(placed, primitive).is_none());
        let drawn = drawn.map(|(primitive, setting)| live_primitive(primitive, setting, origin));
        let outputs = symbol.outputs.iter().zip(&placed.outputs).map(|(output, at)| LiveOutput {
            name: output_name(&symbol.name, &output.port),
            port: &output.port,
            from: origin.place(stub_start(placed, *at)),
            at: origin.place(*at),
        });
        let input =
            |(jack, at): (usize, &Point)| LiveInput { jack: jack_key(placed, jack), at: origin.place(*at) };
        LiveSymbol {
            name: &symbol.name,
            kind: &symbol.kind,
            area: [left, top, right, bottom],
            primitives: drawn.collect(),
            outputs: outputs.collect(),
            // A shape may have more input positions than the symbol has jacks.
            inputs: placed.inputs.iter().take(symbol.jacks.len()).enumerate().map(input).collect(),
        }
    }
}

impl<'a> LiveNet<'a> {
    /// Returns the data of a net.
    fn new(diagram: &'a Diagram, net: &Net, origin: Origin) -> LiveNet<'a> {
        let from = &diagram.symbols[net.from].symbol;
        let reader = |(reader, jack): &(usize, usize)| {
            let reader = &diagram.symbols[*reader];
            (reader.symbol.name.as_str(), jack_key(reader, *jack))
        };
        let place = |at: &Point| origin.place(*at);
        LiveNet {
            from: output_name(&from.name, &from.outputs[net.output].port),
            to: net.to.iter().map(reader).collect(),
            lines: net.route.lines.iter().map(|line| line.map(|at| origin.place(at))).collect(),
            dots: net.route.dots.iter().map(place).collect(),
            arrows: net.route.arrows.iter().map(place).collect(),
        }
    }
}

/// Returns the name of an output at the panel.
fn output_name(symbol: &str, port: &str) -> String {
    if port.is_empty() { symbol.to_owned() } else { format!("{symbol}.{port}") }
}

/// Returns the area of all symbols and lines; an empty one at the corner of the sheet if there are none.
fn content_area(diagram: &Diagram) -> Area {
    let lines = diagram.nets.iter().flat_map(|net| net.route.lines.iter().flatten());
    let areas = diagram.symbols.iter().map(|placed| placed.area);
    let area = shapes::hull(areas.chain(lines.map(|at| Area::around(*at, 0.0))));
    if area.width() < 0.0 { Area { left: 0.0, top: 0.0, right: 0.0, bottom: 0.0 } } else { area }
}

/// Returns the ends of a primitive that is the piece of cord at an output; `None` if it is another primitive.
fn stub(placed: &PlacedSymbol, primitive: &Primitive) -> Option<(Point, Point)> {
    let Primitive::Line { points, ink: Ink::Wire, .. } = primitive else { return None };
    let (start, end) = (*points.first()?, *points.last()?);
    placed.outputs.contains(&end).then_some((start, end))
}

/// Returns the start of the piece of cord that ends at an output; the output itself if there is none.
fn stub_start(placed: &PlacedSymbol, output: Point) -> Point {
    let mut stubs = placed.primitives.iter().filter_map(|primitive| stub(placed, primitive));
    stubs.find(|(_, end)| *end == output).map_or(output, |(start, _)| start)
}

/// Returns the name of the setting whose value ends a text, for each primitive of a symbol.
fn setting_names(placed: &PlacedSymbol) -> Vec<Option<&str>> {
    let mut names: Vec<Option<&str>> = vec![None; placed.primitives.len()];
    for setting in shapes::drawn_settings(&placed.symbol) {
        let shows = |label: &Label| {
            let before = label.text.strip_suffix(setting.shown.as_str());
            before.is_some_and(|before| before.is_empty() || before.ends_with(' '))
        };
        let free = names
            .iter()
            .zip(&placed.primitives)
            .position(|(name, primitive)| name.is_none() && primitive.label().is_some_and(shows));
        if let Some(index) = free {
            names[index] = Some(setting.name.as_str());
        }
    }
    names
}

/// Returns the array of a primitive.
fn live_primitive<'a>(
    primitive: &'a Primitive,
    setting: Option<&'a str>,
    origin: Origin,
) -> LivePrimitive<'a> {
    match primitive {
        Primitive::Line { points, width, ink } => {
            LivePrimitive::Line("line", ink_name(*ink), Pixels(*width), origin.place_all(points))
        }
        Primitive::Area { corners, ink } => {
            LivePrimitive::Area("area", ink_name(*ink), origin.place_all(corners))
        }
        Primitive::Ring { centre, radius, width, ink } => {
            let [x, y] = origin.place(*centre);
            LivePrimitive::Ring("ring", ink_name(*ink), Pixels(*width), x, y, Pixels(*radius))
        }
        Primitive::Disc { centre, radius, ink } => {
            let [x, y] = origin.place(*centre);
            LivePrimitive::Disc("disc", ink_name(*ink), x, y, Pixels(*radius))
        }
        Primitive::Text(label) => {
            let ([x, y], ink, align) = (origin.place(label.at), ink_name(label.ink), align_name(label.align));
            LivePrimitive::Text("text", ink, Pixels(label.size), align, x, y, &label.text, setting)
        }
    }
}

/// Returns the name of an ink in the data.
fn ink_name(ink: Ink) -> &'static str {
    match ink {
        Ink::Page => "page",
        Ink::Body => "body",
        Ink::Line => "line",
        Ink::Wire => "wire",
        Ink::Soft => "soft",
        Ink::Faint => "faint",
        Ink::Signal => "signal",
        Ink::Voltage => "voltage",
        Ink::Cord(_) => "cord",
    }
}

/// Returns the name of an alignment, which is that of SVG.
fn align_name(align: Align) -> &'static str {
    match align {
        Align::Start => "start",
        Align::Middle => "middle",
        Align::End => "end",
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use patchcord_core::circuit::Circuit;
    use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    use serde_json::json;

    use super::*;

    /// A decay with an initial condition, a limit of the same voltage, and a pot.
    fn decay() -> Schematic {
        let integrator = ElementBuilder::new("integrator").cords("x1", ["P1"]).cords("x10", ["+100"]);
        let integrator = integrator.set("initial", 50).set("limit", json!({"upper": 50}));
        let patch = PatchBuilder::new("Decay")
            .element("A1", integrator)
            .element("P1", ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.5))
            .run(1.0, 1e-3)
            .build()
            .unwrap();
        Schematic::new(&Circuit::new(&patch).unwrap(), "", "", &|_| None).unwrap()
    }

    #[test]
    fn lengths_are_rounded_and_short() {
        let texts = [20.0, 20.04, 20.06, -0.01].map(|length| json_value(&Pixels(length)).to_string());
        assert_eq!(texts, ["20", "20", "20.1", "0"]);
    }

    #[test]
    fn the_drawing_is_within_its_size_and_has_every_net() {
        let json = decay().to_live_json();
        let number = |value: &Value| value.as_f64().unwrap();
        for symbol in json["symbols"].as_array().unwrap() {
            let area: Vec<f64> = symbol["area"].as_array().unwrap().iter().map(number).collect();
            assert!(area[0] >= MARGIN && area[1] >= MARGIN, "{area:?}");
            assert!(area[2] <= number(&json["width"]) - MARGIN + 0.1, "{area:?}");
            assert!(area[3] <= number(&json["height"]) - MARGIN + 0.1, "{area:?}");
        }
        let nets = json["nets"].as_array().unwrap();
        let ends: Vec<_> = nets.iter().map(|net| (&net["from"], &net["to"])).collect();
        let (to_pot, to_integrator) = (json!([["P1", "in"]]), json!([["A1", "x1"]]));
        assert_eq!(ends, [(&json!("A1"), &to_pot), (&json!("P1"), &to_integrator)]);
        let output = &json["symbols"][0]["outputs"][0];
        assert_eq!(output["from"][1], output["at"][1]);
        assert!(number(&output["at"][0]) - number(&output["from"][0]) > 20.0);
        let inputs = json["symbols"][0]["inputs"].as_array().unwrap();
        let jacks: BTreeSet<_> = inputs.iter().map(|input| input["jack"].as_str().unwrap()).collect();
        assert_eq!(jacks, BTreeSet::from(["x1", "x10"]));
    }

    #[test]
    fn texts_of_settings_are_marked() {
        let json = decay().to_live_json();
        let marked = |index: usize| -> Vec<(String, String)> {
            let primitives = json["symbols"][index]["primitives"].as_array().unwrap();
            let texts = primitives.iter().filter(|primitive| primitive[0] == "text");
            let texts = texts.filter_map(|text| Some((text[7].as_str()?, text[6].as_str()?)));
            texts.map(|(setting, text)| (setting.to_owned(), text.to_owned())).collect()
        };
        let pair = |setting: &str, text: &str| (setting.to_owned(), text.to_owned());
        assert_eq!(marked(0), [pair("initial", "IC 50 V"), pair("limit.upper", "≤ 50 V")]);
        assert_eq!(marked(1), [pair("setting", "0.5000")]);
    }

    #[test]
    fn an_empty_diagram_has_no_area() {
        assert_eq!(content_area(&Diagram::default()).width(), 0.0);
    }
}
