//! What the empty panel looks like: modules, jacks, texts.

use super::Module;
use super::cords::draw_link;
use crate::plot::{Align, Area, Ink, Label, Stroke, text_within};
use crate::schematic::layout::Point;
use crate::schematic::shapes::{NAME, PRINT, SMALL};

/// Draws modules without jacks and texts.
pub(super) fn draw(modules: &[Module], marks: &mut Vec<Stroke>) {
    for module in modules {
        let [(left, top), (right, bottom)] = module.corners;
        let corners = vec![(left, top), (right, top), (right, bottom), (left, bottom)];
        let edge = corners.iter().chain(corners.first()).copied().collect();
        marks.push(Stroke::Area { corners: corners.clone(), ink: Ink::Body });
        marks.push(Stroke::Line { points: edge, width: 1.0, ink: Ink::Faint });
    }
}

/// What dashed cords are.
const LINKS: &str = "links between the parts of one element, to be plugged in like the cords";

/// Radius of a jack, and of the plug that fills it.
pub(super) const JACK: f64 = 4.4;

/// Draws the jacks, in front of the cords.
pub(super) fn draw_jacks(modules: &[Module], marks: &mut Vec<Stroke>) {
    for centre in modules.iter().flat_map(Module::jacks) {
        marks.push(Stroke::Disc { centre, radius: JACK, ink: Ink::Page });
        marks.push(Stroke::Ring { centre, radius: JACK, width: 1.2, ink: Ink::Soft });
    }
}

/// Writes headings, names, settings and gains on plates in front of the cords.
pub(super) fn draw_texts(modules: &[Module], rows: &[(String, Point)], marks: &mut Vec<Stroke>) {
    for (heading, at) in rows {
        plate(text(heading, *at, PRINT, Align::Start, Ink::Signal), Ink::Page, marks);
    }
    for module in modules {
        let [(left, top), (right, _)] = module.corners;
        let (middle, room) = ((left + right) / 2.0, right - left - 8.0);
        let name = text_within(&module.name, NAME, room);
        plate(text(&name, (middle, top + 14.0), NAME, Align::Middle, Ink::Line), Ink::Body, marks);
        let told = [module.kind.as_str(), module.note.as_str()].into_iter().filter(|told| !told.is_empty());
        let note = text_within(&told.collect::<Vec<_>>().join(", "), SMALL, room);
        plate(text(&note, (middle, top + 26.0), SMALL, Align::Middle, Ink::Soft), Ink::Body, marks);
        for (name, at) in &module.inputs {
            let label = text_within(name, SMALL, room * 0.6);
            plate(text(&label, (at.0 - 5.0, at.1 - 7.5), SMALL, Align::Start, Ink::Line), Ink::Body, marks);
        }
    }
}

/// Says what dashed cords are.
pub(super) fn draw_legend((left, y): Point, marks: &mut Vec<Stroke>) {
    let sample: Vec<_> = (0..6).map(|point| (left + 8.0 * f64::from(point), y - 3.5)).collect();
    draw_link(&sample, marks);
    marks.push(Stroke::Text(text(LINKS, (left + 48.0, y), SMALL, Align::Start, Ink::Soft)));
}

/// A text on a small plate.
fn plate(label: Label, ink: Ink, marks: &mut Vec<Stroke>) {
    if label.text.is_empty() {
        return;
    }
    let Area { left, top, right, bottom } = label.area();
    let (left, right) = (left - 1.0, right + 2.0);
    let corners = vec![(left, top), (right, top), (right, bottom), (left, bottom)];
    marks.push(Stroke::Area { corners, ink });
    marks.push(Stroke::Text(label));
}

fn text(text: &str, at: Point, size: f64, align: Align, ink: Ink) -> Label {
    Label { text: text.to_owned(), at, size, align, ink }
}
