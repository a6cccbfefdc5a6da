use plotters::style::RGBColor;

use super::clip::Area;
use super::font::Font;
use super::layout::{Frame, LABEL_TEXT, MARGIN, TICK_GAP, TICK_TEXT};
use super::surface::{Align, Lettering, Surface};
use super::{Axis, Picture, PlotError, palette, ticks};

/// How far below the middle of a number its baseline is.
const HALF_DIGIT: f64 = 0.36 * TICK_TEXT;

/// How far below the screen the baselines of the numbers and the title are.
const NUMBERS_BELOW: f64 = 20.0;
const TITLE_BELOW: f64 = 42.0;

/// How far above the screen the baselines of the vertical titles are.
const TITLES_ABOVE: f64 = 13.0;

/// Room between neighbouring numbers.
const BETWEEN_NUMBERS: f64 = 14.0;

/// Length of the marks that carry numbers off the graticule.
const MARK: f64 = 5.0;

/// Draws the numbers and titles around the screen.
pub(super) fn draw(
    picture: &Picture,
    frame: &Frame,
    screen: Area,
    font: &Font,
    surface: &mut dyn Surface,
) -> Result<(), PlotError> {
    let mut scales = Scales { frame, screen, font, surface };
    let (left, right) = colours(picture);
    scales.foot(&picture.horizontal)?;
    scales.side(&picture.vertical, Side::Left, left)?;
    scales.side_title(picture, &picture.vertical, Side::Left, left)?;
    if let Some(axis) = &picture.vertical_right {
        scales.side(axis, Side::Right, right)?;
        scales.side_title(picture, axis, Side::Right, right)?;
        if axis.divisions != picture.vertical.divisions {
            scales.right_marks(axis)?;
        }
    }
    Ok(())
}

/// With a right axis, either side has the colour of its first channel.
fn colours(picture: &Picture) -> (RGBColor, RGBColor) {
    let colour = |right: bool| {
        let first = picture.channels.iter().position(|channel| channel.right == right);
        match first {
            Some(index) if picture.vertical_right.is_some() => palette::trace(index),
            _ => palette::TEXT,
        }
    };
    (colour(false), colour(true))
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
}

struct Scales<'a> {
    frame: &'a Frame,
    screen: Area,
    font: &'a Font,
    surface: &'a mut dyn Surface,
}

impl Scales<'_> {
    fn foot(&mut self, axis: &Axis) -> Result<(), PlotError> {
        let screen = self.screen;
        let room_for = |text: &str| self.font.width(text, TICK_TEXT) + BETWEEN_NUMBERS;
        for tick in ticks::fitting(axis, screen.width(), room_for) {
            let x = screen.left + tick.fraction * screen.width();
            let at = (x, screen.bottom + NUMBERS_BELOW);
            self.write(&tick.text, at, TICK_TEXT, palette::TEXT, Align::Middle)?;
        }
        let title = self.title(axis, screen.width());
        let middle = (screen.left + screen.right) / 2.0;
        let at = (middle, screen.bottom + TITLE_BELOW);
        self.write(&title, at, LABEL_TEXT, palette::TEXT, Align::Middle)
    }

    fn side(&mut self, axis: &Axis, side: Side, colour: RGBColor) -> Result<(), PlotError> {
        let screen = self.screen;
        let (x, align) = match side {
            Side::Left => (screen.left - TICK_GAP, Align::End),
            Side::Right => (screen.right + TICK_GAP, Align::Start),
        };
        for tick in ticks::fitting(axis, screen.height(), |_| 1.4 * TICK_TEXT) {
            let y = screen.bottom - tick.fraction * screen.height() + HALF_DIGIT;
            self.write(&tick.text, (x, y), TICK_TEXT, colour, align)?;
        }
        Ok(())
    }

    /// Vertical titles stand level above the screen, where they can be read
    /// without turning the head; two of them share the width.
    fn side_title(
        &mut self,
        picture: &Picture,
        axis: &Axis,
        side: Side,
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        let sharers = 1.0 + f64::from(picture.vertical_right.is_some());
        let room = self.frame.text_room() / sharers - MARGIN;
        let title = self.title(axis, room);
        let (x, align) = match side {
            Side::Left => (MARGIN, Align::Start),
            Side::Right => (self.frame.width - MARGIN, Align::End),
        };
        let at = (x, self.screen.top - TITLES_ABOVE);
        self.write(&title, at, LABEL_TEXT, colour, align)
    }

    /// Label and unit; if they do not fit, the label gives way.
    fn title(&self, axis: &Axis, room: f64) -> String {
        self.font.shortened_before(&ticks::unit(axis), &axis.label, LABEL_TEXT, room)
    }

    fn right_marks(&mut self, axis: &Axis) -> Result<(), PlotError> {
        let x = self.screen.right;
        for line in 0..=axis.divisions {
            let part = line as f64 / axis.divisions as f64;
            let y = (self.screen.bottom - part * self.screen.height()).floor();
            self.surface.rectangle((x, y), (x + MARK, y + 1.0), palette::BORDER)?;
        }
        Ok(())
    }

    fn write(
        &mut self,
        text: &str,
        at: (f64, f64),
        size: f64,
        colour: RGBColor,
        align: Align,
    ) -> Result<(), PlotError> {
        let lettering = Lettering { size, colour, align };
        self.surface.text(text, at, lettering)
    }
}
