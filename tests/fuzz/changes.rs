//! Random changes of a document, of its values or of its text.

use super::corpus::Corpus;
use super::csv_damage::damaged_bytes;
use super::document::Node;
use super::mutation::{mutate, vary};
use crate::common::random::SplitMix64;

/// A changed document and its text. Half of the changes are small; some damage the text only.
pub(crate) fn changed_document(corpus: &Corpus, mut node: Node, random: &mut SplitMix64) -> (Node, Vec<u8>) {
    match random.below(20) {
        0 => (),
        1..11 => vary(&mut node, random),
        11..18 => {
            let most = *random.pick(&[1, 2, 4]);
            mutate(&mut node, 1 + random.below(most), &corpus.fragments, random);
        }
        _ => {
            let bytes = damaged_bytes(&node.json(), random);
            return (node, bytes);
        }
    }
    let bytes = node.json().into_bytes();
    (node, bytes)
}
