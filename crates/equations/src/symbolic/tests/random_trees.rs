//! Random expressions: their normal forms have the right values, and equal expressions have equal normal forms.

use proptest::array::uniform3;
use proptest::prelude::*;

use crate::symbolic::value;
use crate::testing::trees::{point, with_choices, with_quotients};

proptest! {
    #[test]
    fn the_normal_form_has_the_value_of_the_expression(tree in with_quotients(3), points in uniform3(point())) {
        let fraction = tree.fraction();
        for point in points {
            let Some(expected) = tree.measured(&point) else { continue };
            let found = value(&fraction, &point);
            prop_assert!(expected.is_near(found), "{found}, not {expected:?}");
        }
    }

    #[test]
    fn an_expression_minus_itself_is_0(tree in with_quotients(3)) {
        let fraction = tree.fraction();
        prop_assert!(fraction.minus(&fraction).is_zero());
        prop_assert!(fraction.plus(&fraction.negated()).is_zero());
    }

    #[test]
    fn equal_expressions_have_equal_normal_forms(a in with_choices(2), b in with_choices(2), c in with_choices(2)) {
        let [a, b, c] = [a, b, c].map(|tree| tree.fraction());
        prop_assert_eq!(a.times(&b.plus(&c)), a.times(&b).plus(&a.times(&c)));
        prop_assert_eq!(a.plus(&b).times(&a.minus(&b)), a.power(2).minus(&b.power(2)));
        prop_assert_eq!(a.maximum(&b).times(&a.minimum(&b)), a.times(&b));
    }
}
