//! Draws highlighted spans, error bands of lines and error bars of dots.

use super::clip::{Area, clip};
use super::surface::Surface;
use super::trace::{Projection, segments};
use super::{Channel, Picture, PlotError, palette};

/// The thickness of an error bar.
const BAR_WIDTH: f64 = 1.2;

/// Darkens the screen over the spans of a picture. A span with NaN or reversed ends is ignored.
pub(super) fn spans(picture: &Picture, screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    let position = |at: f64| screen.left + picture.horizontal.fraction(at).clamp(0.0, 1.0) * screen.width();
    let mut valid = picture.spans.iter().filter(|[from, to]| from <= to);
    valid.try_for_each(|span| {
        let [from, to] = span.map(position);
        surface.rectangle((from, screen.top), (to, screen.bottom), palette::SPAN)
    })
}

/// Draws the errors of the channels: a band behind a line, a bar through a dot.
pub(super) fn draw(picture: &Picture, screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    for (index, channel) in
        picture.channels.iter().enumerate().filter(|(_, channel)| !channel.errors.is_empty())
    {
        let projection = Projection { picture, channel, screen };
        let colour = palette::channel(index, channel);
        let [upper, lower] = [1.0, -1.0].map(|side| edge(channel, side));
        for (upper, lower) in segments(&upper, channel).into_iter().zip(segments(&lower, channel)) {
            let [upper, lower] =
                [upper, lower].map(|segment| segment.iter().map(|point| projection.project(*point)));
            if channel.dots {
                let bar: Vec<_> = upper.chain(lower).collect();
                let bar = clip(&bar, screen);
                bar.iter().try_for_each(|bar| surface.line(bar, BAR_WIDTH, colour))?;
            } else {
                let corners: Vec<_> = upper.chain(lower.rev()).map(|at| clamp_to(at, screen)).collect();
                surface.area(&corners, palette::pale(colour))?;
            }
        }
    }
    Ok(())
}

/// Returns the points shifted by `side` times their errors; `side` is 1 or -1.
/// An error band is the area between the edges of both sides.
fn edge(channel: &Channel, side: f64) -> Vec<(f64, f64)> {
    let pairs = channel.points.iter().zip(&channel.errors);
    pairs.map(|((x, y), error)| (*x, y + side * error)).collect()
}

/// Returns the point of the screen nearest to a point.
fn clamp_to((x, y): (f64, f64), screen: Area) -> (f64, f64) {
    (x.clamp(screen.left, screen.right), y.clamp(screen.top, screen.bottom))
}
