//! Resolves the signals of a patch: the outputs that can be recorded, the recorded ones, and those in pictures.
//!
//! Signals, drives and elements can all be recorded. A name is first looked up among the signals.
//!
//! A name in a picture can also be the time "t", or the derivative of a signal with respect to a parameter. The methods
//! of [`Circuit`] for signals and pictures are at the end.

use std::collections::{BTreeSet, HashMap, HashSet};

use indexmap::IndexSet;

use super::names::{found_or_report, output_names};
use super::resolve::{Graph, find_scale};
use super::{Circuit, SignalPoint};
use crate::document::{Code, Diagnostic, Placed, Span, derivative_of, derivative_unit};
use crate::elements::Family;
use crate::patch::{Patch, PictureSpec};

/// Everything that can be recorded, and the indices of the signals that the patch records.
///
/// The order is: signals of the patch, drives, elements. Reports unknown names and pictures with more than two units.
pub(super) fn resolve(
    patch: &Patch,
    graph: &Graph,
    findings: &mut Vec<Diagnostic>,
) -> (Vec<SignalPoint>, Vec<usize>) {
    let indices: HashMap<&str, usize> =
        graph.node_indices().map(|index| (graph[index].name.as_str(), index.index())).collect();
    let mut points = Vec::new();
    for (name, signal) in &patch.signals {
        let message = || format!("there is no element {} for the signal", signal.element.value);
        let found = indices.get(signal.element.value.as_str()).copied();
        let known = || output_names(patch, &indices);
        let element = found_or_report(patch, &signal.element, found, message, known, findings);
        let scale = signal.scale.as_ref().and_then(|scale| find_scale(patch, scale, findings));
        if let Some(element) = element {
            points.push(SignalPoint { name: name.clone(), element, scale, factor: signal.factor });
        }
    }
    for index in graph.node_indices() {
        let element = &graph[index];
        if element.kind.family != Family::Reference {
            points.push(SignalPoint {
                name: element.name.clone(),
                element: index.index(),
                scale: element.scale,
                factor: 1.0,
            });
        }
    }
    let recordable = Recordable::new(patch, &points);
    let record = recordable.record(findings);
    recordable.pictures(findings);
    (points, record)
}

/// What people write in a picture for the time "t", in lower case.
const TIME_WORDS: [&str; 5] = ["t", "time", "sec", "second", "seconds"];

/// Everything that can be recorded and drawn, by name.
struct Recordable<'a> {
    /// The patch, for its signals, record and pictures.
    patch: &'a Patch,
    /// Everything that can be recorded, in the order of [`resolve`].
    points: &'a [SignalPoint],
    /// Index of the first point with each name.
    indices: HashMap<&'a str, usize>,
}

impl<'a> Recordable<'a> {
    /// Indexes the points by name. A signal precedes an element of the same name, so it counts.
    fn new(patch: &'a Patch, points: &'a [SignalPoint]) -> Self {
        let mut indices = HashMap::new();
        for (index, point) in points.iter().enumerate() {
            indices.entry(point.name.as_str()).or_insert(index);
        }
        Recordable { patch, points, indices }
    }

    /// The index of the point with a name. Reports an unknown name.
    fn find(&self, name: &Placed<String>, findings: &mut Vec<Diagnostic>) -> Option<usize> {
        let found = self.indices.get(name.value.as_str()).copied();
        if found.is_none() && self.patch.signals.contains_key(&name.value) {
            // The signal has a fault that was reported.
            return None;
        }
        let message = || format!("there is no signal {}", name.value);
        let known = || self.points.iter().map(|point| point.name.as_str()).collect();
        found_or_report(self.patch, name, found, message, known, findings)
    }

    /// The indices of the recorded points. Without a list in the patch these are all signals, or if there are none, all
    /// drives and elements.
    ///
    /// Reports unknown names and names that are listed twice. Warns of a name that has no scale, because volts are
    /// rarely the quantity that the reader wants.
    fn record(&self, findings: &mut Vec<Diagnostic>) -> Vec<usize> {
        if self.patch.record.is_empty() {
            let (named, all) = (self.patch.signals.len(), self.points.len());
            return if named > 0 { (0..named.min(all)).collect() } else { (0..all).collect() };
        }
        let mut record = IndexSet::new();
        for name in &self.patch.record {
            let Some(point) = self.find(name, findings) else { continue };
            if !record.insert(point) {
                let message = format!("{} is recorded twice", name.value);
                findings.push(Diagnostic::at(Code::DUPLICATE_NAME, name.span, message));
            } else if self.is_in_volts(point, &name.value) {
                let message = format!("{} has no scale and is recorded in volts", name.value);
                let hint = "define a signal at it, with a scale";
                findings.push(Diagnostic::at(Code::UNSCALED_SIGNAL, name.span, message).hint(hint));
            }
        }
        record.into_iter().collect()
    }

    /// Whether a point has no scale. A scale that is named but does not exist was reported, so it counts as a scale.
    ///
    /// Drives always have a scale, so they never count as points in volts.
    fn is_in_volts(&self, point: usize, name: &str) -> bool {
        let names_scale = self.patch.signals.get(name).is_some_and(|signal| signal.scale.is_some());
        self.points[point].scale.is_none() && !names_scale && !self.patch.drives.contains_key(name)
    }

    /// Reports signals that a picture draws twice, and pictures with more than two units: a picture has a left and a
    /// right axis.
    fn pictures(&self, findings: &mut Vec<Diagnostic>) {
        for picture in &self.patch.pictures {
            report_repeated(&picture.y, findings);
            self.drawn_unit(&picture.x, findings);
            let drawn = picture.y.iter().filter_map(|name| self.drawn_unit(name, findings));
            let units: BTreeSet<String> = drawn.collect();
            if units.len() > 2 {
                let list: Vec<_> = units.iter().map(String::as_str).collect();
                let (count, list) = (units.len(), list.join(", "));
                let message = format!("the picture has {count} units ({list}), but only two axes");
                let hint = "draw a second picture";
                findings.push(Diagnostic::at(Code::UNIT_MISMATCH, picture.y[0].span, message).hint(hint));
            }
        }
    }

    /// The unit of a name in a picture: time, a signal, or the derivative of a signal with respect to a parameter.
    ///
    /// `None` if the name is unknown, which is reported.
    fn drawn_unit(&self, name: &Placed<String>, findings: &mut Vec<Diagnostic>) -> Option<String> {
        if name.value == "t" {
            return Some("s".to_owned());
        }
        if self.is_meant_as_time(&name.value) {
            let message = format!("there is no signal {}", name.value);
            let hint = "write \"t\" for the time";
            findings.push(Diagnostic::at(Code::UNKNOWN_NAME, name.span, message).hint(hint));
            return None;
        }
        let Some((signal, parameter)) = derivative_of(&name.value) else {
            return self.signal_unit(name, findings);
        };
        let placed = |value: &str| Placed { value: value.to_owned(), span: name.span };
        let signal_unit = self.signal_unit(&placed(signal), findings);
        let parameter_unit = self.parameter_unit(&placed(parameter), findings);
        Some(derivative_unit(&signal_unit?, parameter_unit?))
    }

    /// Whether a name that nothing has is another word for the time.
    fn is_meant_as_time(&self, name: &str) -> bool {
        let is_known = self.indices.contains_key(name) || self.patch.signals.contains_key(name);
        !is_known
            && !self.patch.unread_names().can_include(name)
            && TIME_WORDS.contains(&name.to_lowercase().as_str())
    }

    /// Text of a signal's unit.
    fn signal_unit(&self, signal: &Placed<String>, findings: &mut Vec<Diagnostic>) -> Option<String> {
        let point = &self.points[self.find(signal, findings)?];
        Some(point.scale.map_or("V", |scale| self.patch.scales[scale].unit.text()).to_owned())
    }

    /// Text of a parameter's unit.
    fn parameter_unit(&self, name: &Placed<String>, findings: &mut Vec<Diagnostic>) -> Option<&str> {
        let found = self.patch.parameters.get(&name.value).map(|parameter| parameter.unit.text());
        let message = || format!("there is no parameter {}", name.value);
        let known = || self.patch.parameters.keys().map(String::as_str).collect();
        found_or_report(self.patch, name, found, message, known, findings)
    }
}

/// Reports every name that a picture draws more than once.
fn report_repeated(names: &[Placed<String>], findings: &mut Vec<Diagnostic>) {
    let mut drawn = HashSet::new();
    for name in names.iter().filter(|name| !drawn.insert(name.value.as_str())) {
        let message = format!("the picture shows {} twice", name.value);
        findings.push(Diagnostic::at(Code::DUPLICATE_NAME, name.span, message).hint("remove one of the two"));
    }
}

impl Circuit {
    /// Everything that can be recorded: the signals of the patch, then the drives, then the elements.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("decay")
    ///     .scale("position", 2.0, "mm")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1"]))
    ///     .signal("x", "A1", "position", 1.0)
    ///     .build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let names: Vec<_> = circuit.signals().iter().map(|signal| signal.name.as_str()).collect();
    /// assert_eq!(names, ["x", "A1"]);
    /// assert_eq!(circuit.recorded_signals(), ["x"]);
    /// # Ok(())
    /// # }
    /// ```
    pub fn signals(&self) -> &[SignalPoint] {
        &self.signals
    }

    /// The name under which a signal is recorded. The output of a macro's instance has the name of its element inside.
    ///
    /// `None` if nothing of this name can be recorded.
    pub fn recorded_name<'n>(&'n self, name: &'n str) -> Option<&'n str> {
        let is_signal = |name: &str| self.signals.iter().any(|point| point.name == name);
        let element_inside = || self.patch.instance_outputs.get(name).map(|output| output.element.as_str());
        is_signal(name).then_some(name).or_else(element_inside)
    }

    /// Names of the signals that the patch records or draws, without repetitions. The recorded ones come first.
    pub fn recorded_signals(&self) -> Vec<String> {
        let recorded = self.record.iter().map(|index| self.signals[*index].name.clone());
        recorded.chain(self.drawn_signals()).collect::<IndexSet<_>>().into_iter().collect()
    }

    /// Names of the signals that the pictures of the patch show, or whose derivatives they show. Names may be repeated.
    pub fn drawn_signals(&self) -> impl Iterator<Item = String> + '_ {
        let signal = |name: &str| derivative_of(name).map_or(name, |(signal, _)| signal).to_owned();
        self.drawn_names().filter(|name| *name != "t").map(signal)
    }

    /// The signals of the curves of one signal against another one that the pictures show, for
    /// [`RunSettings::with_curves`](crate::solve::RunSettings::with_curves): to the right and upwards, without
    /// repetitions. Curves of derivatives are not among them.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("two decays")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50))
    ///     .element("A2", ElementBuilder::new("integrator").cords("x10", ["A2"]).set("initial", 50))
    ///     .picture("", "A1", ["A2"])
    ///     .picture("", "t", ["A1"])
    ///     .build()?;
    /// let curves = Circuit::new(&patch)?.drawn_curves();
    /// assert_eq!(curves, [("A1".to_owned(), "A2".to_owned())]);
    /// # Ok(())
    /// # }
    /// ```
    pub fn drawn_curves(&self) -> Vec<(String, String)> {
        let is_signal = |name: &&str| *name != "t" && derivative_of(name).is_none();
        let curves = self.patch.pictures.iter().flat_map(|picture| {
            let x = Some(picture.x.value.as_str()).filter(is_signal);
            let y = picture.y.iter().map(|name| name.value.as_str()).filter(is_signal);
            x.into_iter().flat_map(move |x| y.clone().map(move |y| (x.to_owned(), y.to_owned())))
        });
        curves.collect::<IndexSet<_>>().into_iter().collect()
    }

    /// Names of the parameters with respect to which the pictures show derivatives, without repetitions.
    pub fn sensitivity_parameters(&self) -> Vec<String> {
        let parameters = self.drawn_names().filter_map(|name| Some(derivative_of(name)?.1.to_owned()));
        parameters.collect::<IndexSet<_>>().into_iter().collect()
    }

    /// All names on the axes of the pictures: signals, derivatives and the time "t".
    fn drawn_names(&self) -> impl Iterator<Item = &str> {
        let names = self.patch.pictures.iter().flat_map(|picture| picture.y.iter().chain([&picture.x]));
        names.map(|name| name.value.as_str())
    }

    /// Unit of a signal: its text, and its size in SI units.
    pub(crate) fn signal_unit(&self, signal: &SignalPoint) -> (String, f64) {
        match signal.scale {
            Some(scale) => {
                let unit = self.derived_unit(scale);
                (unit.text().to_owned(), unit.factor())
            }
            None => ("V".to_owned(), 1.0),
        }
    }

    /// The pictures of the patch. If it has none, one picture for each of these signals against time.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let summer = ElementBuilder::new("summer").cords("x1", ["+100"]);
    /// let circuit = Circuit::new(&PatchBuilder::new("sum").element("A1", summer).build()?)?;
    /// let pictures = circuit.picture_specs(["A1"]);
    /// assert_eq!((pictures[0].x.value.as_str(), pictures[0].y[0].value.as_str()), ("t", "A1"));
    /// # Ok(())
    /// # }
    /// ```
    pub fn picture_specs(&self, recorded: impl IntoIterator<Item = impl AsRef<str>>) -> Vec<PictureSpec> {
        if !self.patch.pictures.is_empty() {
            return self.patch.pictures.clone();
        }
        let placed = |name: &str| Placed { value: name.to_owned(), span: Span::default() };
        let against_time = |name: &str| PictureSpec {
            title: String::new(),
            x: placed("t"),
            y: vec![placed(name)],
            equal_scales: true,
        };
        recorded.into_iter().map(|name| against_time(name.as_ref())).collect()
    }
}
