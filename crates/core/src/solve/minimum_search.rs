//! The search for the minimum of a voltage within a step.

/// Tolerance of the position of an extremum, as a share of the step. The voltage is flat there, so its error is of the
/// order of the square.
const POSITION_TOLERANCE: f64 = 1e-4;
/// Largest distance of an extremum from the turning point of the samples, as a share of the step.
const SEARCH_RADIUS: f64 = 0.3;
/// The share of the longer part that the golden section tries next: (3 - sqrt 5) / 2.
const GOLDEN_SHARE: f64 = 0.381_966_011_250_105;
/// Largest number of positions that a search evaluates after the first.
const MAX_EVALUATIONS: usize = 40;

/// The search for the minimum of a function (Brent 1973): by parabolas through the three best positions, with the
/// golden section as a safeguard. Positions are shares of the step.
pub(super) struct MinimumSearch {
    /// The positions between which the minimum is.
    ends: [f64; 2],
    /// The position with the least value, and the value.
    pub best: (f64, f64),
    /// The position with the second least value, and the value.
    second: (f64, f64),
    /// The position with the third least value, and the value.
    third: (f64, f64),
    /// The last two moves, the latest last.
    moves: [f64; 2],
    /// Number of positions that may still be evaluated.
    left: usize,
}

impl MinimumSearch {
    /// A search around a position within a step, with the value there.
    pub(super) fn around(position: f64, value: f64) -> Self {
        let ends = [(position - SEARCH_RADIUS).max(0.0), (position + SEARCH_RADIUS).min(1.0)];
        MinimumSearch::new(ends, position, value)
    }

    /// A search between two ends that begins at a position with a known value.
    fn new(ends: [f64; 2], position: f64, value: f64) -> Self {
        let first = (position, value);
        MinimumSearch {
            ends,
            best: first,
            second: first,
            third: first,
            moves: [0.0; 2],
            left: MAX_EVALUATIONS,
        }
    }

    /// The position to evaluate next; `None` if the position of the minimum is known to [`POSITION_TOLERANCE`], or
    /// after [`MAX_EVALUATIONS`].
    pub(super) fn next(&mut self) -> Option<f64> {
        let ([low, high], (position, _)) = (self.ends, self.best);
        let middle = 0.5 * (low + high);
        if self.left == 0 || (position - middle).abs() + 0.5 * (high - low) <= 2.0 * POSITION_TOLERANCE {
            return None;
        }
        self.left -= 1;
        // A parabola is used only if its move is less than half of the move before the last, and stays inside.
        let vertex = self.vertex().filter(|step| {
            step.abs() < 0.5 * self.moves[0].abs()
                && low + POSITION_TOLERANCE < position + step
                && position + step < high - POSITION_TOLERANCE
        });
        self.moves = match vertex {
            Some(step) => [self.moves[1], step],
            None => {
                let longer = if position < middle { high - position } else { low - position };
                [longer, GOLDEN_SHARE * longer]
            }
        };
        let step = self.moves[1];
        Some(
            position + if step.abs() < POSITION_TOLERANCE { POSITION_TOLERANCE.copysign(step) } else { step },
        )
    }

    /// The distance from the best position to the vertex of the parabola through the three best positions; `None` if
    /// two of them coincide or all are on a straight line.
    fn vertex(&self) -> Option<f64> {
        let [(x, value), (second_x, second_value), (third_x, third_value)] =
            [self.best, self.second, self.third];
        let to_third = (x - second_x) * (value - third_value);
        let to_second = (x - third_x) * (value - second_value);
        let step = -0.5 * ((x - third_x) * to_second - (x - second_x) * to_third) / (to_second - to_third);
        step.is_finite().then_some(step)
    }

    /// Adds the value at a position. One end of the search moves to the worse of this position and the best one.
    pub(super) fn add(&mut self, position: f64, value: f64) {
        let (worse, is_better) = if value <= self.best.1 { (self.best.0, true) } else { (position, false) };
        // The worse of the two bounds the search on its side of the better one.
        let better = if is_better { position } else { self.best.0 };
        self.ends[usize::from(worse > better)] = worse;
        if is_better {
            (self.third, self.second, self.best) = (self.second, self.best, (position, value));
        } else if value <= self.second.1 || self.second.0 == self.best.0 {
            (self.third, self.second) = (self.second, (position, value));
        } else if value <= self.third.1 || self.third.0 == self.best.0 || self.third.0 == self.second.0 {
            self.third = (position, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The position at which a search finds the minimum of a function, and the number of evaluations.
    fn minimise(function: impl Fn(f64) -> f64, start: f64) -> (f64, usize) {
        let mut search = MinimumSearch::new([0.0, 1.0], start, function(start));
        let mut evaluations = 1;
        while let Some(position) = search.next() {
            search.add(position, function(position));
            evaluations += 1;
        }
        (search.best.0, evaluations)
    }

    #[test]
    fn the_minimum_is_found_in_a_valley_at_a_corner_and_at_an_end() {
        for minimum in [0.0, 0.123, 0.5, 0.9] {
            let (position, evaluations) = minimise(|x| (x - minimum).powi(2) * (3.0 + x), 0.45);
            assert!(
                (position - minimum).abs() < 3.0 * POSITION_TOLERANCE && evaluations < 25,
                "{position} for {minimum} after {evaluations}"
            );
            let (position, evaluations) = minimise(|x| (x - minimum).abs() * (3.0 + x), 0.45);
            assert!(
                (position - minimum).abs() < 3.0 * POSITION_TOLERANCE && evaluations < MAX_EVALUATIONS,
                "{position} for {minimum} after {evaluations}"
            );
        }
    }
}
