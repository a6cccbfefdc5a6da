//! The stable codes of everything that can be wrong with a patch.

use super::diagnostic::Severity;

/// One row: the code's variant, its text, its severity, what it means, and what to do where nothing nearer is known.
macro_rules! codes {
    ($($variant:ident $text:literal $severity:ident $meaning:literal $advice:literal;)*) => {
        /// What kind of thing is wrong. The text of a code never changes.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Code {
            $(#[doc = $meaning] $variant,)*
        }

        impl Code {
            /// Every code, in the order of the reference page.
            pub const ALL: &[Code] = &[$(Code::$variant),*];

            /// The code as reports print it.
            pub fn as_str(self) -> &'static str {
                match self { $(Code::$variant => $text,)* }
            }

            /// Whether it stops the patch.
            pub fn severity(self) -> Severity {
                match self { $(Code::$variant => Severity::$severity,)* }
            }

            /// What it means, in a sentence.
            pub fn meaning(self) -> &'static str {
                match self { $(Code::$variant => $meaning,)* }
            }

            /// What to do about it in general; findings may know better.
            pub fn advice(self) -> &'static str {
                match self { $(Code::$variant => $advice,)* }
            }
        }
    };
}

codes! {
    Syntax "syntax" Error "The text is not JSON."
        "look just before this place for a missing comma, quote or bracket";
    WrongType "wrong-type" Error "A value has another type than the format asks for."
        "docs/patch-format.md shows what stands under each key";
    MissingKey "missing-key" Error "A key that the format needs is not there."
        "docs/patch-format.md shows the keys that are needed";
    UnknownKey "unknown-key" Error "A key that the format does not know."
        "take it out, or keep what it says in a \"note\"";
    DuplicateKey "duplicate-key" Error "The same key stands twice in one object."
        "keep one of the two";
    ExcludingKeys "excluding-keys" Error "Two keys that exclude each other."
        "keep one of the two";
    UnknownVersion "unknown-version" Error "The format's version is not one that this program reads."
        "use a program that reads this version";
    UnknownKind "unknown-kind" Error "An element or drive of a kind that does not exist."
        "`patchcord elements` lists the kinds";
    UnknownMachine "unknown-machine" Error "The machine named does not exist."
        "`patchcord machines` lists the machines";
    UnknownName "unknown-name" Error "A cord, signal or formula names something that the patch does not have."
        "add what it names, or correct the name";
    DuplicateName "duplicate-name" Error "One name stands for two things."
        "rename one of them";
    BadName "bad-name" Error "A name that could not be used in a cord or a formula."
        "choose another name";
    UnknownUnit "unknown-unit" Error "A unit that cannot be read."
        "docs/patch-format.md lists the units";
    UnitMismatch "unit-mismatch" Error "Units that do not agree."
        "multiply or divide by parameters and scales until both sides measure the same";
    BadFormula "bad-formula" Error "A formula that cannot be read or worked out."
        "a formula is made of numbers, names, + - * / ^, parentheses and functions";
    NotFinite "not-finite" Error "A number that is NaN, infinite or too large to hold."
        "look for a wrong power of ten";
    BadNumber "bad-number" Error "A number outside what its place allows."
        "choose a number that its place allows";
    BadTable "bad-table" Error "A file that a table stands in cannot be read, or does not hold the table."
        "a table is a CSV file: a line of names, and a line of numbers for every point";
    OutsideRange "outside-range" Error "A parameter outside the range that the patch gives it."
        "choose a value inside the range, or widen the range";
    SettingOutside "setting-outside" Error "A potentiometer setting outside 0 ... 1."
        "move a factor of 10 between the pot and the gain behind it";
    SettingRange "setting-range" Warning "A potentiometer setting that leaves 0 ... 1 within the ranges of its parameters."
        "narrow the range of the parameter, or rescale";
    NoDriver "no-driver" Error "An input that nothing drives."
        "plug in an output, or \"ground\" for 0 V";
    OutputsTied "outputs-tied" Error "Two outputs plugged into one jack."
        "add the two in a summer";
    TooManyInputs "too-many-inputs" Error "More cords than the element has inputs."
        "use a second element for the others";
    UnknownInput "unknown-input" Error "A cord to an input that the element does not have."
        "`patchcord elements NAME` lists the inputs of a kind";
    MissingGain "missing-gain" Error "An input gain that the machine does not have."
        "put a pot in front of a gain that the machine has";
    Inventory "inventory" Error "More parts than the machine has."
        "save some, or patch it on the machine \"unlimited\"";
    PartTwice "part-twice" Error "One part of the machine used by two elements."
        "every part is on the machine once";
    PartCount "part-count" Error "An element lists another number of parts than it is made of."
        "list as many as the element is made of";
    UnscaledSignal "unscaled-signal" Warning "A recorded signal without a scale: it is written in volts."
        "name a signal at it, with a scale";
    UnusedElement "unused-element" Warning "An element that nothing reads."
        "read it somewhere, or leave it out";
    NotARelay "not-a-relay" Error "A phase of a run waits for an element that does not switch."
        "name a relay";
    ScaleInRun "scale-in-run" Error "A phase of a run sets a parameter on which a scale depends."
        "give the scale as a number: what is recorded is read in one scale from beginning to end";
    UnusedMacro "unused-macro" Warning "A macro that no element is an instance of."
        "use it as the kind of an element, or leave it out";
    UnusedPort "unused-port" Warning "An input or a setting of a macro that nothing inside reads."
        "read it inside, or leave it out";
    MacroRing "macro-ring" Error "Macros that hold each other, and so have no end."
        "take an instance out of one of them";
    MacroTooLarge "macro-too-large" Error "Macros that, written out, make a patch beyond reason."
        "use fewer instances, or put fewer macros inside each other";
    LoopWithoutSolution "loop-without-solution" Error "A loop without an integrator that no set of voltages satisfies."
        "put an integrator or a lag into the loop";
    LoopWithSolutions "loop-with-solutions" Error "A loop without an integrator that several sets of voltages satisfy."
        "bring the gain of the loop under 1, or invert it once more";
    LoopTooTangled "loop-too-tangled" Error "Loops without an integrator that are too tangled to be opened one after the other."
        "put an integrator or a lag into some of the loops";
    BadPatch "bad-patch" Error "The patch that an experiment names cannot be read, or is wrong."
        "`patchcord check` tells what is wrong with a patch";
    BadData "bad-data" Error "A file of measured data cannot be read, or does not hold what is needed."
        "data are a CSV file: a line of names, and a line of numbers for every sample";
    UnevenSampling "uneven-sampling" Error "Samples that are not evenly spaced."
        "interpolate the data onto even times; whole rows may be missing";
    TooFewSamples "too-few-samples" Error "Too few samples to train or to test on."
        "record for longer or more often, or widen the range";
    ConstantColumn "constant-column" Error "A column that never moves, and so tells nothing."
        "name the column that was meant";
    NotFittable "not-fittable" Error "A parameter that cannot be fitted."
        "fit another one, or give it a range";
    OffScale "off-scale" Error "Data of which more than one sample in a hundred lies beyond 100 V of their scale, or one beyond 100 kV: the machine would cut it off."
        "let a volt of the scale stand for more, or tell the \"unit\" of the column, if it is another; leave out a row that the recorder let slip";
    DriveBeginsAnew "drive-begins-anew" Error "A drive that moves as the patch has it, beside a record, or a piece of one, that begins later than the drive does."
        "feed it from a column; or list records for training and test that begin where it does; or let its formulas go by a parameter record_start, in s, which a search sets to when a record begins";
    SamplingGap "sampling-gap" Warning "Rows that are missing between others."
        "look whether the recorder lost them; what was measured then is left out";
    SharedSamples "shared-samples" Warning "Samples that are both trained and tested on, or listed twice."
        "keep the two apart: what was fitted to proves nothing";
    StillPart "still-part" Warning "A column that does not move in the part to train or to test on."
        "take a part in which it does";
    WildSample "wild-sample" Warning "Samples of a column far off those before and behind."
        "look at them; leave the rows of those out that the recorder let slip: they count as missing then";
    BeyondData "beyond-data" Warning "A range or a piece that goes on where the data have ended."
        "write the range that is meant: what lies beyond the data is left out";
    BeyondScale "beyond-scale" Warning "A few data for which 100 V of their scale are not enough."
        "let a volt of the scale stand for more";
    BelowScale "below-scale" Warning "A column that fills less than a thousandth of its scale."
        "tell the \"unit\" of the column, if it is another than that of the scale; else let a volt of the scale stand for less";
    SharedColumn "shared-column" Warning "A column that stands for two drives or outputs."
        "name the column of each";
    UnfedDrives "unfed-drives" Warning "An experiment of which no column feeds a drive that moves in the patch, or any drive, so that nothing moves there."
        "name its column under \"drives\", if what drove the thing was measured";
    NothingToFit "nothing-to-fit" Warning "An experiment with a patch of which no parameter can be fitted."
        "give those a range that are not known; if all are, write \"fit\": []";
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
