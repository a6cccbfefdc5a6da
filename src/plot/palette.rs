use plotters::style::RGBColor;

pub(super) const PAGE: RGBColor = RGBColor(255, 255, 255);
pub(super) const SCREEN: RGBColor = RGBColor(250, 251, 252);
pub(super) const GRID: RGBColor = RGBColor(219, 224, 230);
pub(super) const CENTRE: RGBColor = RGBColor(160, 169, 180);
pub(super) const BORDER: RGBColor = RGBColor(74, 85, 96);
pub(super) const TEXT: RGBColor = RGBColor(28, 32, 38);
pub(super) const NOTE: RGBColor = RGBColor(90, 98, 108);
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
