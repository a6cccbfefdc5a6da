//! Checks the definitions of macros before expansion.
//!
//! A fault in a macro is reported once, however many instances use it. The checks concern names, defaults, formulas and
//! cords. A part with a fault is removed from the macro, so that the expansion does not report it again. After an
//! expansion without errors, [`warn_unused`] reports macros, inputs and settings that nothing uses.

use std::collections::HashSet;

use indexmap::IndexMap;

use super::decode::INSTANCE_KEYS;
use super::resolve::{CordOrigin, SectionScope};
use super::{InstanceEntry, Macro, MacroSetting, Macros, SectionEntry};
use crate::document::fields::Findings;
use crate::document::{Code, Diagnostic, Placed, Span, TIME_SCALE, suggestion, unit_mismatch};
use crate::elements::REGISTRY;
use crate::patch::document::{Amount, ElementEntry, Patch};
use crate::patch::names::{check_output_name, check_quantity_name, duplicate_name};
use patchcord_expr::{Dimension, Formula, Scope};

/// Checks every macro, and removes parts that cannot be used.
///
/// `patch_section` is the section "elements" of the patch. An unknown name in a macro that exists there gets a hint.
pub(super) fn check_macros(
    macros: &mut Macros,
    patch_section: &IndexMap<String, SectionEntry>,
    patch: &Patch,
    findings: &mut Findings,
) {
    let drives = &patch.drives;
    for (name, definition) in &mut macros.defined {
        check_names(name, definition, patch, findings);
        check_defaults(definition, findings);
        check_formulas(definition, patch, findings);
    }
    for (name, definition) in &macros.defined {
        let scope = SectionScope {
            entries: &definition.entries,
            owner: Some((name, definition)),
            unread: &definition.unread,
            macros,
            drives,
        };
        let checker = CordChecker { name, definition, scope, patch_section, patch };
        checker.check_cords(findings);
        checker.check_outputs(findings);
    }
}

/// Checks the names of a macro, of its elements and of its ports and settings. Reports invalid names and names with two
/// meanings.
///
/// An output port with the name of an element or an input loses its element.
///
/// Rules for names: ports and elements share one set of names, because cords use both. Settings share the names of
/// parameters and scales, because formulas use them.
fn check_names(name: &str, definition: &mut Macro, patch: &Patch, findings: &mut Findings) {
    findings.extend(check_output_name(name, definition.span, "macro"));
    if REGISTRY.iter().any(|kind| kind.name == name) {
        findings.push(duplicate_name(name, definition.span, "macro", "kind of element").hint(CHOOSE_ANOTHER));
    }
    let is_drive = |name: &str| patch.drives.contains_key(name);
    for (name, entry) in &definition.entries {
        findings.extend(check_output_name(name, entry.span(), "element"));
        report_conflict("element", name, entry.span(), &[("drive", &is_drive)], findings);
    }
    let is_entry = |name: &str| definition.entries.contains_key(name);
    let used_names: UsedNames<'_> =
        &[("drive", &is_drive), ("element", &is_entry), ("key of every instance", &is_instance_key)];
    for (name, port) in &definition.inputs {
        findings.extend(check_port_name(name, port.span));
        report_conflict("input", name, port.span, used_names, findings);
    }
    check_setting_names(definition, patch, findings);
    let is_input = |name: &str| definition.inputs.contains_key(name);
    for (name, port) in &mut definition.outputs {
        findings.extend(check_port_name(name, port.span));
        let used_names: UsedNames<'_> = &[("element", &is_entry), ("input", &is_input)];
        if report_conflict("output", name, port.span, used_names, findings) {
            port.element = None;
        }
    }
}

/// Checks the names of a macro's settings. Formulas inside the macro can also name parameters and scales, and instances
/// have inputs under their names too. The names must therefore differ from all of these.
fn check_setting_names(definition: &Macro, patch: &Patch, findings: &mut Findings) {
    let is_parameter = |name: &str| patch.parameters.contains_key(name);
    let is_scale = |name: &str| patch.scales.contains_key(name);
    let is_input = |name: &str| definition.inputs.contains_key(name);
    let used_names: UsedNames<'_> = &[
        ("parameter", &is_parameter),
        ("scale", &is_scale),
        ("input", &is_input),
        ("key of every instance", &is_instance_key),
    ];
    for (name, setting) in &definition.settings {
        findings.extend(check_quantity_name(name, setting.span, "setting"));
        report_conflict("setting", name, setting.span, used_names, findings);
    }
}

/// The hint for a name that conflicts with one that the patch cannot change.
const CHOOSE_ANOTHER: &str = "choose another name";

/// Whether a name is a key that every instance may have: "kind", "note" or "uses".
fn is_instance_key(name: &str) -> bool {
    INSTANCE_KEYS.contains(&name)
}

/// Groups of names that are in use: the noun of each group, and whether a name belongs to it.
type UsedNames<'a> = &'a [(&'a str, &'a dyn Fn(&str) -> bool)];

/// Reports a name that another object has. Returns whether there is such an object. `noun` is the kind of object at
/// `span`.
fn report_conflict(
    noun: &str,
    name: &str,
    span: Span,
    used_names: UsedNames<'_>,
    findings: &mut Findings,
) -> bool {
    let conflict = used_names.iter().find(|(_, contains)| contains(name));
    let diagnostic = |first_noun: &str| match is_instance_key(name) {
        true => duplicate_name(name, span, noun, first_noun).hint(CHOOSE_ANOTHER),
        false => duplicate_name(name, span, noun, first_noun),
    };
    findings.extend(conflict.map(|(first_noun, _)| diagnostic(first_noun)));
    conflict.is_some()
}

/// Checks the name of a port. It must not contain a dot, because cords name the port as "L1.port".
fn check_port_name(name: &str, span: Span) -> Option<Diagnostic> {
    let dot_fault = || {
        let message = format!("\"{name}\" cannot name a port");
        let hint = "cords name the port of an instance as \"instance.port\": remove the dot";
        name.contains('.').then(|| Diagnostic::at(Code::BAD_NAME, span, message).hint(hint))
    };
    check_output_name(name, span, "port").or_else(dot_fault)
}

/// Reports and removes defaults that contain settings of the same macro. Such a default would need an order of
/// evaluation, and could depend on itself.
fn check_defaults(definition: &mut Macro, findings: &mut Findings) {
    let setting_names: HashSet<String> = definition.settings.keys().cloned().collect();
    for (name, setting) in &mut definition.settings {
        let Some(default) = &setting.default else { continue };
        let names = default.value.names();
        if let Some(used) = names.into_iter().find(|used| setting_names.contains(*used)) {
            let message = format!("the default of {name} names {used}, a setting of the same macro");
            let hint = "a default may contain only parameters and scales";
            findings.push(Diagnostic::at(Code::UNKNOWN_NAME, default.span, message).hint(hint));
            (setting.unit, setting.default) = (None, None);
        }
    }
}

/// Reports and removes formulas with unknown names or with units that do not agree.
fn check_formulas(definition: &mut Macro, patch: &Patch, findings: &mut Findings) {
    let scope = MacroScope { patch, settings: &definition.settings };
    let has_fault = |formula: &Placed<Formula>, findings: &mut Findings| {
        let is_checkable = !scope.can_contain_unread(&formula.value);
        let error = is_checkable.then(|| formula.value.dimension(&scope).err());
        let finding = error.flatten().map(|error| unit_mismatch(&scope, formula, error, None));
        let has_fault = finding.is_some();
        findings.extend(finding);
        has_fault
    };
    for entry in definition.entries.values_mut() {
        match entry {
            SectionEntry::Element(element) => element.settings.iter_mut().for_each(|setting| {
                if formula_of(setting).is_some_and(|formula| has_fault(&formula, findings)) {
                    *setting = None;
                }
            }),
            SectionEntry::Instance(instance) => instance.settings.values_mut().for_each(|setting| {
                if setting.as_ref().is_some_and(|formula| has_fault(formula, findings)) {
                    *setting = None;
                }
            }),
        }
    }
}

/// The formula of a setting. `None` if the setting is absent or is not a formula.
fn formula_of(setting: &Option<Placed<Amount>>) -> Option<Placed<Formula>> {
    match setting.as_ref()? {
        Placed { value: Amount::Formula(formula), span } => {
            Some(Placed { value: formula.clone(), span: *span })
        }
        _ => None,
    }
}

/// The names that formulas inside a macro can use: settings of the macro, parameters, scales and the time scale.
///
/// The names have dimensions but no values, because settings have different values in each instance.
struct MacroScope<'a> {
    patch: &'a Patch,
    settings: &'a IndexMap<String, MacroSetting>,
}

impl MacroScope<'_> {
    /// Whether a formula contains a name whose entry could not be read. Its units cannot be checked then.
    fn can_contain_unread(&self, formula: &Formula) -> bool {
        formula.names().iter().any(|name| match self.settings.get(*name) {
            Some(setting) => setting.unit.is_none(),
            None => self.dimension(name).is_none() && self.patch.unread_names().can_include(name),
        })
    }
}

impl Scope for MacroScope<'_> {
    fn value(&self, _: &str) -> Option<f64> {
        None
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        let (setting, patch) = (self.settings.get(name), self.patch);
        let unit = setting.and_then(|setting| setting.unit.as_ref());
        let unit = unit.or_else(|| patch.parameters.get(name).map(|parameter| &parameter.unit));
        let unit = unit.or_else(|| patch.scales.get(name).map(|scale| &scale.unit));
        let time_scale = (name == TIME_SCALE).then_some(Dimension::NONE);
        unit.map(|unit| unit.dimension()).or(time_scale)
    }

    fn names(&self) -> Vec<&str> {
        let settings = self.settings.keys();
        let quantities = settings.chain(self.patch.parameters.keys()).chain(self.patch.scales.keys());
        quantities.map(String::as_str).chain([TIME_SCALE]).collect()
    }
}

/// Checks the cords and outputs of one macro.
struct CordChecker<'m> {
    /// Name of the macro.
    name: &'m str,
    definition: &'m Macro,
    /// The section of the macro.
    scope: SectionScope<'m>,
    /// The section of the patch, for hints.
    patch_section: &'m IndexMap<String, SectionEntry>,
    patch: &'m Patch,
}

impl CordChecker<'_> {
    /// Checks the cords of all elements and instances inside the macro.
    fn check_cords(&self, findings: &mut Findings) {
        for (reader, entry) in &self.definition.entries {
            for cord in entry.cords() {
                self.check_cord(reader, cord, findings);
            }
        }
    }

    /// Checks one cord into the element `reader`. Reports a name that is no output.
    fn check_cord(&self, reader: &str, cord: &Placed<String>, findings: &mut Findings) {
        match self.scope.resolve(&cord.value) {
            CordOrigin::NotAnOutput(missing) => findings.push(missing.diagnostic(cord)),
            CordOrigin::Unknown if !self.patch.unread_names().can_include(&cord.value) => {
                let searched = format!("the macro {}", self.name);
                let finding = self.scope.unknown_source(reader, cord, &searched, findings.len());
                findings.push(match self.is_in_patch_section(&cord.value) {
                    true => finding
                        .hint(format!("{} is outside the macro: make it an input of the macro", cord.value)),
                    false => finding,
                });
            }
            _ => {}
        }
    }

    /// Whether a name means an output in the section of the patch.
    fn is_in_patch_section(&self, name: &str) -> bool {
        let unread = &self.patch.unread_names().names;
        let patch_scope = SectionScope { entries: self.patch_section, owner: None, unread, ..self.scope };
        !matches!(patch_scope.resolve(name), CordOrigin::Unknown)
    }

    /// Checks that every output port is an element of the macro, or an output of an instance inside it.
    fn check_outputs(&self, findings: &mut Findings) {
        for (port, output) in &self.definition.outputs {
            let Some(element) = &output.element else { continue };
            match self.scope.resolve(&element.value) {
                CordOrigin::Element(_) | CordOrigin::Unread => {}
                CordOrigin::NotAnOutput(missing) => findings.push(missing.diagnostic(element)),
                _ => {
                    let candidates: Vec<_> = self.definition.element_names().collect();
                    let message = format!(
                        "the output {port} is {}, which is not an element of the macro",
                        element.value
                    );
                    let finding = Diagnostic::at(Code::UNKNOWN_NAME, element.span, message);
                    findings.push(finding.maybe_hint(suggestion(&element.value, &candidates)));
                }
            }
        }
    }
}

/// Warns of macros without instances, and of inputs and settings that nothing inside their macro reads.
pub(super) fn warn_unused(
    macros: &Macros,
    patch_section: &IndexMap<String, SectionEntry>,
    findings: &mut Findings,
) {
    let instances_in_patch = patch_section.values().filter_map(SectionEntry::as_instance);
    let instances_in_macros = macros.defined.values().flat_map(Macro::instances);
    let used_macros: HashSet<&str> = instances_in_macros
        .chain(instances_in_patch)
        .map(|instance| instance.macro_name.value.as_str())
        .collect();
    for (name, definition) in &macros.defined {
        if !used_macros.contains(name.as_str()) {
            let message = format!("no element is an instance of the macro {name}");
            findings.push(Diagnostic::at(Code::UNUSED_MACRO, definition.span, message));
        }
        warn_unread_ports(name, definition, findings);
    }
}

/// Warns of inputs and settings of a macro that no cord or formula inside it reads.
///
/// An input counts as read if any cord inside the macro names it. Outputs are not checked: a patch may leave them
/// open.
fn warn_unread_ports(name: &str, definition: &Macro, findings: &mut Findings) {
    let entries = || definition.entries.values();
    let cords: HashSet<&str> =
        entries().flat_map(SectionEntry::cords).map(|cord| cord.value.as_str()).collect();
    let formula_names: HashSet<String> = entries().flat_map(SectionEntry::formula_names).collect();
    let inputs = definition.inputs.iter().filter(|(port, _)| !cords.contains(port.as_str()));
    let inputs = inputs.map(|(port, placed)| ("input", port, placed.span));
    let settings = definition.settings.iter().filter(|(setting, _)| !formula_names.contains(*setting));
    let settings = settings.map(|(name, setting)| ("setting", name, setting.span));
    for (noun, unread, span) in inputs.chain(settings) {
        let message = format!("nothing in the macro {name} reads its {noun} {unread}");
        findings.push(Diagnostic::at(Code::UNUSED_PORT, span, message));
    }
}

impl SectionEntry {
    /// Position of the entry's name in the document.
    pub(super) fn span(&self) -> Span {
        match self {
            SectionEntry::Element(element) => element.span,
            SectionEntry::Instance(instance) => instance.span,
        }
    }

    /// The instance; `None` if the entry is an element.
    pub(super) fn as_instance(&self) -> Option<&InstanceEntry> {
        match self {
            SectionEntry::Element(_) => None,
            SectionEntry::Instance(instance) => Some(instance),
        }
    }

    /// The names that are plugged into the entry.
    fn cords(&self) -> Vec<&Placed<String>> {
        match self {
            SectionEntry::Element(element) => element.plugs.iter().map(|plug| &plug.from).collect(),
            SectionEntry::Instance(instance) => {
                instance.cords.values().flat_map(|cords| &cords.value).collect()
            }
        }
    }

    /// The names in the entry's formulas.
    fn formula_names(&self) -> Vec<String> {
        let names = |formula: &Formula| formula.names().into_iter().map(str::to_owned).collect::<Vec<_>>();
        match self {
            SectionEntry::Element(ElementEntry { settings, .. }) => {
                settings.iter().filter_map(formula_of).flat_map(|formula| names(&formula.value)).collect()
            }
            SectionEntry::Instance(instance) => {
                instance.settings.values().flatten().flat_map(|formula| names(&formula.value)).collect()
            }
        }
    }
}
