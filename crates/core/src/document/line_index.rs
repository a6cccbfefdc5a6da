//! An index of a text that finds the line and column of a byte without a walk over the whole text.
//!
//! Reports with thousands of findings on one long line need it: a walk for each finding would take quadratic time.

/// The starts of the lines of a text, and the number of characters in front of every block of bytes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LineIndex {
    /// First byte of every line.
    line_starts: Vec<usize>,
    /// Number of characters in front of every block of bytes. The last entry is the number in the whole text.
    block_starts: Vec<usize>,
}

/// Bytes between two counts of characters. A lookup counts at most this many bytes twice.
const BLOCK_BYTES: usize = 1024;

impl LineIndex {
    /// Builds the index of a text, in one walk over it.
    pub(super) fn new(text: &str) -> Self {
        let line_ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let mut block_starts = vec![0];
        for block in text.as_bytes().chunks(BLOCK_BYTES) {
            block_starts.push(block_starts[block_starts.len() - 1] + count_characters(block));
        }
        LineIndex {
            line_starts: [0].into_iter().chain(line_ends.map(|(at, _)| at + 1)).collect(),
            block_starts,
        }
    }

    /// Index of the line that contains a byte, from 0. A newline belongs to the line that it ends.
    pub(super) fn line(&self, byte: usize) -> usize {
        self.line_starts.partition_point(|start| *start <= byte) - 1
    }

    /// First byte of a line.
    #[cfg(feature = "snippets")]
    pub(super) fn line_start(&self, line: usize) -> usize {
        self.line_starts[line]
    }

    /// One past the last byte of a line, without the newline.
    #[cfg(feature = "snippets")]
    pub(super) fn line_end(&self, text: &str, line: usize) -> usize {
        self.line_starts.get(line + 1).map_or(text.len(), |next| next - 1)
    }

    /// Line and column of a byte at which a character begins. Both count from 1; columns count characters.
    ///
    /// `text` must be the text of the index.
    pub(super) fn line_and_column(&self, text: &str, byte: usize) -> (usize, usize) {
        let line = self.line(byte);
        let column =
            self.characters_before(text, byte) - self.characters_before(text, self.line_starts[line]);
        (line + 1, column + 1)
    }

    /// Number of characters in front of a byte.
    fn characters_before(&self, text: &str, byte: usize) -> usize {
        let block = byte / BLOCK_BYTES;
        self.block_starts[block] + count_characters(&text.as_bytes()[block * BLOCK_BYTES..byte])
    }
}

/// Number of characters that begin in these bytes of UTF-8: all bytes except continuation bytes.
fn count_characters(bytes: &[u8]) -> usize {
    bytes.iter().filter(|byte| **byte & 0b1100_0000 != 0b1000_0000).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_equal_those_of_a_walk_over_the_text() {
        let text = "µ\n\n1234\n".repeat(700);
        let index = LineIndex::new(&text);
        for (byte, _) in text.char_indices().chain([(text.len(), ' ')]) {
            let before = &text[..byte];
            let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
            let expected = (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1);
            assert_eq!(index.line_and_column(&text, byte), expected);
        }
    }

    #[cfg(feature = "snippets")]
    #[test]
    fn the_end_of_a_line_excludes_the_newline() {
        let index = LineIndex::new("ab\n\ncd");
        let ends: Vec<_> = (0..3).map(|line| index.line_end("ab\n\ncd", line)).collect();
        assert_eq!(ends, [2, 3, 6]);
        assert_eq!((index.line(2), index.line(3), index.line_start(2)), (0, 1, 4));
    }
}
