use super::clip::Area;
use super::font::{self, Font};
use super::surface::{Lettering, Surface};
use super::theme::{Ink, Theme};
use super::{Format, PlotError, raster, svg};

/// A line drawing as data: what is drawn where, in pixels at 100 %, from the upper left corner.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Drawing {
    /// Pixels across.
    pub width: f64,
    /// Pixels down.
    pub height: f64,
    /// What is drawn, the hindmost first.
    pub marks: Vec<Stroke>,
}

/// One thing drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Stroke {
    /// A line through points, with round joins and ends.
    Line {
        /// The points.
        points: Vec<(f64, f64)>,
        /// Its thickness.
        width: f64,
        /// Its colour.
        ink: Ink,
    },
    /// A filled area within straight edges.
    Area {
        /// Its corners.
        corners: Vec<(f64, f64)>,
        /// Its colour.
        ink: Ink,
    },
    /// A circle's edge.
    Ring {
        /// Its centre.
        centre: (f64, f64),
        /// Its radius.
        radius: f64,
        /// Thickness of the edge.
        width: f64,
        /// Its colour.
        ink: Ink,
    },
    /// A filled circle.
    Disc {
        /// Its centre.
        centre: (f64, f64),
        /// Its radius.
        radius: f64,
        /// Its colour.
        ink: Ink,
    },
    /// A line of text.
    Text(Label),
}

/// A line of text in a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// What it says.
    pub text: String,
    /// A point of its baseline.
    pub at: (f64, f64),
    /// Its em size.
    pub size: f64,
    /// Which part of the text is at that point.
    pub align: Align,
    /// Its colour.
    pub ink: Ink,
}

pub use super::surface::Align;

/// Height of capitals and depth of tails, in ems.
const RISE: f64 = 0.76;
const DEPTH: f64 = 0.24;

impl Label {
    /// The room that the text takes.
    pub fn area(&self) -> Area {
        let width = text_width(&self.text, self.size);
        let left = self.at.0 - self.align.shift(width);
        Area {
            left,
            top: self.at.1 - RISE * self.size,
            right: left + width,
            bottom: self.at.1 + DEPTH * self.size,
        }
    }
}

impl Stroke {
    /// The same mark in another place.
    #[must_use]
    pub fn moved(self, by: (f64, f64)) -> Stroke {
        let shift = |at: (f64, f64)| (at.0 + by.0, at.1 + by.1);
        let all = |points: Vec<(f64, f64)>| points.into_iter().map(shift).collect();
        match self {
            Stroke::Line { points, width, ink } => Stroke::Line { points: all(points), width, ink },
            Stroke::Area { corners, ink } => Stroke::Area { corners: all(corners), ink },
            Stroke::Ring { centre, radius, width, ink } => {
                Stroke::Ring { centre: shift(centre), radius, width, ink }
            }
            Stroke::Disc { centre, radius, ink } => Stroke::Disc { centre: shift(centre), radius, ink },
            Stroke::Text(label) => Stroke::Text(Label { at: shift(label.at), ..label }),
        }
    }
}

/// How wide a line of text is at an em size.
pub fn text_width(text: &str, size: f64) -> f64 {
    Font::shared().map_or(0.0, |font| font.width(&font::plain(text), size))
}

/// The text as one plain line, cut to a width, with an ellipsis where something is lost.
pub fn text_within(text: &str, size: f64, room: f64) -> String {
    Font::shared().map_or_else(|_| String::new(), |font| font.shortened(text, size, room))
}

/// The bytes of a file with a drawing. The same drawing always gives the same bytes.
///
/// # Errors
/// [`PlotError::TooLarge`] when a side is longer than [`Drawing::LONGEST`], or a PNG has more than
/// [`Drawing::MOST_PIXELS`]; the others when the file cannot be put together.
pub fn render_drawing(drawing: &Drawing, format: Format, theme: Theme) -> Result<Vec<u8>, PlotError> {
    let size = drawing.size(format)?;
    let font = Font::load()?;
    match format {
        Format::Svg => svg::drawing(size, |surface| drawing.paint(theme, surface)),
        Format::Png => raster::drawing(size, &font, |surface| drawing.paint(theme, surface)),
    }
}

impl Drawing {
    /// The longest side that can be drawn, in pixels.
    pub const LONGEST: f64 = 60_000.0;
    /// The most pixels of a PNG.
    pub const MOST_PIXELS: f64 = 100e6;

    fn size(&self, format: Format) -> Result<(u32, u32), PlotError> {
        let (width, height) = (self.width.ceil(), self.height.ceil());
        let sides_fit = [width, height].iter().all(|side| (1.0..=Self::LONGEST).contains(side));
        let pixels_fit = format == Format::Svg || width * height <= Self::MOST_PIXELS;
        if sides_fit && pixels_fit {
            Ok((width as u32, height as u32))
        } else {
            Err(PlotError::TooLarge {
                width,
                height,
                limit: match sides_fit {
                    true => format!(
                        "a PNG has at most {:.0} million pixels; as SVG it can",
                        Self::MOST_PIXELS / 1e6
                    ),
                    false => format!("a side has at most {} pixels", Self::LONGEST),
                },
            })
        }
    }

    fn paint(&self, theme: Theme, surface: &mut dyn Surface) -> Result<(), PlotError> {
        surface.rectangle((0.0, 0.0), (self.width.ceil(), self.height.ceil()), theme.colour(Ink::Page))?;
        self.marks.iter().try_for_each(|mark| mark.paint(theme, surface))
    }
}

impl Stroke {
    fn paint(&self, theme: Theme, surface: &mut dyn Surface) -> Result<(), PlotError> {
        match self {
            Stroke::Line { points, width, ink } => surface.line(points, *width, theme.colour(*ink)),
            Stroke::Area { corners, ink } => surface.area(corners, theme.colour(*ink)),
            Stroke::Ring { centre, radius, width, ink } => {
                surface.ring(*centre, *radius, *width, theme.colour(*ink))
            }
            Stroke::Disc { centre, radius, ink } => surface.line(&[*centre], *radius, theme.colour(*ink)),
            Stroke::Text(label) => {
                let lettering =
                    Lettering { size: label.size, colour: theme.colour(label.ink), align: label.align };
                surface.text(&font::plain(&label.text), label.at, lettering)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing() -> Drawing {
        let text = |text: &str, at| {
            Stroke::Text(Label { text: text.into(), at, size: 10.0, align: Align::Middle, ink: Ink::Line })
        };
        Drawing {
            width: 120.0,
            height: 80.0,
            marks: vec![
                Stroke::Area { corners: vec![(10.0, 10.0), (60.0, 40.0), (10.0, 70.0)], ink: Ink::Body },
                Stroke::Line { points: vec![(10.0, 10.0), (60.0, 40.0)], width: 1.5, ink: Ink::Line },
                Stroke::Ring { centre: (90.0, 40.0), radius: 15.0, width: 1.5, ink: Ink::Line },
                Stroke::Disc { centre: (60.0, 40.0), radius: 3.0, ink: Ink::Signal },
                text("A<1> & \u{1}", (60.0, 75.0)),
            ],
        }
    }

    #[test]
    fn both_formats_and_themes_are_drawn_alike_every_time() {
        for format in [Format::Svg, Format::Png] {
            let [light, again, dark] = [Theme::Light, Theme::Light, Theme::Dark]
                .map(|theme| render_drawing(&drawing(), format, theme).unwrap());
            assert!(light == again && light != dark);
        }
    }

    #[test]
    fn an_svg_is_well_formed() {
        let bytes = render_drawing(&drawing(), Format::Svg, Theme::Light).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let tree = roxmltree::Document::parse(&text).unwrap();
        let texts: Vec<_> = tree.descendants().filter(|node| node.has_tag_name("text")).collect();
        assert_eq!(texts.len(), 1);
        assert!(
            tree.descendants()
                .any(|node| node.has_tag_name("circle") && node.attribute("fill") == Some("none"))
        );
    }

    #[test]
    fn what_is_too_large_is_refused() {
        let large = |width, format| {
            let drawing = Drawing { width, height: 20_000.0, marks: vec![] };
            render_drawing(&drawing, format, Theme::Light).map(|bytes| bytes.len())
        };
        assert!(large(20_000.0, Format::Svg).is_ok());
        let error = large(20_000.0, Format::Png).unwrap_err().to_string();
        assert!(error.contains("as SVG"), "{error}");
        assert!(large(70_000.0, Format::Svg).is_err() && large(f64::NAN, Format::Svg).is_err());
    }

    #[test]
    fn a_label_takes_the_room_of_its_text() {
        let label = Label {
            text: "velocity".into(),
            at: (50.0, 20.0),
            size: 10.0,
            align: Align::End,
            ink: Ink::Line,
        };
        let area = label.area();
        assert!((area.right - 50.0).abs() < 1e-9 && area.left < 20.0);
        assert!(area.top < 13.0 && area.bottom > 21.0);
    }
}
