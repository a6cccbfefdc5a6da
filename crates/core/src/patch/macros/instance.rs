//! Expands one instance of a macro: its ports, its settings and its elements.
//!
//! The drivers of the input ports are found first, because the elements inside need them. Then the output ports and the
//! settings get their names in the whole patch. Last, the elements of the macro are added.
//!
//! An instance "L1" of a macro with the element "A", the output "out" and the setting "T" gives an element "L1.A", the
//! outputs "L1.out" and "L1", and a quantity "L1.T".

use std::collections::HashMap;

use indexmap::IndexMap;

use super::decode::INSTANCE_KEYS;
use super::expand::{ExpandedSection, Expansion, JacksByPort};
use super::resolve::CordOrigin;
use super::size::ENTRY_OVERHEAD_BYTES;
use super::{Instance, InstanceEntry, InstanceInput, InstanceOutput, InstanceSetting, Macro, MacroSetting};
use crate::document::fields::Findings;
use crate::document::{Code, Diagnostic, Placed, Span};
use crate::patch::cord_faults::{cord_hint, no_cord, outputs_tied};
use crate::patch::names::{check_output_name, duplicate_name};

/// An instance during expansion.
struct InstanceContext<'f, 'm> {
    /// Its name in the whole patch.
    name: &'f str,
    /// The instance in the document.
    entry: &'f InstanceEntry,
    /// The definition of its macro.
    definition: &'m Macro,
    /// The section that contains the instance.
    parent: &'f ExpandedSection<'m>,
}

impl Expansion<'_> {
    /// Adds an instance and its elements. Returns the names of the elements.
    ///
    /// `outer_jacks` are the jacks that the input ports of the parent drive. The jacks behind the ports of this
    /// instance are added to them.
    pub(super) fn add_instance(
        &mut self,
        parent: &ExpandedSection<'_>,
        name: &str,
        entry: &InstanceEntry,
        outer_jacks: &mut JacksByPort,
        findings: &mut Findings,
    ) -> Vec<String> {
        if parent.span.is_none() {
            findings.extend(check_output_name(name, entry.span, "element"));
        }
        let Some((macro_name, definition)) = parent.scope.macros.usable(&entry.macro_name.value) else {
            self.add_unread(name.to_owned(), parent, findings);
            return Vec::new();
        };
        let context = InstanceContext { name, entry, definition, parent };
        let section = ExpandedSection {
            prefix: format!("{name}."),
            scope: parent.scope.macro_scope(macro_name, definition),
            drivers: self.input_drivers(&context, findings),
            span: parent.span.or(Some(entry.span)),
        };
        // An instance precedes the instances inside it, but the jacks behind its inputs are known only after them.
        let instance = self.instance_without_elements(&context, &section, findings);
        self.instances.insert(name.to_owned(), instance);
        let (members, inner_jacks) = self.add_section(&section, findings);
        context.add_to_outer_jacks(&inner_jacks, outer_jacks);
        let instance = &mut self.instances[name];
        instance.members.clone_from(&members);
        instance.inputs = context.inputs(&section, inner_jacks);
        members
    }

    /// An instance with its outputs and settings, but without inputs and elements.
    fn instance_without_elements(
        &mut self,
        context: &InstanceContext<'_, '_>,
        section: &ExpandedSection<'_>,
        findings: &mut Findings,
    ) -> Instance {
        let InstanceContext { entry, definition, parent, .. } = context;
        let instance = Instance {
            macro_name: entry.macro_name.value.clone(),
            parent: parent.span.map(|_| parent.name().to_owned()),
            note: entry.note.clone(),
            inputs: IndexMap::new(),
            outputs: self.outputs(section, definition, findings),
            settings: self.settings(context, section, findings),
            members: Vec::new(),
            span: entry.span,
        };
        self.spend_bytes(section.prefix.len() + byte_count(&instance, section), section, findings);
        instance
    }

    /// The element, drive or reference that drives each input port. Reports ports without a cord or with several cords.
    fn input_drivers<'m>(
        &self,
        context: &InstanceContext<'_, 'm>,
        findings: &mut Findings,
    ) -> HashMap<&'m str, Option<String>> {
        let InstanceContext { name, entry, definition, .. } = context;
        let mut drivers = HashMap::new();
        for (port, description) in &definition.inputs {
            let cords = entry.cords.get(port);
            let driver = match cords.map_or(&[][..], |cords| &cords.value) {
                [] if !entry.is_open(port) => None,
                [] => {
                    let span = cords.map_or(entry.span, |cords| cords.span);
                    let hint = cord_hint(&format!("\"{port}\": \"NAME\""), &description.value);
                    findings.push(no_cord(name, &format!("\"{port}\""), hint, span));
                    None
                }
                [cord] => self.input_driver(context, cord, findings),
                [first, second, ..] => {
                    findings.push(outputs_tied(name, port, first, second));
                    None
                }
            };
            drivers.insert(port.as_str(), driver);
        }
        drivers
    }

    /// The element, drive or reference from which a cord into an input port comes.
    ///
    /// Faults are reported only in the section of the patch. Cords inside macros have been checked with the macros.
    fn input_driver(
        &self,
        context: &InstanceContext<'_, '_>,
        cord: &Placed<String>,
        findings: &mut Findings,
    ) -> Option<String> {
        let InstanceContext { name, parent, .. } = context;
        if parent.span.is_none() {
            match parent.scope.resolve(&cord.value) {
                CordOrigin::NotAnOutput(missing) => findings.push(missing.diagnostic(cord)),
                CordOrigin::Unknown if !self.patch.unread.can_include(&cord.value) => {
                    findings.push(parent.scope.unknown_source(name, cord, "the patch", findings.len()));
                }
                _ => {}
            }
        }
        parent.driver(&cord.value)
    }

    /// The elements behind the output ports. They also become outputs of the patch, under the names that cords, signals
    /// and records use: "L1.out" for each port, and "L1" for the first.
    ///
    /// An output whose element has a fault becomes an unread name, so that cords from it are not reported as well.
    fn outputs(
        &mut self,
        section: &ExpandedSection<'_>,
        definition: &Macro,
        findings: &mut Findings,
    ) -> IndexMap<String, String> {
        let mut outputs = IndexMap::new();
        for (index, (port, output)) in definition.outputs.iter().enumerate() {
            let names = [format!("{}{port}", section.prefix)]
                .into_iter()
                .chain((index == 0).then(|| section.name().to_owned()));
            let origin = output.element.as_ref().map(|element| section.scope.resolve(&element.value));
            let Some(CordOrigin::Element(element)) = origin else {
                names.for_each(|name| self.add_unread(name, section, findings));
                continue;
            };
            let element = format!("{}{element}", section.prefix);
            let span = section.span.unwrap_or(output.span);
            for name in names {
                let is_duplicate = self.elements.contains_key(&name);
                findings.extend(is_duplicate.then(|| duplicate_name(&name, span, "output", "element")));
                self.instance_outputs.insert(name, InstanceOutput { element: element.clone(), span });
            }
            outputs.insert(port.clone(), element);
        }
        outputs
    }

    /// The settings of an instance: the values in the document, or else the defaults of the macro.
    ///
    /// Reports a missing setting without a default. A setting without a value becomes an unread name.
    ///
    /// A value in the document can name settings of the parent, so it is renamed to the names of the whole patch. A
    /// default names only parameters and scales, so it stays as it is.
    fn settings(
        &mut self,
        context: &InstanceContext<'_, '_>,
        section: &ExpandedSection<'_>,
        findings: &mut Findings,
    ) -> IndexMap<String, InstanceSetting> {
        let InstanceContext { entry, definition, parent, .. } = context;
        let mut settings = IndexMap::new();
        for (name, declared) in &definition.settings {
            let written = entry.settings.get(name);
            let value = match written {
                Some(written) => written.as_ref().map(|formula| parent.placed_formula(formula)),
                None => declared.default.clone(),
            };
            if let (Some(value), Some(unit)) = (value, declared.unit.clone()) {
                settings.insert(name.clone(), InstanceSetting { value, unit });
                continue;
            }
            // Values that could not be read have been reported.
            if declared.unit.is_some() && written.is_none() && !entry.is_incomplete {
                findings.push(missing_setting(section, name, declared, entry.span));
            }
            self.add_unread(format!("{}{name}", section.prefix), section, findings);
        }
        settings
    }
}

impl InstanceEntry {
    /// Whether an input port has no cord. A port of an incomplete instance does not count: the cord may be the part that
    /// could not be read. Nor does a port whose name is a key of every instance, because no cord can go there.
    fn is_open(&self, port: &str) -> bool {
        let has_cord = self.cords.get(port).is_some_and(|cords| !cords.value.is_empty());
        !has_cord && !self.is_incomplete && !INSTANCE_KEYS.contains(&port)
    }

    /// The input ports of the macro that have no cord, in the order of the definition.
    pub(in crate::patch) fn open_ports<'m>(&self, definition: &'m Macro) -> impl Iterator<Item = &'m str> {
        definition.inputs.keys().map(String::as_str).filter(|port| self.is_open(port))
    }

    /// Name of the macro.
    pub(in crate::patch) fn macro_name(&self) -> &str {
        &self.macro_name.value
    }
}

impl InstanceContext<'_, '_> {
    /// Adds the jacks behind the ports of the instance to the jacks of the parent's ports that drive them.
    ///
    /// A port inside a macro can be driven by a port of the macro. The jacks behind the inner port are then also behind
    /// the outer one.
    fn add_to_outer_jacks(&self, inner_jacks: &JacksByPort, outer_jacks: &mut JacksByPort) {
        for port in self.entry.cords.keys() {
            if let (Some(outer_port), Some(jacks)) = (self.outer_port(port), inner_jacks.get(port)) {
                outer_jacks.entry(outer_port.to_owned()).or_default().extend(jacks.iter().cloned());
            }
        }
    }

    /// The input port of the parent that is plugged into a port of the instance, if there is one.
    fn outer_port(&self, port: &str) -> Option<&str> {
        self.entry.cords.get(port)?.value.first().and_then(|cord| self.parent.input_port(&cord.value))
    }

    /// The input ports of the instance with their drivers and jacks.
    fn inputs(
        &self,
        section: &ExpandedSection<'_>,
        mut inner_jacks: JacksByPort,
    ) -> IndexMap<String, InstanceInput> {
        let input = |port: &String| {
            let driver = section.drivers.get(port.as_str()).cloned().flatten();
            let outer_port = self.outer_port(port).map(str::to_owned);
            let driven_jacks = inner_jacks.remove(port).unwrap_or_default();
            (port.clone(), InstanceInput { driver, outer_port, driven_jacks })
        };
        self.definition.inputs.keys().map(input).collect()
    }
}

/// Estimated size of an instance in bytes: its drivers, outputs, settings and note.
fn byte_count(instance: &Instance, section: &ExpandedSection<'_>) -> usize {
    let drivers = section.drivers.values().flatten().map(String::len);
    let outputs = instance.outputs.values().map(String::len);
    let settings = instance.settings.values().map(|setting| setting.value.value.text().len());
    let entries = drivers.chain(outputs).chain(settings);
    entries.map(|bytes| bytes + ENTRY_OVERHEAD_BYTES).sum::<usize>() + instance.note.len()
}

/// The diagnostic for a setting that has neither a value in the instance nor a default.
fn missing_setting(
    section: &ExpandedSection<'_>,
    name: &str,
    declared: &MacroSetting,
    span: Span,
) -> Diagnostic {
    let message = format!("{} needs \"{name}\"", section.name());
    let hint = match declared.description.as_str() {
        "" => "specify it in the instance, or add a \"default\" in the macro",
        description => description,
    };
    Diagnostic::at(Code::MISSING_KEY, span, message).hint(hint)
}
