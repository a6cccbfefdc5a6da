//! The patch as it is, fitted.

use super::Told;
use super::sheet::{over_noise, parameters};
use crate::html::escaped;
use crate::plot::PlotError;

pub(super) fn section(told: &Told<'_>) -> Result<String, PlotError> {
    let stage = &told.outcome.base;
    Ok(format!(
        "<section>\n<h2>The patch as it is</h2>\n<p>{} is fitted to the training data: its parameters, and the voltages with which its integrators begin. \
         So it stands in <a href=\"fitted.json\">fitted.json</a>. \
         What it leaves is {} times the noise (rms); on the data held back, where only those voltages are fitted, {}. Besides, {}.</p>\n{}{}</section>\n",
        escaped(told.experiment.patch.file()),
        over_noise(&stage.train),
        over_noise(&stage.test),
        told.outcome.agreement.sentence(),
        parameters(stage),
        told.pictures(&[("the patch as it is", stage)])?
    ))
}
