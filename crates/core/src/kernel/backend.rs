//! The choice of what computes the steps of a run.

use std::fmt;

/// What computes the steps between events. All backends except the reference give the same bits.
///
/// # Examples
///
/// ```
/// use patchcord_core::solve::Backend;
///
/// assert_eq!(Backend::default(), Backend::Automatic);
/// assert_eq!(Backend::ALL.map(Backend::name), ["reference", "interpreter", "lanes", "native", "automatic"]);
/// assert_eq!(Backend::Lanes.to_string(), "lanes");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Backend {
    /// The operations of the program as the elements' laws emit them. Every other backend is compared with it.
    Reference,
    /// The operations of a kernel, interpreted.
    Interpreter,
    /// The operations of a kernel, interpreted for several runs of a sweep in vector registers. A single run is
    /// interpreted alone.
    Lanes,
    /// The operations of a kernel as native code from the first step. They are interpreted if native code is
    /// impossible.
    Native,
    /// The operations of a kernel, interpreted at first and compiled once that is faster. Many runs of a sweep use
    /// lanes; native code computes the events of a single one.
    #[default]
    Automatic,
}

impl Backend {
    /// Every backend, in the order of the documentation.
    pub const ALL: [Backend; 5] =
        [Backend::Reference, Backend::Interpreter, Backend::Lanes, Backend::Native, Backend::Automatic];

    /// Whether it computes several runs in lanes.
    pub(crate) fn can_use_lanes(self) -> bool {
        matches!(self, Backend::Lanes | Backend::Automatic)
    }

    /// Whether it uses native code.
    pub(crate) fn can_be_native(self) -> bool {
        matches!(self, Backend::Native | Backend::Automatic)
    }

    /// The name on the command line.
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
