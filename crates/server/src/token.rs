//! The token: a random text in the address of the panel, without which no session or comparison begins.

use constant_time_eq::constant_time_eq;

/// Random bytes of a token.
const BYTES: usize = 16;

/// A random text of 32 hexadecimal digits.
pub(crate) struct Token(String);

impl Token {
    /// A new token.
    ///
    /// # Errors
    /// If the operating system has no random numbers.
    pub(crate) fn random() -> Result<Token, getrandom::Error> {
        let mut bytes = [0; BYTES];
        getrandom::fill(&mut bytes)?;
        Ok(Token(bytes.iter().map(|byte| format!("{byte:02x}")).collect()))
    }

    /// The text.
    pub(crate) fn text(&self) -> &str {
        &self.0
    }

    /// Whether the query of an address has this token. The time of the comparison does not depend on where the texts
    /// differ.
    pub(crate) fn is_in(&self, query: Option<&str>) -> bool {
        let mut pairs = query.unwrap_or_default().split('&');
        let given = pairs.find_map(|pair| pair.strip_prefix("token="));
        given.is_some_and(|given| constant_time_eq(given.as_bytes(), self.0.as_bytes()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_random_and_has_128_bits() {
        let [first, second] = [Token::random().unwrap(), Token::random().unwrap()];
        assert_eq!(first.text().len(), 32);
        assert!(first.text().chars().all(|digit| digit.is_ascii_hexdigit()));
        assert_ne!(first.text(), second.text());
    }

    #[test]
    fn only_the_complete_token_is_accepted() {
        let token = Token("00ff".to_owned());
        assert!(token.is_in(Some("token=00ff")) && token.is_in(Some("a=b&token=00ff")));
        for query in ["", "token", "token=", "token=00f", "token=00ff0", "token=00FF", "tokens=00ff"] {
            assert!(!token.is_in(Some(query)), "{query}");
        }
        assert!(!token.is_in(None));
    }
}
