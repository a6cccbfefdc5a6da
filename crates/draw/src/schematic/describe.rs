//! From the circuit to symbols and lists.

use super::lists::{List, Row};
use super::symbol::{Jack, Outlet, Setting, Source, Standing, Symbol, Value, digits, quantity, share, volts};
use super::view::{Item, View};
use patchcord_core::circuit::{Circuit, Cord, Element};
use patchcord_core::elements::{Default, Jacks, Measure, Setting as SettingRow};
use patchcord_core::patch::{Amount, Entry, Instance, InstanceSetting};
use patchcord_expr::{Formula, Unit};

/// The symbols of what stands on a drawing, drives first, in the order of the document.
pub(super) fn symbols(view: &View<'_>, standing: &dyn Fn(&str) -> Option<Standing>) -> Vec<Symbol> {
    let describer = Describer { view, standing };
    view.items.iter().map(|item| describer.symbol(*item)).collect()
}

struct Describer<'a> {
    view: &'a View<'a>,
    standing: &'a dyn Fn(&str) -> Option<Standing>,
}

impl Describer<'_> {
    fn symbol(&self, item: Item<'_>) -> Symbol {
        match item {
            Item::Element(index) => self.element(index),
            Item::Instance(name, instance) => self.instance(name, instance),
            Item::Inlet(port) => terminal(port, "port-in", None),
            Item::Outlet(port, element) => terminal(port, "port-out", self.view.source_named(element)),
        }
    }

    fn element(&self, index: usize) -> Symbol {
        let (circuit, patch) = (self.view.circuit, self.view.circuit.patch());
        let element = circuit.element(index);
        let entry = patch.elements.get(&element.name).or_else(|| patch.drives.get(&element.name));
        Symbol {
            name: self.view.local(&element.name).to_owned(),
            kind: element.kind.name.to_owned(),
            shape: element.kind.symbol,
            jacks: self.jacks(index, element),
            settings: settings(circuit, element),
            parts: entry.map(parts).unwrap_or_default(),
            outlets: vec![self.outlet("", &element.name)],
            position: (self.standing)(&element.name).and_then(|standing| standing.position),
            inside: Vec::new(),
            note: entry.map(|entry| entry.note.clone()).unwrap_or_default(),
        }
    }

    fn jacks(&self, index: usize, element: &Element) -> Vec<Jack> {
        let jack = |(cord, from): (Cord, Source)| {
            let input = &element.kind.inputs[cord.input];
            let gain = (input.jacks == Jacks::Gains).then_some(cord.gain);
            Jack { input: input.name.to_owned(), gain, from }
        };
        self.view.cords(index).into_iter().map(jack).collect()
    }

    fn instance(&self, name: &str, instance: &Instance) -> Symbol {
        let plugged = self.view.plugged(instance);
        let ports = instance.outputs.iter();
        let comes_out = |element: &str| instance.outputs.values().any(|out| out == element);
        let inside = instance.members.iter().filter(|member| !comes_out(member));
        Symbol {
            name: self.view.local(name).to_owned(),
            kind: instance.of.clone(),
            shape: "macro",
            jacks: plugged.map(|(port, from)| Jack { input: port.to_owned(), gain: None, from }).collect(),
            settings: instance_settings(self.view.circuit, name, instance),
            parts: Vec::new(),
            outlets: ports.map(|(port, element)| self.outlet(port, element)).collect(),
            position: None,
            inside: inside.flat_map(|member| self.signals(member)).collect(),
            note: instance.note.clone(),
        }
    }

    fn outlet(&self, port: &str, element: &str) -> Outlet {
        let volts = (self.standing)(element).map(|standing| standing.volts);
        Outlet { port: port.to_owned(), signals: self.signals(element), volts }
    }

    /// The signals that are read at an element.
    fn signals(&self, element: &str) -> Vec<String> {
        let signals = self.view.circuit.patch().signals.iter();
        signals.filter(|(_, signal)| signal.at.value == element).map(|(name, _)| name.clone()).collect()
    }
}

/// A port of an opened instance.
fn terminal(port: &str, shape: &'static str, from: Option<Source>) -> Symbol {
    Symbol {
        name: port.to_owned(),
        kind: "port".to_owned(),
        shape,
        jacks: from.into_iter().map(|from| Jack { input: String::new(), gain: None, from }).collect(),
        settings: Vec::new(),
        parts: Vec::new(),
        outlets: vec![Outlet::default()],
        position: None,
        inside: Vec::new(),
        note: String::new(),
    }
}

/// The settings of an instance, in the units that its macro gives them.
fn instance_settings(circuit: &Circuit, name: &str, instance: &Instance) -> Vec<Setting> {
    let setting = |(key, made): (&String, &InstanceSetting)| {
        let value = circuit.per_volt(circuit.derived_index(&format!("{name}.{key}"))?)?;
        let text = made.value.value.text();
        Some(Setting {
            name: key.clone(),
            formula: text.trim().parse::<f64>().is_err().then(|| text.to_owned()),
            value: Value::Number(value),
            shown: quantity(made.unit.text(), value),
            // The box writes all settings of its instance: only formulas are listed.
            is_given: false,
        })
    };
    instance.settings.iter().filter_map(setting).collect()
}

fn parts(entry: &Entry) -> Vec<String> {
    entry.uses.iter().flat_map(|(_, names)| names.iter().map(|name| name.value.clone())).collect()
}

fn settings(circuit: &Circuit, element: &Element) -> Vec<Setting> {
    let rows = element.kind.settings.iter().zip(&element.settings);
    rows.filter_map(|(row, given)| match given {
        Some(placed) => given_setting(circuit, element, row, &placed.value),
        None => preset(circuit, element, row),
    })
    .collect()
}

fn given_setting(circuit: &Circuit, element: &Element, row: &SettingRow, amount: &Amount) -> Option<Setting> {
    let (value, formula, shown) = match (amount, row.measure) {
        (Amount::Formula(formula), _) => {
            let value = formula.evaluate(circuit.quantities()).ok()?;
            let unit = unit(circuit, element, row);
            let value = in_unit(circuit, row, formula, value, &unit);
            let is_number = formula.text().trim().parse::<f64>().is_ok();
            let formula = (!is_number).then(|| formula.text().to_owned());
            (Value::Number(value), formula, shown(row, value, &unit))
        }
        (Amount::Flag(flag), _) => (Value::Flag(*flag), None, flag_told(*flag)),
        (Amount::Choice(index), Measure::Choice(words)) => {
            let word = words.get(*index)?;
            (Value::Word(word), None, (*word).to_owned())
        }
        (Amount::Points(points), _) => (Value::Points(points.clone()), None, points_told(points)),
        (Amount::Choice(_), _) => return None,
    };
    Some(Setting { name: row.name.to_owned(), formula, value, shown, is_given: true })
}

/// The flags of all elements say whether a contact is closed.
fn flag_told(closed: bool) -> String {
    if closed { "closed" } else { "open" }.to_owned()
}

fn preset(circuit: &Circuit, element: &Element, row: &SettingRow) -> Option<Setting> {
    let Default::Number(number) = row.default else { return None };
    let value = match row.measure {
        Measure::Flag => Value::Flag(number != 0.0),
        Measure::Choice(words) => Value::Word(words.get(number as usize)?),
        _ => Value::Number(number),
    };
    let shown = match &value {
        Value::Flag(flag) => flag_told(*flag),
        Value::Word(word) => (*word).to_owned(),
        _ => shown(row, number, &unit(circuit, element, row)),
    };
    Some(Setting { name: row.name.to_owned(), formula: None, value, shown, is_given: false })
}

/// The unit of a setting's numbers.
fn unit(circuit: &Circuit, element: &Element, row: &SettingRow) -> String {
    let scale = element.scale.map(|scale| circuit.derived_unit(scale));
    match (row.measure, scale) {
        (Measure::Signal, Some(scale)) => scale.text().to_owned(),
        (Measure::SignalRate, Some(scale)) => scale.per_second().text().to_owned(),
        _ => row.unit().to_owned(),
    }
}

/// A formula's value in the unit of its place: of a drive's settings it comes in SI.
fn in_unit(circuit: &Circuit, row: &SettingRow, formula: &Formula, value: f64, unit: &str) -> f64 {
    let is_of_signal = matches!(row.measure, Measure::Signal | Measure::SignalRate);
    match Unit::parse(unit) {
        Ok(unit) if is_of_signal && !circuit.is_plain(formula) => unit.out_of_si(value),
        _ => value,
    }
}

/// A value as the drawing shows it.
fn shown(row: &SettingRow, value: f64, unit: &str) -> String {
    match row.measure {
        Measure::Fraction => share(value),
        Measure::Ratio => digits(value),
        Measure::Whole => value.to_string(),
        Measure::Volts => volts(value),
        Measure::MachineSeconds => quantity("s", value),
        _ => quantity(unit, value),
    }
}

/// More points than this are not told one by one.
const MOST_POINTS: usize = 8;

/// Points as text; of many the first ones.
fn points_told(points: &[[f64; 2]]) -> String {
    let told = points.iter().take(MOST_POINTS).map(|[x, y]| format!("({}, {})", digits(*x), digits(*y)));
    let told = told.collect::<Vec<_>>().join(" ");
    if points.len() > MOST_POINTS { format!("{told} … {} points", points.len()) } else { told }
}

/// Machine and time scale, for the small print.
pub(super) fn machine_line(circuit: &Circuit) -> String {
    let machine = circuit.machine().title;
    match circuit.time_scale() {
        1.0 => machine.to_owned(),
        scale => format!("{machine}; time_scale {}: machine seconds per problem second", digits(scale)),
    }
}

/// The lists below a drawing: settings that it does not tell, drives, signals, notes. Symbols come with what their
/// names begin with.
pub(super) fn lists(
    circuit: &Circuit,
    symbols: &[(&str, &Symbol)],
    tells: fn(&Symbol, &Setting) -> bool,
) -> Vec<List> {
    let is_drive = |symbol: &Symbol| symbol.shape.starts_with("drive-");
    let elements = symbols.iter().filter(|(_, symbol)| !is_drive(symbol));
    let drives = symbols.iter().filter(|(_, symbol)| is_drive(symbol));
    let notes = symbols.iter().filter(|(_, symbol)| !symbol.note.is_empty());
    let note =
        |(prefix, symbol): &(&str, &Symbol)| Row::new(&format!("{prefix}{}", symbol.name), "", &symbol.note);
    let lists = [
        ("Settings", elements.flat_map(|(prefix, symbol)| setting_rows(prefix, symbol, tells)).collect()),
        ("Drives", drives.map(|(_, drive)| drive_row(circuit, drive)).collect()),
        ("Signals", signal_rows(circuit)),
        ("Notes", notes.map(note).collect::<Vec<_>>()),
    ];
    let lists = lists.into_iter().map(|(heading, rows)| List { heading, rows });
    lists.filter(|list| !list.rows.is_empty()).collect()
}

/// Settings that come of formulas, and those that the drawing does not tell.
fn setting_rows<'a>(
    prefix: &'a str,
    symbol: &'a Symbol,
    tells: fn(&Symbol, &Setting) -> bool,
) -> impl Iterator<Item = Row> + 'a {
    let listed =
        symbol.settings.iter().filter(move |setting| setting.formula.is_some() || !tells(symbol, setting));
    listed.map(move |setting| setting_row(prefix, symbol, setting))
}

fn setting_row(prefix: &str, symbol: &Symbol, setting: &Setting) -> Row {
    let name = match setting.name.as_str() {
        "setting" | "closed" => format!("{prefix}{}", symbol.name),
        other => format!("{prefix}{} {other}", symbol.name),
    };
    match setting.value {
        Value::Points(_) => Row::new(&name, "", &setting.shown),
        _ => Row::new(&name, &setting.shown, setting.formula.as_deref().unwrap_or_default()),
    }
}

fn drive_row(circuit: &Circuit, drive: &Symbol) -> Row {
    let told = drive.settings.iter().map(|setting| format!("{} {}", setting.name, setting.shown));
    let scale = circuit.elements().into_iter().find(|element| element.name == drive.name);
    let volt = scale.and_then(|element| volt(circuit, element.scale?, 1.0)).unwrap_or_default();
    Row::new(&drive.name, &volt, &format!("{}: {}", drive.kind, told.collect::<Vec<_>>().join(", ")))
}

fn signal_rows(circuit: &Circuit) -> Vec<Row> {
    let signals = circuit.patch().signals.iter();
    let row = |(name, signal): (&String, &patchcord_core::patch::Signal)| {
        let scale = signal.scale.as_ref().and_then(|scale| circuit.derived_index(&scale.value));
        let volt = match scale {
            Some(scale) => volt(circuit, scale, signal.factor),
            None => (signal.factor != 1.0).then(|| stands_for("V", signal.factor)),
        };
        Row::new(name, &volt.unwrap_or_default(), &format!("at {}", signal.at.value))
    };
    signals.map(row).collect()
}

/// What one volt stands for: "1 V = 0.254 mm/s".
fn volt(circuit: &Circuit, scale: usize, factor: f64) -> Option<String> {
    Some(stands_for(circuit.derived_unit(scale).text(), factor * circuit.per_volt(scale)?))
}

fn stands_for(unit: &str, value: f64) -> String {
    format!("1 V = {}", quantity(unit, value))
}
