//! Tracks, less what a fit of the patch follows of them.

use std::ops::Range;

use crate::design::detectability::half::{Half, clear_states};
use crate::statistics::directions::{NEW, clear, orthonormal, product, scale, subtract};

/// Tracks over the records to train on and over those that are held back.
pub(super) type Both = [Vec<f64>; 2];

/// Directions that a fit follows, of length 1 and at right angles.
pub(super) struct Cleared {
    /// By record, those of initial voltages: in training, and in what is held back.
    states: [Vec<Vec<Vec<f64>>>; 2],
    /// Those that training finds, with what follows from them for what is held back.
    common: Vec<Both>,
    /// Those of declared offsets, which are found again in what is held back.
    offsets: Vec<Vec<f64>>,
}

impl Cleared {
    /// What halves follow, `fit` knobs being fitted, with further initial voltages by record.
    pub(super) fn of(halves: [&Half<'_>; 2], fit: usize, more: [&[Vec<Vec<f64>>]; 2]) -> Cleared {
        let states = [0, 1].map(|half| {
            let own = halves[half].states.iter().enumerate();
            let with = |(record, own): (usize, &Vec<Vec<f64>>)| {
                let more = more[half].get(record).into_iter().flatten();
                orthonormal(own.iter().chain(more).cloned())
            };
            own.map(with).collect::<Vec<_>>()
        });
        let mut cleared = Cleared { states, common: Vec::new(), offsets: Vec::new() };
        let spans = halves.map(|half| half.spans.as_slice());
        for (train, test) in halves[0].common.iter().zip(&halves[1].common) {
            let was = product(train, train).sqrt();
            let [mut train, mut test] = cleared.without(spans, [train.clone(), test.clone()]);
            let length = product(&train, &train).sqrt();
            if length > NEW * was {
                [&mut train, &mut test].into_iter().for_each(|track| scale(track, 1.0 / length));
                cleared.common.push([train, test]);
            }
        }
        let offsets = halves[1].common[fit..].iter().map(|offset| {
            let mut offset = offset.clone();
            clear_states(&cleared.states[1], spans[1], &mut offset);
            offset
        });
        cleared.offsets = orthonormal(offsets);
        cleared
    }

    /// What is left of tracks.
    pub(super) fn without(&self, spans: [&[Range<usize>]; 2], [mut train, mut test]: Both) -> Both {
        clear_states(&self.states[0], spans[0], &mut train);
        clear_states(&self.states[1], spans[1], &mut test);
        for [direction, follows] in &self.common {
            let share = product(direction, &train);
            subtract(&mut train, share, direction);
            subtract(&mut test, share, follows);
        }
        clear(&self.offsets, &mut test);
        [train, test]
    }
}
