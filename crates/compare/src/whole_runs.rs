//! Simulation of an experiment in whole runs.
//!
//! The records of an experiment are parts of files: for training, and for validation. A fit begins each of them with its
//! own initial voltages. A simulation has only those of the patch. So records that follow each other in a file are
//! simulated in one run, as they were measured.

use std::iter;
use std::ops::Range;

use patchcord_ident::{Experiment, ModelError, Problem, Record, Simulation};

use crate::message::{model_message, overload_message};

/// Largest difference of two times that count as equal, as a fraction of the interval of the samples.
const TIME_TOLERANCE: f64 = 0.25;

/// A simulated output of a record, sample by sample. Entry i belongs to output i.
pub(crate) type Outputs = Vec<Vec<f64>>;

/// An experiment that is ready to be simulated.
#[derive(Debug)]
pub(crate) struct WholeRuns {
    /// The records that are run.
    runs: Vec<Record>,
    /// For every record of the experiment, training and then validation, its run and its samples there.
    places: Vec<(usize, Range<usize>)>,
    /// The patch, compiled for the runs.
    simulation: Simulation,
}

impl WholeRuns {
    /// Prepares an experiment. `problem` is that of the experiment.
    ///
    /// # Errors
    /// If the patch cannot be compiled, or if a record cannot feed it.
    pub(crate) fn new(experiment: &Experiment, problem: &Problem) -> Result<WholeRuns, ModelError> {
        let records: Vec<&Record> = experiment.train.iter().chain(&experiment.validation).collect();
        let (runs, places) = joined(&records);
        let whole = Experiment { train: runs.clone(), validation: Vec::new(), ..experiment.clone() };
        let simulation = Simulation::new(&whole, problem)?;
        Ok(WholeRuns { runs, places, simulation })
    }

    /// Simulates with these values of parameters. Returns the outputs of every record, and a message about the first
    /// amplifier that is overloaded.
    ///
    /// # Errors
    /// The message if a run fails.
    pub(crate) fn simulate(
        &self,
        values: &[(String, f64)],
    ) -> Result<(Vec<Outputs>, Option<String>), String> {
        let simulated = self.simulation.run(values).map_err(|error| model_message(&error))?;
        let runs = || self.runs.iter().zip(&simulated);
        for (record, simulated) in runs() {
            if let Some(stopped) = &simulated.stopped {
                return Err(format!("with {}, the run stops: {stopped}", record.name));
            }
        }
        let overload = runs().find_map(|(record, simulated)| {
            simulated.overload.as_ref().map(|overload| overload_message(record, overload))
        });
        let outputs = self.places.iter().map(|(run, samples)| {
            let outputs = simulated[*run].outputs.iter();
            outputs.map(|values| values[samples.clone()].to_vec()).collect()
        });
        Ok((outputs.collect(), overload))
    }
}

/// Joins records that follow each other in a file. Returns the joined records, and for every record its run and its
/// samples there.
fn joined(records: &[&Record]) -> (Vec<Record>, Vec<(usize, Range<usize>)>) {
    let mut order: Vec<usize> = (0..records.len()).collect();
    order.sort_by(|a, b| records[*a].begin.total_cmp(&records[*b].begin));
    let mut runs: Vec<Record> = Vec::new();
    let mut places = vec![(0, 0..0); records.len()];
    for index in order {
        let record = records[index];
        let before = runs.iter().enumerate().find_map(|(run, whole)| Some((run, gap(whole, record)?)));
        let run = match before {
            Some((run, missing)) => {
                append(&mut runs[run], record, missing);
                run
            }
            None => {
                runs.push(record.clone());
                runs.len() - 1
            }
        };
        let end = runs[run].len();
        places[index] = (run, end - record.len()..end);
    }
    (runs, places)
}

/// The number of samples between two records that can be joined. None if they cannot: the second one is not later in the
/// same file, or what a drive did between them is not known.
fn gap(first: &Record, second: &Record) -> Option<usize> {
    let is_same_file = first.name == second.name && first.interval == second.interval;
    let samples = (second.begin - first.begin) / first.interval - first.len() as f64;
    let is_later = samples > -TIME_TOLERANCE && (samples - samples.round()).abs() < TIME_TOLERANCE;
    let missing = samples.round().max(0.0) as usize;
    let is_driven = !first.drives.is_empty();
    (is_same_file && is_later && (missing == 0 || !is_driven)).then_some(missing)
}

/// Appends a record to one that it follows, with `missing` samples without data between them.
fn append(first: &mut Record, second: &Record, missing: usize) {
    for (samples, more) in first.outputs.iter_mut().zip(&second.outputs) {
        samples.extend(iter::repeat_n(f64::NAN, missing));
        samples.extend(more);
    }
    for (samples, more) in first.drives.iter_mut().zip(&second.drives) {
        samples.extend(more);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A record of a file whose samples are their numbers in the file, one per half second from 10 s.
    fn record(name: &str, samples: Range<u32>, is_driven: bool) -> Record {
        let values: Vec<f64> = samples.clone().map(f64::from).collect();
        let start = 0.5 * f64::from(samples.start);
        Record {
            name: name.to_owned(),
            begin: 10.0 + start,
            start_in_file: start,
            interval: 0.5,
            jitter: 0.0,
            drives: if is_driven { vec![values.clone()] } else { Vec::new() },
            outputs: vec![values],
        }
    }

    #[test]
    fn the_parts_of_a_file_are_one_run() {
        let [train, test] = [0..30, 30..40].map(|samples| record("a.csv", samples, true));
        let other = record("b.csv", 30..40, true);
        let (runs, places) = joined(&[&test, &train, &other]);
        assert_eq!(runs, [record("a.csv", 0..40, true), other]);
        assert_eq!(places, [(0, 30..40), (0, 0..30), (1, 0..10)]);
    }

    #[test]
    fn a_gap_is_only_crossed_without_drives() {
        for is_driven in [false, true] {
            let [train, test] = [0..30, 33..40].map(|samples| record("a.csv", samples, is_driven));
            let (runs, places) = joined(&[&train, &test]);
            assert_eq!(runs.len(), if is_driven { 2 } else { 1 });
            let (run, samples) = places[1].clone();
            assert_eq!(runs[run].outputs[0][samples], test.outputs[0]);
        }
    }

    #[test]
    fn records_that_overlap_are_run_separately() {
        let [train, test] = [0..30, 25..40].map(|samples| record("a.csv", samples, false));
        assert_eq!(joined(&[&train, &test]).0.len(), 2);
    }
}
