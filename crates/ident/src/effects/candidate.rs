//! A candidate: an effect wired into a patch at one site, in units, with the starts of its fits.
//!
//! The reaches of the site turn the effect's ranges and start values into units. The first parameter is the strength of
//! the effect, the others are its shape. Fits start without effect in several shapes, and from combinations of the
//! start values of all parameters. Each set of combinations is thinned to a fixed maximum.

use crate::effects::attach::EffectPlacement;
use crate::effects::graft::{AddedParameter, Graft};
use crate::effects::reach::{QuantitySize, evaluate_reach};
use crate::effects::{EffectParameter, PlacedEffect, StartRule};
use patchcord_core::patch::{EditError, Patch};

/// Largest number of solver steps per sample that a short time constant of an effect may require.
const MAX_STEPS_PER_SAMPLE: u32 = 4;
/// Largest number of starts with effect. It bounds the time of a trial.
const MAX_STARTS: usize = 24;
/// Largest number of starts without effect: shapes with the strength at its null value.
const MAX_NULL_STARTS: usize = 12;
/// Largest number of combinations of start values before they are thinned to the maximum. It bounds the memory.
const MAX_COMBINATIONS: usize = 10_000;
/// Least number of evenly spaced start values that count as a grid. The sum of squares then has many local minima along
/// the parameter, such as one for each time of a change.
const MIN_GRID_VALUES: usize = 8;
/// Largest deviation of a grid's intervals from the first one, as a share of it. It only covers rounding.
const GRID_TOLERANCE: f64 = 1e-6;
/// Shifts of a fitted grid parameter, as shares of the grid's spacing, from which further fits start. They test whether
/// the fit ended in a wrong local minimum.
const NEIGHBOUR_SHIFTS: [f64; 5] = [0.04, 0.1, 0.2, 0.35, 0.5];

/// An effect wired into a patch.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The name of the effect.
    pub effect: String,
    /// The name of the element at which it acts.
    pub site: String,
    /// The index of its form in the effect's list.
    pub form: usize,
    /// The note of its form. Empty if the effect has only one form.
    pub note: String,
    /// The position, the load and the second integrator that its form uses, by name.
    pub reads: Vec<String>,
    /// The extended patch.
    pub graft: Graft,
    /// Starts without effect: values of all its parameters, in units. Empty if the strength has no null value.
    pub null_starts: Vec<Vec<f64>>,
    /// Further starts: values of all its parameters, in units.
    pub starts: Vec<Vec<f64>>,
    /// The value of the first parameter, in its unit, at which there is no effect. `None` if there is no such value.
    pub null_value: Option<f64>,
    /// Names of effects that data without the required excitation cannot distinguish from this one.
    pub(crate) aliases: Vec<String>,
    /// The spacing of each parameter's start values, in its unit. `None` if they are not a grid.
    start_grid: Vec<Option<f64>>,
}

impl Candidate {
    /// Wires an effect into a patch. `sizes` are those of the quantities at the site. `peaks` are the frequencies, in
    /// Hz, at which the residuals have peaks.
    ///
    /// `None` if the size of a parameter cannot be determined: a quantity of its reach is always zero, or there is no
    /// peak.
    ///
    /// # Errors
    /// If the fragment is inconsistent, so that the result is not a valid patch.
    pub fn new(
        placement: &EffectPlacement<'_>,
        patch: &Patch,
        sizes: &[QuantitySize],
        peaks: &[f64],
    ) -> Result<Option<Candidate>, EditError> {
        let declared =
            placement.form.parameters.iter().map(|name| (name, &placement.effect.parameters[name]));
        let scaled = declared.map(|(name, parameter)| ScaledParameter::of(name, parameter, sizes, peaks));
        let Some(scaled) = scaled.collect::<Option<Vec<_>>>() else { return Ok(None) };
        let added: Vec<AddedParameter> = scaled.iter().map(|parameter| parameter.added.clone()).collect();
        let graft = placement.graft(patch, &added)?;
        let (strength, shape) =
            scaled.split_first().map_or((None, [].as_slice()), |(strength, shape)| (Some(strength), shape));
        let over_shapes = |strengths: Vec<f64>, max| {
            let strengths = strengths.into_iter().map(|strength| vec![strength]).collect();
            let combined = |starts: Vec<Vec<f64>>, parameter: &ScaledParameter| {
                let max_starts = MAX_COMBINATIONS / parameter.starts.len().max(1);
                each_with_starts(thinned(starts, max_starts), parameter)
            };
            thinned(shape.iter().fold(strengths, combined), max)
        };
        let null_value = strength.and_then(|strength| strength.null_value);
        let starts = strength.map(|strength| strength.starts.clone()).unwrap_or_default();
        Ok(Some(Candidate {
            effect: placement.effect.name.clone(),
            site: placement.site_name().to_owned(),
            form: placement.form_index(),
            note: placement.form.note.clone(),
            reads: placement.read_names(),
            graft,
            null_starts: over_shapes(null_value.into_iter().collect(), MAX_NULL_STARTS),
            starts: over_shapes(starts, MAX_STARTS),
            null_value,
            aliases: placement.effect.aliases.keys().cloned().collect(),
            start_grid: scaled.iter().map(|parameter| parameter.start_grid).collect(),
        }))
    }

    /// Values next to fitted ones: each grid parameter is shifted by shares of its spacing, within its range. Empty if
    /// there is no grid parameter.
    pub fn neighbours(&self, fitted: &[f64]) -> Vec<Vec<f64>> {
        let grids =
            self.start_grid.iter().enumerate().filter_map(|(index, spacing)| Some((index, (*spacing)?)));
        let neighbours = grids.flat_map(|(index, spacing)| {
            let [low, high] = self.graft.parameters[index].range;
            let shifts =
                NEIGHBOUR_SHIFTS.into_iter().flat_map(move |share| [-share * spacing, share * spacing]);
            shifts.map(move |shift| {
                let mut values = fitted.to_vec();
                values[index] = (values[index] + shift).clamp(low, high);
                values
            })
        });
        neighbours.collect()
    }

    /// Values of its parameters, clamped to their ranges.
    pub fn clamped(&self, values: &[f64]) -> Vec<f64> {
        let pairs = values.iter().zip(&self.graft.parameters);
        pairs.map(|(value, parameter)| value.clamp(parameter.range[0], parameter.range[1])).collect()
    }

    /// Whether the other candidate acts on the same element and its effect is an alias of this one.
    pub fn has_alias(&self, other: &Candidate) -> bool {
        self.site == other.site && self.aliases.contains(&other.effect)
    }

    /// Whether it is this placement: the same effect, form and element, with the same inputs.
    pub fn is_placed_as(&self, placement: &EffectPlacement<'_>) -> bool {
        let (form, reads) = (placement.form_index(), placement.read_names());
        self.has_placement(&placement.effect.name, form, placement.site_name(), &reads)
    }

    /// The names of the effect and of the element that it acts on.
    pub fn placed_effect(&self) -> PlacedEffect {
        PlacedEffect { effect: self.effect.clone(), site: self.site.clone() }
    }

    /// Whether another candidate has the same placement. The patches that they extend may differ.
    pub fn is_same(&self, other: &Candidate) -> bool {
        self.has_placement(&other.effect, other.form, &other.site, &other.reads)
    }

    /// Whether its placement has these names.
    fn has_placement(&self, effect: &str, form: usize, site: &str, reads: &[String]) -> bool {
        self.effect == effect && self.form == form && self.site == site && self.reads == reads
    }

    /// Solver steps per sample that keep a step shorter than the least time constant of its parameters, at most 4.
    /// `interval` is the time between two samples, in seconds.
    pub fn steps_per_sample(&self, interval: f64) -> u32 {
        let times = self.graft.parameters.iter();
        let times = times.filter(|parameter| parameter.unit == "s" && parameter.range[0] > 0.0);
        let steps = times.map(|parameter| (interval / parameter.range[0]).ceil() as u32);
        steps.max().unwrap_or(1).clamp(1, MAX_STEPS_PER_SAMPLE)
    }
}

/// Distances from the end of a quantity's range at which fits start, as shares of the range. At the end itself the
/// effect does nothing, so that a fit could not move.
const DISTANCES_FROM_END: [f64; 2] = [0.01, 0.05];

/// Start values just within the end of a quantity's measured range, then those just within the end of the range that
/// the model visits. `orient` puts the chosen end first. `None` if the reach is not the name of a quantity at this
/// site.
fn starts_near_end(
    parameter: &EffectParameter,
    sizes: &[QuantitySize],
    orient: impl Fn([f64; 2]) -> [f64; 2],
) -> Option<Vec<f64>> {
    let quantity = sizes.iter().find(|size| size.name == parameter.reach.text())?;
    let near_end = |range: [f64; 2]| {
        let [end, other] = orient(range);
        DISTANCES_FROM_END.map(|share| end + share * (other - end))
    };
    let measured = near_end(quantity.extent.range);
    let visited = near_end(quantity.extent.visited).into_iter().filter(|start| !measured.contains(start));
    Some(measured.into_iter().chain(visited).collect())
}

/// At most `max` of several starts, at even intervals of the list.
fn thinned(starts: Vec<Vec<f64>>, max: usize) -> Vec<Vec<f64>> {
    let every = starts.len().div_ceil(max).max(1);
    starts.into_iter().step_by(every).collect()
}

/// Every start with every start value of one more parameter appended.
fn each_with_starts(starts: Vec<Vec<f64>>, parameter: &ScaledParameter) -> Vec<Vec<f64>> {
    let extended = |values: Vec<f64>| {
        let starts = parameter.starts.iter();
        starts.map(move |start| [values.as_slice(), &[*start]].concat()).collect::<Vec<_>>()
    };
    starts.into_iter().flat_map(extended).collect()
}

/// A parameter of an effect with all values in its unit.
struct ScaledParameter {
    /// The parameter of the patch, with its first start value.
    added: AddedParameter,
    /// The value without effect.
    null_value: Option<f64>,
    /// The values from which fits start, within the range. There is at least one.
    starts: Vec<f64>,
    /// The spacing of the start values if they are a grid.
    start_grid: Option<f64>,
}

/// The spacing of start values if they are a grid: many and evenly spaced.
fn grid_spacing(starts: &[f64]) -> Option<f64> {
    let intervals: Vec<f64> = starts.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let first = *intervals.first().filter(|_| starts.len() >= MIN_GRID_VALUES)?;
    let is_even = intervals.iter().all(|interval| (interval - first).abs() < GRID_TOLERANCE * first.abs());
    is_even.then(|| first.abs())
}

impl ScaledParameter {
    /// Converts a parameter from reaches to its unit. `None` if its reach or its start values cannot be determined.
    ///
    /// Start values are clamped to the range. A frequency of the residual may be outside it.
    fn of(
        name: &str,
        parameter: &EffectParameter,
        sizes: &[QuantitySize],
        peaks: &[f64],
    ) -> Option<ScaledParameter> {
        let (reach, unit) = evaluate_reach(&parameter.reach, sizes)?;
        // If a quantity of the reach is always zero, the effect has no influence.
        if !reach.is_normal() {
            return None;
        }
        let range = parameter.range.map(|end| end * reach);
        let starts: Vec<f64> = match &parameter.start {
            StartRule::Values(values) => values.iter().map(|value| value * reach).collect(),
            StartRule::Spectrum => peaks.to_vec(),
            StartRule::Highest => starts_near_end(parameter, sizes, |[low, high]| [high, low])?,
            StartRule::Lowest => starts_near_end(parameter, sizes, |[low, high]| [-low, -high])?,
        };
        let starts: Vec<f64> = starts.into_iter().map(|start| start.clamp(range[0], range[1])).collect();
        let added = AddedParameter {
            name: name.to_owned(),
            name_in_effect: name.to_owned(),
            unit: unit.text().to_owned(),
            value: *starts.first()?,
            range,
        };
        let null_value = parameter.null_value.map(|value| value * reach);
        let is_listed = matches!(parameter.start, StartRule::Values(_));
        let start_grid = is_listed.then(|| grid_spacing(&starts)).flatten();
        Some(ScaledParameter { added, null_value, starts, start_grid })
    }
}
