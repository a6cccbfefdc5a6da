//! What a user can select: the columns of the data, and the signals, drives and parameters of the patch.

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Patch;
use patchcord_ident::{DataColumn, data_columns};
use serde_json::{Map, Value};

use crate::command::NamedText;
use crate::event::{ColumnView, ColumnsView, Event, ParameterView, SignalView};
use crate::experiment::{experiment_text, read_experiment};
use crate::message::{experiment_texts, patch_message};
use crate::suggestion::{Suggestion, suggest, targets};

/// The event with everything that a user can select.
///
/// # Errors
/// The message if the patch has faults, or if the data cannot be read.
pub(crate) fn columns_event(patch: &Patch, data: &NamedText) -> Result<Event, String> {
    let circuit = Circuit::new(patch).map_err(|report| patch_message(&report))?;
    let columns = data_columns(&data.name, &data.text);
    let columns = columns.map_err(|report| experiment_texts(&report).join("\n"))?;
    let targets = targets(&circuit);
    let Suggestion { mut experiment, notes } = suggest(&columns, &targets);
    experiment.insert("fit".to_owned(), suggested_fit(patch, data, &experiment).into());
    let views = |is_drive: bool| {
        let chosen = targets.iter().filter(move |target| target.is_drive == is_drive);
        chosen.map(|target| SignalView { name: target.name.clone(), unit: target.unit.text().to_owned() })
    };
    Ok(Event::Columns(ColumnsView {
        file: data.name.clone(),
        rows: row_count(&data.text),
        columns: columns.into_iter().map(column_view).collect(),
        signals: views(false).collect(),
        drives: views(true).collect(),
        parameters: parameter_views(patch),
        experiment,
        notes,
    }))
}

/// A column for a client.
fn column_view(column: DataColumn) -> ColumnView {
    let DataColumn { name, unit, least, most, .. } = column;
    ColumnView { name, unit, least, most }
}

/// The number of rows of a CSV file: its lines but comments, empty ones and that of the names.
fn row_count(text: &str) -> usize {
    let is_row = |line: &&str| !line.trim().is_empty() && !line.starts_with('#');
    text.lines().filter(is_row).count().saturating_sub(1)
}

/// The parameters that have a range.
fn parameter_views(patch: &Patch) -> Vec<ParameterView> {
    let views = patch.parameters.iter().filter_map(|(name, parameter)| {
        let (low, high) = parameter.range?;
        let (name, unit) = (name.clone(), parameter.unit.text().to_owned());
        (low < high).then_some(ParameterView { name, unit, value: parameter.value, low, high })
    });
    views.collect()
}

/// The parameters that the suggested experiment fits: all that can be fitted, according to the reader of experiments. If
/// the suggestion is not complete, all that have a range.
fn suggested_fit(patch: &Patch, data: &NamedText, experiment: &Map<String, Value>) -> Vec<String> {
    let text = experiment_text(experiment, patch, data);
    let read = text.and_then(|text| read_experiment(patch, data, &text));
    match read {
        Ok(experiment) => experiment.fit,
        Err(_) => parameter_views(patch).into_iter().map(|parameter| parameter.name).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_empty_lines_are_no_rows() {
        assert_eq!(row_count("# t: s\n\nt,x\n0,1\n# a note\n1,2\n"), 2);
        assert_eq!((row_count("t,x"), row_count("")), (0, 0));
    }
}
