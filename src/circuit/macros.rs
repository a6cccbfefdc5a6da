//! What is told of macros once their instances are elements like others.

use std::collections::{HashMap, HashSet};

use petgraph::graph::NodeIndex;

use super::resolve::Graph;
use crate::patch::{Code, Diagnostic, Instance, Patch, Span};

/// Puts the name of what was looked at before findings inside macros that do not say it.
pub(super) fn name(patch: &Patch, name: &str, findings: &mut [Diagnostic]) {
    for finding in findings {
        if finding.span.is_some_and(|span| is_inside(patch, span)) && !finding.message.contains(name) {
            finding.message = format!("{name}: {}", finding.message);
        }
    }
}

fn is_inside(patch: &Patch, span: Span) -> bool {
    patch.macros_at.start < span.start && span.end < patch.macros_at.end
}

/// The findings, those inside macros told once a place: of the first instance that they were found in.
pub(super) fn once(patch: &Patch, findings: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut told: Vec<(Diagnostic, usize)> = Vec::new();
    let mut places: HashMap<(Code, Span), usize> = HashMap::new();
    for finding in findings {
        let place = finding.span.filter(|span| is_inside(patch, *span)).map(|span| (finding.code, span));
        match place.and_then(|place| places.get(&place)) {
            Some(first) => told[*first].1 += 1,
            None => {
                places.extend(place.map(|place| (place, told.len())));
                told.push((finding, 0));
            }
        }
    }
    told.into_iter().map(|(finding, others)| with_others(finding, others)).collect()
}

fn with_others(finding: Diagnostic, others: usize) -> Diagnostic {
    let message = match others {
        0 => finding.message,
        1 => format!("{}; so in 1 more instance", finding.message),
        several => format!("{}; so in {several} more instances", finding.message),
    };
    Diagnostic { message, ..finding }
}

/// Where the outermost instance stands that an element is part of.
pub(super) fn place(patch: &Patch, element: &str) -> Option<Span> {
    let around = |instance: &&Instance| instance.members.iter().any(|member| member == element);
    patch.instances.values().find(around).map(|instance| instance.span)
}

/// The elements that are outputs of instances.
pub(super) fn outputs(patch: &Patch) -> HashSet<&str> {
    patch.instances.values().flat_map(|instance| instance.outputs.values().map(String::as_str)).collect()
}

/// Instances of which nothing outside reads an output, and where they stand; `named` is what is recorded or drawn.
pub(super) fn unread<'p>(patch: &'p Patch, graph: &Graph, named: &HashSet<&str>) -> Vec<(&'p str, Span)> {
    let places: HashMap<&str, NodeIndex> =
        graph.node_indices().map(|index| (graph[index].name.as_str(), index)).collect();
    let is_read = |name: &str, instance: &Instance| {
        let prefix = format!("{name}.");
        instance.outputs.values().any(|output| {
            let mut readers = graph.neighbors(places[output.as_str()]);
            named.contains(output.as_str()) || readers.any(|reader| !graph[reader].name.starts_with(&prefix))
        })
    };
    let unread = patch.instances.iter().filter(|(name, instance)| !is_read(name, instance));
    unread.map(|(name, instance)| (name.as_str(), instance.span)).collect()
}
