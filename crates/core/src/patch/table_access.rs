//! Which files a patch may read as tables.
//!
//! The text of a patch may come from anybody, such as from a page in a browser, and it can name any file. A reader that
//! does not trust the text restricts it to one folder, or permits no files.

use std::path::{Component, Path, PathBuf};

use crate::document::csv_table::CsvFault;

/// Which files a patch may read as tables. A patch keeps it, also when it is edited and read again.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::{Patch, TableAccess};
///
/// let text = r#"{"patchcord": 1, "scales": {"volt": {"per_volt": 1, "unit": "V"}},
///     "drives": {"u": {"kind": "table", "scale": "volt", "points": {"csv": "/etc/passwd"}}}}"#;
/// let patch = Patch::parse_with(TableAccess::Below("patches".into()), "p.json", text)?;
/// let report = Circuit::new(&patch).err().ok_or("the file was read")?;
/// assert!(report.findings.iter().any(|finding| finding.message.contains("is not below the folder")));
/// assert!(patch.table_files().is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TableAccess {
    /// Every regular file. Paths are relative to this folder; an empty path is the working directory.
    Anywhere(PathBuf),
    /// Only regular files below this folder, to which paths are relative. Links are resolved first, so a link to a
    /// file elsewhere is refused.
    Below(PathBuf),
    /// No files.
    None,
}

impl TableAccess {
    /// The access of a patch in a file: every file, with paths relative to its folder.
    pub(super) fn of_file(file: &str) -> TableAccess {
        TableAccess::Anywhere(folder_of(file).to_owned())
    }

    /// The access of a patch that is renamed. If only its own folder decides, that is the folder of the new name.
    pub(super) fn renamed(&self, old: &str, new: &str) -> TableAccess {
        match self {
            TableAccess::Anywhere(_) if folder_of(old) != folder_of(new) => TableAccess::of_file(new),
            _ => self.clone(),
        }
    }

    /// The path to read for the name of a file; `None` if it may not be read. Whether a file outside the folder exists
    /// makes no difference.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::TableAccess;
    ///
    /// let folder = tempfile::tempdir()?;
    /// let access = TableAccess::Below(folder.path().to_owned());
    /// assert_eq!(access.permitted("tasks/spring.json"), Some(folder.path().join("tasks/spring.json")));
    /// assert_eq!(access.permitted("../spring.json"), None);
    /// assert_eq!(TableAccess::None.permitted("spring.json"), None);
    /// # Ok::<(), std::io::Error>(())
    /// ```
    pub fn permitted(&self, name: &str) -> Option<PathBuf> {
        match self {
            TableAccess::Anywhere(folder) => Some(folder.join(name)),
            TableAccess::Below(folder) => {
                let path = folder.join(name);
                is_below(folder, name, &path).then_some(path)
            }
            TableAccess::None => None,
        }
    }

    /// The path of a table to read, for its name in a patch.
    ///
    /// # Errors
    /// The fault if the file may not be read.
    pub(super) fn path(&self, name: &str) -> Result<PathBuf, CsvFault> {
        self.permitted(name).ok_or_else(|| match self {
            TableAccess::None => {
                let hint = "write the points into the patch, such as \"points\": [[0, 0], [1, 50]]";
                CsvFault::new("tables in files cannot be read here", hint)
            }
            TableAccess::Anywhere(_) | TableAccess::Below(_) => outside(name),
        })
    }
}

/// The folder of a file; an empty path if the name has no folder.
pub(super) fn folder_of(file: &str) -> &Path {
    Path::new(file).parent().unwrap_or(Path::new(""))
}

/// Whether a path is below a folder after all links are resolved. A path that cannot be resolved is below the folder if
/// its name does not lead out of it, so that the reader reports the missing file.
fn is_below(folder: &Path, name: &str, path: &Path) -> bool {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match (folder.canonicalize(), path.canonicalize()) {
        (Ok(folder), Ok(path)) => path.starts_with(folder),
        (Ok(_), Err(_)) => stays_inside(Path::new(name)),
        (Err(_), _) => false,
    }
}

/// Whether a relative path never leads out of the folder from which it starts, apart from links.
fn stays_inside(path: &Path) -> bool {
    let mut depth = 0_i64;
    path.components().all(|component| {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => (),
            Component::ParentDir => depth -= 1,
            Component::RootDir | Component::Prefix(_) => return false,
        }
        depth >= 0
    })
}

/// The fault of a file outside the folder.
fn outside(name: &str) -> CsvFault {
    CsvFault::new(
        format!("the file {name} is not below the folder from which tables may be read"),
        "copy the file into the folder of the patch, and name it by its path from there",
    )
}

#[cfg(test)]
mod tests;
