use super::clip::{Area, clipped};
use super::surface::Surface;
use super::trace::{Projection, runs};
use super::{Channel, Picture, PlotError, palette};

/// Thickness of a bar through a dot.
const BAR: f64 = 1.2;

/// Darkens the stretches of the screen that stand out.
pub(super) fn spans(picture: &Picture, screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    let place = |at: f64| screen.left + picture.horizontal.fraction(at).clamp(0.0, 1.0) * screen.width();
    let mut there = picture.spans.iter().filter(|[from, to]| from <= to);
    there.try_for_each(|span| {
        let [from, to] = span.map(place);
        surface.rectangle((from, screen.top), (to, screen.bottom), palette::SPAN)
    })
}

/// Draws what lies behind traces: how far their points may be off.
pub(super) fn draw(picture: &Picture, screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    for (index, channel) in picture.channels.iter().enumerate().filter(|(_, own)| !own.errors.is_empty()) {
        let onto = Projection { picture, channel, screen };
        let colour = palette::channel(index, channel);
        let [upper, lower] = [1.0, -1.0].map(|side| edge(channel, side));
        for (upper, lower) in runs(&upper, channel).into_iter().zip(runs(&lower, channel)) {
            let [upper, lower] = [upper, lower].map(|run| run.iter().map(|point| onto.place(*point)));
            if channel.dots {
                let bar: Vec<_> = upper.chain(lower).collect();
                let bar = clipped(&bar, screen);
                bar.iter().try_for_each(|bar| surface.line(bar, BAR, colour))?;
            } else {
                let corners: Vec<_> = upper.chain(lower.rev()).map(|at| within(at, screen)).collect();
                surface.area(&corners, palette::pale(colour))?;
            }
        }
    }
    Ok(())
}

/// The points moved to one end of what they may be off by.
fn edge(channel: &Channel, side: f64) -> Vec<(f64, f64)> {
    let pairs = channel.points.iter().zip(&channel.errors);
    pairs.map(|((x, y), error)| (*x, y + side * error)).collect()
}

fn within((x, y): (f64, f64), screen: Area) -> (f64, f64) {
    (x.clamp(screen.left, screen.right), y.clamp(screen.top, screen.bottom))
}
