//! The shapes of the symbols.
//!
//! Each file has one group of shapes, and each shape is one row of [`SHAPES`]. A shape is drawn around
//! its anchor. References at its jacks, and names and voltages at its outputs, are then added.

mod amplifier;
mod art;
mod diodes;
mod drive;
mod function;
mod network;
mod ports;
mod switching;

use super::symbol::{CordSource, Symbol, SymbolSetting};
use crate::plot::{Align, Area, Ink, Label, Primitive, with_minus_sign};

pub(super) use art::{Art, CORD, NAME, PRINT, SMALL};

/// A function that draws a symbol around its anchor.
type Draw = fn(&Symbol) -> Art;

/// A shape: its name in the registry of elements, its function, and the settings that it shows.
type ShapeRow = (&'static str, Draw, &'static [&'static str]);

/// Every shape.
pub(super) static SHAPES: &[ShapeRow] = &[
    ("amplifier", amplifier::summer, &["limit.upper", "limit.lower"]),
    ("open-amplifier", amplifier::open, &["limit.upper", "limit.lower"]),
    ("integrator", amplifier::integrator, &["initial", "limit.upper", "limit.lower"]),
    ("lag", amplifier::lag, &["time", "initial", "limit.upper", "limit.lower"]),
    ("track-hold", switching::track_hold, &["initial", "threshold"]),
    ("potentiometer", network::potentiometer, &["setting"]),
    ("free-potentiometer", network::free_potentiometer, &["setting"]),
    ("diode-dead-zone", diodes::dead_zone, &["setting"]),
    ("diode-lower-of", diodes::lower_of, &[]),
    ("diode-upper-of", diodes::upper_of, &[]),
    ("multiplier", function::multiplier, &["mode"]),
    ("absolute", function::absolute, &[]),
    ("dead-zone", function::dead_zone, &["lower", "upper"]),
    ("backlash", function::backlash, &["width"]),
    ("function-generator", function::generator, &[]),
    ("sin", function::sin, &[]),
    ("cos", function::cos, &[]),
    ("log", function::log, &[]),
    ("exp", function::exp, &[]),
    ("comparator", switching::comparator, &["threshold"]),
    ("relay", switching::relay, &["pull_in", "drop_out"]),
    ("switch", switching::key, &["closed"]),
    ("delay", function::delay, &["delay"]),
    ("macro", ports::instance, &[]),
    ("port-in", ports::input, &[]),
    ("port-out", ports::output, &[]),
    ("drive-step", drive::step, &[]),
    ("drive-ramp", drive::ramp, &[]),
    ("drive-pulse", drive::pulse, &[]),
    ("drive-square", drive::square, &[]),
    ("drive-triangle", drive::triangle, &[]),
    ("drive-sine", drive::sine, &[]),
    ("drive-chirp", drive::chirp, &[]),
    ("drive-noise", drive::noise, &[]),
    ("drive-table", drive::table, &[]),
];

/// Returns the row of the shape of a symbol; `None` if the shape is unknown.
fn row_of(symbol: &Symbol) -> Option<&'static ShapeRow> {
    SHAPES.iter().find(|(name, ..)| *name == symbol.shape)
}

/// The gap between an output and the names and voltages at it.
const READING_GAP: f64 = 4.0;

/// Draws a symbol with its signal names, voltages and references.
///
/// An unknown shape, or one with too few inputs, is drawn as a plain box.
pub(super) fn draw(symbol: &Symbol) -> Art {
    let mut art = row_of(symbol).map_or_else(|| network::plain_box(symbol), |(_, draw, _)| draw(symbol));
    if art.inputs.len() < symbol.jacks.len() {
        art = network::plain_box(symbol);
    }
    references(symbol, &mut art);
    readings(symbol, &mut art);
    art
}

/// Whether a symbol shows a setting, or may omit it because the patch does not specify it.
pub(super) fn shows_setting(symbol: &Symbol, setting: &SymbolSetting) -> bool {
    !setting.is_given || row_of(symbol).is_some_and(|(.., written)| written.contains(&setting.name.as_str()))
}

/// Returns the settings that the shape of a symbol shows, in the order in which it draws them.
pub(super) fn drawn_settings(symbol: &Symbol) -> impl Iterator<Item = &SymbolSetting> {
    let names = row_of(symbol).map_or(&[][..], |(.., names)| *names);
    names.iter().filter_map(|name| symbol.setting(name))
}

/// Returns the number of leading jacks that may be exchanged, which are those of a summing input.
pub(super) fn exchangeable(symbol: &Symbol) -> usize {
    let summing = symbol.jacks.iter().take_while(|jack| jack.input == "x");
    summing.count()
}

/// Draws the references at the jacks of a symbol: a flag with its name, or the sign of ground.
fn references(symbol: &Symbol, art: &mut Art) {
    let texts: Vec<Area> = art.labels().map(Label::area).collect();
    for (jack, at) in symbol.jacks.iter().zip(art.inputs.clone()) {
        let CordSource::Reference(name) = jack.from else { continue };
        let is_at_height = |text: &&Area| text.top < at.1 + FLAG.1 / 2.0 && at.1 - FLAG.1 / 2.0 < text.bottom;
        let clear = texts.iter().filter(is_at_height).map(|text| text.left - FLAG_GAP);
        let tip = clear.fold(at.0, f64::min).min(at.0 - STUB);
        art.line(&[(tip, at.1), at]);
        match name {
            "ground" => ground((tip, at.1), art),
            name => flag(name, (tip, at.1), art),
        }
    }
}

/// The minimum length of the cord to a reference.
const STUB: f64 = 9.0;
/// The gap between a reference and a text at the jack.
const FLAG_GAP: f64 = 2.0;
/// The width and height of the flag of a reference.
const FLAG: (f64, f64) = (34.0, 13.0);

/// Draws a flag with the name of a reference; its tip is at a point.
fn flag(name: &str, at: (f64, f64), art: &mut Art) {
    let (tip, half) = (at.0, FLAG.1 / 2.0);
    let (left, shoulder) = (tip - FLAG.0, tip - half);
    let outline = [
        (left, at.1 - half),
        (shoulder, at.1 - half),
        (tip, at.1),
        (shoulder, at.1 + half),
        (left, at.1 + half),
    ];
    art.body(&outline);
    art.text(
        &with_minus_sign(name),
        ((left + shoulder) / 2.0 + 1.0, at.1 + 3.4),
        SMALL,
        Align::Middle,
        Ink::Line,
    );
}

/// Draws the sign of ground: three lines that get shorter to the left.
fn ground(at: (f64, f64), art: &mut Art) {
    for (step, half) in [6.0, 4.0, 2.0].into_iter().enumerate() {
        let x = at.0 - 3.0 * step as f64;
        art.line(&[(x, at.1 - half), (x, at.1 + half)]);
    }
}

/// Writes signal names above the cords at the outputs and voltages below them.
///
/// The area of a voltage is reserved even if voltages are not drawn, so that both drawings have the same
/// layout.
fn readings(symbol: &Symbol, art: &mut Art) {
    if symbol.shape.starts_with("port-") {
        return;
    }
    for (index, output) in symbol.outputs.iter().enumerate() {
        let (x, y) = art.outputs[index];
        let label = |text: String, down: f64, ink| {
            Label::new(text, (x + READING_GAP, y + down), PRINT, Align::Start, ink)
        };
        let names = label(output.signals.join(", "), -4.0, Ink::Signal);
        let widest = label(voltage(WIDEST_VOLTAGE), 11.0, Ink::Voltage);
        let volts = output.volts.map(|volts| Label { text: voltage(volts), ..widest.clone() });
        art.reserved = Some(hull(art.reserved.into_iter().chain([widest.area()])));
        art.outputs[index] = (names.area().right.max(widest.area().right).ceil(), y);
        art.cord(&[(x, y), art.outputs[index]]);
        let written = [Some(names).filter(|names| !names.text.is_empty()), volts];
        art.primitives.extend(written.into_iter().flatten().map(Primitive::Text));
    }
}

/// The voltage with the widest text.
const WIDEST_VOLTAGE: f64 = -100.0;

/// Formats a voltage with two decimals and its sign; zero has no sign.
fn voltage(volts: f64) -> String {
    let text = format!("{volts:+.2}");
    let is_zero = text.trim_start_matches(['+', '-']).chars().all(|digit| matches!(digit, '0' | '.'));
    if is_zero { "0.00".to_owned() } else { with_minus_sign(&text) }
}

/// Returns the smallest area that encloses the given areas.
pub(super) fn hull(areas: impl Iterator<Item = Area>) -> Area {
    let empty =
        Area { left: f64::INFINITY, top: f64::INFINITY, right: f64::NEG_INFINITY, bottom: f64::NEG_INFINITY };
    areas.fold(empty, |hull, area| Area {
        left: hull.left.min(area.left),
        top: hull.top.min(area.top),
        right: hull.right.max(area.right),
        bottom: hull.bottom.max(area.bottom),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voltages_have_signs() {
        let shown = [0.0, -0.001, 12.345, -100.0].map(voltage);
        assert_eq!(shown, ["0.00", "0.00", "+12.35", "−100.00"]);
    }
}
