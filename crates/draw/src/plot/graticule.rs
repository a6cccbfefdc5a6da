//! The screen: background, division lines, small marks and border.

use super::clip::Area;
use super::colour::Colour;
use super::surface::Surface;
use super::{Axis, Picture, PlotError, palette};

/// The number of small marks per division along the middle of the screen.
const MARKS_PER_DIVISION: usize = 5;

/// The length of a small mark on each side of the middle line.
const HALF_MARK: f64 = 3.5;

/// The minimum distance of small marks; closer marks would merge, so none are drawn.
const MIN_MARK_GAP: f64 = 4.0;

/// Half the thickness of every line of the graticule.
const HALF_WIDTH: f64 = 0.5;

/// Draws the empty screen.
pub(super) fn background(screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    surface.rectangle((screen.left, screen.top), (screen.right, screen.bottom), palette::SCREEN)
}

/// Draws the division lines of the screen, and stronger lines at zero and at decades.
///
/// The lines in the middle are ordinary division lines. A stronger line there would look like an axis through zero.
pub(super) fn draw(picture: &Picture, screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    lines(picture, screen, false, surface)?;
    marks(picture, screen, surface)?;
    lines(picture, screen, true, surface)
}

/// Draws the strong lines, or the others.
fn lines(picture: &Picture, screen: Area, strong: bool, surface: &mut dyn Surface) -> Result<(), PlotError> {
    let colour = if strong { palette::ZERO } else { palette::GRID };
    for line in inner_lines(&picture.horizontal, strong) {
        vertical_line(column(screen, line), (screen.top, screen.bottom), colour, surface)?;
    }
    for line in inner_lines(&picture.vertical, strong) {
        horizontal_line(row(screen, line), (screen.left, screen.right), colour, surface)?;
    }
    Ok(())
}

/// Returns the lines at the zeros of the axes, from edge to edge of the screen.
pub(super) fn zero_lines(picture: &Picture, screen: Area) -> Vec<Vec<(f64, f64)>> {
    let vertical = picture.horizontal.zero_fraction().map(|fraction| {
        let x = column(screen, fraction);
        vec![(x, screen.top), (x, screen.bottom)]
    });
    let horizontal = picture.vertical.zero_fraction().map(|fraction| {
        let y = row(screen, fraction);
        vec![(screen.left, y), (screen.right, y)]
    });
    vertical.into_iter().chain(horizontal).collect()
}

/// Draws the edges of the screen.
pub(super) fn border(screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    for x in [screen.left, screen.right] {
        vertical_line(x, (screen.top - HALF_WIDTH, screen.bottom + HALF_WIDTH), palette::BORDER, surface)?;
    }
    for y in [screen.top, screen.bottom] {
        horizontal_line(y, (screen.left - HALF_WIDTH, screen.right + HALF_WIDTH), palette::BORDER, surface)?;
    }
    Ok(())
}

/// Returns the division lines between the edges, as fractions of the axis.
///
/// The strong lines are those at zero and at decades. Depending on `strong`, these or the other lines are
/// returned. Zero has a line also if it is between two division lines.
fn inner_lines(axis: &Axis, strong: bool) -> Vec<f64> {
    if axis.logarithmic {
        return decade_lines(axis, strong);
    }
    let zero = axis.zero_fraction();
    if strong {
        return zero.into_iter().collect();
    }
    let lines = (1..axis.divisions).map(|line| line as f64 / axis.divisions as f64);
    lines.filter(|line| zero != Some(*line)).collect()
}

/// The maximum number of decades with lines at 2 to 9 times the powers of ten; with more decades the
/// lines would merge.
const MAX_SUBDIVIDED_DECADES: usize = 12;

/// Returns the strong lines at the powers of ten, or the others at 2 to 9 times them.
fn decade_lines(axis: &Axis, strong: bool) -> Vec<f64> {
    let factors = match strong {
        true => 1..2,
        false if axis.divisions <= MAX_SUBDIVIDED_DECADES => 2..10,
        false => 0..0,
    };
    axis.multiples(factors).map(|value| axis.fraction(value)).collect()
}

/// Returns the division line in the centre; for an odd number, the one just below it.
fn centre_line(axis: &Axis) -> usize {
    axis.divisions / 2
}

/// Draws the small marks along both middle lines, in the colour of these lines; a logarithmic screen has none.
fn marks(picture: &Picture, screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    if picture.horizontal.logarithmic || picture.vertical.logarithmic {
        return Ok(());
    }
    let centre = |axis: &Axis| centre_line(axis) as f64 / axis.divisions as f64;
    let x = column(screen, centre(&picture.horizontal));
    let y = row(screen, centre(&picture.vertical));
    for fraction in mark_fractions(&picture.horizontal, screen.width()) {
        let ends = (y - HALF_MARK, y + HALF_MARK);
        vertical_line(column(screen, fraction), ends, palette::GRID, surface)?;
    }
    for fraction in mark_fractions(&picture.vertical, screen.height()) {
        let ends = (x - HALF_MARK, x + HALF_MARK);
        horizontal_line(row(screen, fraction), ends, palette::GRID, surface)?;
    }
    Ok(())
}

/// Returns the positions of the small marks along an axis, as fractions; none if they would be too close.
fn mark_fractions(axis: &Axis, length: f64) -> impl Iterator<Item = f64> {
    let count = axis.divisions * MARKS_PER_DIVISION;
    let count = if length / count as f64 >= MIN_MARK_GAP { count } else { 0 };
    (1..count).map(move |mark| mark as f64 / count as f64)
}

/// Returns the middle of the pixel column at a fraction of the width.
fn column(screen: Area, fraction: f64) -> f64 {
    (screen.left + fraction * screen.width()).floor() + HALF_WIDTH
}

/// Returns the middle of the pixel row at a fraction of the height, counted from the lower edge.
fn row(screen: Area, fraction: f64) -> f64 {
    (screen.bottom - fraction * screen.height()).floor() + HALF_WIDTH
}

/// Draws a line one unit wide at `x`, between two heights.
fn vertical_line(
    x: f64,
    ends: (f64, f64),
    colour: Colour,
    surface: &mut dyn Surface,
) -> Result<(), PlotError> {
    surface.rectangle((x - HALF_WIDTH, ends.0), (x + HALF_WIDTH, ends.1), colour)
}

/// Draws a line one unit high at `y`, between two positions.
fn horizontal_line(
    y: f64,
    ends: (f64, f64),
    colour: Colour,
    surface: &mut dyn Surface,
) -> Result<(), PlotError> {
    surface.rectangle((ends.0, y - HALF_WIDTH), (ends.1, y + HALF_WIDTH), colour)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_line_at_zero_is_strong() {
        let axis = |low: f64, high: f64| Axis::fit_tight("x", "", [low, high], 10);
        assert_eq!(inner_lines(&axis(-10.0, 30.0), true), [0.25]);
        assert_eq!(inner_lines(&axis(-10.0, 30.0), false).len(), 6);
        // The line in the middle of 0 to 10 is an ordinary one.
        assert!(inner_lines(&axis(0.0, 10.0), true).is_empty());
        assert!(inner_lines(&axis(0.0, 10.0), false).contains(&0.5));
    }
}
