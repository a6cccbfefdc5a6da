//! Experiments: the document, its patch, its files, records, and what columns are like without any model.

pub(crate) mod columns;
pub(crate) mod document;
pub(crate) mod drive_timing;
pub(crate) mod examine;
pub(crate) mod experiment;
pub(crate) mod experiment_builder;
pub(crate) mod experiment_file;
pub(crate) mod fittable;
pub(crate) mod interpolation;
pub(crate) mod measured;
pub(crate) mod motion;
pub(crate) mod noise_level;
pub(crate) mod parts;
pub(crate) mod record;
pub(crate) mod subject;
