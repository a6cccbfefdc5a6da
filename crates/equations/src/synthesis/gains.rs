//! Coefficients as pots, gains and cords: coefficient = pot x gain x number of equal cords.

use super::formula::Product;

/// The largest number of equal cords from one output to one amplifier.
pub(super) const MOST_CORDS: u32 = 5;
/// The gain of an additional summer.
pub(super) const GAIN_OF_SUMMER: f64 = 10.0;
/// The smallest setting of a pot that can be set accurately.
pub(super) const LEAST_SETTING: f64 = 0.1;
/// Rounding of a coefficient. It is within the tolerance of pot settings.
const ROUNDING: f64 = 5e-13;

/// A coefficient in volts per volt, without its sign.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coefficient {
    /// The present value.
    pub value: f64,
    /// The largest value over the ranges of the parameters.
    pub most: f64,
    /// Whether it depends on no parameter.
    pub is_fixed: bool,
}

/// How a voltage is multiplied by a coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Route {
    /// Whether there is a pot.
    pub has_pot: bool,
    /// Number of summers with a gain of 10 after the pot: 0 or 1.
    pub summers: u32,
    /// The gain of each cord.
    pub gain: f64,
    /// Number of equal cords.
    pub cords: u32,
}

impl Coefficient {
    /// Whether the coefficient is a number, except for rounding.
    pub(super) fn is(&self, number: f64) -> bool {
        (self.value / number - 1.0).abs() <= ROUNDING
    }

    /// Whether a pot can multiply by the coefficient.
    pub(super) fn fits_pot(&self) -> bool {
        self.value <= 1.0 + ROUNDING
    }
}

impl Route {
    /// A pot alone.
    pub(super) const POT: Route = Route { has_pot: true, summers: 0, gain: 1.0, cords: 1 };

    /// The factor of everything after the pot.
    pub(super) fn factor(&self) -> f64 {
        self.gain * f64::from(self.cords) * GAIN_OF_SUMMER.powi(self.summers as i32)
    }

    /// Divides the product of a coefficient by the factor of everything after the pot.
    pub(super) fn setting(&self, coefficient: Product) -> Product {
        coefficient.over_number(self.factor())
    }
}

/// The route for a coefficient into an amplifier with these gains, which ascend.
///
/// The gain is the smallest one that is not below the coefficient, so the pot is from 0.1 to 1 if that is possible. A
/// coefficient that equals a gain needs no pot, unless it depends on parameters; then the gain leaves space for larger
/// values. Above the largest gain there are several equal cords, and then an additional summer if it is permitted. `None`
/// if the coefficient is larger still.
pub(super) fn route(coefficient: &Coefficient, gains: &[f64], may_add_summer: bool) -> Option<Route> {
    let largest = gains.last().copied()?;
    // The gain for a coefficient of 0 follows from the values that it can have.
    let wanted = if coefficient.value == 0.0 { coefficient.most.min(largest) } else { coefficient.value };
    if let Some(first) = gains.iter().position(|gain| wanted <= gain * (1.0 + ROUNDING)) {
        return Some(single_cord(coefficient, &gains[first..]));
    }
    let cords = |value: f64| (value / largest * (1.0 - ROUNDING)).ceil();
    let most_cords = f64::from(MOST_CORDS);
    let summers = [0, u32::from(may_add_summer)].into_iter();
    let count = |summers: u32| (summers, cords(wanted / GAIN_OF_SUMMER.powi(summers as i32)));
    let (summers, cords) = summers.map(count).find(|(_, cords)| *cords <= most_cords)?;
    let route = Route { has_pot: true, summers, gain: largest, cords: cords as u32 };
    let is_exact = coefficient.is_fixed && coefficient.is(route.factor());
    Some(Route { has_pot: !is_exact, ..route })
}

/// The route through one cord. The first gain is not below the coefficient.
fn single_cord(coefficient: &Coefficient, gains: &[f64]) -> Route {
    let is_exact = coefficient.is(gains[0]);
    if is_exact && coefficient.is_fixed {
        return Route { has_pot: false, gain: gains[0], ..Route::POT };
    }
    let can_rise = coefficient.most > coefficient.value * (1.0 + ROUNDING);
    let gain = if is_exact && can_rise { gains.get(1).copied().unwrap_or(gains[0]) } else { gains[0] };
    Route { gain, ..Route::POT }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUMMER: [f64; 2] = [1.0, 10.0];
    const INTEGRATOR: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];

    /// A coefficient that depends on no parameter.
    fn fixed(value: f64) -> Coefficient {
        Coefficient { value, most: value, is_fixed: true }
    }

    /// A coefficient that depends on a parameter, with its largest value.
    fn variable(value: f64, most: f64) -> Coefficient {
        Coefficient { value, most, is_fixed: false }
    }

    fn cord(has_pot: bool, gain: f64) -> Option<Route> {
        Some(Route { has_pot, gain, ..Route::POT })
    }

    #[test]
    fn a_coefficient_that_equals_a_gain_needs_no_pot() {
        assert_eq!(route(&fixed(1.0), &SUMMER, true), cord(false, 1.0));
        assert_eq!(route(&fixed(10.0), &SUMMER, true), cord(false, 10.0));
        assert_eq!(route(&fixed(0.1 + 0.2 + 0.7), &SUMMER, true), cord(false, 1.0));
        assert_eq!(route(&fixed(1000.0), &INTEGRATOR, false), cord(false, 1000.0));
    }

    #[test]
    fn a_pot_is_from_0_1_to_1_if_that_is_possible() {
        assert_eq!(route(&fixed(0.39), &SUMMER, true), cord(true, 1.0));
        assert_eq!(route(&fixed(2.5), &SUMMER, true), cord(true, 10.0));
        assert_eq!(route(&fixed(393.0), &INTEGRATOR, false), cord(true, 1000.0));
        assert_eq!(route(&fixed(0.05), &SUMMER, true), cord(true, 1.0));
    }

    #[test]
    fn a_parameter_that_can_rise_gets_a_larger_gain() {
        assert_eq!(route(&variable(1.0, 1.5), &SUMMER, true), cord(true, 10.0));
        assert_eq!(route(&variable(1.0, 1.0), &SUMMER, true), cord(true, 1.0));
        // A larger gain would need a pot below 0.1.
        assert_eq!(route(&variable(0.5, 1.5), &SUMMER, true), cord(true, 1.0));
        assert_eq!(route(&variable(0.0, 30.0), &INTEGRATOR, false), cord(true, 100.0));
        assert_eq!(route(&variable(0.0, 0.0), &INTEGRATOR, false), cord(true, 1.0));
    }

    #[test]
    fn a_fixed_coefficient_needs_no_larger_gain() {
        // Parameters cancel in k y / k. The largest value of the first factor does not matter.
        let fixed = Coefficient { value: 1.0, most: 6.7, is_fixed: true };
        assert_eq!(route(&fixed, &SUMMER, true), cord(false, 1.0));
        assert_eq!(route(&fixed, &INTEGRATOR, false), cord(false, 1.0));
    }

    #[test]
    fn a_coefficient_above_the_largest_gain_has_several_cords() {
        let route_of = |value, gains: &[f64]| route(&fixed(value), gains, false);
        let several = |has_pot, gain, cords| Some(Route { has_pot, summers: 0, gain, cords });
        assert_eq!(route_of(25.2, &SUMMER), several(true, 10.0, 3));
        assert_eq!(route_of(30.0, &SUMMER), several(false, 10.0, 3));
        assert_eq!(route_of(4200.0, &INTEGRATOR), several(true, 1000.0, 5));
        assert_eq!(route_of(5100.0, &INTEGRATOR), None);
        assert_eq!(route_of(51.0, &SUMMER), None);
    }

    #[test]
    fn a_large_coefficient_has_an_additional_summer() {
        let large = route(&fixed(252.0), &SUMMER, true).unwrap();
        assert_eq!((large.summers, large.gain, large.cords, large.has_pot), (1, 10.0, 3, true));
        assert!((252.0 / large.factor() - 0.84).abs() < 1e-12);
        assert_eq!(route(&fixed(501.0), &SUMMER, true), None);
        assert_eq!(route(&fixed(f64::NAN), &SUMMER, true), None);
    }
}
