//! The reference text of a kind: `patchcord elements NAME` prints it, and docs/elements.md contains it.

use super::{Family, Input, Jacks, Kind, REGISTRY, Setting, SettingDefault, SettingQuantity};

/// The reference text of a kind, in parts that a terminal or a document arranges.
///
/// # Examples
///
/// ```
/// use patchcord_core::elements::{Family, KindPage, find};
///
/// let page = KindPage::of(find(Family::Computing, "inverter").expect("an element"));
/// assert_eq!(page.facts[0], ("law", "out = -in".to_owned()));
/// assert_eq!(page.inputs, [["in", "1", "input voltage"]]);
/// assert!(page.markdown().starts_with("### inverter\n"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct KindPage {
    /// Its name in documents.
    pub name: &'static str,
    /// A description in one line.
    pub summary: &'static str,
    /// Pairs of a heading and a text: law, overload, modes, parts (if it needs any), source, symbol.
    pub facts: Vec<(&'static str, String)>,
    /// One row per input, with the headings [`KindPage::INPUTS`].
    pub inputs: Vec<[String; 3]>,
    /// One row per setting, with the headings [`KindPage::SETTINGS`].
    pub settings: Vec<[String; 5]>,
}

impl KindPage {
    /// Headings of the table of inputs.
    pub const INPUTS: [&str; 3] = ["input", "cords", "purpose"];
    /// Headings of the table of settings.
    pub const SETTINGS: [&str; 5] = ["setting", "unit", "default", "range", "effect"];

    /// The reference text of a kind.
    pub fn of(kind: &Kind) -> Self {
        let row = |input: &Input| [input.jack_text(), input.cords_text(), input.description.to_owned()];
        KindPage {
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
        setting.default_text(),
        setting.range_text(),
        setting.description.to_owned(),
    ]
}

/// A Markdown table after an empty line; an empty text if there are no rows.
///
/// # Examples
///
/// ```
/// use patchcord_core::elements::markdown_table;
///
/// let rows = [["|x|".to_owned(), "size".to_owned()]];
/// assert_eq!(markdown_table(["a", "b"], &rows), "\n| a | b |\n|---|---|\n| \\|x\\| | size |\n");
/// assert_eq!(markdown_table(["a"], &[]), "");
/// ```
pub fn markdown_table<const N: usize>(headings: [&str; N], rows: &[[String; N]]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let escaped = |row: &[String; N]| row.clone().map(|cell| cell.replace('|', "\\|"));
    let rows: String = rows.iter().map(|row| line(&escaped(row))).collect();
    format!("\n{}|{}\n{rows}", line(&headings.map(str::to_owned)), "---|".repeat(N))
}

/// The reference text of all kinds as one Markdown document: docs/elements.md.
///
/// # Examples
///
/// ```
/// use patchcord_core::elements::{REGISTRY, reference_page};
///
/// let page = reference_page();
/// assert!(page.starts_with("# Elements and drives\n"));
/// assert!(REGISTRY.iter().all(|kind| page.contains(&format!("\n### {}\n", kind.name))));
/// ```
pub fn reference_page() -> String {
    let sections: String = [(Family::Computing, "Elements"), (Family::Drive, "Drives")]
        .map(|(family, heading)| {
            let kinds: Vec<_> = REGISTRY.iter().filter(|kind| kind.family == family).collect();
            let row = |kind: &&&Kind| [format!("[{0}](#{0})", kind.name), kind.summary.to_owned()];
            let rows: Vec<_> = kinds.iter().map(row).collect();
            let pages: String =
                kinds.iter().map(|kind| format!("\n{}", KindPage::of(kind).markdown())).collect();
            format!("\n## {heading}\n{}{pages}", markdown_table(["kind", "description"], &rows))
        })
        .concat();
    format!(
        "# Elements and drives\n\n\
         This page describes every kind of element that a patch can contain. `patchcord elements NAME` prints the same \
         text for one kind. Laws are in volts of the machine. Amplifiers are limited to ±100 V. \
         `docs/patch-format.md` describes the notation of cords and settings.\n\
         {sections}\n\
         This page is generated from the table of elements by `PATCHCORD_BLESS=1 cargo test -p patchcord docs`.\n"
    )
}

impl Family {
    /// The section of a document in which kinds of this family occur.
    pub fn section(self) -> &'static str {
        match self {
            Family::Computing => "elements",
            Family::Drive => "drives",
            Family::Reference => "cords",
        }
    }
}

impl Input {
    /// The names of its jacks: "in", or "x1, x10, ..." for inputs with gains.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::elements::{Input, Jacks};
    ///
    /// assert_eq!(Input::gains("x", "summing inputs").jack_text(), "x1, x10, ...");
    /// assert_eq!(Input::jack("in", "input voltage").jacks(Jacks::Exactly(2)).cords_text(), "2");
    /// ```
    pub fn jack_text(&self) -> String {
        match self.jacks {
            Jacks::Gains => format!("{0}1, {0}10, ...", self.name),
            _ => self.name.to_owned(),
        }
    }

    /// The number of cords in words.
    pub fn cords_text(&self) -> String {
        let count = match self.jacks {
            Jacks::One => "1".to_owned(),
            Jacks::Exactly(count) => count.to_string(),
            Jacks::Any | Jacks::Gains => "any number".to_owned(),
        };
        if self.required { count } else { format!("{count}, or none") }
    }
}

impl Setting {
    /// The default in words.
    pub fn default_text(&self) -> String {
        match (self.default, self.quantity) {
            (SettingDefault::Required, _) => "must be given".to_owned(),
            (SettingDefault::Absent, _) => "none".to_owned(),
            (SettingDefault::Number(number), SettingQuantity::Flag) => (number != 0.0).to_string(),
            (SettingDefault::Number(index), SettingQuantity::Choice(words)) => {
                words[index as usize].to_owned()
            }
            (SettingDefault::Number(number), _) => number.to_string(),
        }
    }

    /// The permitted values in words.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::elements::{Setting, SettingQuantity};
    ///
    /// let initial = Setting::preset("initial", SettingQuantity::Volts, 0.0, "output in initial condition");
    /// assert_eq!((initial.range_text(), initial.default_text()), ("-100 ... 100".to_owned(), "0".to_owned()));
    /// ```
    pub fn range_text(&self) -> String {
        match self.quantity {
            SettingQuantity::Flag => String::new(),
            SettingQuantity::Choice(words) => words.join(", "),
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
    fn a_page_contains_everything_in_the_row() {
        for kind in REGISTRY {
            let text = KindPage::of(kind).markdown();
            let facts = [kind.summary, kind.law, kind.overload, kind.modes, kind.source, kind.symbol];
            let inputs = kind.inputs.iter().flat_map(|input| [input.name, input.description]);
            let settings = kind.settings.iter().flat_map(|setting| [setting.name, setting.description]);
            for text_part in facts.into_iter().chain(inputs).chain(settings) {
                assert!(text.contains(text_part), "{}: {text_part}", kind.name);
            }
        }
    }

    #[test]
    fn bars_within_cells_stay_in_their_cells() {
        let rows = [["|x|".to_owned(), "size".to_owned()]];
        assert_eq!(markdown_table(["a", "b"], &rows), "\n| a | b |\n|---|---|\n| \\|x\\| | size |\n");
    }
}
