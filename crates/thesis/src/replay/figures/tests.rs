//! Tests of the table of figures, and a helper for tests of readings.

use std::collections::{BTreeMap, HashSet};
use std::sync::{Arc, Mutex, OnceLock};

use super::{DrawnFigure, Figure, figures};
use crate::replay::ledger;

/// Returns the reading of a figure. A figure is drawn once for all tests.
fn reading(id: &'static str) -> String {
    static DRAWN: Mutex<BTreeMap<&str, Arc<OnceLock<DrawnFigure>>>> = Mutex::new(BTreeMap::new());
    let cell = Arc::clone(DRAWN.lock().unwrap().entry(id).or_default());
    let drawn = cell.get_or_init(|| figures().find(|figure| figure.id == id).unwrap().draw().unwrap());
    drawn.reading.clone()
}

/// Asserts that the reading of a figure contains a text.
#[track_caller]
pub(super) fn assert_reading_contains(id: &'static str, text: &str) {
    let reading = reading(id);
    assert!(reading.contains(text), "{id}: {reading}");
}

#[test]
fn figures_have_unique_names_in_the_order_of_the_thesis() {
    let mut seen = HashSet::new();
    assert!(figures().all(|figure| seen.insert(figure.id)));
    assert!(figures().map(|figure| (figure.chapter(), figure.id)).is_sorted());
    let numbers: Vec<_> =
        figures().filter(|figure| figure.id.ends_with("9-02")).map(Figure::number).collect();
    assert_eq!(numbers, ["Fig 9.2"]);
}

#[test]
fn figures_name_existing_claims() {
    let claims: HashSet<_> = ledger().unwrap().into_iter().map(|claim| claim.id).collect();
    let unknown: Vec<_> =
        figures().flat_map(|figure| figure.claims).filter(|id| !claims.contains(**id)).collect();
    assert!(unknown.is_empty(), "{unknown:?}");
}
