//! The colours of scope pictures.

use plotters::style::RGBColor;

use super::Channel;

/// The background of the picture.
pub(super) const PAGE: RGBColor = RGBColor(255, 255, 255);
/// The background of the screen.
pub(super) const SCREEN: RGBColor = RGBColor(250, 251, 252);
/// Ordinary division lines.
pub(super) const GRID: RGBColor = RGBColor(219, 224, 230);
/// The lines at zero and the decades.
pub(super) const ZERO: RGBColor = RGBColor(160, 169, 180);
/// The edges of the screen.
pub(super) const BORDER: RGBColor = RGBColor(74, 85, 96);
/// Titles, numbers and names.
pub(super) const TEXT: RGBColor = RGBColor(28, 32, 38);
/// The note under the title, and labels of markers.
pub(super) const NOTE: RGBColor = RGBColor(90, 98, 108);
/// The warning under the title.
pub(super) const WARNING: RGBColor = RGBColor(176, 32, 24);
/// Highlighted spans of the horizontal axis.
pub(super) const SPAN: RGBColor = RGBColor(236, 238, 241);
/// Faint channels.
const FAINT: RGBColor = RGBColor(176, 183, 192);
/// The dashed lines of markers.
pub(super) const MARKER: RGBColor = RGBColor(132, 140, 152);

/// The colours of the traces in order. Neighbours differ in hue for colour-blind readers and in
/// lightness in a grey print.
const TRACES: [RGBColor; 6] = [
    RGBColor(11, 61, 145),
    RGBColor(213, 94, 0),
    RGBColor(86, 180, 233),
    RGBColor(24, 24, 24),
    RGBColor(0, 158, 115),
    RGBColor(150, 60, 140),
];

/// Returns the colour of the channel with this index; the colours repeat after six channels.
pub(super) fn trace(index: usize) -> RGBColor {
    TRACES[index % TRACES.len()]
}

/// Returns the colour of a channel; a faint channel is grey.
pub(super) fn channel(index: usize, channel: &Channel) -> RGBColor {
    if channel.faint { FAINT } else { trace(index) }
}

/// The share of the trace colour in the colour of its error band.
const BAND_SHARE: f64 = 0.3;

/// The share of the trace colour where the trace is wrong.
const WRONG_SHARE: f64 = 0.45;

/// Returns the pale colour of the error band of a trace.
pub(super) fn pale(colour: RGBColor) -> RGBColor {
    mixed_with_screen(colour, BAND_SHARE)
}

/// Returns the pale colour of a trace where it is wrong.
pub(super) fn wrong(colour: RGBColor) -> RGBColor {
    mixed_with_screen(colour, WRONG_SHARE)
}

/// Returns a share of a colour mixed with the background of the screen.
fn mixed_with_screen(colour: RGBColor, share: f64) -> RGBColor {
    let mix = |full: u8, background: u8| {
        (f64::from(background) + share * (f64::from(full) - f64::from(background))) as u8
    };
    RGBColor(mix(colour.0, SCREEN.0), mix(colour.1, SCREEN.1), mix(colour.2, SCREEN.2))
}
