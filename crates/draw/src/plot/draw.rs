use super::font::Font;
use super::layout::Frame;
use super::surface::Surface;
use super::{Picture, PlotError, band, graticule, header, labels, marks, palette, scales, trace};

/// Draws one picture into the upper left corner of a surface.
pub(super) fn picture(
    picture: &Picture,
    frame: &Frame,
    font: &Font,
    surface: &mut dyn Surface,
) -> Result<(), PlotError> {
    surface.rectangle((0.0, 0.0), (frame.width, frame.height), palette::PAGE)?;
    let top = header::draw(picture, frame, font, surface)?;
    let screen = frame.screen(top);
    graticule::ground(screen, surface)?;
    band::spans(picture, screen, surface)?;
    band::draw(picture, screen, surface)?;
    graticule::draw(picture, screen, surface)?;
    let texts = marks::draw(picture, screen, font, surface)?;
    let mut drawn = Vec::new();
    let (behind, before): (Vec<_>, Vec<_>) =
        picture.channels.iter().enumerate().partition(|(_, channel)| channel.faint);
    for (index, channel) in behind.into_iter().chain(before) {
        let lines = trace::lines(picture, channel, screen, frame.unit);
        trace::draw(&lines, (index, channel), surface)?;
        drawn.extend(lines);
    }
    labels::draw(picture, &drawn, texts, screen, font, surface)?;
    graticule::border(screen, surface)?;
    scales::draw(picture, frame, screen, font, surface)
}
