//! An effect at a place of a patch, ready to be fitted: wired, in units, with the points from which fits begin.

use crate::effects::attach::Attached;
use crate::effects::graft::{Brought, Graft};
use crate::effects::reach::{Largest, reach};
use crate::effects::{EffectParameter, Start};
use patchcord_core::patch::{EditError, Patch};

/// No sample takes more steps than this for the sake of an effect's time.
const MOST_STEPS: u32 = 4;
/// From so many points a fit may begin,
const MOST_STARTS: usize = 24;
/// and from so many without any effect.
const MOST_SHAPES: usize = 12;
/// So many of what parameters may begin with together are gone through at most to find these.
const MOST_JOINED: usize = 10_000;
/// A parameter that begins at so many values or more has many valleys.
const COMB: usize = 8;
/// They lie as far apart as the first two, but for this share.
const UNEVEN: f64 = 1e-6;
/// By these shares of the way from one of them to the next a fit is moved, to see whether it ended in the wrong one.
const BESIDE: [f64; 5] = [0.04, 0.1, 0.2, 0.35, 0.5];

/// An effect wired into a patch.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Name of the effect.
    pub effect: String,
    /// The element that it acts on.
    pub junction: String,
    /// Which of its forms it has,
    pub form: usize,
    /// and what that is; empty where there is nothing to tell.
    pub note: String,
    /// What it reads beside it, where there is a choice.
    pub reads: Vec<String>,
    /// The patch with it.
    pub graft: Graft,
    /// Values of its parameters with which it has no effect, one for every shape that it may have.
    pub without: Vec<Vec<f64>>,
    /// Values from which fits begin beside those.
    pub starts: Vec<Vec<f64>>,
    /// The value of its first parameter at which there is no effect, where that lies in its range.
    pub none: Option<f64>,
    /// Effects that it is the same as where the data do not excite what sets it apart.
    pub(crate) aliases: Vec<String>,
    /// Of every parameter how far the values lie apart from which fits begin, where they are many.
    combs: Vec<Option<f64>>,
}

impl Candidate {
    /// Wires an effect; `largest` holds what is largest where it attaches, `peaks` the frequencies at which a force is missing, in Hz.
    ///
    /// # Errors
    /// When the fragment does not fit together.
    pub fn new(
        attached: &Attached<'_>,
        patch: &Patch,
        largest: &[Largest],
        peaks: &[f64],
    ) -> Result<Option<Candidate>, EditError> {
        let told = attached.form.parameters.iter().map(|name| (name, &attached.effect.parameters[name]));
        let measured = told.map(|(name, parameter)| Measured::of(name, parameter, largest, peaks));
        let Some(measured) = measured.collect::<Option<Vec<_>>>() else { return Ok(None) };
        let graft =
            attached.graft(patch, &measured.iter().map(|own| own.brought.clone()).collect::<Vec<_>>())?;
        let (first, shape) =
            measured.split_first().map_or((None, [].as_slice()), |(first, shape)| (Some(first), shape));
        let over_shapes = |sizes: Vec<f64>, most| {
            let sizes = sizes.into_iter().map(|size| vec![size]).collect();
            let joined = |points: Vec<Vec<f64>>, own: &Measured| {
                each_with(thinned(points, MOST_JOINED / own.starts.len().max(1)), own)
            };
            thinned(shape.iter().fold(sizes, joined), most)
        };
        let none = first.and_then(|first| first.none);
        let starts = first.map(|first| first.starts.clone()).unwrap_or_default();
        Ok(Some(Candidate {
            effect: attached.effect.name.clone(),
            junction: attached.junction().to_owned(),
            form: attached.number(),
            note: attached.form.note.clone(),
            reads: attached.reads(),
            graft,
            without: over_shapes(none.into_iter().collect(), MOST_SHAPES),
            starts: over_shapes(starts, MOST_STARTS),
            none,
            aliases: attached.effect.aliases.keys().cloned().collect(),
            combs: measured.iter().map(|own| own.comb).collect(),
        }))
    }

    /// Values of its parameters beside those where a fit ended, where it may have ended in the wrong of many valleys.
    pub fn beside(&self, found: &[f64]) -> Vec<Vec<f64>> {
        let combs = self.combs.iter().enumerate().filter_map(|(place, comb)| Some((place, (*comb)?)));
        let moved = combs.flat_map(|(place, comb)| {
            let [low, high] = self.graft.parameters[place].range;
            let shifts = BESIDE.into_iter().flat_map(move |share| [-share * comb, share * comb]);
            shifts.map(move |shift| {
                let mut moved = found.to_vec();
                moved[place] = (moved[place] + shift).clamp(low, high);
                moved
            })
        });
        moved.collect()
    }

    /// Values of its parameters, those out of their ranges at the ends of these.
    pub fn within(&self, values: &[f64]) -> Vec<f64> {
        let pairs = values.iter().zip(&self.graft.parameters);
        pairs.map(|(value, own)| value.clamp(own.range[0], own.range[1])).collect()
    }

    /// Whether it may be but another: an alias at the same place.
    pub fn may_be(&self, other: &Candidate) -> bool {
        self.junction == other.junction && self.aliases.contains(&other.effect)
    }

    /// Whether it is this effect at this place.
    pub fn is(&self, attached: &Attached<'_>) -> bool {
        self.is_the(&attached.effect.name, attached.number(), attached.junction(), &attached.reads())
    }

    /// The effect and where it acts.
    pub fn named(&self) -> String {
        format!("{} at {}", self.effect, self.junction)
    }

    /// Whether another is the same effect at the same place.
    pub fn is_same(&self, other: &Candidate) -> bool {
        self.is_the(&other.effect, other.form, &other.junction, &other.reads)
    }

    fn is_the(&self, effect: &str, form: usize, junction: &str, reads: &[String]) -> bool {
        self.effect == effect && self.form == form && self.junction == junction && self.reads == reads
    }

    /// Steps from sample to sample without which its least time would be shorter than a step.
    pub fn steps(&self, interval: f64) -> u32 {
        let times = self.graft.parameters.iter().filter(|own| own.unit == "s" && own.range[0] > 0.0);
        let steps = times.map(|own| (interval / own.range[0]).ceil() as u32);
        steps.max().unwrap_or(1).clamp(1, MOST_STEPS)
    }
}

/// Values by so many shares of the span from the end of what the reach names.
const FROM_THE_END: [f64; 2] = [0.01, 0.05];

fn near_the_end(
    parameter: &EffectParameter,
    largest: &[Largest],
    towards: impl Fn([f64; 2]) -> [f64; 2],
) -> Option<Vec<f64>> {
    let named = largest.iter().find(|own| own.name == parameter.reach.text())?;
    let from = |ends: [f64; 2]| {
        let [end, other] = towards(ends);
        FROM_THE_END.map(|share| end + share * (other - end))
    };
    let measured = from(named.extent.ends);
    let met = from(named.extent.met).into_iter().filter(|own| !measured.contains(own));
    Some(measured.into_iter().chain(met).collect())
}

/// So many of several points at most, from all over them.
fn thinned(points: Vec<Vec<f64>>, most: usize) -> Vec<Vec<f64>> {
    let every = points.len().div_ceil(most).max(1);
    points.into_iter().step_by(every).collect()
}

/// Points with one more parameter, which may be each of several.
fn each_with(points: Vec<Vec<f64>>, own: &Measured) -> Vec<Vec<f64>> {
    let with = |point: Vec<f64>| {
        own.starts.iter().map(move |start| [point.as_slice(), &[*start]].concat()).collect::<Vec<_>>()
    };
    points.into_iter().flat_map(with).collect()
}

/// A parameter in its unit.
struct Measured {
    brought: Brought,
    /// The value at which there is no effect.
    none: Option<f64>,
    starts: Vec<f64>,
    /// How far these lie apart, where they are many.
    comb: Option<f64>,
}

/// How far many values lie apart, all alike.
fn comb(starts: &[f64]) -> Option<f64> {
    let apart: Vec<f64> = starts.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let first = *apart.first().filter(|_| starts.len() >= COMB)?;
    let is_even = apart.iter().all(|own| (own - first).abs() < UNEVEN * first.abs());
    is_even.then(|| first.abs())
}

impl Measured {
    fn of(name: &str, parameter: &EffectParameter, largest: &[Largest], peaks: &[f64]) -> Option<Measured> {
        let (size, unit) = reach(&parameter.reach, largest)?;
        // Where something that it is measured in never leaves zero, it has nothing to act on.
        if !size.is_normal() {
            return None;
        }
        let range = parameter.range.map(|end| end * size);
        let starts: Vec<f64> = match &parameter.start {
            Start::Values(values) => values.iter().map(|value| value * size).collect(),
            Start::Spectrum => peaks.to_vec(),
            Start::Highest => near_the_end(parameter, largest, |[least, most]| [most, least])?,
            Start::Lowest => near_the_end(parameter, largest, |[least, most]| [-least, -most])?,
        };
        let starts: Vec<f64> = starts.into_iter().map(|start| start.clamp(range[0], range[1])).collect();
        let brought = Brought {
            name: name.to_owned(),
            of: name.to_owned(),
            unit: unit.text().to_owned(),
            value: *starts.first()?,
            range,
        };
        let none = parameter.none.map(|none| none * size);
        let comb = matches!(parameter.start, Start::Values(_)).then(|| comb(&starts)).flatten();
        Some(Measured { brought, none, starts, comb })
    }
}
