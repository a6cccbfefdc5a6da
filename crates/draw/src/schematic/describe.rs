//! Converts the items of a view into symbols, and lists settings, drives, signals and notes.

use super::lists::{List, ListRow};
use super::number_text::{format_four_digits, format_with_unit};
use super::settings;
use super::symbol::{CordSource, ElementState, Jack, SettingValue, Symbol, SymbolOutput, SymbolSetting};
use super::view::{View, ViewItem};
use patchcord_core::circuit::{Circuit, Cord, Element};
use patchcord_core::elements::Jacks;
use patchcord_core::patch::{ElementEntry, Instance, Signal};

/// Returns the symbols of the items of a view, in their order.
///
/// `state` returns the state of an element, by its full name, if voltages are drawn.
pub(super) fn symbols(view: &View<'_>, state: &dyn Fn(&str) -> Option<ElementState>) -> Vec<Symbol> {
    let describer = Describer { view, state };
    view.items.iter().map(|item| describer.symbol(*item)).collect()
}

/// Makes the symbols of one view.
struct Describer<'a> {
    /// The items and the sources of their cords.
    view: &'a View<'a>,
    /// Returns the state of an element by its full name; `None` if no voltages are drawn.
    state: &'a dyn Fn(&str) -> Option<ElementState>,
}

impl Describer<'_> {
    /// Returns the symbol of an item.
    ///
    /// An input port has no jack. An output port has one jack, with a cord from the element that drives the port.
    fn symbol(&self, item: ViewItem<'_>) -> Symbol {
        match item {
            ViewItem::Element(index) => self.element(index),
            ViewItem::Instance(name, instance) => self.instance(name, instance),
            ViewItem::InputPort(port) => terminal(port, "port-in", None),
            ViewItem::OutputPort(port, element) => {
                terminal(port, "port-out", self.view.source_named(element))
            }
        }
    }

    /// Returns the symbol of an element or a drive.
    ///
    /// The name is the one inside the opened instance. Parts and note are those of the entry in the patch.
    fn element(&self, index: usize) -> Symbol {
        let (circuit, patch) = (self.view.circuit, self.view.circuit.patch());
        let element = circuit.element(index);
        let entry = patch.elements.get(&element.name).or_else(|| patch.drives.get(&element.name));
        Symbol {
            name: self.view.local(&element.name).to_owned(),
            kind: element.kind.name.to_owned(),
            shape: element.kind.symbol,
            jacks: self.jacks(index, element),
            settings: settings::of_element(circuit, element),
            parts: entry.map(parts).unwrap_or_default(),
            outputs: vec![self.output("", &element.name)],
            position: (self.state)(&element.name).and_then(|state| state.position),
            inside: Vec::new(),
            note: entry.map(|entry| entry.note.clone()).unwrap_or_default(),
        }
    }

    /// Returns the jacks with cords, in the order of the inputs. Only inputs with gains have a gain.
    fn jacks(&self, index: usize, element: &Element) -> Vec<Jack> {
        let jack = |(cord, from): (Cord, CordSource)| {
            let input = &element.kind.inputs[cord.input];
            let gain = (input.jacks == Jacks::Gains).then_some(cord.gain);
            Jack { input: input.name.to_owned(), gain, from }
        };
        self.view.cords(index).into_iter().map(jack).collect()
    }

    /// Returns the box of an instance.
    ///
    /// It has a jack for each input port with a cord and an output for each output port. Signals at members that are no
    /// outputs are listed as `inside`, because the box has no point at which they could be written.
    fn instance(&self, name: &str, instance: &Instance) -> Symbol {
        let sources = self.view.port_sources(instance);
        let ports = instance.outputs.iter();
        let is_output = |element: &str| instance.outputs.values().any(|out| out == element);
        let inside = instance.members.iter().filter(|member| !is_output(member));
        Symbol {
            name: self.view.local(name).to_owned(),
            kind: instance.macro_name.clone(),
            shape: "macro",
            jacks: sources.map(|(port, from)| Jack { input: port.to_owned(), gain: None, from }).collect(),
            settings: settings::of_instance(self.view.circuit, name, instance),
            parts: Vec::new(),
            outputs: ports.map(|(port, element)| self.output(port, element)).collect(),
            position: None,
            inside: inside.flat_map(|member| self.signals(member)).collect(),
            note: instance.note.clone(),
        }
    }

    /// Returns an output with the names of its signals and its voltage.
    ///
    /// `element` is the full name of the element with the voltage. `port` is empty for a single element.
    fn output(&self, port: &str, element: &str) -> SymbolOutput {
        let volts = (self.state)(element).map(|state| state.volts);
        SymbolOutput { port: port.to_owned(), signals: self.signals(element), volts }
    }

    /// Returns the names of the signals at an element.
    fn signals(&self, element: &str) -> Vec<String> {
        let signals = self.view.circuit.patch().signals.iter();
        signals.filter(|(_, signal)| signal.element.value == element).map(|(name, _)| name.clone()).collect()
    }
}

/// Returns the symbol of a port of the opened instance.
///
/// `shape` is "port-in" or "port-out", and `from` is the source of the only cord of an output port.
fn terminal(port: &str, shape: &'static str, from: Option<CordSource>) -> Symbol {
    Symbol {
        name: port.to_owned(),
        kind: "port".to_owned(),
        shape,
        jacks: from.into_iter().map(|from| Jack { input: String::new(), gain: None, from }).collect(),
        settings: Vec::new(),
        parts: Vec::new(),
        outputs: vec![SymbolOutput::default()],
        position: None,
        inside: Vec::new(),
        note: String::new(),
    }
}

/// Returns the names of the machine parts that an entry of the patch specifies.
fn parts(entry: &ElementEntry) -> Vec<String> {
    entry.machine_parts.iter().flat_map(|(_, names)| names.iter().map(|name| name.value.clone())).collect()
}

/// Returns the line of small print with the machine and the time scale.
pub(super) fn machine_line(circuit: &Circuit) -> String {
    let machine = circuit.machine().title;
    match circuit.time_scale() {
        1.0 => machine.to_owned(),
        scale => {
            format!("{machine}; time_scale {}: machine seconds per problem second", format_four_digits(scale))
        }
    }
}

/// Returns the lists below a drawing: settings, drives, signals and notes. Empty lists are omitted.
///
/// Each symbol has the prefix of its names. Settings that the drawing shows, according to
/// `shows_setting`, are listed only if they have a formula.
pub(super) fn lists(
    circuit: &Circuit,
    symbols: &[(&str, &Symbol)],
    shows_setting: fn(&Symbol, &SymbolSetting) -> bool,
) -> Vec<List> {
    let is_drive = |symbol: &Symbol| symbol.shape.starts_with("drive-");
    let elements = symbols.iter().filter(|(_, symbol)| !is_drive(symbol));
    let drives = symbols.iter().filter(|(_, symbol)| is_drive(symbol));
    let notes = symbols.iter().filter(|(_, symbol)| !symbol.note.is_empty());
    let note = |(prefix, symbol): &(&str, &Symbol)| {
        ListRow::new(&format!("{prefix}{}", symbol.name), "", &symbol.note)
    };
    let lists = [
        (
            "Settings",
            elements.flat_map(|(prefix, symbol)| setting_rows(prefix, symbol, shows_setting)).collect(),
        ),
        ("Drives", drives.map(|(_, drive)| drive_row(circuit, drive)).collect()),
        ("Signals", signal_rows(circuit)),
        ("Notes", notes.map(note).collect::<Vec<_>>()),
    ];
    let lists = lists.into_iter().map(|(heading, rows)| List { heading, rows });
    lists.filter(|list| !list.rows.is_empty()).collect()
}

/// Returns rows for the settings with formulas and for those that the drawing does not show.
fn setting_rows<'a>(
    prefix: &'a str,
    symbol: &'a Symbol,
    shows_setting: fn(&Symbol, &SymbolSetting) -> bool,
) -> impl Iterator<Item = ListRow> + 'a {
    let listed = symbol
        .settings
        .iter()
        .filter(move |setting| setting.formula.is_some() || !shows_setting(symbol, setting));
    listed.map(move |setting| setting_row(prefix, symbol, setting))
}

/// Returns the row of one setting.
///
/// The setting of a potentiometer and the state of a switch have the name of the element alone, such as `P1`. Other
/// settings add their name: `A1 initial`. Points are in the text column, because they are long.
fn setting_row(prefix: &str, symbol: &Symbol, setting: &SymbolSetting) -> ListRow {
    let name = match setting.name.as_str() {
        "setting" | "closed" => format!("{prefix}{}", symbol.name),
        other => format!("{prefix}{} {other}", symbol.name),
    };
    match setting.value {
        SettingValue::Points(_) => ListRow::new(&name, "", &setting.shown),
        _ => ListRow::new(&name, &setting.shown, setting.formula.as_deref().unwrap_or_default()),
    }
}

/// Returns the row of a drive: its name, the physical value of one volt, its kind and its settings.
///
/// Example: `push`, `1 V = 20 mN`, `sine: amplitude 1 N, frequency 1 Hz, ...`.
fn drive_row(circuit: &Circuit, drive: &Symbol) -> ListRow {
    let texts = drive.settings.iter().map(|setting| format!("{} {}", setting.name, setting.shown));
    let element = circuit.elements().into_iter().find(|element| element.name == drive.name);
    let volt = element.and_then(|element| volt(circuit, element.scale?, 1.0)).unwrap_or_default();
    ListRow::new(&drive.name, &volt, &format!("{}: {}", drive.kind, texts.collect::<Vec<_>>().join(", ")))
}

/// Returns a row for each signal: its name, the physical value of one volt, and the element at which it is.
///
/// A signal in volts has a value only if it has a factor.
fn signal_rows(circuit: &Circuit) -> Vec<ListRow> {
    let signals = circuit.patch().signals.iter();
    let row = |(name, signal): (&String, &Signal)| {
        let scale = signal.scale.as_ref().and_then(|scale| circuit.derived_index(&scale.value));
        let volt = match scale {
            Some(scale) => volt(circuit, scale, signal.factor),
            None => (signal.factor != 1.0).then(|| volt_text("V", signal.factor)),
        };
        ListRow::new(name, &volt.unwrap_or_default(), &format!("at {}", signal.element.value))
    };
    signals.map(row).collect()
}

/// Returns the physical value of one volt: `1 V = 0.254 mm/s`.
fn volt(circuit: &Circuit, scale: usize, factor: f64) -> Option<String> {
    Some(volt_text(circuit.derived_unit(scale).text(), factor * circuit.per_volt(scale)?))
}

/// Formats the physical value of one volt with a unit prefix.
fn volt_text(unit: &str, value: f64) -> String {
    format!("1 V = {}", format_with_unit(value, unit))
}
