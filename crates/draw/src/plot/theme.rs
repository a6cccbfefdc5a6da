//! The colours of line drawings in a light and a dark theme.

use super::colour::Colour;

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
const CORDS: [(Colour, Colour); 8] = [
    (Colour(200, 30, 45), Colour(240, 98, 98)),
    (Colour(20, 95, 190), Colour(96, 165, 250)),
    (Colour(225, 140, 0), Colour(250, 190, 70)),
    (Colour(20, 135, 80), Colour(74, 200, 130)),
    (Colour(130, 60, 160), Colour(195, 140, 240)),
    (Colour(60, 65, 72), Colour(200, 205, 212)),
    (Colour(0, 145, 160), Colour(60, 205, 215)),
    (Colour(150, 85, 40), Colour(215, 155, 110)),
];

impl Ink {
    /// The number of different colours of patch cords.
    pub const CORD_COLOURS: usize = CORDS.len();
}

impl Theme {
    /// Returns the colour of an ink.
    pub(super) fn colour(self, ink: Ink) -> Colour {
        let (light, dark) = match ink {
            Ink::Page => (Colour(255, 255, 255), Colour(20, 24, 30)),
            Ink::Body => (Colour(247, 244, 234), Colour(38, 45, 55)),
            Ink::Line => (Colour(24, 28, 34), Colour(232, 235, 239)),
            Ink::Wire => (Colour(44, 62, 84), Colour(168, 184, 202)),
            Ink::Soft => (Colour(92, 100, 110), Colour(150, 160, 172)),
            Ink::Faint => (Colour(205, 210, 217), Colour(62, 70, 82)),
            Ink::Signal => (Colour(11, 77, 162), Colour(120, 180, 255)),
            Ink::Voltage => (Colour(178, 50, 20), Colour(255, 170, 105)),
            Ink::Cord(number) => CORDS[number % CORDS.len()],
        };
        match self {
            Theme::Light => light,
            Theme::Dark => dark,
        }
    }
}
