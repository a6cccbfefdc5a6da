//! The data of a picture before they are scaled to its axes: the curves that a run followed, or its samples.

use std::borrow::Cow;

use patchcord_core::patch::PictureSpec;
use patchcord_core::trace::{SignalCurve, Trace, Track};

/// The reasons why a picture of a trace cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScopeError {
    /// A signal of the picture was not recorded.
    #[error("the picture \"{picture}\" shows {signal}, which was not recorded")]
    NotRecorded {
        /// The title of the picture.
        picture: String,
        /// The name of the signal.
        signal: String,
    },
    /// The signals have more than two units, but a picture has two vertical axes.
    #[error("the picture \"{picture}\" shows signals in more than two units; draw two pictures")]
    TooManyUnits {
        /// The title of the picture.
        picture: String,
    },
}

/// The values of a quantity along an axis.
pub(super) struct Quantity<'t> {
    /// Its name, such as `v_o`; "t" for time.
    pub name: &'t str,
    /// The text of its unit.
    pub unit: &'t str,
    /// One value for each point, in that unit.
    pub values: Vec<f64>,
}

impl<'t> Quantity<'t> {
    /// Returns the samples of a recorded signal.
    fn of(track: &'t Track) -> Self {
        Quantity { name: &track.name, unit: &track.unit, values: track.values().collect() }
    }

    /// Returns the signal along an axis, 0 or 1, of curves with the same signal there.
    fn of_curves(curves: &[&'t SignalCurve], axis: usize) -> Option<Self> {
        let signal = &curves.first()?.axes[axis];
        let values = curves.iter().flat_map(|curve| curve.values(axis)).collect();
        Some(Quantity { name: &signal.name, unit: &signal.unit, values })
    }
}

/// Where and when the points of a channel are.
pub(super) struct PointSource<'t> {
    /// The index of the first point among the values along the horizontal axis.
    pub first: usize,
    /// The time of each point in seconds of the recorder's clock.
    pub time: Cow<'t, [f64]>,
    /// The indices of the points with which the runs begin.
    pub begins: Vec<usize>,
}

/// The data of a picture.
pub(super) struct PictureData<'t> {
    /// The values along the horizontal axis.
    pub along: Quantity<'t>,
    /// The values along the vertical axes, one quantity for each channel.
    pub shown: Vec<Quantity<'t>>,
    /// The points of each channel.
    pub sources: Vec<PointSource<'t>>,
}

/// Returns the data of a picture against a signal from the curves that the run followed. `None` if it did not follow all
/// of them.
pub(super) fn of_curves<'t>(trace: &'t Trace, spec: &PictureSpec) -> Option<PictureData<'t>> {
    let curves = spec.y.iter().map(|name| trace.curve(&spec.x.value, &name.value));
    let curves = curves.collect::<Option<Vec<_>>>()?;
    let mut first = 0;
    let sources = curves.iter().map(|curve| {
        let time = curve.points.iter().map(|point| point.time).collect();
        let source = PointSource { first, time, begins: curve.begins().collect() };
        first += curve.points.len();
        source
    });
    let sources = sources.collect();
    let shown = curves.chunks(1).filter_map(|curve| Quantity::of_curves(curve, 1)).collect();
    Some(PictureData { along: Quantity::of_curves(&curves, 0)?, shown, sources })
}

/// Returns the data of a picture from the samples.
///
/// # Errors
///
/// If a signal was not recorded.
pub(super) fn of_samples<'t>(trace: &'t Trace, spec: &PictureSpec) -> Result<PictureData<'t>, ScopeError> {
    let along = find(trace, spec, &spec.x.value)?;
    let shown: Result<Vec<_>, _> = spec.y.iter().map(|name| find(trace, spec, &name.value)).collect();
    let source = || PointSource {
        first: 0,
        time: Cow::Borrowed(trace.time.as_slice()),
        begins: trace.repetitions.iter().map(|repetition| repetition.first).collect(),
    };
    Ok(PictureData { along, shown: shown?, sources: spec.y.iter().map(|_| source()).collect() })
}

/// Returns the samples of a signal, or the times of the samples for "t".
fn find<'t>(trace: &'t Trace, spec: &PictureSpec, name: &str) -> Result<Quantity<'t>, ScopeError> {
    if name == "t" {
        return Ok(Quantity { name: "t", unit: "s", values: trace.time.clone() });
    }
    let missing = || ScopeError::NotRecorded { picture: title(spec), signal: name.to_owned() };
    trace.track(name).map(Quantity::of).ok_or_else(missing)
}

/// Returns the title that the patch gives, or else the names of the signals: `x, v against t`.
pub(super) fn title(spec: &PictureSpec) -> String {
    if !spec.title.is_empty() {
        return spec.title.clone();
    }
    let names: Vec<_> = spec.y.iter().map(|name| name.value.as_str()).collect();
    format!("{} against {}", names.join(", "), spec.x.value)
}
