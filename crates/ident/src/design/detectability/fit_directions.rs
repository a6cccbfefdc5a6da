//! The part of an output change that a fit of the patch can follow, and its removal.
//!
//! A fit changes parameters, initial voltages and offsets. To first order, each changes the outputs along one
//! direction. Only the component of an effect that is orthogonal to all these directions remains visible in the
//! residual. Initial voltages and offsets are fitted again in validation. Parameters are taken from training, so
//! their directions are common to both.

use std::ops::Range;

use crate::design::detectability::record_group::{RecordGroup, remove_states};
use crate::statistics::projection::{
    MIN_INDEPENDENT_RATIO, dot, orthonormal, remove_projections, scale, subtract_multiple,
};

/// All outputs of the training records and of the validation records, over the noise. Records follow one another.
pub(super) type TrainAndValidation = [Vec<f64>; 2];

/// Orthonormal directions in the space of all outputs that a fit can follow.
pub(super) struct FitDirections {
    /// Directions of the initial voltages, by record: training first, then validation.
    states: [Vec<Vec<Vec<f64>>>; 2],
    /// Directions of parameters and offsets, which are determined in training. The second half is what follows from
    /// them in validation.
    common: Vec<TrainAndValidation>,
    /// Directions of the declared offsets in validation, where they are fitted again.
    offsets: Vec<Vec<f64>>,
}

impl FitDirections {
    /// The directions of the training and validation groups. `fit` is the number of fitted parameters. `more` has
    /// responses to further initial voltages, by record, such as those of an effect.
    pub(super) fn new(
        groups: [&RecordGroup<'_>; 2],
        fit: usize,
        more: [&[Vec<Vec<f64>>]; 2],
    ) -> FitDirections {
        let states = [0, 1].map(|group| {
            let responses = groups[group].states.iter().enumerate();
            let with_more = |(record, responses): (usize, &Vec<Vec<f64>>)| {
                let more = more[group].get(record).into_iter().flatten();
                orthonormal(responses.iter().chain(more).cloned())
            };
            responses.map(with_more).collect::<Vec<_>>()
        });
        let mut directions = FitDirections { states, common: Vec::new(), offsets: Vec::new() };
        let spans = groups.map(|group| group.spans.as_slice());
        for (train, validation) in groups[0].common.iter().zip(&groups[1].common) {
            let original_length = dot(train, train).sqrt();
            let [mut train, mut validation] =
                directions.remove_from(spans, [train.clone(), validation.clone()]);
            let length = dot(&train, &train).sqrt();
            if length > MIN_INDEPENDENT_RATIO * original_length {
                [&mut train, &mut validation].into_iter().for_each(|track| scale(track, 1.0 / length));
                directions.common.push([train, validation]);
            }
        }
        let offsets = groups[1].common[fit..].iter().map(|offset| {
            let mut offset = offset.clone();
            remove_states(&directions.states[1], spans[1], &mut offset);
            offset
        });
        directions.offsets = orthonormal(offsets);
        directions
    }

    /// The part of `change` that a fit cannot follow. `spans` has the range of every record in training and in
    /// validation.
    pub(super) fn remove_from(
        &self,
        spans: [&[Range<usize>]; 2],
        [mut train, mut validation]: TrainAndValidation,
    ) -> TrainAndValidation {
        remove_states(&self.states[0], spans[0], &mut train);
        remove_states(&self.states[1], spans[1], &mut validation);
        for [direction, follows] in &self.common {
            let share = dot(direction, &train);
            subtract_multiple(&mut train, share, direction);
            subtract_multiple(&mut validation, share, follows);
        }
        remove_projections(&self.offsets, &mut validation);
        [train, validation]
    }
}
