//! The layout that all pictures of a sheet share.

use super::clip::Area;
use super::{Axis, Picture, Size, font, ticks};

/// The margin around the picture.
pub(super) const MARGIN: f64 = 16.0;

/// The em size of the numbers at the division lines.
pub(super) const TICK_TEXT: f64 = 13.0;

/// The em size of the axis titles and the legend.
pub(super) const LABEL_TEXT: f64 = 14.0;

/// The gap between the screen and the numbers to its left and right.
pub(super) const TICK_GAP: f64 = 8.0;

/// The height of the numbers and the title under the screen.
const FOOT_HEIGHT: f64 = 54.0;

/// The smallest picture, in pixels, in which one picture unit is one pixel.
const NOMINAL_SIZE: (f64, f64) = (900.0, 400.0);

/// The minimum and maximum of pixels per picture unit. They limit the size of texts in very small and
/// very large pictures.
const UNIT_RANGE: (f64, f64) = (0.6, 4.0);

/// The maximum share of the width for the numbers at one side.
const MAX_GUTTER: f64 = 0.3;

/// The dimensions that the pictures of a sheet share, so that their screens are aligned.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Frame {
    /// Pixels per picture unit.
    pub unit: f64,
    /// The width of each picture in picture units.
    pub width: f64,
    /// The height of each picture in picture units.
    pub height: f64,
    /// The width to the left of the screen.
    left_gutter: f64,
    /// The width to the right of the screen.
    right_gutter: f64,
}

impl Frame {
    /// Returns the frame for pictures of a size; the widest numbers of all pictures set the gutters.
    pub(super) fn for_pictures(pictures: &[Picture], size: Size) -> Frame {
        let (width, height) = (f64::from(size.width), f64::from(size.height));
        let unit = (width / NOMINAL_SIZE.0).min(height / NOMINAL_SIZE.1);
        let unit = unit.clamp(UNIT_RANGE.0, UNIT_RANGE.1);
        let widest = |gutter: fn(&Picture) -> f64| {
            let gutters = pictures.iter().map(gutter);
            let max = width / unit * MAX_GUTTER;
            gutters.fold(0.0, f64::max).clamp(0.0, max).round()
        };
        Frame {
            unit,
            width: width / unit,
            height: height / unit,
            left_gutter: widest(left_gutter),
            right_gutter: widest(right_gutter),
        }
    }

    /// Returns the screen of a picture whose header ends at `top`.
    ///
    /// Its edges are in the middle of pixels, so that the border is sharp.
    pub(super) fn screen(&self, picture: &Picture, top: f64) -> Area {
        let whole = Area {
            left: self.left_gutter + 0.5,
            top: top.floor() + 0.5,
            right: (self.width - self.right_gutter).floor() - 0.5,
            bottom: (self.height - FOOT_HEIGHT).floor() - 0.5,
        };
        if picture.equal_scales { equally_scaled(picture, whole) } else { whole }
    }

    /// Returns the frame with more pixels per picture unit by a factor.
    pub(super) fn magnified(&self, factor: f64) -> Frame {
        Frame { unit: self.unit * factor, ..self.clone() }
    }

    /// Returns the maximum width of a line of text above the screen.
    pub(super) fn max_text_width(&self) -> f64 {
        self.width - 2.0 * MARGIN
    }
}

/// Returns the upper left part of a screen in which one unit has the same length along both axes.
///
/// The lengths of its edges are rounded to whole picture units. A logarithmic axis has no length of a unit, so the
/// whole screen is returned.
fn equally_scaled(picture: &Picture, whole: Area) -> Area {
    let axes = [&picture.horizontal, &picture.vertical];
    let [across, up] = axes.map(|axis| (axis.high - axis.low).abs());
    let unit_length = (whole.width() / across).min(whole.height() / up);
    let is_linear = axes.iter().all(|axis| !axis.logarithmic);
    if is_linear && unit_length > 0.0 && unit_length.is_finite() {
        let (width, height) = ((across * unit_length).round(), (up * unit_length).round());
        Area { right: whole.left + width, bottom: whole.top + height, ..whole }
    } else {
        whole
    }
}

/// Returns the width to the left of the screen, for the numbers of the left axis.
fn left_gutter(picture: &Picture) -> f64 {
    let numbers = MARGIN + widest_number(&picture.vertical) + TICK_GAP;
    numbers.max(half_number(&picture.horizontal))
}

/// Returns the width to the right of the screen, for the numbers of the right axis if there is one.
fn right_gutter(picture: &Picture) -> f64 {
    let numbers = picture.vertical_right.as_ref().map_or(0.0, |axis| widest_number(axis) + TICK_GAP);
    (MARGIN + numbers).max(half_number(&picture.horizontal))
}

/// Returns the width for the half of a number that extends beyond a corner of the screen.
fn half_number(axis: &Axis) -> f64 {
    MARGIN / 2.0 + widest_number(axis) / 2.0
}

/// Returns the width of the widest number of an axis.
fn widest_number(axis: &Axis) -> f64 {
    ticks::with_stride(axis, 1).iter().map(|tick| font::width(&tick.text, TICK_TEXT)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_scales_give_one_length_of_a_unit() {
        let axis = |low: f64, high: f64| Axis::fit_tight("x", "mm", [low, high], 10);
        let whole = Area { left: 50.5, top: 80.5, right: 850.5, bottom: 480.5 };
        let screen = |horizontal: Axis| equally_scaled(&Picture::new("", horizontal, axis(0.0, 40.0)), whole);
        let narrow = screen(axis(0.0, 20.0));
        assert_eq!((narrow.width(), narrow.height()), (200.0, 400.0));
        let wide = screen(axis(0.0, 100.0));
        assert_eq!((wide.width(), wide.height()), (800.0, 320.0));
        assert_eq!((wide.left, wide.top), (whole.left, whole.top));
        assert_eq!(screen(Axis::logarithmic("f", "Hz", 1.0, 10.0)), whole);
    }
}
