//! Counts how large an expansion will be at least, before anything is expanded.
//!
//! Nested instances multiply elements, so a short text can describe an expansion of any size. The count takes time in
//! proportion to the text. It includes the names, and [`ENTRY_OVERHEAD_BYTES`] for every element and instance. The
//! expansion itself counts every byte.

use std::collections::HashMap;

use indexmap::IndexMap;

use super::{Macros, SectionEntry};
use crate::document::Span;

/// Estimated size of an element, a port or a cord in addition to its texts, in bytes. A rough value is sufficient,
/// because it only bounds the memory that nested instances use.
pub(super) const ENTRY_OVERHEAD_BYTES: usize = 50;

/// The position of the first instance with which the instances of a section exceed a number of bytes. `None` if they do
/// not exceed it.
pub(super) fn first_instance_above(
    limit: usize,
    macros: &Macros,
    section: &IndexMap<String, SectionEntry>,
) -> Option<Span> {
    let mut counter = SizeCounter { macros, sizes: HashMap::new() };
    let mut total: usize = 0;
    section.iter().find_map(|(name, entry)| {
        let SectionEntry::Instance(instance) = entry else { return None };
        total = total.saturating_add(counter.inside(&instance.macro_name.value, name).bytes);
        (total > limit).then_some(instance.span)
    })
}

/// The size of expanded entries.
#[derive(Debug, Clone, Copy, Default)]
struct ExpandedSize {
    /// Number of elements and instances.
    entries: usize,
    /// Size in bytes.
    bytes: usize,
}

impl ExpandedSize {
    /// The sum of two sizes.
    fn plus(self, other: ExpandedSize) -> ExpandedSize {
        ExpandedSize {
            entries: self.entries.saturating_add(other.entries),
            bytes: self.bytes.saturating_add(other.bytes),
        }
    }
}

/// Counts the sections of macros, each once.
struct SizeCounter<'m> {
    /// The macros of the patch.
    macros: &'m Macros,
    /// The sizes of the sections that were counted, by macro. Their names have no prefix.
    sizes: HashMap<&'m str, ExpandedSize>,
}

impl SizeCounter<'_> {
    /// The size of everything inside an instance. Each name inside begins with the instance's name and a dot.
    fn inside(&mut self, macro_name: &str, instance_name: &str) -> ExpandedSize {
        let section = self.section(macro_name);
        let prefixes = section.entries.saturating_mul(instance_name.len() + 1);
        section.plus(ExpandedSize { entries: 0, bytes: prefixes })
    }

    /// The size of the section of a macro; 0 if the macro cannot be expanded. Usable macros do not contain themselves.
    fn section(&mut self, macro_name: &str) -> ExpandedSize {
        let macros = self.macros;
        let Some((macro_name, definition)) = macros.usable(macro_name) else {
            return ExpandedSize::default();
        };
        if let Some(size) = self.sizes.get(macro_name) {
            return *size;
        }
        let mut size = ExpandedSize::default();
        for (name, entry) in &definition.entries {
            size = size.plus(ExpandedSize { entries: 1, bytes: name.len() + ENTRY_OVERHEAD_BYTES });
            if let SectionEntry::Instance(instance) = entry {
                size = size.plus(self.inside(&instance.macro_name.value, name));
            }
        }
        self.sizes.insert(macro_name, size);
        size
    }
}
