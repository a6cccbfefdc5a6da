//! The effects that are known: those of the program, and those of a folder.

use std::path::Path;

use indexmap::IndexMap;

use crate::effects::{Effect, trial_patch};
use patchcord_core::document::Report;
use patchcord_core::output::refusal;

/// The files of `patches/effects`: name and text.
static SHIPPED: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/effects.rs"));

/// Effects by name.
#[derive(Debug, Clone, Default)]
pub struct Library {
    effects: IndexMap<String, Effect>,
    /// What is odd about the files of a folder, in words.
    notes: Vec<String>,
}

/// Why effects could not be read.
#[derive(Debug, thiserror::Error)]
pub enum EffectError {
    /// The file system refused.
    #[error("cannot read {file}: {}", refusal(source))]
    File {
        /// The file or folder.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file was named, where folders are taken.
    #[error(
        "{file} is a file: name the folder that it is in, and what other effects are in there will be taken, too"
    )]
    NoFolder {
        /// The file.
        file: String,
    },
    /// There is none in a folder.
    #[error("there is no effect in {folder}: effects are files whose names end in .json")]
    None {
        /// The folder.
        folder: String,
    },
    /// Files are no effects: what is wrong with each.
    #[error("{}", .0.iter().map(Report::to_string).collect::<String>())]
    Wrong(Vec<Report>),
}

impl Library {
    /// The effects that are part of the program.
    pub fn shipped() -> Library {
        let mut library = Library::default();
        for (file, text) in SHIPPED {
            let effect = Effect::parse(&format!("patches/effects/{file}"), text);
            library
                .add(effect.unwrap_or_else(|report| {
                    unreachable!("what is part of the program is tested: {report}")
                }));
        }
        library
    }

    /// The same with every `.json` file of a folder, in the order of their names; one that has the name of another takes
    /// its place.
    ///
    /// # Errors
    /// When the folder or a file in it cannot be read, or files in it are no effects: all of them at once.
    pub fn and_folder(mut self, folder: &Path) -> Result<Library, EffectError> {
        let refused = |path: &Path, source| EffectError::File { file: path.display().to_string(), source };
        if folder.is_file() {
            return Err(EffectError::NoFolder { file: folder.display().to_string() });
        }
        let entries = std::fs::read_dir(folder).map_err(|source| refused(folder, source))?;
        let files: Result<Vec<_>, _> = entries.map(|entry| entry.map(|entry| entry.path())).collect();
        let mut files = files.map_err(|source| refused(folder, source))?;
        files.retain(|file| file.extension().is_some_and(|ending| ending == "json"));
        if files.is_empty() {
            return Err(EffectError::None { folder: folder.display().to_string() });
        }
        files.sort();
        let mut wrong = Vec::new();
        for file in files {
            let text = std::fs::read_to_string(&file).map_err(|source| refused(&file, source))?;
            let name = file.display().to_string();
            match own(&name, &text).map(|effect| self.add(effect)) {
                Ok(None) => (),
                Ok(Some(_)) => self.notes.push(format!(
                    "{name} takes the place of the effect of that name that comes with the program"
                )),
                Err(report) => wrong.push(*report),
            }
        }
        if !wrong.is_empty() {
            return Err(EffectError::Wrong(wrong));
        }
        self.notes.extend(self.unknown_aliases());
        Ok(self)
    }

    /// Adds an effect; gives back the one whose place it takes.
    fn add(&mut self, effect: Effect) -> Option<Effect> {
        self.effects.insert(effect.name.clone(), effect)
    }

    /// Aliases that are no effects.
    fn unknown_aliases(&self) -> Vec<String> {
        let named = self.iter().flat_map(|own| own.aliases.keys().map(move |alias| (&own.name, alias)));
        let unknown = named.filter(|(_, alias)| self.get(alias).is_none());
        unknown.map(|(name, alias)| format!("{name} has the alias {alias}, which is no effect")).collect()
    }

    /// What is odd about the files of a folder, in words: those that take the place of effects of the program, and aliases
    /// that are no effects.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Every effect: those of the program, then those of a folder that it has not, either in the order of their names.
    pub fn iter(&self) -> impl Iterator<Item = &Effect> {
        self.effects.values()
    }

    /// An effect by name.
    pub fn get(&self, name: &str) -> Option<&Effect> {
        self.effects.get(name)
    }
}

/// An effect of one's own, which must not only be read but wired, too.
fn own(name: &str, text: &str) -> Result<Effect, Box<Report>> {
    let effect = Effect::parse(name, text)?;
    trial_patch::check(name, text, &effect)?;
    Ok(effect)
}
