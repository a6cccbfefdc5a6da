//! Values beyond the ranges that a patch was fitted in: they may be all that it lacks.

use crate::fit::estimate::Fitted;
use crate::fit::estimation::refit;
use crate::fit::fitted_model::Stage;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::search::verdict::Verdict;
use crate::statistics::acceptance::APART;
use crate::statistics::block_comparison::advantage;

/// So many times as far from zero a range goes, or so much nearer, where a patch stood at its end.
const WIDER: f64 = 10.0;

/// A patch fitted with wider ranges where it stood at their ends.
#[derive(Debug, Clone)]
pub struct Beyond {
    /// Where it came to.
    pub stage: Stage,
    /// The places of what lies beyond its range now.
    pub(crate) places: Vec<usize>,
    /// Whether the data cannot tell it from the patch with what is named.
    pub is_rival: bool,
}

impl Beyond {
    /// What the data say when it is weighed against what they seemed to: it may be what is missing, and is what is not.
    pub(crate) fn weighed(&self, verdict: Verdict) -> Verdict {
        match verdict {
            Verdict::Named if self.is_rival => Verdict::Ambiguous,
            Verdict::UnknownEffect if self.leaves_noise() => Verdict::CannotJudge,
            own => own,
        }
    }

    /// Whether it leaves nothing but noise.
    pub(crate) fn leaves_noise(&self) -> bool {
        !self.stage.leaves_structure()
    }
}

/// Where a patch that leaves a gap comes to beyond the ends of ranges at which it stands; nothing where there is none or it
/// stays. `last` is the patch with what is named.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn extend_ranges(
    problem: &Problem,
    base: &Stage,
    last: &Stage,
) -> Result<Option<Beyond>, ModelError> {
    let was: Vec<Option<(f64, f64)>> = base.version.ranges().collect();
    let widened = base.at_end().filter_map(|place| {
        let (low, high) = wider(was[place]?, base.train.point.knobs[place]);
        (was[place] != Some((low, high))).then(|| (&base.version.fit[place], [low, high]))
    });
    let widened: Vec<(&String, [f64; 2])> = widened.collect();
    if widened.is_empty() || !base.leaves_structure() {
        return Ok(None);
    }
    let mut editor = base.version.patch().edit();
    for (name, range) in widened {
        editor.set_range(name, range)?;
    }
    let patch = editor.finish(base.version.patch().file())?;
    let version = base.version.with_patch(patch);
    let Some(stage) = refit(problem, base, version, base.train.point.clone())? else { return Ok(None) };
    let places: Vec<usize> = stage.beyond_of(&was).collect();
    let of = |own: fn(&Stage) -> &Fitted| advantage(&own(&stage).residuals, &own(last).residuals);
    let behind = of(|own| &own.train).and(of(|own| &own.test));
    let is_rival = behind.ratio() < APART;
    Ok((!places.is_empty()).then_some(Beyond { stage, places, is_rival }))
}

/// A range that goes on where a value stands at its end; nature changes no signs.
fn wider((low, high): (f64, f64), value: f64) -> (f64, f64) {
    let on = |end: f64, is_outward: bool| if is_outward { end * WIDER } else { end / WIDER };
    match value - low < high - value {
        true => (on(low, low < 0.0), high),
        false => (low, on(high, high > 0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_go_on_where_a_value_stands_but_not_through_zero() {
        assert_eq!(wider((1.0, 8.0), 8.0), (1.0, 80.0));
        assert_eq!(wider((1.0, 8.0), 1.0), (0.1, 8.0));
        assert_eq!(wider((-3.0, -2.0), -3.0), (-30.0, -2.0));
        assert_eq!(wider((-3.0, -2.0), -2.0), (-3.0, -0.2));
        assert_eq!(wider((0.0, 5.0), 0.0), (0.0, 5.0));
    }
}
