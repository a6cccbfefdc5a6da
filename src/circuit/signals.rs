//! Signals: where quantities are read, what is recorded and drawn.

use std::collections::{BTreeSet, HashMap};

use super::SignalPoint;
use super::resolve::{Graph, find_scale};
use crate::elements::Family;
use crate::patch::{Code, Diagnostic, Patch, Placed, suggestion};

/// Everything that can be recorded (signals, then drives, then elements), and what the patch records.
pub(super) fn resolve(
    patch: &Patch,
    graph: &Graph,
    findings: &mut Vec<Diagnostic>,
) -> (Vec<SignalPoint>, Vec<usize>) {
    let places: HashMap<&str, usize> =
        graph.node_indices().map(|index| (graph[index].name.as_str(), index.index())).collect();
    let mut points = Vec::new();
    for (name, signal) in &patch.signals {
        let element = find(patch, &signal.at, &places, findings);
        let scale = signal.scale.as_ref().and_then(|scale| find_scale(patch, scale, findings));
        if let Some(element) = element {
            points.push(SignalPoint { name: name.clone(), element, scale, factor: signal.factor });
        }
    }
    for index in graph.node_indices() {
        let element = &graph[index];
        if element.kind.family != Family::Reference {
            points.push(SignalPoint {
                name: element.name.clone(),
                element: index.index(),
                scale: element.scale,
                factor: 1.0,
            });
        }
    }
    let record = record(patch, &points, findings);
    pictures(patch, &points, findings);
    (points, record)
}

fn find(
    patch: &Patch,
    at: &Placed<String>,
    places: &HashMap<&str, usize>,
    findings: &mut Vec<Diagnostic>,
) -> Option<usize> {
    let found = places.get(at.value.as_str()).copied();
    if found.is_none() && !patch.lost().may_hold(&at.value) {
        let mut known: Vec<_> = places.keys().copied().collect();
        known.sort_unstable();
        let message = format!("there is no element {} to read at", at.value);
        let hint = suggestion(&at.value, &known);
        findings.push(Diagnostic::at(Code::UnknownName, at.span, message).maybe_hint(hint));
    }
    found
}

/// What the patch records; every signal where it does not say.
fn record(patch: &Patch, points: &[SignalPoint], findings: &mut Vec<Diagnostic>) -> Vec<usize> {
    if patch.record.is_empty() {
        let named = patch.signals.len();
        return if named > 0 { (0..named.min(points.len())).collect() } else { (0..points.len()).collect() };
    }
    let mut record = Vec::new();
    for name in &patch.record {
        let Some(point) = recordable(patch, name, points, findings) else { continue };
        if record.contains(&point) {
            let message = format!("{} is recorded twice", name.value);
            findings.push(Diagnostic::at(Code::DuplicateName, name.span, message));
            continue;
        }
        if points[point].scale.is_none() && asks_for_volts(patch, &name.value) {
            let message = format!("{} has no scale and is recorded in volts", name.value);
            let hint = "name a signal at it, with a scale";
            findings.push(Diagnostic::at(Code::UnscaledSignal, name.span, message).hint(hint));
        }
        record.push(point);
    }
    record
}

/// Whether nothing gives the signal a scale; one that is named and not there has been reported.
fn asks_for_volts(patch: &Patch, name: &str) -> bool {
    let signal = patch.signals.get(name).is_some_and(|signal| signal.scale.is_some());
    !signal && !patch.drives.contains_key(name)
}

fn pictures(patch: &Patch, points: &[SignalPoint], findings: &mut Vec<Diagnostic>) {
    for picture in &patch.pictures {
        if picture.x.value != "t" {
            recordable(patch, &picture.x, points, findings);
        }
        let shown: Vec<_> = picture.y.iter().map(|name| unit_shown(patch, name, points, findings)).collect();
        let units: BTreeSet<&str> = shown.iter().flatten().map(String::as_str).collect();
        if units.len() > 2 {
            let units: Vec<_> = units.into_iter().collect();
            let message = format!(
                "the picture shows {} units, {}, and has two axes for them",
                units.len(),
                units.join(", ")
            );
            let hint = "draw a second picture";
            findings.push(Diagnostic::at(Code::UnitMismatch, picture.y[0].span, message).hint(hint));
        }
    }
}

/// The unit of a signal that a picture shows; none for time.
fn unit_shown(
    patch: &Patch,
    name: &Placed<String>,
    points: &[SignalPoint],
    findings: &mut Vec<Diagnostic>,
) -> Option<String> {
    if name.value == "t" {
        return Some("s".to_owned());
    }
    let point = &points[recordable(patch, name, points, findings)?];
    Some(point.scale.map_or("V".to_owned(), |scale| patch.scales[scale].unit.text().to_owned()))
}

fn recordable(
    patch: &Patch,
    name: &Placed<String>,
    points: &[SignalPoint],
    findings: &mut Vec<Diagnostic>,
) -> Option<usize> {
    let found = points.iter().position(|point| point.name == name.value);
    let reported = patch.signals.contains_key(&name.value) || patch.lost().may_hold(&name.value);
    if found.is_none() && !reported {
        let known: Vec<_> = points.iter().map(|point| point.name.as_str()).collect();
        let message = format!("there is no signal {}", name.value);
        let hint = suggestion(&name.value, &known);
        findings.push(Diagnostic::at(Code::UnknownName, name.span, message).maybe_hint(hint));
    }
    found
}
