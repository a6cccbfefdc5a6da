//! Replaces native code in builds without the `native` feature.
//!
//! `Native::new` returns `None`, so every run is interpreted. The other functions cannot be called.

use super::frame::Frame;
use super::{Kernel, Steps};

/// An uninhabited type: there is no native code.
#[derive(Debug)]
pub(crate) enum Native {}

impl Native {
    /// Always `None`.
    pub(crate) fn new(_: &Kernel) -> Option<Native> {
        None
    }

    /// Never called, because there is no value of this type.
    pub(crate) fn steps(&self, _: &mut Frame<f64>, _: &[Vec<[f64; 2]>], _: &Steps) -> u64 {
        match *self {}
    }

    /// Never called.
    pub(crate) fn look(&self, _: &mut Frame<f64>, _: &[Vec<[f64; 2]>], _: f64) -> bool {
        match *self {}
    }

    /// Never called.
    pub(crate) fn evaluate(&self, _: &mut Frame<f64>, _: &[Vec<[f64; 2]>]) {
        match *self {}
    }
}
