//! Integration tests of the comparison with measured data.

mod faults;
mod files;
mod slide;
mod spring;
mod units;
