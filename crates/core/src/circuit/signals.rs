//! Signals: where quantities are read, what is recorded and drawn.

use std::collections::{BTreeSet, HashMap};

use indexmap::IndexSet;

use super::SignalPoint;
use super::names::{found_or_told, outlets};
use super::resolve::{Graph, find_scale};
use crate::document::{Code, Diagnostic, Placed, derivative_of, derivative_unit};
use crate::elements::Family;
use crate::patch::Patch;

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
        let message = || format!("there is no element {} to read at", signal.at.value);
        let found = places.get(signal.at.value.as_str()).copied();
        let element = found_or_told(patch, &signal.at, found, message, || outlets(patch, &places), findings);
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
    let recordable = Recordable::new(patch, &points);
    let record = recordable.record(findings);
    recordable.pictures(findings);
    (points, record)
}

/// What can be recorded and drawn, by name.
struct Recordable<'a> {
    patch: &'a Patch,
    points: &'a [SignalPoint],
    places: HashMap<&'a str, usize>,
}

impl<'a> Recordable<'a> {
    fn new(patch: &'a Patch, points: &'a [SignalPoint]) -> Self {
        let mut places = HashMap::new();
        for (index, point) in points.iter().enumerate() {
            places.entry(point.name.as_str()).or_insert(index);
        }
        Recordable { patch, points, places }
    }

    fn find(&self, name: &Placed<String>, findings: &mut Vec<Diagnostic>) -> Option<usize> {
        let found = self.places.get(name.value.as_str()).copied();
        if found.is_none() && self.patch.signals.contains_key(&name.value) {
            // What is wrong with the signal has been reported.
            return None;
        }
        let message = || format!("there is no signal {}", name.value);
        let known = || self.points.iter().map(|point| point.name.as_str()).collect();
        found_or_told(self.patch, name, found, message, known, findings)
    }

    /// What the patch records; every signal where it does not say.
    fn record(&self, findings: &mut Vec<Diagnostic>) -> Vec<usize> {
        if self.patch.record.is_empty() {
            let (named, all) = (self.patch.signals.len(), self.points.len());
            return if named > 0 { (0..named.min(all)).collect() } else { (0..all).collect() };
        }
        let mut record = IndexSet::new();
        for name in &self.patch.record {
            let Some(point) = self.find(name, findings) else { continue };
            if !record.insert(point) {
                let message = format!("{} is recorded twice", name.value);
                findings.push(Diagnostic::at(Code::DuplicateName, name.span, message));
            } else if self.is_in_volts(point, &name.value) {
                let message = format!("{} has no scale and is recorded in volts", name.value);
                let hint = "name a signal at it, with a scale";
                findings.push(Diagnostic::at(Code::UnscaledSignal, name.span, message).hint(hint));
            }
        }
        record.into_iter().collect()
    }

    /// Whether nothing gives the signal a scale; one that is named and not there has been reported.
    fn is_in_volts(&self, point: usize, name: &str) -> bool {
        let asks_for_scale = self.patch.signals.get(name).is_some_and(|signal| signal.scale.is_some());
        self.points[point].scale.is_none() && !asks_for_scale && !self.patch.drives.contains_key(name)
    }

    fn pictures(&self, findings: &mut Vec<Diagnostic>) {
        for picture in &self.patch.pictures {
            self.unit_shown(&picture.x, findings);
            let shown = picture.y.iter().filter_map(|name| self.unit_shown(name, findings));
            let units: BTreeSet<String> = shown.collect();
            if units.len() > 2 {
                let told: Vec<_> = units.iter().map(String::as_str).collect();
                let (count, told) = (units.len(), told.join(", "));
                let message = format!("the picture shows {count} units, {told}, and has two axes for them");
                let hint = "draw a second picture";
                findings.push(Diagnostic::at(Code::UnitMismatch, picture.y[0].span, message).hint(hint));
            }
        }
    }

    /// The unit of what a picture shows: time, a signal, or the derivative of one by a parameter.
    fn unit_shown(&self, name: &Placed<String>, findings: &mut Vec<Diagnostic>) -> Option<String> {
        if name.value == "t" {
            return Some("s".to_owned());
        }
        let Some((signal, parameter)) = derivative_of(&name.value) else { return self.unit(name, findings) };
        let part = |value: &str| Placed { value: value.to_owned(), span: name.span };
        let (of, by) = (self.unit(&part(signal), findings), self.parameter_unit(&part(parameter), findings));
        Some(derivative_unit(&of?, by?))
    }

    fn unit(&self, signal: &Placed<String>, findings: &mut Vec<Diagnostic>) -> Option<String> {
        let point = &self.points[self.find(signal, findings)?];
        Some(point.scale.map_or("V", |scale| self.patch.scales[scale].unit.text()).to_owned())
    }

    fn parameter_unit(&self, name: &Placed<String>, findings: &mut Vec<Diagnostic>) -> Option<&str> {
        let found = self.patch.parameters.get(&name.value).map(|parameter| parameter.unit.text());
        let message = || format!("there is no parameter {}", name.value);
        let known = || self.patch.parameters.keys().map(String::as_str).collect();
        found_or_told(self.patch, name, found, message, known, findings)
    }
}
