//! Random patches without integrators, and all voltages that satisfy them, by enumeration.
//!
//! The enumeration shares nothing with the solver. Every element has a few linear cases, such as an amplifier within
//! its limits, at +100 V and at -100 V. For every combination of cases a system of linear equations gives the voltages.
//! They are a solution if they satisfy the conditions of all cases.

use super::random::SplitMix64;
use super::{element, run_for, voltage, volts};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, PatchBuilder};

/// An affine form of the outputs: their coefficients, and last the constant in volts.
type Form = Vec<f64>;

/// One linear case of an element's law.
struct Case {
    /// The output.
    output: Form,
    /// The forms that must not be negative.
    conditions: Vec<Form>,
}

/// A patch without integrators, and the laws of its elements.
pub(crate) struct StaticPatch {
    /// The patch. Its elements are named E0, E1 and so on.
    pub builder: PatchBuilder,
    /// The cases of every element.
    laws: Vec<Vec<Case>>,
}

/// The voltages that satisfy a patch.
pub(crate) struct Enumerated {
    /// The outputs of all elements, for every solution.
    pub solutions: Vec<Vec<f64>>,
    /// Whether rounding decides the number of solutions: a condition is barely satisfied or barely violated, or a
    /// system is nearly singular.
    pub is_borderline: bool,
}

/// The result of the solver compared with that of the enumeration.
pub(crate) enum Comparison {
    /// The same, only solution.
    Equal,
    /// Refused, and there is not exactly one solution.
    Refused,
    /// Rounding decides the number of solutions.
    Borderline,
    /// Not the same. The text shows both, and the patch.
    Different(String),
}

/// Numbers of results.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    /// Patches with the same, only solution.
    pub equal: usize,
    /// Patches that were refused, and do not have exactly one solution.
    pub refused: usize,
    /// Patches for which rounding decides the number of solutions.
    pub borderline: usize,
    /// Descriptions of the patches that differ.
    pub different: Vec<String>,
}

/// Compares random patches with the enumeration.
pub(crate) fn compare_random(
    seed: u64,
    cases: usize,
    mut random_one: impl FnMut(&mut SplitMix64) -> StaticPatch,
) -> Tally {
    let mut random = SplitMix64(seed);
    let mut tally = Tally::default();
    for _ in 0..cases {
        match random_one(&mut random).compare() {
            Comparison::Equal => tally.equal += 1,
            Comparison::Refused => tally.refused += 1,
            Comparison::Borderline => tally.borderline += 1,
            Comparison::Different(text) => tally.different.push(text),
        }
    }
    tally
}

/// A random number of elements from `least` to `most`.
pub(crate) fn random_count(random: &mut SplitMix64, least: usize, most: usize) -> usize {
    least + random.uniform(0.0, (most - least + 1) as f64) as usize
}

/// Name of an element.
fn name(index: usize) -> String {
    format!("E{index}")
}

/// A source that an input can be connected to: an element or a reference of ±100 V.
#[derive(Clone, Copy)]
enum Cord {
    Element(usize),
    Reference(f64),
}

impl Cord {
    /// A random cord. One in five comes from a reference.
    fn random(random: &mut SplitMix64, count: usize) -> Self {
        match random.uniform(0.0, 10.0) {
            volts if volts < 1.0 => Cord::Reference(100.0),
            volts if volts < 2.0 => Cord::Reference(-100.0),
            _ => Cord::Element(random.uniform(0.0, count as f64) as usize),
        }
    }

    /// The name that a patch uses.
    fn name(self) -> String {
        match self {
            Cord::Element(index) => name(index),
            Cord::Reference(volts) => format!("{volts:+}"),
        }
    }

    /// The voltage.
    fn form(self, count: usize) -> Form {
        let mut form = vec![0.0; count + 1];
        match self {
            Cord::Element(index) => form[index] = 1.0,
            Cord::Reference(volts) => form[count] = volts,
        }
        form
    }
}

/// a x + b y.
fn combined(a: f64, x: &[f64], b: f64, y: &[f64]) -> Form {
    x.iter().zip(y).map(|(x, y)| a * x + b * y).collect()
}

/// The cases of an amplifier that is demanded this output.
fn amplifier(demand: &Form) -> Vec<Case> {
    let count = demand.len() - 1;
    let level = |volts: f64| {
        let mut form = vec![0.0; count + 1];
        form[count] = volts;
        form
    };
    let (below, above) =
        (combined(1.0, &level(100.0), -1.0, demand), combined(1.0, demand, 1.0, &level(100.0)));
    let negated = |form: &Form| combined(-1.0, form, 0.0, form);
    vec![
        Case { output: demand.clone(), conditions: vec![below.clone(), above.clone()] },
        Case { output: level(100.0), conditions: vec![negated(&below)] },
        Case { output: level(-100.0), conditions: vec![negated(&above)] },
    ]
}

/// Sum of gain times voltage, over 1 to 4 cords, with the element that has these inputs.
fn sum(random: &mut SplitMix64, count: usize, mut entry: ElementBuilder) -> (ElementBuilder, Form) {
    let gains = [0.1, 0.3, 0.5, 1.0, 2.0, 3.0, 10.0];
    let mut total = vec![0.0; count + 1];
    let mut used: Vec<usize> = Vec::new();
    for _ in 0..1 + random.uniform(0.0, 4.0) as usize {
        let jack = random.uniform(0.0, gains.len() as f64) as usize;
        if used.contains(&jack) {
            continue;
        }
        used.push(jack);
        let cord = Cord::random(random, count);
        total = combined(1.0, &total, gains[jack], &cord.form(count));
        entry = entry.cords(&format!("x{}", gains[jack]), [cord.name()]);
    }
    (entry, total)
}

/// A random element with its cases.
fn random_element(random: &mut SplitMix64, count: usize) -> (ElementBuilder, Vec<Case>) {
    let cord = Cord::random(random, count);
    let form = cord.form(count);
    let zero = vec![0.0; count + 1];
    match random.uniform(0.0, 12.0) as usize {
        0..5 => {
            let (entry, total) = sum(random, count, element("summer"));
            (entry, amplifier(&combined(-1.0, &total, 0.0, &zero)))
        }
        5 => {
            let gain = [1e2, 1e4, 1e6, 1e8][random.uniform(0.0, 4.0) as usize];
            let (entry, total) = sum(random, count, element("open-amplifier").set("amplification", gain));
            (entry, amplifier(&combined(-gain, &total, 0.0, &zero)))
        }
        6 | 7 => {
            let setting = [0.2, 0.5, 0.9][random.uniform(0.0, 3.0) as usize];
            let entry = element("pot").cord("in", &cord.name()).set("setting", setting);
            (entry, vec![Case { output: combined(setting, &form, 0.0, &zero), conditions: Vec::new() }])
        }
        8 => {
            let negated = combined(-1.0, &form, 0.0, &zero);
            let cases = vec![
                Case { output: form.clone(), conditions: vec![form] },
                Case { output: negated.clone(), conditions: vec![negated] },
            ];
            (element("absolute").cord("in", &cord.name()), cases)
        }
        kind => {
            let other = Cord::random(random, count);
            let difference = combined(1.0, &form, -1.0, &other.form(count));
            let opposite = combined(-1.0, &difference, 0.0, &zero);
            let kind = if kind % 2 == 0 { "diode-upper-of" } else { "diode-lower-of" };
            let (first, second) =
                if kind == "diode-upper-of" { (difference, opposite) } else { (opposite, difference) };
            let entry =
                element(kind).set("in", serde_json::json!([cord.name(), other.name()])).set("drop", 0);
            let cases = vec![
                Case { output: form, conditions: vec![first] },
                Case { output: other.form(count), conditions: vec![second] },
            ];
            (entry, cases)
        }
    }
}

/// A patch of elements of several kinds.
pub(crate) fn random_patch(random: &mut SplitMix64, count: usize) -> StaticPatch {
    let parts: Vec<_> = (0..count).map(|_| random_element(random, count)).collect();
    assembled(parts)
}

/// A patch of summers, each of which reads about half of all summers and a reference.
pub(crate) fn random_summers(random: &mut SplitMix64, count: usize) -> StaticPatch {
    let zero = vec![0.0; count + 1];
    let parts = (0..count).map(|own| {
        let mut total = zero.clone();
        let mut entry = element("summer");
        for other in 0..count {
            if other == own || random.uniform(0.0, 1.0) < 0.5 {
                // No two cords have the same gain, because a jack is named by its gain.
                let gain = (random.uniform(0.05, 1.5) * 1e3).round() / 1e3 + 1e-4 * other as f64;
                total = combined(1.0, &total, gain, &Cord::Element(other).form(count));
                entry = entry.cords(&format!("x{gain}"), [name(other)]);
            }
        }
        let volts = if random.uniform(0.0, 1.0) < 0.5 { 100.0 } else { -100.0 };
        let gain = random.uniform(0.1, 1.2);
        total = combined(1.0, &total, gain, &Cord::Reference(volts).form(count));
        entry = entry.cords(&format!("x{gain}"), [Cord::Reference(volts).name()]);
        (entry, amplifier(&combined(-1.0, &total, 0.0, &zero)))
    });
    let parts = parts.collect();
    assembled(parts)
}

/// A patch of these elements.
fn assembled(parts: Vec<(ElementBuilder, Vec<Case>)>) -> StaticPatch {
    let mut builder = volts("static");
    let mut laws = Vec::new();
    for (index, (entry, cases)) in parts.into_iter().enumerate() {
        builder = builder.element(&name(index), entry);
        laws.push(cases);
    }
    StaticPatch { builder, laws }
}

impl StaticPatch {
    /// Largest difference, in volts, between an output and the law of its element at these outputs. The law of an
    /// amplifier with much gain counts at its inputs.
    pub(crate) fn violation(&self, outputs: &[f64]) -> f64 {
        let value =
            |form: &Form| form[outputs.len()] + form.iter().zip(outputs).map(|(a, v)| a * v).sum::<f64>();
        let of = |(index, cases): (usize, &Vec<Case>)| {
            let of_case = |case: &Case| {
                let scale =
                    case.output.iter().take(outputs.len()).fold(1.0f64, |most, term| most.max(term.abs()));
                let scale = if scale >= 100.0 { scale } else { 1.0 };
                let broken = case.conditions.iter().map(|form| -value(form) / scale).fold(0.0, f64::max);
                ((value(&case.output) - outputs[index]).abs() / scale).max(broken)
            };
            cases.iter().map(of_case).fold(f64::INFINITY, f64::min)
        };
        self.laws.iter().enumerate().map(of).fold(0.0, f64::max)
    }

    /// Compares the solver with the enumeration.
    pub(crate) fn compare(&self) -> Comparison {
        let built = self.builder.clone().build().unwrap_or_else(|report| panic!("{report}"));
        let circuit = Circuit::new(&built).unwrap_or_else(|report| panic!("{report}"));
        let expected = self.enumerate();
        let program = match Program::new(&circuit) {
            Ok(program) => program,
            Err(_) if expected.is_borderline => return Comparison::Borderline,
            Err(_) if expected.solutions.len() != 1 => return Comparison::Refused,
            Err(report) => {
                let only = &expected.solutions[0];
                return Comparison::Different(format!("{report}\nexpected {only:?}\n{}", built.text()));
            }
        };
        let machine = run_for(&program, 1e-3, 0.0);
        let outputs: Vec<f64> = (0..self.laws.len()).map(|index| voltage(&machine, &name(index))).collect();
        let violation = self.violation(&outputs);
        let is_expected = match expected.solutions.as_slice() {
            [only] => only.iter().zip(&outputs).all(|(a, b)| (a - b).abs() < 1e-6),
            _ => false,
        };
        // The laws must hold even where rounding decides the number of solutions.
        if violation <= 1e-9 && (is_expected || expected.is_borderline) {
            return if is_expected { Comparison::Equal } else { Comparison::Borderline };
        }
        let found = format!("found {outputs:?}, a law violated by {violation:e} V");
        Comparison::Different(format!("{found}\nexpected {:?}\n{}", expected.solutions, built.text()))
    }

    /// All voltages that satisfy the laws of all elements.
    pub(crate) fn enumerate(&self) -> Enumerated {
        let mut all = Enumerated { solutions: Vec::new(), is_borderline: false };
        let mut chosen = vec![0; self.laws.len()];
        loop {
            self.examine(&chosen, &mut all);
            let Some(next) = (0..chosen.len()).find(|at| chosen[*at] + 1 < self.laws[*at].len()) else {
                return all;
            };
            chosen[next] += 1;
            chosen[..next].fill(0);
        }
    }

    /// Adds the solution of one combination of cases.
    fn examine(&self, chosen: &[usize], all: &mut Enumerated) {
        let count = chosen.len();
        let cases: Vec<&Case> = self.laws.iter().zip(chosen).map(|(cases, case)| &cases[*case]).collect();
        let rows = cases.iter().enumerate().map(|(index, case)| {
            let mut row: Form = case.output.iter().map(|term| -term).collect();
            row[index] += 1.0;
            row[count] = case.output[count];
            row
        });
        let outputs = match eliminate(rows.collect()) {
            Eliminated::One(outputs) => outputs,
            Eliminated::Nothing => return,
            Eliminated::Line(point, direction) => {
                self.examine_line(&cases, &point, &direction, all);
                return;
            }
            Eliminated::Unknown => {
                all.is_borderline = true;
                return;
            }
        };
        let mut worst = f64::INFINITY;
        for condition in cases.iter().flat_map(|case| &case.conditions) {
            let scale = condition.iter().fold(1.0f64, |most, term| most.max(term.abs()));
            let value = condition[count] + condition.iter().zip(&outputs).map(|(a, v)| a * v).sum::<f64>();
            worst = worst.min(value / scale);
        }
        // On a corner, the neighbouring case has the same solution.
        all.is_borderline |= worst.abs() < 1e-7 && worst < 0.0;
        let is_known = |known: &Vec<f64>| known.iter().zip(&outputs).all(|(a, b)| (a - b).abs() < 1e-6);
        if worst >= -1e-9 && !all.solutions.iter().any(is_known) {
            all.solutions.push(outputs);
        }
    }

    /// Adds two solutions if the conditions leave a range of a line.
    fn examine_line(&self, cases: &[&Case], point: &[f64], direction: &[f64], all: &mut Enumerated) {
        let count = point.len();
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        // No voltage of the machine is above 100 V. This also limits passive elements that drive themselves.
        for (volts, rate) in point.iter().zip(direction).filter(|(_, rate)| **rate != 0.0) {
            let ends = [(-100.0 - volts) / rate, (100.0 - volts) / rate];
            (low, high) = (low.max(ends[0].min(ends[1])), high.min(ends[0].max(ends[1])));
        }
        for form in cases.iter().flat_map(|case| &case.conditions) {
            let start = form[count] + form.iter().zip(point).map(|(a, v)| a * v).sum::<f64>();
            let rate = form.iter().zip(direction).map(|(a, v)| a * v).sum::<f64>();
            if rate.abs() > 1e-9 {
                let end = -start / rate;
                if rate > 0.0 { low = low.max(end) } else { high = high.min(end) }
            } else if start < -1e-9 {
                return;
            }
        }
        if high - low > 1e-6 {
            for share in [0.25, 0.75] {
                let at = low + share * (high - low);
                all.solutions.push(point.iter().zip(direction).map(|(v, d)| v + at * d).collect());
            }
        } else {
            all.is_borderline |= high - low > -1e-6;
        }
    }
}

/// The solutions of linear equations.
pub(super) enum Eliminated {
    /// One solution.
    One(Form),
    /// A point and any multiple of a direction.
    Line(Form, Form),
    /// No solution: a combination of the equations says that 0 is something else.
    Nothing,
    /// Rounding decides.
    Unknown,
}

/// The line of solutions of reduced equations in which one column is free.
fn line(rows: &[Form], solved: &[Option<usize>], free: usize) -> Eliminated {
    let count = rows.len();
    let (mut point, mut direction) = (vec![0.0; count], vec![0.0; count]);
    direction[free] = 1.0;
    for (row, column) in rows.iter().zip(solved).filter_map(|(row, column)| Some((row, (*column)?))) {
        point[column] = row[count] / row[column];
        direction[column] = -row[free] / row[column];
    }
    Eliminated::Line(point, direction)
}

/// Solves linear equations by elimination with complete pivoting. Each row has the coefficients and then the right-hand
/// side.
pub(super) fn eliminate(mut rows: Vec<Form>) -> Eliminated {
    let count = rows.len();
    for row in &mut rows {
        let scale = row[..count].iter().fold(0.0f64, |most, term| most.max(term.abs()));
        if scale > 0.0 {
            row.iter_mut().for_each(|term| *term /= scale);
        }
    }
    let mut solved = vec![None; count];
    for step in 0..count {
        let free = |column: &usize| !solved.contains(&Some(*column));
        let places = (step..count).flat_map(|row| (0..count).filter(free).map(move |column| (row, column)));
        let size = |place: &(usize, usize)| rows[place.0][place.1].abs();
        let Some((row, column)) = places.max_by(|a, b| size(a).total_cmp(&size(b))) else { break };
        let pivot = size(&(row, column));
        if pivot > 1e-13 && pivot < 1e-9 {
            return Eliminated::Unknown;
        }
        if pivot.is_nan() || pivot <= 1e-13 {
            return if rows[step..].iter().any(|row| row[count].abs() > 1e-6) {
                Eliminated::Nothing
            } else if step + 1 == count {
                line(&rows, &solved, column)
            } else {
                Eliminated::Unknown
            };
        }
        rows.swap(step, row);
        solved[step] = Some(column);
        for other in (0..count).filter(|other| *other != step) {
            let factor = rows[other][column] / rows[step][column];
            let reduced = combined(1.0, &rows[other], -factor, &rows[step]);
            rows[other] = reduced;
        }
    }
    let mut outputs = vec![0.0; count];
    for (row, column) in solved.into_iter().enumerate() {
        let column = column.expect("every row was solved");
        outputs[column] = rows[row][count] / rows[row][column];
    }
    Eliminated::One(outputs)
}
