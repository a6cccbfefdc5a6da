//! A patch fitted to the training records and held against the others: where the search stands, and every attempt to go on.

use std::sync::{Arc, OnceLock};

use crate::data::experiment::Feed;
use crate::effects::candidate::Candidate;
use crate::effects::graft::Brought;
use crate::fit::coloured_residual::NotWhite;
use crate::fit::estimate::{Fitted, Point};
use crate::fit::model::{FitProgram, ModelError, share};
use crate::fit::parameter_values::ParameterValues;
use crate::fit::start_cache::Seen;
use crate::fit::uncertainty::Known;
use crate::statistics::whiteness::{colour, memory};
use patchcord_core::patch::{EditError, Patch};

/// A patch with what may be turned in it.
#[derive(Debug, Clone)]
pub struct Version {
    patch: Arc<Patch>,
    /// The patch lowered for fitting, once it is; copies of the version share it.
    lowered: Arc<OnceLock<Arc<FitProgram>>>,
    /// Parameters that are fitted.
    pub fit: Vec<String>,
    /// Parameters that are initial voltages.
    pub free: Vec<String>,
    /// Steps of the solver from sample to sample.
    pub steps: u32,
}

impl Version {
    /// A patch of which the parameters `fit` are fitted, and the parameters `free` are initial voltages found with them. Each
    /// sample takes so many steps of the solver.
    pub fn new(patch: impl Into<Arc<Patch>>, fit: Vec<String>, free: Vec<String>, steps: u32) -> Version {
        Version { patch: patch.into(), lowered: Arc::default(), fit, free, steps }
    }

    /// The patch.
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// The same with so many steps from sample to sample.
    pub fn with_steps(&self, steps: u32) -> Version {
        Version { steps, ..self.clone() }
    }

    /// The same fit of another patch.
    pub fn with_patch(&self, patch: impl Into<Arc<Patch>>) -> Version {
        Version::new(patch, self.fit.clone(), self.free.clone(), self.steps)
    }

    /// The patch lowered for fitting with records that feed these drives. It is kept for the drives that come first: other
    /// drives, or drives that are held otherwise, are lowered every time.
    ///
    /// # Errors
    /// When the patch cannot be lowered so.
    pub(crate) fn lowered(&self, drives: &[Feed]) -> Result<Arc<FitProgram>, ModelError> {
        if let Some(kept) = self.lowered.get().filter(|kept| kept.is_for(drives)) {
            return Ok(Arc::clone(kept));
        }
        let made = Arc::new(FitProgram::new(&self.patch, drives)?);
        // Another thread may have kept its own by now.
        let kept = self.lowered.get_or_init(|| Arc::clone(&made));
        Ok(if kept.is_for(drives) { Arc::clone(kept) } else { made })
    }

    /// How long a fit takes beside that of others: the runs for all derivatives, in steps.
    pub(crate) fn work(&self) -> usize {
        (self.fit.len() + self.free.len() + 1) * self.steps as usize
    }

    /// The ranges of what is fitted.
    pub(crate) fn ranges(&self) -> impl Iterator<Item = Option<(f64, f64)>> + '_ {
        self.fit.iter().map(|name| self.patch.parameters.get(name)?.range)
    }

    /// The patch with what is fitted at these values, as one of a file.
    ///
    /// # Errors
    /// If a value is not finite.
    pub fn at(&self, file: &str, knobs: &[f64]) -> Result<Patch, EditError> {
        let mut editor = self.patch.edit();
        for (name, value) in self.fit.iter().zip(knobs) {
            editor.set_parameter(name, *value)?;
        }
        editor.finish(file)
    }
}

/// A patch fitted.
#[derive(Debug, Clone)]
pub struct Stage {
    /// The patch, with its parameters as they stood.
    pub version: Version,
    /// The best fit to the training records.
    pub train: Fitted,
    /// The same knobs on the other records: initial voltages and declared offsets are found there.
    pub test: Fitted,
    /// How far what is left in training is from white: [`colour`].
    pub colour: f64,
    /// How long it remembers: [`memory`].
    pub memory: f64,
    /// Where the fit to the pieces came to; nothing where what it began with left so little that it was not needed.
    pub in_pieces: Option<Point>,
    /// What is known of the points from which it was fitted.
    pub(crate) seen: Seen,
    /// Whether it was gone through with, or looked at quickly only.
    pub gone_through: bool,
    /// How well each value that is fitted is known; nothing before `fit::intervals::with_errors`.
    pub known: Vec<Known>,
    /// What `residuals::residual_analysis::coloured_residual` says of it, once that was asked.
    pub(crate) not_white: OnceLock<Option<NotWhite>>,
}

impl Stage {
    pub(crate) fn new(
        version: Version,
        [train, test]: [Fitted; 2],
        in_pieces: Option<Point>,
        seen: Seen,
        gone_through: bool,
    ) -> Stage {
        let (colour, memory) = (colour(&train.residuals), memory(&train.residuals));
        let (known, not_white) = (Vec::new(), OnceLock::new());
        Stage { version, train, test, colour, memory, in_pieces, seen, gone_through, known, not_white }
    }

    /// What no noise explains, in sigmas rms.
    pub fn gap(&self) -> f64 {
        self.train.unexplained().sqrt()
    }

    /// Whether what is left is more than noise.
    pub fn leaves_structure(&self) -> bool {
        self.colour > COLOURED
    }

    /// The share of what another leaves, in squares over the noise, that this one does not.
    pub fn closed(&self, without: &Stage) -> f64 {
        1.0 - self.train.unexplained() / without.train.unexplained()
    }

    /// The places of what is fitted best at an end of its range.
    pub(crate) fn at_end(&self) -> impl Iterator<Item = usize> + '_ {
        self.within(self.version.ranges(), |[below, above]| below.abs().min(above.abs()) <= AT_END)
    }

    /// The places of what lies beyond these ranges.
    pub(crate) fn beyond_of<'s>(
        &'s self,
        ranges: &'s [Option<(f64, f64)>],
    ) -> impl Iterator<Item = usize> + 's {
        self.within(ranges.iter().copied(), |[below, above]| below.min(above) < -AT_END)
    }

    /// The places of what lies so far inside the two ends of its range, in shares of that.
    fn within<'s>(
        &'s self,
        ranges: impl Iterator<Item = Option<(f64, f64)>> + 's,
        is_so: impl Fn([f64; 2]) -> bool + 's,
    ) -> impl Iterator<Item = usize> + 's {
        let fitted = ranges.zip(&self.train.point.knobs).enumerate();
        fitted.filter_map(move |(place, (range, value))| {
            let (low, high) = range?;
            let inside = share([low, high], *value);
            is_so([inside, 1.0 - inside]).then_some(place)
        })
    }

    /// The places of what is fitted best at an end of its range, and was not where it was fitted before.
    pub(crate) fn newly_at_end<'s>(&'s self, before: &'s Stage) -> impl Iterator<Item = usize> + 's {
        let own = self.at_end().filter(|place| *place < before.version.fit.len());
        own.filter(|place| before.at_end().all(|other| other != *place))
    }

    /// Whether an effect is as strong as it may be.
    pub(crate) fn is_strongest(&self, effect: &Candidate) -> bool {
        let strength = effect.graft.parameters.first();
        let is_it = |place: usize| {
            strength.is_some_and(|own| own.name == self.version.fit[place])
                && Some(self.train.point.knobs[place]) != effect.none
        };
        self.at_end().any(is_it)
    }

    /// Whether the gap is so large that fits may have lost their way.
    pub fn is_far(&self) -> bool {
        self.train.over_noise() >= FAR
    }

    /// The parameters that an effect brought, their values, and how well these are known.
    pub(crate) fn brought<'s>(
        &'s self,
        effect: &'s Candidate,
    ) -> impl Iterator<Item = (&'s Brought, f64, Known)> {
        effect.graft.parameters.iter().filter_map(|own| {
            let place = self.version.fit.iter().position(|name| *name == own.name)?;
            Some((own, self.train.point.knobs[place], self.known(place)))
        })
    }

    /// How well what is fitted at a place is known; not at all where that was not worked out.
    pub fn known(&self, place: usize) -> Known {
        self.known.get(place).copied().unwrap_or(Known::NOT)
    }
}

/// What is nearer to the end of a range, by this share of it, is at it.
const AT_END: f64 = 1e-6;
/// Residuals further than this from white noise are not noise.
pub(crate) const COLOURED: f64 = 4.0;
/// Where the gap is less than so many sigmas rms, fits find their way without pieces.
const FAR: f64 = 5.0;

impl Stage {
    /// The unit of what is fitted at a place.
    pub fn unit(&self, place: usize) -> &str {
        let parameter = self.version.patch.parameters.get(&self.version.fit[place]);
        parameter.map_or("1", |own| own.unit.text())
    }

    /// What is fitted, with the values that it has at a point.
    pub(crate) fn values_at(&self, point: &Point) -> ParameterValues {
        let each = self.version.fit.iter().zip(&point.knobs).enumerate();
        let each = each.map(|(place, (name, value))| (name.clone(), *value, self.unit(place).to_owned()));
        ParameterValues(each.collect())
    }
}
