//! The library of effects: the shipped effects, and those of a user's folder.
//!
//! The shipped files are part of the program, so that it needs no folder at run time. A file in a user's folder
//! replaces a shipped effect of the same name. Its forms are also wired into an example patch at once, so that faults
//! are reported with their position in the file.

use std::path::{Path, PathBuf};

use indexmap::IndexMap;

use crate::effects::{Effect, wiring_check};
use patchcord_core::document::{DocumentError, Report, read_text};
use patchcord_core::output::io_reason;

/// The files of `patches/effects`: name and text. The build script writes the list.
static SHIPPED: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/effects.rs"));

/// A set of effects with unique names.
///
/// # Examples
///
/// ```
/// use patchcord_ident::Library;
///
/// let library = Library::shipped();
/// let is_friction = |name: &&str| name.contains("friction");
/// let frictions: Vec<&str> = library.iter().map(|effect| effect.name.as_str()).filter(is_friction).collect();
/// assert!(frictions.contains(&"coulomb-friction") && frictions.contains(&"viscous-friction"));
/// assert!(Library::default().iter().next().is_none());
/// ```
#[derive(Debug, Clone, Default)]
pub struct Library {
    /// The effects by name, in the order of listings.
    effects: IndexMap<String, Effect>,
    /// Warnings about the files of a folder.
    notes: Vec<String>,
    /// The files that were read from folders.
    files: Vec<PathBuf>,
}

/// Why the effects of a folder cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EffectError {
    /// The folder cannot be read.
    #[error("cannot read {folder}: {}", io_reason(source))]
    Folder {
        /// The folder.
        folder: String,
        /// The error of the file system.
        source: std::io::Error,
    },
    /// A file in the folder cannot be read.
    #[error(transparent)]
    File(DocumentError),
    /// The path is a file instead of a folder.
    #[error("{file} is a file: name the folder that it is in; all effects in that folder are read")]
    NotAFolder {
        /// The file.
        file: String,
    },
    /// The folder has no `.json` file.
    #[error("there is no effect in {folder}: effects are files whose names end in .json")]
    EmptyFolder {
        /// The folder.
        folder: String,
    },
    /// Some files are not valid effects. There is a report for each.
    #[error("{}", .0.iter().map(Report::to_string).collect::<String>())]
    Invalid(Vec<Report>),
}

impl Library {
    /// The effects that are part of the program.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_ident::Library;
    ///
    /// let library = Library::shipped();
    /// let friction = library.get("viscous-friction").ok_or("a shipped effect")?;
    /// assert_eq!((friction.law.as_str(), friction.title.as_str()), ("F = c v", "Viscous friction"));
    /// assert!(library.get("phlogiston").is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn shipped() -> Library {
        let mut library = Library::default();
        for (file, text) in SHIPPED {
            let effect = Effect::parse(&format!("patches/effects/{file}"), text);
            library.add(
                effect.unwrap_or_else(|report| unreachable!("tests check all shipped effects: {report}")),
            );
        }
        library
    }

    /// Adds every `.json` file of a folder, in the order of the names. An effect replaces one that has the same name.
    ///
    /// # Errors
    /// If the folder or a file in it cannot be read, the folder has no effect, or files in it are not valid
    /// effects. The last error lists all of these files.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_ident::Library;
    ///
    /// let folder = tempfile::tempdir()?;
    /// let error = Library::shipped().with_folder(folder.path()).err().ok_or("the folder is empty")?;
    /// assert!(error.to_string().ends_with("effects are files whose names end in .json"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_folder(mut self, folder: impl AsRef<Path>) -> Result<Library, EffectError> {
        let folder = folder.as_ref();
        let unreadable = |source| EffectError::Folder { folder: folder.display().to_string(), source };
        if folder.is_file() {
            return Err(EffectError::NotAFolder { file: folder.display().to_string() });
        }
        let entries = std::fs::read_dir(folder).map_err(unreadable)?;
        let files: Result<Vec<_>, _> = entries.map(|entry| entry.map(|entry| entry.path())).collect();
        let mut files = files.map_err(unreadable)?;
        files.retain(|file| file.extension().is_some_and(|extension| extension == "json"));
        if files.is_empty() {
            return Err(EffectError::EmptyFolder { folder: folder.display().to_string() });
        }
        files.sort();
        let mut reports = Vec::new();
        for file in files {
            let name = file.display().to_string();
            match read_and_wire(&file, &name).map(|effect| self.add(effect)) {
                Ok(None) => (),
                Ok(Some(_)) => self.notes.push(format!("{name} replaces the shipped effect of that name")),
                Err(DocumentError::Text(report)) => reports.push(*report),
                Err(error) => return Err(EffectError::File(error)),
            }
            self.files.push(file);
        }
        if !reports.is_empty() {
            return Err(EffectError::Invalid(reports));
        }
        self.notes.extend(self.unknown_aliases());
        Ok(self)
    }

    /// Adds an effect and returns the one that it replaces.
    fn add(&mut self, effect: Effect) -> Option<Effect> {
        self.effects.insert(effect.name.clone(), effect)
    }

    /// A note for every alias that names no effect of the library.
    fn unknown_aliases(&self) -> Vec<String> {
        let pairs =
            self.iter().flat_map(|effect| effect.aliases.keys().map(move |alias| (&effect.name, alias)));
        let unknown = pairs.filter(|(_, alias)| self.get(alias).is_none());
        unknown.map(|(name, alias)| format!("{name} has the alias {alias}, which is not an effect")).collect()
    }

    /// Warnings about the files of a folder: shipped effects that were replaced, and aliases that name no effect.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The files that [`Library::with_folder`] has read, in the order of reading.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// All effects: the shipped ones in the order of their names, then the added ones in the order of theirs.
    pub fn iter(&self) -> impl Iterator<Item = &Effect> {
        self.effects.values()
    }

    /// The effect with this name.
    pub fn get(&self, name: &str) -> Option<&Effect> {
        self.effects.get(name)
    }
}

/// Reads an effect from a file and wires it into the example patch. Reports name the file as `name`.
///
/// The two steps find different faults: the first those of the document, the second those of the wiring.
fn read_and_wire(file: &Path, name: &str) -> Result<Effect, DocumentError> {
    let text = read_text(file)?;
    let effect = Effect::parse(name, &text)?;
    wiring_check::check(name, &text, &effect)?;
    Ok(effect)
}
