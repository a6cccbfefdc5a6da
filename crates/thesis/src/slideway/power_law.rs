//! Power laws and their fit to points, which is a straight line on logarithmic paper.

use super::{Range, SlidewayError};

const ABSCISSA: Range = Range::positive("abscissa of a power law", "");
const ORDINATE: Range = Range::positive("ordinate of a power law", "");

/// y = factor x^exponent, in the units of its source.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::power_law::PowerLaw;
///
/// let law = PowerLaw::fit(&[(1.0, 3.0), (2.0, 12.0), (4.0, 48.0)])?;
/// assert!((law.factor - 3.0).abs() < 1e-9 && (law.exponent - 2.0).abs() < 1e-9);
/// assert!((law.inverse().at(law.at(5.0)) - 5.0).abs() < 1e-9);
/// assert!(PowerLaw::fit(&[(1.0, 3.0)]).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// y at x = 1.
    pub factor: f64,
    /// Relative change of y divided by the relative change of x.
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

    /// The inverse law, which gives x from y: (y / factor)^(1 / exponent).
    pub fn inverse(&self) -> Self {
        PowerLaw { factor: self.factor.powf(-1.0 / self.exponent), exponent: 1.0 / self.exponent }
    }

    /// The law that minimises the sum of the squared differences of logarithms. All points have the same weight.
    ///
    /// # Errors
    /// If a coordinate is not above 0, or fewer than two abscissas differ.
    pub fn fit(points: &[(f64, f64)]) -> Result<Self, SlidewayError> {
        let logarithms = logarithms(points)?;
        let (x_mean, y_mean) = (mean(logarithms.iter().map(|p| p.0)), mean(logarithms.iter().map(|p| p.1)));
        let spread: f64 = logarithms.iter().map(|(x, _)| (x - x_mean).powi(2)).sum();
        if spread.is_nan() || spread <= 0.0 {
            let reason = "at least two different abscissas are needed".to_owned();
            return Err(SlidewayError::NoSolution { sought: "power law", reason });
        }
        let joint: f64 = logarithms.iter().map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
        let exponent = joint / spread;
        Ok(PowerLaw { factor: (y_mean - exponent * x_mean).exp(), exponent })
    }

    /// The largest deviation of the law from the points, relative to their ordinates.
    pub fn max_deviation(&self, points: &[(f64, f64)]) -> f64 {
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
        fn fit_recovers_the_law_of_its_points(factor in 1e-6..1e6f64, exponent in -4.0..4.0f64) {
            let law = PowerLaw { factor, exponent };
            let points: Vec<_> = [0.2, 0.5, 1.0, 3.0].map(|x| (x, law.at(x))).into();
            let fit = PowerLaw::fit(&points).unwrap();
            prop_assert!((fit.factor / factor - 1.0).abs() < 1e-9 && (fit.exponent - exponent).abs() < 1e-9);
            prop_assert!(fit.max_deviation(&points) < 1e-9);
        }

        #[test]
        fn inverse_undoes_the_law(factor in 0.1..10.0f64, exponent in 0.1..4.0f64, x in 0.1..10.0f64) {
            let law = PowerLaw { factor, exponent };
            prop_assert!((law.inverse().at(law.at(x)) / x - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn points_without_a_fit_are_refused() {
        assert!(PowerLaw::fit(&[]).is_err());
        assert!(PowerLaw::fit(&[(1.0, 2.0), (1.0, 3.0)]).is_err());
        assert!(PowerLaw::fit(&[(1.0, 2.0), (-1.0, 3.0)]).is_err());
    }
}
