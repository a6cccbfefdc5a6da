//! The storage oscilloscope: pictures of a trace against time or against another signal.

use std::collections::HashSet;

use crate::family::labels;
use crate::plot::{Axis, Channel, Marker, Picture};
use patchcord_analysis::format::QuantityFormat;
use patchcord_analysis::instruments::phase_description;
use patchcord_core::patch::PictureSpec;
use patchcord_core::trace::{PhaseKind, PhaseRecord, Trace, Track};

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
    /// One value for each sample, in that unit.
    pub values: Vec<f64>,
}

impl<'t> Quantity<'t> {
    /// Returns the samples of a recorded signal.
    fn of(track: &'t Track) -> Self {
        Quantity { name: &track.name, unit: &track.unit, values: track.values().collect() }
    }
}

/// Returns the picture that a patch specifies, from the recorded signals.
///
/// Channels with the same unit share an axis; those with a second unit use the right axis. Every run
/// starts a new line. `note` is printed below the title.
///
/// # Errors
///
/// If a signal was not recorded or the channels have more than two units.
///
/// # Examples
///
/// ```
/// use patchcord_draw::{ScopeError, picture};
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // dx/dt = -x, from x = 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("Decay").element("A1", decay).run(2.0, 1e-3).record(["A1"]).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let trace = run(&Program::new(&circuit)?, &RunSettings::of(&circuit)?)?;
///
/// let specs = circuit.picture_specs(["A1", "A2"].into_iter());
/// let shown = picture(&trace, &specs[0], None)?;
/// assert_eq!((shown.title.as_str(), shown.channels[0].name.as_str()), ("A1 against t", "A1"));
/// assert_eq!(shown.channels[0].points.len(), trace.time.len());
/// assert!(matches!(picture(&trace, &specs[1], None), Err(ScopeError::NotRecorded { .. })));
/// # Ok(())
/// # }
/// ```
pub fn picture(trace: &Trace, spec: &PictureSpec, note: Option<&str>) -> Result<Picture, ScopeError> {
    let along = find(trace, spec, &spec.x.value)?;
    let shown: Result<Vec<_>, _> = spec.y.iter().map(|name| find(trace, spec, &name.value)).collect();
    let shown = shown?;
    let left_unit = shown.first().map_or("", |quantity| quantity.unit);
    let (left, right): (Vec<_>, Vec<_>) = shown.iter().partition(|quantity| quantity.unit == left_unit);
    if right.iter().any(|quantity| quantity.unit != right[0].unit) {
        return Err(ScopeError::TooManyUnits { picture: title(spec) });
    }
    let (horizontal, across) = axis(&[&along], Axis::HORIZONTAL_DIVISIONS);
    let (vertical, up) = axis(&left, Axis::VERTICAL_DIVISIONS);
    let second = (!right.is_empty()).then(|| axis(&right, Axis::VERTICAL_DIVISIONS));
    let breaks: Vec<usize> = trace.repetitions.iter().map(|repetition| repetition.first).collect();
    // The first channel has the labels of the family; the other channels would only repeat them.
    let mut labels = labels(trace);
    let channels = shown.iter().map(|quantity| {
        let on_right = quantity.unit != left_unit;
        let scale = if on_right { second.as_ref().map_or(&up, |(_, scale)| scale) } else { &up };
        let points =
            along.values.iter().zip(&quantity.values).map(|(x, y)| (across.value(*x), scale.value(*y)));
        Channel {
            right: on_right,
            breaks: breaks.clone(),
            labels: std::mem::take(&mut labels),
            ..Channel::line(quantity.name, points.collect())
        }
    });
    Ok(Picture {
        channels: channels.collect(),
        vertical_right: second.map(|(axis, _)| axis),
        note: note.map(str::to_owned),
        markers: markers(trace, &along, &across),
        ..Picture::new(title(spec), horizontal, vertical)
    })
}

/// Returns markers where phases begin within the runs, for a picture against time only.
///
/// Phases that begin at the same time share a marker, and so do equal phases of several runs.
fn markers(trace: &Trace, along: &Quantity<'_>, across: &QuantityFormat) -> Vec<Marker> {
    if along.name != "t" {
        return Vec::new();
    }
    let is_simultaneous =
        |one: &PhaseRecord, next: &PhaseRecord| one.repetition == next.repetition && one.begin == next.begin;
    let is_within = |phase: &PhaseRecord| {
        let end = trace.repetitions.get(phase.repetition).map_or(0.0, |repetition| repetition.end);
        phase.begin > 0.0 && phase.begin < end
    };
    let mut seen = HashSet::new();
    let groups = trace.phase_records.chunk_by(is_simultaneous).filter(|group| is_within(&group[0]));
    let markers = groups.map(|group| {
        let labels: Vec<_> = group.iter().map(label).collect();
        (across.value(group[0].begin), labels.join(", "))
    });
    markers
        .filter(|(at, label)| seen.insert((at.to_bits(), label.clone())))
        .map(|(at, label)| Marker { at, label })
        .collect()
}

/// Returns the label of a phase on the screen. The condition of an operate phase is omitted.
fn label(phase: &PhaseRecord) -> String {
    match phase.phase {
        PhaseKind::Operate { .. } => "operate".to_owned(),
        _ => phase_description(phase),
    }
}

/// Returns the title that the patch gives, or else the names of the signals: `x, v against t`.
fn title(spec: &PictureSpec) -> String {
    if !spec.title.is_empty() {
        return spec.title.clone();
    }
    let names: Vec<_> = spec.y.iter().map(|name| name.value.as_str()).collect();
    format!("{} against {}", names.join(", "), spec.x.value)
}

/// Returns the samples of a signal, or the times of the samples for "t".
fn find<'t>(trace: &'t Trace, spec: &PictureSpec, name: &str) -> Result<Quantity<'t>, ScopeError> {
    if name == "t" {
        return Ok(Quantity { name: "t", unit: "s", values: trace.time.clone() });
    }
    let missing = || ScopeError::NotRecorded { picture: title(spec), signal: name.to_owned() };
    trace.track(name).map(Quantity::of).ok_or_else(missing)
}

/// Returns an axis for quantities with the same unit, and the display that scales their values.
pub(super) fn axis(quantities: &[&Quantity<'_>], divisions: usize) -> (Axis, QuantityFormat) {
    let all = || quantities.iter().flat_map(|quantity| quantity.values.iter().copied());
    let largest =
        all().filter(|value| value.is_finite()).fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let display = QuantityFormat::new(quantities.first().map_or("", |quantity| quantity.unit), largest);
    let shown: Vec<f64> = all().map(|value| display.value(value)).collect();
    let names: Vec<_> = quantities.iter().map(|quantity| quantity.name).collect();
    (Axis::fit_tight(names.join(", "), display.unit.clone(), shown, divisions), display)
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::document::{Placed, Span};
    use patchcord_core::trace::{NewValue, PhaseEnd, Repetition};

    fn spec(x: &str, y: &[&str]) -> PictureSpec {
        let placed = |name: &str| Placed { value: name.to_owned(), span: Span::default() };
        PictureSpec { title: String::new(), x: placed(x), y: y.iter().map(|name| placed(name)).collect() }
    }

    fn trace() -> Trace {
        let track = |name: &str, unit: &str| Track {
            name: name.into(),
            unit: unit.into(),
            per_volt: 1e-3,
            volts: vec![0.0, 2.0, 1.0, 0.0, 2.0, 1.0],
            extremes: Vec::new(),
            derivative: None,
        };
        Trace {
            time: vec![0.0, 1.0, 2.0, 0.0, 1.0, 2.0],
            tracks: vec![track("v", "m/s"), track("w", "m/s"), track("F", "N"), track("p", "Pa")],
            repetitions: vec![Repetition::default(), Repetition { first: 3, ..Repetition::default() }],
            ..Trace::default()
        }
    }

    #[test]
    fn values_are_shown_in_a_prefixed_unit() {
        let picture = picture(&trace(), &spec("t", &["v", "w"]), None).unwrap();
        assert_eq!((picture.vertical.unit.as_str(), picture.vertical.label.as_str()), ("mm/s", "v, w"));
        assert_eq!(picture.channels[1].points[1], (1.0, 2.0));
        assert!(picture.vertical_right.is_none());
    }

    #[test]
    fn a_second_unit_uses_the_right_axis() {
        let picture = picture(&trace(), &spec("v", &["w", "F"]), None).unwrap();
        assert_eq!(picture.vertical_right.unwrap().unit, "mN");
        assert_eq!(picture.channels.iter().map(|channel| channel.right).collect::<Vec<_>>(), [false, true]);
    }

    #[test]
    fn every_repetition_begins_a_new_line() {
        let picture = picture(&trace(), &spec("t", &["v"]), None).unwrap();
        assert_eq!(picture.channels[0].breaks, [0, 3]);
    }

    fn phase(phase: PhaseKind, repetition: usize, begin: f64) -> PhaseRecord {
        let (end, sample, ended) = (begin, 3 * repetition, PhaseEnd::Time);
        PhaseRecord { phase, repetition, begin, end, problem_time: begin, sample, ended }
    }

    #[test]
    fn phases_within_a_run_are_marked_where_they_begin() {
        let operate = || PhaseKind::Operate { until: None };
        let set = |before: f64, value: f64| {
            PhaseKind::Set(vec![NewValue { parameter: "k".into(), value, before, unit: "N/m".into() }])
        };
        let mut trace = trace();
        trace.repetitions.iter_mut().for_each(|repetition| repetition.end = 2.0);
        for (repetition, first) in [(0, 1.0), (1, 3.0)] {
            trace.phase_records.extend([
                phase(PhaseKind::InitialCondition, repetition, 0.0),
                phase(operate(), repetition, 0.0),
                phase(PhaseKind::Hold, repetition, 0.5),
                phase(set(first, first + 1.0), repetition, 1.0),
                phase(operate(), repetition, 1.0),
                phase(set(first + 1.0, 3.0), repetition, 2.0),
            ]);
        }
        let against_time = picture(&trace, &spec("t", &["v", "w"]), None).unwrap();
        let markers: Vec<_> =
            against_time.markers.iter().map(|marker| (marker.at, marker.label.as_str())).collect();
        assert_eq!(markers, [(0.5, "hold"), (1.0, "k = 2 N/m, operate"), (1.0, "k = 4 N/m, operate")]);
        let labels = [(2, "k = 1, then 2 N/m".to_owned()), (5, "k = 3, then 4 N/m".to_owned())];
        assert_eq!(
            (&against_time.channels[0].labels[..], against_time.channels[1].labels.len()),
            (&labels[..], 0)
        );
        assert!(picture(&trace, &spec("v", &["w"]), None).unwrap().markers.is_empty());
    }

    #[test]
    fn invalid_pictures_are_rejected() {
        assert!(matches!(picture(&trace(), &spec("t", &["x"]), None), Err(ScopeError::NotRecorded { .. })));
        let three = spec("t", &["v", "F", "p"]);
        assert!(matches!(picture(&trace(), &three, None), Err(ScopeError::TooManyUnits { .. })));
    }
}
