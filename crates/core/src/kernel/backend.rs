//! What works the steps out.

use std::fmt;

/// What works the steps of a run out where nothing switches and no amplifier comes to an end of its range. All but the
/// reference give the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Backend {
    /// The program's own operations, as the elements' laws emit them: the reference that the others are held against.
    Reference,
    /// The operations folded, interpreted.
    Interpreter,
    /// The same over the runs of a sweep side by side, in vectors as wide as the processor has. A run that is alone is
    /// interpreted alone.
    Lanes,
    /// The operations folded, as native code from the first step; interpreted where none can be made.
    Native,
    /// The operations folded, interpreted until native code pays; many runs of a sweep side by side, what one of them meets by
    /// native code.
    #[default]
    Automatic,
}

impl Backend {
    /// All of them.
    pub const ALL: [Backend; 5] =
        [Backend::Reference, Backend::Interpreter, Backend::Lanes, Backend::Native, Backend::Automatic];

    /// Whether it takes runs side by side.
    pub(crate) fn goes_abreast(self) -> bool {
        matches!(self, Backend::Lanes | Backend::Automatic)
    }

    /// Whether it may take steps as native code.
    pub(crate) fn may_be_native(self) -> bool {
        matches!(self, Backend::Native | Backend::Automatic)
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Backend::Reference => "reference",
            Backend::Interpreter => "interpreter",
            Backend::Lanes => "lanes",
            Backend::Native => "native",
            Backend::Automatic => "automatic",
        }
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}
