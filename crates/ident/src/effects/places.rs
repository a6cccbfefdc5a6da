//! Where a patch has room for each effect of a library.

use indexmap::IndexSet;

use crate::data::experiment::Feed;
use crate::effects::Library;
use crate::effects::attach::Attached;
use crate::effects::sites::Sites;
use patchcord_core::document::Report;
use patchcord_core::patch::Patch;

/// The places at which effects are tried.
#[derive(Debug, Clone, Default)]
pub struct Places {
    /// Every effect with the integrators, drives and levels at which it fits, in the order of the circuit.
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
            let at: IndexSet<String> =
                Attached::all(effect, &sites).iter().map(|own| own.junction().to_owned()).collect();
            (effect.name.clone(), at.into_iter().collect())
        });
        let effects = effects.collect();
        Ok(Places { effects, nameless: sites.nameless })
    }

    /// The effects for which there is none.
    pub fn nowhere(&self) -> Vec<&str> {
        let placeless = self.effects.iter().filter(|(_, at)| at.is_empty());
        placeless.map(|(effect, _)| effect.as_str()).collect()
    }
}
