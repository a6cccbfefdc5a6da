//! Random texts.

use proptest::prelude::*;

use super::super::Equation;
use super::{SCOPE, TABLES, equation};
use crate::formula::Formula;

proptest! {
    #[test]
    fn nothing_panics_on_any_text(text in "\\PC*") {
        if let Err(error) = Equation::parse(&text, &TABLES) {
            prop_assert!(text.get(error.range).is_some());
        }
    }

    #[test]
    fn nothing_panics_on_equation_like_text(
        text in "((x'{0,2}|dx|dt|k|friction|sign\\(|2|limit\\(|\\(|\\(0\\)|pi|ẋ|=)[-+*/^,) =]{0,2}){0,12}\\)?"
    ) {
        match Equation::parse(&text, &TABLES) {
            Err(error) => prop_assert!(text.get(error.range).is_some()),
            Ok(equation) => {
                let faults = [equation.evaluate(&SCOPE).err(), equation.dimension_check(&SCOPE).err()];
                for error in faults.into_iter().flatten() {
                    prop_assert!(text.get(error.range).is_some());
                }
            }
        }
    }

    #[test]
    fn an_equation_without_additions_has_the_trees_of_formulas(
        text in "((v|x|u|2)[-+*/^]){0,8}(v|u|3)"
    ) {
        let formula = Formula::parse(&text).unwrap();
        let equation = equation(&format!("{text} = 0"));
        prop_assert_eq!(formula.root(), equation.left());
    }
}
