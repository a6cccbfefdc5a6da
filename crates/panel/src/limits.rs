//! Limits of a session, so that no client can use up the computer of its host.
//!
//! They are far above what the page and the shipped patches need. Whatever exceeds them is refused with a message.

pub use patchcord_core::document::MAX_VALUES;
use patchcord_core::document::{format_distinct, format_number, format_outside};
use patchcord_core::patch::{Amount, Patch};
use patchcord_core::solve::{RunError, RunSettings};

/// Size of the largest request in bytes. A snapshot has the texts of the history, and JSON needs two bytes for each of
/// their quotes and line ends.
pub const MAX_REQUEST_BYTES: usize = 12_000_000;
/// Largest number of commands of a request.
pub const MAX_COMMANDS: usize = 100;
/// Largest number of characters of a name in a command. The name of an element inside instances of macros has the names
/// of the instances in front.
pub const MAX_NAME_CHARACTERS: usize = 1000;
/// Size of the longest text of a patch in bytes.
pub const MAX_PATCH_BYTES: usize = 1_000_000;
/// Largest number of elements, drives and outputs of instances of a patch, after macros are expanded.
pub const MAX_ELEMENTS: usize = 2000;
/// Largest number of cords into the elements of a patch, after macros are expanded.
pub const MAX_CORDS: usize = 20_000;
/// Largest number of points of all tables and curves of a patch.
pub const MAX_POINTS: usize = 1_000_000;
/// Largest number of loose cords.
pub const MAX_LOOSE_CORDS: usize = 200;
/// Largest number of findings that an event lists.
pub const MAX_FINDINGS: usize = 200;
/// Size of the largest table of a run in bytes.
pub const MAX_TABLE_BYTES: usize = 50_000_000;
/// Largest number of numbers in the table of a run. Most numbers have at most 20 characters.
const MAX_TABLE_NUMBERS: f64 = 2.5e6;
/// Largest number of steps of a run for a table.
const MAX_RUN_STEPS: f64 = 2e7;
/// Largest number of steps times elements of a run for a table. Each takes the interpreter up to 10 ns, so that a run takes
/// some seconds.
const MAX_RUN_WORK: f64 = 4e8;
/// Size of the largest past that the delays of a machine may store, in bytes.
pub const MAX_DELAY_BYTES: usize = 50_000_000;
/// Size of all checkpoints of a run in bytes, above which some of them are dropped.
pub const MAX_CHECKPOINT_BYTES: usize = 32_000_000;

/// Checks that a number that a client gives is in a range. `what` is the subject of the message.
///
/// # Errors
/// The message if it is not.
pub(crate) fn check_range(what: &str, number: f64, [least, most]: [f64; 2]) -> Result<(), String> {
    if (least..=most).contains(&number) {
        return Ok(());
    }
    let number = format_outside(number, (least, most));
    Err(format!("{what} must be from {} to {}, not {number}", format_number(least), format_number(most)))
}

/// Checks the size of the text of a patch.
///
/// # Errors
/// The message if it is too long.
pub(crate) fn check_text(text: &str) -> Result<(), String> {
    if text.len() <= MAX_PATCH_BYTES {
        return Ok(());
    }
    let limit = MAX_PATCH_BYTES / 1_000_000;
    Err(format!("the patch would have more than {limit} MB: use shorter tables, or tables in files"))
}

/// Checks the size of a patch after its macros were expanded and its tables were read.
///
/// # Errors
/// The message if it has too many elements, cords or points.
pub(crate) fn check_patch(patch: &Patch) -> Result<(), String> {
    let entries = || patch.elements.values().chain(patch.drives.values());
    let ports = patch.instances.values().map(|instance| 1 + instance.outputs.len());
    let elements = entries().count() + ports.sum::<usize>();
    check_count(elements, MAX_ELEMENTS, "elements and outputs of instances")?;
    check_count(entries().map(|entry| entry.plugs.len()).sum(), MAX_CORDS, "cords")?;
    let points =
        entries().flat_map(|entry| entry.settings.iter().flatten()).map(|setting| match &setting.value {
            Amount::Points(points) => points.len(),
            _ => 0,
        });
    check_count(points.sum(), MAX_POINTS, "points in tables")
}

/// Checks that a patch does not have too many parts of a sort.
///
/// # Errors
/// The message if it does.
fn check_count(count: usize, limit: usize, noun: &str) -> Result<(), String> {
    if count <= limit {
        return Ok(());
    }
    Err(format!("the patch has {count} {noun}, and the panel takes {limit}: run it with patchcord run"))
}

/// Limits the steps of a run for a table of this number of elements.
///
/// # Errors
/// The message if it has too many samples.
pub(crate) fn limit_run(settings: &mut RunSettings, elements: usize) -> Result<(), String> {
    settings.max_steps = MAX_RUN_STEPS.min((MAX_RUN_WORK / elements.max(1) as f64).floor());
    if settings.recorded_numbers() > MAX_TABLE_NUMBERS { Err(table_too_large()) } else { Ok(()) }
}

/// The message about an error of a run for a table.
pub(crate) fn run_message(error: &RunError) -> String {
    match error {
        RunError::TooManySteps { steps, max } => {
            let [steps, max] = [format_distinct(*steps, *max), format_distinct(*max, *steps)];
            format!("the run would take {steps} steps, and the panel takes {max}: use patchcord run")
        }
        _ => error.to_string(),
    }
}

/// The message about a table that is too large.
pub(crate) fn table_too_large() -> String {
    let limit = MAX_TABLE_BYTES / 1_000_000;
    format!(
        "the table of the run would have more than {limit} MB: record fewer signals, or use patchcord run"
    )
}
