//! The stable codes of all diagnostics, as one table.
//!
//! A row has the variant, the text, the severity, the meaning and the general advice. The enum, its methods and the
//! page docs/diagnostics.md come from this table. Scripts read the texts, so a text never changes.

use super::diagnostic::Severity;

/// Makes the enum `Code` and its methods from the table.
/// The columns of a row are: variant, text, severity, meaning and general advice.
macro_rules! codes {
    ($($variant:ident $text:literal $severity:ident $meaning:literal $advice:literal;)*) => {
        /// The kind of a fault. The text of a code never changes, so scripts can rely on it.
        ///
        /// # Examples
        ///
        /// ```
        /// use patchcord_core::document::{Code, Severity};
        ///
        /// assert_eq!(Code::UnknownKey.as_str(), "unknown-key");
        /// assert_eq!(Code::UnknownKey.severity(), Severity::Error);
        /// assert_eq!(Code::UnusedElement.severity(), Severity::Warning);
        /// assert_eq!(Code::UnknownName.advice(), "define the name, or correct it");
        /// assert!(Code::ALL.contains(&Code::NoDriver));
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Code {
            $(#[doc = $meaning] $variant,)*
        }

        impl Code {
            /// All codes, in the order of the reference page.
            pub const ALL: &[Code] = &[$(Code::$variant),*];

            /// The text of the code in reports and in JSON, such as "unknown-key".
            pub fn as_str(self) -> &'static str {
                match self { $(Code::$variant => $text,)* }
            }

            /// Whether a diagnostic with this code prevents the patch from running.
            pub fn severity(self) -> Severity {
                match self { $(Code::$variant => Severity::$severity,)* }
            }

            /// The meaning of the code, as one sentence.
            pub fn meaning(self) -> &'static str {
                match self { $(Code::$variant => $meaning,)* }
            }

            /// The general advice. The hint of a diagnostic is more specific and takes precedence.
            pub fn advice(self) -> &'static str {
                match self { $(Code::$variant => $advice,)* }
            }
        }
    };
}

codes! {
    Syntax "syntax" Error "The text is not valid JSON."
        "look just before this place for a missing comma, quote or bracket";
    WrongType "wrong-type" Error "A value has the wrong type."
        "docs/patch-format.md describes every key";
    MissingKey "missing-key" Error "A required key is missing."
        "docs/patch-format.md lists the required keys";
    UnknownKey "unknown-key" Error "The format does not have a key of this name."
        "remove it, or move its text to a \"note\"";
    DuplicateKey "duplicate-key" Error "A key occurs twice in one object."
        "keep one of the two";
    ExcludingKeys "excluding-keys" Error "Two keys exclude each other."
        "keep one of the two";
    UnknownVersion "unknown-version" Error "This program does not read this version of the format."
        "use a program that reads this version";
    UnknownKind "unknown-kind" Error "There is no element or drive of this kind."
        "`patchcord elements` lists the kinds";
    UnknownMachine "unknown-machine" Error "There is no machine of this name."
        "`patchcord machines` lists the machines";
    UnknownName "unknown-name" Error "A cord, signal or formula uses a name that is not in the patch."
        "define the name, or correct it";
    DuplicateName "duplicate-name" Error "Two things have the same name."
        "rename one of them";
    BadName "bad-name" Error "A name cannot be used in a cord or a formula."
        "choose another name";
    UnknownUnit "unknown-unit" Error "The text is not a unit."
        "docs/patch-format.md lists the units";
    UnitMismatch "unit-mismatch" Error "The units do not agree."
        "multiply or divide by parameters and scales until both sides have the same unit";
    BadFormula "bad-formula" Error "A formula has a syntax error or cannot be evaluated."
        "a formula consists of numbers, names, + - * / ^, parentheses and functions";
    NotFinite "not-finite" Error "A number is NaN, infinite or too large."
        "look for a wrong power of ten";
    BadNumber "bad-number" Error "A number is outside its allowed range."
        "choose a number in the allowed range";
    BadTable "bad-table" Error "The file of a table cannot be read or does not contain a table."
        "a table is a CSV file: a line of names, and a line of numbers for every point";
    OutsideRange "outside-range" Error "A parameter is outside its range in the patch."
        "choose a value inside the range, or widen the range";
    SettingOutside "setting-outside" Error "A pot setting is outside 0 ... 1."
        "move a factor of 10 between the pot and the input gain after it";
    SettingRange "setting-range" Warning "A pot setting leaves 0 ... 1 for some values in the ranges of its parameters."
        "narrow the range of the parameter, or rescale";
    NoDriver "no-driver" Error "Nothing drives an input."
        "plug in an output, or \"ground\" for 0 V";
    OutputsTied "outputs-tied" Error "Two outputs are plugged into one jack."
        "add the two in a summer";
    TooManyInputs "too-many-inputs" Error "An element has more cords than inputs."
        "use a second element for the others";
    UnknownInput "unknown-input" Error "A cord goes to an input that the element does not have."
        "`patchcord elements NAME` lists the inputs of a kind";
    MissingGain "missing-gain" Error "The machine does not have this input gain."
        "use an input gain of the machine, with a pot in front of it";
    Inventory "inventory" Error "The patch needs more parts than the machine has."
        "use fewer, or use the machine \"unlimited\"";
    PartTwice "part-twice" Error "Two elements use the same part of the machine."
        "the machine has each part once";
    PartCount "part-count" Error "An element lists a wrong number of parts."
        "list as many parts as the element consists of";
    UnscaledSignal "unscaled-signal" Warning "A recorded signal has no scale and is recorded in volts."
        "define a signal at it, with a scale";
    UnusedElement "unused-element" Warning "Nothing reads the output of an element."
        "use its output, or remove the element";
    NotARelay "not-a-relay" Error "A phase of a run waits for an element that does not switch."
        "name a relay";
    ScaleInRun "scale-in-run" Error "A phase of a run sets a parameter on which a scale depends."
        "give the scale as a number: a scale must not change within a record";
    UnusedMacro "unused-macro" Warning "No element is an instance of a macro."
        "use it as the kind of an element, or remove it";
    UnusedPort "unused-port" Warning "Nothing inside a macro reads one of its inputs or settings."
        "use it inside the macro, or remove it";
    MacroRing "macro-ring" Error "Macros contain each other."
        "remove an instance from one of them";
    MacroTooLarge "macro-too-large" Error "The expanded macros exceed the size limit of a patch."
        "use fewer instances, or nest fewer macros";
    LoopWithoutSolution "loop-without-solution" Error "No set of voltages satisfies a loop without an integrator."
        "put an integrator or a lag into the loop";
    LoopWithSolutions "loop-with-solutions" Error "Several sets of voltages satisfy a loop without an integrator."
        "reduce the gain of the loop below 1, or add an inverter";
    LoopTooTangled "loop-too-tangled" Error "Loops without an integrator are nested too deeply to be solved."
        "put an integrator or a lag into some of the loops";
    BadPatch "bad-patch" Error "The patch of an experiment cannot be read or has errors."
        "`patchcord check` lists the errors of a patch";
    BadData "bad-data" Error "A file of measured data cannot be read or does not contain the required data."
        "data are a CSV file: a line of names, and a line of numbers for every sample";
    UnevenSampling "uneven-sampling" Error "The samples are not evenly spaced."
        "interpolate the data to even times; whole rows may be missing";
    TooFewSamples "too-few-samples" Error "There are too few samples for training or test."
        "record for a longer time or at a higher rate, or widen the range";
    ConstantColumn "constant-column" Error "A column is constant and so contains no information."
        "check the name of the column";
    NotFittable "not-fittable" Error "A parameter cannot be fitted."
        "fit another parameter, or give this one a range";
    OffScale "off-scale" Error "More than 1 % of the samples exceed 100 V in their scale, or a sample exceeds 100 kV: \
        the machine would cut them off."
        "increase per_volt of the scale, correct the \"unit\" of the column, or remove rows with recording errors";
    DriveBeginsAnew "drive-begins-anew" Error "A drive without a column starts at time 0, but its record starts later."
        "feed the drive from a column; or use records for training and test that start with the drive; or let its \
        formulas use a parameter record_start in s, which is set to the start of the record";
    SamplingGap "sampling-gap" Warning "Rows are missing between other rows."
        "check whether the recorder lost them; this time is ignored";
    SharedSamples "shared-samples" Warning "Samples are used for both training and test, or are listed twice."
        "separate the two: a test on training samples does not validate the model";
    StillPart "still-part" Warning "A column is constant in the samples for training or test."
        "choose samples in which it changes";
    WildSample "wild-sample" Warning "Samples of a column differ strongly from their neighbours."
        "look at them, and remove rows with recording errors: removed rows count as missing";
    BeyondData "beyond-data" Warning "A range of samples extends beyond the data."
        "correct the range: only the part with data is used";
    BeyondScale "beyond-scale" Warning "A few samples exceed 100 V in their scale."
        "increase per_volt of the scale";
    BelowScale "below-scale" Warning "A column uses less than a thousandth of its scale."
        "correct the \"unit\" of the column, or decrease per_volt of the scale";
    SharedColumn "shared-column" Warning "Two drives or outputs use the same column."
        "name a different column for each";
    UnfedDrives "unfed-drives" Warning "No column feeds a drive that changes in the patch, or no column feeds \
        any drive and so nothing moves."
        "if the drive was measured, name its column under \"drives\"";
    NothingToFit "nothing-to-fit" Warning "The patch of an experiment has no parameter that can be fitted."
        "give the unknown parameters a range; if all are known, write \"fit\": []";
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
