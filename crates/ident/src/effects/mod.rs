//! Effects that a patch may lack: the library, the sites at which they attach, and the patch with one wired in.

pub mod attach;
pub mod candidate;
pub mod effect;
pub mod graft;
pub(crate) mod library;
pub mod places;
pub mod reach;
pub(crate) mod reader;
pub mod sites;
pub(crate) mod trial_patch;

pub use effect::{Attachment, Effect, EffectParameter, Form, Gives, Reads, Start};
pub use library::{EffectError, Library};
