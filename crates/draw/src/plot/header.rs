use plotters::style::RGBColor;

use super::font::Font;
use super::layout::{Frame, LABEL_TEXT, MARGIN};
use super::surface::{Align, Lettering, Surface};
use super::{Channel, Picture, PlotError, palette, trace};

const TITLE_TEXT: f64 = 18.0;
const NOTE_TEXT: f64 = 12.5;

/// Heights of the rows of the head; the last holds the vertical titles.
const TITLE_ROW: f64 = 24.0;
const NOTE_ROW: f64 = 20.0;
const LEGEND_ROW: f64 = 21.0;
const AXIS_ROW: f64 = 36.0;

/// Space above the first row.
const ABOVE: f64 = 10.0;

/// Length of the line before a name in the legend, and the gap after it.
const SAMPLE: f64 = 24.0;
const SAMPLE_GAP: f64 = 7.0;

/// How far above the baseline of a name its line is.
const SAMPLE_ABOVE: f64 = 0.34 * LABEL_TEXT;

/// Gap between the entries of the legend.
const BETWEEN: f64 = 22.0;

/// Rows of legend beyond these would leave no room for the screen.
const MOST_LEGEND_ROWS: usize = 4;

/// Draws title, note and legend, and tells where the screen begins.
pub(super) fn draw(
    picture: &Picture,
    frame: &Frame,
    font: &Font,
    surface: &mut dyn Surface,
) -> Result<f64, PlotError> {
    let legend = legend(picture, font, frame.text_room());
    let mut head = Head { frame, font, surface, baseline: ABOVE };
    let rest = head.title_row(&picture.title, legend)?;
    if let Some(note) = &picture.note {
        head.baseline += NOTE_ROW;
        head.write(note, NOTE_TEXT, palette::NOTE)?;
    }
    for row in rows(rest, frame.text_room()) {
        head.baseline += LEGEND_ROW;
        head.legend_row(&row, MARGIN)?;
    }
    Ok(head.baseline + AXIS_ROW)
}

/// The rows above the screen, written one below the other.
struct Head<'a> {
    frame: &'a Frame,
    font: &'a Font,
    surface: &'a mut dyn Surface,
    /// That of the latest row.
    baseline: f64,
}

impl Head<'_> {
    /// Writes the title and, if there is room beside it, the legend, and gives back
    /// what of the legend is still to be written.
    fn title_row<'a>(&mut self, title: &str, legend: Vec<Entry<'a>>) -> Result<Vec<Entry<'a>>, PlotError> {
        let room = self.frame.text_room();
        let title_width = self.font.width(title, TITLE_TEXT);
        let beside = !legend.is_empty() && width(&legend) <= room - title_width - BETWEEN;
        if beside || !title.is_empty() {
            self.baseline += TITLE_ROW;
            self.write(title, TITLE_TEXT, palette::TEXT)?;
        }
        if !beside {
            return Ok(legend);
        }
        self.legend_row(&legend, self.frame.width - MARGIN - width(&legend))?;
        Ok(Vec::new())
    }

    fn write(&mut self, text: &str, size: f64, colour: RGBColor) -> Result<(), PlotError> {
        let text = self.font.shortened(text, size, self.frame.text_room());
        let lettering = Lettering { size, colour, align: Align::Start };
        self.surface.text(&text, (MARGIN, self.baseline), lettering)
    }

    fn legend_row(&mut self, row: &[Entry<'_>], left: f64) -> Result<(), PlotError> {
        let lettering = Lettering { size: LABEL_TEXT, colour: palette::TEXT, align: Align::Start };
        let mut x = left;
        for entry in row {
            let y = self.baseline - SAMPLE_ABOVE;
            let (width, points) = trace::sample(entry.channel, (x, y), SAMPLE);
            self.surface.line(&points, width, entry.colour)?;
            let at = (x + SAMPLE + SAMPLE_GAP, self.baseline);
            self.surface.text(&entry.name, at, lettering)?;
            x += entry.width + BETWEEN;
        }
        Ok(())
    }
}

/// One channel in the legend.
struct Entry<'a> {
    name: String,
    width: f64,
    colour: RGBColor,
    channel: &'a Channel,
}

/// A single channel needs no legend, unless it is read at the right.
fn legend<'a>(picture: &'a Picture, font: &Font, room: f64) -> Vec<Entry<'a>> {
    if picture.channels.len() < 2 && picture.vertical_right.is_none() {
        return Vec::new();
    }
    let room = room - SAMPLE - SAMPLE_GAP;
    let entry = |(index, channel): (usize, &'a Channel)| {
        let name = font.shortened_before(reading(picture, channel), &channel.name, LABEL_TEXT, room);
        Entry {
            width: SAMPLE + SAMPLE_GAP + font.width(&name, LABEL_TEXT),
            name,
            colour: palette::channel(index, channel),
            channel,
        }
    };
    picture.channels.iter().enumerate().map(entry).collect()
}

/// On which axis to read a channel, if there are two.
fn reading(picture: &Picture, channel: &Channel) -> &'static str {
    match (&picture.vertical_right, channel.right) {
        (None, _) => "",
        (Some(_), false) => " (left)",
        (Some(_), true) => " (right)",
    }
}

fn width(row: &[Entry<'_>]) -> f64 {
    let gaps = row.len().saturating_sub(1) as f64 * BETWEEN;
    row.iter().map(|entry| entry.width).sum::<f64>() + gaps
}

/// The legend broken into rows no wider than the room.
fn rows(legend: Vec<Entry<'_>>, room: f64) -> Vec<Vec<Entry<'_>>> {
    let mut rows: Vec<Vec<Entry<'_>>> = Vec::new();
    for entry in legend {
        match rows.last_mut() {
            Some(row) if width(row) + BETWEEN + entry.width <= room => row.push(entry),
            _ => rows.push(vec![entry]),
        }
    }
    rows.truncate(MOST_LEGEND_ROWS);
    rows
}
