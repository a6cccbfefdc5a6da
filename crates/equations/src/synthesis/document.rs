//! Writes the document of the patch.

use std::path::Path;

use patchcord_core::document::{Diagnostic, Report, escape_controls};
use patchcord_core::machines::DEFAULT_MACHINE;
use patchcord_core::patch::{
    Amount, ElementBuilder, Patch, PatchBuilder, Problem, ScaleBuilder, SignalBuilder,
};
use patchcord_expr::{Equation, FormulaDimension, split_primes};
use serde_json::{Map, Value, json};

use super::assembly::Assembly;
use super::design::Design;
use super::formula::{SettingFormula, exact_number, json_number};
use super::input::Input;
use super::layout::layout;
use crate::graph::{NodeId, Operation, PlannedQuantity};
use crate::notation::primed;

/// The largest number of pictures.
const MOST_PICTURES: usize = 4;
/// The largest number of names in the title of a picture.
const MOST_NAMES: usize = 4;

/// A signal of the patch.
struct SignalEntry {
    /// The output that it reads.
    at: String,
    /// Whether the output is inverted.
    is_inverted: bool,
    /// Its name and unit.
    curve: Curve,
}

/// A recorded signal or drive.
struct Curve {
    /// Its name, which is that of its scale too.
    name: String,
    /// The name for the reader, with primes for a derivative.
    label: String,
    /// The text of its unit.
    unit: String,
}

/// Makes the patch from its elements.
///
/// # Errors
/// If the document cannot be decoded, for example because it is longer than 16 MB.
pub(super) fn patch(assembly: Assembly<'_>) -> Result<Patch, Vec<Diagnostic>> {
    let design = assembly.design;
    let signals = signals(&assembly);
    let mut builder = with_scales(head(design), design);
    for name in design.input.problem.patch.drives.keys() {
        builder = builder.drive(name, name, drive(design.input.problem, name));
    }
    builder = with_equations(builder, design);
    for (name, element) in assembly.into_elements() {
        builder = builder.element(&name, element);
    }
    for signal in &signals {
        let name = &signal.curve.name;
        let entry = SignalBuilder::new(&signal.at).scale(name);
        let entry = if signal.is_inverted { entry.factor(-1) } else { entry };
        builder = builder.put_signal(name, entry);
    }
    if let Some(run) = design.input.problem.patch.value().get("run") {
        builder = builder.section("run", run.clone());
    }
    let curves: Vec<Curve> =
        signals.into_iter().map(|signal| signal.curve).chain(drive_curves(design)).collect();
    builder = builder.record(curves.iter().map(|curve| &curve.name));
    let built = with_pictures(builder, &curves).build();
    let written = built.and_then(|patch| Patch::parse(patch.file(), &layout(patch.value())));
    written.map_err(|report| faults(&report))
}

/// A patch with other ranges of some parameters. An end that does not change keeps its text.
///
/// # Errors
/// If the document cannot be decoded.
pub(crate) fn with_ranges(patch: &Patch, ranges: &[(&str, [f64; 2])]) -> Result<Patch, Box<Report>> {
    let mut document = patch.value().clone();
    for (name, ends) in ranges {
        for (index, end) in ends.iter().enumerate() {
            if let Some(written) = document.pointer_mut(&format!("/parameters/{name}/range/{index}"))
                && written.as_f64() != Some(*end)
            {
                *written = exact_number(*end);
            }
        }
    }
    Patch::parse(patch.file(), &layout(&document))
}

/// A patch with another step of its run. The times of its samples stay.
///
/// # Errors
/// If the document cannot be decoded.
pub(crate) fn with_step(patch: &Patch, step: f64) -> Result<Patch, Box<Report>> {
    let mut document = patch.value().clone();
    if let Some(run) = document.get_mut("run").and_then(Value::as_object_mut)
        && let Some(stated) = run.insert("step".to_owned(), exact_number(step))
    {
        run.entry("every").or_insert(stated);
    }
    Patch::parse(patch.file(), &layout(&document))
}

/// The faults of a patch, without their positions in its text, which the user does not see.
fn faults(report: &Report) -> Vec<Diagnostic> {
    report.findings.iter().map(|finding| Diagnostic { span: None, ..finding.clone() }).collect()
}

/// The beginning of the document: texts, machine, time scale and parameters.
fn head(design: &Design<'_>) -> PatchBuilder {
    let problem = &design.input.problem.patch;
    let mut builder = PatchBuilder::new(&title_of(problem));
    if !problem.source.is_empty() {
        builder = builder.source(&problem.source);
    }
    if !problem.note.is_empty() {
        builder = builder.note(&problem.note);
    }
    let machine = design.input.options.machine.name;
    if machine != DEFAULT_MACHINE.name {
        builder = builder.machine(machine);
    }
    if design.time_scale != 1.0 {
        builder = builder.section("time_scale", json_number(design.time_scale));
    }
    match problem.value().get("parameters") {
        Some(parameters) => builder.section("parameters", parameters.clone()),
        None => builder,
    }
}

/// The title of a problem, or the name of its file without the ending.
fn title_of(problem: &Patch) -> String {
    if !problem.title.trim().is_empty() {
        return problem.title.clone();
    }
    let stem = Path::new(problem.file()).file_stem().unwrap_or_default();
    escape_controls(&stem.to_string_lossy())
}

/// Adds the scales: of drives, of quantities, and of other nodes.
fn with_scales(mut builder: PatchBuilder, design: &Design<'_>) -> PatchBuilder {
    let input = design.input;
    for (name, scale) in &input.problem.patch.scales {
        if input.problem.patch.drives.contains_key(name) {
            let node = input.plan.ids().find(|id| *input.operation(*id) == Operation::Drive(name.clone()));
            let per_volt = node.map_or(1.0, |id| scale.unit.out_of_si(design.table.value(id)));
            builder = builder.put_scale(name, ScaleBuilder::new(json_number(per_volt), scale.unit.text()));
        }
    }
    for (index, quantity) in input.plan.quantities.iter().enumerate() {
        if is_signal(design, quantity) {
            let scale = scale_of_quantity(design, index, quantity);
            builder = builder.put_scale(design.names.of_quantity(index), scale);
        }
    }
    for id in input.plan.ids().filter(|id| is_unnamed(design, *id)) {
        if let Some(name) = design.names.of_node(id) {
            let unit = input.unit(id);
            let per_volt = json_number(unit.out_of_si(design.table.value(id)));
            let scale = ScaleBuilder::new(per_volt, unit.text()).description(&input.plan.node(id).name);
            builder = builder.put_scale(&name, scale);
        }
    }
    builder
}

/// Whether a node is neither a quantity nor a drive.
fn is_unnamed(design: &Design<'_>, id: NodeId) -> bool {
    design.input.labels(id).is_empty() && !matches!(design.input.operation(id), Operation::Drive(_))
}

/// Whether a quantity becomes a signal: a derivative does not if it has a name without primes too.
fn is_signal(design: &Design<'_>, quantity: &PlannedQuantity) -> bool {
    let is_derivative = |name: &str| split_primes(name).1 > 0;
    let first = design.input.labels(quantity.node).first();
    !is_derivative(&quantity.name) || first.is_none_or(|first| is_derivative(first))
}

/// The scale of a quantity: a number, or a formula of other scales.
fn scale_of_quantity(design: &Design<'_>, index: usize, quantity: &PlannedQuantity) -> ScaleBuilder {
    let unit = design.input.unit_of_quantity(&quantity.name, quantity.node);
    let entry = design.table.entry(quantity.node);
    let in_unit = unit.out_of_si(entry.value);
    let per_volt = match (&entry.name, &entry.definition) {
        (Some(name), _) if name != design.names.of_quantity(index) => Value::from(name.as_str()),
        (_, Some(definition)) => {
            SettingFormula::one().times(definition, &design.table.expressions).setting(in_unit)
        }
        _ => json_number(in_unit),
    };
    let scale = ScaleBuilder::new(per_volt, unit.text());
    let described = design.input.problem.quantities.get(&quantity.name);
    let description = described.map(|quantity| quantity.description.as_str()).filter(|text| !text.is_empty());
    // The name of the scale of a derivative has no primes.
    let derivative = Some(quantity.name.as_str()).filter(|name| split_primes(name).1 > 0);
    match description.or(derivative) {
        Some(description) => scale.description(description),
        None => scale,
    }
}

/// A drive as the problem states it, with its scale in place of its unit. Points of a file are written in full, because
/// the path to the file depends on the folder of the patch.
fn drive(problem: &Problem, name: &str) -> ElementBuilder {
    let drives = problem.patch.value().get("drives");
    let written = drives.and_then(|drives| drives.get(name)).and_then(Value::as_object);
    let mut entry = Map::new();
    for (key, value) in written.into_iter().flatten() {
        match key.as_str() {
            "unit" => entry.insert("scale".to_owned(), name.into()),
            "points" if value.is_object() => entry.insert(key.clone(), json!(points(problem, name))),
            _ => entry.insert(key.clone(), value.clone()),
        };
    }
    ElementBuilder::from_entry(entry)
}

/// The points of a drive that were read from a file.
fn points<'p>(problem: &'p Problem, name: &str) -> &'p [[f64; 2]] {
    let drive = problem.patch.drives.get(name);
    let mut settings = drive.into_iter().flat_map(|drive| drive.settings.iter().flatten());
    let points = settings.find_map(|setting| match &setting.value {
        Amount::Points(points) => Some(points.as_slice()),
        _ => None,
    });
    points.unwrap_or_default()
}

/// Adds the equations of the problem, the derivatives that are signals, and the initial values. Without equations of the
/// problem, a check would warn of motions that grow, so the patch then says that these are intended.
fn with_equations(builder: PatchBuilder, design: &Design<'_>) -> PatchBuilder {
    let problem = design.input.problem;
    let equations = problem.patch.equations.iter().map(|placed| &placed.value);
    let is_stated =
        |equation: &&Equation| !problem.applies_table(equation) && !starts_solution(design, equation);
    let stated: Vec<&Equation> = equations.filter(is_stated).collect();
    if stated.is_empty() {
        return builder.section("positive_feedback", true);
    }
    let builder = stated.into_iter().fold(builder, |builder, equation| builder.equation(equation.text()));
    let further = derivative_equations(design).chain(initial_equations(design));
    further.fold(builder, |builder, equation| builder.equation(&equation))
}

/// The equations of the derivatives that are signals, such as x_dot = x'. The quantity that is differentiated is a state.
fn derivative_equations(design: &Design<'_>) -> impl Iterator<Item = String> {
    let quantities = design.input.plan.quantities.iter().enumerate();
    let derivatives = quantities.filter(move |(_, quantity)| {
        let (base, order) = split_primes(&quantity.name);
        order > 0 && is_state(design, &primed(base, order - 1)) && is_signal(design, quantity)
    });
    derivatives
        .map(move |(index, quantity)| format!("{} = {}", design.names.of_quantity(index), quantity.name))
}

/// The initial values of states that the problem declares, such as x(0) = x0. Equations of the problem with initial values
/// are equations already. A number with a unit is left out, because a number in an equation has none.
fn initial_equations(design: &Design<'_>) -> impl Iterator<Item = String> {
    let Input { problem, circuit, .. } = design.input;
    let states = problem.quantities.iter().filter(move |(name, _)| is_state(design, name));
    states.filter_map(move |(name, quantity)| {
        let (initial, factor) = quantity.initial_formula(circuit.quantities())?;
        let is_pure = quantity.unit.dimension().is_dimensionless() && factor == 1.0;
        let value = match initial.value.dimension(circuit.quantities()) {
            Ok(FormulaDimension::Of(_)) => initial.value.text(),
            _ if initial.value.evaluate(circuit.quantities()) == Ok(0.0) => "0",
            _ if is_pure => initial.value.text(),
            _ => return None,
        };
        Some(format!("{name}(0) = {value}"))
    })
}

/// Whether a quantity is the output of an integrator.
fn is_state(design: &Design<'_>, name: &str) -> bool {
    let mut quantities = design.input.plan.quantities.iter();
    let node = quantities.find(|quantity| quantity.name == name).map(|quantity| quantity.node);
    node.is_some_and(|node| matches!(design.input.operation(node), Operation::Integral { .. }))
}

/// Whether an equation says near which value an implicit equation is solved. In a patch, only states have initial values.
fn starts_solution(design: &Design<'_>, equation: &Equation) -> bool {
    let Some(name) = equation.initial_quantity() else { return false };
    let mut quantities = design.input.plan.quantities.iter();
    let planned = quantities.find(|quantity| quantity.name == name);
    planned
        .is_none_or(|quantity| !matches!(design.input.operation(quantity.node), Operation::Integral { .. }))
}

/// The signals of the quantities.
fn signals(assembly: &Assembly<'_>) -> Vec<SignalEntry> {
    let design = assembly.design;
    let mut signals = Vec::new();
    for (index, quantity) in design.input.plan.quantities.iter().enumerate() {
        if is_signal(design, quantity) {
            let (at, factor) = assembly.reading(quantity.node);
            let name = design.names.of_quantity(index).to_owned();
            let unit = design.input.unit_of_quantity(&quantity.name, quantity.node).text().to_owned();
            let curve = Curve { name, label: quantity.name.clone(), unit };
            signals.push(SignalEntry { at: at.to_owned(), is_inverted: factor < 0.0, curve });
        }
    }
    signals
}

/// The drives as curves.
fn drive_curves(design: &Design<'_>) -> impl Iterator<Item = Curve> {
    let patch = &design.input.problem.patch;
    let drives = patch.scales.iter().filter(|(name, _)| patch.drives.contains_key(*name));
    drives.map(|(name, scale)| {
        let unit = scale.unit.text().to_owned();
        Curve { name: name.clone(), label: name.clone(), unit }
    })
}

/// Adds the pictures: one for each unit, with all quantities and drives in this unit against time.
fn with_pictures(builder: PatchBuilder, curves: &[Curve]) -> PatchBuilder {
    let mut groups: Vec<Vec<&Curve>> = Vec::new();
    for curve in curves {
        match groups.iter_mut().find(|group| group[0].unit == curve.unit) {
            Some(group) => group.push(curve),
            None => groups.push(vec![curve]),
        }
    }
    let pictures = groups.into_iter().take(MOST_PICTURES);
    pictures.fold(builder, |builder, group| {
        let labels: Vec<&str> = group.iter().map(|curve| curve.label.as_str()).collect();
        builder.picture(&title(&labels), "t", group.iter().map(|curve| &curve.name))
    })
}

/// The title of a picture: the names of its quantities and drives.
fn title(names: &[&str]) -> String {
    match names.len().checked_sub(MOST_NAMES) {
        Some(more @ 1..) => format!("{} and {more} more", names[..MOST_NAMES].join(", ")),
        _ => names.join(", "),
    }
}
