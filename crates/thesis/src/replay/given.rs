//! The arguments of a check: "Tc=0.0065 K=45e6", in SI units, or in those of the study (kgf, um, cm/s) where the check says so.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is wrong with the arguments of a check.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GivenError {
    /// A word that is no `name=value`.
    #[error("\"{0}\" is no argument: write name=value")]
    NotAnArgument(String),
    /// A name that stands there twice.
    #[error("{0} is given twice")]
    Twice(String),
    /// An argument that the check needs.
    #[error("{0} is needed and not given")]
    Missing(String),
    /// An argument that should be a number.
    #[error("{name} is \"{text}\", which is not a number")]
    NotANumber {
        /// Its name.
        name: String,
        /// What is there.
        text: String,
    },
    /// An argument that is none of the words that the check knows.
    #[error("{name} is \"{text}\", and may be {known}")]
    NotAWord {
        /// Its name.
        name: String,
        /// What is there.
        text: String,
        /// What may be.
        known: String,
    },
    /// Arguments that the check has no use for.
    #[error("the check takes no {}", .0.join(", "))]
    NotAsked(Vec<String>),
}

/// The arguments of a check, by name.
#[derive(Debug, Default)]
pub struct Given {
    values: BTreeMap<String, String>,
    /// Names that the check asked for: one that it never asks for is misspelt.
    asked: Mutex<BTreeSet<String>>,
}

impl Clone for Given {
    fn clone(&self) -> Self {
        Given { values: self.values.clone(), asked: Mutex::new(self.asked().clone()) }
    }
}

impl Given {
    /// Arguments from words `name=value`.
    ///
    /// # Errors
    /// A word that is none, or a name that stands there twice.
    pub fn parse(text: &str) -> Result<Self, GivenError> {
        let mut values = BTreeMap::new();
        for word in text.split_whitespace() {
            let (name, value) =
                word.split_once('=').ok_or_else(|| GivenError::NotAnArgument(word.to_owned()))?;
            if values.insert(name.to_owned(), value.to_owned()).is_some() {
                return Err(GivenError::Twice(name.to_owned()));
            }
        }
        Ok(Given { values, asked: Mutex::default() })
    }

    /// An argument as it is written, if it is given.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.asked().insert(name.to_owned());
        self.values.get(name).map(String::as_str)
    }

    /// An argument that has to be given.
    ///
    /// # Errors
    /// Where it is not.
    pub fn need(&self, name: &str) -> Result<&str, GivenError> {
        self.text(name).ok_or_else(|| GivenError::Missing(name.to_owned()))
    }

    /// A number that has to be given.
    ///
    /// # Errors
    /// Where it is not, or is no number.
    pub fn number(&self, name: &str) -> Result<f64, GivenError> {
        number(name, self.need(name)?)
    }

    /// A number, or what it is where it is not given.
    ///
    /// # Errors
    /// Where it is no number.
    pub fn number_or(&self, name: &str, preset: f64) -> Result<f64, GivenError> {
        self.text(name).map_or(Ok(preset), |text| number(name, text))
    }

    /// Numbers with semicolons between them.
    ///
    /// # Errors
    /// Where there are none, or one of them is no number.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, GivenError> {
        self.need(name)?.split(';').map(|text| number(name, text)).collect()
    }

    /// What a word that has to be given stands for.
    ///
    /// # Errors
    /// Where it is not given, or is none of those known.
    pub fn word<T: Copy>(&self, name: &str, known: &[(&str, T)]) -> Result<T, GivenError> {
        let text = self.need(name)?;
        known.iter().find(|(word, _)| *word == text).map(|(_, meaning)| *meaning).ok_or_else(|| {
            let known: Vec<_> = known.iter().map(|(word, _)| *word).collect();
            GivenError::NotAWord { name: name.to_owned(), text: text.to_owned(), known: known.join(", ") }
        })
    }

    fn asked(&self) -> MutexGuard<'_, BTreeSet<String>> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// That the check has asked for everything that is given.
    pub(super) fn all_asked(&self) -> Result<(), GivenError> {
        let asked = self.asked();
        let left: Vec<_> = self.values.keys().filter(|name| !asked.contains(*name)).cloned().collect();
        if left.is_empty() { Ok(()) } else { Err(GivenError::NotAsked(left)) }
    }
}

fn number(name: &str, text: &str) -> Result<f64, GivenError> {
    let found = text.parse().ok().filter(|number: &f64| number.is_finite());
    found.ok_or_else(|| GivenError::NotANumber { name: name.to_owned(), text: text.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_read_by_name() {
        let given = Given::parse("Tc=0.0065 V=1;2.5 oil=polar").unwrap();
        assert_eq!(given.number("Tc"), Ok(0.0065));
        assert_eq!(given.number_or("K", 45e6), Ok(45e6));
        assert_eq!(given.numbers("V"), Ok(vec![1.0, 2.5]));
        assert_eq!(given.all_asked(), Err(GivenError::NotAsked(vec!["oil".into()])));
        assert_eq!(given.word("oil", &[("plain", 1), ("polar", 2)]), Ok(2));
        assert_eq!(given.all_asked(), Ok(()));
    }

    #[test]
    fn what_is_wrong_with_them_is_told() {
        let told = |text: &str| Given::parse(text).unwrap_err().to_string();
        assert_eq!(told("Tc 0.1"), "\"Tc\" is no argument: write name=value");
        assert_eq!(told("K=1 K=2"), "K is given twice");
        let given = Given::parse("Tc=fast oil=olive").unwrap();
        assert_eq!(given.number("K").unwrap_err().to_string(), "K is needed and not given");
        assert_eq!(given.number("Tc").unwrap_err().to_string(), "Tc is \"fast\", which is not a number");
        let oil = given.word("oil", &[("plain", 1), ("polar", 2)]).unwrap_err();
        assert_eq!(oil.to_string(), "oil is \"olive\", and may be plain, polar");
    }
}
