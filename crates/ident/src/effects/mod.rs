//! Effects that a patch may lack: the library, the sites at which they attach, and the patch extended by one.
//!
//! `library` holds the effects, which `reader` reads from documents into an [`Effect`]. `wiring_check` checks the
//! effects of a user's folder. `sites` finds the sites of a circuit and `attach` lists the placements of an effect at
//! these sites. `reach` evaluates the natural size of each parameter at a site. `candidate` prepares one placement for
//! fitting and `graft` writes the extended patch.
//!
//! The way of an effect through these modules, with the types: document, [`Effect`],
//! [`EffectPlacement`](attach::EffectPlacement) at a site of [`Sites`](sites::Sites),
//! [`Candidate`](candidate::Candidate) with a [`Graft`](graft::Graft). A search fits the patch of the graft like any
//! other patch.

pub mod attach;
pub mod candidate;
pub mod effect;
pub mod effect_sites;
pub mod graft;
pub(crate) mod library;
pub mod placed_effect;
pub mod reach;
pub(crate) mod reader;
pub mod sites;
pub(crate) mod unused_names;
pub(crate) mod wiring_check;

pub use effect::{Attachment, Effect, EffectParameter, Form, InputRole, OutputRole, StartRule};
pub use library::{EffectError, Library};
pub use placed_effect::PlacedEffect;
