//! Draws the empty panel: modules, jacks and texts.

use super::Module;
use super::cords::draw_link;
use crate::plot::{Align, Area, Ink, Label, Primitive, truncate_text};
use crate::schematic::layout::Point;
use crate::schematic::shapes::{NAME, PRINT, SMALL};

/// Draws modules without jacks and texts.
pub(super) fn draw(modules: &[Module], primitives: &mut Vec<Primitive>) {
    for module in modules {
        let [(left, top), (right, bottom)] = module.corners;
        let corners = vec![(left, top), (right, top), (right, bottom), (left, bottom)];
        let edge = corners.iter().chain(corners.first()).copied().collect();
        primitives.push(Primitive::Area { corners: corners.clone(), ink: Ink::Body });
        primitives.push(Primitive::Line { points: edge, width: 1.0, ink: Ink::Faint });
    }
}

/// The explanation of dashed cords below the panel.
const LINKS: &str = "links between the parts of one element, to be plugged in like the cords";

/// The radius of a jack and of its plug.
pub(super) const JACK_RADIUS: f64 = 4.4;

/// Draws the jacks. They are in front of the cords.
pub(super) fn draw_jacks(modules: &[Module], primitives: &mut Vec<Primitive>) {
    for centre in modules.iter().flat_map(Module::jacks) {
        primitives.push(Primitive::Disc { centre, radius: JACK_RADIUS, ink: Ink::Page });
        primitives.push(Primitive::Ring { centre, radius: JACK_RADIUS, width: 1.2, ink: Ink::Soft });
    }
}

/// Writes headings, names, settings and gains on plates. They are in front of the cords.
///
/// The plates have the colour of the background, so that a text stays readable if a cord passes below it.
pub(super) fn draw_texts(modules: &[Module], rows: &[(String, Point)], primitives: &mut Vec<Primitive>) {
    for (heading, at) in rows {
        plate(Label::new(heading, *at, PRINT, Align::Start, Ink::Signal), Ink::Page, primitives);
    }
    for module in modules {
        let [(left, top), (right, _)] = module.corners;
        let (middle, max_width) = ((left + right) / 2.0, right - left - 8.0);
        let name = truncate_text(&module.name, NAME, max_width);
        plate(Label::new(name, (middle, top + 14.0), NAME, Align::Middle, Ink::Line), Ink::Body, primitives);
        let texts = [module.kind.as_str(), module.note.as_str()].into_iter().filter(|text| !text.is_empty());
        let note = truncate_text(&texts.collect::<Vec<_>>().join(", "), SMALL, max_width);
        plate(Label::new(note, (middle, top + 26.0), SMALL, Align::Middle, Ink::Soft), Ink::Body, primitives);
        for (name, at) in &module.inputs {
            let label = truncate_text(name, SMALL, max_width * 0.6);
            plate(
                Label::new(label, (at.0 - 5.0, at.1 - 7.5), SMALL, Align::Start, Ink::Line),
                Ink::Body,
                primitives,
            );
        }
    }
}

/// Draws the explanation of dashed cords.
pub(super) fn draw_legend((left, y): Point, primitives: &mut Vec<Primitive>) {
    let sample: Vec<_> = (0..6).map(|point| (left + 8.0 * f64::from(point), y - 3.5)).collect();
    draw_link(&sample, primitives);
    primitives.push(Primitive::Text(Label::new(LINKS, (left + 48.0, y), SMALL, Align::Start, Ink::Soft)));
}

/// Draws a text on a small plate of the given colour; an empty text is not drawn.
fn plate(label: Label, ink: Ink, primitives: &mut Vec<Primitive>) {
    if label.text.is_empty() {
        return;
    }
    let Area { left, top, right, bottom } = label.area();
    let (left, right) = (left - 1.0, right + 2.0);
    let corners = vec![(left, top), (right, top), (right, bottom), (left, bottom)];
    primitives.push(Primitive::Area { corners, ink });
    primitives.push(Primitive::Text(label));
}
