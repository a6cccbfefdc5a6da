//! Runs every problem with a known solution with equal steps and with a tolerance, and checks docs/problems.md.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fs;

use crate::common::pages::assert_part_up_to_date;
use crate::common::{convergence_order, files};
use crate::known_problems::equations::Equations;
use crate::known_problems::{ErrorSource, Problem, Solution, closed_form, lessons, others, thesis};
use patchcord_core::solve::Backend;

/// Tolerances of the adaptive runs, in machine units.
const TOLERANCES: [f64; 4] = [1e-5, 1e-6, 1e-7, 1e-8];

#[test]
fn equal_steps_are_within_the_error_bound_on_every_backend() {
    for problem in crate::known_problems::all() {
        let prepared = problem.prepare();
        for backend in Backend::ALL {
            let error = prepared.error(&prepared.settings.clone().with_backend(backend));
            assert!(error < problem.max_error, "{}, {backend}: {error:e}", problem.name);
        }
    }
}

#[test]
fn the_error_is_proportional_to_the_fourth_power_of_the_step() {
    for problem in crate::known_problems::all().filter(|problem| problem.error_source == ErrorSource::Step) {
        let prepared = problem.prepare();
        let steps = [8.0, 4.0, 2.0, 1.0].map(|factor| factor * problem.step_factor * prepared.settings.step);
        let errors = steps.map(|step| prepared.error(&prepared.settings.clone().with_step(step)));
        let observed = convergence_order(&steps, &errors);
        assert!((3.9..=4.1).contains(&observed), "{}: order {observed} from {errors:?}", problem.name);
    }
}

#[test]
fn adaptive_runs_keep_their_tolerance() {
    for problem in crate::known_problems::all() {
        let prepared = problem.prepare();
        let permitted =
            if problem.error_source == ErrorSource::Amplification { problem.max_error } else { 0.0 };
        for tolerance in TOLERANCES {
            let error = prepared.error(&prepared.settings.clone().with_tolerance(tolerance));
            assert!(error < tolerance + permitted, "{}: {error:e} at {tolerance:e}", problem.name);
        }
    }
}

/// The patches of patches/measured are excluded: crates/ident/tests/measured.rs compares them with their equations.
#[test]
fn every_shipped_patch_is_a_problem() {
    for file in
        files::shipped_files().iter().filter(|file| !file.parent().unwrap().ends_with("patches/measured"))
    {
        let uses_file = |problem: &Problem| file.ends_with(format!("patches/{}.json", problem.patch));
        assert!(crate::known_problems::all().any(uses_file), "no problem uses {}", file.display());
    }
}

/// The text of docs/problems.md.
fn page() -> String {
    fs::read_to_string("../../docs/problems.md").unwrap()
}

#[test]
fn the_page_has_a_section_for_every_closed_form_problem() {
    let page = page();
    let headings: Vec<_> = page.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    let sections = closed_form::PROBLEMS.iter().map(|problem| problem.name).chain([
        "Lessons",
        "Circuits of the thesis",
        "Circuits of others",
    ]);
    assert_eq!(headings, sections.collect::<Vec<_>>());
    for (problem, section) in closed_form::PROBLEMS.iter().zip(page.split("\n## ").skip(1)) {
        let required = [format!("`patches/{}.json`", problem.patch), format!("signal `{}`", problem.signal)];
        for words in required {
            assert!(section.contains(&words), "the section {} does not contain {words}", problem.name);
        }
    }
}

/// The generated table of problems without a section. `link` gives the page that describes a problem.
fn table(problems: &[Problem], link: impl Fn(&Problem) -> String) -> String {
    let row = |problem: &Problem| {
        let changes = problem.changes.iter().map(|(name, value)| format!("{name} = {value}"));
        let solution = match problem.solution {
            Solution::ClosedForm(_) => "closed form",
            Solution::Integrated(_) => "integrated equations",
        };
        let error_source = match problem.error_source {
            ErrorSource::Step => "step, order 4",
            ErrorSource::Rounding => "rounding",
            ErrorSource::Amplification => "finite amplification",
        };
        let cells = [
            format!("[{}]({})", problem.name, link(problem)),
            changes.collect::<Vec<_>>().join(", "),
            format!("`{}`", problem.signal),
            format!("{} s", problem.duration),
            solution.to_owned(),
            format!("{:e} s", problem.prepare().settings.step),
            format!("{:e}", problem.max_error),
            error_source.to_owned(),
        ];
        format!("| {} |\n", cells.join(" | "))
    };
    let head = "| problem | changed parameters | signal | duration | solution | step | error below | error source |\n";
    format!("{head}{}|\n{}", "|---".repeat(8), problems.iter().map(row).collect::<String>())
}

#[test]
fn the_tables_of_lessons_and_circuits_are_up_to_date() {
    let lesson_link = |problem: &Problem| format!("lessons.md#{}", problem.name);
    let circuit_link = |problem: &Problem| format!("../patches/{}.json", problem.patch);
    assert_part_up_to_date(
        "docs/problems.md",
        "lessons",
        &table(&lessons::PROBLEMS, lesson_link),
        "patchcord-core",
    );
    assert_part_up_to_date(
        "docs/problems.md",
        "thesis",
        &table(&thesis::PROBLEMS, circuit_link),
        "patchcord-core",
    );
    assert_part_up_to_date(
        "docs/problems.md",
        "others",
        &table(&others::PROBLEMS, circuit_link),
        "patchcord-core",
    );
}

/// The section of a problem with a closed solution, and that solution.
fn section<'p>(page: &'p str, name: &str) -> (&'p str, fn(f64) -> f64) {
    let problem = closed_form::PROBLEMS.iter().find(|problem| problem.name == name).unwrap();
    (page.split("\n## ").find(|section| section.starts_with(name)).unwrap(), problem.closed_form())
}

/// The numbers between two phrases of a section.
fn numbers<const COUNT: usize>(section: &str, phrase: &str, end: &str) -> [f64; COUNT] {
    let rest = section.split_once(phrase).unwrap_or_else(|| panic!("the section lacks {phrase}")).1;
    let words = rest
        .split_once(end)
        .unwrap()
        .0
        .split(|letter: char| !(letter.is_ascii_digit() || "-.".contains(letter)));
    let numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
    numbers.try_into().unwrap_or_else(|numbers| panic!("{phrase} {numbers:?}"))
}

/// The first and second time derivative of a solution, by differences.
fn derivatives(exact: fn(f64) -> f64, time: f64) -> [f64; 2] {
    let (step, value) = (1e-4, exact(time));
    let (before, after) = (exact(time - step), exact(time + step));
    [(after - before) / (2.0 * step), (after - 2.0 * value + before) / (step * step)]
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-5 * (1.0 + expected.abs()), "{found}, expected {expected}");
}

#[test]
fn the_solutions_satisfy_the_equations_of_the_page() {
    let page = page();
    let (dry, x) = section(&page, "Dry friction");
    let [stiffness, friction] = numbers(dry, "    x'' = -", "sign(x')");
    let [speed, acceleration] = derivatives(x, 1.0);
    assert_near(acceleration, -stiffness * x(1.0) - friction * speed.signum());
    let turns: [f64; 5] = numbers(dry, "turning points are ", ", and there it stays");
    (0..5).zip(turns).for_each(|(turn, position)| assert_near(x(f64::from(turn) * FRAC_PI_2), position));
    assert!((stiffness * turns[4]).abs() <= friction && x(8.0) == turns[4]);

    let (ball, h) = section(&page, "Bouncing ball");
    let [gravity, height] = numbers(&ball.replace("h(0)", "h"), "h'' = -", ", h'(0)");
    assert_near(derivatives(h, 1.0)[1], -gravity);
    assert_near(h(0.0), height);
    let [fall] = numbers(ball, "It falls for ", " s");
    let [first_duration, duration_ratio] = numbers(&ball.replace("^n", ""), "and flies for `", "`");
    let [first_speed, restitution] = numbers(&ball.replace("^n", ""), "`v = ", "`");
    let mut bounce = fall;
    for n in 1..4 {
        assert_near(h(bounce), 0.0);
        assert_near(
            derivatives(h, bounce + 1e-3)[0] + gravity * 1e-3,
            first_speed * f64::powi(restitution, n),
        );
        bounce += first_duration * f64::powi(duration_ratio, n);
    }

    let (saturated, x) = section(&page, "Saturated integrator");
    let [size, rate] = numbers(saturated, "x' = -", " t)");
    assert_near(derivatives(x, 0.5)[0], -size * (rate * 0.5).sin());
    let [low, high] = numbers(&saturated.replace("x <= ", ""), " t), ", ", x(0)");
    let samples = (0..=1200).map(|sample| x(f64::from(sample) * 1e-2));
    let ends = samples.fold([0.0f64; 2], |[minimum, maximum], x| [minimum.min(x), maximum.max(x)]);
    assert_eq!(ends, [low, high]);

    let (relay, x) = section(&page, "Relay oscillator");
    let [level, _, threshold] = numbers(relay, "x' = -x - s ", ", and -1");
    assert_near(derivatives(x, 0.5)[0], -x(0.5) + level);
    let [over, under] = numbers(relay, "first after `ln(", ")`");
    let [next_over, next_under] = numbers(relay, "every\n`ln(", ")`");
    let (first, half) = (f64::ln(over / under), f64::ln(next_over / next_under));
    (0..5).zip([1.0, -1.0].into_iter().cycle()).for_each(|(n, sign)| {
        assert_near(x(first + f64::from(n) * half), sign * threshold);
    });
}

#[test]
fn the_numbers_of_the_page_are_those_of_the_problems() {
    let page = page();
    let pol = closed_form::PROBLEMS.iter().find(|problem| problem.name == "Van der Pol's period").unwrap();
    let (text, _) = section(&page, pol.name);
    let changes: [f64; 2] = numbers(&text.replace("x0", "x"), "with mu = ", ", the top");
    assert!(pol.changes.iter().map(|(_, value)| value).eq(&changes), "{changes:?}");
    assert_eq!(numbers(text, "after every period of ", ": C. M."), [pol.every]);
    let (masses, x1) = section(&page, "Three masses");
    let [start] = numbers(masses, "let go from ", ":\n");
    let [stiffness] = numbers(masses, "x_j'' = ", " (x_");
    // At t = 0 only the first mass is displaced, so its acceleration is -2 k x.
    assert_near(derivatives(x1, 0.0)[1], -2.0 * stiffness * x1(0.0));
    assert_near(x1(0.0), start);
}

/// Integrates Van der Pol's equation with the numbers of the page over the period of the page.
#[test]
fn the_equation_of_van_der_pol_has_the_period_of_the_page() {
    let page = page();
    let (text, _) = section(&page, "Van der Pol's period");
    assert!(text.contains("    x'' = mu (1 - x^2) x' - x\n"));
    let [mu, top]: [f64; 2] = numbers(&text.replace("x0", "x"), "with mu = ", ", the top");
    let [period] = numbers(text, "after every period of ", ": C. M.");
    let rates = |[x, v]: [f64; 2], _: f64| [v, mu * (1.0 - x * x) * v - x];
    let end = rates.integrate([top, 0.0], period, period, period / 1e4)[1];
    assert!((end[0] - top).abs() < 1e-9 && end[1].abs() < 1e-9, "{end:?} after a period");
}

/// The sum of the modes on the page starts with only the first mass displaced, and each mode satisfies the equations.
#[test]
fn the_modes_of_three_masses_satisfy_the_equations() {
    let page = page();
    let (text, x1) = section(&page, "Three masses");
    let [stiffness] = numbers(text, "x_j'' = ", " (x_");
    let [size, quarter, power, rate, eighth]: [f64; 5] = numbers(text, "k = 1, 2, 3 of ", " t)");
    assert_eq!(power, 2.0);
    // The amplitude of mass or wall j in mode k, and the mode's frequency in rad/s.
    let shape = |k: f64, j: usize| size * (k * PI / quarter).sin() * (j as f64 * k * PI / quarter).sin();
    let frequency = |k: f64| rate * (k * PI / eighth).sin();
    for k in [1.0, 2.0, 3.0] {
        assert!(shape(k, 0).abs() < 1e-12 && shape(k, 4).abs() < 1e-12, "walls in mode {k}");
        for j in 1..=3 {
            let pull = stiffness * (shape(k, j - 1) - 2.0 * shape(k, j) + shape(k, j + 1));
            assert_near(pull, -frequency(k).powi(2) * shape(k, j));
        }
    }
    let position = |j: usize, time: f64| -> f64 {
        [1.0, 2.0, 3.0].map(|k| shape(k, j) * (frequency(k) * time).cos()).iter().sum()
    };
    let [start] = numbers(text, "let go from ", ":\n");
    [start, 0.0, 0.0].into_iter().zip(1..).for_each(|(begin, j)| assert_near(position(j, 0.0), begin));
    [0.0, 0.7, 3.1, 9.9].into_iter().for_each(|time| assert_near(x1(time), position(1, time)));
}
