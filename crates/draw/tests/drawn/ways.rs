//! Which way cords run: to the right, but where they close a loop or lead to another row.

use patchcord_draw::schematic::{Diagram, Net, PlacedSymbol};

/// Rows stand at least this far apart.
const BETWEEN_ROWS: f64 = 24.0;

/// Looks at every cord that leads to the left.
pub fn check(drawn: &Diagram, what: &str) {
    let rows = rows(drawn);
    for net in &drawn.nets {
        let from = &drawn.symbols[net.from];
        let row = row_of(from, &rows);
        for (reader, jack) in &net.to {
            let (to, at) = (&drawn.symbols[*reader], drawn.symbols[*reader].inputs[*jack]);
            if at.0 > from.outputs[net.outlet].0 || row_of(to, &rows) != row {
                continue;
            }
            let names = (&from.symbol.name, &to.symbol.name);
            assert!(
                leads_to(drawn, *reader, net.from),
                "{what}: {names:?} leads to the left, and back nowhere"
            );
            assert!(
                returns_below(net, rows[row].1, at.0, from.outputs[net.outlet].0),
                "{what}: {names:?} returns within the row"
            );
        }
    }
}

/// Upper and lower edges of the rows.
fn rows(drawn: &Diagram) -> Vec<(f64, f64)> {
    let mut spans: Vec<_> =
        drawn.symbols.iter().map(|placed| (placed.area.top, placed.area.bottom)).collect();
    spans.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for (top, bottom) in spans {
        match rows.last_mut() {
            Some(row) if top < row.1 + BETWEEN_ROWS => row.1 = row.1.max(bottom),
            _ => rows.push((top, bottom)),
        }
    }
    rows
}

fn row_of(placed: &PlacedSymbol, rows: &[(f64, f64)]) -> usize {
    rows.iter().position(|(top, bottom)| (*top..=*bottom).contains(&placed.area.top)).unwrap()
}

/// Whether signals come from one symbol to another.
fn leads_to(drawn: &Diagram, from: usize, to: usize) -> bool {
    let (mut seen, mut open) = (vec![false; drawn.symbols.len()], vec![from]);
    while let Some(symbol) = open.pop() {
        if !std::mem::replace(&mut seen[symbol], true) {
            let leaving = drawn.nets.iter().filter(|net| net.from == symbol);
            open.extend(leaving.flat_map(|net| &net.to).map(|(reader, _)| *reader));
        }
    }
    seen[to]
}

/// Whether a net has a line below the row that spans from left to right.
fn returns_below(net: &Net, bottom: f64, left: f64, right: f64) -> bool {
    let mut lines = net.route.lines.iter();
    lines.any(|[from, to]| from.1 == to.1 && from.1 >= bottom && from.0 <= left && to.0 >= right)
}
