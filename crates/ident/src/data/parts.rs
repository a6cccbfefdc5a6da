//! Which samples of a record are trained on, and which are kept for the test.

use std::ops::Range;

use crate::data::document::Held;
use crate::data::measured::Measured;
use crate::data::record::LEAST_SAMPLES;
use patchcord_core::document::{Placed, Span};

/// Of which part of a record there is talk, for messages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Use {
    Train,
    Test,
}

/// A stretch of even times, what it is for, and where the experiment asks for it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    pub places: Range<usize>,
    pub used: Use,
    pub span: Span,
}

/// What training takes of a record where nothing says so, in quarters.
const TRAINED: usize = 3;

/// A record, what the experiment asks for, and in how many seconds it tells times.
pub(crate) struct Cutting<'a> {
    pub measured: &'a Measured,
    pub seconds: f64,
    /// The part of the file that is the record.
    pub range: Option<&'a Placed<(f64, f64)>>,
    /// Where the record is asked for.
    pub span: Span,
}

impl Cutting<'_> {
    /// All of the record.
    pub fn whole(&self) -> Range<usize> {
        self.range.map_or(0..self.measured.len(), |range| self.within(range))
    }

    fn within(&self, range: &Placed<(f64, f64)>) -> Range<usize> {
        let (from, to) = range.value;
        self.measured.within((from * self.seconds, to * self.seconds))
    }

    /// The part of a range that lies within the record.
    fn part(&self, range: &Placed<(f64, f64)>, used: Use) -> Part {
        let (asked, whole) = (self.within(range), self.whole());
        let start = asked.start.max(whole.start);
        Part { places: start..asked.end.min(whole.end).max(start), used, span: range.span }
    }

    /// All of the record, for one use.
    pub fn entire(&self, used: Use) -> Part {
        Part { places: self.whole(), used, span: self.range.map_or(self.span, |range| range.span) }
    }

    /// What is trained on, and what is tested on.
    pub fn parts(&self, train: Option<&Placed<(f64, f64)>>, test: &Held) -> Vec<Part> {
        let whole = self.whole();
        let trained = train.map(|range| self.part(range, Use::Train));
        let tested = match test {
            Held::Records(_) => return vec![trained.unwrap_or_else(|| self.entire(Use::Train))],
            Held::Part(range) => Some(self.part(range, Use::Test)),
            Held::Rest => None,
        };
        let (trained, tested) = match (trained, tested) {
            (Some(trained), Some(tested)) => (trained, tested),
            (Some(trained), None) => {
                let places = trained.places.end..whole.end;
                let tested = Part { places, used: Use::Test, span: trained.span };
                (trained, tested)
            }
            (None, Some(tested)) => {
                let before = whole.start..tested.places.start;
                let behind = tested.places.end..whole.end;
                let places = if before.len() < LEAST_SAMPLES { behind } else { before };
                (Part { places, used: Use::Train, span: tested.span }, tested)
            }
            (None, None) => {
                let middle = whole.start + whole.len() * TRAINED / 4;
                let part = |places, used| Part { places, used, span: self.span };
                (part(whole.start..middle, Use::Train), part(middle..whole.end, Use::Test))
            }
        };
        vec![trained, tested]
    }
}

/// How many samples two stretches share.
pub(crate) fn in_both(one: &Range<usize>, other: &Range<usize>) -> usize {
    one.end.min(other.end).saturating_sub(one.start.max(other.start))
}

/// The sample at which one ends and the other begins belongs to what is trained on alone.
pub(crate) fn apart(trained: &Range<usize>, tested: &mut Range<usize>) -> usize {
    let shared = in_both(trained, tested);
    if shared != 1 || tested.len() < 2 {
        return shared;
    }
    if tested.start + 1 == trained.end {
        tested.start += 1;
    } else {
        tested.end -= 1;
    }
    0
}
