//! What all requests share.

use std::path::PathBuf;
use std::sync::Arc;

use crate::browsers::Browsers;
use crate::limits::Limits;
use crate::names::Names;
use crate::service::{Purpose, Service};
use crate::token::Token;

/// The patch that the panel opens first.
#[derive(Debug, Clone)]
pub struct GivenPatch {
    /// Name of its file, without a folder.
    pub name: String,
    /// Its text, which may have faults.
    pub text: String,
}

/// The state of a server.
pub(crate) struct Host {
    /// The names of the server.
    pub names: Names,
    /// The token of its address.
    pub token: Token,
    /// The patch that the panel opens first.
    pub patch: Option<GivenPatch>,
    /// The folder below which workers read patches and tables.
    pub folder: PathBuf,
    /// The limits.
    pub limits: Limits,
    /// The sessions.
    pub sessions: Service,
    /// The comparisons.
    pub comparisons: Service,
    /// The open panels.
    pub browsers: Arc<Browsers>,
}

impl Host {
    /// The service for a purpose.
    pub(crate) fn service(&self, purpose: Purpose) -> &Service {
        match purpose {
            Purpose::Session => &self.sessions,
            Purpose::Comparison => &self.comparisons,
        }
    }
}
