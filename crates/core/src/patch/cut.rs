//! Cuts parts out of the text of a document. The rest of the text stays as it is.
//!
//! The parts are those that a pruned copy of the document's tree lacks. The nodes of the copy keep their positions.

use std::iter::Peekable;
use std::ops::Range;

use crate::document::Span;
use crate::document::tree::{Content, Node};

/// Returns the text without the entries of objects and the items of lists that `pruned` lacks.
///
/// `root` is the tree of the text, and `pruned` is a copy of it from which entries and items were removed.
pub(super) fn cut(text: &str, root: &Node, pruned: &Node) -> String {
    let mut cuts = Vec::new();
    collect_cuts(root, pruned, &mut cuts);
    let (mut rest, mut position) = (String::with_capacity(text.len()), 0);
    for cut in cuts {
        rest.push_str(&text[position..cut.start]);
        position = cut.end;
    }
    rest + &text[position..]
}

/// An entry of an object or an item of a list: its position, with the key, and its value.
type Child<'n> = (Span, &'n Node);

/// Adds the ranges of the text that `pruned` lacks, in rising order.
///
/// A child is cut out with the comma and the line break in front of it, so that no blank line stays. The first children
/// have no comma in front of them, so they are cut out with what follows, up to the first child that stays.
fn collect_cuts(node: &Node, pruned: &Node, cuts: &mut Vec<Range<usize>>) {
    let (children, children_of_pruned) = (children_of(node), children_of(pruned));
    let mut kept = children_of_pruned.into_iter().peekable();
    if kept.peek().is_none() {
        if !children.is_empty() {
            cuts.push(node.span.start + 1..node.span.end - 1);
        }
        return;
    }
    // The end of the child before this one. `None` as long as no child stays.
    let mut previous_end = None;
    for (span, child) in &children {
        match next_if_at(&mut kept, *span) {
            Some(pruned_child) => {
                let first_start = children[0].0.start;
                if previous_end.is_none() && first_start < span.start {
                    cuts.push(first_start..span.start);
                }
                collect_cuts(child, pruned_child, cuts);
                previous_end = Some(span.end);
            }
            None => {
                previous_end = previous_end.map(|end| {
                    cuts.push(end..span.end);
                    span.end
                });
            }
        }
    }
}

/// The next of the children that stay, if it is the one at this position.
fn next_if_at<'n>(kept: &mut Peekable<impl Iterator<Item = Child<'n>>>, span: Span) -> Option<&'n Node> {
    kept.next_if(|(kept_span, _)| *kept_span == span).map(|(_, child)| child)
}

/// The entries of an object or the items of a list. Other values have none.
fn children_of(node: &Node) -> Vec<Child<'_>> {
    match &node.value {
        Content::Object(entries) => entries
            .iter()
            .map(|entry| (Span { start: entry.key_span.start, end: entry.value.span.end }, &entry.value))
            .collect(),
        Content::List(items) => items.iter().map(|item| (item.span, item)).collect(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::tree::parse;

    /// The text without the entries and items whose key or text is one of these words.
    fn without(text: &str, words: &[&str]) -> String {
        let root = parse(text).unwrap();
        let mut pruned = root.clone();
        prune(&mut pruned, words);
        cut(text, &root, &pruned)
    }

    /// Removes the entries and items whose key or text is one of these words.
    fn prune(node: &mut Node, words: &[&str]) {
        match &mut node.value {
            Content::Object(entries) => {
                entries.retain(|entry| !words.contains(&entry.key.as_str()));
                entries.iter_mut().for_each(|entry| prune(&mut entry.value, words));
            }
            Content::List(items) => {
                items.retain(|item| match &item.value {
                    Content::Text(text) => !words.contains(&text.as_str()),
                    _ => true,
                });
                items.iter_mut().for_each(|item| prune(item, words));
            }
            _ => {}
        }
    }

    #[test]
    fn an_entry_is_cut_out_with_its_comma_and_line() {
        let text = "{\n  \"a\": 1,\n  \"b\": {\"c\": []},\n  \"d\": [2]\n}\n";
        let cases: [(&[&str], &str); 7] = [
            (&["a"], "{\n  \"b\": {\"c\": []},\n  \"d\": [2]\n}\n"),
            (&["b"], "{\n  \"a\": 1,\n  \"d\": [2]\n}\n"),
            (&["d"], "{\n  \"a\": 1,\n  \"b\": {\"c\": []}\n}\n"),
            (&["a", "b"], "{\n  \"d\": [2]\n}\n"),
            (&["b", "d"], "{\n  \"a\": 1\n}\n"),
            (&["a", "c", "d"], "{\n  \"b\": {}\n}\n"),
            (&["a", "b", "d"], "{}\n"),
        ];
        for (words, expected) in cases {
            assert_eq!(without(text, words), expected, "{words:?}");
        }
    }

    #[test]
    fn an_item_is_cut_out_with_its_comma() {
        let text = r#"{"y" : [ "a" ,"b", {"c": "a"}, "d" ] }"#;
        let cases: [(&[&str], &str); 6] = [
            (&["a"], r#"{"y" : [ "b", {"c": "a"}, "d" ] }"#),
            (&["b"], r#"{"y" : [ "a", {"c": "a"}, "d" ] }"#),
            (&["d"], r#"{"y" : [ "a" ,"b", {"c": "a"} ] }"#),
            (&["a", "b", "c"], r#"{"y" : [ {}, "d" ] }"#),
            (&["y"], "{}"),
            (&["e"], text),
        ];
        for (words, expected) in cases {
            assert_eq!(without(text, words), expected, "{words:?}");
        }
    }

    #[test]
    fn equal_items_are_distinguished_by_their_positions() {
        let text = r#"["a", "b", "a", "a"]"#;
        let root = parse(text).unwrap();
        let mut pruned = root.clone();
        let Content::List(items) = &mut pruned.value else { panic!("a list") };
        items.remove(2);
        assert_eq!(cut(text, &root, &pruned), r#"["a", "b", "a"]"#);
    }
}
