//! The arguments of a check, as a row of the ledger writes them: "Tc=0.0065 K=45e6".
//!
//! Values are in SI units, or in the units of the thesis (kgf, um, cm/s) if the check says so. A check reads its
//! arguments by name. Arguments that no check reads are an error, because they are probably misspelt.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// An error in the arguments of a check.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArgumentError {
    /// A word that is not `name=value`.
    #[error("\"{0}\" is not an argument: write name=value")]
    Malformed(String),
    /// A name that occurs twice.
    #[error("{0} is given twice")]
    Duplicate(String),
    /// A required argument that is missing.
    #[error("argument {0} is missing")]
    Missing(String),
    /// An argument that must be a number.
    #[error("{name} is \"{text}\", but must be a number")]
    NotANumber {
        /// The name of the argument.
        name: String,
        /// The text of its value.
        text: String,
    },
    /// An argument that is not one of the words that the check accepts.
    #[error("{name} is \"{text}\", but must be one of {known}")]
    UnknownWord {
        /// The name of the argument.
        name: String,
        /// The text of its value.
        text: String,
        /// The accepted words, separated by commas.
        known: String,
    },
    /// Arguments that the check did not read.
    #[error("the check takes no {}", .0.join(", "))]
    Unused(Vec<String>),
}

/// The arguments of a check, by name.
#[derive(Debug, Default)]
pub struct CheckArguments {
    values: BTreeMap<String, String>,
    /// The names that the check has read so far. A name that it never reads is probably misspelt.
    read_names: Mutex<BTreeSet<String>>,
}

impl Clone for CheckArguments {
    fn clone(&self) -> Self {
        CheckArguments { values: self.values.clone(), read_names: Mutex::new(self.read_names().clone()) }
    }
}

impl CheckArguments {
    /// Parses words `name=value` that are separated by white space.
    ///
    /// # Errors
    /// If a word is not `name=value`, or if a name occurs twice.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_thesis::replay::{ArgumentError, CheckArguments};
    ///
    /// let arguments = CheckArguments::parse("Tc=0.0065 V=1;2.5 oil=polar")?;
    /// assert_eq!(arguments.number("Tc")?, 0.0065);
    /// assert_eq!(arguments.numbers("V")?, [1.0, 2.5]);
    /// assert_eq!(arguments.choice("oil", &[("plain", 70), ("polar", 120)])?, 120);
    /// assert_eq!(arguments.number("K"), Err(ArgumentError::Missing("K".to_owned())));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, ArgumentError> {
        let mut values = BTreeMap::new();
        for word in text.split_whitespace() {
            let (name, value) =
                word.split_once('=').ok_or_else(|| ArgumentError::Malformed(word.to_owned()))?;
            if values.insert(name.to_owned(), value.to_owned()).is_some() {
                return Err(ArgumentError::Duplicate(name.to_owned()));
            }
        }
        Ok(CheckArguments { values, read_names: Mutex::default() })
    }

    /// Returns the text of an argument. `None` if it is missing.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.read_names().insert(name.to_owned());
        self.values.get(name).map(String::as_str)
    }

    /// Returns the text of a required argument.
    ///
    /// # Errors
    /// If the argument is missing.
    pub fn require(&self, name: &str) -> Result<&str, ArgumentError> {
        self.text(name).ok_or_else(|| ArgumentError::Missing(name.to_owned()))
    }

    /// Returns a required argument as a number.
    ///
    /// # Errors
    /// If the argument is missing or is not a finite number.
    pub fn number(&self, name: &str) -> Result<f64, ArgumentError> {
        number(name, self.require(name)?)
    }

    /// Returns an argument as a number, or `preset` if the argument is missing.
    ///
    /// # Errors
    /// If the argument is not a finite number.
    pub fn number_or(&self, name: &str, preset: f64) -> Result<f64, ArgumentError> {
        self.text(name).map_or(Ok(preset), |text| number(name, text))
    }

    /// Returns a required list of numbers, separated by semicolons: "1;2.5".
    ///
    /// # Errors
    /// If the argument is missing, or if one item is not a finite number.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, ArgumentError> {
        self.require(name)?.split(';').map(|text| number(name, text)).collect()
    }

    /// Returns the meaning of a required word. `known` lists the accepted words with their meanings.
    ///
    /// # Errors
    /// If the argument is missing, or if its word is not listed.
    pub fn choice<T: Copy>(&self, name: &str, known: &[(&str, T)]) -> Result<T, ArgumentError> {
        let text = self.require(name)?;
        known.iter().find(|(word, _)| *word == text).map(|(_, meaning)| *meaning).ok_or_else(|| {
            let known: Vec<_> = known.iter().map(|(word, _)| *word).collect();
            ArgumentError::UnknownWord {
                name: name.to_owned(),
                text: text.to_owned(),
                known: known.join(", "),
            }
        })
    }

    /// Locks the set of names that were read. A panic in another thread does not matter: the set stays valid.
    fn read_names(&self) -> MutexGuard<'_, BTreeSet<String>> {
        self.read_names.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Checks that every argument was read.
    ///
    /// # Errors
    /// If some were not; the error lists their names.
    pub(super) fn reject_unused(&self) -> Result<(), ArgumentError> {
        let read_names = self.read_names();
        let unused: Vec<_> = self.values.keys().filter(|name| !read_names.contains(*name)).cloned().collect();
        if unused.is_empty() { Ok(()) } else { Err(ArgumentError::Unused(unused)) }
    }
}

/// Parses a finite number.
fn number(name: &str, text: &str) -> Result<f64, ArgumentError> {
    let found = text.parse().ok().filter(|number: &f64| number.is_finite());
    found.ok_or_else(|| ArgumentError::NotANumber { name: name.to_owned(), text: text.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_read_by_name() {
        let arguments = CheckArguments::parse("Tc=0.0065 V=1;2.5 oil=polar").unwrap();
        assert_eq!(arguments.number("Tc"), Ok(0.0065));
        assert_eq!(arguments.number_or("K", 45e6), Ok(45e6));
        assert_eq!(arguments.numbers("V"), Ok(vec![1.0, 2.5]));
        assert_eq!(arguments.reject_unused(), Err(ArgumentError::Unused(vec!["oil".into()])));
        assert_eq!(arguments.choice("oil", &[("plain", 1), ("polar", 2)]), Ok(2));
        assert_eq!(arguments.reject_unused(), Ok(()));
    }

    #[test]
    fn errors_name_the_argument() {
        let error_of = |text: &str| CheckArguments::parse(text).unwrap_err().to_string();
        assert_eq!(error_of("Tc 0.1"), "\"Tc\" is not an argument: write name=value");
        assert_eq!(error_of("K=1 K=2"), "K is given twice");
        let arguments = CheckArguments::parse("Tc=fast oil=olive").unwrap();
        assert_eq!(arguments.number("K").unwrap_err().to_string(), "argument K is missing");
        assert_eq!(arguments.number("Tc").unwrap_err().to_string(), "Tc is \"fast\", but must be a number");
        let oil = arguments.choice("oil", &[("plain", 1), ("polar", 2)]).unwrap_err();
        assert_eq!(oil.to_string(), "oil is \"olive\", but must be one of plain, polar");
    }
}
