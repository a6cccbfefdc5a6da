//! Draws one picture from back to front: background, spans, error bands, graticule, border, traces, texts.

use super::layout::Frame;
use super::surface::Surface;
use super::trace::Projection;
use super::{Picture, PlotError, band, graticule, header, labels, markers, palette, scales, trace};

/// Draws one picture into the upper left corner of a surface.
pub(super) fn picture(picture: &Picture, frame: &Frame, surface: &mut dyn Surface) -> Result<(), PlotError> {
    surface.rectangle((0.0, 0.0), (frame.width, frame.height), palette::PAGE)?;
    let top = header::draw(picture, frame, surface)?;
    let screen = frame.screen(picture, top);
    graticule::background(screen, surface)?;
    band::spans(picture, screen, surface)?;
    band::draw(picture, screen, surface)?;
    graticule::draw(picture, screen, surface)?;
    // A trace at the edge, such as one at the limit of its amplifier, must be visible on the border.
    graticule::border(screen, surface)?;
    let (background, foreground): (Vec<_>, Vec<_>) =
        picture.channels.iter().enumerate().partition(|(_, channel)| channel.faint);
    let ordered = background.into_iter().chain(foreground);
    let parts = ordered.flat_map(|(index, channel)| trace::parts(channel, palette::channel(index, channel)));
    let traces: Vec<_> = parts
        .map(|(part, colour)| (trace::lines(picture, &part, screen, frame.unit), part, colour))
        .collect();
    let lines: Vec<_> = traces.iter().flat_map(|(lines, ..)| lines).cloned().collect();
    let marker_labels = markers::draw(picture, &lines, screen, surface)?;
    for (lines, part, colour) in &traces {
        trace::draw(&Projection { picture, channel: part, screen }, lines, *colour, surface)?;
    }
    labels::draw(picture, lines, marker_labels, screen, surface)?;
    scales::draw(picture, frame, screen, surface)
}
