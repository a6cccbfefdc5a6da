//! The codes of warnings about loops and about the start of a run.

patchcord_core::diagnostic_codes! {
    /// All codes of the linear analysis.
    self::ALL;
    GROWING_LOOP "growing-loop" Warning "A loop of integrators amplifies deviations, and a motion grows."
        "take one cord from an inverted output; if the growth is intended, state the equations of the patch, or \
         write \"positive_feedback\": true";
    INITIAL_AT_LIMIT "initial-at-limit" Warning "An integrator or lag begins at its limit of 100 V, and its feedback does \
        not keep it below."
        "let one volt represent more, so that the initial voltage is smaller";
    LOOP_SHIFTS_START "loop-shifts-start" Warning "A loop without an integrator changes a voltage at the start that an \
        integrator alone would determine."
        "plug the feedback of the loop into an integrator; if the loop is intended, state the equations of the patch";
}
