//! The rows above the screen: title, note, warning and legend.

use super::colour::Colour;
use super::layout::{Frame, LABEL_TEXT, MARGIN};
use super::surface::{Align, Surface, TextStyle};
use super::{Channel, Picture, PlotError, font, palette, trace};

/// The em size of the title.
const TITLE_TEXT: f64 = 18.0;
/// The em size of the note and of the warning.
const NOTE_TEXT: f64 = 12.5;

/// The height of the row of the title.
const TITLE_ROW: f64 = 24.0;
/// The height of the row of the note, and of that of the warning.
const NOTE_ROW: f64 = 20.0;
/// The height of a row of the legend.
const LEGEND_ROW: f64 = 21.0;
/// The height of the row with the titles of the vertical axes.
const AXIS_ROW: f64 = 36.0;

/// The space above the first row.
const TOP_MARGIN: f64 = 10.0;

/// The length of the line before a name in the legend.
const SAMPLE_LENGTH: f64 = 24.0;
/// The gap between that line and the name.
const SAMPLE_GAP: f64 = 7.0;

/// The height of that line above the baseline of the name.
const SAMPLE_ABOVE: f64 = 0.34 * LABEL_TEXT;

/// The gap between the entries of the legend.
const ENTRY_GAP: f64 = 22.0;

/// The maximum number of rows of the legend; more rows would leave too little height for the screen.
const MAX_LEGEND_ROWS: usize = 4;

/// Draws title, note, warning and legend, and returns the upper edge of the screen.
pub(super) fn draw(picture: &Picture, frame: &Frame, surface: &mut dyn Surface) -> Result<f64, PlotError> {
    let legend = legend(picture, frame.max_text_width());
    let mut header = HeaderWriter { frame, surface, baseline: TOP_MARGIN };
    let remaining = header.title_row(&picture.title, legend)?;
    if let Some(note) = &picture.note {
        header.baseline += NOTE_ROW;
        header.write(note, NOTE_TEXT, palette::NOTE)?;
    }
    if let Some(warning) = &picture.warning {
        header.baseline += NOTE_ROW;
        header.write(warning, NOTE_TEXT, palette::WARNING)?;
    }
    for row in rows(remaining, frame.max_text_width()) {
        header.baseline += LEGEND_ROW;
        header.legend_row(&row, MARGIN)?;
    }
    Ok(header.baseline + AXIS_ROW)
}

/// The rows above the screen, written one below the other.
struct HeaderWriter<'a> {
    /// The size of the picture and of its margins.
    frame: &'a Frame,
    /// The surface that is drawn on.
    surface: &'a mut dyn Surface,
    /// The baseline of the last row.
    baseline: f64,
}

impl HeaderWriter<'_> {
    /// Writes the title, and the legend to its right if both fit in one row.
    ///
    /// Returns the entries of the legend that are not yet written.
    fn title_row<'a>(
        &mut self,
        title: &str,
        legend: Vec<LegendEntry<'a>>,
    ) -> Result<Vec<LegendEntry<'a>>, PlotError> {
        let max_width = self.frame.max_text_width();
        let title_width = font::width(title, TITLE_TEXT);
        let in_same_row = !legend.is_empty() && width(&legend) <= max_width - title_width - ENTRY_GAP;
        if in_same_row || !title.is_empty() {
            self.baseline += TITLE_ROW;
            self.write(title, TITLE_TEXT, palette::TEXT)?;
        }
        if !in_same_row {
            return Ok(legend);
        }
        self.legend_row(&legend, self.frame.width - MARGIN - width(&legend))?;
        Ok(Vec::new())
    }

    /// Writes a text at the left margin of the last row, truncated to the width of the picture.
    fn write(&mut self, text: &str, size: f64, colour: Colour) -> Result<(), PlotError> {
        let text = font::truncated(text, size, self.frame.max_text_width());
        let style = TextStyle { size, colour, align: Align::Start };
        self.surface.text(&text, (MARGIN, self.baseline), style)
    }

    /// Writes entries of the legend next to each other, from `left` on.
    fn legend_row(&mut self, row: &[LegendEntry<'_>], left: f64) -> Result<(), PlotError> {
        let style = TextStyle { size: LABEL_TEXT, colour: palette::TEXT, align: Align::Start };
        let mut x = left;
        for entry in row {
            let mut text_left = x;
            if let Some((channel, colour)) = entry.sample {
                let y = self.baseline - SAMPLE_ABOVE;
                let (width, points) = trace::legend_sample(channel, (x, y), SAMPLE_LENGTH);
                self.surface.line(&points, width, colour)?;
                text_left += SAMPLE_LENGTH + SAMPLE_GAP;
            }
            self.surface.text(&entry.name, (text_left, self.baseline), style)?;
            x += entry.width + ENTRY_GAP;
        }
        Ok(())
    }
}

/// The entry of one channel in the legend, or the number of channels without an entry.
struct LegendEntry<'a> {
    /// The name of the channel and its axis, truncated to the width of the picture; or "and 24 more".
    name: String,
    /// The width with the sample, without the gap to the next entry.
    width: f64,
    /// The channel and the colour of its trace, for the sample. `None` for the number of channels without an entry.
    sample: Option<(&'a Channel, Colour)>,
}

impl LegendEntry<'_> {
    /// Returns the last entry of a legend from which this number of channels is missing.
    fn missing(channels: usize) -> Self {
        let name = format!("and {channels} more");
        LegendEntry { width: font::width(&name, LABEL_TEXT), name, sample: None }
    }
}

/// Returns the entries of the legend.
///
/// A single channel has no legend, unless there is a right axis.
fn legend<'a>(picture: &'a Picture, max_width: f64) -> Vec<LegendEntry<'a>> {
    if picture.channels.len() < 2 && picture.vertical_right.is_none() {
        return Vec::new();
    }
    let max_width = max_width - SAMPLE_LENGTH - SAMPLE_GAP;
    let entry = |(index, channel): (usize, &'a Channel)| {
        let name = font::truncated_before(axis_note(picture, channel), &channel.name, LABEL_TEXT, max_width);
        LegendEntry {
            width: SAMPLE_LENGTH + SAMPLE_GAP + font::width(&name, LABEL_TEXT),
            name,
            sample: Some((channel, palette::channel(index, channel))),
        }
    };
    picture.channels.iter().enumerate().map(entry).collect()
}

/// Returns the name suffix for the axis that a channel uses; empty if there is only one.
fn axis_note(picture: &Picture, channel: &Channel) -> &'static str {
    match (&picture.vertical_right, channel.right) {
        (None, _) => "",
        (Some(_), false) => " (left)",
        (Some(_), true) => " (right)",
    }
}

/// Returns the width of a row of the legend with the gaps between its entries.
fn width(row: &[LegendEntry<'_>]) -> f64 {
    let gaps = row.len().saturating_sub(1) as f64 * ENTRY_GAP;
    row.iter().map(|entry| entry.width).sum::<f64>() + gaps
}

/// Breaks the legend into rows of at most `max_width`.
///
/// If there are more than [`MAX_LEGEND_ROWS`], the last entry says how many channels are missing.
fn rows(legend: Vec<LegendEntry<'_>>, max_width: f64) -> Vec<Vec<LegendEntry<'_>>> {
    let mut rows: Vec<Vec<LegendEntry<'_>>> = Vec::new();
    for entry in legend {
        match rows.last_mut() {
            Some(row) if width(row) + ENTRY_GAP + entry.width <= max_width => row.push(entry),
            _ => rows.push(vec![entry]),
        }
    }
    let mut missing: usize = rows.iter().skip(MAX_LEGEND_ROWS).map(Vec::len).sum();
    rows.truncate(MAX_LEGEND_ROWS);
    if let Some(last) = rows.last_mut().filter(|_| missing > 0) {
        let mut note = LegendEntry::missing(missing);
        // The note may take the place of further entries.
        while width(last) + ENTRY_GAP + note.width > max_width && last.pop().is_some() {
            missing += 1;
            note = LegendEntry::missing(missing);
        }
        last.push(note);
    }
    rows
}
