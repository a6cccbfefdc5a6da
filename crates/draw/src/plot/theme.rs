//! The colours of line drawings in a light and a dark theme.

use plotters::style::RGBColor;

/// The colour theme of a line drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Theme {
    /// Dark lines on a white page.
    #[default]
    Light,
    /// Light lines on a dark page.
    Dark,
}

/// The role of a primitive in a drawing; the theme assigns a colour to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Ink {
    /// The background of the page.
    Page,
    /// The inside of symbols and fields.
    Body,
    /// Edges and names of symbols.
    Line,
    /// Connections of a schematic.
    Wire,
    /// Secondary text and frames.
    Soft,
    /// Rules, and the lines of a patch panel.
    Faint,
    /// Names of signals.
    Signal,
    /// Voltages.
    Voltage,
    /// A cord of a patch panel, by its number; the colours repeat after [`Ink::CORD_COLOURS`].
    Cord(usize),
}

/// The colours of patch cords, for the light and the dark theme.
const CORDS: [(RGBColor, RGBColor); 8] = [
    (RGBColor(200, 30, 45), RGBColor(240, 98, 98)),
    (RGBColor(20, 95, 190), RGBColor(96, 165, 250)),
    (RGBColor(225, 140, 0), RGBColor(250, 190, 70)),
    (RGBColor(20, 135, 80), RGBColor(74, 200, 130)),
    (RGBColor(130, 60, 160), RGBColor(195, 140, 240)),
    (RGBColor(60, 65, 72), RGBColor(200, 205, 212)),
    (RGBColor(0, 145, 160), RGBColor(60, 205, 215)),
    (RGBColor(150, 85, 40), RGBColor(215, 155, 110)),
];

impl Ink {
    /// The number of different colours of patch cords.
    pub const CORD_COLOURS: usize = CORDS.len();
}

impl Theme {
    /// Returns the colour of an ink.
    pub(super) fn colour(self, ink: Ink) -> RGBColor {
        let (light, dark) = match ink {
            Ink::Page => (RGBColor(255, 255, 255), RGBColor(20, 24, 30)),
            Ink::Body => (RGBColor(247, 244, 234), RGBColor(38, 45, 55)),
            Ink::Line => (RGBColor(24, 28, 34), RGBColor(232, 235, 239)),
            Ink::Wire => (RGBColor(44, 62, 84), RGBColor(168, 184, 202)),
            Ink::Soft => (RGBColor(92, 100, 110), RGBColor(150, 160, 172)),
            Ink::Faint => (RGBColor(205, 210, 217), RGBColor(62, 70, 82)),
            Ink::Signal => (RGBColor(11, 77, 162), RGBColor(120, 180, 255)),
            Ink::Voltage => (RGBColor(178, 50, 20), RGBColor(255, 170, 105)),
            Ink::Cord(number) => CORDS[number % CORDS.len()],
        };
        match self {
            Theme::Light => light,
            Theme::Dark => dark,
        }
    }
}
