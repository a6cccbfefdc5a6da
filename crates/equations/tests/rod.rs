//! A problem with any number of states. Tests and benches share this file.

use patchcord_core::patch::Problem;

/// A rod of cells, heated at one end, in equal cells: T_i' = a (T_(i-1) - 2 T_i + T_(i+1)). `run` is its section.
pub(crate) fn rod(cells: usize, run: &str) -> Problem {
    let quantities: Vec<String> =
        (1..=cells).map(|cell| format!(r#""T{cell}": {{"unit": "K", "initial": 0}}"#)).collect();
    let left = |cell: usize| if cell == 1 { "T_hot".to_owned() } else { format!("T{}", cell - 1) };
    let right = |cell: usize| if cell == cells { "0".to_owned() } else { format!("T{}", cell + 1) };
    let equation = |cell: usize| format!("\"T{cell}' = a ({} - 2 T{cell} + {})\"", left(cell), right(cell));
    let equations: Vec<String> = (1..=cells).map(equation).collect();
    let text = format!(
        r#"{{"patchcord": 1,
  "parameters": {{"a": {{"value": 2, "unit": "1/s"}}, "T_hot": {{"value": 80, "unit": "K"}}}},
  "quantities": {{{}}},
  "equations": [{}],
  "run": {run}
}}"#,
        quantities.join(", "),
        equations.join(", ")
    );
    Problem::parse("rod.json", &text).unwrap_or_else(|report| panic!("{report}"))
}
