//! Formats a velocity profile as text and as JSON.
//!
//! Velocities have one unit prefix in the whole report. A point or section that does not exist keeps its row, with the
//! reason.

use serde_json::{Value, json};

use super::table::Table;
use patchcord::format::QuantityFormat;
use patchcord::instruments::{
    AbsenceReason, CriticalInterval, ProfileCriterion, ProfilePoint, ProfileSection, VelocityProfile,
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
    let seconds = QuantityFormat::new("", 1.0);
    format!(
        "{}\n{}\nOscillation: {} swings by more than {}, peak to peak, within {} s. Standstill: up to {}.\n{note}",
        points_text(reading, &format),
        sections_text(reading, &format),
        reading.names[1],
        format.text(criterion.oscillation.threshold),
        seconds.number(criterion.oscillation.window),
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
    let seconds = QuantityFormat::new("", 1.0);
    let headings = ["point", falling(reading), &format!("{}, {}", reading.names[0], format.unit), "at s", ""];
    let mut table = Table::with(headings.map(str::to_owned));
    let names = reading.profile.direction.point_names();
    for (index, point) in reading.profile.points.iter().enumerate() {
        let [command, time, remark] = match point {
            Ok(point) => {
                [format.number(point.command), seconds.number(point.time), reading.remark(index, point)]
            }
            Err(why) => [String::new(), String::new(), format!("none: {why}")],
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
        let why = section.err().map_or(String::new(), |why| format!("none: {why}"));
        table.row([
            VelocityProfile::SECTION_LETTERS[index].to_string(),
            names[index].to_owned(),
            command,
            cycles,
            swing,
            frequency,
            why,
        ]);
    }
    table.text()
}

/// Command, cycles, swing and frequency of a section.
fn cells(section: &ProfileSection, format: &QuantityFormat) -> [String; 4] {
    let between = |format: &QuantityFormat, ends: [f64; 2]| {
        format!("{} to {}", format.number(ends[0]), format.number(ends[1]))
    };
    [
        between(format, section.command),
        section.cycles.to_string(),
        section.swing.map_or(String::new(), |swing| format.number(swing)),
        section.frequency.map_or(String::new(), |both| between(&QuantityFormat::new("", 1.0), both)),
    ]
}

/// The report as JSON, without the parts that all commands share.
///
/// The only key is `profile`, with `command` and `velocity` (names), `unit`, `threshold`, `window` in s, `standstill`,
/// `way` ("rising" or "falling"), `jump`, `note`, `points`, `sections` and `critical_velocity`. All velocities are in
/// `unit`.
pub(super) fn json(reading: &ProfileReading) -> Value {
    let ProfileCriterion { oscillation, standstill } = reading.criterion;
    let VelocityProfile { direction, points, sections, jump } = &reading.profile;
    let points = points.iter().zip(direction.point_names()).enumerate().map(point_json);
    let sections = sections
        .iter()
        .zip(direction.section_names())
        .zip(VelocityProfile::SECTION_LETTERS)
        .map(section_json);
    json!({ "profile": {
        "command": reading.names[0],
        "velocity": reading.names[1],
        "unit": reading.unit,
        "threshold": oscillation.threshold,
        "window": oscillation.window,
        "standstill": standstill,
        "way": direction.select(["rising", "falling"]),
        "jump": jump,
        "note": reading.note,
        "points": points.collect::<Value>(),
        "sections": sections.collect::<Value>(),
        "critical_velocity": reading.range.map(range_json),
    }})
}

/// `there` is false if the point does not exist; then `why` replaces `command`, `t` and `coincides`.
fn point_json((index, (point, what)): (usize, (&Result<ProfilePoint, AbsenceReason>, &str))) -> Value {
    let number = index + 1;
    match point {
        Ok(point) => json!({
            "point": number, "what": what, "there": true,
            "command": point.command, "t": point.time, "coincides": point.coincides_with,
        }),
        Err(why) => json!({"point": number, "what": what, "there": false, "why": why.to_string()}),
    }
}

/// `command` and `t` are pairs of first and last value. `swing` is peak to peak, `frequency` a pair in Hz.
fn section_json(((section, what), letter): ((&Result<ProfileSection, AbsenceReason>, &str), char)) -> Value {
    match section {
        Ok(section) => json!({
            "section": letter, "what": what, "there": true,
            "command": section.command, "t": section.time,
            "cycles": section.cycles, "swing": section.swing, "frequency": section.frequency,
        }),
        Err(why) => json!({"section": letter, "what": what, "there": false, "why": why.to_string()}),
    }
}

/// `least` and `most` limit the value over other thresholds and windows. `unread` counts the criteria that gave none.
fn range_json(range: CriticalInterval) -> Value {
    json!({
        "value": range.value, "least": range.least, "most": range.most,
        "by_threshold": range.by_threshold, "by_window": range.by_window, "overrun": range.overrun,
        "unread": range.unread,
    })
}
