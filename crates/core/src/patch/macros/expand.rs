//! Expands macros: replaces every instance by its elements, with names such as "L1.A1".
//!
//! The expansion walks through the section of the patch and, for each instance, through the section of its macro. Cords
//! from ports become cords from the elements, drives or references behind the ports. Names of settings in formulas
//! become names of the instance's settings ("L1.T"). Nested instances can multiply elements without limit, so the
//! expansion counts the bytes that it produces and stops at the size of the largest document. `size` estimates them
//! first.

use std::collections::HashMap;

use indexmap::IndexMap;

use super::check::{check_macros, warn_unused};
use super::resolve::{CordOrigin, SectionScope};
use super::size::{ENTRY_OVERHEAD_BYTES, first_instance_above};
use super::{DrivenJack, Instance, InstanceOutput, Macros, SectionEntry};
use crate::document::fields::Findings;
use crate::document::file::MAX_DOCUMENT_BYTES;
use crate::document::{Code, Diagnostic, Phase, Placed, Span, any_error};
use crate::patch::document::{Amount, ElementEntry, Patch, Plug};
use crate::patch::names::duplicate_name;
use crate::patch::table_file::TableFile;
use patchcord_expr::Formula;

/// Puts the elements of a section into the patch, with macros expanded.
///
/// Fills the elements, instances, outputs of instances and macros of the patch. The parameters, scales, drives and
/// signals of the patch must have been decoded. Unused macros and ports are reported only if there is no error.
pub(in crate::patch) fn expand_macros(
    mut macros: Macros,
    element_section: &IndexMap<String, SectionEntry>,
    patch: &mut Patch,
    findings: &mut Findings,
) {
    macros.mark_unusable(findings);
    check_macros(&mut macros, element_section, patch, findings);
    let Expansion { elements, instances, instance_outputs, unread, is_full, .. } =
        Expansion::of_patch(&macros, element_section, patch, findings);
    if !any_error(findings) {
        warn_unused(&macros, element_section, findings);
    }
    (patch.elements, patch.instances, patch.instance_outputs) = (elements, instances, instance_outputs);
    patch.unread.names.extend(unread);
    patch.unread.has_unread_section |= is_full;
    (patch.macros, patch.macros_span) = (macros.defined, macros.span);
    replace_ports(patch);
}

/// Replaces the names of ports in signals, records, pictures and phases by the names of the elements behind them.
fn replace_ports(patch: &mut Patch) {
    let Patch { signals, record, pictures, run, instance_outputs, .. } = patch;
    let replace_port = |name: &mut Placed<String>| {
        if let Some(output) = instance_outputs.get(&name.value) {
            name.value.clone_from(&output.element);
        }
    };
    let is_no_signal = |name: &&mut Placed<String>| !signals.contains_key(&name.value);
    record.iter_mut().filter(is_no_signal).for_each(replace_port);
    for picture in pictures {
        picture.y.iter_mut().chain([&mut picture.x]).filter(is_no_signal).for_each(replace_port);
    }
    signals.values_mut().map(|signal| &mut signal.element).for_each(replace_port);
    run.phases.iter_mut().flat_map(relay_names).for_each(replace_port);
}

/// The names of the relays that end a phase or the phases inside it.
fn relay_names(phase: &mut Phase) -> Vec<&mut Placed<String>> {
    match phase {
        Phase::Operate { until: Some(until), .. } => vec![&mut until.relay],
        Phase::Repeat { phases, .. } => phases.iter_mut().flat_map(relay_names).collect(),
        _ => Vec::new(),
    }
}

/// A section during expansion: that of the patch, or that of an instance.
pub(super) struct ExpandedSection<'m> {
    /// The prefix of the names of its elements: "L1." for an instance, empty for the patch.
    pub prefix: String,
    /// The section as written.
    pub scope: SectionScope<'m>,
    /// The element, drive or reference that drives each input port. `None` if the cord has a fault.
    pub drivers: HashMap<&'m str, Option<String>>,
    /// Position of the outermost instance in the document. `None` for the section of the patch.
    pub span: Option<Span>,
}

impl<'m> ExpandedSection<'m> {
    /// The name of the instance; empty for the section of the patch.
    pub(super) fn name(&self) -> &str {
        self.prefix.strip_suffix('.').unwrap_or_default()
    }

    /// The element, drive or reference from which a cord comes, by its name in the whole patch. `None` if there is a
    /// fault.
    pub(super) fn driver(&self, cord: &str) -> Option<String> {
        match self.scope.resolve(cord) {
            CordOrigin::Element(element) => Some(format!("{}{element}", self.prefix)),
            CordOrigin::DriveOrReference => Some(cord.to_owned()),
            CordOrigin::MacroInput => self.drivers.get(cord).cloned().flatten(),
            _ => None,
        }
    }

    /// The input port of the instance from which a cord comes. `None` if it comes from another source.
    pub(super) fn input_port(&self, cord: &str) -> Option<&'m str> {
        self.drivers.get_key_value(cord).map(|(port, _)| *port)
    }

    /// A formula in the names of the whole patch: names of settings get the prefix of the instance.
    pub(super) fn formula(&self, formula: &Formula) -> Formula {
        match self.scope.owner {
            Some((_, owner)) => formula
                .renamed(&|name| owner.settings.contains_key(name).then(|| format!("{}{name}", self.prefix))),
            None => formula.clone(),
        }
    }

    /// A formula in the names of the whole patch, with its position in the document.
    pub(super) fn placed_formula(&self, formula: &Placed<Formula>) -> Placed<Formula> {
        Placed { value: self.formula(&formula.value), span: formula.span }
    }
}

/// The jacks that each input port of a section drives, by port.
pub(super) type JacksByPort = HashMap<String, Vec<DrivenJack>>;

/// The result of the expansion so far.
pub(super) struct Expansion<'p> {
    /// The elements by their names in the whole patch.
    pub elements: IndexMap<String, ElementEntry>,
    /// The instances by name, each before those inside it.
    pub instances: IndexMap<String, Instance>,
    /// The outputs of instances by the names that cords use.
    pub instance_outputs: IndexMap<String, InstanceOutput>,
    /// Names that could not be expanded.
    pub unread: Vec<String>,
    /// The patch, for its drives and unread names.
    pub patch: &'p Patch,
    /// Number of bytes that instances may still produce. In total they may produce as many as a document may have.
    remaining_bytes: usize,
    /// Whether the limit has been exceeded. Nothing more is then expanded.
    is_full: bool,
}

/// Estimated size of a point of a table, in bytes: twice its two numbers of 8 bytes.
const POINT_BYTES: usize = 32;

impl<'p> Expansion<'p> {
    /// Expands the section of a patch.
    fn of_patch(
        macros: &Macros,
        entries: &IndexMap<String, SectionEntry>,
        patch: &'p Patch,
        findings: &mut Findings,
    ) -> Self {
        let (unread, drives) = (&patch.unread.names, &patch.drives);
        let scope = SectionScope { entries, owner: None, unread, macros, drives };
        let section = ExpandedSection { prefix: String::new(), scope, drivers: HashMap::new(), span: None };
        let mut expansion = Expansion {
            elements: IndexMap::new(),
            instances: IndexMap::new(),
            instance_outputs: IndexMap::new(),
            unread: Vec::new(),
            patch,
            remaining_bytes: MAX_DOCUMENT_BYTES,
            is_full: false,
        };
        if let Some(span) = first_instance_above(MAX_DOCUMENT_BYTES, macros, entries) {
            expansion.report_too_large(span, findings);
        }
        expansion.add_section(&section, findings);
        expansion
    }

    /// Adds the elements of a section. Returns their names, and the jacks that the input ports of the section drive.
    pub(super) fn add_section(
        &mut self,
        section: &ExpandedSection<'_>,
        findings: &mut Findings,
    ) -> (Vec<String>, JacksByPort) {
        let (mut members, mut jacks) = (Vec::new(), JacksByPort::new());
        for (name, entry) in section.scope.entries {
            let full_name = format!("{}{name}", section.prefix);
            if self.is_full || self.report_duplicate(&full_name, entry, findings) {
                continue;
            }
            match entry {
                SectionEntry::Element(entry) => {
                    self.add_element(section, &full_name, entry, &mut jacks, findings);
                    members.push(full_name);
                }
                SectionEntry::Instance(entry) => {
                    members.extend(self.add_instance(section, &full_name, entry, &mut jacks, findings));
                }
            }
        }
        if !section.prefix.is_empty() {
            for name in section.scope.unread {
                self.add_unread(format!("{}{name}", section.prefix), section, findings);
            }
        }
        (members, jacks)
    }

    /// Reports an entry whose full name exists already, for example an element "L1.A1" of the patch. Returns whether it
    /// exists.
    fn report_duplicate(&self, full_name: &str, entry: &SectionEntry, findings: &mut Findings) -> bool {
        let is_duplicate =
            self.elements.contains_key(full_name) || self.instance_outputs.contains_key(full_name);
        findings.extend(is_duplicate.then(|| duplicate_name(full_name, entry.span(), "element", "element")));
        is_duplicate
    }

    /// Adds an element, with its cords and formulas in the names of the whole patch.
    fn add_element(
        &mut self,
        section: &ExpandedSection<'_>,
        full_name: &str,
        entry: &ElementEntry,
        jacks: &mut JacksByPort,
        findings: &mut Findings,
    ) {
        let mut expanded = ElementEntry { plugs: Vec::new(), ..entry.clone() };
        for Plug { jack, from } in &entry.plugs {
            let Some(driver) = self.plug_driver(section, from, findings) else {
                expanded.is_incomplete = true;
                continue;
            };
            if let Some(port) = section.input_port(&from.value) {
                let driven_jack = DrivenJack { element: full_name.to_owned(), jack: jack.value.clone() };
                jacks.entry(port.to_owned()).or_default().push(driven_jack);
            }
            let from = Placed { value: driver, span: from.span };
            expanded.plugs.push(Plug { jack: jack.clone(), from });
        }
        for setting in expanded.settings.iter_mut().flatten() {
            if let Amount::Formula(formula) = &mut setting.value {
                *formula = section.formula(formula);
            }
        }
        self.spend_bytes(full_name.len() + byte_count(&expanded), section, findings);
        self.elements.insert(full_name.to_owned(), expanded);
    }

    /// The element, drive or reference that drives a jack. `None` if the cord has a fault.
    ///
    /// In the section of the patch, an unknown name is returned unchanged. It is reported later, when the circuit
    /// resolves all cords. Faults inside macros have been reported by the check of the macros.
    fn plug_driver(
        &self,
        section: &ExpandedSection<'_>,
        cord: &Placed<String>,
        findings: &mut Findings,
    ) -> Option<String> {
        match section.scope.resolve(&cord.value) {
            CordOrigin::NotAnOutput(missing) if section.span.is_none() => {
                findings.push(missing.diagnostic(cord));
                None
            }
            CordOrigin::Unknown | CordOrigin::Unread if section.span.is_none() => Some(cord.value.clone()),
            _ => section.driver(&cord.value),
        }
    }

    /// Adds a name that cannot be expanded.
    pub(super) fn add_unread(
        &mut self,
        name: String,
        section: &ExpandedSection<'_>,
        findings: &mut Findings,
    ) {
        self.spend_bytes(name.len(), section, findings);
        self.unread.push(name);
    }

    /// Subtracts the bytes of an entry and its overhead from the remaining bytes. Reports an exceeded limit once.
    ///
    /// Entries in the section of the patch are free, because the size of the document limits them.
    pub(super) fn spend_bytes(
        &mut self,
        bytes: usize,
        section: &ExpandedSection<'_>,
        findings: &mut Findings,
    ) {
        let Some(span) = section.span.filter(|_| !self.is_full) else { return };
        match self.remaining_bytes.checked_sub(bytes + ENTRY_OVERHEAD_BYTES) {
            Some(remaining_bytes) => self.remaining_bytes = remaining_bytes,
            None => self.report_too_large(span, findings),
        }
    }

    /// Reports an expansion above the limit and ends it.
    fn report_too_large(&mut self, span: Span, findings: &mut Findings) {
        let message = format!(
            "the elements of all macro instances together are larger than {} MB",
            MAX_DOCUMENT_BYTES / 1_000_000
        );
        findings.push(Diagnostic::at(Code::MACRO_TOO_LARGE, span, message));
        self.is_full = true;
    }
}

/// Estimated size of an element in bytes: its note, cords, machine parts, formulas, points and file names.
fn byte_count(entry: &ElementEntry) -> usize {
    let plugs = entry.plugs.iter().map(|plug| plug.jack.value.len() + plug.from.value.len());
    let empty = entry.empty_jacks.iter().map(|jack| jack.value.len() + ENTRY_OVERHEAD_BYTES);
    let part_names = entry.machine_parts.iter().flat_map(|(_, names)| names);
    let parts = part_names.map(|name| name.value.len() + ENTRY_OVERHEAD_BYTES);
    let settings = entry.settings.iter().flatten().map(|setting| match &setting.value {
        Amount::Formula(formula) => formula.text().len(),
        Amount::Points(points) => POINT_BYTES * points.len(),
        _ => 0,
    });
    let files = entry.table_files.iter().map(TableFile::size);
    entry.note.len() + plugs.chain(empty).chain(parts).chain(settings).chain(files).sum::<usize>()
}
