//! Formats a velocity profile as text and as JSON.
//!
//! Velocities have one unit prefix in the whole report. A point or section that does not exist keeps its row, with the
//! reason.

use serde::Serialize;

use super::table::Table;
use patchcord::format::{QuantityFormat, format_pure_number};
use patchcord::instruments::{
    CriticalInterval, MissingPointError, ProfileCriterion, ProfilePoint, ProfileSection, VelocityProfile,
};

/// A velocity profile with everything that the report needs.
pub(super) struct ProfileReading {
    /// Names of the commanded and the actual velocity.
    pub names: [String; 2],
    /// Unit of both velocities.
    pub unit: String,
    /// Samples of both velocities.
    pub values: [Vec<f64>; 2],
    /// What counts as oscillation and as standstill.
    pub criterion: ProfileCriterion,
    /// The points and sections.
    pub profile: VelocityProfile,
    /// A note about the run.
    pub note: Option<String>,
    /// The interval of the critical velocity, point 5.
    pub range: Option<CriticalInterval>,
}

impl ProfileReading {
    /// The common format of all velocities.
    fn format(&self) -> QuantityFormat {
        let largest = self.values.iter().flatten().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        QuantityFormat::new(&self.unit, largest)
    }

    /// The remark on a point; empty if there is none.
    ///
    /// Point 1 has the jump, point 5 the interval of the upper critical velocity. A point that coincides with another
    /// says so.
    fn remark(&self, index: usize, point: &ProfilePoint) -> String {
        let (format, direction) = (self.format(), self.profile.direction);
        let here = direction.select(["from here on", "down to here"]);
        let oscillates_beyond = self.profile.points[4].map_or(true, |end| end.coincides_with.is_none());
        let remark = match (index, self.profile.jump, self.range) {
            (0, Some(jump), _) => {
                let jumps = direction.select(["the velocity jumps to", "a last slip reaches"]);
                format!("{jumps} {}", format.text(jump))
            }
            (1, ..) => "the lower critical velocity".to_owned(),
            (2, ..) => format!("{here} cycles reach standstill"),
            (3, ..) if oscillates_beyond => format!("{here} it oscillates without standstill"),
            (4, _, Some(range)) => range_text(range, &format),
            _ => String::new(),
        };
        let coincides = point.coincides_with.map(|other| format!("coincides with point {other}"));
        let parts = [Some(remark).filter(|remark| !remark.is_empty()), coincides];
        parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}

/// The report as text.
pub(super) fn text(reading: &ProfileReading) -> String {
    let format = reading.format();
    let criterion = reading.criterion;
    let note = reading.note.as_ref().map_or_else(String::new, |note| format!("note: {note}\n"));
    format!(
        "{}\n{}\nOscillation: {} swings by more than {}, peak to peak, within {} s. Standstill: up to {}.\n{note}",
        points_text(reading, &format),
        sections_text(reading, &format),
        reading.names[1],
        format.text(criterion.oscillation.threshold),
        format_pure_number(criterion.oscillation.window),
        format.text(criterion.standstill),
    )
}

/// "the upper critical velocity: 4.3 to 4.8 mm/s".
fn range_text(range: CriticalInterval, format: &QuantityFormat) -> String {
    let unread = match range.unread {
        0 => String::new(),
        unread => format!(", {unread} of 4 other criteria failed"),
    };
    format!(
        "the upper critical velocity: {} to {}{unread}",
        format.number(range.least),
        format.text(range.most)
    )
}

/// The heading above the names of points and sections.
fn falling(reading: &ProfileReading) -> &'static str {
    reading.profile.direction.select(["", "command falling"])
}

/// The table of points.
fn points_text(reading: &ProfileReading, format: &QuantityFormat) -> String {
    let headings = ["point", falling(reading), &format!("{}, {}", reading.names[0], format.unit), "at s", ""];
    let mut table = Table::with(headings.map(str::to_owned));
    let names = reading.profile.direction.point_names();
    for (index, point) in reading.profile.points.iter().enumerate() {
        let [command, time, remark] = match point {
            Ok(point) => {
                [format.number(point.command), format_pure_number(point.time), reading.remark(index, point)]
            }
            Err(reason) => [String::new(), String::new(), format!("none: {reason}")],
        };
        table.row([(index + 1).to_string(), names[index].to_owned(), command, time, remark]);
    }
    table.text()
}

/// The table of sections.
fn sections_text(reading: &ProfileReading, format: &QuantityFormat) -> String {
    let [command, swing] = [&reading.names[0], "swing"].map(|what| format!("{what}, {}", format.unit));
    let headings = ["section", falling(reading), &command, "cycles", &swing, "Hz", ""];
    let mut table = Table::with(headings.map(str::to_owned));
    let names = reading.profile.direction.section_names();
    for (index, section) in reading.profile.sections.iter().enumerate() {
        let [command, cycles, swing, frequency] =
            section.map_or_else(|_| Default::default(), |section| cells(&section, format));
        let reason = section.err().map_or(String::new(), |reason| format!("none: {reason}"));
        table.row([
            VelocityProfile::SECTION_LETTERS[index].to_string(),
            names[index].to_owned(),
            command,
            cycles,
            swing,
            frequency,
            reason,
        ]);
    }
    table.text()
}

/// Command, cycles, swing and frequency of a section.
fn cells(section: &ProfileSection, format: &QuantityFormat) -> [String; 4] {
    let between = |[first, last]: [String; 2]| format!("{first} to {last}");
    [
        between(section.command.map(|command| format.number(command))),
        section.cycles.to_string(),
        section.swing.map_or(String::new(), |swing| format.number(swing)),
        section.frequency.map_or(String::new(), |both| between(both.map(format_pure_number))),
    ]
}

/// A profile for `--json`. All velocities are in `unit`, the window is in s.
#[derive(Serialize)]
pub(super) struct ProfileDocument<'a> {
    command: &'a str,
    velocity: &'a str,
    unit: &'a str,
    threshold: f64,
    window: f64,
    standstill: f64,
    /// "rising" or "falling".
    #[serde(rename = "way")]
    direction: &'static str,
    jump: Option<f64>,
    note: Option<&'a str>,
    points: Vec<PointDocument>,
    sections: Vec<SectionDocument>,
    #[serde(rename = "critical_velocity")]
    range: Option<RangeDocument>,
}

/// A point of the profile, numbered from 1.
#[derive(Serialize)]
struct PointDocument {
    point: usize,
    what: &'static str,
    #[serde(rename = "there")]
    exists: bool,
    #[serde(flatten)]
    reading: PointReading,
}

/// The command and the time of a point, or why the point does not exist.
#[derive(Serialize)]
#[serde(untagged)]
enum PointReading {
    Exists {
        command: f64,
        #[serde(rename = "t")]
        time: f64,
        #[serde(rename = "coincides")]
        coincides_with: Option<usize>,
    },
    Absent {
        #[serde(rename = "why")]
        reason: String,
    },
}

/// A section of the profile.
#[derive(Serialize)]
struct SectionDocument {
    section: char,
    what: &'static str,
    #[serde(rename = "there")]
    exists: bool,
    #[serde(flatten)]
    reading: SectionReading,
}

/// The first and the last value of command and time of a section, or why the section does not exist. `swing` is peak to
/// peak, `frequency` a pair in Hz.
#[derive(Serialize)]
#[serde(untagged)]
enum SectionReading {
    Exists {
        command: [f64; 2],
        #[serde(rename = "t")]
        time: [f64; 2],
        cycles: usize,
        swing: Option<f64>,
        frequency: Option<[f64; 2]>,
    },
    Absent {
        #[serde(rename = "why")]
        reason: String,
    },
}

/// The upper critical velocity. `least` and `most` limit the value over other thresholds and windows. `unread` counts
/// the criteria that gave none.
#[derive(Serialize)]
struct RangeDocument {
    value: f64,
    least: f64,
    most: f64,
    by_threshold: f64,
    by_window: f64,
    overrun: Option<f64>,
    unread: usize,
}

impl<'a> ProfileDocument<'a> {
    /// The document of a profile.
    pub(super) fn of(reading: &'a ProfileReading) -> Self {
        let ProfileCriterion { oscillation, standstill } = reading.criterion;
        let VelocityProfile { direction, points, sections, jump } = &reading.profile;
        let points = points.iter().zip(direction.point_names()).enumerate();
        let sections = sections.iter().zip(direction.section_names()).zip(VelocityProfile::SECTION_LETTERS);
        ProfileDocument {
            command: &reading.names[0],
            velocity: &reading.names[1],
            unit: &reading.unit,
            threshold: oscillation.threshold,
            window: oscillation.window,
            standstill,
            direction: direction.select(["rising", "falling"]),
            jump: *jump,
            note: reading.note.as_deref(),
            points: points.map(|(index, (point, what))| PointDocument::of(index + 1, what, point)).collect(),
            sections: sections
                .map(|((section, what), letter)| SectionDocument::of(letter, what, section))
                .collect(),
            range: reading.range.map(RangeDocument::of),
        }
    }
}

impl PointDocument {
    fn of(number: usize, what: &'static str, point: &Result<ProfilePoint, MissingPointError>) -> Self {
        let reading = match *point {
            Ok(ProfilePoint { time, command, coincides_with }) => {
                PointReading::Exists { command, time, coincides_with }
            }
            Err(reason) => PointReading::Absent { reason: reason.to_string() },
        };
        PointDocument { point: number, what, exists: point.is_ok(), reading }
    }
}

impl SectionDocument {
    fn of(letter: char, what: &'static str, section: &Result<ProfileSection, MissingPointError>) -> Self {
        let reading = match *section {
            Ok(ProfileSection { time, command, cycles, swing, frequency }) => {
                SectionReading::Exists { command, time, cycles, swing, frequency }
            }
            Err(reason) => SectionReading::Absent { reason: reason.to_string() },
        };
        SectionDocument { section: letter, what, exists: section.is_ok(), reading }
    }
}

impl RangeDocument {
    fn of(range: CriticalInterval) -> Self {
        let CriticalInterval { value, least, most, by_threshold, by_window, overrun, unread } = range;
        RangeDocument { value, least, most, by_threshold, by_window, overrun, unread }
    }
}
