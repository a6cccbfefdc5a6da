//! A velocity profile, told to people and to programs.

use serde_json::{Value, json};

use super::table::Table;
use patchcord::instruments::{
    Absent, CriticalInterval, Display, ProfileCriterion, ProfilePoint, Section, VelocityProfile,
};

/// What was read off a run.
pub(super) struct Read {
    /// The names of the commanded and the actual velocity.
    pub names: [String; 2],
    /// Their unit.
    pub unit: String,
    /// Their values.
    pub values: [Vec<f64>; 2],
    pub criterion: ProfileCriterion,
    pub profile: VelocityProfile,
    /// What the reader should know of the run.
    pub note: Option<String>,
    /// How far point 5 depends on the criterion.
    pub range: Option<CriticalInterval>,
}

impl Read {
    /// How values are shown: all in the same prefixed unit.
    fn shown(&self) -> Display {
        let largest = self.values.iter().flatten().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        Display::new(&self.unit, largest)
    }

    /// What there is to say of a point.
    fn remark(&self, index: usize, point: &ProfilePoint) -> String {
        let (shown, way) = (self.shown(), self.profile.way);
        let here = way.of(["from here on", "down to here"]);
        let oscillates_beyond = self.profile.points[4].map_or(true, |end| end.coincides.is_none());
        let remark = match (index, self.profile.jump, self.range) {
            (0, Some(jump), _) => {
                let jumps = way.of(["the velocity jumps to", "a last slip reaches"]);
                format!("{jumps} {}", shown.text(jump))
            }
            (1, ..) => "the lower critical velocity".to_owned(),
            (2, ..) => format!("{here} its cycles come down to standstill"),
            (3, ..) if oscillates_beyond => format!("{here} it oscillates without standstill"),
            (4, _, Some(range)) => range_told(range, &shown),
            _ => String::new(),
        };
        let coincides = point.coincides.map(|other| format!("coincides with point {other}"));
        let told = [Some(remark).filter(|remark| !remark.is_empty()), coincides];
        told.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}

pub(super) fn told(read: &Read) -> String {
    let shown = read.shown();
    let criterion = read.criterion;
    let note = read.note.as_ref().map_or_else(String::new, |note| format!("note: {note}\n"));
    let seconds = Display::new("", 1.0);
    format!(
        "{}\n{}\nOscillation: {} swings by more than {}, peak to peak, within {} s. Standstill: up to {}.\n{note}",
        points_told(read, &shown),
        sections_told(read, &shown),
        read.names[1],
        shown.text(criterion.oscillation.threshold),
        seconds.number(criterion.oscillation.window),
        shown.text(criterion.standstill),
    )
}

fn range_told(range: CriticalInterval, shown: &Display) -> String {
    let unread = match range.unread {
        0 => String::new(),
        unread => format!(", {unread} of 4 other criteria not to be read here"),
    };
    format!(
        "the upper critical velocity: {} to {}{unread}",
        shown.number(range.least),
        shown.text(range.most)
    )
}

/// What stands above the names of a falling profile.
fn falling(read: &Read) -> &'static str {
    read.profile.way.of(["", "command falling"])
}

fn points_told(read: &Read, shown: &Display) -> String {
    let seconds = Display::new("", 1.0);
    let headings = ["point", falling(read), &format!("{}, {}", read.names[0], shown.unit), "at s", ""];
    let mut table = Table::with(headings.map(str::to_owned));
    let names = read.profile.way.points();
    for (index, point) in read.profile.points.iter().enumerate() {
        let [command, time, remark] = match point {
            Ok(point) => [shown.number(point.command), seconds.number(point.time), read.remark(index, point)],
            Err(why) => [String::new(), String::new(), format!("none: {why}")],
        };
        table.row([(index + 1).to_string(), names[index].to_owned(), command, time, remark]);
    }
    table.text()
}

fn sections_told(read: &Read, shown: &Display) -> String {
    let [command, swing] = [&read.names[0], "swing"].map(|what| format!("{what}, {}", shown.unit));
    let headings = ["section", falling(read), &command, "cycles", &swing, "Hz", ""];
    let mut table = Table::with(headings.map(str::to_owned));
    let names = read.profile.way.sections();
    for (index, section) in read.profile.sections.iter().enumerate() {
        let [command, cycles, swing, frequency] =
            section.map_or_else(|_| Default::default(), |section| cells(&section, shown));
        let why = section.err().map_or(String::new(), |why| format!("none: {why}"));
        table.row([
            VelocityProfile::LETTERS[index].to_string(),
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

fn cells(section: &Section, shown: &Display) -> [String; 4] {
    let between =
        |shown: &Display, ends: [f64; 2]| format!("{} to {}", shown.number(ends[0]), shown.number(ends[1]));
    [
        between(shown, section.command),
        section.cycles.to_string(),
        section.swing.map_or(String::new(), |swing| shown.number(swing)),
        section.frequency.map_or(String::new(), |both| between(&Display::new("", 1.0), both)),
    ]
}

pub(super) fn json(read: &Read) -> Value {
    let ProfileCriterion { oscillation, standstill } = read.criterion;
    let VelocityProfile { way, points, sections, jump } = &read.profile;
    let points = points.iter().zip(way.points()).enumerate().map(point_json);
    let sections = sections.iter().zip(way.sections()).zip(VelocityProfile::LETTERS).map(section_json);
    json!({ "profile": {
        "command": read.names[0],
        "velocity": read.names[1],
        "unit": read.unit,
        "threshold": oscillation.threshold,
        "window": oscillation.window,
        "standstill": standstill,
        "way": way.of(["rising", "falling"]),
        "jump": jump,
        "note": read.note,
        "points": points.collect::<Value>(),
        "sections": sections.collect::<Value>(),
        "critical_velocity": read.range.map(range_json),
    }})
}

fn point_json((index, (point, what)): (usize, (&Result<ProfilePoint, Absent>, &str))) -> Value {
    let number = index + 1;
    match point {
        Ok(point) => json!({
            "point": number, "what": what, "there": true,
            "command": point.command, "t": point.time, "coincides": point.coincides,
        }),
        Err(why) => json!({"point": number, "what": what, "there": false, "why": why.to_string()}),
    }
}

fn section_json(((section, what), letter): ((&Result<Section, Absent>, &str), char)) -> Value {
    match section {
        Ok(section) => json!({
            "section": letter, "what": what, "there": true,
            "command": section.command, "t": section.time,
            "cycles": section.cycles, "swing": section.swing, "frequency": section.frequency,
        }),
        Err(why) => json!({"section": letter, "what": what, "there": false, "why": why.to_string()}),
    }
}

fn range_json(range: CriticalInterval) -> Value {
    json!({
        "value": range.value, "least": range.least, "most": range.most,
        "by_threshold": range.by_threshold, "by_window": range.by_window, "overrun": range.overrun,
        "unread": range.unread,
    })
}
