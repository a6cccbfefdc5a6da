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
    /// How far point 5 depends on the criterion.
    pub range: Option<CriticalInterval>,
}

const POINTS: [&str; 5] =
    ["breaks away", "oscillation begins", "stick-slip begins", "stick-slip ends", "oscillation ends"];

const SECTIONS: [&str; 4] = ["smooth sliding", "oscillation grows", "stick-slip", "oscillation dies away"];

const LETTERS: [&str; 4] = ["A", "B", "C", "D"];

impl Read {
    /// How values are shown: all in the same prefixed unit.
    fn shown(&self) -> Display {
        let largest = self.values.iter().flatten().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        Display::new(&self.unit, largest)
    }

    /// What there is to say of a point.
    fn remark(&self, index: usize, point: &ProfilePoint) -> String {
        let shown = self.shown();
        let remark = match (index, self.profile.jump, self.range) {
            (0, Some(jump), _) => format!("the velocity jumps to {}", shown.text(jump)),
            (1, ..) => "the lower critical velocity".to_owned(),
            (2, ..) => "from here on its cycles come down to standstill".to_owned(),
            (3, ..) => "from here on it oscillates without standstill".to_owned(),
            (4, _, Some(range)) => range_told(range, &shown),
            _ => String::new(),
        };
        let coincides =
            point.coincides.map_or(String::new(), |other| format!("; coincides with point {other}"));
        remark + &coincides
    }
}

pub(super) fn told(read: &Read) -> String {
    let shown = read.shown();
    let criterion = read.criterion;
    let seconds = Display::new("", 1.0);
    format!(
        "{}\n{}\nIt oscillates: {} swings by more than {}, peak to peak, within {} s. Standstill: up to {}.\n",
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

fn points_told(read: &Read, shown: &Display) -> String {
    let seconds = Display::new("", 1.0);
    let headings = ["point", "", &format!("{}, {}", read.names[0], shown.unit), "at s", ""];
    let mut table = Table::with(headings.map(str::to_owned));
    for (index, point) in read.profile.points.iter().enumerate() {
        let [command, time, remark] = match point {
            Ok(point) => [shown.number(point.command), seconds.number(point.time), read.remark(index, point)],
            Err(why) => [String::new(), String::new(), format!("none: {why}")],
        };
        table.row([(index + 1).to_string(), POINTS[index].to_owned(), command, time, remark]);
    }
    table.text()
}

fn sections_told(read: &Read, shown: &Display) -> String {
    let [command, swing] = [&read.names[0], "swing"].map(|what| format!("{what}, {}", shown.unit));
    let headings = ["section", "", &command, "cycles", &swing, "Hz", ""];
    let mut table = Table::with(headings.map(str::to_owned));
    for (index, section) in read.profile.sections.iter().enumerate() {
        let [command, cycles, swing, frequency] =
            section.map_or_else(|_| Default::default(), |section| cells(&section, shown));
        let why = section.err().map_or(String::new(), |why| format!("none: {why}"));
        table.row([
            LETTERS[index].to_owned(),
            SECTIONS[index].to_owned(),
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
    let points = read.profile.points.iter().enumerate().map(|(index, point)| point_json(index, point));
    let sections =
        read.profile.sections.iter().enumerate().map(|(index, section)| section_json(index, section));
    json!({ "profile": {
        "command": read.names[0],
        "velocity": read.names[1],
        "unit": read.unit,
        "threshold": oscillation.threshold,
        "window": oscillation.window,
        "standstill": standstill,
        "jump": read.profile.jump,
        "points": points.collect::<Value>(),
        "sections": sections.collect::<Value>(),
        "critical_velocity": read.range.map(range_json),
    }})
}

fn point_json(index: usize, point: &Result<ProfilePoint, Absent>) -> Value {
    let (number, what) = (index + 1, POINTS[index]);
    match point {
        Ok(point) => json!({
            "point": number, "what": what, "there": true,
            "command": point.command, "t": point.time, "coincides": point.coincides,
        }),
        Err(why) => json!({"point": number, "what": what, "there": false, "why": why.to_string()}),
    }
}

fn section_json(index: usize, section: &Result<Section, Absent>) -> Value {
    let (letter, what) = (LETTERS[index], SECTIONS[index]);
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
