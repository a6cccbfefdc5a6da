//! The colours of scope pictures.

use super::Channel;
use super::colour::Colour;

/// The background of the picture.
pub(super) const PAGE: Colour = Colour(255, 255, 255);
/// The background of the screen.
pub(super) const SCREEN: Colour = Colour(250, 251, 252);
/// Ordinary division lines.
pub(super) const GRID: Colour = Colour(219, 224, 230);
/// The lines at zero and the decades.
pub(super) const ZERO: Colour = Colour(160, 169, 180);
/// The edges of the screen.
pub(super) const BORDER: Colour = Colour(74, 85, 96);
/// Titles, numbers and names.
pub(super) const TEXT: Colour = Colour(28, 32, 38);
/// The note under the title, and labels of markers.
pub(super) const NOTE: Colour = Colour(90, 98, 108);
/// The warning under the title.
pub(super) const WARNING: Colour = Colour(176, 32, 24);
/// Highlighted spans of the horizontal axis.
pub(super) const SPAN: Colour = Colour(236, 238, 241);
/// Faint channels.
const FAINT: Colour = Colour(176, 183, 192);
/// The dashed lines of markers.
pub(super) const MARKER: Colour = Colour(132, 140, 152);

/// The colours of the traces in order. Neighbours differ in hue for colour-blind readers and in
/// lightness in a grey print.
const TRACES: [Colour; 6] = [
    Colour(11, 61, 145),
    Colour(213, 94, 0),
    Colour(86, 180, 233),
    Colour(24, 24, 24),
    Colour(0, 158, 115),
    Colour(150, 60, 140),
];

/// Returns the colour of the channel with this index; the colours repeat after six channels.
pub(super) fn trace(index: usize) -> Colour {
    TRACES[index % TRACES.len()]
}

/// Returns the colour of a channel; a faint channel is grey.
pub(super) fn channel(index: usize, channel: &Channel) -> Colour {
    if channel.faint { FAINT } else { trace(index) }
}

/// The share of the trace colour in the colour of its error band.
const BAND_SHARE: f64 = 0.3;

/// The share of the trace colour where the trace is wrong.
const WRONG_SHARE: f64 = 0.45;

/// Returns the pale colour of the error band of a trace.
pub(super) fn pale(colour: Colour) -> Colour {
    mixed_with_screen(colour, BAND_SHARE)
}

/// Returns the pale colour of a trace where it is wrong.
pub(super) fn wrong(colour: Colour) -> Colour {
    mixed_with_screen(colour, WRONG_SHARE)
}

/// Returns a share of a colour mixed with the background of the screen.
pub(super) fn mixed_with_screen(colour: Colour, share: f64) -> Colour {
    let mix = |full: u8, background: u8| {
        (f64::from(background) + share * (f64::from(full) - f64::from(background))) as u8
    };
    Colour(mix(colour.0, SCREEN.0), mix(colour.1, SCREEN.1), mix(colour.2, SCREEN.2))
}
