//! The storage oscilloscope: pictures of a trace against time or against another signal.

use std::collections::HashSet;
use std::sync::Arc;

use crate::family::labels;
use crate::faults;
use crate::picture_data::{self, PictureData, PointSource, Quantity, ScopeError, title};
use crate::plot::{Axis, Channel, Marker, Picture};
use patchcord_analysis::format::QuantityFormat;
use patchcord_analysis::instruments::{SignalFault, phase_description};
use patchcord_core::patch::PictureSpec;
use patchcord_core::trace::{PhaseKind, PhaseRecord, Trace};

/// Returns the picture that a patch specifies, from the recorded signals.
///
/// A picture against a signal shows the curves that the run followed, which are round between samples. If the run did
/// not follow all of them ([`RunSettings::with_curves`](patchcord_core::solve::RunSettings::with_curves)), the samples
/// are joined by straight lines.
///
/// Channels with the same unit share an axis; those with a second unit use the right axis. Every run
/// starts a new line. `note` is printed below the title. The curves are pale from the times of `faults` on, and a
/// warning says why.
///
/// A picture against a signal has equal scales if the signals along both axes have the same unit and the patch does
/// not say otherwise.
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
/// let shown = picture(&trace, &specs[0], None, &[])?;
/// assert_eq!((shown.title.as_str(), shown.channels[0].name.as_str()), ("A1 against t", "A1"));
/// assert_eq!(shown.channels[0].points.len(), trace.time.len());
/// assert!(matches!(picture(&trace, &specs[1], None, &[]), Err(ScopeError::NotRecorded { .. })));
/// # Ok(())
/// # }
/// ```
pub fn picture(
    trace: &Trace,
    spec: &PictureSpec,
    note: Option<&str>,
    faults: &[SignalFault],
) -> Result<Picture, ScopeError> {
    let PictureData { along, shown, sources } = match picture_data::of_curves(trace, spec) {
        Some(data) => data,
        None => picture_data::of_samples(trace, spec)?,
    };
    let left_unit = shown.first().map_or("", |quantity| quantity.unit);
    let (left, right): (Vec<_>, Vec<_>) = shown.iter().partition(|quantity| quantity.unit == left_unit);
    if right.iter().any(|quantity| quantity.unit != right[0].unit) {
        return Err(ScopeError::TooManyUnits { picture: title(spec) });
    }
    let equal_scales = spec.equal_scales && along.name != "t" && along.unit == left_unit;
    let [(horizontal, across), (vertical, up)] = if equal_scales {
        equal_axes(&along, &left)
    } else {
        [axis(&[&along], Axis::HORIZONTAL_DIVISIONS), axis(&left, Axis::VERTICAL_DIVISIONS)]
    };
    let second = (!right.is_empty()).then(|| axis(&right, Axis::VERTICAL_DIVISIONS));
    let displays = [&up, second.as_ref().map_or(&up, |(_, display)| display)];
    let drawn = Picture {
        channels: channels(trace, (&along, &across), (&shown, &sources), displays),
        vertical_right: second.map(|(axis, _)| axis),
        note: note.map(str::to_owned),
        markers: markers(trace, &along, &across),
        equal_scales,
        ..Picture::new(title(spec), horizontal, vertical)
    };
    Ok(faults::mark(drawn, (trace, &sources), spec, faults, &across))
}

/// Returns the channels of the quantities along the vertical axes.
///
/// `displays` are those of the left and the right axis. The first quantity uses the left one.
fn channels(
    trace: &Trace,
    (along, across): (&Quantity<'_>, &QuantityFormat),
    (shown, sources): (&[Quantity<'_>], &[PointSource<'_>]),
    [left, right]: [&QuantityFormat; 2],
) -> Vec<Channel> {
    let left_unit = shown.first().map_or("", |quantity| quantity.unit);
    // The first channel has the labels of the family; the other channels would only repeat them.
    let mut labels = sources.first().map_or(Vec::new(), |source| labels(trace, source));
    let channel = |(quantity, source): (&Quantity<'_>, &PointSource<'_>)| {
        let on_right = quantity.unit != left_unit;
        let display = if on_right { right } else { left };
        let pairs = along.values[source.first..].iter().zip(&quantity.values);
        let points = pairs.map(|(x, y)| (across.value(*x), display.value(*y))).collect();
        let is_time = along.name == "t";
        Channel {
            times: if is_time { Arc::default() } else { Arc::from(&source.time[..]) },
            right: on_right,
            breaks: source.begins.clone(),
            labels: std::mem::take(&mut labels),
            ..Channel::line(quantity.name, points)
        }
    };
    shown.iter().zip(sources).map(channel).collect()
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

/// Returns an axis for quantities with the same unit, and the display that scales their values.
pub(super) fn axis(quantities: &[&Quantity<'_>], divisions: usize) -> (Axis, QuantityFormat) {
    let display = display(quantities);
    let (names, shown) = displayed(quantities, &display);
    (Axis::fit_tight(names, display.unit.clone(), shown, divisions), display)
}

/// Returns a horizontal and a vertical axis with divisions of one size, each with the display of its values.
///
/// All quantities have the same unit, so both axes have the same display.
fn equal_axes(along: &Quantity<'_>, up: &[&Quantity<'_>]) -> [(Axis, QuantityFormat); 2] {
    let display = display(&[&[along][..], up].concat());
    let axes = Axis::fit_equal(&display.unit, [displayed(&[along], &display), displayed(up, &display)]);
    axes.map(|axis| (axis, display.clone()))
}

/// Returns the display for quantities with the same unit; the largest value selects the prefix of the unit.
fn display(quantities: &[&Quantity<'_>]) -> QuantityFormat {
    let all = quantities.iter().flat_map(|quantity| quantity.values.iter().copied());
    let largest =
        all.filter(|value| value.is_finite()).fold(0.0, |largest: f64, value| largest.max(value.abs()));
    QuantityFormat::new(quantities.first().map_or("", |quantity| quantity.unit), largest)
}

/// Returns the names of quantities, joined, and all their values as displayed.
fn displayed(quantities: &[&Quantity<'_>], display: &QuantityFormat) -> (String, Vec<f64>) {
    let names: Vec<_> = quantities.iter().map(|quantity| quantity.name).collect();
    let values = quantities.iter().flat_map(|quantity| quantity.values.iter());
    (names.join(", "), values.map(|value| display.value(*value)).collect())
}

#[cfg(test)]
mod tests;
