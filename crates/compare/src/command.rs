//! The commands of a client: what a user can do with measured data.
//!
//! A client sends a [`Request`] as JSON, as to the session of a panel. Names of commands and fields are part of the
//! protocol, which docs/panel-protocol.md documents.

use std::collections::BTreeMap;

use patchcord_core::document::{self, RequestCommand};
use serde::Deserialize;
use serde_json::{Map, Value};

/// A request of a comparison.
pub type Request = document::Request<Command>;

impl RequestCommand for Command {}

/// A file that the client has read.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NamedText {
    /// The name of the file, for messages and for the experiment.
    pub name: String,
    /// Its content.
    pub text: String,
}

/// One action of a user.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Command {
    /// Begins a comparison. The answer is the event `columns`.
    Begin {
        /// The patch, with the present values of its parameters.
        patch: NamedText,
        /// The measured data, a CSV file.
        data: NamedText,
    },
    /// Replaces the patch, because it was rewired. The experiment stays, so the answer is that of `compare`.
    Patch {
        /// The name of the file.
        name: String,
        /// The patch, with the present values of its parameters.
        text: String,
    },
    /// Compares the patch with the data. The answers are the events `comparison` and `curves`.
    Compare {
        /// The experiment as a document, without the keys "patch" and "data".
        experiment: Map<String, Value>,
    },
    /// Sets parameters and simulates. The answer is the event `curves`.
    Simulate {
        /// New values by name, in declared units. Other parameters keep their values.
        parameters: BTreeMap<String, f64>,
    },
    /// Fits the parameters of the experiment, from their present values. The answers are the events `fitted` and
    /// `curves`.
    Fit,
    /// Searches for the effects that the patch lacks. The answer is the event `found`, after events `progress` in
    /// partial responses.
    Search {
        /// The seed of the random starts of the fits; 1 if absent.
        seed: Option<u64>,
    },
}
