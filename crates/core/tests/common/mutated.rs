//! Documents that somebody or something has spoilt.

/// Numbers that look like chance and are the same in every run (xorshift).
pub struct Dice(pub u64);

impl Dice {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end.max(1) as u64) as usize
    }

    fn one_of<'a, T: ?Sized>(&mut self, items: &[&'a T]) -> &'a T {
        items[self.below(items.len())]
    }
}

/// Words, numbers and signs of a JSON text, each by itself.
fn tokens(text: &str) -> Vec<&str> {
    let is_sign = |letter: char| !(letter.is_alphanumeric() || "+-._".contains(letter));
    text.split_inclusive(is_sign)
        .flat_map(|piece| {
            let sign = piece.char_indices().last().filter(|(_, last)| is_sign(*last));
            let (word, sign) = piece.split_at(sign.map_or(piece.len(), |(at, _)| at));
            [word, sign]
        })
        .filter(|token| !token.is_empty())
        .collect()
}

const STRANGE: &[&str] = &[
    "null",
    "true",
    "0",
    "-1",
    "1e308",
    "1e-308",
    "1e999",
    "NaN",
    "\"\"",
    "\"x10\"",
    "\"in\"",
    "\"A3\"",
    "A3",
    "ground",
    "µ",
    "\\",
    "\u{feff}",
    "\r\n",
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    "(",
    "^",
    "/",
    "summer",
    "pot",
    "multiplier",
    "diode-lower-of",
    "table",
    "[[0, 0], [1, 1e300]]",
    "unlimited",
    "N s/m",
    "kind",
];

/// The text with one token deleted, doubled, exchanged for another, or replaced by something strange.
fn with_another_token(text: &str, dice: &mut Dice) -> String {
    let mut tokens = tokens(text);
    let (at, other) = (dice.below(tokens.len()), dice.below(tokens.len()));
    match dice.below(5) {
        0 => drop(tokens.remove(at)),
        1 => tokens.insert(at, tokens[at]),
        2 => tokens.swap(at, other),
        3 => tokens[at] = tokens[other],
        _ => tokens[at] = dice.one_of(STRANGE),
    }
    tokens.concat()
}

/// The text with one byte deleted or replaced, or cut off there.
fn with_another_byte(text: &str, dice: &mut Dice) -> String {
    let mut bytes = text.as_bytes().to_vec();
    let at = dice.below(bytes.len());
    match dice.below(8) {
        0 => bytes.truncate(at),
        1..4 => drop(bytes.remove(at)),
        _ => bytes[at] = *dice.one_of(&b"{}[],:\"\\ 0123456789.eE+-abxyzABS\n/*".each_ref()),
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The text with one to three changes.
pub fn mutated(text: &str, dice: &mut Dice) -> String {
    let rounds = 1 + dice.below(3);
    (0..rounds).fold(text.to_owned(), |text, _| match dice.below(3) {
        _ if text.is_empty() => text,
        0 => with_another_byte(&text, dice),
        _ => with_another_token(&text, dice),
    })
}
