//! Effects that a patch may lack: fragments of a few elements, with the places where they attach, parameters and physics.

use indexmap::IndexMap;
use serde_json::{Map, Value};

use crate::effects::reach::NAMES;
use patchcord_expr::{Formula, Unit};

/// A physical effect as a fragment that can be wired into a patch: one file of `patches/effects`.
#[derive(Debug, Clone)]
pub struct Effect {
    /// Its name: the stem of its file.
    pub name: String,
    /// What people call it.
    pub title: String,
    /// Its law as a formula.
    pub law: String,
    /// Its physics in a sentence.
    pub physics: String,
    /// Where law and physics are from.
    pub source: String,
    /// What data must hold for it to be judged.
    pub excitation: String,
    /// Other effects that are the same thing, and when.
    pub aliases: IndexMap<String, String>,
    /// What is fitted, by name.
    pub parameters: IndexMap<String, EffectParameter>,
    /// The ways to wire it.
    pub forms: Vec<Form>,
}

/// A parameter of an effect. It has the unit of its reach; range and starts count in reaches.
#[derive(Debug, Clone)]
pub struct EffectParameter {
    /// A product of powers of what is largest where it attaches.
    pub reach: Formula,
    /// Least and largest value searched.
    pub range: [f64; 2],
    /// From where fits begin.
    pub start: Start,
    /// The value at which there is no effect, in reaches.
    pub none: Option<f64>,
    /// What it is.
    pub description: String,
}

impl Form {
    /// The names of what is largest where it attaches, in which its parameters may be measured.
    pub fn measures(&self) -> Vec<&'static str> {
        let (is_cord, is_beside) = (self.at.is_cord(), self.at.is_beside());
        let has = |reads| is_beside && self.reads.contains(&reads);
        let has_load = has(Reads::Load) || has(Reads::Force);
        let gives_on = is_beside && self.gives.iter().any(|(gives, _)| *gives == Gives::AddToNext);
        let has = |name: &str| match name {
            "own" | "sum" => !is_cord,
            "position" => has(Reads::Position),
            "load" | "force" => has_load,
            "next" => gives_on,
            _ => true,
        };
        NAMES.into_iter().filter(|name| has(name)).collect()
    }
}

impl Attachment {
    /// Whether it lies in the cords of an output.
    fn is_cord(self) -> bool {
        matches!(self, Attachment::Drive | Attachment::Level)
    }

    /// Whether a fragment adds to what drives an integrator.
    fn is_beside(self) -> bool {
        matches!(self, Attachment::Motion | Attachment::Store | Attachment::Sum)
    }

    /// What a fragment there may read.
    pub fn reads(self) -> &'static [Reads] {
        match self {
            Attachment::Drive | Attachment::Level => &[Reads::In],
            Attachment::Total => &[Reads::In, Reads::Own],
            _ => &[Reads::Own, Reads::Position, Reads::Load, Reads::Force],
        }
    }

    /// What its elements may be wired to.
    pub fn gives(self) -> &'static [Gives] {
        match self.is_beside() {
            true => &[Gives::Add, Gives::Subtract, Gives::Brake, Gives::AddToNext],
            false => &[Gives::Out],
        }
    }
}

impl Effect {
    /// Whether it may act at the same place twice: each time with a frequency of its own.
    pub fn recurs(&self) -> bool {
        self.parameters.values().any(|own| own.start == Start::Spectrum)
    }
}

/// From where fits begin.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// From each of these values.
    Values(Vec<f64>),
    /// From the frequencies of which what is left is full.
    Spectrum,
    /// From just below the highest value of what the reach names, and of those to which the patch comes.
    Highest,
    /// From just above its lowest value, counted downward.
    Lowest,
}

impl Start {
    /// The words for those that data tell.
    pub const WORDS: [(&str, Start); 3] =
        [("spectrum", Start::Spectrum), ("highest", Start::Highest), ("lowest", Start::Lowest)];
}

/// A way to wire an effect.
#[derive(Debug, Clone)]
pub struct Form {
    /// What sets it apart from the other forms.
    pub note: String,
    /// Where it attaches.
    pub at: Attachment,
    /// Of a cord, the unit in which what comes through it must be measurable.
    pub signal: Option<Unit>,
    /// What it reads.
    pub reads: Vec<Reads>,
    /// What its elements are wired to.
    pub gives: Vec<(Gives, String)>,
    /// So many volts of the sum stand for a volt that it gives: forces far above all others would leave the range of the machine.
    pub times: f64,
    /// Powers of ten that keep its potentiometers within 0 ... 1, by name: at least what the formula comes to.
    pub gains: IndexMap<String, Formula>,
    /// Its drives, as in a patch.
    pub drives: Map<String, Value>,
    /// Its elements, as in a macro.
    pub elements: Map<String, Value>,
    /// Its states of which the data find the initial voltage.
    pub free: Vec<String>,
    /// The parameters that it has.
    pub parameters: Vec<String>,
}

/// Words that documents choose one of.
macro_rules! words {
    ($(#[$doc:meta])* $name:ident { $($variant:ident $text:literal $meaning:literal),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name {
            $(#[doc = $meaning] $variant,)*
        }

        impl $name {
            /// Every one, in the order of listings.
            pub const ALL: &[$name] = &[$($name::$variant),*];

            /// The word for it in documents.
            pub fn word(self) -> &'static str {
                match self { $($name::$variant => $text,)* }
            }

            /// What it means.
            pub fn meaning(self) -> &'static str {
                match self { $($name::$variant => $meaning,)* }
            }
        }
    };
}

words! {
    /// Where a fragment attaches.
    Attachment {
        Motion "motion" "the input of an integrator that gives a velocity",
        Store "store" "the input of an integrator that gives something else: a level, a temperature, a voltage",
        Sum "sum" "the input of any integrator that does more than integrate a velocity",
        Drive "drive" "in the cords of a drive",
        Level "level" "in the cords of a friction level, which drives a brake or the bias of a dead zone",
        Total "total" "between all that drives an integrator and the integrator",
    }
}

words! {
    /// What a fragment reads.
    Reads {
        Own "own" "what the integrator gives, positive where it is",
        Position "position" "a signal of its time integral",
        Load "load" "a signal or drive in the unit of the sum",
        Force "force" "such a signal that is no drive",
        In "in" "what came through the cord",
    }
}

words! {
    /// What an element of a fragment is wired to.
    Gives {
        Add "add" "the sum, upward",
        Subtract "subtract" "the sum, downward",
        Brake "brake" "the brake of the integrator",
        Out "out" "what the cord drove",
        AddToNext "add_to_next" "the sum of another integrator of the same kind, upward",
    }
}
