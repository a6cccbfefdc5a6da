//! Diagnostics about macros, whose instances are expanded to ordinary elements at this stage.
//!
//! A fault inside a macro is found once for every instance. It is reported once, with the number of instances.

use std::collections::{HashMap, HashSet};

use petgraph::graph::NodeIndex;

use super::resolve::Graph;
use crate::document::{Code, Diagnostic, Span};
use crate::patch::{Instance, Patch};

/// Adds the name of the checked element to diagnostics inside macros whose message does not contain it.
///
/// The position alone does not say which instance is meant.
pub(super) fn add_name(patch: &Patch, name: &str, findings: &mut [Diagnostic]) {
    for finding in findings {
        if finding.span.is_some_and(|span| is_inside(patch, span)) && !finding.message.contains(name) {
            finding.message = format!("{name}: {}", finding.message);
        }
    }
}

/// Whether a position is inside the section of macros.
///
/// Positions of edited parts are beyond the text, so they are never inside.
fn is_inside(patch: &Patch, span: Span) -> bool {
    patch.macros_span.start < span.start && span.end < patch.macros_span.end
}

/// Joins the diagnostics that differ only in the instance of a macro. The diagnostic of the first instance stays.
pub(super) fn merge_instances(patch: &Patch, findings: Vec<Diagnostic>) -> Vec<Diagnostic> {
    // Each kept diagnostic, with the names of the instances in which it occurs.
    let mut merged: Vec<(Diagnostic, HashSet<String>)> = Vec::new();
    let mut first_indices: HashMap<(Code, Span, String), usize> = HashMap::new();
    for finding in findings {
        let Some(span) = finding.span.filter(|span| is_inside(patch, *span)) else {
            merged.push((finding, HashSet::new()));
            continue;
        };
        let (instance, message) = without_instance(patch, &finding.message);
        let first = *first_indices.entry((finding.code, span, message)).or_insert(merged.len());
        if first == merged.len() {
            merged.push((finding, HashSet::new()));
        }
        // A message without an instance comes from another instance each time, so it gets a name of its own.
        let unnamed = instance.is_empty().then(|| merged[first].1.len().to_string());
        merged[first].1.insert(unnamed.unwrap_or(instance));
    }
    let others = |instances: HashSet<String>| instances.len().saturating_sub(1);
    merged.into_iter().map(|(finding, instances)| with_others(finding, others(instances))).collect()
}

/// The instance that a message names, and the message without the words that differ between instances: names of
/// elements, drives and instances, and numbers.
///
/// The instance is empty if the message names none.
fn without_instance(patch: &Patch, message: &str) -> (String, String) {
    let words = message.split(' ').map(|word| word.trim_matches(|letter| "\",:;()".contains(letter)));
    let named_instance = words.clone().find_map(|word| innermost_instance(patch, word)).unwrap_or_default();
    let differs = |word: &str| {
        let is_output = patch.elements.contains_key(word) || patch.drives.contains_key(word);
        is_output || innermost_instance(patch, word).is_some() || word.parse::<f64>().is_ok()
    };
    let common_words: Vec<&str> = words.filter(|word| !differs(word)).collect();
    (named_instance.to_owned(), common_words.join(" "))
}

/// Name of the innermost instance that contains this name: "L1.M2" for "L1.M2.A1".
fn innermost_instance<'n>(patch: &Patch, name: &'n str) -> Option<&'n str> {
    name.rmatch_indices('.').map(|(dot, _)| &name[..dot]).find(|prefix| patch.instances.contains_key(*prefix))
}

/// The diagnostic with the number of other instances in which it occurs.
fn with_others(finding: Diagnostic, others: usize) -> Diagnostic {
    let message = match others {
        0 => finding.message,
        1 => format!("{}; also in 1 other instance", finding.message),
        several => format!("{}; also in {several} other instances", finding.message),
    };
    Diagnostic { message, ..finding }
}

/// Position of the outermost instance that contains an element. `None` if the element is not in an instance.
pub(super) fn instance_span(patch: &Patch, element: &str) -> Option<Span> {
    let contains = |instance: &&Instance| instance.members.iter().any(|member| member == element);
    patch.instances.values().find(contains).map(|instance| instance.span)
}

/// Names of the elements whose outputs are outputs of instances.
pub(super) fn outputs(patch: &Patch) -> HashSet<&str> {
    patch.instances.values().flat_map(|instance| instance.outputs.values().map(String::as_str)).collect()
}

/// Names and positions of the instances without an output that is used outside.
///
/// `named` has the names that signals, the record, the pictures and the phases use.
pub(super) fn unused_instances<'p>(
    patch: &'p Patch,
    graph: &Graph,
    named: &HashSet<&str>,
) -> Vec<(&'p str, Span)> {
    let indices: HashMap<&str, NodeIndex> =
        graph.node_indices().map(|index| (graph[index].name.as_str(), index)).collect();
    let is_read = |name: &str, instance: &Instance| {
        let prefix = format!("{name}.");
        instance.outputs.values().any(|output| {
            let mut readers = graph.neighbors(indices[output.as_str()]);
            named.contains(output.as_str()) || readers.any(|reader| !graph[reader].name.starts_with(&prefix))
        })
    };
    let unused = patch.instances.iter().filter(|(name, instance)| !is_read(name, instance));
    unused.map(|(name, instance)| (name.as_str(), instance.span)).collect()
}
