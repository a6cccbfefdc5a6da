//! The numbers and titles around the screen.

use super::clip::Area;
use super::colour::Colour;
use super::layout::{Frame, LABEL_TEXT, MARGIN, TICK_GAP, TICK_TEXT};
use super::surface::{Align, Surface, TextStyle};
use super::{Axis, Picture, PlotError, font, palette, ticks};

/// The distance from the middle of a digit down to its baseline.
const HALF_DIGIT: f64 = 0.36 * TICK_TEXT;

/// The distance from the screen down to the baseline of the numbers.
const NUMBERS_BELOW: f64 = 20.0;
/// The distance from the screen down to the baseline of the horizontal title.
const TITLE_BELOW: f64 = 42.0;

/// The distance from the screen up to the baselines of the vertical titles.
const TITLES_ABOVE: f64 = 13.0;

/// The minimum gap between neighbouring numbers.
const NUMBER_GAP: f64 = 14.0;

/// The length of the marks of the right axis. They are drawn if its divisions differ from those of
/// the graticule.
const MARK_LENGTH: f64 = 5.0;

/// Draws the numbers and titles around the screen.
pub(super) fn draw(
    picture: &Picture,
    frame: &Frame,
    screen: Area,
    surface: &mut dyn Surface,
) -> Result<(), PlotError> {
    let mut scales = Scales { frame, screen, surface };
    let (left, right) = colours(picture);
    scales.horizontal_scale(&picture.horizontal)?;
    scales.vertical_scale(&picture.vertical, Side::Left, left)?;
    scales.vertical_title(picture, &picture.vertical, Side::Left, left)?;
    if let Some(axis) = &picture.vertical_right {
        scales.vertical_scale(axis, Side::Right, right)?;
        scales.vertical_title(picture, axis, Side::Right, right)?;
        if axis.divisions != picture.vertical.divisions {
            scales.right_marks(axis)?;
        }
    }
    Ok(())
}

/// Returns the colours of the left and the right scale.
///
/// If there is a right axis, each scale has the colour of its first channel.
fn colours(picture: &Picture) -> (Colour, Colour) {
    let colour = |right: bool| {
        let first = picture.channels.iter().position(|channel| channel.right == right);
        match first {
            Some(index) if picture.vertical_right.is_some() => palette::trace(index),
            _ => palette::TEXT,
        }
    };
    (colour(false), colour(true))
}

/// The side of the screen on which a vertical scale is.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    /// The side of [`Picture::vertical`].
    Left,
    /// The side of [`Picture::vertical_right`].
    Right,
}

/// Writes the scales of one picture.
struct Scales<'a> {
    /// The size of the picture and of its margins.
    frame: &'a Frame,
    /// The screen in picture units.
    screen: Area,
    /// The surface that is drawn on.
    surface: &'a mut dyn Surface,
}

impl Scales<'_> {
    /// Writes the numbers and the title below the screen.
    fn horizontal_scale(&mut self, axis: &Axis) -> Result<(), PlotError> {
        let screen = self.screen;
        let extent = |text: &str| font::width(text, TICK_TEXT) + NUMBER_GAP;
        for tick in ticks::fit(axis, screen.width(), extent) {
            let x = screen.left + tick.fraction * screen.width();
            let at = (x, screen.bottom + NUMBERS_BELOW);
            self.write(&tick.text, at, TICK_TEXT, palette::TEXT, Align::Middle)?;
        }
        let title = self.title(axis, screen.width());
        let middle = (screen.left + screen.right) / 2.0;
        let at = (middle, screen.bottom + TITLE_BELOW);
        self.write(&title, at, LABEL_TEXT, palette::TEXT, Align::Middle)
    }

    /// Writes the numbers at one side of the screen.
    fn vertical_scale(&mut self, axis: &Axis, side: Side, colour: Colour) -> Result<(), PlotError> {
        let screen = self.screen;
        let (x, align) = match side {
            Side::Left => (screen.left - TICK_GAP, Align::End),
            Side::Right => (screen.right + TICK_GAP, Align::Start),
        };
        for tick in ticks::fit(axis, screen.height(), |_| 1.4 * TICK_TEXT) {
            let y = screen.bottom - tick.fraction * screen.height() + HALF_DIGIT;
            self.write(&tick.text, (x, y), TICK_TEXT, colour, align)?;
        }
        Ok(())
    }

    /// Writes the title of a vertical axis horizontally above the screen, where it is easy to read.
    ///
    /// Two titles share the width.
    fn vertical_title(
        &mut self,
        picture: &Picture,
        axis: &Axis,
        side: Side,
        colour: Colour,
    ) -> Result<(), PlotError> {
        let titles = 1.0 + f64::from(picture.vertical_right.is_some());
        let max_width = self.frame.max_text_width() / titles - MARGIN;
        let title = self.title(axis, max_width);
        let (x, align) = match side {
            Side::Left => (MARGIN, Align::Start),
            Side::Right => (self.frame.width - MARGIN, Align::End),
        };
        let at = (x, self.screen.top - TITLES_ABOVE);
        self.write(&title, at, LABEL_TEXT, colour, align)
    }

    /// Returns label and unit. If they do not fit, the label is truncated.
    fn title(&self, axis: &Axis, max_width: f64) -> String {
        font::truncated_before(&ticks::unit(axis), &axis.label, LABEL_TEXT, max_width)
    }

    /// Draws a mark at each division of the right axis.
    fn right_marks(&mut self, axis: &Axis) -> Result<(), PlotError> {
        let x = self.screen.right;
        for line in 0..=axis.divisions {
            let fraction = line as f64 / axis.divisions as f64;
            let y = (self.screen.bottom - fraction * self.screen.height()).floor();
            self.surface.rectangle((x, y), (x + MARK_LENGTH, y + 1.0), palette::BORDER)?;
        }
        Ok(())
    }

    /// Writes one line of text; `at` is a point on its baseline.
    fn write(
        &mut self,
        text: &str,
        at: (f64, f64),
        size: f64,
        colour: Colour,
        align: Align,
    ) -> Result<(), PlotError> {
        let style = TextStyle { size, colour, align };
        self.surface.text(text, at, style)
    }
}
