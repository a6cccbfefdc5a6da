//! The codes of the synthesis.

patchcord_core::diagnostic_codes! {
    /// All codes of the synthesis.
    self::ALL;
    NO_CIRCUIT "no-circuit" Error "A part of the problem has no circuit with these values and scales."
        "give the quantity another \"maximum\", or write the equation in another form";
}
