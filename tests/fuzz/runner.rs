//! Runs the command with limits of time and memory.

use std::fs::File;
use std::io::{self, Read as _, Seek as _};
use std::path::Path;
use std::process::{Child, Command, ExitStatus};
use std::thread;
use std::time::{Duration, Instant};

use super::case::Case;

/// The longest time of a command in seconds of the processor, which do not depend on what else the machine does.
const PROCESSOR_LIMIT: u32 = 20;
/// The time in seconds of the processor after which the system ends a command that ignores the first limit.
const FINAL_PROCESSOR_LIMIT: u32 = PROCESSOR_LIMIT + 2;
/// The longest time of a command that waits for something, in seconds.
const WAITING_LIMIT: u64 = 120;
/// The largest memory of a command, in units of 1024 bytes: 1 GB.
const MEMORY_LIMIT: u32 = 1 << 20;
/// The time between two looks at a running command.
const INTERVAL: Duration = Duration::from_millis(1);

/// A limit of time that ended a command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum TimeLimit {
    /// The limit of the time of the processor.
    Processor,
    /// The limit of the time that passes.
    Waiting,
}

impl TimeLimit {
    /// What a command does that breaks the limit.
    pub(crate) fn violation(self) -> String {
        match self {
            TimeLimit::Processor => format!("needs more than {PROCESSOR_LIMIT} s of processor time"),
            TimeLimit::Waiting => format!("waits longer than {WAITING_LIMIT} s"),
        }
    }
}

/// The answer of a command.
pub(crate) struct Answer {
    /// The exit code. `None` if a signal or a limit of time has ended the command.
    pub code: Option<i32>,
    /// The limit of time that has ended the command. `None` if it ended otherwise.
    pub broken_limit: Option<TimeLimit>,
    /// Standard output. Empty if it was not kept.
    pub output: Vec<u8>,
    /// Standard error.
    pub errors: Vec<u8>,
    /// The time that the command took.
    pub time: Duration,
}

/// Runs the command of a case in a folder with its files.
///
/// # Errors
/// If the system cannot start it, refuses its arguments, or does not have its streams.
///
/// # Panics
/// If the system fails otherwise.
pub(crate) fn run(folder: &Path, case: &Case) -> io::Result<Answer> {
    let [output, errors] = [(); 2].map(|()| tempfile::tempfile().unwrap());
    let start = Instant::now();
    let mut child = limited_command()
        .args(&case.arguments)
        .current_dir(folder)
        // Each thread of the C library would otherwise reserve an address range of its own.
        .env("MALLOC_ARENA_MAX", "2")
        .env_remove("RUST_BACKTRACE")
        // A line about the progress is no message about an error.
        .env("PATCHCORD_PROGRESS", "0")
        .stdin(case.input.stdio(folder)?)
        .stdout(case.output.stdio(&output)?)
        .stderr(errors.try_clone().unwrap())
        .spawn()?;
    let status = wait(&mut child, start).unwrap();
    let broken_limit = match status {
        None => Some(TimeLimit::Waiting),
        Some(status) => is_out_of_time(status).then_some(TimeLimit::Processor),
    };
    Ok(Answer {
        code: status.and_then(|status| status.code()),
        broken_limit,
        output: contents(output).unwrap(),
        errors: contents(errors).unwrap(),
        time: start.elapsed(),
    })
}

/// The command, started by a shell that limits its time and its memory.
fn limited_command() -> Command {
    // Systems without such a limit run the command without it. The first limit of time sends a signal of its own, so a
    // command that is ended for lack of memory is not confused with a late one.
    let limits = [
        format!("-S -t {PROCESSOR_LIMIT}"),
        format!("-H -t {FINAL_PROCESSOR_LIMIT}"),
        format!("-v {MEMORY_LIMIT}"),
    ];
    let limits = limits.map(|limit| format!("ulimit {limit} 2>/dev/null; ")).concat();
    let script = format!("{limits}exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", script.as_str(), env!("CARGO_BIN_EXE_patchcord")]);
    command
}

/// Whether a command was ended because of its limit of processor time.
#[cfg(unix)]
fn is_out_of_time(status: ExitStatus) -> bool {
    use std::os::unix::process::ExitStatusExt as _;
    // The signal SIGXCPU. The system also sends signal 9 to a process that needs too much memory.
    status.signal() == Some(24)
}

#[cfg(not(unix))]
fn is_out_of_time(_: ExitStatus) -> bool {
    false
}

/// Waits for the end of a command. `None` if it was ended because it waited too long.
fn wait(child: &mut Child, start: Instant) -> io::Result<Option<ExitStatus>> {
    while start.elapsed() < Duration::from_secs(WAITING_LIMIT) {
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
