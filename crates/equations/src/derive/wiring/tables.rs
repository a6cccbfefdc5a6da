//! The tables of a program.

use patchcord_core::ir::Program;

use super::super::system::{TableLaw, TableUnit};

/// The tables, in the order of the program.
pub(super) fn tables(program: &Program) -> Vec<TableLaw> {
    let empty = TableLaw { element: String::new(), points: Vec::new(), unit: None };
    let mut tables = vec![empty; program.table_points().len()];
    for (element, output) in program.element_outputs().iter().enumerate() {
        let [of_time, curve] = [program.drive_table(element), program.element_curve(element)];
        if of_time.or(curve).is_none() {
            continue;
        }
        let signal = program.signals().iter().find(|signal| signal.name == output.name);
        let unit = signal.map(|signal| TableUnit {
            text: signal.unit.clone(),
            factor: signal.per_unit,
            dimension: signal.dimension,
        });
        for (table, unit) in [(of_time, unit), (curve, None)] {
            let Some(table) = table else { continue };
            let points = program.table_points()[table].clone();
            tables[table] = TableLaw { element: output.name.clone(), points, unit };
        }
    }
    tables
}
