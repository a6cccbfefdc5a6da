//! Writing out one instance: its ports, its settings, its elements.

use std::collections::HashMap;

use indexmap::IndexMap;

use super::expand::{Feeds, Frame, OVERHEAD, Written};
use super::outline::Meaning;
use super::read::KEYS;
use super::{Inlet, Instance, InstanceSetting, Macro, MacroSetting, Port, Use};
use crate::document::fields::Findings;
use crate::document::{Code, Diagnostic, Placed, Span};
use crate::patch::names::{outlet_name, same_name};

/// An instance that is being written out.
struct Making<'f, 'm> {
    /// Its name in the whole patch.
    name: &'f str,
    made: &'f Use,
    of: &'m Macro,
    /// The section where it stands.
    around: &'f Frame<'m>,
}

impl Written<'_> {
    /// The names of an instance's elements, written out; `feeds` are those of the section where it stands.
    pub fn instance(
        &mut self,
        around: &Frame<'_>,
        name: &str,
        made: &Use,
        feeds: &mut Feeds,
        findings: &mut Findings,
    ) -> Vec<String> {
        if around.span.is_none() {
            findings.extend(outlet_name(name, made.span, "element"));
        }
        let Some((macro_name, of)) = around.section.macros.usable(&made.of.value) else {
            self.lose(name.to_owned(), around, findings);
            return Vec::new();
        };
        let making = Making { name, made, of, around };
        let inside = Frame {
            prefix: format!("{name}."),
            section: around.section.inside(macro_name, of),
            drivers: self.drivers(&making, findings),
            span: around.span.or(Some(made.span)),
        };
        // It stands before the instances inside it; what they feed is known only after them.
        let instance = self.empty_box(&making, &inside, findings);
        self.instances.insert(name.to_owned(), instance);
        let (members, inner) = self.section(&inside, findings);
        making.pass_on(&inner, feeds);
        let instance = &mut self.instances[name];
        instance.members.clone_from(&members);
        instance.inputs = making.inlets(&inside, inner);
        members
    }

    /// An instance without its elements.
    fn empty_box(
        &mut self,
        making: &Making<'_, '_>,
        inside: &Frame<'_>,
        findings: &mut Findings,
    ) -> Instance {
        let Making { made, of, around, .. } = making;
        let instance = Instance {
            of: made.of.value.clone(),
            around: around.span.map(|_| around.name().to_owned()),
            note: made.note.clone(),
            inputs: IndexMap::new(),
            outputs: self.outputs(inside, of, findings),
            settings: self.settings(making, inside, findings),
            members: Vec::new(),
            span: made.span,
        };
        self.spend(inside.prefix.len() + size(&instance, inside), inside, findings);
        instance
    }

    /// What drives the input ports.
    fn drivers<'m>(
        &self,
        making: &Making<'_, 'm>,
        findings: &mut Findings,
    ) -> HashMap<&'m str, Option<String>> {
        let Making { name, made, of, .. } = making;
        let mut drivers = HashMap::new();
        for (port, description) in &of.inputs {
            let cords = made.cords.get(port);
            let driver = match cords.map_or(&[][..], |cords| &cords.value) {
                [] if made.doubtful || KEYS.contains(&port.as_str()) => None,
                [] => {
                    let span = cords.map_or(made.span, |cords| cords.span);
                    findings.push(undriven(name, port, &description.value, span));
                    None
                }
                [only] => self.port_driver(making, only, findings),
                [first, second, ..] => {
                    findings.push(tied(name, port, first, second));
                    None
                }
            };
            drivers.insert(port.as_str(), driver);
        }
        drivers
    }

    /// What drives a port. Cords inside macros were looked at there.
    fn port_driver(
        &self,
        making: &Making<'_, '_>,
        cord: &Placed<String>,
        findings: &mut Findings,
    ) -> Option<String> {
        let Making { name, around, .. } = making;
        if around.span.is_none() {
            match around.section.meaning(&cord.value) {
                Meaning::Inside(inside) => findings.push(inside.told(cord)),
                Meaning::Unknown if !self.patch.lost.may_hold(&cord.value) => {
                    findings.push(around.section.told_missing(name, cord, "the patch", findings.len()));
                }
                _ => {}
            }
        }
        around.driver(&cord.value)
    }

    /// The elements that the output ports are; cords, signals and records find them by the ports' names.
    fn outputs(
        &mut self,
        inside: &Frame<'_>,
        of: &Macro,
        findings: &mut Findings,
    ) -> IndexMap<String, String> {
        let mut outputs = IndexMap::new();
        for (index, (port, output)) in of.outputs.iter().enumerate() {
            let names = [format!("{}{port}", inside.prefix)]
                .into_iter()
                .chain((index == 0).then(|| inside.name().to_owned()));
            let at = output.at.as_ref().map(|at| inside.section.meaning(&at.value));
            let Some(Meaning::Outlet(at)) = at else {
                names.for_each(|name| self.lose(name, inside, findings));
                continue;
            };
            let at = format!("{}{at}", inside.prefix);
            let span = inside.span.unwrap_or(output.span);
            for name in names {
                let taken = self.elements.contains_key(&name);
                findings.extend(taken.then(|| same_name(&name, span, "output", "element")));
                self.ports.insert(name, Port { at: at.clone(), span });
            }
            outputs.insert(port.clone(), at);
        }
        outputs
    }

    /// The settings of an instance, as they are written there or by default.
    fn settings(
        &mut self,
        making: &Making<'_, '_>,
        inside: &Frame<'_>,
        findings: &mut Findings,
    ) -> IndexMap<String, InstanceSetting> {
        let Making { made, of, around, .. } = making;
        let mut settings = IndexMap::new();
        for (name, row) in &of.settings {
            let written = made.settings.get(name);
            let value = match written {
                Some(written) => written.as_ref().map(|placed| around.placed(placed)),
                None => row.default.clone(),
            };
            if let (Some(value), Some(unit)) = (value, row.unit.clone()) {
                settings.insert(name.clone(), InstanceSetting { value, unit });
                continue;
            }
            // What could not be read has been reported.
            if row.unit.is_some() && written.is_none() && !made.doubtful {
                findings.push(unset(inside, name, row, made.span));
            }
            self.lose(format!("{}{name}", inside.prefix), inside, findings);
        }
        settings
    }
}

impl Making<'_, '_> {
    /// Where ports of the section drive ports of the instance, they feed what those feed.
    fn pass_on(&self, inner: &Feeds, feeds: &mut Feeds) {
        for port in self.made.cords.keys() {
            if let (Some(outer), Some(fed)) = (self.outer_port(port), inner.get(port)) {
                feeds.entry(outer.to_owned()).or_default().extend(fed.iter().cloned());
            }
        }
    }

    /// The port of the section that is plugged into a port of the instance.
    fn outer_port(&self, port: &str) -> Option<&str> {
        self.made.cords.get(port)?.value.first().and_then(|cord| self.around.port(&cord.value))
    }

    fn inlets(&self, inside: &Frame<'_>, mut feeds: Feeds) -> IndexMap<String, Inlet> {
        let inlet = |port: &String| {
            let driver = inside.drivers.get(port.as_str()).cloned().flatten();
            let outer = self.outer_port(port).map(str::to_owned);
            (port.clone(), Inlet { driver, port: outer, feeds: feeds.remove(port).unwrap_or_default() })
        };
        self.of.inputs.keys().map(inlet).collect()
    }
}

/// Bytes of an instance's drivers, outputs and settings.
fn size(instance: &Instance, inside: &Frame<'_>) -> usize {
    let drivers = inside.drivers.values().flatten().map(String::len);
    let outputs = instance.outputs.values().map(String::len);
    let settings = instance.settings.values().map(|setting| setting.value.value.text().len());
    drivers.chain(outputs).chain(settings).map(|bytes| bytes + OVERHEAD).sum::<usize>() + instance.note.len()
}

fn undriven(instance: &str, port: &str, description: &str, span: Span) -> Diagnostic {
    let message = format!("nothing drives \"{port}\" of {instance}");
    let hint = match description {
        "" => "use \"ground\" for 0 V".to_owned(),
        description => format!("{description}; use \"ground\" for 0 V"),
    };
    Diagnostic::at(Code::NoDriver, span, message).hint(hint)
}

fn tied(instance: &str, port: &str, first: &Placed<String>, second: &Placed<String>) -> Diagnostic {
    let message = format!(
        "the outputs of {} and {} are tied together at {port} of {instance}",
        first.value, second.value
    );
    Diagnostic::at(Code::OutputsTied, second.span, message)
        .hint("add them in a summer, and plug in its output")
}

fn unset(inside: &Frame<'_>, name: &str, row: &MacroSetting, span: Span) -> Diagnostic {
    let message = format!("{} needs \"{name}\"", inside.name());
    let hint = match row.description.as_str() {
        "" => "write it there, or give it a \"default\" in the macro",
        description => description,
    };
    Diagnostic::at(Code::MissingKey, span, message).hint(hint)
}
