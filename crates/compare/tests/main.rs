//! Integration tests of the comparison with measured data.

mod faults;
mod files;
mod protocol;
mod slide;
mod spring;
mod units;
