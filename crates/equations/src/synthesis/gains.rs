//! Coefficients as pots, gains and cords: coefficient = pot x gain x number of equal cords.

use super::formula::SettingFormula;

/// The largest number of equal cords from one output to one amplifier.
pub(super) const MOST_CORDS: u32 = 5;
/// The gain of an additional summer.
pub(super) const GAIN_OF_SUMMER: f64 = 10.0;
/// The smallest setting of a pot that can be set accurately.
pub(super) const LEAST_SETTING: f64 = 0.1;
/// The largest setting of a pot whose coefficient can rise. Above it there is no space for a change.
pub(super) const MOST_SETTING: f64 = 0.98;
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
    /// Whether it depends on a parameter without a range, so that it can exceed `most`.
    pub is_unbounded: bool,
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

    /// Whether a pot can multiply by the coefficient. A pot that is nearly fully open could not follow a parameter.
    pub(super) fn fits_pot(&self) -> bool {
        self.value <= 1.0 + ROUNDING && !self.lacks_reserve(1.0)
    }

    /// The largest value that it can have.
    fn largest(&self) -> f64 {
        if self.is_fixed { self.value } else { self.most }
    }

    /// Whether a pot in front of this factor is nearly fully open, although the coefficient can exceed the factor.
    fn lacks_reserve(&self, factor: f64) -> bool {
        let is_open = self.value > MOST_SETTING * factor;
        let can_exceed = self.largest() > factor * (1.0 + ROUNDING) || (self.is_unbounded && !self.is_fixed);
        is_open && can_exceed
    }

    /// Whether a pot in front of this factor is at least 0.1, and valid in the ranges of the parameters.
    fn has_space(&self, factor: f64) -> bool {
        let is_accurate = self.value == 0.0 || self.value >= LEAST_SETTING * factor * (1.0 - ROUNDING);
        is_accurate && self.largest() <= factor * (1.0 + ROUNDING) && !self.lacks_reserve(factor)
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
    pub(super) fn setting(&self, coefficient: SettingFormula) -> SettingFormula {
        coefficient.over_number(self.factor())
    }
}

/// The route for a coefficient into an amplifier with these gains, which ascend.
///
/// The gain is the smallest one that is not below the coefficient, so the pot is from 0.1 to 1 if that is possible. A
/// coefficient that equals a gain needs no pot, unless it depends on parameters. If it exceeds the gain for some values
/// of the parameters, a larger gain or a second cord of the largest gain is chosen, if the pot is then valid for all
/// values and still at least 0.1. A pot above 0.98 has the next gain in any case.
///
/// Above the largest gain there are several equal cords, and then an additional summer if it is permitted. `None` if the
/// coefficient is larger still.
pub(super) fn route(coefficient: &Coefficient, gains: &[f64], may_add_summer: bool) -> Option<Route> {
    let largest = gains.last().copied()?;
    // The gain for a coefficient of 0 follows from the values that it can have.
    let wanted = if coefficient.value == 0.0 { coefficient.most.min(largest) } else { coefficient.value };
    let cords = |from: u32, summers: u32| {
        (from..=MOST_CORDS).map(move |cords| Route { has_pot: true, summers, gain: largest, cords })
    };
    if let Some(first) = gains.iter().position(|gain| wanted <= gain * (1.0 + ROUNDING)) {
        let single = gains[first..].iter().map(|gain| Route { gain: *gain, ..Route::POT });
        return chosen(coefficient, &single.chain(cords(2, 0).take(1)).collect::<Vec<_>>());
    }
    let count = |summers: u32| {
        let count = wanted / largest / GAIN_OF_SUMMER.powi(summers as i32) * (1.0 - ROUNDING);
        (summers, count.ceil())
    };
    let mut counts = [0, u32::from(may_add_summer)].into_iter().map(count);
    let (summers, least) = counts.find(|(_, count)| *count <= f64::from(MOST_CORDS))?;
    chosen(coefficient, &cords(least as u32, summers).collect::<Vec<_>>())
}

/// The first of several routes with a pot that has space for all values of the coefficient. The routes have rising
/// factors, and the first one is not below the coefficient. If no route has enough space, it is the first one, or the
/// second one if the pot of the first one would be nearly fully open. `None` without routes.
fn chosen(coefficient: &Coefficient, routes: &[Route]) -> Option<Route> {
    let least = *routes.first()?;
    if coefficient.is_fixed && coefficient.is(least.factor()) {
        return Some(Route { has_pot: false, ..least });
    }
    let next = routes.get(1).filter(|_| coefficient.lacks_reserve(least.factor()));
    let with_space = routes.iter().find(|route| coefficient.has_space(route.factor()));
    Some(with_space.or(next).copied().unwrap_or(least))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gains of a summer.
    const SUMMER: [f64; 2] = [1.0, 10.0];
    /// The gains of an integrator.
    const INTEGRATOR: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];

    /// A coefficient that depends on no parameter.
    fn fixed(value: f64) -> Coefficient {
        Coefficient { value, most: value, is_fixed: true, is_unbounded: false }
    }

    /// A coefficient that depends on a parameter, with its largest value.
    fn variable(value: f64, most: f64) -> Coefficient {
        Coefficient { value, most, is_fixed: false, is_unbounded: false }
    }

    /// A coefficient that depends on a parameter without a range.
    fn unbounded(value: f64) -> Coefficient {
        Coefficient { is_unbounded: true, ..variable(value, value) }
    }

    /// A route with one cord.
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
        assert_eq!(route(&variable(0.05, 0.5), &SUMMER, true), cord(true, 1.0));
        // A gain of 4 has space for 3.5, and one of 10 would need a pot of 0.09.
        let gains = [1.0, 4.0, 10.0];
        assert_eq!(route(&variable(0.9, 3.5), &gains, true), cord(true, 4.0));
        assert_eq!(route(&variable(0.9, 4.5), &gains, true), cord(true, 1.0));
        // No gain has space for 60, but the pot must not be fully open.
        assert_eq!(route(&variable(1.0, 60.0), &SUMMER, true), cord(true, 10.0));
        assert_eq!(route(&variable(0.0, 30.0), &INTEGRATOR, false), cord(true, 100.0));
        assert_eq!(route(&variable(0.0, 0.0), &INTEGRATOR, false), cord(true, 1.0));
    }

    #[test]
    fn a_fixed_coefficient_needs_no_larger_gain() {
        // Parameters cancel in k y / k. The largest value of the first factor does not matter.
        let fixed = Coefficient { most: 6.7, ..fixed(1.0) };
        assert_eq!(route(&fixed, &SUMMER, true), cord(false, 1.0));
        assert_eq!(route(&fixed, &INTEGRATOR, false), cord(false, 1.0));
        assert!(fixed.fits_pot());
        let eight = Coefficient { value: 8.0, most: 16.0, ..fixed };
        assert_eq!(route(&eight, &SUMMER, true), cord(true, 10.0));
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
    fn more_cords_give_space_to_a_parameter_above_the_largest_gain() {
        let cords_of = |value, most| route(&variable(value, most), &SUMMER, true).map(|route| route.cords);
        assert_eq!(cords_of(8.0, 15.0), Some(2));
        assert_eq!(cords_of(8.0, 25.0), Some(1));
        assert_eq!(cords_of(25.0, 29.0), Some(3));
        assert_eq!(cords_of(25.0, 45.0), Some(5));
        assert_eq!(cords_of(25.0, 60.0), Some(3));
        // 3 cords would need a fully open pot.
        assert_eq!(cords_of(30.0, 60.0), Some(4));
        assert_eq!(cords_of(0.0, 15.0), Some(2));
    }

    #[test]
    fn a_parameter_that_can_rise_has_no_pot_above_0_98() {
        // The pot is 0.099.
        assert_eq!(route(&variable(0.99, 1.5), &SUMMER, true), cord(true, 10.0));
        assert_eq!(route(&variable(0.97, 1.5), &SUMMER, true), cord(true, 1.0));
        // The range ends at the coefficient.
        assert_eq!(route(&variable(0.99, 1.0), &SUMMER, true), cord(true, 1.0));
        for value in [0.99, 1.0] {
            assert_eq!(route(&unbounded(value), &SUMMER, true), cord(true, 10.0));
            assert_eq!(route(&unbounded(100.0 * value), &INTEGRATOR, false), cord(true, 1000.0));
            assert!(!unbounded(value).fits_pot());
        }
        assert_eq!(route(&unbounded(0.97), &SUMMER, true), cord(true, 1.0));
        assert_eq!(route(&unbounded(29.9), &SUMMER, true).unwrap().cords, 4);
        // The largest gain with the most cords has no larger one.
        assert_eq!(route(&unbounded(5000.0), &INTEGRATOR, false).unwrap().cords, 5);
    }

    #[test]
    fn a_fully_open_pot_cannot_follow_a_parameter() {
        assert!(fixed(1.0).fits_pot() && variable(1.0, 1.0).fits_pot() && variable(0.9, 2.0).fits_pot());
        assert!(!variable(1.0, 1.1).fits_pot() && !fixed(1.1).fits_pot());
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
