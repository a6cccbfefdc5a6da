//! A virtual analogue computer: patch it, run it, read it, and find what it lacks.
//!
//! This page is a tutorial. It takes ten minutes and goes from a patch to a run, from equations to a patch, from a run
//! to readings and pictures, from one run to many, and from measured data to the effect that a model lacks.
//!
//! # Run a patch
//!
//! A patch is a JSON document. Five types follow each other, and one function leads from each to the next:
//! [`Patch`] (the document), [`Circuit`] (checked, with parameter values), [`Program`] (compiled),
//! [`Machine`] (running) and [`Trace`] (recorded). [`run`] makes the last two steps.
//!
//! ```
//! use patchcord::{Circuit, Patch, Program, RunSettings, run};
//!
//! # fn main() -> Result<(), patchcord::Error> {
//! let patch = Patch::read("patches/lessons/mass-and-spring.json")?;
//! let circuit = Circuit::with_parameters(&patch, [("m", 4.0)])?;
//! let program = Program::new(&circuit)?;
//! let settings = RunSettings::of(&circuit)?.with_duration(2.0);
//! let trace = run(&program, &settings)?;
//!
//! if let Some(position) = trace.track("x") {
//!     assert_eq!(position.unit, "mm");
//!     assert_eq!(position.values().len(), trace.time.len());
//! }
//! # Ok(())
//! # }
//! ```
//!
//! If a patch is wrong, the error is a [`Report`](document::Report) with every fault, its position and a hint:
//!
//! ```
//! use patchcord::{Circuit, Patch};
//!
//! let patch: Patch = r#"{"patchcord": 1, "elements": {"A1": {"kind": "integrator", "in": {"x1": ["A7"]}}}}"#.parse()?;
//! if let Err(report) = Circuit::new(&patch) {
//!     assert_eq!(report.error_count(), 1);
//!     assert!(report.to_string().contains("A7"));
//! }
//! # Ok::<(), patchcord::Error>(())
//! ```
//!
//! # Build a patch in Rust
//!
//! [`PatchBuilder`](patch::PatchBuilder) makes the same document without a file:
//!
//! ```
//! use patchcord::patch::{ElementBuilder, PatchBuilder};
//! use patchcord::{Circuit, Program, RunSettings, run};
//!
//! # fn main() -> Result<(), patchcord::Error> {
//! // dx/dt = -x, from x = 50 V
//! let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
//! let patch = PatchBuilder::new("Decay").element("A1", decay).run(1.0, 1e-3).record(["A1"]).build()?;
//! let circuit = Circuit::new(&patch)?;
//! let trace = run(&Program::new(&circuit)?, &RunSettings::of(&circuit)?)?;
//! let last = trace.track("A1").and_then(|track| track.values().last());
//! assert!(last.is_some_and(|volts| (volts - 50.0 * (-1.0f64).exp()).abs() < 1e-9));
//! # Ok(())
//! # }
//! ```
//!
//! # Make a patch from equations
//!
//! A problem states equations with numbers and units. [`equations::scale_problem`] makes a patch from it, with scales,
//! gains and pots. [`equations::EquationListing`] reads the equations back from the wiring:
//!
//! ```
//! use patchcord::equations::{Detail, EquationListing, ScaleOptions, scale_problem};
//! use patchcord::patch::Problem;
//! use patchcord::{Circuit, Program};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let problem = Problem::read("problems/van-der-pol.json")?;
//! let scaled = scale_problem(&problem, &ScaleOptions::default())?;
//! assert!(scaled.quantities.iter().all(|quantity| (50.0..=95.0).contains(&quantity.peak)));
//!
//! let circuit = Circuit::new(&scaled.patch)?;
//! let listing = EquationListing::new(&circuit, &Program::new(&circuit)?, Detail::Signals);
//! let equations: Vec<String> = listing.equations.iter().map(|equation| equation.text()).collect();
//! assert_eq!(equations, ["x' = x_dot", "x_dot' = mu (1 - x^2) x_dot - x"]);
//! # Ok(())
//! # }
//! ```
//!
//! # Read and draw a run
//!
//! [`instruments`] read quantities from a trace, and [`draw`] makes pictures:
//!
//! ```
//! use patchcord::draw::plot::{Format, Size, render};
//! use patchcord::{Circuit, Patch, Program, RunSettings, draw, instruments, run};
//!
//! # fn main() -> Result<(), patchcord::Error> {
//! let patch = Patch::read("patches/lessons/mass-and-spring.json")?;
//! let circuit = Circuit::new(&patch)?;
//! let trace = run(&Program::new(&circuit)?, &RunSettings::of(&circuit)?)?;
//!
//! let readings = instruments::readings(&trace);
//! let position = readings.iter().find(|reading| reading.signal == "x");
//! assert!(position.is_some_and(|reading| reading.least.value < 0.0 && reading.most.value > 0.0));
//!
//! let specs = circuit.picture_specs(["x"]);
//! let picture = draw::picture(&trace, &specs[0], None, &[])?;
//! let svg = render(&[picture], Format::Svg, Size::default())?;
//! assert!(svg.starts_with(b"<?xml"));
//! # Ok(())
//! # }
//! ```
//!
//! # Run it many times
//!
//! A [`sweep`] runs a program for many parameter values and computes measures of each run. It continues an interrupted
//! file, and its rows do not depend on the number of threads.
//!
//! ```
//! use patchcord::instruments::Measure;
//! use patchcord::sweep::{Axis, Plan, Sweep};
//! use patchcord::{Circuit, Patch, Program, RunSettings};
//!
//! # fn main() -> Result<(), patchcord::Error> {
//! let patch = Patch::read("patches/lessons/mass-and-spring.json")?;
//! let circuit = Circuit::new(&patch)?;
//! let program = Program::new(&circuit)?;
//! let plan = Plan::new([Axis::parse("k=20:80:4")?], &program)?;
//! let measure = Measure::parse("frequency:x", program.signals())?;
//! let settings = RunSettings::of(&circuit)?.with_duration(5.0);
//! let sweep = Sweep::new(&patch, program, settings, plan, [measure])?;
//! let mut csv = Vec::new();
//! sweep.write(&mut csv, 2, &mut |_| ())?;
//! let rows = csv.split(|byte| *byte == b'\n').filter(|line| !line.is_empty() && line[0] != b'#');
//! assert_eq!(rows.count(), 1 + 4);
//! # Ok(())
//! # }
//! ```
//!
//! # Find what a model lacks
//!
//! [`ident`] fits a patch to measured data and searches for the effect that explains the rest. An
//! [`Experiment`] names the patch, the data and the parameters to fit.
//!
//! ```no_run
//! use patchcord::ident::Report;
//! use patchcord::{Experiment, Library, Problem, SearchSettings, search};
//!
//! # fn main() -> Result<(), patchcord::Error> {
//! let experiment = Experiment::read("examples/05_missing_effect/spring.experiment.json")?;
//! let problem = Problem::of(&experiment)?;
//! let library = Library::shipped();
//! if let Some(outcome) = search(&experiment, &problem, &SearchSettings::new(&library), |_| ())? {
//!     // "...: viscous-friction at A1 is missing", after about 5 seconds
//!     println!("{}", Report::new(&experiment, &problem, &outcome).sentence());
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Where to look next
//!
//! * The formats of patches, problems and experiments: `docs/patch-format.md`, `docs/problem-format.md` and `docs/gap.md`.
//! * Programs to copy from: `examples`.
//! * How it works: `docs/architecture.md`.
//!
//! # Features
//!
//! * `native` (default): long runs are compiled to native code. Without it every run is interpreted, with
//!   bit-identical results.
//! * `cli` (default): builds the command `patchcord`. A program that uses only the library can switch it off.
//! * `panel` (default): adds the command `patchcord panel`, the front panel in a browser.

#![forbid(unsafe_code)]

mod error;

pub use error::Error;
pub use patchcord_analysis::{format, instruments, linear, sweep};
pub use patchcord_core::circuit::Circuit;
pub use patchcord_core::ir::Program;
pub use patchcord_core::patch::Patch;
pub use patchcord_core::solve::{Machine, RunSettings, run};
pub use patchcord_core::trace::Trace;
pub use patchcord_core::{circuit, document, elements, ir, machines, output, patch, solve, trace};
pub use patchcord_draw as draw;
pub use patchcord_equations as equations;
pub use patchcord_expr as expr;
pub use patchcord_ident as ident;
pub use patchcord_ident::{Experiment, Library, Outcome, Problem, SearchSettings, search};
pub use patchcord_thesis as thesis;
