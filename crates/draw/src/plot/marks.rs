use super::clip::Area;
use super::font::Font;
use super::surface::{Align, Lettering, Surface};
use super::{Picture, PlotError, palette};

/// Em size of the labels.
const TEXT: f64 = 11.5;

/// Distances of a label from its line and from the upper edge of the screen, and between labels.
const BESIDE: f64 = 4.0;
const BELOW_EDGE: f64 = 14.0;
const BETWEEN: f64 = 6.0;

/// Lengths of the dashes of a line and of the gaps between them.
const DASH: f64 = 5.0;
const GAP: f64 = 4.0;

/// Half the thickness of a line.
const HALF: f64 = 0.5;

/// Labels stand in so many rows, the next where there is no room in those above, each so far below the one above.
const ROWS: usize = 2;
const ROW: f64 = 14.0;

/// Lines nearer to each other than this are drawn as one.
const NEAREST: f64 = 2.0;

/// Draws dashed upright lines, and their labels as far as there is room for them. Gives back where these stand.
pub(super) fn draw(
    picture: &Picture,
    screen: Area,
    font: &Font,
    surface: &mut dyn Surface,
) -> Result<Vec<Area>, PlotError> {
    let places = picture.marks.iter().map(|mark| picture.horizontal.fraction(mark.at));
    let mut marks: Vec<_> =
        places.zip(&picture.marks).filter(|(part, _)| (0.0..=1.0).contains(part)).collect();
    marks.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut texts: Vec<Area> = Vec::new();
    let mut free = [screen.left; ROWS];
    let mut line_free = screen.left;
    for (part, mark) in marks {
        let x = (screen.left + part * screen.width()).floor() + HALF;
        if x >= line_free {
            dashes(x, screen, surface)?;
            line_free = x + NEAREST;
        }
        let label = font.shortened(&mark.label, TEXT, screen.width());
        let (from, to) = (x + BESIDE, x + BESIDE + font.width(&label, TEXT));
        let row = free.iter().position(|free| from >= *free).filter(|_| to <= screen.right);
        if let Some(row) = row {
            let lettering = Lettering { size: TEXT, colour: palette::NOTE, align: Align::Start };
            let top = screen.top + ROW * row as f64;
            surface.text(&label, (from, top + BELOW_EDGE), lettering)?;
            texts.push(Area { left: from, top, right: to, bottom: top + BELOW_EDGE });
            free[row] = to + BETWEEN;
        }
    }
    Ok(texts)
}

fn dashes(x: f64, screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    let mut top = screen.top;
    while top < screen.bottom {
        let bottom = (top + DASH).min(screen.bottom);
        surface.rectangle((x - HALF, top), (x + HALF, bottom), palette::MARK)?;
        top = bottom + GAP;
    }
    Ok(())
}
