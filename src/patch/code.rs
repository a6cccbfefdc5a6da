//! The stable codes of everything that can be wrong with a patch.

use super::diagnostic::Severity;

/// One row: the code's variant, its text, its severity, and what it means.
macro_rules! codes {
    ($($variant:ident $text:literal $severity:ident $meaning:literal;)*) => {
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
        }
    };
}

codes! {
    Syntax "syntax" Error "The text is not JSON.";
    WrongType "wrong-type" Error "A value has another type than the format asks for.";
    MissingKey "missing-key" Error "A key that the format needs is not there.";
    UnknownKey "unknown-key" Error "A key that the format does not know.";
    DuplicateKey "duplicate-key" Error "The same key stands twice in one object.";
    UnknownVersion "unknown-version" Error "The format's version is not one that this program reads.";
    UnknownKind "unknown-kind" Error "An element or drive of a kind that does not exist.";
    UnknownMachine "unknown-machine" Error "The machine named does not exist.";
    UnknownName "unknown-name" Error "A cord, signal or formula names something that the patch does not have.";
    DuplicateName "duplicate-name" Error "One name stands for two things.";
    BadName "bad-name" Error "A name that could not be used in a cord or a formula.";
    UnknownUnit "unknown-unit" Error "A unit that cannot be read.";
    UnitMismatch "unit-mismatch" Error "Units that do not agree.";
    BadFormula "bad-formula" Error "A formula that cannot be read or worked out.";
    NotFinite "not-finite" Error "A number that is NaN, infinite or too large to hold.";
    BadNumber "bad-number" Error "A number outside what its place allows.";
    OutsideRange "outside-range" Error "A parameter outside the range that the patch gives it.";
    SettingOutside "setting-outside" Error "A potentiometer setting outside 0 ... 1.";
    SettingRange "setting-range" Warning "A potentiometer setting that leaves 0 ... 1 within the ranges of its parameters.";
    NoDriver "no-driver" Error "An input that nothing drives.";
    OutputsTied "outputs-tied" Error "Two outputs plugged into one jack.";
    TooManyInputs "too-many-inputs" Error "More cords than the element has inputs.";
    UnknownInput "unknown-input" Error "A cord to an input that the element does not have.";
    MissingGain "missing-gain" Error "An input gain that the machine does not have.";
    Inventory "inventory" Error "More parts than the machine has.";
    PartTwice "part-twice" Error "One part of the machine used by two elements.";
    PartCount "part-count" Error "An element lists another number of parts than it is made of.";
    UnscaledSignal "unscaled-signal" Warning "A recorded signal without a scale: it is written in volts.";
    UnusedElement "unused-element" Warning "An element that nothing reads.";
    LoopWithoutSolution "loop-without-solution" Error "A loop without an integrator that no set of voltages satisfies.";
    LoopWithSolutions "loop-with-solutions" Error "A loop without an integrator that several sets of voltages satisfy.";
    LoopNotPiecewiseLinear "loop-not-piecewise-linear" Error "A loop without an integrator through an element that is not made of straight pieces.";
    LoopTooTangled "loop-too-tangled" Error "Loops without an integrator that are too tangled to be opened one after the other.";
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn codes_are_distinct_and_kebab_case() {
        let texts: HashSet<_> = Code::ALL.iter().map(|code| code.as_str()).collect();
        assert_eq!(texts.len(), Code::ALL.len());
        assert!(texts.iter().all(|text| text.chars().all(|c| c.is_ascii_lowercase() || c == '-')));
    }
}
