//! The storage oscilloscope: Y-t and X-Y pictures of a trace.

use std::collections::HashSet;

use crate::family::labels;
use crate::plot::{Axis, Channel, Mark, Picture};
use patchcord_analysis::instruments::{Display, deed};
use patchcord_core::patch::PictureSpec;
use patchcord_core::trace::{Deed, Mark as Phase, Trace, Track};

/// Why a picture cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ScopeError {
    /// A signal that was not recorded.
    #[error("the picture \"{picture}\" shows {signal}, which was not recorded")]
    NotRecorded {
        /// Title of the picture.
        picture: String,
        /// The signal.
        signal: String,
    },
    /// More units than a picture has axes.
    #[error("the picture \"{picture}\" shows signals in more than two units; draw two pictures")]
    TooManyUnits {
        /// Title of the picture.
        picture: String,
    },
}

/// A quantity along an axis.
pub(super) struct Quantity<'t> {
    pub name: &'t str,
    pub unit: &'t str,
    pub values: Vec<f64>,
}

impl<'t> Quantity<'t> {
    fn of(track: &'t Track) -> Self {
        Quantity { name: &track.name, unit: &track.unit, values: track.values().collect() }
    }
}

/// The picture that a patch asks for, from what was recorded: channels in one unit share an axis, those in a
/// second unit are read on the right; every sweep begins a new line. `note` is a line of small print.
///
/// # Errors
/// When a signal was not recorded, or the channels have more than two units.
pub fn picture(trace: &Trace, spec: &PictureSpec, note: Option<String>) -> Result<Picture, ScopeError> {
    let along = find(trace, spec, &spec.x.value)?;
    let shown: Result<Vec<_>, _> = spec.y.iter().map(|name| find(trace, spec, &name.value)).collect();
    let shown = shown?;
    let left_unit = shown.first().map_or("", |quantity| quantity.unit);
    let (left, right): (Vec<_>, Vec<_>) = shown.iter().partition(|quantity| quantity.unit == left_unit);
    if right.iter().any(|quantity| quantity.unit != right[0].unit) {
        return Err(ScopeError::TooManyUnits { picture: title(spec) });
    }
    let (horizontal, across) = axis(&[&along], Axis::ACROSS);
    let (vertical, up) = axis(&left, Axis::UP);
    let second = (!right.is_empty()).then(|| axis(&right, Axis::UP));
    let breaks: Vec<usize> = trace.sweeps.iter().map(|sweep| sweep.first).collect();
    // One channel carries the labels of a family: the others run beside it.
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
        note,
        marks: marks(trace, &along, &across),
        ..Picture::new(title(spec), horizontal, vertical)
    })
}

/// Against time: where phases begin within the runs. What begins together has one mark, and what happens at the
/// same place in several runs too.
fn marks(trace: &Trace, along: &Quantity<'_>, across: &Display) -> Vec<Mark> {
    if along.name != "t" {
        return Vec::new();
    }
    let at_once = |one: &Phase, next: &Phase| one.sweep == next.sweep && one.begin == next.begin;
    let is_within = |phase: &Phase| {
        let end = trace.sweeps.get(phase.sweep).map_or(0.0, |sweep| sweep.end);
        phase.begin > 0.0 && phase.begin < end
    };
    let mut seen = HashSet::new();
    let together = trace.marks.chunk_by(at_once).filter(|together| is_within(&together[0]));
    let marks = together.map(|together| {
        let told: Vec<_> = together.iter().map(label).collect();
        (across.value(together[0].begin), told.join(", "))
    });
    marks
        .filter(|(at, label)| seen.insert((at.to_bits(), label.clone())))
        .map(|(at, label)| Mark { at, label })
        .collect()
}

/// What a phase is called on the screen: of operating the first word.
fn label(phase: &Phase) -> String {
    match phase.phase {
        Deed::Operate { .. } => "operate".to_owned(),
        _ => deed(phase),
    }
}

fn title(spec: &PictureSpec) -> String {
    if !spec.title.is_empty() {
        return spec.title.clone();
    }
    let names: Vec<_> = spec.y.iter().map(|name| name.value.as_str()).collect();
    format!("{} against {}", names.join(", "), spec.x.value)
}

fn find<'t>(trace: &'t Trace, spec: &PictureSpec, name: &str) -> Result<Quantity<'t>, ScopeError> {
    if name == "t" {
        return Ok(Quantity { name: "t", unit: "s", values: trace.time.clone() });
    }
    let missing = || ScopeError::NotRecorded { picture: title(spec), signal: name.to_owned() };
    trace.track(name).map(Quantity::of).ok_or_else(missing)
}

/// An axis for quantities of one unit, and how their values are shown on it.
pub(super) fn axis(quantities: &[&Quantity<'_>], divisions: usize) -> (Axis, Display) {
    let all = || quantities.iter().flat_map(|quantity| quantity.values.iter().copied());
    let largest = all().filter(|value| value.is_finite()).fold(0.0, |most: f64, value| most.max(value.abs()));
    let display = Display::new(quantities.first().map_or("", |quantity| quantity.unit), largest);
    let shown: Vec<f64> = all().map(|value| display.value(value)).collect();
    let names: Vec<_> = quantities.iter().map(|quantity| quantity.name).collect();
    (Axis::snug(names.join(", "), display.unit.clone(), shown.into_iter(), divisions), display)
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::document::{Placed, Span};
    use patchcord_core::trace::{Ending, NewValue, Sweep};

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
            courses: Vec::new(),
            derivative: None,
        };
        Trace {
            time: vec![0.0, 1.0, 2.0, 0.0, 1.0, 2.0],
            tracks: vec![track("v", "m/s"), track("w", "m/s"), track("F", "N"), track("p", "Pa")],
            sweeps: vec![Sweep::default(), Sweep { first: 3, ..Sweep::default() }],
            marks: Vec::new(),
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
    fn a_second_unit_is_read_on_the_right() {
        let picture = picture(&trace(), &spec("v", &["w", "F"]), None).unwrap();
        assert_eq!(picture.vertical_right.unwrap().unit, "mN");
        assert_eq!(picture.channels.iter().map(|channel| channel.right).collect::<Vec<_>>(), [false, true]);
    }

    #[test]
    fn every_sweep_begins_a_new_line() {
        let picture = picture(&trace(), &spec("t", &["v"]), None).unwrap();
        assert_eq!(picture.channels[0].breaks, [0, 3]);
    }

    fn phase(phase: Deed, sweep: usize, begin: f64) -> Phase {
        let (end, sample, ended) = (begin, 3 * sweep, Ending::Time);
        Phase { phase, sweep, begin, end, problem_time: begin, sample, ended }
    }

    #[test]
    fn phases_within_a_run_are_marked_where_they_begin() {
        let operate = || Deed::Operate { until: None };
        let set = |before: f64, value: f64| {
            Deed::Set(vec![NewValue { parameter: "k".into(), value, before, unit: "N/m".into() }])
        };
        let mut trace = trace();
        trace.sweeps.iter_mut().for_each(|sweep| sweep.end = 2.0);
        for (sweep, first) in [(0, 1.0), (1, 3.0)] {
            trace.marks.extend([
                phase(Deed::InitialCondition, sweep, 0.0),
                phase(operate(), sweep, 0.0),
                phase(Deed::Hold, sweep, 0.5),
                phase(set(first, first + 1.0), sweep, 1.0),
                phase(operate(), sweep, 1.0),
                phase(set(first + 1.0, 3.0), sweep, 2.0),
            ]);
        }
        let against_time = picture(&trace, &spec("t", &["v", "w"]), None).unwrap();
        let told: Vec<_> = against_time.marks.iter().map(|mark| (mark.at, mark.label.as_str())).collect();
        assert_eq!(told, [(0.5, "hold"), (1.0, "k = 2 N/m, operate"), (1.0, "k = 4 N/m, operate")]);
        let labels = [(2, "k = 1, then 2 N/m".to_owned()), (5, "k = 3, then 4 N/m".to_owned())];
        assert_eq!(
            (&against_time.channels[0].labels[..], against_time.channels[1].labels.len()),
            (&labels[..], 0)
        );
        assert!(picture(&trace, &spec("v", &["w"]), None).unwrap().marks.is_empty());
    }

    #[test]
    fn what_cannot_be_drawn_is_told() {
        assert!(matches!(picture(&trace(), &spec("t", &["x"]), None), Err(ScopeError::NotRecorded { .. })));
        let three = spec("t", &["v", "F", "p"]);
        assert!(matches!(picture(&trace(), &three, None), Err(ScopeError::TooManyUnits { .. })));
    }
}
