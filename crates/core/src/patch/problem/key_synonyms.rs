//! Keys that people write in a problem and in its quantities and tables, and the keys of this format.

use crate::document::fields::KeyAdvice;
use crate::document::key_synonyms::{KeySynonyms, QUANTITIES, synonym_advice};
use crate::patch::key_synonyms::patch_advice;

/// Keys that people write for the sections of a problem.
static PROBLEM: [KeySynonyms; 5] = [
    QUANTITIES,
    KeySynonyms {
        key: "parameters",
        meaning: "the constants with their values and units",
        words: &["parameter", "params", "constants", "constant", "coefficients"],
    },
    KeySynonyms {
        key: "drives",
        meaning: "the given functions of time",
        words: &["drive", "inputs", "input", "forcing", "excitation", "excitations"],
    },
    KeySynonyms {
        key: "tables",
        meaning: "the functions that are given by points",
        words: &["table", "curves", "curve", "lookup", "lookups", "characteristics", "characteristic"],
    },
    KeySynonyms {
        key: "run",
        meaning: "the length of the run",
        words: &["simulation", "solver", "time_span", "tspan"],
    },
];

/// Keys of a problem for which there is no section, and what to do instead.
static MISPLACED: [(&[&str], &str); 6] = [
    (
        &["signals", "macros", "record", "pictures", "positive_feedback"],
        "only a patch has it: `patchcord scale` makes a patch from the problem",
    ),
    (&["scales"], "a quantity can prescribe its scale: write \"per_volt\" in it"),
    (&["machine"], "choose the machine by `patchcord scale --machine NAME`"),
    (&["time_scale"], "`patchcord scale` chooses the time scale"),
    (
        &["initial", "initials", "initial_values", "initial_conditions"],
        "write \"initial\" in each quantity that has an initial value",
    ),
    (&["maximum", "maxima", "bounds"], "write \"maximum\" in each quantity whose maximum is known"),
];

/// Keys that people write for those of a quantity.
static QUANTITY: [KeySynonyms; 5] = [
    KeySynonyms { key: "unit", meaning: "", words: &["units", "dimension"] },
    KeySynonyms {
        key: "initial",
        meaning: "the value at the start",
        words: &[
            "start",
            "start_value",
            "value",
            "ic",
            "init",
            "initial_value",
            "initial_condition",
            "x0",
            "y0",
            "at_start",
            "begin",
        ],
    },
    KeySynonyms {
        key: "maximum",
        meaning: "the largest magnitude that is expected",
        words: &[
            "max",
            "maximal",
            "max_value",
            "maximum_value",
            "expected_maximum",
            "peak",
            "amplitude",
            "bound",
            "limit",
            "range",
            "largest",
            "upper",
        ],
    },
    KeySynonyms {
        key: "per_volt",
        meaning: "the value of one volt in the unit of the quantity",
        words: &["scale", "scale_factor", "factor", "volt", "volts"],
    },
    KeySynonyms {
        key: "description",
        meaning: "",
        words: &["text", "comment", "meaning", "label", "title", "name"],
    },
];

/// Keys that people write for those of a table.
static TABLE: [KeySynonyms; 3] = [
    KeySynonyms {
        key: "in",
        meaning: "the unit of the argument",
        words: &["input", "x", "from", "argument", "input_unit", "in_unit", "x_unit"],
    },
    KeySynonyms {
        key: "out",
        meaning: "the unit of the value",
        words: &["output", "y", "to", "output_unit", "out_unit", "y_unit", "unit"],
    },
    KeySynonyms {
        key: "points",
        meaning: "a list of points [argument, value]",
        words: &["data", "values", "table", "pairs", "curve"],
    },
];

/// The hint about a key that a problem does not have. `None` if the tables do not have the key.
pub(super) fn problem_advice(written: &str) -> Option<KeyAdvice> {
    let synonym = synonym_advice(&PROBLEM, written, |_| true).or_else(|| patch_advice(written));
    synonym.or_else(|| misplaced_advice(written))
}

/// The hint about a key whose content is elsewhere. It means no key of a problem.
fn misplaced_advice(written: &str) -> Option<KeyAdvice> {
    let (_, hint) = MISPLACED.iter().find(|(keys, _)| keys.contains(&written))?;
    Some(KeyAdvice { key: "", hint: (*hint).to_owned() })
}

/// The hint about a key that a quantity does not have. `None` if the table does not have the key.
pub(super) fn quantity_advice(written: &str) -> Option<KeyAdvice> {
    synonym_advice(&QUANTITY, written, |_| true)
}

/// The hint about a key that a table does not have. `None` if the table of synonyms does not have the key.
pub(super) fn table_advice(written: &str) -> Option<KeyAdvice> {
    synonym_advice(&TABLE, written, |_| true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_of_other_programs_are_recognised() {
        let key = |advice: Option<KeyAdvice>| advice.map(|advice| advice.key);
        for word in ["variables", "States", "unknowns"] {
            assert_eq!(key(problem_advice(word)), Some("quantities"), "{word}");
        }
        assert_eq!(key(problem_advice("ODE")), Some("equations"));
        assert_eq!(key(problem_advice("constants")), Some("parameters"));
        assert_eq!(problem_advice("colour"), None);
        let machine = problem_advice("machine").map(|advice| advice.hint);
        assert_eq!(machine.as_deref(), Some("choose the machine by `patchcord scale --machine NAME`"));
        for (word, expected) in [("max", "maximum"), ("start", "initial"), ("scale", "per_volt")] {
            assert_eq!(key(quantity_advice(word)), Some(expected), "{word}");
        }
        assert_eq!(key(table_advice("values")), Some("points"));
    }

    #[test]
    fn every_word_is_in_one_row_and_is_no_key() {
        for table in [&PROBLEM[..], &QUANTITY, &TABLE] {
            let words: Vec<&str> = table.iter().flat_map(|row| row.words).copied().collect();
            for (index, word) in words.iter().enumerate() {
                assert!(!words[..index].contains(word), "{word}");
                assert!(!table.iter().any(|row| row.key == *word), "{word}");
            }
        }
        let misplaced: Vec<&str> = MISPLACED.iter().flat_map(|(keys, _)| *keys).copied().collect();
        for word in misplaced {
            let is_synonym =
                PROBLEM.iter().any(|row| row.words.contains(&word)) || patch_advice(word).is_some();
            assert!(!is_synonym, "{word}");
        }
    }
}
