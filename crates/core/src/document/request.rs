//! Requests of clients: commands as JSON, within limits.

use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};

use super::named_variant::read_variant;

/// Largest number of values in a request, counted by the commas outside of its texts. A value takes up to 100 bytes of memory,
/// also where its text has two bytes, and texts take as much as in the request.
pub const MAX_VALUES: usize = 500_000;

/// A command of a client.
pub trait RequestCommand: DeserializeOwned {
    /// Checks the fields of a command before it is read.
    ///
    /// # Errors
    /// A message if a field exceeds a limit.
    fn check_fields(_fields: &Map<String, Value>) -> Result<(), String> {
        Ok(())
    }
}

/// Commands that are carried out in order, with a number that the response repeats.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, bound(deserialize = "C: RequestCommand"))]
pub struct Request<C> {
    /// The number of the request, chosen by the client.
    pub id: u64,
    /// The commands, each an object with the name under the key "command".
    #[serde(deserialize_with = "commands")]
    pub commands: Vec<C>,
}

/// Reads commands.
///
/// # Errors
/// If a command is unknown, or a field is missing, unknown, of the wrong type or above a limit.
fn commands<'de, C: RequestCommand, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<C>, D::Error> {
    let read = |object| {
        C::check_fields(&object)?;
        read_variant(object, "command")
    };
    let objects = Vec::<Map<String, Value>>::deserialize(deserializer)?;
    objects.into_iter().map(read).collect::<Result<_, _>>().map_err(D::Error::custom)
}

/// Reads a request of at most `max_bytes` bytes and `max_commands` commands.
///
/// # Errors
/// The message if it is not a request, or above a limit.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{RequestCommand, read_request};
///
/// #[derive(serde::Deserialize)]
/// enum Command {
///     Wait { seconds: f64 },
/// }
///
/// impl RequestCommand for Command {}
///
/// let one = r#"{"command": "Wait", "seconds": 0.5}"#;
/// let request = read_request::<Command>(&format!(r#"{{"id": 7, "commands": [{one}]}}"#), 100, 1)?;
/// let Command::Wait { seconds } = request.commands[0];
/// assert_eq!((request.id, seconds), (7, 0.5));
///
/// let refused = read_request::<Command>(&format!(r#"{{"id": 8, "commands": [{one}, {one}]}}"#), 200, 1);
/// assert_eq!(refused.err().ok_or("two commands")?, "a request has at most 1 commands, got 2");
/// # Ok::<(), String>(())
/// ```
pub fn read_request<C: RequestCommand>(
    text: &str,
    max_bytes: usize,
    max_commands: usize,
) -> Result<Request<C>, String> {
    if text.len() > max_bytes {
        return Err(format!("the request has more than {} MB", max_bytes / 1_000_000));
    }
    if commas(text) > MAX_VALUES {
        return Err(format!("the request has more than {MAX_VALUES} values"));
    }
    let request: Request<C> =
        serde_json::from_str(text).map_err(|error| format!("the request cannot be read: {error}"))?;
    if request.commands.len() > max_commands {
        return Err(format!(
            "a request has at most {} commands, got {}",
            max_commands,
            request.commands.len()
        ));
    }
    Ok(request)
}

/// The number of commas outside of texts.
fn commas(json: &str) -> usize {
    let (mut count, mut is_text, mut is_escaped) = (0, false, false);
    for byte in json.bytes() {
        match byte {
            _ if is_escaped => is_escaped = false,
            b'\\' => is_escaped = is_text,
            b'"' => is_text = !is_text,
            b',' if !is_text => count += 1,
            _ => {}
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Deserialize)]
    enum Command {
        Note { text: String },
    }

    impl RequestCommand for Command {}

    /// Reads a request with this text as JSON.
    fn read(text: &str) -> Result<Request<Command>, String> {
        let request = format!(r#"{{"id": 1, "commands": [{{"command": "Note", "text": {text}}}]}}"#);
        read_request(&request, 3_000_000, 1)
    }

    #[test]
    fn values_are_limited_and_commas_in_texts_are_not() {
        let commas = ",".repeat(2 * MAX_VALUES);
        let request = read(&format!(r#""\"{commas}\\""#)).unwrap();
        let Command::Note { text } = &request.commands[0];
        assert_eq!(*text, format!("\"{commas}\\"));
        let numbers = vec!["0"; MAX_VALUES + 2].join(",");
        assert_eq!(read(&format!("[{numbers}]")).unwrap_err(), "the request has more than 500000 values");
    }
}
