//! The places of findings at the panel: which jack, setting, element or parameter the checker means.
//!
//! A finding has a position in the text. The keys that lead there name the place: the position of "B1" in
//! `"P1": {"kind": "pot", "in": "B1"}` is the cord from B1 in the jack "in" of P1. A missing cord has no position of
//! its own. Its message names the input. The hints about the text of a patch have other words at the panel.

use std::collections::HashMap;

use patchcord_core::document::tree::{self, Node};
use patchcord_core::document::{Code, Diagnostic, DiagnosticDocument, Report, Span};
use patchcord_core::elements::{Jacks, Kind};
use patchcord_core::patch::Patch;

use crate::event::{Finding, Place};
use crate::limits::MAX_FINDINGS;
use crate::wiring;

/// The findings of a report with their places at the panel, at most [`MAX_FINDINGS`]. The report must be about the text of
/// the patch. `pulled` has the jacks from which cords were pulled last, by their elements.
pub fn findings(report: &Report, patch: &Patch, pulled: &HashMap<String, String>) -> Vec<Finding> {
    let tree = tree::parse(patch.text()).ok();
    let documents = report.findings.iter().zip(report.documents());
    let finding = |(diagnostic, document): (&Diagnostic, DiagnosticDocument)| Finding {
        code: document.code.to_owned(),
        severity: document.severity.to_owned(),
        message: document.message,
        hint: panel_hint(diagnostic.code, patch, &document.hint).unwrap_or(document.hint),
        place: tree.as_ref().and_then(|tree| place(diagnostic, tree, patch, pulled)),
        line: document.line,
        column: document.column,
    };
    documents.take(MAX_FINDINGS).map(finding).collect()
}

/// What to do at the panel about a finding whose hint says what to write. `None` if the hint is also right at the panel.
fn panel_hint(code: Code, patch: &Patch, hint: &str) -> Option<String> {
    if code == Code::NO_DRIVER {
        let purpose = hint.find(" (purpose: ").map_or("", |start| &hint[start..]);
        return Some(format!("plug a cord in: from an output, or from ground for 0 V{purpose}"));
    }
    let is_empty = patch.elements.is_empty() && patch.drives.is_empty();
    (code == Code::MISSING_KEY && is_empty).then(|| "add an element".to_owned())
}

/// The place of a diagnostic. `None` if it is about the whole patch, a scale, a signal or the run.
fn place(
    diagnostic: &Diagnostic,
    tree: &Node,
    patch: &Patch,
    pulled: &HashMap<String, String>,
) -> Option<Place> {
    let span = diagnostic.span?;
    match tree.key_path(span.start).as_slice() {
        ["parameters", name, ..] => Some(Place { parameter: Some((*name).to_owned()), ..Place::default() }),
        ["drives" | "elements", name] => {
            let jack = (diagnostic.code == Code::NO_DRIVER)
                .then(|| open_jack(patch, name, &diagnostic.message, pulled.get(*name)))
                .flatten();
            Some(Place { jack, ..element_place(name) })
        }
        ["drives" | "elements", name, keys @ ..] => Some(place_in_entry(patch, name, keys, span)),
        ["macros", name, ..] => {
            let mut instances = patch.instances.iter();
            let used = instances.find(|(_, one)| one.macro_name == *name && one.parent.is_none())?;
            Some(element_place(used.0))
        }
        _ => None,
    }
}

/// The place of an element, drive or instance.
fn element_place(name: &str) -> Place {
    Place { element: Some(name.to_owned()), ..Place::default() }
}

/// The place of a position inside the entry of an element, drive or instance. `keys` lead there from the entry.
fn place_in_entry(patch: &Patch, name: &str, keys: &[&str], span: Span) -> Place {
    let entry = patch.drives.get(name).or_else(|| patch.elements.get(name));
    let kind = entry.map(|entry| entry.kind);
    let place = element_place(name);
    match keys {
        ["in", jack, ..] => jack_place(patch, place, jack, span),
        [key, ..] if is_jack(patch, name, kind, key) => jack_place(patch, place, key, span),
        keys if is_setting(patch, name, kind, keys) => Place { setting: Some(keys.join(".")), ..place },
        _ => place,
    }
}

/// Whether an element has a jack of this name, or an instance an input port.
fn is_jack(patch: &Patch, name: &str, kind: Option<&Kind>, key: &str) -> bool {
    let ports = || Some(&patch.macros.get(&patch.instances.get(name)?.macro_name)?.inputs);
    match kind {
        Some(kind) => !kind.has_gains() && kind.input(key).is_some(),
        None => ports().is_some_and(|ports| ports.contains_key(key)),
    }
}

/// Whether keys lead to a setting, or to a group of settings such as "limit".
fn is_setting(patch: &Patch, name: &str, kind: Option<&Kind>, keys: &[&str]) -> bool {
    let path = keys.join(".");
    let is_named = |setting: &str| {
        setting == path || setting.strip_prefix(&path).is_some_and(|rest| rest.starts_with('.'))
    };
    match kind {
        Some(kind) => kind.settings.iter().any(|setting| is_named(setting.name)),
        None => patch.instances.get(name).is_some_and(|instance| instance.settings.contains_key(&path)),
    }
}

/// The place of a jack. If the position is that of a cord in it, the output of the cord is added.
fn jack_place(patch: &Patch, place: Place, jack: &str, span: Span) -> Place {
    let written = patch.text().get(span.start..span.end);
    let name = written.and_then(|text| serde_json::from_str::<String>(text).ok());
    let from = name.filter(|name| name != jack).map(|name| wiring::panel_name(patch, &name));
    Place { jack: Some(jack.to_owned()), from, ..place }
}

/// The jack without a cord that a message about an element or an instance names. For a summing input it is the jack
/// from which a cord was pulled last if the panel has it, or else the one with the least gain.
fn open_jack(patch: &Patch, name: &str, message: &str, pulled: Option<&String>) -> Option<String> {
    let is_named = |input: &str| message.contains(&format!("\"{input}\" of {name}"));
    let Some(entry) = patch.elements.get(name) else {
        let definition = patch.macros.get(&patch.instances.get(name)?.macro_name)?;
        return definition.inputs.keys().find(|port| is_named(port)).cloned();
    };
    let gains = wiring::shown_gains(entry.kind, wiring::machine(patch));
    let pulled = pulled.and_then(|jack| entry.kind.input(jack));
    entry.kind.inputs.iter().enumerate().find_map(|(index, input)| match input.jacks {
        Jacks::Gains => message.contains(&format!(" {} of {name}", input.jack_text())).then(|| {
            let pulled = pulled.filter(|(input, gain)| *input == index && gains.contains(gain));
            format!("{}{}", input.name, pulled.map_or(gains[0], |(_, gain)| gain))
        }),
        _ => is_named(input.name).then(|| input.name.to_owned()),
    })
}

#[cfg(test)]
mod tests;
