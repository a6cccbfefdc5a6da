//! Tracks: parallel lines side by side in a channel or street, ordered so that few cross.

use std::cmp::Ordering;

/// A line along a channel, seen across it: what reaches it from the side before it and from the side after it.
#[derive(Debug, Clone, Default)]
pub(super) struct Bus {
    /// Places along the channel at which something comes from before.
    pub before: Vec<f64>,
    /// Places at which something goes on to after.
    pub after: Vec<f64>,
    /// Places that it reaches along the channel without leaving it.
    pub reach: Vec<f64>,
}

/// Lines on one track are at least this far apart.
const APART: f64 = 10.0;

/// What one line before the other costs when they would run in one.
const IN_LINE: usize = 1000;

impl Bus {
    fn places(&self) -> impl Iterator<Item = f64> + '_ {
        self.before.iter().chain(&self.after).chain(&self.reach).copied()
    }

    /// Its least and greatest place.
    pub fn ends(&self) -> (f64, f64) {
        self.places().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
    }

    /// Whether it is a mere crossing of the channel.
    pub fn is_straight(&self) -> bool {
        let (low, high) = self.ends();
        low >= high
    }

    fn crossed_at(&self, place: f64) -> bool {
        let (low, high) = self.ends();
        (low..=high).contains(&place)
    }

    /// Crossings when this one comes before the other.
    fn crossings_before(&self, other: &Bus) -> usize {
        let on = self.after.iter().filter(|place| other.crossed_at(**place)).count();
        let from = other.before.iter().filter(|place| self.crossed_at(**place)).count();
        let in_line = self.after.iter().any(|place| other.before.contains(place));
        on + from + if in_line { IN_LINE } else { 0 }
    }
}

/// The track of every line, and how many tracks there are; lines that cross straight need none.
pub(super) fn assign(buses: &[Bus]) -> (Vec<usize>, usize) {
    let order = ordered(buses);
    let mut tracks = vec![0; buses.len()];
    let mut count = 0;
    for (index, bus) in order.iter().enumerate() {
        let near = order[..index].iter().filter(|earlier| overlap(&buses[*bus], &buses[**earlier]));
        tracks[*bus] = near.map(|earlier| tracks[*earlier] + 1).max().unwrap_or(0);
        count = count.max(tracks[*bus] + 1);
    }
    (tracks, count)
}

fn overlap(one: &Bus, other: &Bus) -> bool {
    let (one, other) = (one.ends(), other.ends());
    one.0 < other.1 + APART && other.0 < one.1 + APART
}

/// Puts every line where it crosses least, again and again.
fn ordered(buses: &[Bus]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..buses.len()).filter(|bus| !buses[*bus].is_straight()).collect();
    order.sort_by(|a, b| buses[*a].ends().partial_cmp(&buses[*b].ends()).unwrap_or(Ordering::Equal));
    let costs: Vec<Vec<usize>> =
        buses.iter().map(|one| buses.iter().map(|other| one.crossings_before(other)).collect()).collect();
    for _ in 0..ROUNDS {
        let was = order.clone();
        for bus in was.clone() {
            sift(bus, &mut order, &costs);
        }
        if order == was {
            break;
        }
    }
    order
}

const ROUNDS: usize = 8;

/// Moves one line to the best of its places among the others; the first of equals that it meets from where it is.
fn sift(bus: usize, order: &mut Vec<usize>, costs: &[Vec<usize>]) {
    let Some(now) = order.iter().position(|other| *other == bus) else { return };
    order.remove(now);
    let mut cost: usize = order.iter().map(|other| costs[bus][*other]).sum();
    let mut at = vec![cost];
    for other in order.iter() {
        cost = cost + costs[*other][bus] - costs[bus][*other];
        at.push(cost);
    }
    let best = (0..at.len()).min_by_key(|place| (at[*place], place.abs_diff(now)));
    order.insert(best.unwrap_or(now), bus);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bus(before: &[f64], after: &[f64]) -> Bus {
        Bus { before: before.to_vec(), after: after.to_vec(), reach: vec![] }
    }

    #[test]
    fn lines_apart_share_a_track_and_straight_ones_need_none() {
        let buses = [bus(&[0.0], &[50.0]), bus(&[80.0], &[120.0]), bus(&[70.0], &[70.0])];
        assert_eq!(assign(&buses), (vec![0, 0, 0], 1));
    }

    #[test]
    fn nested_lines_do_not_cross() {
        // The inner line goes on before the outer one does.
        let buses = [bus(&[0.0], &[100.0]), bus(&[20.0], &[80.0])];
        let (tracks, count) = assign(&buses);
        assert_eq!(count, 2);
        assert_eq!(buses[0].crossings_before(&buses[1]).min(buses[1].crossings_before(&buses[0])), 1);
        let (first, second) = if tracks[0] < tracks[1] { (0, 1) } else { (1, 0) };
        assert_eq!(buses[first].crossings_before(&buses[second]), 1);
    }

    #[test]
    fn what_comes_from_before_is_not_run_into() {
        // The second comes in where the first goes on: it must be met before.
        let buses = [bus(&[0.0], &[50.0]), bus(&[50.0], &[90.0])];
        let (tracks, _) = assign(&buses);
        assert!(tracks[1] < tracks[0]);
    }
}
