//! What fed drives do between their samples.

use crate::data::document::Hold;
use crate::statistics::directions::product;

/// A drive that goes on smoothly is told at so many places from sample to sample.
const PARTS: usize = 8;
/// It goes through so many samples at once.
const THROUGH: usize = 6;

/// The table of a drive that was sampled every `interval` seconds: times in seconds, values in its unit.
pub(crate) fn points(values: &[f64], interval: f64, hold: Hold) -> Vec<[f64; 2]> {
    match hold == Hold::Smooth && values.len() >= THROUGH {
        true => smooth(values, interval),
        false => {
            values.iter().enumerate().map(|(sample, value)| [sample as f64 * interval, *value]).collect()
        }
    }
}

/// From sample to sample the curve of fifth degree through the three on either side (Lagrange), at the ends through the first six or
/// the last. A sine of angular frequency w, sampled every h seconds, is missed by 5/1024 (w h)^6 of itself at most.
fn smooth(values: &[f64], interval: f64) -> Vec<[f64; 2]> {
    let weights: Vec<_> =
        (0..=(THROUGH - 1) * PARTS).map(|place| weights_at(place as f64 / PARTS as f64)).collect();
    let point = |place: usize| {
        let first = (place / PARTS).saturating_sub(THROUGH / 2 - 1).min(values.len() - THROUGH);
        let value = product(&weights[place - first * PARTS], &values[first..first + THROUGH]);
        [place as f64 / PARTS as f64 * interval, value]
    };
    (0..=(values.len() - 1) * PARTS).map(point).collect()
}

/// What each of six samples counts, so many samples behind the first of them.
fn weights_at(at: f64) -> [f64; THROUGH] {
    std::array::from_fn(|own| {
        let others = (0..THROUGH).filter(|other| *other != own);
        others.map(|other| (at - other as f64) / (own as f64 - other as f64)).product()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_drives_go_through_their_samples_and_follow_what_bends() {
        let bent = |t: f64| 1.0 - 2.0 * t + 0.5 * t * t - 0.1 * t.powi(5);
        let values: Vec<f64> = (0..7).map(|k| bent(0.5 * f64::from(k))).collect();
        let smooth = points(&values, 0.5, Hold::Smooth);
        assert_eq!((smooth.len(), smooth[0], smooth[48][0]), (49, [0.0, 1.0], 3.0));
        assert!(smooth.iter().all(|[t, value]| (value - bent(*t)).abs() < 1e-11));
        let turn = |k: u32| (0.5 * f64::from(k)).sin();
        let sine = points(&(0..40).map(turn).collect::<Vec<_>>(), 1.0, Hold::Smooth);
        let missed =
            sine[16..296].iter().map(|[t, value]| (value - (0.5 * t).sin()).abs()).fold(0.0, f64::max);
        assert!((0.5..1.0).contains(&(missed / (5.0 / 1024.0 * 0.5_f64.powi(6)))), "{missed}");
        let straight = points(&values, 0.5, Hold::Linear);
        assert!(straight.iter().zip(&values).all(|([_, told], value)| told == value) && straight.len() == 7);
        assert_eq!(points(&[1.0, 2.0, 4.0], 1.0, Hold::Smooth), [[0.0, 1.0], [1.0, 2.0], [2.0, 4.0]]);
        assert!(points(&[], 1.0, Hold::Smooth).is_empty());
    }
}
