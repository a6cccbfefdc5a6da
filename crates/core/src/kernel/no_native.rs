//! Native code where none can be made.

use super::Kernel;
use super::frame::Frame;
use super::step::{Look, Steps};

/// There is none.
#[derive(Debug)]
pub(crate) enum Native {}

impl Native {
    pub fn new(_: &Kernel) -> Option<Native> {
        None
    }

    pub fn steps(&self, _: &mut Frame<f64>, _: &[Vec<[f64; 2]>], _: &Steps) -> u64 {
        match *self {}
    }

    pub fn look(&self, _: &mut Frame<f64>, _: &[Vec<[f64; 2]>], _: f64) -> Look {
        match *self {}
    }

    pub fn work_out(&self, _: &mut Frame<f64>, _: &[Vec<[f64; 2]>]) {
        match *self {}
    }
}
