//! What a reader is told of a kind: its page on the terminal and its part of docs/elements.md.

use super::{Default, Family, Input, Jacks, Kind, Measure, REGISTRY, Setting};

/// A kind's page in words, for a terminal or a document to lay out.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Name in documents.
    pub name: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    /// What is said of it as a whole: law, overload, modes, parts if it takes any, source, symbol.
    pub facts: Vec<(&'static str, String)>,
    /// A row an input, under [`Page::INPUTS`].
    pub inputs: Vec<[String; 3]>,
    /// A row a setting, under [`Page::SETTINGS`].
    pub settings: Vec<[String; 5]>,
}

impl Page {
    /// Headings of the inputs.
    pub const INPUTS: [&str; 3] = ["input", "cords", "what it is for"];
    /// Headings of the settings.
    pub const SETTINGS: [&str; 5] = ["setting", "unit", "default", "range", "what it does"];

    /// The page of a kind.
    pub fn of(kind: &Kind) -> Self {
        let row = |input: &Input| [input.jack_told(), input.cords_told(), input.description.to_owned()];
        Page {
            name: kind.name,
            summary: kind.summary,
            facts: facts(kind),
            inputs: kind.inputs.iter().map(row).collect(),
            settings: kind.settings.iter().map(setting_row).collect(),
        }
    }

    /// The page as a section of a Markdown document.
    pub fn markdown(&self) -> String {
        let facts: String = self.facts.iter().map(|(what, text)| format!("* {what}: {text}\n")).collect();
        let tables =
            [markdown_table(Self::INPUTS, &self.inputs), markdown_table(Self::SETTINGS, &self.settings)];
        format!("### {}\n\n{}.\n\n{facts}{}", self.name, self.summary, tables.concat())
    }
}

fn facts(kind: &Kind) -> Vec<(&'static str, String)> {
    let parts = kind.parts.iter().map(|takes| {
        let with = if takes.with.is_empty() { String::new() } else { format!(" with \"{}\"", takes.with) };
        format!("{}{with}", takes.part.counted(takes.count))
    });
    let facts = [
        ("law", kind.law.to_owned()),
        ("overload", kind.overload.to_owned()),
        ("modes", kind.modes.to_owned()),
        ("parts", parts.collect::<Vec<_>>().join(", ")),
        ("source", kind.source.to_owned()),
        ("symbol", kind.symbol.to_owned()),
    ];
    facts.into_iter().filter(|(_, text)| !text.is_empty()).collect()
}

fn setting_row(setting: &Setting) -> [String; 5] {
    [
        setting.name.to_owned(),
        setting.unit().to_owned(),
        setting.default_told(),
        setting.range_told(),
        setting.description.to_owned(),
    ]
}

/// A Markdown table after an empty line; nothing where there are no rows.
pub fn markdown_table<const N: usize>(headings: [&str; N], rows: &[[String; N]]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let escaped = |row: &[String; N]| row.clone().map(|cell| cell.replace('|', "\\|"));
    let rows: String = rows.iter().map(|row| line(&escaped(row))).collect();
    format!("\n{}|{}\n{rows}", line(&headings.map(str::to_owned)), "---|".repeat(N))
}

/// Every kind's page in one Markdown document: docs/elements.md.
pub fn reference_page() -> String {
    let sections: String = [(Family::Computing, "Elements"), (Family::Drive, "Drives")]
        .map(|(family, heading)| {
            let kinds: Vec<_> = REGISTRY.iter().filter(|kind| kind.family == family).collect();
            let row = |kind: &&&Kind| [format!("[{0}](#{0})", kind.name), kind.summary.to_owned()];
            let rows: Vec<_> = kinds.iter().map(row).collect();
            let pages: String = kinds.iter().map(|kind| format!("\n{}", Page::of(kind).markdown())).collect();
            format!("\n## {heading}\n{}{pages}", markdown_table(["kind", "what it is"], &rows))
        })
        .concat();
    format!(
        "# Elements and drives\n\n\
         Every kind that may stand in a patch, as `patchcord elements NAME` tells of it. Laws are in volts of the \
         machine; `docs/patch-format.md` tells how cords and settings are written. Amplifiers stop at ±100 V.\n\
         {sections}\n\
         This page is written from the table of elements by `PATCHCORD_BLESS=1 cargo test -p patchcord docs`.\n"
    )
}

impl Family {
    /// Where in a document it stands.
    pub fn section(self) -> &'static str {
        match self {
            Family::Computing => "elements",
            Family::Drive => "drives",
            Family::Reference => "cords",
        }
    }
}

impl Input {
    /// Its jacks, as a reader is told of them: "in", "x1, x10, ...".
    pub fn jack_told(&self) -> String {
        match self.jacks {
            Jacks::Gains => format!("{0}1, {0}10, ...", self.name),
            _ => self.name.to_owned(),
        }
    }

    /// How many cords it takes, in words.
    pub fn cords_told(&self) -> String {
        let count = match self.jacks {
            Jacks::One => "1".to_owned(),
            Jacks::Exactly(count) => count.to_string(),
            Jacks::Any | Jacks::Gains => "any number".to_owned(),
        };
        if self.required { count } else { format!("{count}, or none") }
    }
}

impl Setting {
    /// What it is when the patch does not say, in words.
    pub fn default_told(&self) -> String {
        match (self.default, self.measure) {
            (Default::Required, _) => "must be given".to_owned(),
            (Default::Absent, _) => "none".to_owned(),
            (Default::Number(number), Measure::Flag) => (number != 0.0).to_string(),
            (Default::Number(index), Measure::Choice(words)) => words[index as usize].to_owned(),
            (Default::Number(number), _) => number.to_string(),
        }
    }

    /// What it may be, in words.
    pub fn range_told(&self) -> String {
        match self.measure {
            Measure::Flag => String::new(),
            Measure::Choice(words) => words.join(", "),
            _ => match self.range {
                (f64::MIN, f64::MAX) => "any".to_owned(),
                (low, f64::MAX) => format!("{low} or more"),
                (low, high) => format!("{low} ... {high}"),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_tells_everything_in_the_row() {
        for kind in REGISTRY {
            let text = Page::of(kind).markdown();
            let facts = [kind.summary, kind.law, kind.overload, kind.modes, kind.source, kind.symbol];
            let inputs = kind.inputs.iter().flat_map(|input| [input.name, input.description]);
            let settings = kind.settings.iter().flat_map(|setting| [setting.name, setting.description]);
            for told in facts.into_iter().chain(inputs).chain(settings) {
                assert!(text.contains(told), "{}: {told}", kind.name);
            }
        }
    }

    #[test]
    fn bars_within_cells_stay_in_their_cells() {
        let rows = [["|x|".to_owned(), "size".to_owned()]];
        assert_eq!(markdown_table(["a", "b"], &rows), "\n| a | b |\n|---|---|\n| \\|x\\| | size |\n");
    }
}
