//! An effect at a place of a patch, ready to be fitted: wired, in units, with the points from which fits begin.

use super::effect::{EffectParameter, Start};
use super::graft::{Attached, Brought, Graft};
use super::reach::{Largest, reach};
use crate::patch::{EditError, Patch};

/// No sample takes more steps than this for the sake of an effect's time.
const MOST_STEPS: u32 = 4;
/// From so many points a fit may begin.
const MOST_STARTS: usize = 48;

/// An effect wired into a patch.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Name of the effect.
    pub effect: String,
    /// The element that it acts on.
    pub junction: String,
    /// Which of its forms it has.
    pub form: usize,
    /// What it reads beside it, where there is a choice.
    pub reads: Vec<String>,
    /// The patch with it.
    pub graft: Graft,
    /// The values of its parameters from which fits begin, that without any effect first where there is one.
    pub starts: Vec<Vec<f64>>,
    /// The value of its first parameter at which there is no effect, where that lies in its range.
    pub none: Option<f64>,
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
        let none = measured.first().and_then(|first| first.none);
        let without: Option<Vec<f64>> = none.map(|none| {
            let rest = measured.iter().skip(1).map(|own| own.brought.value);
            [none].into_iter().chain(rest).collect()
        });
        let starts = measured.iter().fold(vec![Vec::new()], |points: Vec<Vec<f64>>, own| {
            let with = |point: &Vec<f64>| {
                let point = point.clone();
                own.starts.iter().map(move |start| [point.as_slice(), &[*start]].concat()).collect::<Vec<_>>()
            };
            points.iter().flat_map(with).collect()
        });
        Ok(Some(Candidate {
            effect: attached.effect.name.clone(),
            junction: attached.junction().to_owned(),
            form: attached.number(),
            reads: attached.reads(),
            graft,
            starts: without.into_iter().chain(starts).take(MOST_STARTS).collect(),
            none,
        }))
    }

    /// Whether it is this effect at this place.
    pub fn is(&self, attached: &Attached<'_>) -> bool {
        self.effect == attached.effect.name
            && self.form == attached.number()
            && self.junction == attached.junction()
            && self.reads == attached.reads()
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
    let [end, other] = towards(named.ends);
    Some(FROM_THE_END.iter().map(|share| end + share * (other - end)).collect())
}

/// A parameter in its unit.
struct Measured {
    brought: Brought,
    /// The value at which there is no effect.
    none: Option<f64>,
    starts: Vec<f64>,
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
        Some(Measured { brought, none, starts })
    }
}
