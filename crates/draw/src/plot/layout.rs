use super::clip::Area;
use super::font::Font;
use super::{Axis, Picture, Size, ticks};

/// Space kept free around everything.
pub(super) const MARGIN: f64 = 16.0;

/// Em size of the numbers at the division lines.
pub(super) const TICK_TEXT: f64 = 13.0;

/// Em size of the axis titles and the legend.
pub(super) const LABEL_TEXT: f64 = 14.0;

/// Gap between the screen and the numbers beside it.
pub(super) const TICK_GAP: f64 = 8.0;

/// Height of the numbers and the title under the screen.
const FOOT: f64 = 54.0;

/// The smallest picture in which texts have their full size, in pixels.
const FULL_SIZE: (f64, f64) = (900.0, 400.0);

/// By how much pictures of other sizes change the size of texts, in pixels per
/// picture unit.
const UNITS: (f64, f64) = (0.6, 4.0);

/// The most of the width that the numbers at one side may take.
const MOST_GUTTER: f64 = 0.3;

/// What the pictures of a sheet have in common, so that their screens line up.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Frame {
    /// Pixels per picture unit.
    pub unit: f64,
    /// Size of each picture in picture units.
    pub width: f64,
    pub height: f64,
    left_gutter: f64,
    right_gutter: f64,
}

impl Frame {
    pub(super) fn around(pictures: &[Picture], size: Size, font: &Font) -> Frame {
        let (width, height) = (f64::from(size.width), f64::from(size.height));
        let unit = (width / FULL_SIZE.0).min(height / FULL_SIZE.1);
        let unit = unit.clamp(UNITS.0, UNITS.1);
        let widest = |gutter: fn(&Picture, &Font) -> f64| {
            let gutters = pictures.iter().map(|picture| gutter(picture, font));
            let most = width / unit * MOST_GUTTER;
            gutters.fold(0.0, f64::max).clamp(0.0, most).round()
        };
        Frame {
            unit,
            width: width / unit,
            height: height / unit,
            left_gutter: widest(left_gutter),
            right_gutter: widest(right_gutter),
        }
    }

    /// The screen of a picture whose head ends at `top`. Its edges are in the
    /// middle of pixels, so that its border is sharp.
    pub(super) fn screen(&self, top: f64) -> Area {
        Area {
            left: self.left_gutter + 0.5,
            top: top.floor() + 0.5,
            right: (self.width - self.right_gutter).floor() - 0.5,
            bottom: (self.height - FOOT).floor() - 0.5,
        }
    }

    /// How wide a line of text over the whole picture may be.
    pub(super) fn text_room(&self) -> f64 {
        self.width - 2.0 * MARGIN
    }
}

fn left_gutter(picture: &Picture, font: &Font) -> f64 {
    let numbers = MARGIN + widest_number(&picture.vertical, font) + TICK_GAP;
    numbers.max(half_number(&picture.horizontal, font))
}

fn right_gutter(picture: &Picture, font: &Font) -> f64 {
    let numbers = picture.vertical_right.as_ref().map_or(0.0, |axis| widest_number(axis, font) + TICK_GAP);
    (MARGIN + numbers).max(half_number(&picture.horizontal, font))
}

/// Room for the half of a number that stands out under a corner of the screen.
fn half_number(axis: &Axis, font: &Font) -> f64 {
    MARGIN / 2.0 + widest_number(axis, font) / 2.0
}

fn widest_number(axis: &Axis, font: &Font) -> f64 {
    ticks::every(axis, 1).iter().map(|tick| font.width(&tick.text, TICK_TEXT)).fold(0.0, f64::max)
}
