//! Keys that people write in a patch and in its "run", "scales" and "signals", and the keys of this format.
//!
//! Hints for unknown keys use these tables before they look for a similar key. Keys of elements and drives have tables
//! of their own in `elements`.

use crate::document::fields::KeyAdvice;
use crate::document::key_synonyms::{KeySynonyms, synonym_advice};

/// Keys that people write for the sections of a patch.
static PATCH: [KeySynonyms; 1] = [KeySynonyms {
    key: "equations",
    meaning: "the equations that the wiring is meant to solve",
    words: &[
        "equation",
        "eq",
        "eqs",
        "eqn",
        "eqns",
        "ode",
        "odes",
        "dae",
        "system",
        "model",
        "problem",
        "dynamics",
        "equations_of_motion",
        "differential_equation",
        "differential_equations",
    ],
}];

/// Keys of other programs for the settings of a run.
static RUN: [KeySynonyms; 5] = [
    KeySynonyms {
        key: "step",
        meaning: "the step of the solver in s",
        words: &["dt", "h", "timestep", "time_step", "step_size", "max_step", "dt_max", "delta_t"],
    },
    KeySynonyms {
        key: "for",
        meaning: "the length of the run in s",
        words: &[
            "duration",
            "length",
            "end",
            "stop",
            "end_time",
            "stop_time",
            "time",
            "until",
            "t_end",
            "tend",
            "t_stop",
            "tstop",
            "t_final",
            "tfinal",
            "t_max",
            "tmax",
        ],
    },
    KeySynonyms {
        key: "tolerance",
        meaning: "the largest error of a run as a share of 100 V",
        words: &["tol", "atol", "rtol", "abstol", "reltol", "abs_tol", "rel_tol", "accuracy", "eps"],
    },
    KeySynonyms {
        key: "every",
        meaning: "the time between samples in s",
        words: &["sample", "samples", "sampling", "sample_time", "interval", "save_every", "saveat"],
    },
    KeySynonyms {
        key: "repeat",
        meaning: "the number of runs from initial condition",
        words: &["repeats", "repetitions", "times", "runs", "cycles"],
    },
];

/// Keys of other programs for a scale.
static SCALE: [KeySynonyms; 1] = [KeySynonyms {
    key: "per_volt",
    meaning: "the value of one volt in the unit of the scale",
    words: &["value", "factor", "scale", "scale_factor", "gain", "max", "maximum", "full_scale", "range"],
}];

/// Keys of other programs for a signal.
static SIGNAL: [KeySynonyms; 1] = [KeySynonyms {
    key: "at",
    meaning: "the element whose output is read",
    words: &["from", "of", "in", "element", "source", "node", "output", "jack", "probe"],
}];

/// The hint about a key that a patch does not have. `None` if the table does not have the key.
pub(super) fn patch_advice(written: &str) -> Option<KeyAdvice> {
    synonym_advice(&PATCH, written, |_| true)
}

/// The hint about a key that "run" does not have. `None` if the table does not have the key.
pub(super) fn run_advice(written: &str) -> Option<KeyAdvice> {
    synonym_advice(&RUN, written, |_| true)
}

/// The hint about a key that a scale does not have. `None` if the table does not have the key.
pub(super) fn scale_advice(written: &str) -> Option<KeyAdvice> {
    synonym_advice(&SCALE, written, |_| true)
}

/// The hint about a key that a signal does not have. `None` if the table does not have the key.
pub(super) fn signal_advice(written: &str) -> Option<KeyAdvice> {
    synonym_advice(&SIGNAL, written, |_| true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_of_other_programs_are_recognised() {
        let cases: [(&str, &[&str]); 4] = [
            ("step", &["dt", "h", "timestep", "dt_max", "Step-Size"]),
            ("for", &["duration", "end", "stop", "t_end", "tEnd"]),
            ("tolerance", &["tol", "atol", "rtol", "RelTol"]),
            ("every", &["sample", "samples"]),
        ];
        for (key, words) in cases {
            for word in words {
                assert_eq!(run_advice(word).map(|advice| advice.key), Some(key), "{word}");
            }
        }
        let hint = run_advice("dt").map(|advice| advice.hint);
        assert_eq!(hint.as_deref(), Some("did you mean \"step\", the step of the solver in s?"));
        for word in ["equation", "ODE", "differential equations"] {
            assert_eq!(patch_advice(word).map(|advice| advice.key), Some("equations"), "{word}");
        }
        assert_eq!(scale_advice("max").map(|advice| advice.key), Some("per_volt"));
        assert_eq!(signal_advice("element").map(|advice| advice.key), Some("at"));
        assert_eq!(run_advice("colour"), None);
    }

    #[test]
    fn every_word_is_in_one_row_and_is_no_key() {
        for table in [&PATCH[..], &RUN, &SCALE, &SIGNAL] {
            let words: Vec<&str> = table.iter().flat_map(|row| row.words).copied().collect();
            for (index, word) in words.iter().enumerate() {
                assert!(!words[..index].contains(word), "{word}");
                assert!(!table.iter().any(|row| row.key == *word), "{word}");
            }
        }
    }
}
