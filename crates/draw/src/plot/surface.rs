use plotters::style::RGBColor;

use super::PlotError;

/// What can be drawn on. Positions and sizes are in picture units, of which an
/// ordinary picture is 900 wide, counted from its upper left corner.
pub(super) trait Surface {
    /// Fills a rectangle between its upper left and lower right corners.
    fn rectangle(&mut self, from: (f64, f64), to: (f64, f64), colour: RGBColor) -> Result<(), PlotError>;

    /// Draws a line with round joins and ends; points in one place make a dot.
    fn line(&mut self, points: &[(f64, f64)], width: f64, colour: RGBColor) -> Result<(), PlotError>;

    /// Fills the area within corners.
    fn area(&mut self, corners: &[(f64, f64)], colour: RGBColor) -> Result<(), PlotError>;

    /// Draws the edge of a circle.
    fn ring(
        &mut self,
        centre: (f64, f64),
        radius: f64,
        width: f64,
        colour: RGBColor,
    ) -> Result<(), PlotError>;

    /// Writes a line of text; `at` is on its baseline.
    fn text(&mut self, text: &str, at: (f64, f64), lettering: Lettering) -> Result<(), PlotError>;
}

/// How a line of text is written.
#[derive(Clone, Copy)]
pub(super) struct Lettering {
    /// The em size in picture units.
    pub size: f64,
    pub colour: RGBColor,
    pub align: Align,
}

/// Which part of a line of text is at the position given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

impl Align {
    /// How far before the position a text begins.
    pub(super) fn shift(self, width: f64) -> f64 {
        match self {
            Align::Start => 0.0,
            Align::Middle => width / 2.0,
            Align::End => width,
        }
    }
}

/// Whole backend positions, neighbours in the same place told once.
pub(super) fn whole_points(points: &[(f64, f64)], scale: f64) -> Vec<(i32, i32)> {
    let mut whole: Vec<(i32, i32)> = points.iter().map(|at| whole_point(*at, scale)).collect();
    whole.dedup();
    whole
}

/// The backend position nearest to a picture position.
pub(super) fn whole_point(at: (f64, f64), scale: f64) -> (i32, i32) {
    ((at.0 * scale).round() as i32, (at.1 * scale).round() as i32)
}

/// A failure of the drawing library in this module's own terms.
pub(super) fn drawing_error(error: impl std::fmt::Display) -> PlotError {
    PlotError::Drawing(error.to_string())
}
