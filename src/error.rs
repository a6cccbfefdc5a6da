//! The error of the whole library.

use crate::document::{DocumentError, ParameterRangeError, Report};
use crate::draw::plot::PlotError;
use crate::draw::schematic::DrawError;
use crate::draw::{ScopeError, TooManySamplesError};
use crate::expr::{ConversionError, FormulaError, UnitError};
use crate::ident::ExperimentError;
use crate::ident::effects::EffectError;
use crate::ident::fit::model::ModelError;
use crate::instruments::{
    CriticalVelocityError, CyclesError, FirstOscillationError, FrictionLoopError, HarmonicError,
    MeasureError, MissingPointError, OscillationError, ProfileError, RingingError, SteadyFrictionError,
    StickError, WindowError,
};
use crate::ir::SettingError;
use crate::linear::LinearError;
use crate::patch::EditError;
use crate::solve::{CurveError, DriveTableError, RunError, StoppedRunError};
use crate::sweep::{JournalError, PlanError, SweepError};
use crate::thesis::chain::ChainError;
use crate::thesis::replay::{ArgumentError, CheckError, FigureError, LedgerError, ReplayError};
use crate::thesis::slideway::SlidewayError;
use crate::trace::CsvError;

/// Any error of the library. Every error of the crate converts to it, so a program can use `?` with one type.
///
/// # Examples
///
/// ```
/// use patchcord::expr::Unit;
/// use patchcord::{Error, Patch};
///
/// fn lengths() -> Result<[f64; 2], Error> {
///     Ok([Unit::parse("mm")?.factor(), Unit::parse("lightyear")?.factor()])
/// }
///
/// assert!(matches!(lengths(), Err(Error::Unit(_))));
/// assert!(matches!(Patch::read("no-such-patch.json").map_err(Error::from), Err(Error::Document(_))));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A document cannot be read or written, or is not valid.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// A patch has faults. The report has all of them, with their positions.
    #[error(transparent)]
    Patch(#[from] Box<Report>),
    /// An edit does not fit a patch, for example because the element does not exist.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// A text is not a unit.
    #[error(transparent)]
    Unit(#[from] UnitError),
    /// A value cannot be converted from one unit to another.
    #[error(transparent)]
    Conversion(#[from] ConversionError),
    /// A text is not a formula, or a formula cannot be evaluated.
    #[error(transparent)]
    Formula(#[from] FormulaError),
    /// A parameter or a setting of a program cannot have the given value.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A value is outside the range of its parameter.
    #[error(transparent)]
    ParameterRange(#[from] ParameterRangeError),
    /// The points for a drive do not form a table.
    #[error(transparent)]
    DriveTable(#[from] DriveTableError),
    /// The points for an element do not form a curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// A run cannot begin, or a machine cannot reach the next instant.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A run stopped before its end. The error has the samples that were recorded until then.
    #[error(transparent)]
    Stopped(#[from] StoppedRunError),
    /// A trace cannot be written as a table.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// A recorded signal cannot be shown in a scope picture.
    #[error(transparent)]
    Scope(#[from] ScopeError),
    /// A run has more samples than its pictures permit.
    #[error(transparent)]
    Samples(#[from] TooManySamplesError),
    /// A circuit cannot be drawn as a schematic or a patch panel.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// A picture or a drawing cannot be rendered, or its file name selects no format.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A circuit cannot be linearised, or its linear model cannot be analysed.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// A measure is not valid for the signals of a program.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// An instrument gives no reading. The error is that of the instrument.
    #[error(transparent)]
    Instrument(Box<dyn std::error::Error + Send + Sync>),
    /// The axes of a sweep do not form a plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A sweep cannot be made from its patch, its settings and its measures.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// The file of a sweep cannot be continued or written.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// An experiment cannot be read.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// A folder of effects cannot be read.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// A patch cannot be fitted to data.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A law, a prediction or a figure of the slideway thesis gives no result. The error is that of [`crate::thesis`].
    #[error(transparent)]
    Thesis(Box<dyn std::error::Error + Send + Sync>),
    /// A file cannot be read or written.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

/// Implements the conversion of several error types into one variant with a boxed error.
macro_rules! boxed {
    ($variant:ident: $($error:ty),* $(,)?) => {
        $(impl From<$error> for Error {
            fn from(error: $error) -> Self {
                Error::$variant(Box::new(error))
            }
        })*
    };
}

boxed!(
    Instrument: CriticalVelocityError,
    CyclesError,
    FirstOscillationError,
    FrictionLoopError,
    HarmonicError,
    MissingPointError,
    OscillationError,
    ProfileError,
    RingingError,
    SteadyFrictionError,
    StickError,
    WindowError,
);
boxed!(Thesis: ArgumentError, ChainError, CheckError, FigureError, LedgerError, ReplayError, SlidewayError);
