//! Runs the command with limits of time and memory.

use std::fs::File;
use std::io::{self, Read as _, Seek as _};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// The longest time of a command in seconds of the processor, which do not depend on what else the machine does.
pub(crate) const TIME_LIMIT: u32 = 20;
/// The longest time of a command that waits for something.
const WAITING_LIMIT: Duration = Duration::from_secs(120);
/// The largest memory of a command, in units of 1024 bytes: 1 GB.
const MEMORY_LIMIT: u32 = 1 << 20;
/// The time between two looks at a running command.
const INTERVAL: Duration = Duration::from_millis(1);

/// The answer of a command.
pub(crate) struct Answer {
    /// The exit code. `None` if a signal or the limit of time has ended the command.
    pub code: Option<i32>,
    /// Whether the limit of time has ended the command.
    pub is_late: bool,
    /// Standard output.
    pub output: Vec<u8>,
    /// Standard error.
    pub errors: Vec<u8>,
    /// The time that the command took.
    pub time: Duration,
}

/// Runs the command in a folder.
///
/// # Errors
/// If the system cannot start it, or refuses its arguments.
pub(crate) fn run(folder: &Path, arguments: &[String]) -> io::Result<Answer> {
    let (output, errors) = (tempfile::tempfile()?, tempfile::tempfile()?);
    let start = Instant::now();
    let mut child = limited_command()
        .args(arguments)
        .current_dir(folder)
        // Each thread of the C library would otherwise reserve an address range of its own.
        .env("MALLOC_ARENA_MAX", "2")
        .env_remove("RUST_BACKTRACE")
        .stdin(Stdio::null())
        .stdout(output.try_clone()?)
        .stderr(errors.try_clone()?)
        .spawn()?;
    let status = wait(&mut child, start)?;
    Ok(Answer {
        code: status.and_then(|status| status.code()),
        is_late: status.is_none_or(is_out_of_time),
        output: contents(output)?,
        errors: contents(errors)?,
        time: start.elapsed(),
    })
}

/// The command, started by a shell that limits its time and its memory.
fn limited_command() -> Command {
    // Systems without such a limit run the command without it.
    let script = format!(
        "ulimit -t {TIME_LIMIT} 2>/dev/null; ulimit -v {MEMORY_LIMIT} 2>/dev/null; exec \"$0\" \"$@\""
    );
    let mut command = Command::new("sh");
    command.args(["-c", script.as_str(), env!("CARGO_BIN_EXE_patchcord")]);
    command
}

/// Whether a command was ended because of its limit of processor time.
#[cfg(unix)]
fn is_out_of_time(status: ExitStatus) -> bool {
    use std::os::unix::process::ExitStatusExt as _;
    // SIGXCPU, then SIGKILL a second later.
    matches!(status.signal(), Some(9 | 24))
}

#[cfg(not(unix))]
fn is_out_of_time(_: ExitStatus) -> bool {
    false
}

/// Waits for the end of a command. `None` if it was ended because it waited too long.
fn wait(child: &mut Child, start: Instant) -> io::Result<Option<ExitStatus>> {
    while start.elapsed() < WAITING_LIMIT {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        thread::sleep(INTERVAL);
    }
    child.kill()?;
    child.wait()?;
    Ok(None)
}

/// The contents of a file from its beginning.
fn contents(mut file: File) -> io::Result<Vec<u8>> {
    file.rewind()?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}
