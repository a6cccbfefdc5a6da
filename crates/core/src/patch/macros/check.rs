//! What is wrong with a macro itself: told once, however often it is used.

use std::collections::HashSet;

use indexmap::IndexMap;

use super::outline::{Meaning, Section};
use super::read::KEYS;
use super::{Item, Macro, MacroSetting, Macros};
use crate::document::fields::Findings;
use crate::document::{Code, Diagnostic, Placed, Span, TIME_SCALE, misfit, suggestion};
use crate::elements::REGISTRY;
use crate::patch::document::{Amount, Entry, Patch};
use crate::patch::names::{outlet_name, quantity_name, same_name};
use patchcord_expr::{Dimension, Formula, Scope};

/// Checks every macro, and takes out of them what cannot be used; `outside` is the patch's own section of elements.
pub(super) fn check(
    macros: &mut Macros,
    outside: &IndexMap<String, Item>,
    patch: &Patch,
    findings: &mut Findings,
) {
    let drives = &patch.drives;
    for (name, of) in &mut macros.defined {
        names(name, of, patch, findings);
        defaults(of, findings);
        formulas(of, patch, findings);
    }
    for (name, of) in &macros.defined {
        let inside = Section { items: &of.items, of: Some((name, of)), lost: &of.lost, macros, drives };
        let checker = Cords { name, of, inside, outside, patch };
        checker.all(findings);
        checker.outputs(findings);
    }
}

/// Names of a macro and in it: what could not be named, and what has two meanings.
fn names(name: &str, of: &mut Macro, patch: &Patch, findings: &mut Findings) {
    findings.extend(outlet_name(name, of.span, "macro"));
    if REGISTRY.iter().any(|kind| kind.name == name) {
        findings.push(same_name(name, of.span, "macro", "kind of element").hint(ANOTHER));
    }
    let is_drive = |name: &str| patch.drives.contains_key(name);
    for (name, item) in &of.items {
        findings.extend(outlet_name(name, item.span(), "element"));
        clash("element", name, item.span(), &[("drive", &is_drive)], findings);
    }
    let is_item = |name: &str| of.items.contains_key(name);
    let taken: Taken<'_> = &[("drive", &is_drive), ("element", &is_item), ("key of every instance", &is_key)];
    for (name, port) in &of.inputs {
        findings.extend(port_name(name, port.span));
        clash("input", name, port.span, taken, findings);
    }
    settings(of, patch, findings);
    let is_input = |name: &str| of.inputs.contains_key(name);
    for (name, port) in &mut of.outputs {
        findings.extend(port_name(name, port.span));
        if clash("output", name, port.span, &[("element", &is_item), ("input", &is_input)], findings) {
            port.at = None;
        }
    }
}

/// Names of a macro's settings: formulas inside may also name parameters and scales, instances also inputs.
fn settings(of: &Macro, patch: &Patch, findings: &mut Findings) {
    let is_parameter = |name: &str| patch.parameters.contains_key(name);
    let is_scale = |name: &str| patch.scales.contains_key(name);
    let is_input = |name: &str| of.inputs.contains_key(name);
    let taken: Taken<'_> = &[
        ("parameter", &is_parameter),
        ("scale", &is_scale),
        ("input", &is_input),
        ("key of every instance", &is_key),
    ];
    for (name, setting) in &of.settings {
        findings.extend(quantity_name(name, setting.span, "setting"));
        clash("setting", name, setting.span, taken, findings);
    }
}

/// What to do about a name that is not the patch's to change.
const ANOTHER: &str = "choose another name";

fn is_key(name: &str) -> bool {
    KEYS.contains(&name)
}

/// Nouns for what has names already, and whether a name is one of them.
type Taken<'a> = &'a [(&'a str, &'a dyn Fn(&str) -> bool)];

/// Reports a name that something else has; whether there was one.
fn clash(noun: &str, name: &str, span: Span, taken: Taken<'_>, findings: &mut Findings) -> bool {
    let other = taken.iter().find(|(_, has)| has(name));
    let told = |first: &str| match is_key(name) {
        true => same_name(name, span, noun, first).hint(ANOTHER),
        false => same_name(name, span, noun, first),
    };
    findings.extend(other.map(|(first, _)| told(first)));
    other.is_some()
}

/// A port is read as "L1.port": a dot in it would be one too many.
fn port_name(name: &str, span: Span) -> Option<Diagnostic> {
    let dotted = || {
        let message = format!("\"{name}\" cannot name a port");
        let hint = "the port of an instance is read as \"instance.port\": leave the dot out";
        name.contains('.').then(|| Diagnostic::at(Code::BadName, span, message).hint(hint))
    };
    outlet_name(name, span, "port").or_else(dotted)
}

/// Takes out defaults that name other settings of the macro: their values come with the instances.
fn defaults(of: &mut Macro, findings: &mut Findings) {
    let own: HashSet<String> = of.settings.keys().cloned().collect();
    for (name, setting) in &mut of.settings {
        let Some(default) = &setting.default else { continue };
        if let Some(named) = default.value.names().into_iter().find(|named| own.contains(*named)) {
            let message = format!("the default of {name} names {named}, a setting of the same macro");
            let hint = "a default may name parameters and scales";
            findings.push(Diagnostic::at(Code::UnknownName, default.span, message).hint(hint));
            (setting.unit, setting.default) = (None, None);
        }
    }
}

/// Takes out formulas that name what is not there or whose units do not agree.
fn formulas(of: &mut Macro, patch: &Patch, findings: &mut Findings) {
    let names = Names { patch, own: &of.settings };
    let is_wrong = |placed: &Placed<Formula>, findings: &mut Findings| {
        let error = (!names.may_name_lost(&placed.value)).then(|| placed.value.dimension(&names).err());
        let finding = error.flatten().map(|error| misfit(&names, placed, error));
        let wrong = finding.is_some();
        findings.extend(finding);
        wrong
    };
    for item in of.items.values_mut() {
        match item {
            Item::Element(entry) => entry.settings.iter_mut().for_each(|setting| {
                if formula_of(setting).is_some_and(|formula| is_wrong(&formula, findings)) {
                    *setting = None;
                }
            }),
            Item::Use(made) => made.settings.values_mut().for_each(|setting| {
                if setting.as_ref().is_some_and(|formula| is_wrong(formula, findings)) {
                    *setting = None;
                }
            }),
        }
    }
}

fn formula_of(setting: &Option<Placed<Amount>>) -> Option<Placed<Formula>> {
    match setting.as_ref()? {
        Placed { value: Amount::Formula(formula), span } => {
            Some(Placed { value: formula.clone(), span: *span })
        }
        _ => None,
    }
}

/// What formulas inside a macro may name. Nothing has a value there: that comes with the instances.
struct Names<'a> {
    patch: &'a Patch,
    own: &'a IndexMap<String, MacroSetting>,
}

impl Names<'_> {
    fn may_name_lost(&self, formula: &Formula) -> bool {
        formula.names().iter().any(|name| match self.own.get(*name) {
            Some(setting) => setting.unit.is_none(),
            None => self.dimension(name).is_none() && self.patch.lost().may_hold(name),
        })
    }
}

impl Scope for Names<'_> {
    fn value(&self, _: &str) -> Option<f64> {
        None
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        let (own, patch) = (self.own.get(name), self.patch);
        let unit = own.and_then(|setting| setting.unit.as_ref());
        let unit = unit.or_else(|| patch.parameters.get(name).map(|parameter| &parameter.unit));
        let unit = unit.or_else(|| patch.scales.get(name).map(|scale| &scale.unit));
        let time_scale = (name == TIME_SCALE).then_some(Dimension::NONE);
        unit.map(|unit| unit.dimension()).or(time_scale)
    }

    fn names(&self) -> Vec<&str> {
        let named = self.own.keys().chain(self.patch.parameters.keys()).chain(self.patch.scales.keys());
        named.map(String::as_str).chain([TIME_SCALE]).collect()
    }
}

/// The cords of one macro.
struct Cords<'m> {
    name: &'m str,
    of: &'m Macro,
    inside: Section<'m>,
    outside: &'m IndexMap<String, Item>,
    patch: &'m Patch,
}

impl Cords<'_> {
    fn all(&self, findings: &mut Findings) {
        for (reader, item) in &self.of.items {
            for cord in item.cords() {
                self.cord(reader, cord, findings);
            }
        }
    }

    fn cord(&self, reader: &str, cord: &Placed<String>, findings: &mut Findings) {
        match self.inside.meaning(&cord.value) {
            Meaning::Inside(inside) => findings.push(inside.told(cord)),
            Meaning::Unknown if !self.patch.lost().may_hold(&cord.value) => {
                let holder = format!("the macro {}", self.name);
                let finding = self.inside.told_missing(reader, cord, &holder, findings.len());
                findings.push(match self.stands_outside(&cord.value) {
                    true => {
                        finding.hint(format!("{} stands outside: make it an input of the macro", cord.value))
                    }
                    false => finding,
                });
            }
            _ => {}
        }
    }

    fn stands_outside(&self, name: &str) -> bool {
        let outside =
            Section { items: self.outside, of: None, lost: &self.patch.lost().names, ..self.inside };
        !matches!(outside.meaning(name), Meaning::Unknown)
    }

    /// Every output port is an element inside, or an output of an instance inside.
    fn outputs(&self, findings: &mut Findings) {
        for (port, output) in &self.of.outputs {
            let Some(at) = &output.at else { continue };
            match self.inside.meaning(&at.value) {
                Meaning::Outlet(_) | Meaning::Lost => {}
                Meaning::Inside(inside) => findings.push(inside.told(at)),
                _ => {
                    let known: Vec<_> = self.of.parts().collect();
                    let message = format!("the output {port} is {}, which is no element inside", at.value);
                    let finding = Diagnostic::at(Code::UnknownName, at.span, message);
                    findings.push(finding.maybe_hint(suggestion(&at.value, &known)));
                }
            }
        }
    }
}

/// Warns of macros that nothing uses, and of inputs and settings that nothing inside them reads.
pub(super) fn unused(macros: &Macros, outside: &IndexMap<String, Item>, findings: &mut Findings) {
    let outside = outside.values().filter_map(Item::made);
    let used: HashSet<&str> = (macros.defined.values().flat_map(Macro::uses).chain(outside))
        .map(|made| made.of.value.as_str())
        .collect();
    for (name, of) in &macros.defined {
        if !used.contains(name.as_str()) {
            let message = format!("no element is an instance of the macro {name}");
            findings.push(Diagnostic::at(Code::UnusedMacro, of.span, message));
        }
        unread(name, of, findings);
    }
}

fn unread(name: &str, of: &Macro, findings: &mut Findings) {
    let cords: HashSet<&str> =
        of.items.values().flat_map(Item::cords).map(|cord| cord.value.as_str()).collect();
    let named: HashSet<String> = of.items.values().flat_map(Item::named).collect();
    let inputs = of.inputs.iter().filter(|(port, _)| !cords.contains(port.as_str()));
    let inputs = inputs.map(|(port, placed)| ("input", port, placed.span));
    let settings = of.settings.iter().filter(|(setting, _)| !named.contains(*setting));
    let settings = settings.map(|(setting, row)| ("setting", setting, row.span));
    for (noun, port, span) in inputs.chain(settings) {
        let message = format!("nothing in the macro {name} reads its {noun} {port}");
        findings.push(Diagnostic::at(Code::UnusedPort, span, message));
    }
}

impl Item {
    pub(super) fn span(&self) -> Span {
        match self {
            Item::Element(entry) => entry.span,
            Item::Use(made) => made.span,
        }
    }

    pub(super) fn made(&self) -> Option<&super::Use> {
        match self {
            Item::Element(_) => None,
            Item::Use(made) => Some(made),
        }
    }

    /// The cords into it.
    fn cords(&self) -> Vec<&Placed<String>> {
        match self {
            Item::Element(entry) => entry.plugs.iter().map(|plug| &plug.from).collect(),
            Item::Use(made) => made.cords.values().flat_map(|cords| &cords.value).collect(),
        }
    }

    /// The names in its formulas.
    fn named(&self) -> Vec<String> {
        let owned = |formula: &Formula| formula.names().into_iter().map(str::to_owned).collect::<Vec<_>>();
        match self {
            Item::Element(Entry { settings, .. }) => {
                settings.iter().filter_map(formula_of).flat_map(|formula| owned(&formula.value)).collect()
            }
            Item::Use(made) => {
                made.settings.values().flatten().flat_map(|formula| owned(&formula.value)).collect()
            }
        }
    }
}
