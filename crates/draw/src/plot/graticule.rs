use plotters::style::RGBColor;

use super::clip::Area;
use super::surface::Surface;
use super::{Axis, Picture, PlotError, palette};

/// Small marks on the centre lines per division.
const MARKS: usize = 5;

/// How far a small mark stands out on either side of the centre line.
const MARK: f64 = 3.5;

/// Marks closer than this would run together.
const LEAST_MARK_GAP: f64 = 4.0;

/// Half the thickness of every line of the graticule.
const HALF: f64 = 0.5;

/// Draws the empty screen.
pub(super) fn ground(screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    surface.rectangle((screen.left, screen.top), (screen.right, screen.bottom), palette::SCREEN)
}

/// Draws the division lines of the screen.
pub(super) fn draw(picture: &Picture, screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    for strong in [false, true] {
        let colour = if strong { palette::CENTRE } else { palette::GRID };
        for line in inner_lines(&picture.horizontal, strong) {
            upright(column(screen, line), (screen.top, screen.bottom), colour, surface)?;
        }
        for line in inner_lines(&picture.vertical, strong) {
            level(row(screen, line), (screen.left, screen.right), colour, surface)?;
        }
    }
    marks(picture, screen, surface)
}

/// Draws the edges of the screen.
pub(super) fn border(screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    for x in [screen.left, screen.right] {
        upright(x, (screen.top - HALF, screen.bottom + HALF), palette::BORDER, surface)?;
    }
    for y in [screen.top, screen.bottom] {
        level(y, (screen.left - HALF, screen.right + HALF), palette::BORDER, surface)?;
    }
    Ok(())
}

/// Where the division lines between the edges are, as parts of the screen: the
/// strong ones, in the centre, at zero and at decades, or the others.
fn inner_lines(axis: &Axis, strong: bool) -> Vec<f64> {
    if axis.logarithmic {
        return decade_lines(axis, strong);
    }
    let zero = axis.zero_line();
    let centre = centre_line(axis);
    let divisions = axis.divisions;
    (1..divisions)
        .filter(|line| (*line == centre || zero == Some(*line)) == strong)
        .map(|line| line as f64 / divisions as f64)
        .collect()
}

/// More decades than this leave no room for lines within them.
const MOST_DIVIDED: usize = 12;

/// The strong lines at the decades, or the others at 2 to 9 times them.
fn decade_lines(axis: &Axis, strong: bool) -> Vec<f64> {
    let times = match strong {
        true => 1..2,
        false if axis.divisions <= MOST_DIVIDED => 2..10,
        false => 0..0,
    };
    axis.multiples(times).map(|value| axis.fraction(value)).collect()
}

/// The division line in the centre, or next to it.
fn centre_line(axis: &Axis) -> usize {
    axis.divisions / 2
}

/// The small marks along both centre lines; on a screen of decades there are none.
fn marks(picture: &Picture, screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    if picture.horizontal.logarithmic || picture.vertical.logarithmic {
        return Ok(());
    }
    let centre = |axis: &Axis| centre_line(axis) as f64 / axis.divisions as f64;
    let x = column(screen, centre(&picture.horizontal));
    let y = row(screen, centre(&picture.vertical));
    for part in mark_parts(&picture.horizontal, screen.width()) {
        let ends = (y - MARK, y + MARK);
        upright(column(screen, part), ends, palette::CENTRE, surface)?;
    }
    for part in mark_parts(&picture.vertical, screen.height()) {
        let ends = (x - MARK, x + MARK);
        level(row(screen, part), ends, palette::CENTRE, surface)?;
    }
    Ok(())
}

fn mark_parts(axis: &Axis, length: f64) -> impl Iterator<Item = f64> {
    let count = axis.divisions * MARKS;
    let count = if length / count as f64 >= LEAST_MARK_GAP { count } else { 0 };
    (1..count).map(move |mark| mark as f64 / count as f64)
}

/// The middle of the pixel column at a part of the width.
fn column(screen: Area, part: f64) -> f64 {
    (screen.left + part * screen.width()).floor() + HALF
}

/// The middle of the pixel row at a part of the height, counted from below.
fn row(screen: Area, part: f64) -> f64 {
    (screen.bottom - part * screen.height()).floor() + HALF
}

fn upright(x: f64, ends: (f64, f64), colour: RGBColor, surface: &mut dyn Surface) -> Result<(), PlotError> {
    surface.rectangle((x - HALF, ends.0), (x + HALF, ends.1), colour)
}

fn level(y: f64, ends: (f64, f64), colour: RGBColor, surface: &mut dyn Surface) -> Result<(), PlotError> {
    surface.rectangle((ends.0, y - HALF), (ends.1, y + HALF), colour)
}
