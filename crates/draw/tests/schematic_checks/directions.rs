//! Cords run to the right, unless they close a loop or lead to another row.

use patchcord_draw::schematic::{Diagram, Net, PlacedSymbol};

/// The minimum distance of rows in pixels.
const ROW_DISTANCE: f64 = 24.0;

/// Checks every cord that leads to the left.
pub(super) fn check(diagram: &Diagram, case: &str) {
    let rows = rows(diagram);
    for net in &diagram.nets {
        let from = &diagram.symbols[net.from];
        let row = row_of(from, &rows);
        for (reader, jack) in &net.to {
            let (to, at) = (&diagram.symbols[*reader], diagram.symbols[*reader].inputs[*jack]);
            if at.0 > from.outputs[net.output].0 || row_of(to, &rows) != row {
                continue;
            }
            let names = (&from.symbol.name, &to.symbol.name);
            assert!(
                leads_to(diagram, *reader, net.from),
                "{case}: {names:?} leads to the left without closing a loop"
            );
            assert!(
                returns_below(net, rows[row].1, at.0, from.outputs[net.output].0),
                "{case}: {names:?} returns within the row"
            );
        }
    }
}

/// Returns the upper and lower edges of the rows.
fn rows(diagram: &Diagram) -> Vec<(f64, f64)> {
    let mut spans: Vec<_> =
        diagram.symbols.iter().map(|placed| (placed.area.top, placed.area.bottom)).collect();
    spans.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for (top, bottom) in spans {
        match rows.last_mut() {
            Some(row) if top < row.1 + ROW_DISTANCE => row.1 = row.1.max(bottom),
            _ => rows.push((top, bottom)),
        }
    }
    rows
}

/// Returns the row that contains a symbol.
fn row_of(placed: &PlacedSymbol, rows: &[(f64, f64)]) -> usize {
    rows.iter().position(|(top, bottom)| (*top..=*bottom).contains(&placed.area.top)).unwrap()
}

/// Whether a path of nets leads from one symbol to another.
fn leads_to(diagram: &Diagram, from: usize, to: usize) -> bool {
    let (mut visited, mut open) = (vec![false; diagram.symbols.len()], vec![from]);
    while let Some(symbol) = open.pop() {
        if !std::mem::replace(&mut visited[symbol], true) {
            let nets = diagram.nets.iter().filter(|net| net.from == symbol);
            open.extend(nets.flat_map(|net| &net.to).map(|(reader, _)| *reader));
        }
    }
    visited[to]
}

/// Whether a net has a line below the row that spans both ends.
fn returns_below(net: &Net, bottom: f64, left: f64, right: f64) -> bool {
    let mut lines = net.route.lines.iter();
    lines.any(|[from, to]| from.1 == to.1 && from.1 >= bottom && from.0 <= left && to.0 >= right)
}
