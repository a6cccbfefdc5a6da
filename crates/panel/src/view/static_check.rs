//! The table of a static check as an event.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_equations::{StaticRow, TestValues, static_check};

use crate::event::{CheckRow, Event};

/// Compares every output and derivative with the equations, at random test values with this seed, or at the initial
/// condition.
///
/// # Errors
/// A message if there are no voltages at the values.
pub fn static_check_event(circuit: &Circuit, program: &Program, seed: Option<u64>) -> Result<Event, String> {
    let values = seed.map_or(TestValues::Initial, TestValues::Random);
    let mut check = static_check(circuit, program, &values).map_err(|error| error.to_string())?;
    check.rows.sort_by_key(|row| row.place);
    let rows = check.rows.iter().map(row).collect();
    Ok(Event::StaticCheck { compared: check.has_equations, rows })
}

/// A row of the table.
fn row(row: &StaticRow) -> CheckRow {
    CheckRow {
        element: row.element.clone(),
        kind: row.kind.to_owned(),
        order: row.order,
        quantity: row.quantity.as_ref().map(|quantity| format!("{} in {}", quantity.name, quantity.unit)),
        expected: row.expected,
        wired: row.wired,
        differs: row.differs,
        not_compared: row.not_compared.clone(),
        overloaded: row.is_overloaded,
    }
}
