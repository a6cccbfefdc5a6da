//! The symbols of the trade: one file a group, one row a symbol in [`SHAPES`].

mod amplifier;
mod art;
mod diodes;
mod drive;
mod function;
mod network;
mod ports;
mod switching;

use super::symbol::{Setting, Source, Symbol};
use crate::plot::{Align, Area, Ink, Label, Stroke};

pub(super) use art::{Art, CORD, NAME, PRINT, SMALL};

/// A symbol drawn around its anchor.
type Draw = fn(&Symbol) -> Art;

/// Every symbol by its name in the registry of elements, with the settings that it writes.
pub(super) static SHAPES: &[(&str, Draw, &[&str])] = &[
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
    ("relay", switching::relay, &["pull_in", "drop_out"]),
    ("switch", switching::key, &["closed"]),
    ("delay", function::delay, &["delay"]),
    ("macro", ports::instance, &[]),
    ("port-in", ports::inlet, &[]),
    ("port-out", ports::outlet, &[]),
    ("drive-step", drive::step, &[]),
    ("drive-ramp", drive::ramp, &[]),
    ("drive-triangle", drive::triangle, &[]),
    ("drive-sine", drive::sine, &[]),
    ("drive-noise", drive::noise, &[]),
    ("drive-table", drive::table, &[]),
];

/// Room to the right of an output for the names and the voltage read there.
const READING_GAP: f64 = 4.0;

/// Draws a symbol with what is read at it and the references plugged into it.
pub(super) fn draw(symbol: &Symbol) -> Art {
    let row = SHAPES.iter().find(|(name, ..)| *name == symbol.shape);
    let mut art = row.map_or_else(|| network::plain_box(symbol), |(_, draw, _)| draw(symbol));
    if art.inputs.len() < symbol.jacks.len() {
        art = network::plain_box(symbol);
    }
    references(symbol, &mut art);
    readings(symbol, &mut art);
    art
}

/// Whether a symbol tells a setting, or may leave it out because the patch does not give it.
pub(super) fn tells(symbol: &Symbol, setting: &Setting) -> bool {
    let row = SHAPES.iter().find(|(name, ..)| *name == symbol.shape);
    !setting.is_given || row.is_some_and(|(.., written)| written.contains(&setting.name.as_str()))
}

/// How many of its first jacks are equal in rights.
pub(super) fn exchangeable(symbol: &Symbol) -> usize {
    let summing = symbol.jacks.iter().take_while(|jack| jack.input == "x");
    summing.count()
}

/// Flags of the references at the jacks that they are plugged into.
fn references(symbol: &Symbol, art: &mut Art) {
    let texts: Vec<Area> = art.labels().map(Label::area).collect();
    for (jack, at) in symbol.jacks.iter().zip(art.inputs.clone()) {
        let Source::Reference(name) = jack.from else { continue };
        let is_beside = |text: &&Area| text.top < at.1 + FLAG.1 / 2.0 && at.1 - FLAG.1 / 2.0 < text.bottom;
        let clear = texts.iter().filter(is_beside).map(|text| text.left - BESIDE);
        let tip = clear.fold(at.0, f64::min).min(at.0 - STUB);
        art.line(&[(tip, at.1), at]);
        match name {
            "ground" => ground((tip, at.1), art),
            name => flag(name, (tip, at.1), art),
        }
    }
}

/// Least length of the cord to a reference, and room between it and a text at the jack.
const STUB: f64 = 9.0;
const BESIDE: f64 = 2.0;
const FLAG: (f64, f64) = (34.0, 13.0);

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
        &name.replace('-', "−"),
        ((left + shoulder) / 2.0 + 1.0, at.1 + 3.4),
        SMALL,
        Align::Middle,
        Ink::Line,
    );
}

fn ground(at: (f64, f64), art: &mut Art) {
    for (step, half) in [6.0, 4.0, 2.0].into_iter().enumerate() {
        let x = at.0 - 3.0 * step as f64;
        art.line(&[(x, at.1 - half), (x, at.1 + half)]);
    }
}

/// Names of signals above the cords that leave, voltages below them; room is kept for voltages that are not drawn, so
/// that everything stands where it does with them.
fn readings(symbol: &Symbol, art: &mut Art) {
    if symbol.shape.starts_with("port-") {
        return;
    }
    for (index, outlet) in symbol.outlets.iter().enumerate() {
        let (x, y) = art.outputs[index];
        let label = |text, down, ink| Label {
            text,
            at: (x + READING_GAP, y + down),
            size: PRINT,
            align: Align::Start,
            ink,
        };
        let names = label(outlet.signals.join(", "), -4.0, Ink::Signal);
        let room = label(voltage(WIDEST_VOLTAGE), 11.0, Ink::Voltage);
        let volts = outlet.volts.map(|volts| Label { text: voltage(volts), ..room.clone() });
        art.kept = Some(hull(art.kept.into_iter().chain([room.area()])));
        art.outputs[index] = (names.area().right.max(room.area().right).ceil(), y);
        art.cord(&[(x, y), art.outputs[index]]);
        let written = [Some(names).filter(|names| !names.text.is_empty()), volts];
        art.marks.extend(written.into_iter().flatten().map(Stroke::Text));
    }
}

/// No voltage takes more room.
const WIDEST_VOLTAGE: f64 = -100.0;

/// A voltage as a voltmeter shows it.
fn voltage(volts: f64) -> String {
    let text = format!("{volts:+.2}");
    let nothing = text.trim_start_matches(['+', '-']).chars().all(|digit| matches!(digit, '0' | '.'));
    if nothing { "0.00".to_owned() } else { text.replace('-', "−") }
}

/// The hull of areas.
pub(super) fn hull(areas: impl Iterator<Item = Area>) -> Area {
    let nothing =
        Area { left: f64::INFINITY, top: f64::INFINITY, right: f64::NEG_INFINITY, bottom: f64::NEG_INFINITY };
    areas.fold(nothing, |hull, area| Area {
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
