//! A suggestion of what the columns of a data file are.
//!
//! People name columns after the quantity, often with its unit. So a column belongs to the signal or drive of the same
//! name. Otherwise it belongs to the only one of its dimension. The user corrects the rest.

use patchcord_core::circuit::Circuit;
use patchcord_core::document::csv_table::without_unit;
use patchcord_expr::{Dimension, Unit, UnitLabel};
use patchcord_ident::DataColumn;
use serde_json::{Map, Value};

/// Names of a column of times, in lower case.
const TIME_NAMES: [&str; 9] = ["t", "time", "zeit", "temps", "tempo", "tiempo", "sec", "second", "seconds"];
/// Characters between a name and its unit, as in "x_mm".
const SEPARATORS: [char; 4] = ['_', ' ', '.', '-'];

/// A signal or drive of the patch that a column can belong to.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Target {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: Unit,
    /// Whether it is a drive.
    pub is_drive: bool,
}

/// A suggested experiment.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Suggestion {
    /// The document, without the keys "patch", "data" and "fit".
    pub experiment: Map<String, Value>,
    /// What it lacks, and what to do, a text each.
    pub notes: Vec<String>,
}

/// The drives of a patch, then its signals. If it has no signals, its elements are signals.
pub(crate) fn targets(circuit: &Circuit) -> Vec<Target> {
    let patch = circuit.patch();
    let target = |name: &str, scale: Option<usize>, is_drive: bool| {
        let unit = match scale {
            Some(scale) => circuit.derived_unit(scale).clone(),
            None => Unit::parse("V").ok()?,
        };
        Some(Target { name: name.to_owned(), unit, is_drive })
    };
    let drives = patch.drives.iter().filter_map(|(name, drive)| {
        let scale = drive.scale.as_ref().and_then(|scale| circuit.derived_index(&scale.value));
        target(name, scale, true)
    });
    // The signals of the patch are first.
    let all = circuit.signals();
    let named = if patch.signals.is_empty() { all } else { &all[..patch.signals.len().min(all.len())] };
    let signals =
        named.iter().filter(|signal| !patch.signals.is_empty() || !patch.drives.contains_key(&signal.name));
    drives.chain(signals.filter_map(|signal| target(&signal.name, signal.scale, false))).collect()
}

/// Suggests which column has the times, and what the other columns are.
pub(crate) fn suggest(columns: &[DataColumn], targets: &[Target]) -> Suggestion {
    let time = time_column(columns);
    let roles = roles(columns, targets, time);
    let chosen = |is_drive: bool| -> Map<String, Value> {
        let pairs = columns.iter().zip(&roles).filter_map(|(column, role)| {
            let target = &targets[(*role)?];
            (target.is_drive == is_drive).then(|| (target.name.clone(), column.name.clone().into()))
        });
        pairs.collect()
    };
    let (drives, outputs) = (chosen(true), chosen(false));
    let mut suggestion = Suggestion::default();
    match time {
        Some(index) => {
            suggestion.experiment.insert("time".to_owned(), columns[index].name.clone().into());
        }
        None => suggestion.notes.push(
            "no column increases from row to row: select the column of the times, or give the interval of the samples"
                .to_owned(),
        ),
    }
    if outputs.is_empty() {
        let note =
            "no column has the name or the dimension of a signal: select the column of each measured signal";
        suggestion.notes.push(note.to_owned());
    }
    if !drives.is_empty() {
        suggestion.experiment.insert("drives".to_owned(), drives.into());
    }
    suggestion.experiment.insert("outputs".to_owned(), outputs.into());
    suggestion
}

/// The column of the times: the first one with such a name, or else the first one that increases and can be in
/// seconds.
fn time_column(columns: &[DataColumn]) -> Option<usize> {
    let is_named = |column: &DataColumn| TIME_NAMES.contains(&bare_name(&column.name).as_str());
    let time = Unit::parse("s").ok()?.dimension();
    let is_time = |column: &DataColumn| dimension(column).is_none_or(|dimension| dimension == time);
    let position = |condition: &dyn Fn(&DataColumn) -> bool| columns.iter().position(condition);
    position(&is_named).or_else(|| position(&|column| column.is_rising && is_time(column)))
}

/// For every column the index of the target that it belongs to.
fn roles(columns: &[DataColumn], targets: &[Target], time: Option<usize>) -> Vec<Option<usize>> {
    let mut roles = vec![None; columns.len()];
    // A column that does not move has no information.
    let is_free = |roles: &[Option<usize>], column: usize| {
        Some(column) != time && roles[column].is_none() && columns[column].least < columns[column].most
    };
    let names: [fn(&str) -> String; 3] = [str::to_owned, str::to_lowercase, bare_name];
    for name in names {
        for (index, column) in columns.iter().enumerate() {
            let is_same = |(target_index, target): &(usize, &Target)| {
                !roles.contains(&Some(*target_index))
                    && name(&target.name) == name(&column.name)
                    && dimension(column).is_none_or(|unit| unit == target.unit.dimension())
            };
            if is_free(&roles, index) {
                let found = targets.iter().enumerate().find(is_same).map(|(target_index, _)| target_index);
                roles[index] = found;
            }
        }
    }
    let by_name = roles.clone();
    for column in (0..columns.len()).filter(|column| is_free(&by_name, *column)) {
        let Some(unit) = dimension(&columns[column]) else { continue };
        let mut same_columns = (0..columns.len())
            .filter(|other| is_free(&by_name, *other) && dimension(&columns[*other]) == Some(unit));
        let mut same_targets = targets
            .iter()
            .enumerate()
            .filter(|(index, target)| !by_name.contains(&Some(*index)) && target.unit.dimension() == unit);
        if let (Some(_), None, Some((target, _)), None) =
            (same_columns.next(), same_columns.next(), same_targets.next(), same_targets.next())
        {
            roles[column] = Some(target);
        }
    }
    roles
}

/// The dimension of a column. None if the file does not give a unit.
fn dimension(column: &DataColumn) -> Option<Dimension> {
    match UnitLabel::read(column.unit.as_deref()?) {
        UnitLabel::Unit(unit) => Some(unit.dimension()),
        _ => None,
    }
}

/// A name in lower case, without the unit at its end: "x" for "X (mm)" and for "x_mm".
fn bare_name(name: &str) -> String {
    let name = without_unit(name);
    let is_unit = |text: &str| text.contains(char::is_alphabetic) && Unit::parse(text).is_ok();
    let bare = name.rsplit_once(SEPARATORS).filter(|(front, label)| !front.is_empty() && is_unit(label));
    bare.map_or(name, |(front, _)| front).to_lowercase()
}

#[cfg(test)]
mod tests;
