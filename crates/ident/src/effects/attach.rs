//! Placements: the ways in which an effect fits into a circuit, and the meaning of its formulas' names there.
//!
//! A form of an effect fits wherever the kind of site and the dimensions suit. A form that reads a position or a load,
//! or drives a second integrator, has one placement for every choice of these.

use crate::effects::reach::{Extent, QuantitySize};
use crate::effects::sites::{Junction, ScaledSignal, Sites};
use crate::effects::{Attachment, Effect, Form, InputRole, OutputRole, PlacedEffect};
use patchcord_expr::Unit;

/// An effect, one of its forms, and the site at which it is wired.
///
/// Two placements of the same form at the same integrator differ in the signals that they read
/// ([`EffectPlacement::read_names`]).
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::Patch;
/// use patchcord_ident::Library;
/// use patchcord_ident::effects::attach::EffectPlacement;
/// use patchcord_ident::effects::sites::Sites;
///
/// let sites = Sites::fed(&Patch::read("../../examples/05_missing_effect/spring.json")?, &[])?;
/// let library = Library::shipped();
/// let friction = library.get("viscous-friction").ok_or("a shipped effect")?;
/// let placements = EffectPlacement::all(friction, &sites);
/// assert_eq!((placements[0].site_name(), placements[0].form_index()), ("A1", 0));
/// assert!(placements[0].read_names().is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct EffectPlacement<'a> {
    /// The effect.
    pub effect: &'a Effect,
    /// The form: one of `effect.forms`, by reference.
    pub form: &'a Form,
    /// The site.
    pub site: AttachmentSite<'a>,
}

/// The site at which an effect acts.
#[derive(Debug, Clone)]
pub enum AttachmentSite<'a> {
    /// The input of an integrator, with the signals that the form reads in addition.
    Junction {
        /// The integrator and its inputs.
        junction: &'a Junction,
        /// The displacement that the form reads.
        position: Option<&'a ScaledSignal>,
        /// The force that the form reads, as load or as force.
        load: Option<&'a ScaledSignal>,
        /// The second integrator that the form drives, for an outflow that is an inflow elsewhere.
        next: Option<&'a Junction>,
    },
    /// The cords of an output: the fragment drives everything that the output drove.
    Cord(&'a ScaledSignal),
}

impl<'a> EffectPlacement<'a> {
    /// All placements of an effect, in the order of its forms and of the sites.
    pub fn all(effect: &'a Effect, sites: &'a Sites) -> Vec<EffectPlacement<'a>> {
        let placements = effect.forms.iter().flat_map(|form| {
            let form_sites = AttachmentSite::all(form, sites).into_iter();
            form_sites.map(move |site| EffectPlacement { effect, form, site })
        });
        placements.collect()
    }

    /// The name of the element at which it acts: an integrator, a drive or the carrier of a friction level.
    pub fn site_name(&self) -> &'a str {
        match &self.site {
            AttachmentSite::Junction { junction, .. } => &junction.integrator,
            AttachmentSite::Cord(signal) => &signal.element,
        }
    }

    /// The effect at its site, by name.
    pub fn placed_effect(&self) -> PlacedEffect {
        PlacedEffect { effect: self.effect.name.clone(), site: self.site_name().to_owned() }
    }

    /// The index of the form in the effect's list.
    pub fn form_index(&self) -> usize {
        self.effect.forms.iter().position(|form| std::ptr::eq(form, self.form)).unwrap_or_default()
    }

    /// The names that distinguish placements at the same element: the position, the load and the second integrator, as
    /// far as the form has them.
    pub fn read_names(&self) -> Vec<String> {
        let AttachmentSite::Junction { position, load, next, .. } = &self.site else { return Vec::new() };
        let signals = [position, load].into_iter().flatten().map(|signal| signal.signal.clone());
        signals.chain(next.map(|next| next.integrator.clone())).collect()
    }
}

impl<'a> AttachmentSite<'a> {
    /// The sites that suit a form.
    ///
    /// A form for a total has one placement at each junction that moves. Forms for sums have one for every combination
    /// of the signals that they read.
    fn all(form: &Form, sites: &'a Sites) -> Vec<AttachmentSite<'a>> {
        let junctions = sites.junctions.iter();
        match form.attachment {
            Attachment::Drive => AttachmentSite::cords(form, &sites.drives),
            Attachment::Level => AttachmentSite::cords(form, &sites.levels),
            Attachment::Total => junctions
                .filter(|junction| junction.is_motion)
                .map(|junction| AttachmentSite::Junction { junction, position: None, load: None, next: None })
                .collect(),
            Attachment::Motion => junctions
                .filter(|junction| junction.is_motion)
                .flat_map(|junction| AttachmentSite::at_junction(form, junction, sites))
                .collect(),
            Attachment::Store => junctions
                .filter(|junction| !junction.is_motion)
                .flat_map(|junction| AttachmentSite::at_junction(form, junction, sites))
                .collect(),
            Attachment::Sum => {
                junctions.flat_map(|junction| AttachmentSite::at_junction(form, junction, sites)).collect()
            }
        }
    }

    /// The cords whose quantity has the dimension that the form requires.
    fn cords(form: &Form, signals: &'a [ScaledSignal]) -> Vec<AttachmentSite<'a>> {
        let is_suitable = |signal: &&ScaledSignal| {
            form.signal.as_ref().is_none_or(|unit| unit.dimension() == signal.unit.dimension())
        };
        signals.iter().filter(is_suitable).map(AttachmentSite::Cord).collect()
    }

    /// Every combination of a position, a load and a second integrator that the form can use at a junction. The second
    /// integrator has an output of the same dimension.
    fn at_junction(form: &Form, junction: &'a Junction, sites: &'a Sites) -> Vec<AttachmentSite<'a>> {
        let choices = |role, signals: &'a [ScaledSignal]| match form.reads.contains(&role) {
            true => signals.iter().map(Some).collect(),
            false => vec![None],
        };
        let drives_next = form.gives.iter().any(|(role, _)| *role == OutputRole::AddToNext);
        let is_next = |next: &&Junction| {
            next.integrator != junction.integrator
                && next.output.unit.dimension() == junction.output.unit.dimension()
        };
        let nexts: Vec<Option<&Junction>> = match drives_next {
            true => sites.junctions.iter().filter(is_next).map(Some).collect(),
            false => vec![None],
        };
        let mut combinations = Vec::new();
        for position in choices(InputRole::Position, &junction.positions) {
            let loads = match form.reads.contains(&InputRole::Force) {
                true => junction.forces.iter().map(Some).collect(),
                false => choices(InputRole::Load, &junction.loads),
            };
            for load in loads {
                let nexts = nexts.iter();
                combinations.extend(nexts.map(|next| AttachmentSite::Junction {
                    junction,
                    position,
                    load,
                    next: *next,
                }));
            }
        }
        combinations
    }

    /// The names that formulas may use at this site, with the quantity of each. In a formula of an element the name is
    /// the quantity's scale, in a reach its largest value.
    pub fn quantities(&self) -> Vec<(&'static str, FormulaQuantity<'a>)> {
        match self {
            AttachmentSite::Junction { junction, position, load, next } => {
                let sum = FormulaQuantity::sum(junction);
                let mut quantities =
                    vec![("own", FormulaQuantity::Signal(&junction.output)), ("sum", sum), ("signal", sum)];
                quantities.extend(position.map(|signal| ("position", FormulaQuantity::Signal(signal))));
                let load = load.iter().copied();
                quantities.extend(load.flat_map(|signal| {
                    ["load", "force"].map(|name| (name, FormulaQuantity::Signal(signal)))
                }));
                quantities.extend(next.map(|next| ("next", FormulaQuantity::sum(next))));
                quantities
            }
            AttachmentSite::Cord(signal) => vec![("signal", FormulaQuantity::Signal(signal))],
        }
    }

    /// The sizes of everything that a reach may name at this site. `extent` gives the extent of a quantity in its unit;
    /// a quantity with `None` is left out. `sample` is the sampling interval and `record` the length of the data, both
    /// in seconds.
    pub fn quantity_sizes(
        &self,
        extent: impl Fn(FormulaQuantity<'_>) -> Option<Extent>,
        sample: f64,
        record: f64,
    ) -> Vec<QuantitySize> {
        let quantities = self.quantities().into_iter();
        let quantities = quantities.filter_map(|(name, quantity)| {
            Some(QuantitySize::of(name, quantity.unit().clone(), extent(quantity)?))
        });
        let times = [("sample", sample), ("record", record)].into_iter();
        let seconds =
            |(name, value)| Some(QuantitySize::of(name, Unit::parse("s").ok()?, Extent::of([0.0, value])));
        quantities.chain(times.filter_map(seconds)).collect()
    }
}

/// The quantity that a name in an effect's formulas denotes.
#[derive(Debug, Clone, Copy)]
pub enum FormulaQuantity<'a> {
    /// The quantity of a signal or a drive.
    Signal(&'a ScaledSignal),
    /// The rate of a junction's output. It replaces the sum if no signal names the sum.
    Rate(&'a Junction),
}

impl<'a> FormulaQuantity<'a> {
    /// The sum that drives a junction.
    fn sum(junction: &'a Junction) -> Self {
        match &junction.sum.signal {
            Some(signal) => FormulaQuantity::Signal(signal),
            None => FormulaQuantity::Rate(junction),
        }
    }

    /// The value of one volt, as a formula of the patch's scales.
    pub(crate) fn scale(self) -> &'a str {
        match self {
            FormulaQuantity::Signal(signal) => &signal.scale,
            FormulaQuantity::Rate(junction) => &junction.sum.scale,
        }
    }

    /// The value of one volt, as a number in the quantity's unit.
    pub fn per_volt(self) -> f64 {
        match self {
            FormulaQuantity::Signal(signal) => signal.per_volt,
            FormulaQuantity::Rate(junction) => junction.sum.per_volt,
        }
    }

    /// The unit of the quantity.
    pub fn unit(self) -> &'a Unit {
        match self {
            FormulaQuantity::Signal(signal) => &signal.unit,
            FormulaQuantity::Rate(junction) => &junction.sum.unit,
        }
    }
}
