use plotters::style::RGBColor;

use super::Channel;

pub(super) const PAGE: RGBColor = RGBColor(255, 255, 255);
pub(super) const SCREEN: RGBColor = RGBColor(250, 251, 252);
pub(super) const GRID: RGBColor = RGBColor(219, 224, 230);
pub(super) const CENTRE: RGBColor = RGBColor(160, 169, 180);
pub(super) const BORDER: RGBColor = RGBColor(74, 85, 96);
pub(super) const TEXT: RGBColor = RGBColor(28, 32, 38);
pub(super) const NOTE: RGBColor = RGBColor(90, 98, 108);
pub(super) const SPAN: RGBColor = RGBColor(236, 238, 241);
const FAINT: RGBColor = RGBColor(176, 183, 192);
pub(super) const MARK: RGBColor = RGBColor(132, 140, 152);

/// Neighbours differ in hue to colour-blind eyes and in lightness on grey paper.
const TRACES: [RGBColor; 6] = [
    RGBColor(11, 61, 145),
    RGBColor(213, 94, 0),
    RGBColor(86, 180, 233),
    RGBColor(24, 24, 24),
    RGBColor(0, 158, 115),
    RGBColor(150, 60, 140),
];

/// The colour of a channel by its place among the channels.
pub(super) fn trace(index: usize) -> RGBColor {
    TRACES[index % TRACES.len()]
}

/// The colour in which a channel is drawn.
pub(super) fn channel(index: usize, channel: &Channel) -> RGBColor {
    if channel.faint { FAINT } else { trace(index) }
}

/// How much of a colour is left in what stands behind it.
const PALE: f64 = 0.3;

/// The colour of what belongs to a trace and stands behind it.
pub(super) fn pale(colour: RGBColor) -> RGBColor {
    let mixed = |own: u8, ground: u8| (f64::from(ground) + PALE * (f64::from(own) - f64::from(ground))) as u8;
    RGBColor(mixed(colour.0, SCREEN.0), mixed(colour.1, SCREEN.1), mixed(colour.2, SCREEN.2))
}
