//! What a patch is held against: records to fit and to confirm with, and the noise of what they hold.

use crate::data::experiment::Feed;
use crate::data::record::Record;
use crate::fit::estimate::Point;
use crate::fit::fitted_model::Version;
use crate::fit::levenberg_marquardt::{Ladder, MOST_ROUNDS, SETTLED_SHARE, Task};
use crate::fit::model::{Model, ModelError};

/// What a patch is held against.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Drives that the records feed.
    pub drives: Vec<Feed>,
    /// Standard deviation of the noise of each.
    pub drive_sigma: Vec<f64>,
    /// Signals that they hold.
    pub outputs: Vec<String>,
    /// Standard deviation of the noise of each.
    pub sigma: Vec<f64>,
    /// Which of them may stand off by a constant.
    pub offset: Vec<bool>,
    /// Records to fit.
    pub train: Vec<Record>,
    /// The same cut into pieces, over which errors cannot grow far.
    pub pieces: Vec<Record>,
    /// Into how many of these each record is cut, if it is long enough.
    pub(crate) cuts: usize,
    /// Records to confirm with.
    pub test: Vec<Record>,
    /// Whether the records are pieces already, as the experiment asks.
    pub is_cut: bool,
    /// Steps of the solver from sample to sample, for the patch as it is.
    pub steps: u32,
}

/// No piece of a record has fewer samples than this.
const LEAST_PIECE: usize = 40;

impl Problem {
    /// An output of a record as a patch makes it that leaves this of the record.
    pub(crate) fn made(&self, record: &Record, left: &[Vec<f64>], output: usize) -> Vec<f64> {
        let sigma = self.sigma[output];
        record.outputs[output].iter().zip(&left[output]).map(|(datum, left)| datum - sigma * left).collect()
    }

    pub(crate) fn model(
        &self,
        version: &Version,
        records: &[Record],
        outputs: &[String],
    ) -> Result<Model, ModelError> {
        let lowered = version.lowered(&self.drives)?;
        Model::new(&lowered, version.patch(), records, &version.fit, &version.free, outputs, version.steps)
    }

    pub(crate) fn task<'a>(&'a self, model: &'a Model, records: &'a [Record], turns: bool) -> Task<'a> {
        let (sigma, offset) = (&self.sigma, &self.offset);
        Task {
            model,
            records,
            sigma,
            offset,
            turns,
            held: None,
            wanted: f64::INFINITY,
            most_rounds: MOST_ROUNDS,
            settled: SETTLED_SHARE,
            dampings: if model.goes_abreast() { Ladder::MANY } else { Ladder::ONE },
        }
    }

    /// A point of the pieces as one of the records whole.
    pub(crate) fn joined_up(&self, point: &Point) -> Point {
        let mut first = 0;
        let initial = self.train.iter().map(|record| {
            let own = point.initial[first].clone();
            first += record.pieces(self.cuts, LEAST_PIECE).len();
            own
        });
        Point { initial: initial.collect(), ..point.clone() }
    }
}

/// Records each cut into so many pieces, if it is long enough: over these errors cannot grow far.
pub(crate) fn in_pieces(records: &[Record], cuts: usize) -> Vec<Record> {
    records.iter().flat_map(|record| record.pieces(cuts, LEAST_PIECE)).collect()
}
