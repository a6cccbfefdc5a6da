//! Passes samples on in blocks, so that the memory of a run does not grow with their number.

use super::Recorder;

impl Recorder<'_> {
    /// Number of samples so far, including those that were flushed.
    pub(super) fn sample_count(&self) -> usize {
        self.flushed + self.trace.len()
    }

    /// Passes the samples of the record on if they fill a block.
    pub(super) fn flush_full_block(&mut self) {
        if self.block_samples.is_some_and(|samples| self.trace.len() >= samples) {
            self.flush();
        }
    }

    /// Passes the samples of the record on and removes them. Does nothing if the samples stay in the record.
    pub(in crate::solve) fn flush(&mut self) {
        if self.block_samples.is_none() || self.trace.is_empty() {
            return;
        }
        if let Some(consumer) = self.consumer.as_mut().filter(|_| !self.is_cancelled) {
            self.is_cancelled = consumer(&self.trace).is_break();
        }
        self.flushed += self.trace.len();
        self.trace.time.clear();
        self.trace.tracks.iter_mut().for_each(|track| track.volts.clear());
    }
}
