//! The documents are correct: paths exist, patches in them are valid, generated files are up to date.

#[path = "../benches/performance/threads.rs"]
mod threads;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::common::files::assert_up_to_date;
use crate::known_problems::runs;
use patchcord::circuit::Circuit;
use patchcord::draw::plot;
use patchcord::elements::reference_page;
use patchcord::equations::{Detail, EquationListing};
use patchcord::ident::effects::{Attachment, InputRole, Library, OutputRole};
use patchcord::ir::Program;
use patchcord::patch::{Patch, Problem, json_schema};
use patchcord::solve::Backend;

pub(crate) fn documents() -> Vec<PathBuf> {
    let mut found = vec!["README.md".into(), "CONTRIBUTING.md".into(), "CHANGELOG.md".into()];
    let examples = fs::read_dir("examples").unwrap().map(|entry| entry.unwrap().path());
    for folder in examples.chain(["docs".into()]) {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        found.extend(entries.filter(|path| path.extension().is_some_and(|ending| ending == "md")));
    }
    found
}

/// Words in backquotes or link targets that look like paths of this repository.
fn paths_named(text: &str) -> Vec<String> {
    let quoted = text.split('`').skip(1).step_by(2);
    let linked = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let is_path = |word: &&str| {
        let folders =
            ["src/", "crates/", "docs/", "tests/", "patches/", "problems/", "examples/", "benches/", ".ci/"];
        folders.iter().any(|folder| word.starts_with(folder))
            || (word.ends_with(".md") && !word.contains(' '))
    };
    quoted.chain(linked).filter(is_path).filter(|word| !word.contains("NAME")).map(str::to_owned).collect()
}

#[test]
fn every_named_path_exists() {
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for path in paths_named(&text) {
            // The path is relative to the root or to the document. A section name after # is ignored.
            let path = path.split('#').next().unwrap_or_default();
            let exists = Path::new(path).exists() || document.with_file_name(path).exists();
            assert!(exists, "{} names {path}, which does not exist", document.display());
        }
    }
}

/// Constants of a table with their file: "`NAME`, `crates/core/src/solve/events.rs`".
fn constants_named(text: &str) -> Vec<(&str, &str)> {
    let words: Vec<&str> = text.split('`').collect();
    let pairs = words.windows(3).filter(|words| words[1] == ", " && words[2].ends_with(".rs"));
    let is_constant = |name: &str| {
        name.len() > 1 && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
    };
    pairs.map(|words| (words[0], words[2])).filter(|(name, _)| is_constant(name)).collect()
}

#[test]
fn every_named_constant_is_in_the_named_file() {
    let mut count = 0;
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for (name, path) in constants_named(&text) {
            let paths = [path.to_owned(), format!("crates/ident/src/{path}")];
            let source = paths.iter().find_map(|path| fs::read_to_string(path).ok()).unwrap_or_default();
            let is_defined = source.contains(&format!("const {name}: "));
            assert!(is_defined, "{}: {path} does not define {name}", document.display());
            count += 1;
        }
    }
    assert!(count >= 40, "only {count} constants are found: has the form of the tables changed?");
}

/// The Rust sources below a folder.
pub(crate) fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    files_with_endings(folder, &["rs"], found);
}

/// The files below a folder whose names have one of these endings. The packages that `npm` installs for the browser tests
/// are not ours.
pub(crate) fn files_with_endings(folder: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            if !path.ends_with("node_modules") {
                files_with_endings(&path, endings, found);
            }
        } else if path.extension().is_some_and(|ending| endings.iter().any(|known| ending == *known)) {
            found.push(path);
        }
    }
}

/// The path of a test module for the filter of `cargo test`: "cli::replay" for tests/cli/replay.rs.
fn module(package: &Path, source: &Path) -> String {
    let inside = source.strip_prefix(package).unwrap().with_extension("");
    let parts = inside.iter().skip(1).map(|part| part.to_str().unwrap());
    parts.collect::<Vec<_>>().join("::")
}

/// Whether a name in the table of CONTRIBUTING.md selects the tests of a module.
fn is_selected(name: &str, module: &str) -> bool {
    module.contains(name.trim_end_matches("::"))
}

#[test]
fn every_slow_test_is_listed() {
    let page = fs::read_to_string("CONTRIBUTING.md").unwrap();
    let (_, table) = page.split_once("| name | subject of the tests |").unwrap();
    let rows = table.lines().skip(2).take_while(|line| line.starts_with("| `"));
    let listed: Vec<&str> = rows.map(|row| row.split('`').nth(1).unwrap()).collect();
    let crates = fs::read_dir("crates").unwrap().map(|entry| entry.unwrap().path());
    let mut slow = Vec::new();
    for package in crates.chain([PathBuf::from("")]) {
        let mut found = Vec::new();
        let folders = ["src", "tests"].map(|folder| package.join(folder));
        folders.iter().filter(|folder| folder.is_dir()).for_each(|folder| sources(folder, &mut found));
        let ignored = |path: &&PathBuf| fs::read_to_string(path).unwrap().contains(concat!("#[", "ignore"));
        for source in found.iter().filter(ignored) {
            let module = module(&package, source);
            let is_listed = listed.iter().any(|name| is_selected(name, &module));
            assert!(is_listed, "CONTRIBUTING.md does not list the slow tests of {}", source.display());
            slow.push(module);
        }
    }
    assert!(slow.len() > 20, "{}", slow.len());
    for name in &listed {
        let has_tests = slow.iter().any(|module| is_selected(name, module));
        assert!(has_tests, "CONTRIBUTING.md lists {name}, which selects no slow test");
    }
}

/// The fenced JSON blocks of a document.
fn blocks(text: &str) -> impl Iterator<Item = &str> {
    text.split("```json\n").skip(1).filter_map(|rest| rest.split("```").next())
}

/// The patches among the JSON blocks. A block that names a patch is an experiment.
fn patches_shown(text: &str) -> impl Iterator<Item = &str> {
    let is_other = |block: &str| block.contains("\"patch\":") || block.contains("\"effect\":");
    blocks(text).filter(move |block| !is_other(block) && !Problem::is_problem(block))
}

#[test]
fn the_effect_of_the_page_is_valid() {
    let text = fs::read_to_string("docs/effect-format.md").unwrap();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("square-stiffness.json"), blocks(&text).next().unwrap()).unwrap();
    let library = Library::default().with_folder(folder.path()).unwrap_or_else(|error| panic!("{error}"));
    let effect = library.get("square-stiffness").unwrap();
    // Every name that the page lists is valid.
    let listed = ["sum", "own", "signal", "position", "load", "force", "next", "sample", "record"];
    assert!(effect.forms[0].reach_names().iter().all(|name| listed.contains(name)));
    assert!(listed.iter().all(|name| text.contains(&format!("`{name}`"))));
    let words =
        Attachment::ALL.iter().map(|kind| kind.word()).chain(InputRole::ALL.iter().map(|role| role.word()));
    for word in words.chain(OutputRole::ALL.iter().map(|role| role.word())) {
        assert!(text.contains(&format!("`{word}`")), "{word}");
    }
}

#[test]
fn every_patch_in_a_document_is_valid() {
    let mut shown = 0;
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for block in patches_shown(&text) {
            let name = document.display().to_string();
            let patch = Patch::parse(&name, block).unwrap_or_else(|report| panic!("{report}"));
            let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
            assert_eq!(circuit.warnings().to_string(), "", "{name}");
            Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
            shown += 1;
        }
    }
    assert!(shown >= 2);
}

#[test]
fn every_problem_in_a_document_is_valid() {
    let mut shown = 0;
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for block in blocks(&text).filter(|block| Problem::is_problem(block)) {
            let name = document.display().to_string();
            let problem = Problem::parse(&name, block).unwrap_or_else(|report| panic!("{report}"));
            let circuit = Circuit::new(&problem.patch).unwrap_or_else(|report| panic!("{report}"));
            assert_eq!(circuit.warnings().to_string(), "", "{name}");
            shown += 1;
        }
    }
    assert!(shown >= 1);
}

/// The keys that a section of a page lists in the first column of its table.
fn keys_listed<'p>(page: &'p str, heading: &str) -> Vec<&'p str> {
    let (_, section) = page.split_once(&format!("\n## {heading}\n")).expect("the page has the heading");
    let section = section.split("\n## ").next().unwrap_or_default();
    let cells = section.lines().filter_map(|line| line.strip_prefix("| `")?.split_once(" |"));
    cells.flat_map(|(keys, _)| keys.split('`').step_by(2)).collect()
}

/// A problem with an unknown key in a quantity and in a table. The hints about them list the known keys.
const UNKNOWN_KEYS: &str = r#"{"patchcord": 1,
    "quantities": {"x": {"unit": "1", "colour": 0}},
    "tables": {"f": {"in": "1", "out": "1", "points": [[0, 0], [1, 1]], "colour": 0}},
    "equations": ["x' = f(x)"], "run": {"for": 1, "step": 0.01}}"#;

#[test]
fn the_page_of_problems_lists_the_keys_of_quantities_and_tables() {
    let page = fs::read_to_string("docs/problem-format.md").unwrap();
    let problem = Problem::parse("p.json", UNKNOWN_KEYS).unwrap_or_else(|report| panic!("{report}"));
    let report = Circuit::new(&problem.patch).unwrap_err();
    assert_eq!(report.findings.len(), 2, "{report}");
    for (finding, heading) in report.findings.iter().zip(["Quantities", "Tables"]) {
        let known = finding.advice().strip_prefix("known here: ").expect("the hint lists the keys");
        let expected: Vec<&str> = known.split(", ").filter(|key| *key != "note").collect();
        assert_eq!(keys_listed(&page, heading), expected);
    }
}

#[test]
fn the_schema_is_up_to_date() {
    assert_up_to_date("docs/patch.schema.json", format!("{:#}\n", json_schema()).as_bytes(), "patchcord");
}

#[test]
fn the_page_of_elements_is_up_to_date() {
    assert_up_to_date("docs/elements.md", reference_page().as_bytes(), "patchcord");
}

/// The heading after which a page is generated.
const GENERATED_EQUATIONS: &str = "## The equations of the shipped patches\n";

#[test]
fn the_page_of_equations_is_up_to_date() {
    let page = fs::read_to_string("docs/equations.md").unwrap();
    let (written, _) = page.split_once(GENERATED_EQUATIONS).expect("the page has the heading");
    let mut fresh = format!("{written}{GENERATED_EQUATIONS}");
    let root = crate::common::files::repository_path("");
    for file in crate::common::files::shipped_files() {
        let circuit = crate::common::circuit(&crate::common::patch_of(&file), &[]);
        let program = Program::new(&circuit).unwrap();
        let listing = EquationListing::new(&circuit, &program, Detail::Signals);
        let text = listing.text();
        let title = &circuit.patch().title;
        fresh += &format!(
            "\n### {}\n\n{title}.\n\n```text\n{text}```\n",
            file.strip_prefix(&root).unwrap().display()
        );
    }
    assert_up_to_date("docs/equations.md", fresh.as_bytes(), "patchcord");
}

#[test]
fn the_picture_of_all_symbols_is_up_to_date() {
    let path = "docs/pictures/symbols.svg";
    let drawing = patchcord::draw::schematic::legend();
    let fresh = plot::render_drawing(&drawing, plot::Format::Svg, plot::Theme::Light).unwrap();
    assert_up_to_date(path, &fresh, "patchcord");
}

/// The first and the last cell of every row of a page's tables.
fn rows(page: &str) -> BTreeMap<String, String> {
    let text = fs::read_to_string(page).unwrap();
    let cells = text.lines().filter_map(|line| line.strip_prefix("| ")?.strip_suffix(" |"));
    let pairs = cells.filter_map(|cells| Some((cells.split_once(" | ")?.0, cells.rsplit_once(" | ")?.1)));
    pairs.map(|(first, last)| (first.to_owned(), last.to_owned())).collect()
}

#[test]
fn the_comparison_quotes_the_measured_numbers() {
    let measured = rows("docs/hidden-effects.md");
    let text = fs::read_to_string("docs/side-by-side.md").unwrap();
    let (_, table) = text.split_once("| measure | pysindy | patchcord |\n|---|---|---|\n").unwrap();
    let compared = table.lines().take_while(|line| line.starts_with("| "));
    let mut count = 0;
    for line in compared {
        let cells: Vec<_> = line.trim_matches(['|', ' ']).split(" | ").collect();
        assert_eq!(measured.get(cells[0]).map(String::as_str), Some(cells[2]), "{}", cells[0]);
        count += 1;
    }
    assert!(count >= 10);
}

/// The success rates on the page of hidden effects are within these limits, in percent.
#[test]
fn the_success_rates_of_the_search_are_within_limits() {
    let page = rows("docs/hidden-effects.md");
    let limits = [
        ("right name, gap over noise above 3", [90.0, 100.0]),
        ("right name, gap over noise 1 ... 3", [80.0, 100.0]),
        ("right name, gap over noise 0.3 ... 1", [50.0, 100.0]),
        ("both of a pair named, gap over noise above 3", [60.0, 100.0]),
        ("wrong name, aliases merged", [0.0, 2.0]),
        ("false alarm when nothing is missing", [0.0, 1.0]),
        ("unknown effect called by a library name", [0.0, 10.0]),
        ("named at the right place", [98.0, 100.0]),
        ("the same where the library's law is hidden: within 10 %", [90.0, 100.0]),
        ("the same where the library's law is hidden: the true value in the interval of 95 %", [90.0, 98.0]),
        ("data held back, after naming: within 10 % of what the true laws leave", [90.0, 100.0]),
    ];
    for (what, [least, most]) in limits {
        let rate: f64 = page[what].split_once(" %").unwrap().0.parse().unwrap();
        assert!((least..=most).contains(&rate), "{what}: {}", page[what]);
    }
}

#[test]
fn the_counts_of_the_page_match_the_list_of_cases() {
    let list = fs::read_to_string("docs/hidden-effects.jsonl").unwrap();
    let cases: Vec<Value> = list.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let page = rows("docs/hidden-effects.md");
    let counts = |what: &str, those: &dyn Fn(&&Value) -> bool, is: &dyn Fn(&&Value) -> bool| {
        let all: Vec<&Value> = cases.iter().filter(those).collect();
        let (all, count) = (all.len(), all.into_iter().filter(is).count());
        assert!(
            page[what].contains(&format!("({count} of {all})")),
            "{what}: {}, not {count} of {all}",
            page[what]
        );
    };
    let hides = |case: &&Value, begins: &str| case["hidden"].as_str().unwrap().starts_with(begins);
    let is = |wanted: &'static str| move |case: &&Value| case["judgement"] == wanted;
    counts("false alarm when nothing is missing", &|case| hides(case, "none"), &is("false alarm"));
    counts("unknown effect called by a library name", &|case| hides(case, "unknown:"), &is("wrong name"));
    let is_pair = |case: &&Value| {
        case["hidden"].as_str().unwrap().contains('+') && case["gap_over_noise"].as_f64().unwrap() > 3.0
    };
    counts("both of a pair named, gap over noise above 3", &is_pair, &is("right"));
    assert!(cases.len() >= 100, "{}", cases.len());
}

/// A table of docs/performance.md.
fn measured<'p>(page: &'p str, name: &str) -> &'p str {
    let begun = page.split_once(&format!("<!-- {name} -->\n")).unwrap_or_else(|| panic!("no table {name}")).1;
    begun.split_once("<!-- end").unwrap().0
}

#[test]
fn every_backend_and_every_problem_is_measured() {
    let page = fs::read_to_string("docs/performance.md").unwrap();
    let check = |name: &str, backends: &[Backend]| {
        for backend in backends {
            let is_listed = measured(&page, name).contains(&backend.to_string());
            assert!(is_listed, "the table {name} does not list {backend}");
        }
    };
    // A single run uses no lanes, and the automatic backend selects one of the others.
    for name in ["whole", "accuracy", "elements", "record", "problems"] {
        check(name, &[Backend::Reference, Backend::Interpreter, Backend::Native]);
    }
    check("sweep", &Backend::ALL);
    check("lanes", &[Backend::Lanes, Backend::Automatic]);
    for problem in crate::known_problems::all() {
        let row = format!("\n| {} |", problem.name);
        assert!(measured(&page, "problems").contains(&row), "{} is not measured", problem.name);
    }
}

#[test]
fn sweeps_are_measured_with_every_number_of_threads() {
    let series: [&[usize]; 5] = [&[1], &[1, 2], &[1, 2, 3], &[1, 2, 4], &[1, 2, 4, 6]];
    for (cores, tried) in [1, 2, 3, 4, 6].into_iter().zip(series) {
        assert_eq!(threads::up_to(cores), tried);
    }
    let page = fs::read_to_string("docs/performance.md").unwrap();
    let machine = measured(&page, "machine").split_once(" cores; ").unwrap().0;
    let cores = machine.rsplit(' ').next().unwrap().parse().unwrap();
    for threads in threads::up_to(cores) {
        for backend in Backend::ALL {
            let row = format!("\n| patchcord, {backend}, {threads} thread");
            assert!(
                measured(&page, "sweep").contains(&row),
                "{backend} is not measured on {threads} threads"
            );
        }
    }
}

/// Trial steps per located crossing and their share of all evaluations in percent, for the first 2 s of Fig 8.16.
fn tried(tolerance: f64) -> [f64; 2] {
    let circuit = runs::circuit("thesis/fig-8-16", &[]);
    let settings = runs::settings(&circuit).with_duration(2.0).with_tolerance(tolerance);
    let work = runs::run_circuit(&circuit, &settings).repetitions[0].work;
    let [all, steps, crossings] =
        [work.evaluations, work.steps + work.rejections, work.crossings + work.changes].map(|n| n as f64);
    let tried = all - 6.0 * steps;
    [tried / 6.0 / crossings, 100.0 * tried / all]
}

#[test]
fn the_page_states_the_cost_of_crossings() {
    let [[steps, coarse], [same, fine]] = [1e-5, 1e-9].map(tried);
    assert_eq!(steps.round(), same.round());
    let sentence = format!(
        "each crossing takes {steps:.0} steps: {coarse:.0} % of all evaluations with a tolerance of 1e-5, {fine:.0} % with 1e-9."
    );
    let page = fs::read_to_string("docs/solver.md").unwrap();
    let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(page.contains(&sentence), "docs/solver.md lacks the sentence: {sentence}");
}
