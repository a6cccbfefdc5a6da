//! The interface of the drawing backends for SVG and PNG.

use super::PlotError;
use super::colour::Colour;

/// A surface that pictures and drawings are drawn on.
///
/// Positions and lengths are in picture units from the upper left corner; y points down. An ordinary
/// picture is 900 units wide.
pub(super) trait Surface {
    /// Fills a rectangle between its upper left and lower right corners.
    fn rectangle(&mut self, from: (f64, f64), to: (f64, f64), colour: Colour) -> Result<(), PlotError>;

    /// Draws a polyline with round joins and ends. If all points coincide, it is a disc with radius
    /// `width`.
    fn line(&mut self, points: &[(f64, f64)], width: f64, colour: Colour) -> Result<(), PlotError> {
        self.translucent_line(points, width, colour, 1.0)
    }

    /// Draws a polyline like [`line`](Surface::line), of which `opacity`, 0 to 1, covers what is below it.
    fn translucent_line(
        &mut self,
        points: &[(f64, f64)],
        width: f64,
        colour: Colour,
        opacity: f64,
    ) -> Result<(), PlotError>;

    /// Fills a polygon.
    fn area(&mut self, corners: &[(f64, f64)], colour: Colour) -> Result<(), PlotError>;

    /// Draws the outline of a circle.
    fn ring(&mut self, centre: (f64, f64), radius: f64, width: f64, colour: Colour) -> Result<(), PlotError>;

    /// Writes a line of text; `at` is a point on its baseline.
    fn text(&mut self, text: &str, at: (f64, f64), style: TextStyle) -> Result<(), PlotError>;
}

/// The size, colour and alignment of a line of text.
#[derive(Clone, Copy)]
pub(super) struct TextStyle {
    /// The em size in picture units.
    pub size: f64,
    /// The colour.
    pub colour: Colour,
    /// The part of the text that is at its position.
    pub align: Align,
}

/// The part of a line of text that is at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// The start of the text.
    Start,
    /// The middle of the text.
    Middle,
    /// The end of the text.
    End,
}

impl Align {
    /// Returns the distance from the start of a text of this width to its position.
    pub(super) fn shift(self, width: f64) -> f64 {
        match self {
            Align::Start => 0.0,
            Align::Middle => width / 2.0,
            Align::End => width,
        }
    }
}

/// Returns backend positions rounded to whole numbers; repeated neighbours are dropped.
pub(super) fn whole_points(points: &[(f64, f64)], scale: f64) -> Vec<(i32, i32)> {
    let mut whole: Vec<(i32, i32)> = points.iter().map(|at| whole_point(*at, scale)).collect();
    whole.dedup();
    whole
}

/// Returns the whole backend position nearest to a picture position.
pub(super) fn whole_point(at: (f64, f64), scale: f64) -> (i32, i32) {
    ((at.0 * scale).round() as i32, (at.1 * scale).round() as i32)
}

/// Converts an error of the drawing library.
pub(super) fn drawing_error(error: impl std::fmt::Display) -> PlotError {
    PlotError::Drawing(error.to_string())
}
