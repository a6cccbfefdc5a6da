//! Draws one picture from back to front: background, spans, error bands, graticule, border, traces, texts.

use super::font::Font;
use super::layout::Frame;
use super::surface::Surface;
use super::{Picture, PlotError, band, graticule, header, labels, markers, palette, scales, trace};

/// Draws one picture into the upper left corner of a surface.
pub(super) fn picture(
    picture: &Picture,
    frame: &Frame,
    font: &Font,
    surface: &mut dyn Surface,
) -> Result<(), PlotError> {
    surface.rectangle((0.0, 0.0), (frame.width, frame.height), palette::PAGE)?;
    let top = header::draw(picture, frame, font, surface)?;
    let screen = frame.screen(picture, top);
    graticule::background(screen, surface)?;
    band::spans(picture, screen, surface)?;
    band::draw(picture, screen, surface)?;
    graticule::draw(picture, screen, surface)?;
    // A trace at the edge, such as one at the limit of its amplifier, must be visible on the border.
    graticule::border(screen, surface)?;
    let marker_labels = markers::draw(picture, screen, font, surface)?;
    let mut drawn = Vec::new();
    let (background, foreground): (Vec<_>, Vec<_>) =
        picture.channels.iter().enumerate().partition(|(_, channel)| channel.faint);
    for (index, channel) in background.into_iter().chain(foreground) {
        for (part, colour) in trace::parts(channel, palette::channel(index, channel)) {
            let lines = trace::lines(picture, &part, screen, frame.unit);
            trace::draw(&lines, &part, colour, surface)?;
            drawn.extend(lines);
        }
    }
    labels::draw(picture, drawn, marker_labels, screen, font, surface)?;
    scales::draw(picture, frame, screen, font, surface)
}
