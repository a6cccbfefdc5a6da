//! Files that are written in parts, and published as a whole.

use std::io::{Read, Result, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::SpooledTempFile;

use super::{StagedFile, Target, copy_to_standard_output, copy_to_stream, target_of};

/// Number of bytes for a pipe or a device that stay in memory. If there are more, a temporary file holds them.
const MAX_BYTES_IN_MEMORY: usize = 1 << 20;

/// A file that is written in parts, and that appears under its name only when it is complete.
///
/// It follows the rules of [`write_atomic`](super::write_atomic). A pipe or a device gets all bytes at the end. If the
/// file is dropped without [`commit`](PendingFile::commit), an existing file stays as it was.
///
/// # Examples
///
/// ```
/// use std::io::Write as _;
///
/// use patchcord_core::output::PendingFile;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("trace.csv");
/// let mut file = PendingFile::create(&path)?;
/// file.write_all(b"t,x\n")?;
/// file.write_all(b"0,1\n")?;
/// assert!(!path.exists());
/// file.commit()?;
/// assert_eq!(std::fs::read(&path)?, b"t,x\n0,1\n");
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct PendingFile(Content);

/// The bytes of a pending file, and their destination.
#[derive(Debug)]
enum Content {
    /// A file under a temporary name, next to its final path.
    Staged(StagedFile),
    /// Bytes that are copied at the end.
    Copied {
        /// The bytes so far.
        bytes: SpooledTempFile,
        /// The path of a pipe or a device. `None` for standard output.
        stream: Option<PathBuf>,
    },
}

impl PendingFile {
    /// Begins a file.
    ///
    /// # Errors
    /// If the file system reports an error, or if an existing file is read-only.
    pub fn create(path: impl AsRef<Path>) -> Result<PendingFile> {
        let path = path.as_ref();
        let copied = |stream| Content::Copied { bytes: SpooledTempFile::new(MAX_BYTES_IN_MEMORY), stream };
        let content = match target_of(path)? {
            Target::StandardOutput => copied(None),
            Target::Stream => copied(Some(path.to_owned())),
            Target::File { path, permissions } => Content::Staged(StagedFile::new(path, permissions)?),
        };
        Ok(PendingFile(content))
    }

    /// Publishes the file: flushes it to disk and gives it its name, which replaces an older file in one step.
    ///
    /// # Errors
    /// If the file system reports an error. An existing file is then unchanged.
    pub fn commit(self) -> Result<()> {
        match self.0 {
            Content::Staged(file) => {
                file.temporary.as_file().sync_all()?;
                file.commit()
            }
            Content::Copied { mut bytes, stream } => {
                bytes.rewind()?;
                match stream {
                    Some(path) => copy_to_stream(&path, bytes),
                    None => copy_to_standard_output(bytes),
                }
            }
        }
    }
}

impl Write for PendingFile {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        match &mut self.0 {
            Content::Staged(file) => file.temporary.as_file_mut().write(bytes),
            Content::Copied { bytes: copied, .. } => copied.write(bytes),
        }
    }

    fn flush(&mut self) -> Result<()> {
        match &mut self.0 {
            Content::Staged(file) => file.temporary.as_file_mut().flush(),
            Content::Copied { bytes, .. } => bytes.flush(),
        }
    }
}

/// Reads the bytes written so far, from the position of the file on.
impl Read for PendingFile {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        match &mut self.0 {
            Content::Staged(file) => file.temporary.as_file_mut().read(buffer),
            Content::Copied { bytes, .. } => bytes.read(buffer),
        }
    }
}

impl Seek for PendingFile {
    fn seek(&mut self, position: SeekFrom) -> Result<u64> {
        match &mut self.0 {
            Content::Staged(file) => file.temporary.as_file_mut().seek(position),
            Content::Copied { bytes, .. } => bytes.seek(position),
        }
    }
}
