//! Where a patch has room for each effect of a library.

use super::effect::Library;
use super::experiment::Feed;
use super::graft::Attached;
use super::site::Sites;
use crate::patch::{Patch, Report};

/// The places at which effects are tried.
#[derive(Debug, Clone, Default)]
pub struct Places {
    /// Every effect with the integrators, drives and signals at which it fits, in the order of the circuit.
    pub effects: Vec<(String, Vec<String>)>,
    /// Integrators at which nothing is tried, as they give no signal with a scale.
    pub nameless: Vec<String>,
}

impl Places {
    /// Those of an experiment: of its patch, with the drives that its data feed.
    ///
    /// # Errors
    /// When the patch cannot be wired.
    pub fn of(patch: &Patch, drives: &[Feed], library: &Library) -> Result<Places, Box<Report>> {
        let sites = Sites::fed(patch, drives)?;
        let effects = library.iter().map(|effect| {
            let mut at: Vec<String> = Vec::new();
            for attached in Attached::all(effect, &sites) {
                let own = attached.junction();
                if at.iter().all(|other| other != own) {
                    at.push(own.to_owned());
                }
            }
            (effect.name.clone(), at)
        });
        Ok(Places { effects: effects.collect(), nameless: sites.nameless.clone() })
    }

    /// The effects for which there is none.
    pub fn nowhere(&self) -> Vec<&str> {
        let placeless = self.effects.iter().filter(|(_, at)| at.is_empty());
        placeless.map(|(effect, _)| effect.as_str()).collect()
    }
}
