//! Changes of cords in the JSON document of a patch.

use serde_json::{Value, json};

/// Where the document has a cord.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct CordPlace {
    /// Name of the element or instance that the cord leads to.
    pub element: String,
    /// Name of the jack.
    pub jack: String,
    /// Its place among the cords of the jack.
    pub position: usize,
    /// The output that is plugged in, as written.
    pub source: String,
}

/// The value at a jack: a name or a list of names. `entry` is the element of the document.
fn jack<'e>(entry: &'e mut Value, name: &str) -> Option<&'e mut Value> {
    let jacks = if entry.get("in").is_some_and(Value::is_object) { entry.get_mut("in")? } else { entry };
    jacks.get_mut(name)
}

/// Connects a cord to another output. `None` if the document does not have the cord.
pub(super) fn replug(entry: &mut Value, cord: &CordPlace, source: &str) -> Option<()> {
    match jack(entry, &cord.jack)? {
        Value::Array(sources) => *sources.get_mut(cord.position)? = json!(source),
        only => *only = json!(source),
    }
    Some(())
}

/// Removes a cord from a jack of the object "in". `None` if the document does not have the cord there.
pub(super) fn unplug(entry: &mut Value, cord: &CordPlace) -> Option<()> {
    let jacks = entry.get_mut("in")?.as_object_mut()?;
    let is_empty = match jacks.get_mut(&cord.jack)? {
        Value::Array(sources) if cord.position < sources.len() => {
            sources.remove(cord.position);
            sources.is_empty()
        }
        Value::String(_) => true,
        _ => return None,
    };
    if is_empty {
        jacks.shift_remove(&cord.jack);
    }
    Some(())
}

/// Adds a cord at a jack of the object "in". `None` if the element has no such object.
pub(super) fn plug(entry: &mut Value, jack: &str, source: &str) -> Option<()> {
    let jacks = entry.get_mut("in")?.as_object_mut()?;
    let sources = jacks.entry(jack.to_owned()).or_insert_with(|| json!([]));
    if let Value::String(only) = sources {
        *sources = json!([only]);
    }
    sources.as_array_mut()?.push(json!(source));
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cord of the element E.
    fn cord(jack: &str, position: usize) -> CordPlace {
        CordPlace { element: "E".to_owned(), jack: jack.to_owned(), position, source: "A".to_owned() }
    }

    #[test]
    fn one_of_several_equal_cords_is_replaced() {
        let mut pair = json!({"kind": "diode-lower-of", "in": ["A", "A"]});
        assert_eq!(replug(&mut pair, &cord("in", 1), "B"), Some(()));
        assert_eq!(pair["in"], json!(["A", "B"]));
        let mut product = json!({"kind": "multiplier", "a": "A", "b": "A"});
        assert_eq!(replug(&mut product, &cord("b", 0), "B"), Some(()));
        assert_eq!(product, json!({"kind": "multiplier", "a": "A", "b": "B"}));
        assert_eq!(replug(&mut product, &cord("c", 0), "B"), None);
    }

    #[test]
    fn the_last_cord_of_a_jack_leaves_no_empty_list() {
        let mut summer = json!({"in": {"x1": ["A", "B"], "x10": "C"}});
        assert_eq!(unplug(&mut summer, &cord("x1", 0)), Some(()));
        assert_eq!(unplug(&mut summer, &cord("x10", 0)), Some(()));
        assert_eq!(summer, json!({"in": {"x1": ["B"]}}));
        assert_eq!(unplug(&mut summer, &cord("x1", 7)), None);
        assert_eq!(unplug(&mut json!({"in": "A"}), &cord("in", 0)), None);
    }

    #[test]
    fn a_cord_is_added_after_the_others() {
        let mut summer = json!({"in": {"x10": "A"}});
        assert_eq!(plug(&mut summer, "x10", "B"), Some(()));
        assert_eq!(plug(&mut summer, "x1", "C"), Some(()));
        assert_eq!(summer, json!({"in": {"x10": ["A", "B"], "x1": ["C"]}}));
        assert_eq!(plug(&mut json!({"in": "A"}), "x1", "B"), None);
    }
}
