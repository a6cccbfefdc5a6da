//! For each effect of a library: the elements of a patch at which it can act.
//!
//! The command line lists them before a search, and reports list the effects that the patch has no site for.

use indexmap::IndexSet;

use crate::data::experiment::MeasuredDrive;
use crate::effects::Library;
use crate::effects::attach::EffectPlacement;
use crate::effects::sites::Sites;
use patchcord_core::document::Report;
use patchcord_core::patch::Patch;

/// The elements of a patch at which the effects of a library are tried.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::Patch;
/// use patchcord_ident::{EffectSites, Library};
///
/// // A mass on a spring: A1 integrates the velocity, A2 the position.
/// let patch = Patch::read("../../examples/05_missing_effect/spring.json")?;
/// let sites = EffectSites::of(&patch, &[], &Library::shipped())?;
/// let friction = sites.effects.iter().find(|(effect, _)| effect == "viscous-friction").ok_or("listed")?;
/// assert_eq!(friction.1, ["A1"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct EffectSites {
    /// Every effect with the integrators, drives and friction levels at which it can act, in the order of the circuit.
    /// The list is empty if the effect can act nowhere.
    pub effects: Vec<(String, Vec<String>)>,
    /// Integrators at which no effect is tried, because no signal gives their output a scale.
    pub unscaled_integrators: Vec<String>,
}

impl EffectSites {
    /// The sites of a patch. `drives` are those that the data feed.
    ///
    /// # Errors
    /// If the patch cannot be wired.
    pub fn of(
        patch: &Patch,
        drives: &[MeasuredDrive],
        library: &Library,
    ) -> Result<EffectSites, Box<Report>> {
        let sites = Sites::fed(patch, drives)?;
        let effects = library.iter().map(|effect| {
            let elements: IndexSet<String> = EffectPlacement::all(effect, &sites)
                .iter()
                .map(|placement| placement.site_name().to_owned())
                .collect();
            (effect.name.clone(), elements.into_iter().collect())
        });
        let effects = effects.collect();
        Ok(EffectSites { effects, unscaled_integrators: sites.unscaled_integrators })
    }

    /// The effects that can act nowhere in the patch.
    pub fn inapplicable_effects(&self) -> Vec<&str> {
        let inapplicable = self.effects.iter().filter(|(_, elements)| elements.is_empty());
        inapplicable.map(|(effect, _)| effect.as_str()).collect()
    }
}
