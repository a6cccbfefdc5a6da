//! Assigns the lines of a channel or row gap to parallel tracks so that few lines cross.
//!
//! The lines are ordered by sifting: each line in turn moves to its best position among the others.
//! Then each line gets the first track after those of earlier lines that overlap it.

use std::cmp::Ordering;

/// A line along a channel, with the positions along the channel at which it is connected.
///
/// "Before" is the left side of a channel or the upper side of a row gap, "after" the other side.
#[derive(Debug, Clone, Default)]
pub(super) struct ChannelLine {
    /// The positions of connections to the side before.
    pub before: Vec<f64>,
    /// The positions of connections to the side after.
    pub after: Vec<f64>,
    /// Positions that the line reaches within the channel.
    pub reach: Vec<f64>,
}

/// The minimum gap between lines on one track.
const LINE_GAP: f64 = 10.0;

/// The cost of an order in which the connections of two lines would overlap.
const OVERLAP_COST: usize = 1000;

impl ChannelLine {
    /// Returns all positions at which the line is connected or which it reaches.
    fn positions(&self) -> impl Iterator<Item = f64> + '_ {
        self.before.iter().chain(&self.after).chain(&self.reach).copied()
    }

    /// Returns the lowest and highest positions.
    pub(super) fn ends(&self) -> (f64, f64) {
        self.positions()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
    }

    /// Whether the line only crosses the channel, at one position.
    pub(super) fn is_straight(&self) -> bool {
        let (low, high) = self.ends();
        low >= high
    }

    /// Whether a connection at a position crosses the line.
    fn crossed_at(&self, position: f64) -> bool {
        let (low, high) = self.ends();
        (low..=high).contains(&position)
    }

    /// Returns the cost of the crossings if this line is before the other.
    fn crossings_before(&self, other: &ChannelLine) -> usize {
        let on = self.after.iter().filter(|position| other.crossed_at(**position)).count();
        let from = other.before.iter().filter(|position| self.crossed_at(**position)).count();
        let overlaps = self.after.iter().any(|position| other.before.contains(position));
        on + from + if overlaps { OVERLAP_COST } else { 0 }
    }
}

/// Returns the track of each line and the number of tracks. Straight crossings need no track.
pub(super) fn assign(lines: &[ChannelLine]) -> (Vec<usize>, usize) {
    let order = sorted_lines(lines);
    let mut tracks = vec![0; lines.len()];
    let mut count = 0;
    for (index, line) in order.iter().enumerate() {
        let near = order[..index].iter().filter(|earlier| overlap(&lines[*line], &lines[**earlier]));
        tracks[*line] = near.map(|earlier| tracks[*earlier] + 1).max().unwrap_or(0);
        count = count.max(tracks[*line] + 1);
    }
    (tracks, count)
}

/// Whether two lines are too close to share a track.
fn overlap(one: &ChannelLine, other: &ChannelLine) -> bool {
    let (one, other) = (one.ends(), other.ends());
    one.0 < other.1 + LINE_GAP && other.0 < one.1 + LINE_GAP
}

/// Returns the lines in an order with few crossings, found by repeated sifting.
fn sorted_lines(lines: &[ChannelLine]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..lines.len()).filter(|line| !lines[*line].is_straight()).collect();
    order.sort_by(|a, b| lines[*a].ends().partial_cmp(&lines[*b].ends()).unwrap_or(Ordering::Equal));
    let costs: Vec<Vec<usize>> =
        lines.iter().map(|one| lines.iter().map(|other| one.crossings_before(other)).collect()).collect();
    for _ in 0..ROUNDS {
        let previous = order.clone();
        for line in previous.clone() {
            sift(line, &mut order, &costs);
        }
        if order == previous {
            break;
        }
    }
    order
}

/// The maximum number of rounds of sifting.
const ROUNDS: usize = 8;

/// Moves one line to its best position; of equally good positions to the nearest.
fn sift(line: usize, order: &mut Vec<usize>, costs: &[Vec<usize>]) {
    let Some(now) = order.iter().position(|other| *other == line) else { return };
    order.remove(now);
    let mut cost: usize = order.iter().map(|other| costs[line][*other]).sum();
    let mut at = vec![cost];
    for other in order.iter() {
        cost = cost + costs[*other][line] - costs[line][*other];
        at.push(cost);
    }
    let best = (0..at.len()).min_by_key(|position| (at[*position], position.abs_diff(now)));
    order.insert(best.unwrap_or(now), line);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(before: &[f64], after: &[f64]) -> ChannelLine {
        ChannelLine { before: before.to_vec(), after: after.to_vec(), reach: vec![] }
    }

    #[test]
    fn separate_lines_share_a_track() {
        let lines = [line(&[0.0], &[50.0]), line(&[80.0], &[120.0]), line(&[70.0], &[70.0])];
        assert_eq!(assign(&lines), (vec![0, 0, 0], 1));
    }

    #[test]
    fn nested_lines_do_not_cross() {
        // The inner line is connected to the side after before the outer one is.
        let lines = [line(&[0.0], &[100.0]), line(&[20.0], &[80.0])];
        let (tracks, count) = assign(&lines);
        assert_eq!(count, 2);
        assert_eq!(lines[0].crossings_before(&lines[1]).min(lines[1].crossings_before(&lines[0])), 1);
        let (first, second) = if tracks[0] < tracks[1] { (0, 1) } else { (1, 0) };
        assert_eq!(lines[first].crossings_before(&lines[second]), 1);
    }

    #[test]
    fn connections_do_not_overlap() {
        // The second line enters at the position at which the first one leaves, so its track must be first.
        let lines = [line(&[0.0], &[50.0]), line(&[50.0], &[90.0])];
        let (tracks, _) = assign(&lines);
        assert!(tracks[1] < tracks[0]);
    }
}
