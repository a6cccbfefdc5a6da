//! The text behind the fields of a patch: the text that was read, and the edits made since.
//!
//! An edit changes the fields of the patch immediately. The text is rendered only when a caller reads it. Most edited
//! patches are run and discarded, so most texts are never rendered.

use std::sync::{Arc, OnceLock};

use serde_json::Value;

use super::render::{DocumentEdit, render, root_of};

/// The text of a patch and the edits made since it was read.
#[derive(Debug, Clone)]
pub(super) struct EditedText {
    /// The text without the batches below. Copies of the patch share it.
    base: Arc<TextWithValue>,
    /// One batch of edits for every call of `PatchEditor::finish`, the oldest first.
    batches: Vec<Arc<Vec<DocumentEdit>>>,
    /// The base text with all batches applied. It is rendered when it is first read.
    rendered: OnceLock<Arc<TextWithValue>>,
    /// Whether the patch was edited since its text was read. If so, some of its parts have spans beyond the text.
    is_edited: bool,
    /// The start of the next span beyond the text, in bytes. No part of the patch uses it yet.
    pub next_span: usize,
}

/// A text and its JSON value, which is parsed when it is first read.
#[derive(Debug)]
struct TextWithValue {
    text: String,
    value: OnceLock<Value>,
}

impl TextWithValue {
    /// A text whose value is not parsed yet.
    fn new(text: String) -> Arc<TextWithValue> {
        Arc::new(TextWithValue { text, value: OnceLock::new() })
    }
}

impl EditedText {
    /// A text that has just been read, without edits.
    pub(super) fn unedited(text: &str) -> EditedText {
        EditedText {
            base: TextWithValue::new(text.to_owned()),
            batches: Vec::new(),
            rendered: OnceLock::new(),
            is_edited: false,
            next_span: text.len() + 1,
        }
    }

    /// Adds a batch of edits. The document must contain every object that the edits refer to.
    pub(super) fn push(&mut self, batch: Vec<DocumentEdit>) {
        if let Some(rendered) = self.rendered.take() {
            self.base = rendered;
            self.batches.clear();
        }
        self.batches.push(Arc::new(batch));
        self.is_edited = true;
    }

    /// Whether there are edits since the text was read.
    pub(super) fn is_edited(&self) -> bool {
        self.is_edited
    }

    /// The text with all edits.
    pub(super) fn text(&self) -> &str {
        &self.rendered().text
    }

    /// The JSON value of the text with all edits.
    pub(super) fn value(&self) -> &Value {
        let document = self.rendered();
        document.value.get_or_init(|| root_of(&document.text).to_value())
    }

    /// The text with all edits, rendered on the first call.
    fn rendered(&self) -> &TextWithValue {
        if self.batches.is_empty() {
            return &self.base;
        }
        self.rendered.get_or_init(|| {
            let mut text = self.base.text.clone();
            for batch in &self.batches {
                text = render(&text, batch).expect("typed edits change only parts that the document has");
            }
            TextWithValue::new(text)
        })
    }
}
