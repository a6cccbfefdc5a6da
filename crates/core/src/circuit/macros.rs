//! What is told of macros once their instances are elements like others.

use std::collections::{HashMap, HashSet};

use petgraph::graph::NodeIndex;

use super::resolve::Graph;
use crate::document::{Code, Diagnostic, Span};
use crate::patch::{Instance, Patch};

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

/// The findings, those inside macros told once: of the first instance that they were found in.
pub(super) fn once(patch: &Patch, findings: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut told: Vec<(Diagnostic, HashSet<String>)> = Vec::new();
    let mut places: HashMap<(Code, Span, String), usize> = HashMap::new();
    for finding in findings {
        let Some(span) = finding.span.filter(|span| is_inside(patch, *span)) else {
            told.push((finding, HashSet::new()));
            continue;
        };
        let (instance, message) = without_instance(patch, &finding.message);
        let first = *places.entry((finding.code, span, message)).or_insert(told.len());
        if first == told.len() {
            told.push((finding, HashSet::new()));
        }
        // What names none comes from one instance each time.
        let unnamed = instance.is_empty().then(|| told[first].1.len().to_string());
        told[first].1.insert(unnamed.unwrap_or(instance));
    }
    let others = |instances: HashSet<String>| instances.len().saturating_sub(1);
    told.into_iter().map(|(finding, instances)| with_others(finding, others(instances))).collect()
}

/// The instance that a message is about, and the message without what differs from instance to instance: the names
/// of elements and what drives them, and the numbers that settings came to.
fn without_instance(patch: &Patch, message: &str) -> (String, String) {
    let bare = message.split(' ').map(|word| word.trim_matches(|sign| "\",:;()".contains(sign)));
    let about = bare.clone().find_map(|word| instance(patch, word)).unwrap_or_default();
    let differs = |word: &str| {
        let is_outlet = patch.elements.contains_key(word) || patch.drives.contains_key(word);
        is_outlet || instance(patch, word).is_some() || word.parse::<f64>().is_ok()
    };
    let same: Vec<&str> = bare.filter(|word| !differs(word)).collect();
    (about.to_owned(), same.join(" "))
}

/// The innermost instance that something of this name stands in.
fn instance<'n>(patch: &Patch, name: &'n str) -> Option<&'n str> {
    name.rmatch_indices('.').map(|(dot, _)| &name[..dot]).find(|around| patch.instances.contains_key(*around))
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
