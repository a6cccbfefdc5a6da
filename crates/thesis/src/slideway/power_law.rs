//! Power laws, and the one that fits points best: a straight line drawn on logarithmic paper.

use super::{Range, SlidewayError};

const ABSCISSA: Range = Range::positive("abscissa of a power law", "");
const ORDINATE: Range = Range::positive("ordinate of a power law", "");

/// y = factor x^exponent, in the units of its source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// y at x = 1.
    pub factor: f64,
    /// By how many percent y grows where x grows by one.
    pub exponent: f64,
}

impl PowerLaw {
    /// A law as it is printed.
    pub const fn new(factor: f64, exponent: f64) -> Self {
        PowerLaw { factor, exponent }
    }

    /// y at x.
    pub fn at(&self, x: f64) -> f64 {
        self.factor * x.powf(self.exponent)
    }

    /// The law that gives x by y: (y / factor)^(1 / exponent).
    pub fn inverse(&self) -> Self {
        PowerLaw { factor: self.factor.powf(-1.0 / self.exponent), exponent: 1.0 / self.exponent }
    }

    /// The law with the least squares of differences of logarithms, all points weighing the same.
    ///
    /// # Errors
    /// Where a coordinate is not above 0, or fewer than two abscissas differ.
    pub fn fit(points: &[(f64, f64)]) -> Result<Self, SlidewayError> {
        let logarithms = logarithms(points)?;
        let (x_mean, y_mean) = (mean(logarithms.iter().map(|p| p.0)), mean(logarithms.iter().map(|p| p.1)));
        let spread: f64 = logarithms.iter().map(|(x, _)| (x - x_mean).powi(2)).sum();
        if spread.is_nan() || spread <= 0.0 {
            let because = "it takes points of at least two abscissas".to_owned();
            return Err(SlidewayError::NoSolution { sought: "power law", because });
        }
        let joint: f64 = logarithms.iter().map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
        let exponent = joint / spread;
        Ok(PowerLaw { factor: (y_mean - exponent * x_mean).exp(), exponent })
    }

    /// By how much the law misses the points at most, as a share of their ordinates.
    pub fn worst_miss(&self, points: &[(f64, f64)]) -> f64 {
        points.iter().map(|(x, y)| (self.at(*x) / y - 1.0).abs()).fold(0.0, f64::max)
    }
}

fn logarithms(points: &[(f64, f64)]) -> Result<Vec<(f64, f64)>, SlidewayError> {
    points.iter().map(|(x, y)| Ok((ABSCISSA.check(*x)?.ln(), ORDINATE.check(*y)?.ln()))).collect()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn points_of_a_law_give_it_back(factor in 1e-6..1e6f64, exponent in -4.0..4.0f64) {
            let law = PowerLaw { factor, exponent };
            let points: Vec<_> = [0.2, 0.5, 1.0, 3.0].map(|x| (x, law.at(x))).into();
            let fit = PowerLaw::fit(&points).unwrap();
            prop_assert!((fit.factor / factor - 1.0).abs() < 1e-9 && (fit.exponent - exponent).abs() < 1e-9);
            prop_assert!(fit.worst_miss(&points) < 1e-9);
        }

        #[test]
        fn the_inverse_undoes_it(factor in 0.1..10.0f64, exponent in 0.1..4.0f64, x in 0.1..10.0f64) {
            let law = PowerLaw { factor, exponent };
            prop_assert!((law.inverse().at(law.at(x)) / x - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn what_has_no_fit_is_told() {
        assert!(PowerLaw::fit(&[]).is_err());
        assert!(PowerLaw::fit(&[(1.0, 2.0), (1.0, 3.0)]).is_err());
        assert!(PowerLaw::fit(&[(1.0, 2.0), (-1.0, 3.0)]).is_err());
    }
}
