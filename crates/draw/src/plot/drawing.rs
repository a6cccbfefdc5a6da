//! Line drawings as data: schematics, patch panels and figures.

use super::clip::Area;
use super::surface::{Surface, TextStyle};
use super::theme::{Ink, Theme};
use super::{Format, PlotError, font, raster, svg};

/// A line drawing: a list of primitives on a page.
///
/// Positions and lengths are in pixels at 100 %, from the upper left corner; y points down.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::{Drawing, Format, Ink, PlotError, Primitive, Theme, render_drawing};
///
/// let line = Primitive::Line { points: vec![(10.0, 10.0), (90.0, 40.0)], width: 1.5, ink: Ink::Line };
/// let drawing = Drawing { width: 100.0, height: 50.0, primitives: vec![line] };
/// let svg = render_drawing(&drawing, Format::Svg, Theme::Light)?;
/// assert!(svg.starts_with(b"<?xml"));
/// assert_ne!(svg, render_drawing(&drawing, Format::Svg, Theme::Dark)?);
/// # Ok::<(), PlotError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Drawing {
    /// The width of the page.
    pub width: f64,
    /// The height of the page.
    pub height: f64,
    /// The primitives from back to front.
    pub primitives: Vec<Primitive>,
}

/// One element of a drawing.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Primitive {
    /// A polyline with round joins and ends.
    Line {
        /// The corners in order.
        points: Vec<(f64, f64)>,
        /// The thickness of the line.
        width: f64,
        /// The colour.
        ink: Ink,
    },
    /// A filled polygon.
    Area {
        /// The corners in order; the last is joined to the first.
        corners: Vec<(f64, f64)>,
        /// The colour.
        ink: Ink,
    },
    /// The outline of a circle.
    Ring {
        /// The centre.
        centre: (f64, f64),
        /// The radius.
        radius: f64,
        /// The thickness of the outline.
        width: f64,
        /// The colour.
        ink: Ink,
    },
    /// A filled circle.
    Disc {
        /// The centre.
        centre: (f64, f64),
        /// The radius.
        radius: f64,
        /// The colour.
        ink: Ink,
    },
    /// A line of text.
    Text(Label),
}

/// A line of text at a position.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::{Align, Ink, Label, text_width};
///
/// let label = Label::new("v_o", (50.0, 20.0), 10.0, Align::Middle, Ink::Line);
/// let area = label.area();
/// assert!((area.width() - text_width("v_o", 10.0)).abs() < 1e-9);
/// assert!((area.left + area.right - 100.0).abs() < 1e-9, "centred at 50");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// The text.
    pub text: String,
    /// A point on the baseline.
    pub at: (f64, f64),
    /// The em size.
    pub size: f64,
    /// The part of the text that is at that point.
    pub align: Align,
    /// The colour.
    pub ink: Ink,
}

pub use super::surface::Align;

/// The height of capitals above the baseline, in ems of the built-in font.
const RISE: f64 = 0.76;
/// The depth of descenders below the baseline, in ems.
const DEPTH: f64 = 0.24;

impl Label {
    /// Returns a line of text with a point of its baseline at `at`.
    pub fn new(text: impl Into<String>, at: (f64, f64), size: f64, align: Align, ink: Ink) -> Label {
        Label { text: text.into(), at, size, align, ink }
    }

    /// Returns the rectangle that the text occupies.
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

impl Primitive {
    /// Returns the line of text; `None` if the primitive is a line, an area or a circle.
    pub fn label(&self) -> Option<&Label> {
        match self {
            Primitive::Text(label) => Some(label),
            _ => None,
        }
    }

    /// Returns the primitive shifted by `by`.
    #[must_use]
    pub fn moved(self, by: (f64, f64)) -> Primitive {
        let shift = |at: (f64, f64)| (at.0 + by.0, at.1 + by.1);
        let all = |points: Vec<(f64, f64)>| points.into_iter().map(shift).collect();
        match self {
            Primitive::Line { points, width, ink } => Primitive::Line { points: all(points), width, ink },
            Primitive::Area { corners, ink } => Primitive::Area { corners: all(corners), ink },
            Primitive::Ring { centre, radius, width, ink } => {
                Primitive::Ring { centre: shift(centre), radius, width, ink }
            }
            Primitive::Disc { centre, radius, ink } => Primitive::Disc { centre: shift(centre), radius, ink },
            Primitive::Text(label) => Primitive::Text(Label { at: shift(label.at), ..label }),
        }
    }
}

/// Returns the width of a line of text at an em size, in the built-in font.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::text_width;
///
/// assert!((text_width("nn", 10.0) - 2.0 * text_width("n", 10.0)).abs() < 1e-6);
/// assert_eq!(text_width("", 10.0), 0.0);
/// ```
pub fn text_width(text: &str, size: f64) -> f64 {
    font::width(&font::printable(text), size)
}

/// Truncates a text to a maximum width. A truncated text ends in an ellipsis.
///
/// Control characters, including line breaks, become blanks.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::{text_width, truncate_text};
///
/// assert_eq!(truncate_text("velocity", 10.0, 1000.0), "velocity");
/// let short = truncate_text("velocity", 10.0, 30.0);
/// assert!(short.ends_with('…') && text_width(&short, 10.0) <= 30.0);
/// ```
pub fn truncate_text(text: &str, size: f64, max_width: f64) -> String {
    font::truncated(text, size, max_width)
}

/// Renders a drawing and returns the bytes of the file. Equal drawings give equal bytes.
///
/// # Errors
///
/// [`PlotError::TooLarge`] if a side is longer than [`Drawing::MAX_SIDE`] or a PNG has more than
/// [`Drawing::MAX_PNG_PIXELS`]. [`PlotError::Font`], [`PlotError::Drawing`] and [`PlotError::Png`] if
/// a library fails.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::{Drawing, Format, Ink, PlotError, Primitive, Theme, render_drawing};
///
/// let circle = Primitive::Ring { centre: (50.0, 50.0), radius: 40.0, width: 2.0, ink: Ink::Line };
/// let drawing = Drawing { width: 100.0, height: 100.0, primitives: vec![circle] };
/// let svg = String::from_utf8_lossy(&render_drawing(&drawing, Format::Svg, Theme::Light)?).into_owned();
/// assert!(svg.contains("<circle") && svg.ends_with("</svg>\n"));
/// # Ok::<(), PlotError>(())
/// ```
pub fn render_drawing(drawing: &Drawing, format: Format, theme: Theme) -> Result<Vec<u8>, PlotError> {
    let size = drawing.size(format)?;
    match format {
        Format::Svg => svg::render_drawing(size, |surface| drawing.paint(theme, surface)),
        Format::Png => raster::render_drawing(size, |surface| drawing.paint(theme, surface)),
    }
}

impl Drawing {
    /// The maximum length of a side, in pixels. It keeps SVG coordinates well within 32 bits.
    pub const MAX_SIDE: f64 = 60_000.0;
    /// The maximum number of pixels of a PNG; an uncompressed image of this size takes 300 MB.
    pub const MAX_PNG_PIXELS: f64 = 100e6;

    /// Returns the size in whole pixels, or an error if it exceeds the limits.
    fn size(&self, format: Format) -> Result<(u32, u32), PlotError> {
        let (width, height) = (self.width.ceil(), self.height.ceil());
        let sides_fit = [width, height].iter().all(|side| (1.0..=Self::MAX_SIDE).contains(side));
        let pixels_fit = format == Format::Svg || width * height <= Self::MAX_PNG_PIXELS;
        if sides_fit && pixels_fit {
            Ok((width as u32, height as u32))
        } else {
            Err(PlotError::TooLarge {
                width,
                height,
                limit: match sides_fit {
                    true => Self::pixel_limit(),
                    false => format!("a side has at most {} pixels", Self::MAX_SIDE),
                },
            })
        }
    }

    /// Returns the limit of the pixels of a PNG, as a sentence.
    pub(super) fn pixel_limit() -> String {
        let millions = Self::MAX_PNG_PIXELS / 1e6;
        format!("a PNG has at most {millions:.0} million pixels; an SVG has no such limit")
    }

    /// Draws the page and then the primitives from back to front.
    fn paint(&self, theme: Theme, surface: &mut dyn Surface) -> Result<(), PlotError> {
        surface.rectangle((0.0, 0.0), (self.width.ceil(), self.height.ceil()), theme.colour(Ink::Page))?;
        self.primitives.iter().try_for_each(|primitive| primitive.paint(theme, surface))
    }
}

impl Primitive {
    /// Draws the primitive in the colours of a theme.
    fn paint(&self, theme: Theme, surface: &mut dyn Surface) -> Result<(), PlotError> {
        match self {
            Primitive::Line { points, width, ink } => surface.line(points, *width, theme.colour(*ink)),
            Primitive::Area { corners, ink } => surface.area(corners, theme.colour(*ink)),
            Primitive::Ring { centre, radius, width, ink } => {
                surface.ring(*centre, *radius, *width, theme.colour(*ink))
            }
            Primitive::Disc { centre, radius, ink } => surface.line(&[*centre], *radius, theme.colour(*ink)),
            Primitive::Text(label) => {
                let style =
                    TextStyle { size: label.size, colour: theme.colour(label.ink), align: label.align };
                surface.text(&font::printable(&label.text), label.at, style)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing() -> Drawing {
        let text = Label::new("A<1> & \u{1}", (60.0, 75.0), 10.0, Align::Middle, Ink::Line);
        Drawing {
            width: 120.0,
            height: 80.0,
            primitives: vec![
                Primitive::Area { corners: vec![(10.0, 10.0), (60.0, 40.0), (10.0, 70.0)], ink: Ink::Body },
                Primitive::Line { points: vec![(10.0, 10.0), (60.0, 40.0)], width: 1.5, ink: Ink::Line },
                Primitive::Ring { centre: (90.0, 40.0), radius: 15.0, width: 1.5, ink: Ink::Line },
                Primitive::Disc { centre: (60.0, 40.0), radius: 3.0, ink: Ink::Signal },
                Primitive::Text(text),
            ],
        }
    }

    #[test]
    fn rendering_is_repeatable_in_both_formats() {
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
    fn too_large_drawings_are_rejected() {
        let large = |width, format| {
            let drawing = Drawing { width, height: 20_000.0, primitives: vec![] };
            render_drawing(&drawing, format, Theme::Light).map(|bytes| bytes.len())
        };
        assert!(large(20_000.0, Format::Svg).is_ok());
        let error = large(20_000.0, Format::Png).unwrap_err().to_string();
        assert!(error.contains("SVG"), "{error}");
        assert!(large(70_000.0, Format::Svg).is_err() && large(f64::NAN, Format::Svg).is_err());
    }

    #[test]
    fn a_label_covers_its_text() {
        let label = Label::new("velocity", (50.0, 20.0), 10.0, Align::End, Ink::Line);
        let area = label.area();
        assert!((area.right - 50.0).abs() < 1e-9 && area.left < 20.0);
        assert!(area.top < 13.0 && area.bottom > 21.0);
    }
}
