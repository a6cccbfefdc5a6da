//! Where an effect can be wired into a patch, and what the names in its formulas stand for there.

use crate::effects::reach::{Extent, Largest};
use crate::effects::sites::{Junction, Reading, Sites};
use crate::effects::{Attachment, Effect, Form, Gives, Reads};
use patchcord_expr::Unit;

/// A way to wire an effect into a patch.
#[derive(Debug, Clone)]
pub struct Attached<'a> {
    /// The effect.
    pub effect: &'a Effect,
    /// How it is wired.
    pub form: &'a Form,
    /// Where.
    pub place: Place<'a>,
}

/// The place that an effect acts on.
#[derive(Debug, Clone)]
pub enum Place<'a> {
    /// An integrator's input, with what the fragment reads beside it and another junction that it gives to.
    Junction {
        /// Where it acts.
        junction: &'a Junction,
        /// The displacement that it reads.
        position: Option<&'a Reading>,
        /// The force that it reads.
        load: Option<&'a Reading>,
        /// Where what leaves the first goes.
        next: Option<&'a Junction>,
    },
    /// A cord: everything that this output drove is driven by the fragment.
    Cord(&'a Reading),
}

impl<'a> Attached<'a> {
    /// Every way in which an effect fits into a circuit.
    pub fn all(effect: &'a Effect, sites: &'a Sites) -> Vec<Attached<'a>> {
        let places = effect.forms.iter().flat_map(|form| {
            let places = Place::all(form, sites).into_iter();
            places.map(move |place| Attached { effect, form, place })
        });
        places.collect()
    }

    /// The element that it acts on: an integrator, a drive, what carries a friction level.
    pub fn junction(&self) -> &'a str {
        match &self.place {
            Place::Junction { junction, .. } => &junction.integrator,
            Place::Cord(reading) => &reading.at,
        }
    }

    /// The place of its form among those of the effect.
    pub fn number(&self) -> usize {
        self.effect.forms.iter().position(|form| std::ptr::eq(form, self.form)).unwrap_or_default()
    }

    /// The signals that it reads, where it has a choice, and the other junction that it gives to.
    pub fn reads(&self) -> Vec<String> {
        let Place::Junction { position, load, next, .. } = &self.place else { return Vec::new() };
        let signals = [position, load].into_iter().flatten().map(|reading| reading.signal.clone());
        signals.chain(next.map(|next| next.integrator.clone())).collect()
    }
}

impl<'a> Place<'a> {
    fn all(form: &Form, sites: &'a Sites) -> Vec<Place<'a>> {
        let junctions = sites.junctions.iter();
        match form.at {
            Attachment::Drive => Place::cords(form, &sites.drives),
            Attachment::Level => Place::cords(form, &sites.levels),
            Attachment::Total => junctions
                .filter(|junction| junction.is_motion)
                .map(|junction| Place::Junction { junction, position: None, load: None, next: None })
                .collect(),
            Attachment::Motion => junctions
                .filter(|junction| junction.is_motion)
                .flat_map(|own| Place::at(form, own, sites))
                .collect(),
            Attachment::Store => junctions
                .filter(|junction| !junction.is_motion)
                .flat_map(|own| Place::at(form, own, sites))
                .collect(),
            Attachment::Sum => junctions.flat_map(|own| Place::at(form, own, sites)).collect(),
        }
    }

    /// The cords that carry what the form asks for.
    fn cords(form: &Form, readings: &'a [Reading]) -> Vec<Place<'a>> {
        let fits = |reading: &&Reading| {
            form.signal.as_ref().is_none_or(|unit| unit.dimension() == reading.unit.dimension())
        };
        readings.iter().filter(fits).map(Place::Cord).collect()
    }

    /// Every choice of what the form reads beside a junction, and of where it gives to.
    fn at(form: &Form, junction: &'a Junction, sites: &'a Sites) -> Vec<Place<'a>> {
        let choices = |role, readings: &'a [Reading]| match form.reads.contains(&role) {
            true => readings.iter().map(Some).collect(),
            false => vec![None],
        };
        let gives_on = form.gives.iter().any(|(gives, _)| *gives == Gives::AddToNext);
        let is_next = |next: &&Junction| {
            next.integrator != junction.integrator
                && next.own.unit.dimension() == junction.own.unit.dimension()
        };
        let nexts: Vec<Option<&Junction>> = match gives_on {
            true => sites.junctions.iter().filter(is_next).map(Some).collect(),
            false => vec![None],
        };
        let mut places = Vec::new();
        for position in choices(Reads::Position, &junction.positions) {
            let loads = match form.reads.contains(&Reads::Force) {
                true => junction.forces.iter().map(Some).collect(),
                false => choices(Reads::Load, &junction.loads),
            };
            for load in loads {
                let nexts = nexts.iter();
                places.extend(nexts.map(|next| Place::Junction { junction, position, load, next: *next }));
            }
        }
        places
    }

    /// The readings that stand behind the names of formulas: scales by role, and where their largest values are met.
    pub fn roles(&self) -> Vec<(&'static str, Role<'a>)> {
        match self {
            Place::Junction { junction, position, load, next } => {
                let sum = Role::sum(junction);
                let mut roles = vec![("own", Role::Read(&junction.own)), ("sum", sum), ("signal", sum)];
                roles.extend(position.map(|reading| ("position", Role::Read(reading))));
                let load = load.iter().copied();
                roles.extend(load.flat_map(|own| ["load", "force"].map(|name| (name, Role::Read(own)))));
                roles.extend(next.map(|next| ("next", Role::sum(next))));
                roles
            }
            Place::Cord(reading) => vec![("signal", Role::Read(reading))],
        }
    }

    /// The largest of what reaches may name here: of every role whose extent is told, of `sample` and of `record`, in seconds.
    pub fn largest(
        &self,
        extent: impl Fn(Role<'_>) -> Option<Extent>,
        sample: f64,
        record: f64,
    ) -> Vec<Largest> {
        let roles = self.roles().into_iter();
        let roles =
            roles.filter_map(|(name, role)| Some(Largest::of(name, role.unit().clone(), extent(role)?)));
        let times = [("sample", sample), ("record", record)].into_iter();
        let seconds =
            |(name, value)| Some(Largest::of(name, Unit::parse("s").ok()?, Extent::of([0.0, value])));
        roles.chain(times.filter_map(seconds)).collect()
    }
}

/// What a name in the formulas of an effect stands for.
#[derive(Debug, Clone, Copy)]
pub enum Role<'a> {
    /// A quantity that a signal names.
    Read(&'a Reading),
    /// The rate of what a junction gives, where nothing that drives it is named.
    Rate(&'a Junction),
}

impl<'a> Role<'a> {
    /// What drives a junction.
    fn sum(junction: &'a Junction) -> Self {
        match &junction.sum.of {
            Some(reading) => Role::Read(reading),
            None => Role::Rate(junction),
        }
    }

    /// The same as a formula.
    pub(crate) fn scale(self) -> &'a str {
        match self {
            Role::Read(reading) => &reading.scale,
            Role::Rate(junction) => &junction.sum.scale,
        }
    }

    /// What a volt stands for, as a number of its unit.
    pub fn per_volt(self) -> f64 {
        match self {
            Role::Read(reading) => reading.per_volt,
            Role::Rate(junction) => junction.sum.per_volt,
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'a Unit {
        match self {
            Role::Read(reading) => &reading.unit,
            Role::Rate(junction) => &junction.sum.unit,
        }
    }
}
