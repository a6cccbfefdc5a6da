//! Every problem of which the solution is known, with equal steps and with a tolerance; and the page that tells them.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fs;

use crate::common::pages::check_part;
use crate::common::{files, order};
use crate::known::equations::Equations;
use crate::known::{Known, Left, Problem, closed, lessons, others, thesis};
use patchcord_core::solve::{Backend, RunSettings};

const TOLERANCES: [f64; 4] = [1e-5, 1e-6, 1e-7, 1e-8];

#[test]
fn equal_steps_are_right_on_every_backend() {
    for problem in crate::known::all() {
        let ready = problem.ready();
        for backend in Backend::ALL {
            let error = ready.error(&RunSettings { backend, ..ready.settings.clone() });
            assert!(error < problem.within, "{}, {backend}: {error:e}", problem.name);
        }
    }
}

#[test]
fn the_error_goes_with_the_fourth_power_of_the_step() {
    for problem in crate::known::all().filter(|problem| problem.left == Left::Step) {
        let ready = problem.ready();
        let steps = [8.0, 4.0, 2.0, 1.0].map(|times| times * problem.ladder * ready.settings.step);
        let errors = steps.map(|step| ready.error(&RunSettings { step, ..ready.settings.clone() }));
        let reached = order(&steps, &errors);
        assert!((3.9..=4.1).contains(&reached), "{}: order {reached} from {errors:?}", problem.name);
    }
}

#[test]
fn runs_are_right_to_the_tolerance() {
    for problem in crate::known::all() {
        let ready = problem.ready();
        let apart = if problem.left == Left::Amplification { problem.within } else { 0.0 };
        for tolerance in TOLERANCES {
            let error = ready.error(&RunSettings { tolerance: Some(tolerance), ..ready.settings.clone() });
            assert!(error < tolerance + apart, "{}: {error:e} at {tolerance:e}", problem.name);
        }
    }
}

/// But for those that a search in measured data begins from: crates/ident/tests/measured.rs holds them against their equations.
#[test]
fn every_patch_that_is_shipped_is_a_problem() {
    for file in files::shipped().iter().filter(|file| !file.parent().unwrap().ends_with("patches/measured")) {
        let is_it = |problem: &Problem| file.ends_with(format!("patches/{}.json", problem.patch));
        assert!(crate::known::all().any(is_it), "nothing is known of {}", file.display());
    }
}

/// The page's text.
fn page() -> String {
    fs::read_to_string("../../docs/problems.md").unwrap()
}

#[test]
fn the_page_tells_every_problem_with_a_section() {
    let page = page();
    let told: Vec<_> = page.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    let sections = closed::PROBLEMS.iter().map(|problem| problem.name).chain([
        "Lessons",
        "Circuits of the thesis",
        "Circuits of others",
    ]);
    assert_eq!(told, sections.collect::<Vec<_>>());
    for (problem, section) in closed::PROBLEMS.iter().zip(page.split("\n## ").skip(1)) {
        let named = [format!("`patches/{}.json`", problem.patch), format!("signal `{}`", problem.signal)];
        for words in named {
            assert!(section.contains(&words), "{} does not say {words}", problem.name);
        }
    }
}

/// Problems in the order of the library, as the page tells those whose own page is elsewhere.
fn table(problems: &[Problem], page_of: impl Fn(&Problem) -> String) -> String {
    let row = |problem: &Problem| {
        let changes = problem.changes.iter().map(|(name, value)| format!("{name} = {value}"));
        let known = match problem.known {
            Known::Closed(_) => "closed solution",
            Known::Stepped(_) => "equations, stepped",
        };
        let left = match problem.left {
            Left::Step => "the step: order 4",
            Left::Rounding => "rounding",
            Left::Amplification => "finite amplification",
        };
        let cells = [
            format!("[{}]({})", problem.name, page_of(problem)),
            changes.collect::<Vec<_>>().join(", "),
            format!("`{}`", problem.signal),
            format!("{} s", problem.duration),
            known.to_owned(),
            format!("{:e} s", problem.ready().settings.step),
            format!("{:e}", problem.within),
            left.to_owned(),
        ];
        format!("| {} |\n", cells.join(" | "))
    };
    let head = "| | changed | signal | over | known by | step | less off than | what is left |\n";
    format!("{head}{}|\n{}", "|---".repeat(8), problems.iter().map(row).collect::<String>())
}

#[test]
fn the_page_tells_lessons_and_circuits_as_they_are_run() {
    let of_lesson = |problem: &Problem| format!("lessons.md#{}", problem.name);
    let of_circuit = |problem: &Problem| format!("../patches/{}.json", problem.patch);
    check_part("docs/problems.md", "lessons", &table(&lessons::PROBLEMS, of_lesson), "patchcord-core");
    check_part("docs/problems.md", "thesis", &table(&thesis::PROBLEMS, of_circuit), "patchcord-core");
    check_part("docs/problems.md", "others", &table(&others::PROBLEMS, of_circuit), "patchcord-core");
}

/// The section of a problem, and its solution.
fn section<'p>(page: &'p str, name: &str) -> (&'p str, fn(f64) -> f64) {
    let problem = closed::PROBLEMS.iter().find(|problem| problem.name == name).unwrap();
    (page.split("\n## ").find(|section| section.starts_with(name)).unwrap(), problem.closed())
}

/// The numbers that stand between two phrases.
fn numbers<const COUNT: usize>(section: &str, phrase: &str, end: &str) -> [f64; COUNT] {
    let rest = section.split_once(phrase).unwrap_or_else(|| panic!("{phrase} is not told")).1;
    let words = rest
        .split_once(end)
        .unwrap()
        .0
        .split(|letter: char| !(letter.is_ascii_digit() || "-.".contains(letter)));
    let found: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
    found.try_into().unwrap_or_else(|found| panic!("{phrase} {found:?}"))
}

/// First and second derivative, by differences.
fn slopes(exact: fn(f64) -> f64, time: f64) -> [f64; 2] {
    let (step, here) = (1e-4, exact(time));
    let (before, after) = (exact(time - step), exact(time + step));
    [(after - before) / (2.0 * step), (after - 2.0 * here + before) / (step * step)]
}

fn assert_near(found: f64, wanted: f64) {
    assert!((found - wanted).abs() <= 1e-5 * (1.0 + wanted.abs()), "{found} and not {wanted}");
}

#[test]
fn the_equations_of_the_page_have_these_solutions() {
    let page = page();
    let (dry, x) = section(&page, "Dry friction");
    let [stiffness, friction] = numbers(dry, "    x'' = -", "sign(x')");
    let [speed, bend] = slopes(x, 1.0);
    assert_near(bend, -stiffness * x(1.0) - friction * speed.signum());
    let turns: [f64; 5] = numbers(dry, "turning points are ", ", and there it stays");
    (0..5).zip(turns).for_each(|(turn, told)| assert_near(x(f64::from(turn) * FRAC_PI_2), told));
    assert!((stiffness * turns[4]).abs() <= friction && x(8.0) == turns[4]);

    let (ball, h) = section(&page, "Bouncing ball");
    let [gravity, height] = numbers(&ball.replace("h(0)", "h"), "h'' = -", ", h'(0)");
    assert_near(slopes(h, 1.0)[1], -gravity);
    assert_near(h(0.0), height);
    let [fall] = numbers(ball, "It falls for ", " s");
    let [flight, share] = numbers(&ball.replace("^n", ""), "and flies for `", "`");
    let [first, again] = numbers(&ball.replace("^n", ""), "`v = ", "`");
    let mut blow = fall;
    for n in 1..4 {
        assert_near(h(blow), 0.0);
        assert_near(slopes(h, blow + 1e-3)[0] + gravity * 1e-3, first * f64::powi(again, n));
        blow += flight * f64::powi(share, n);
    }

    let (saturated, x) = section(&page, "Saturated integrator");
    let [size, rate] = numbers(saturated, "x' = -", " t)");
    assert_near(slopes(x, 0.5)[0], -size * (rate * 0.5).sin());
    let [low, high] = numbers(&saturated.replace("x <= ", ""), " t), ", ", x(0)");
    let course = (0..=1200).map(|at| x(f64::from(at) * 1e-2));
    let ends = course.fold([0.0f64; 2], |[least, most], x| [least.min(x), most.max(x)]);
    assert_eq!(ends, [low, high]);

    let (relay, x) = section(&page, "Relay oscillator");
    let [level, _, mark] = numbers(relay, "x' = -x - s ", ", and -1");
    assert_near(slopes(x, 0.5)[0], -x(0.5) + level);
    let [over, under] = numbers(relay, "first after `ln(", ")`");
    let [next_over, next_under] = numbers(relay, "every\n`ln(", ")`");
    let (first, half) = (f64::ln(over / under), f64::ln(next_over / next_under));
    (0..5).zip([1.0, -1.0].into_iter().cycle()).for_each(|(n, sign)| {
        assert_near(x(first + f64::from(n) * half), sign * mark);
    });
}

#[test]
fn the_numbers_of_the_page_are_those_that_are_run() {
    let page = page();
    let pol = closed::PROBLEMS.iter().find(|problem| problem.name == "Van der Pol's period").unwrap();
    let (told, _) = section(&page, pol.name);
    let changes: [f64; 2] = numbers(&told.replace("x0", "x"), "with mu = ", ", the top");
    assert!(pol.changes.iter().map(|(_, value)| value).eq(&changes), "{changes:?}");
    assert_eq!(numbers(told, "after every period of ", ": C. M."), [pol.every]);
    let (masses, x1) = section(&page, "Three masses");
    let [out] = numbers(masses, "let go from ", ":\n");
    let [stiffness] = numbers(masses, "x_j'' = ", " (x_");
    // At the beginning the first alone is out: -2 k x.
    assert_near(slopes(x1, 0.0)[1], -2.0 * stiffness * x1(0.0));
    assert_near(x1(0.0), out);
}

/// Van der Pol's equation as the page has it, integrated here over the period that it tells.
#[test]
fn the_equation_of_van_der_pol_has_this_period() {
    let page = page();
    let (told, _) = section(&page, "Van der Pol's period");
    assert!(told.contains("    x'' = mu (1 - x^2) x' - x\n"));
    let [mu, top]: [f64; 2] = numbers(&told.replace("x0", "x"), "with mu = ", ", the top");
    let [period] = numbers(told, "after every period of ", ": C. M.");
    let rates = |[x, v]: [f64; 2], _: f64| [v, mu * (1.0 - x * x) * v - x];
    let at = rates.course([top, 0.0], period, period, period / 1e4)[1];
    assert!((at[0] - top).abs() < 1e-9 && at[1].abs() < 1e-9, "{at:?} after a period");
}

/// The modes of the page begin with the first mass out, and each swings as the equations want it to.
#[test]
fn the_modes_of_three_masses_are_those_of_the_equations() {
    let page = page();
    let (told, x1) = section(&page, "Three masses");
    let [stiffness] = numbers(told, "x_j'' = ", " (x_");
    let [size, quarter, power, rate, eighth]: [f64; 5] = numbers(told, "k = 1, 2, 3 of ", " t)");
    assert_eq!(power, 2.0);
    // The voltages of all masses and walls in one mode, and what they change by.
    let shape = |k: f64, j: usize| size * (k * PI / quarter).sin() * (j as f64 * k * PI / quarter).sin();
    let speed = |k: f64| rate * (k * PI / eighth).sin();
    for k in [1.0, 2.0, 3.0] {
        assert!(shape(k, 0).abs() < 1e-12 && shape(k, 4).abs() < 1e-12, "walls in mode {k}");
        for j in 1..=3 {
            let pull = stiffness * (shape(k, j - 1) - 2.0 * shape(k, j) + shape(k, j + 1));
            assert_near(pull, -speed(k).powi(2) * shape(k, j));
        }
    }
    let place = |j: usize, time: f64| -> f64 {
        [1.0, 2.0, 3.0].map(|k| shape(k, j) * (speed(k) * time).cos()).iter().sum()
    };
    let [out] = numbers(told, "let go from ", ":\n");
    [out, 0.0, 0.0].into_iter().zip(1..).for_each(|(begin, j)| assert_near(place(j, 0.0), begin));
    [0.0, 0.7, 3.1, 9.9].into_iter().for_each(|time| assert_near(x1(time), place(1, time)));
}
