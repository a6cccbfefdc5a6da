//! Experiments: a document, its patch and its data files become records in the units of the patch.
//!
//! `experiment_file` reads the text and `experiment_document` turns it into typed entries. `experiment_builder` then
//! combines the entries with the patch (`checked_patch`) and with the CSV files (`measured_file`). Both are in a folder
//! or in memory (`file_source`). `record_split` divides each file into training and validation data, and `record`
//! extracts the samples. `fittable` selects the parameters to fit. Finally, `column_checks` compares every column with
//! the scale of its drive or signal. All faults are collected, so that one run reports all of them.
//!
//! `data_columns` lists the columns of a data file before there is an experiment. `examine` and `noise_level` describe
//! samples without any model. `drive_timing` and `interpolation` specify what the drives do between records and between
//! samples.

pub(crate) mod checked_patch;
pub mod codes;
pub(crate) mod column_checks;
pub(crate) mod columns;
pub(crate) mod data_columns;
pub(crate) mod drive_timing;
pub(crate) mod examine;
pub(crate) mod experiment;
pub(crate) mod experiment_builder;
pub(crate) mod experiment_document;
pub(crate) mod experiment_file;
pub(crate) mod file_source;
pub(crate) mod fittable;
pub(crate) mod interpolation;
pub(crate) mod measured_file;
pub(crate) mod noise_level;
pub(crate) mod record;
pub(crate) mod record_split;
