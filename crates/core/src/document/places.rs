//! Lines and columns of a text, found without walking the whole text for each.

/// Where the lines of a text begin, and how many characters come before.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Places {
    /// First byte of every line.
    lines: Vec<usize>,
    /// Characters before every block of bytes, and in the whole text.
    characters: Vec<usize>,
}

/// Bytes between two counts of characters.
const BLOCK: usize = 1024;

impl Places {
    pub fn of(text: &str) -> Self {
        let line_ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let mut characters = vec![0];
        for block in text.as_bytes().chunks(BLOCK) {
            characters.push(characters[characters.len() - 1] + characters_in(block));
        }
        Places { lines: [0].into_iter().chain(line_ends.map(|(at, _)| at + 1)).collect(), characters }
    }

    /// The line of a byte, from 0.
    pub fn line(&self, byte: usize) -> usize {
        self.lines.partition_point(|start| *start <= byte) - 1
    }

    /// First byte of a line.
    pub fn line_start(&self, line: usize) -> usize {
        self.lines[line]
    }

    /// One past the last byte of a line, its end of line not counted.
    pub fn line_end(&self, text: &str, line: usize) -> usize {
        self.lines.get(line + 1).map_or(text.len(), |next| next - 1)
    }

    /// Line and column (both from 1, columns in characters) of a byte of the text where a character begins.
    pub fn line_and_column(&self, text: &str, byte: usize) -> (usize, usize) {
        let line = self.line(byte);
        let column = self.characters_before(text, byte) - self.characters_before(text, self.lines[line]);
        (line + 1, column + 1)
    }

    fn characters_before(&self, text: &str, byte: usize) -> usize {
        let block = byte / BLOCK;
        self.characters[block] + characters_in(&text.as_bytes()[block * BLOCK..byte])
    }
}

fn characters_in(bytes: &[u8]) -> usize {
    bytes.iter().filter(|byte| **byte & 0b1100_0000 != 0b1000_0000).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_agree_with_a_walk_over_the_text() {
        let text = "µ\n\n1234\n".repeat(700);
        let places = Places::of(&text);
        for (byte, _) in text.char_indices().chain([(text.len(), ' ')]) {
            let before = &text[..byte];
            let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
            let expected = (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1);
            assert_eq!(places.line_and_column(&text, byte), expected);
        }
    }

    #[test]
    fn lines_end_before_their_end() {
        let places = Places::of("ab\n\ncd");
        let ends: Vec<_> = (0..3).map(|line| places.line_end("ab\n\ncd", line)).collect();
        assert_eq!(ends, [2, 3, 6]);
        assert_eq!((places.line(2), places.line(3), places.line_start(2)), (0, 1, 4));
    }
}
