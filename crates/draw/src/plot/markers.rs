//! The dashed vertical lines at events, and their labels.

use super::clip::Area;
use super::font::Font;
use super::surface::{Align, Surface, TextStyle};
use super::{Picture, PlotError, palette};

/// The em size of the labels.
const TEXT_SIZE: f64 = 11.5;

/// The distance from a line to its label.
const LABEL_OFFSET: f64 = 4.0;
/// The distance from the upper edge of a row to the baseline of its labels.
const BASELINE: f64 = 14.0;
/// The minimum gap between labels in a row.
const LABEL_GAP: f64 = 6.0;

/// The length of a dash.
const DASH: f64 = 5.0;
/// The gap between dashes.
const DASH_GAP: f64 = 4.0;

/// Half the thickness of a line.
const HALF_WIDTH: f64 = 0.5;

/// The number of rows of labels. A label is in the first row in which it fits.
const ROWS: usize = 2;
/// The height of a row of labels.
const ROW_HEIGHT: f64 = 14.0;

/// The minimum distance of lines; of closer lines only the first is drawn.
const MIN_LINE_GAP: f64 = 2.0;

/// Draws the dashed lines and the labels that fit, and returns the areas of these labels.
pub(super) fn draw(
    picture: &Picture,
    screen: Area,
    font: &Font,
    surface: &mut dyn Surface,
) -> Result<Vec<Area>, PlotError> {
    let fractions = picture.markers.iter().map(|marker| picture.horizontal.fraction(marker.at));
    let mut markers: Vec<_> =
        fractions.zip(&picture.markers).filter(|(fraction, _)| (0.0..=1.0).contains(fraction)).collect();
    markers.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut labels: Vec<Area> = Vec::new();
    let mut free_from = [screen.left; ROWS];
    let mut next_line_from = screen.left;
    for (fraction, marker) in markers {
        let x = (screen.left + fraction * screen.width()).floor() + HALF_WIDTH;
        if x >= next_line_from {
            draw_dashes(x, screen, surface)?;
            next_line_from = x + MIN_LINE_GAP;
        }
        let label = font.truncated(&marker.label, TEXT_SIZE, screen.width());
        let (from, to) = label_extent(x, font.width(&label, TEXT_SIZE), screen);
        let row = free_from.iter().position(|free_from| from >= *free_from);
        if let Some(row) = row {
            let style = TextStyle { size: TEXT_SIZE, colour: palette::NOTE, align: Align::Start };
            let top = screen.top + ROW_HEIGHT * row as f64;
            surface.text(&label, (from, top + BASELINE), style)?;
            labels.push(Area { left: from, top, right: to, bottom: top + BASELINE });
            free_from[row] = to + LABEL_GAP;
        }
    }
    Ok(labels)
}

/// Returns the left and right end of a label of this width: right of its line, or left of it near the right edge.
fn label_extent(x: f64, width: f64, screen: Area) -> (f64, f64) {
    let right = x + LABEL_OFFSET;
    let from = if right + width <= screen.right { right } else { x - LABEL_OFFSET - width };
    (from, from + width)
}

/// Draws a dashed vertical line at `x` from the upper to the lower edge of the screen.
fn draw_dashes(x: f64, screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    let mut top = screen.top;
    while top < screen.bottom {
        let bottom = (top + DASH).min(screen.bottom);
        surface.rectangle((x - HALF_WIDTH, top), (x + HALF_WIDTH, bottom), palette::MARKER)?;
        top = bottom + DASH_GAP;
    }
    Ok(())
}
