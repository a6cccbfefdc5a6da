//! The data model of an effect: a fragment of a few elements, its parameters, its physics and the ways to wire it.
//!
//! The structs follow the keys of an effect's document (docs/effect-format.md). `reader` fills them. The *reach* of a
//! parameter is the unit and the natural size in which its range and its start values are counted. It depends on the
//! site, so that one document suits patches of any size.
//!
//! A form attaches at one kind of site ([`Attachment`]), reads signals there ([`InputRole`]) and gives its outputs to
//! destinations ([`OutputRole`]). Which roles are possible depends on the kind of site: see
//! [`Attachment::input_roles`].

use indexmap::IndexMap;
use serde_json::{Map, Value};

use crate::effects::reach::REACH_NAMES;
use patchcord_expr::{Formula, Unit};

/// A physical effect as a fragment that can be wired into a patch: one file of `patches/effects`.
///
/// # Examples
///
/// ```
/// use patchcord_ident::effects::{Attachment, StartRule};
/// use patchcord_ident::Library;
///
/// let library = Library::shipped();
/// let friction = library.get("viscous-friction").ok_or("a shipped effect")?;
/// let c = &friction.parameters["c"];
/// assert_eq!((c.reach.text(), c.range, c.null_value), ("sum / own", [0.0, 5.0], Some(0.0)));
/// assert_eq!(c.start, StartRule::Values(vec![0.1, 1.0]));
/// assert_eq!(friction.forms[0].attachment, Attachment::Motion);
/// assert!(friction.aliases.contains_key("quadratic-drag"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Effect {
    /// Unique name: the stem of the file name, such as "viscous-friction".
    pub name: String,
    /// Common name of the effect, for headings.
    pub title: String,
    /// The law as a formula in plain text, such as "F = c v".
    pub law: String,
    /// The physics in a sentence or two.
    pub physics: String,
    /// The literature from which the law and the physics are taken.
    pub source: String,
    /// The motion that data must contain to identify the effect.
    pub excitation: String,
    /// Effects that have the same influence under a condition. The key is the name of the effect, the value the
    /// condition in words.
    pub aliases: IndexMap<String, String>,
    /// The fitted parameters by name.
    pub parameters: IndexMap<String, EffectParameter>,
    /// The alternative ways to wire the effect. Each is tried separately.
    pub forms: Vec<Form>,
}

/// A parameter of an effect. Its unit is that of its reach. All values are counted in reaches.
#[derive(Debug, Clone)]
pub struct EffectParameter {
    /// The reach: a product of powers of the largest values at the site, such as `sum / own^2`.
    pub reach: Formula,
    /// Least and largest value of the search, in reaches.
    pub range: [f64; 2],
    /// The rule for the values from which fits start.
    pub start: StartRule,
    /// The value without effect, in reaches. `None` if no fit starts without effect.
    pub null_value: Option<f64>,
    /// The meaning of the parameter in a few words.
    pub description: String,
}

impl Form {
    /// The names that the reaches of this form may contain, given where it attaches and what it reads.
    pub fn reach_names(&self) -> Vec<&'static str> {
        let (is_cord, is_summing) = (self.attachment.is_cord(), self.attachment.is_summing());
        let reads = |role| is_summing && self.reads.contains(&role);
        let reads_load = reads(InputRole::Load) || reads(InputRole::Force);
        let drives_next = is_summing && self.gives.iter().any(|(role, _)| *role == OutputRole::AddToNext);
        let is_available = |name: &str| match name {
            "own" | "sum" => !is_cord,
            "position" => reads(InputRole::Position),
            "load" | "force" => reads_load,
            "next" => drives_next,
            _ => true,
        };
        REACH_NAMES.into_iter().filter(|name| is_available(name)).collect()
    }
}

impl Attachment {
    /// Whether a fragment is inserted into the cords of an output.
    fn is_cord(self) -> bool {
        matches!(self, Attachment::Drive | Attachment::Level)
    }

    /// Whether a fragment adds to the sum that drives an integrator.
    fn is_summing(self) -> bool {
        matches!(self, Attachment::Motion | Attachment::Store | Attachment::Sum)
    }

    /// The inputs that a fragment may have at this kind of site.
    pub fn input_roles(self) -> &'static [InputRole] {
        match self {
            Attachment::Drive | Attachment::Level => &[InputRole::In],
            Attachment::Total => &[InputRole::In, InputRole::Own],
            _ => &[InputRole::Own, InputRole::Position, InputRole::Load, InputRole::Force],
        }
    }

    /// The destinations that a fragment's outputs may have at this kind of site.
    pub fn output_roles(self) -> &'static [OutputRole] {
        match self.is_summing() {
            true => &[OutputRole::Add, OutputRole::Subtract, OutputRole::Brake, OutputRole::AddToNext],
            false => &[OutputRole::Out],
        }
    }
}

impl Effect {
    /// Whether the effect may act more than once at the same site, because each instance has its own frequency.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_ident::Library;
    ///
    /// let library = Library::shipped();
    /// let is_repeatable = |name| library.get(name).is_some_and(|effect| effect.is_repeatable());
    /// assert!(is_repeatable("periodic-disturbance") && !is_repeatable("viscous-friction"));
    /// ```
    pub fn is_repeatable(&self) -> bool {
        self.parameters.values().any(|parameter| parameter.start == StartRule::Spectrum)
    }
}

/// The rule for the values of a parameter from which fits start.
#[derive(Debug, Clone, PartialEq)]
pub enum StartRule {
    /// Each of these values, in reaches.
    Values(Vec<f64>),
    /// The frequencies of the highest peaks in the spectrum of the residuals.
    Spectrum,
    /// Just below the highest measured value of the quantity that the reach names, and just below the highest value
    /// that the model reaches without the effect.
    Highest,
    /// Just above the lowest values, with the sign changed: 3 if the lowest value is -3.
    Lowest,
}

impl StartRule {
    /// The keywords of documents for the rules that depend on data.
    pub const KEYWORDS: [(&str, StartRule); 3] =
        [("spectrum", StartRule::Spectrum), ("highest", StartRule::Highest), ("lowest", StartRule::Lowest)];
}

/// One way to wire an effect.
#[derive(Debug, Clone)]
pub struct Form {
    /// The difference from the other forms of the effect. Empty if there is only one.
    pub note: String,
    /// The kind of site at which it attaches (key `at`).
    pub attachment: Attachment,
    /// Only for a cord: its quantity must have the dimension of this unit. `None` if any dimension suits.
    pub signal: Option<Unit>,
    /// The inputs of the fragment.
    pub reads: Vec<InputRole>,
    /// The outputs of the fragment: the destination, and the name of the element that drives it.
    pub gives: Vec<(OutputRole, String)>,
    /// Volts of the sum per volt of the fragment's output (key `times`); 1 or more. A larger value keeps a force that
    /// is far larger than all others within the range of the machine.
    pub output_gain: f64,
    /// Powers of ten that keep the fragment's potentiometers within 0 ... 1, by name. Each is at least the largest
    /// value of its formula.
    pub gains: IndexMap<String, Formula>,
    /// The drives of the fragment, in the format of a patch.
    pub(crate) drives: Map<String, Value>,
    /// The elements of the fragment, in the format of a macro.
    pub(crate) elements: Map<String, Value>,
    /// The states of the fragment whose initial voltage is fitted (key `free`).
    pub free_states: Vec<String>,
    /// The parameters of the effect that this form has. The first is its strength.
    pub parameters: Vec<String>,
}

/// Defines an enum whose variants are words of a document, with their meanings.
macro_rules! document_words {
    ($(#[$doc:meta])* $name:ident { $($variant:ident $text:literal $meaning:literal),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name {
            $(#[doc = $meaning] $variant,)*
        }

        impl $name {
            /// All variants, in the order of listings.
            pub const ALL: &[$name] = &[$($name::$variant),*];

            /// The word in documents.
            pub fn word(self) -> &'static str {
                match self { $($name::$variant => $text,)* }
            }

            /// The meaning in a few words.
            pub fn meaning(self) -> &'static str {
                match self { $($name::$variant => $meaning,)* }
            }
        }
    };
}

document_words! {
    /// The kind of site at which a fragment attaches.
    Attachment {
        Motion "motion" "the input of an integrator whose output is a velocity",
        Store "store" "the input of an integrator with another output: a level, a temperature, a voltage",
        Sum "sum" "the input of any integrator, except one that only integrates a velocity",
        Drive "drive" "the cords of a drive",
        Level "level" "the cords of a friction level, which drives a brake or the bias of a dead zone",
        Total "total" "between an integrator and everything that drives it",
    }
}

document_words! {
    /// The meaning of an input of a fragment.
    InputRole {
        Own "own" "the output of the integrator, with its sign",
        Position "position" "a signal of the time integral of that output",
        Load "load" "a signal or drive in the unit of the sum",
        Force "force" "a signal in the unit of the sum that is not a drive",
        In "in" "the voltage that the cord carried",
    }
}

document_words! {
    /// The destination of an output of a fragment.
    OutputRole {
        Add "add" "the sum: a positive voltage increases the output of the integrator",
        Subtract "subtract" "the sum: a positive voltage decreases the output of the integrator",
        Brake "brake" "the brake of the integrator",
        Out "out" "the inputs that the cord drove",
        AddToNext "add_to_next" "the sum of another integrator of the same kind, as with add",
    }
}
