//! Requests of clients: commands as JSON, within limits.

use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};

use super::named_variant::read_variant;

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
