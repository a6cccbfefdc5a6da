//! Random patches composed from the table of elements.

use super::document::Node;
use super::number_text::edge_number;
use crate::common::random::SplitMix64;
use patchcord::elements::{Family, Jacks, Kind, REGISTRY, Setting, SettingDefault, SettingQuantity, find};

/// Kinds from which most circuits are made.
const USUAL_KINDS: [&str; 6] = ["integrator", "summer", "pot", "lag", "multiplier", "relay"];

/// The gains of jacks.
const GAINS: [&str; 6] = ["1", "10", "10", "100", "1000", "0.5"];

/// The ratio of the ends of a range from which its decades are equally likely.
const WIDE_RANGE: f64 = 1e6;

/// A patch with up to three drives and up to twenty elements, with cords between any of them.
pub(crate) fn random_patch(random: &mut SplitMix64) -> Node {
    let has_edges = random.below(2) == 0;
    let most = *random.pick(&[4, 8, 20]);
    let elements: Vec<String> = (0..=random.below(most)).map(|index| format!("E{index}")).collect();
    let drives: Vec<String> = (0..random.below(4)).map(|index| format!("D{index}")).collect();
    let drive_section = drives.iter().map(|name| (name.clone(), drive(has_edges, random))).collect();
    let element_section = (0..elements.len()).map(|index| {
        let cords = Cords { elements: &elements, drives: &drives, index };
        (elements[index].clone(), element(&cords, has_edges, random))
    });
    let element_section = element_section.collect();
    let parameter = Node::object([
        ("value", Node::number(1.0)),
        ("unit", Node::text("1")),
        ("range", Node::List(vec![Node::number(0.0), Node::number(2.0)])),
    ]);
    let volt = Node::object([("per_volt", Node::number(1.0)), ("unit", Node::text("V"))]);
    let time_scale = if random.below(3) == 0 { random.log_uniform(1e-6, 1e6) } else { 1.0 };
    Node::object([
        ("patchcord", Node::Number("1".to_owned())),
        ("time_scale", Node::number(time_scale)),
        ("parameters", Node::object([("p", parameter)])),
        ("scales", Node::object([("volt", volt)])),
        ("drives", Node::Object(drive_section)),
        ("elements", Node::Object(element_section)),
        ("run", run_plan(random)),
    ])
}

/// A run plan with equal steps or with a tolerance.
fn run_plan(random: &mut SplitMix64) -> Node {
    let step = random.log_uniform(1e-6, 1.0);
    let mut entries = vec![
        ("for".to_owned(), Node::number(step * (1 + random.below(300)) as f64)),
        ("step".to_owned(), Node::number(step)),
    ];
    if random.below(4) == 0 {
        entries.push(("tolerance".to_owned(), Node::number(random.log_uniform(1e-9, 1e-2))));
    }
    Node::Object(entries)
}

/// What the cords of an element may name.
struct Cords<'a> {
    /// All elements, in order.
    elements: &'a [String],
    /// All drives.
    drives: &'a [String],
    /// The index of the element.
    index: usize,
}

impl Cords<'_> {
    /// The name of a source: often an earlier element, so that there are not too many loops.
    fn source(&self, random: &mut SplitMix64) -> Node {
        let earlier = &self.elements[..self.index];
        Node::text(match random.below(8) {
            0..3 if !earlier.is_empty() => random.pick(earlier).as_str(),
            3..5 if !self.drives.is_empty() => random.pick(self.drives).as_str(),
            5 | 6 => random.choose(&["+100", "-100", "ground"]),
            _ => random.pick(self.elements).as_str(),
        })
    }

    /// A list of sources.
    fn list(&self, count: usize, random: &mut SplitMix64) -> Node {
        Node::List((0..count).map(|_| self.source(random)).collect())
    }
}

/// A random drive.
fn drive(has_edges: bool, random: &mut SplitMix64) -> Node {
    let kind = any_kind(Family::Drive, random);
    let mut entries =
        vec![("kind".to_owned(), Node::text(kind.name)), ("scale".to_owned(), Node::text("volt"))];
    add_settings(&mut entries, kind, has_edges, random);
    Node::Object(entries)
}

/// A random element.
fn element(cords: &Cords<'_>, has_edges: bool, random: &mut SplitMix64) -> Node {
    let is_usual = random.below(3) == 0;
    let usual = *random.pick(&USUAL_KINDS);
    let any = any_kind(Family::Computing, random);
    let kind = if is_usual { find(Family::Computing, usual).unwrap_or(any) } else { any };
    let mut entries = vec![("kind".to_owned(), Node::text(kind.name))];
    let mut jacks = Vec::new();
    for input in kind.inputs {
        if !input.required && random.below(4) > 0 {
            continue;
        }
        match input.jacks {
            Jacks::One => entries.push((input.name.to_owned(), cords.source(random))),
            Jacks::Exactly(count) => entries.push((input.name.to_owned(), cords.list(count, random))),
            Jacks::Any => jacks.push((input.name.to_owned(), cords.list(1, random))),
            Jacks::Gains => {
                let name = format!("{}{}", input.name, random.pick(&GAINS));
                jacks.push((name, cords.list(1 + random.below(3), random)));
            }
        }
    }
    if !jacks.is_empty() {
        entries.push(("in".to_owned(), Node::Object(jacks)));
    }
    add_settings(&mut entries, kind, has_edges, random);
    Node::Object(entries)
}

/// A random kind of a family.
fn any_kind(family: Family, random: &mut SplitMix64) -> &'static Kind {
    let kinds: Vec<&'static Kind> = REGISTRY.iter().copied().filter(|kind| kind.family == family).collect();
    random.choose(&kinds)
}

/// Adds the settings that a kind needs, and some others.
fn add_settings(entries: &mut Vec<(String, Node)>, kind: &Kind, has_edges: bool, random: &mut SplitMix64) {
    for setting in kind.settings {
        if setting.default == SettingDefault::Required || random.below(4) == 0 {
            let is_edge = has_edges && random.below(12) == 0;
            let value = if is_edge { Node::Number(edge_number(random)) } else { value(setting, random) };
            add(entries, setting.name, value);
        }
    }
}

/// Adds an entry. A name with a dot is that of an entry in an object: "limit.upper".
fn add(entries: &mut Vec<(String, Node)>, name: &str, value: Node) {
    let Some((outer, inner)) = name.split_once('.') else {
        return entries.push((name.to_owned(), value));
    };
    let inner = (inner.to_owned(), value);
    match entries.iter_mut().find(|(key, _)| key == outer) {
        Some((_, Node::Object(group))) => group.push(inner),
        _ => entries.push((outer.to_owned(), Node::Object(vec![inner]))),
    }
}

/// A random value of a setting, within its range.
fn value(setting: &Setting, random: &mut SplitMix64) -> Node {
    match setting.quantity {
        SettingQuantity::Flag => Node::Flag(random.below(2) == 0),
        SettingQuantity::Choice(words) => Node::text(random.choose(words)),
        SettingQuantity::Whole => Node::Number(random.below(1000).to_string()),
        SettingQuantity::Points => points(1.0, random),
        SettingQuantity::Curve(_) => points(50.0, random),
        _ => Node::number(number(setting, random)),
    }
}

/// A number within the range of a setting: an end, or a value between.
fn number(setting: &Setting, random: &mut SplitMix64) -> f64 {
    let (low, high) = setting.range;
    let is_bounded = high - low < WIDE_RANGE;
    match random.below(4) {
        0 if is_bounded => *random.pick(&[low, high]),
        _ if low > 0.0 && high > WIDE_RANGE * low => random.log_uniform(low.max(1e-6), high.min(1e3)),
        _ if is_bounded => random.uniform(low, high),
        _ if low == 0.0 => random.log_uniform(1e-3, 1e3),
        _ => random.uniform(-100.0, 100.0),
    }
}

/// Points with increasing abscissae from 0 to about four times `distance`, and ordinates within 100.
fn points(distance: f64, random: &mut SplitMix64) -> Node {
    let mut abscissa = 0.0;
    let point = |_| {
        abscissa += random.uniform(0.1, 1.0) * distance;
        Node::List(vec![Node::number(abscissa), Node::number(random.uniform(-100.0, 100.0))])
    };
    Node::List((0..3).map(point).collect())
}
