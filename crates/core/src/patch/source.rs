//! Where the fields of a patch come from: a text that was read, and the edits made since.
//!
//! An edit changes the fields of the patch at once. Its text is rendered only when a caller reads it: most edited patches
//! are run and forgotten.

use std::sync::{Arc, OnceLock};

use serde_json::Value;

use super::render::{DocumentEdit, render, root_of};

/// A text that was read, and the edits made since.
#[derive(Debug, Clone)]
pub(super) struct Source {
    /// The text without the batches below.
    base: Arc<Document>,
    /// One batch for every `PatchEditor::finish`, the oldest first.
    batches: Vec<Arc<Vec<DocumentEdit>>>,
    /// The text with the batches, made when it is first read.
    rendered: OnceLock<Arc<Document>>,
    /// Whether the patch was edited since it was read: some of its parts then have spans beyond the text.
    is_edited: bool,
    /// The start of the next span beyond the text. No part has it yet.
    pub next_span: usize,
}

/// A text and its JSON value, which is made when it is first read.
#[derive(Debug)]
struct Document {
    text: String,
    value: OnceLock<Value>,
}

impl Document {
    fn of(text: String) -> Arc<Document> {
        Arc::new(Document { text, value: OnceLock::new() })
    }
}

impl Source {
    /// A text that is read now.
    pub fn read(text: &str) -> Source {
        Source {
            base: Document::of(text.to_owned()),
            batches: Vec::new(),
            rendered: OnceLock::new(),
            is_edited: false,
            next_span: text.len() + 1,
        }
    }

    /// Notes edits. All places at which typed edits change the document are there.
    pub fn push(&mut self, batch: Vec<DocumentEdit>) {
        if let Some(rendered) = self.rendered.take() {
            self.base = rendered;
            self.batches.clear();
        }
        self.batches.push(Arc::new(batch));
        self.is_edited = true;
    }

    /// Whether there are edits since the text was read.
    pub fn is_edited(&self) -> bool {
        self.is_edited
    }

    /// The text with all edits.
    pub fn text(&self) -> &str {
        &self.document().text
    }

    /// The JSON value of the text with all edits.
    pub fn value(&self) -> &Value {
        let document = self.document();
        document.value.get_or_init(|| root_of(&document.text).to_value())
    }

    fn document(&self) -> &Document {
        if self.batches.is_empty() {
            return &self.base;
        }
        self.rendered.get_or_init(|| {
            let mut text = self.base.text.clone();
            for batch in &self.batches {
                text = render(&text, batch).expect("typed edits change what the document has");
            }
            Document::of(text)
        })
    }
}
