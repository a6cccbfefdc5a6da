//! The error of the common path.

use crate::document::{DocumentError, Report};
use crate::draw::ScopeError;
use crate::draw::plot::PlotError;
use crate::ident::ExperimentError;
use crate::ident::fit::model::ModelError;
use crate::instruments::MeasureError;
use crate::linear::LinearError;
use crate::patch::EditError;
use crate::solve::{RunError, StoppedRun};
use crate::sweep::{PlanError, SweepError};

/// Any error between a file and a picture. Every error of the crate that a program usually meets converts to it, so a
/// program can use `?` with one type.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A document cannot be read or written, or is not valid.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// A patch has faults. The report has all of them.
    #[error(transparent)]
    Patch(#[from] Box<Report>),
    /// An edit does not fit a patch.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// A run cannot begin.
    #[error(transparent)]
    Settings(#[from] RunError),
    /// A run stopped before its end.
    #[error(transparent)]
    Run(#[from] StoppedRun),
    /// A signal cannot be drawn.
    #[error(transparent)]
    Draw(#[from] ScopeError),
    /// A picture cannot be rendered.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A circuit cannot be linearised, or its linear model cannot be analysed.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// A measure is not valid for the signals of a program.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// A sweep has no valid plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A sweep cannot be made.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// An experiment cannot be read.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// A patch cannot be fitted to data.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A file cannot be written.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}
