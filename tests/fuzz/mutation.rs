//! Random changes of a document at the level of its values.

use std::collections::BTreeMap;

use super::document::Node;
use super::edge_values::UNITS;
use super::number_text::{
    changed_formula, changed_number, edge_formula, edge_name, edge_number, usual_number,
};
use crate::common::random::SplitMix64;

/// The values of all documents, by key. A change may put such a value at the same key of another document.
pub(crate) type Fragments = BTreeMap<String, Vec<Node>>;

/// Keys whose values name elements.
const CORD_KEYS: [&str; 11] =
    ["in", "a", "b", "on", "off", "against", "end", "bias_plus", "bias_minus", "track", "at"];

/// Groups of kinds with the same inputs and without required settings. They can replace each other.
const SIMILAR_KINDS: [&[&str]; 2] = [
    &["inverter", "absolute", "sin", "cos", "log", "exp", "key-switch"],
    &["summer", "open-amplifier", "integrator"],
];

/// The least number of characters of a text that is not a name.
const LONG_TEXT: usize = 40;

/// Adds the values of a document to the fragments.
pub(crate) fn collect_fragments(document: &Node, fragments: &mut Fragments) {
    document.visit("", &mut |key, node| {
        if !key.is_empty() {
            fragments.entry(key.to_owned()).or_default().push(node.clone());
        }
    });
}

/// The keys and the short texts of a document: what its formulas, cords and lists may name. Not empty.
fn names_of(document: &Node) -> Vec<String> {
    let mut found = vec!["x".to_owned()];
    document.visit("", &mut |key, node| {
        let text = node.as_text().filter(|text| text.len() < LONG_TEXT);
        found.extend([key].into_iter().chain(text).map(str::to_owned));
    });
    found.sort();
    found.dedup();
    found
}

/// Makes small changes that a document often survives: numbers of the same size, other cords, similar kinds.
pub(crate) fn vary(document: &mut Node, random: &mut SplitMix64) {
    let elements = document.names_in("elements");
    for _ in 0..1 + random.below(4) {
        // Most values are texts and lists that are not varied, so several are tried.
        for _ in 0..20 {
            let index = random.below(document.size());
            let Some((key, node)) = document.value_mut(index) else { break };
            if let Some(varied) = varied(&key, node, &elements, random) {
                *node = varied;
                break;
            }
        }
    }
}

/// Another value for a number, a cord, a kind or a setting. `None` for other values.
fn varied(key: &str, node: &Node, elements: &[String], random: &mut SplitMix64) -> Option<Node> {
    match node {
        Node::Number(text) => Some(Node::Number(match random.below(10) {
            0 => changed_number(text, random),
            1 => usual_number(random),
            _ => scaled(text, random)?,
        })),
        Node::Text(kind) if key == "kind" => {
            let group = SIMILAR_KINDS.iter().copied().find(|group| group.contains(&kind.as_str()))?;
            Some(Node::text(random.choose(group)))
        }
        Node::Text(_) if key == "setting" => Some(Node::number(random.uniform(0.0, 1.0))),
        Node::Text(_) if CORD_KEYS.contains(&key) && !elements.is_empty() => {
            Some(Node::text(random.pick(elements).as_str()))
        }
        _ => None,
    }
}

/// A number times a factor from 0.5 to 2. `None` if the text is not a finite number.
fn scaled(text: &str, random: &mut SplitMix64) -> Option<String> {
    let number = text.parse::<f64>().ok()? * random.log_uniform(0.5, 2.0);
    number.is_finite().then(|| format!("{number:?}"))
}

/// Makes a number of changes that a document seldom survives.
pub(crate) fn mutate(document: &mut Node, changes: usize, fragments: &Fragments, random: &mut SplitMix64) {
    for _ in 0..changes {
        let names = names_of(document);
        let mut index = random.below(document.size());
        // Numbers and texts are changed more often than lists and objects.
        if matches!(document.value_mut(index), Some((_, Node::List(_) | Node::Object(_)))) {
            index = random.below(document.size());
        }
        if let Some((key, node)) = document.value_mut(index) {
            *node = changed(&key, node, &names, fragments, random);
        }
    }
}

/// A changed value, which may be of another type, nested in lists, or from another document.
fn changed(key: &str, node: &Node, names: &[String], fragments: &Fragments, random: &mut SplitMix64) -> Node {
    match random.below(20) {
        0 => any_value(random),
        1 => nested(node.clone(), random),
        2 | 3 => match fragments.get(key) {
            Some(values) => random.pick(values).clone(),
            None => any_value(random),
        },
        choice => match node {
            Node::Null => any_value(random),
            Node::Flag(flag) => Node::Flag(!flag),
            Node::Number(_) if choice == 4 => Node::Text(edge_formula(random)),
            Node::Number(_) if choice == 5 => Node::text(random.pick(names).as_str()),
            Node::Number(text) => Node::Number(changed_number(text, random)),
            Node::Text(_) if key == "unit" && choice < 16 => Node::Text(any_unit(random)),
            Node::Text(text) => changed_text(text, choice, names, random),
            Node::List(items) => {
                Node::List(changed_items(items, max_copies(node), random, |item, _| item.clone()))
            }
            Node::Object(entries) => {
                Node::Object(changed_entries(entries, max_copies(node), names, fragments, random))
            }
        },
    }
}

/// A value of any type.
fn any_value(random: &mut SplitMix64) -> Node {
    match random.below(10) {
        0 => Node::Null,
        1 => Node::Flag(random.below(2) == 0),
        2 | 3 => Node::Number(edge_number(random)),
        4 | 5 => Node::Text(edge_name(random)),
        6 => Node::List(Vec::new()),
        7 => Node::Object(Vec::new()),
        8 => Node::List(vec![Node::Null]),
        _ => Node::Object(vec![(String::new(), Node::text(""))]),
    }
}

/// The value inside up to 500 lists.
fn nested(node: Node, random: &mut SplitMix64) -> Node {
    let depth = *random.pick(&[1, 2, 20, 127, 128, 129, 500]);
    (0..depth).fold(node, |inner, _| Node::List(vec![inner]))
}

/// A unit at an edge, sometimes a very long one.
fn any_unit(random: &mut SplitMix64) -> String {
    match random.below(20) {
        0 => "m".repeat(300),
        1 => "m ".repeat(200),
        _ => (*random.pick(&UNITS)).to_owned(),
    }
}

/// Another text: a name of the document, a changed formula, or a text at an edge.
fn changed_text(text: &str, choice: usize, names: &[String], random: &mut SplitMix64) -> Node {
    match choice {
        4..9 => Node::text(random.pick(names).as_str()),
        9..15 => Node::Text(changed_formula(text, names, random)),
        15..18 => Node::Text(edge_name(random)),
        _ => Node::Number(edge_number(random)),
    }
}

/// The largest number of copies of an item of this value. It limits the size of a document.
fn max_copies(node: &Node) -> usize {
    if node.size() > 300 { 3 } else { 300 }
}

/// A list with one item removed, doubled, moved or repeated many times. `copy` makes a copy with a number.
fn changed_items<T: Clone>(
    items: &[T],
    max_copies: usize,
    random: &mut SplitMix64,
    copy: impl Fn(&T, usize) -> T,
) -> Vec<T> {
    let mut items = items.to_vec();
    if items.is_empty() {
        return items;
    }
    let (index, other) = (random.below(items.len()), random.below(items.len()));
    match random.below(6) {
        0 | 1 => drop(items.remove(index)),
        2 => items.insert(other, items[index].clone()),
        3 | 4 => items.swap(index, other),
        _ => {
            let count = max_copies.min(*random.pick(&[3, 30, 300]));
            let copies: Vec<T> = (0..count).map(|number| copy(&items[index], number)).collect();
            items.extend(copies);
        }
    }
    items
}

/// The entries of an object, with a change of the list, of a key, or of what belongs to a key.
fn changed_entries(
    entries: &[(String, Node)],
    max_copies: usize,
    names: &[String],
    fragments: &Fragments,
    random: &mut SplitMix64,
) -> Vec<(String, Node)> {
    let mut changed = entries.to_vec();
    let (index, other) = (random.below(entries.len()), random.below(entries.len()));
    match random.below(8) {
        0 | 1 if !entries.is_empty() => {
            let is_edge = random.below(2) == 0;
            changed[index].0 = if is_edge { edge_name(random) } else { random.pick(names).clone() };
        }
        2 if !entries.is_empty() => {
            changed[index].1 = entries[other].1.clone();
            changed[other].1 = entries[index].1.clone();
        }
        3 if !fragments.is_empty() => {
            let keys: Vec<&String> = fragments.keys().collect();
            let key = *random.pick(&keys);
            changed.insert(other, (key.clone(), random.pick(&fragments[key]).clone()));
        }
        _ => return changed_items(entries, max_copies, random, numbered),
    }
    changed
}

/// An entry whose key ends with a number.
fn numbered(entry: &(String, Node), number: usize) -> (String, Node) {
    (format!("{}{number}", entry.0), entry.1.clone())
}
