//! Derivatives of runs by parameters, compared with closed solutions and with differences of whole runs.

mod closed_form;
mod comparison;
mod differences;
mod phases;
mod random;
mod shipped;
mod undefined;
