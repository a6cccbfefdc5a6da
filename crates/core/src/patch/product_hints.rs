//! Completes the hints about numbers with units in formulas, such as "2 m".
//!
//! If the unit is also a name that the formula can use, a product may be meant: "2 * m". The names are known only when
//! the whole document is read.

use crate::document::tree::{Content, Node};
use crate::document::{Code, Diagnostic, MAX_SUGGESTIONS, possible_product};

/// Adds the product to the hint about each number with a unit whose unit is also a name. The search of each formula in
/// the document takes time, so only the first of many findings are completed.
pub(super) fn offer_products(root: &Node, findings: &mut [Diagnostic]) {
    let about_formulas = findings.iter_mut().filter(|finding| finding.code == Code::BAD_FORMULA);
    for finding in about_formulas.take(MAX_SUGGESTIONS) {
        let Some(span) = finding.span else { continue };
        let Content::Text(text) = &root.value_at(span.start).value else { continue };
        let Some((product, name)) = possible_product(text) else { continue };
        if can_use(root, &root.key_path(span.start), &name)
            && let Some(hint) = &finding.hint
        {
            finding.hint = Some(format!("{hint}, or {product} for a product"));
        }
    }
}

/// Whether the formula at this path of keys can use a name: a parameter or a scale, in a macro also one of its
/// settings, and in a phase of the run also a signal.
fn can_use(root: &Node, path: &[&str], name: &str) -> bool {
    let has_name = |section: Option<&Node>| section.is_some_and(|section| section.child(name).is_some());
    let is_local = match path {
        ["macros", definition, "elements", ..] => {
            let definition = root.child("macros").and_then(|macros| macros.child(definition));
            has_name(definition.and_then(|definition| definition.child("settings")))
        }
        ["run", ..] => has_name(root.child("signals")),
        _ => false,
    };
    is_local || has_name(root.child("parameters")) || has_name(root.child("scales"))
}

#[cfg(test)]
mod tests {
    use crate::document::{Code, Diagnostic};
    use crate::patch::Patch;

    /// The hints about a document with the parameter `m`, the setting `s` of a macro and the signal `kg`.
    fn hints(element: &str, in_macro: &str, change: &str) -> Vec<String> {
        let text = format!(
            r#"{{"patchcord": 1, "parameters": {{"m": {{"value": 1, "unit": "kg"}}}},
                "macros": {{"half": {{
                    "inputs": {{"in": ""}}, "outputs": {{"out": "P"}}, "settings": {{"s": {{"unit": "1"}}}},
                    "elements": {{"P": {{"kind": "pot", "in": "in", "setting": "{in_macro}"}}}}
                }}}},
                "elements": {{"P": {{"kind": "pot", "in": "+100", "setting": "{element}"}}}},
                "signals": {{"kg": {{"at": "P"}}}},
                "run": {{"step": 0.1, "phases": [{{"operate": 1}}, {{"set": {{"m": "{change}"}}}}]}}}}"#
        );
        let patch = Patch::parse("p.json", &text).unwrap();
        let about_formulas = patch.findings().iter().filter(|finding| finding.code == Code::BAD_FORMULA);
        about_formulas.map(Diagnostic::advice).map(str::to_owned).collect()
    }

    #[test]
    fn a_product_is_offered_if_the_unit_is_a_name_that_the_formula_can_use() {
        let (alone, in_unit) = ("write a number without a unit", "write the number alone, in that unit");
        let product = |hint: &str, product: &str| format!("{hint}, or {product} for a product");
        assert_eq!(hints("0.5 m", "s", "m"), [product(alone, "0.5 * m")]);
        assert_eq!(hints("0.5", "0.5 s", "m"), [product(alone, "0.5 * s")]);
        assert_eq!(hints("0.5", "0.5m", "m"), [product(alone, "0.5 * m")]);
        assert_eq!(hints("0.5", "s", "2 kg"), [product(in_unit, "2 * kg")]);
        assert_eq!(hints("0.5 s", "0.5 kg", "2 s"), [alone, alone, in_unit]);
    }
}
