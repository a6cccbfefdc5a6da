//! The stable codes of diagnostics, and the table of those that patches can get.
//!
//! Scripts read the texts, so a text never changes. Experiments have further codes, in `patchcord_ident`. The page
//! docs/diagnostics.md lists all of them.

use super::diagnostic::Severity;

/// The kind of a fault. The text of a code never changes, so scripts can rely on it.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{Code, Severity};
///
/// assert_eq!(Code::UNKNOWN_KEY.as_str(), "unknown-key");
/// assert_eq!(Code::UNKNOWN_KEY.severity(), Severity::Error);
/// assert_eq!(Code::UNUSED_ELEMENT.severity(), Severity::Warning);
/// assert_eq!(Code::UNKNOWN_NAME.advice(), "define the name, or correct it");
/// assert!(Code::ALL.contains(&Code::NO_DRIVER));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Code(&'static CodeEntry);

/// The entry of a code in a table of codes.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct CodeEntry {
    /// The text of the code in kebab case.
    pub text: &'static str,
    /// The severity of all its diagnostics.
    pub severity: Severity,
    /// The meaning, as one sentence.
    pub meaning: &'static str,
    /// General advice.
    pub advice: &'static str,
}

impl Code {
    /// The code of an entry.
    pub const fn new(entry: &'static CodeEntry) -> Code {
        Code(entry)
    }

    /// The text of the code in reports and in JSON, such as "unknown-key".
    pub fn as_str(self) -> &'static str {
        self.0.text
    }

    /// Whether a diagnostic with this code prevents the patch from running.
    pub fn severity(self) -> Severity {
        self.0.severity
    }

    /// The meaning of the code, as one sentence.
    pub fn meaning(self) -> &'static str {
        self.0.meaning
    }

    /// The general advice. The hint of a diagnostic is more specific and takes precedence.
    pub fn advice(self) -> &'static str {
        self.0.advice
    }
}

/// Makes the constants of a table of codes, and a constant `ALL` with all of them in the order of the table.
///
/// The first line is the documentation of `ALL`, followed by the path to the constants: `Self::ALL` inside an `impl`
/// block, `self::ALL` in a module. Every further line is one code: the name of its constant, its text, its severity,
/// its meaning and its general advice. The meaning is also the documentation of the constant.
///
/// # Examples
///
/// ```
/// mod codes {
///     patchcord_core::diagnostic_codes! {
///         /// All codes of recordings.
///         self::ALL;
///         EMPTY_TAPE "empty-tape" Error "The tape contains no recording."
///             "record for a longer time";
///         WORN_TAPE "worn-tape" Warning "The tape has gaps."
///             "use a new tape";
///     }
/// }
///
/// assert_eq!(codes::ALL, [codes::EMPTY_TAPE, codes::WORN_TAPE]);
/// assert_eq!(codes::EMPTY_TAPE.as_str(), "empty-tape");
/// ```
#[doc(hidden)]
#[macro_export]
macro_rules! diagnostic_codes {
    (
        $(#[$attribute:meta])*
        $scope:ident::ALL;
        $($name:ident $text:literal $severity:ident $meaning:literal $advice:literal;)*
    ) => {
        $(#[$attribute])*
        pub const ALL: &[$crate::document::Code] = &[$($scope::$name),*];

        $(
            #[doc = $meaning]
            pub const $name: $crate::document::Code = $crate::document::Code::new(&$crate::document::CodeEntry {
                text: $text,
                severity: $crate::document::Severity::$severity,
                meaning: $meaning,
                advice: $advice,
            });
        )*
    };
}

impl Code {
    diagnostic_codes! {
        /// All codes of patches, in the order of the reference page.
        Self::ALL;
        SYNTAX "syntax" Error "The text is not valid JSON."
            "look just before this place for a missing comma, quote or bracket";
        WRONG_TYPE "wrong-type" Error "A value has the wrong type."
            "docs/patch-format.md describes every key";
        MISSING_KEY "missing-key" Error "A required key is missing."
            "docs/patch-format.md lists the required keys";
        UNKNOWN_KEY "unknown-key" Error "The format does not have a key of this name."
            "remove it, or move its text to a \"note\"";
        DUPLICATE_KEY "duplicate-key" Error "A key occurs twice in one object."
            "keep one of the two";
        EXCLUDING_KEYS "excluding-keys" Error "Two keys exclude each other."
            "keep one of the two";
        UNKNOWN_VERSION "unknown-version" Error "This program does not read this version of the format."
            "use a program that reads this version";
        UNKNOWN_KIND "unknown-kind" Error "There is no element or drive of this kind."
            "`patchcord elements` lists the kinds";
        UNKNOWN_MACHINE "unknown-machine" Error "There is no machine of this name."
            "`patchcord machines` lists the machines";
        UNKNOWN_NAME "unknown-name" Error "A cord, signal or formula uses a name that is not in the patch."
            "define the name, or correct it";
        DUPLICATE_NAME "duplicate-name" Error "Two things have the same name."
            "rename one of them";
        BAD_NAME "bad-name" Error "A name cannot be used in a cord or a formula."
            "choose another name";
        UNKNOWN_UNIT "unknown-unit" Error "The text is not a unit."
            "docs/patch-format.md lists the units; a pure number, such as a count, has the unit \"1\"";
        UNIT_MISMATCH "unit-mismatch" Error "The units do not agree."
            "multiply or divide by parameters and scales until both sides have the same unit";
        BAD_FORMULA "bad-formula" Error "A formula has a syntax error or cannot be evaluated."
            "a formula consists of numbers, names, + - * / ^, parentheses and functions";
        NOT_FINITE "not-finite" Error "A number is NaN, infinite or too large."
            "look for a wrong power of ten";
        BAD_NUMBER "bad-number" Error "A number is outside its allowed range."
            "choose a number in the allowed range";
        BAD_TABLE "bad-table" Error "The file of a table cannot be read or does not contain a table."
            "a table is a CSV file: a line of names, and a line of numbers for every point";
        UNCLEAR_UNIT "unclear-unit" Warning "The name of a column seems to contain a unit, which is not understood."
            "write the unit above the names of the file: \"# t: ms\"";
        UNREACHED_TABLE "unreached-table" Warning "The times of a table do not fit the length of the run."
            "times are in seconds from the start of the run";
        OUTSIDE_RANGE "outside-range" Error "A parameter is outside its range in the patch."
            "choose a value inside the range, or widen the range";
        SETTING_OUTSIDE "setting-outside" Error "A pot setting is outside 0 ... 1."
            "move a factor of 10 between the pot and the input gain after it";
        SETTING_RANGE "setting-range" Warning "A pot setting leaves 0 ... 1 for some values in the ranges of its \
            parameters."
            "narrow the range of the parameter, or rescale";
        NO_DRIVER "no-driver" Error "Nothing drives an input."
            "plug in an output, or \"ground\" for 0 V";
        OUTPUTS_TIED "outputs-tied" Error "Two outputs are plugged into one jack."
            "add the two in a summer";
        TOO_MANY_INPUTS "too-many-inputs" Error "An element has more cords than inputs."
            "use a second element for the others";
        UNKNOWN_INPUT "unknown-input" Error "A cord goes to an input that the element does not have."
            "`patchcord elements NAME` lists the inputs of a kind";
        MISSING_GAIN "missing-gain" Error "The machine does not have this input gain."
            "use an input gain of the machine, with a pot in front of it";
        INVENTORY "inventory" Error "The patch needs more parts than the machine has."
            "use fewer of them, or write \"machine\": \"unlimited\", which has any number of parts";
        PART_TWICE "part-twice" Error "Two elements use the same part of the machine."
            "the machine has each part once";
        PART_COUNT "part-count" Error "An element lists a wrong number of parts."
            "list as many parts as the element consists of";
        UNSCALED_SIGNAL "unscaled-signal" Warning "A recorded signal has no scale and is recorded in volts."
            "define a signal at it, with a scale";
        SCALE_MISMATCH "scale-mismatch" Warning "The wiring between a rate and its integral does not agree with their \
            scales."
            "compare the gains by `patchcord check --scaling`";
        UNUSED_TIME_SCALE "unused-time-scale" Warning "No setting contains the time scale, although it is not 1."
            "divide the settings in front of integrators by time_scale";
        UNUSED_ELEMENT "unused-element" Warning "Nothing reads the output of an element."
            "use its output, or remove the element";
        NOT_A_RELAY "not-a-relay" Error "A phase of a run waits for an element that does not switch."
            "name a relay";
        SCALE_IN_RUN "scale-in-run" Error "A phase of a run sets a parameter on which a scale depends."
            "give the scale as a number: a scale must not change within a record";
        UNUSED_MACRO "unused-macro" Warning "No element is an instance of a macro."
            "use it as the kind of an element, or remove it";
        UNUSED_PORT "unused-port" Warning "Nothing inside a macro reads one of its inputs or settings."
            "use it inside the macro, or remove it";
        MACRO_RING "macro-ring" Error "Macros contain each other."
            "remove an instance from one of them";
        MACRO_TOO_LARGE "macro-too-large" Error "The expanded macros exceed the size limit of a patch."
            "use fewer instances, or nest fewer macros";
        LOOP_WITHOUT_SOLUTION "loop-without-solution" Error "No set of voltages satisfies a loop without an integrator."
            "put an integrator or a lag into the loop";
        LOOP_WITH_SOLUTIONS "loop-with-solutions" Error "Several sets of voltages satisfy a loop without an integrator."
            "reduce the gain of the loop below 1, or add an inverter";
        LOOP_TOO_TANGLED "loop-too-tangled" Error "A loop without an integrator has too many pieces, or amplifies rounding too much, to be solved."
            "put an integrator or a lag into the loop";
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn codes_are_distinct_and_kebab_case() {
        let texts: HashSet<_> = Code::ALL.iter().map(|code| code.as_str()).collect();
        assert_eq!(texts.len(), Code::ALL.len());
        assert!(texts.iter().all(|text| text.chars().all(|c| c.is_ascii_lowercase() || c == '-')));
    }
}
