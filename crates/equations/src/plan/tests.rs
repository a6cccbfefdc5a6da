//! Unit tests of the plan: small problems with plans that were made by hand, and all problems.

mod diagnostics;
mod evaluation;
mod functions;
mod loops;
mod starts;
mod systems;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::patch::Problem;
use patchcord_expr::Dimension;

use super::plan;
use crate::derive::System;
use crate::graph::{FunctionKind, Node, NodeId, ONE, Operation, Plan, Sum};
use crate::notation::text;
use crate::symbolic::Fraction;
use crate::testing::problem_files::problem_file;
use crate::writing::Writer;

/// A problem with these sections.
fn problem(sections: &str) -> Problem {
    let text = format!("{{\"patchcord\": 1, {sections}, \"run\": {{\"for\": 1, \"step\": 0.01}}}}");
    Problem::parse("problem.json", &text).unwrap_or_else(|report| panic!("{report}"))
}

/// The circuit of a problem.
fn circuit(problem: &Problem) -> Circuit {
    Circuit::new(&problem.patch).unwrap_or_else(|report| panic!("{report}"))
}

/// The plan of a problem with these sections.
fn planned(sections: &str) -> Plan {
    let problem = problem(sections);
    plan(&problem, &circuit(&problem)).unwrap_or_else(|findings| panic!("{findings:#?}"))
}

/// The plan of the problem with this name.
fn planned_system(name: &str) -> Plan {
    let problem = Problem::read(problem_file(name)).unwrap();
    plan(&problem, &circuit(&problem)).unwrap_or_else(|findings| panic!("{name}: {findings:#?}"))
}

/// The faults of a problem with these sections: each with its place in the text, its message and its hint.
fn faults(sections: &str) -> Vec<[String; 3]> {
    let problem = problem(sections);
    let findings = plan(&problem, &circuit(&problem)).expect_err("the problem has a fault");
    let fault = |finding: &Diagnostic| {
        let place = finding.span.map_or("", |span| &problem.patch.text()[span.start..span.end]);
        [place.to_owned(), finding.message.clone(), finding.hint.clone().unwrap_or_default()]
    };
    findings.iter().map(fault).collect()
}

/// The operation of the node with this name.
fn operation<'p>(plan: &'p Plan, name: &str) -> &'p Operation {
    let named = |node: &&Node| node.name == name;
    &plan.nodes.iter().find(named).unwrap_or_else(|| panic!("there is no node {name}")).operation
}

/// The node of a quantity.
fn node_of(plan: &Plan, quantity: &str) -> NodeId {
    let planned = plan.quantities.iter().find(|planned| planned.name == quantity);
    planned.unwrap_or_else(|| panic!("{quantity} is not planned")).node
}

/// Number of nodes whose operation has this property.
fn count(plan: &Plan, has_property: impl Fn(&Operation) -> bool) -> usize {
    plan.nodes.iter().filter(|node| has_property(&node.operation)).count()
}

/// The nodes of a plan except the number 1, each as a line: name = operation.
fn lines(plan: &Plan) -> Vec<String> {
    let system = System::without_laws(plan.symbols.clone());
    let printer = Printer { plan, writer: Writer::physical(&system) };
    plan.ids().skip(1).map(|id| printer.line(id)).collect()
}

/// Writes the nodes of a plan.
struct Printer<'a> {
    plan: &'a Plan,
    writer: Writer<'a>,
}

impl Printer<'_> {
    fn line(&self, id: NodeId) -> String {
        format!("{} = {}", self.name(id), self.operation(&self.plan.node(id).operation))
    }

    fn name(&self, id: NodeId) -> &str {
        &self.plan.node(id).name
    }

    fn constant(&self, value: &Fraction) -> String {
        text(&self.writer.expression(value, None))
    }

    fn bound(&self, bound: Option<&Fraction>) -> String {
        bound.map_or("none".to_owned(), |bound| self.constant(bound))
    }

    fn term(&self, coefficient: &Fraction, node: NodeId) -> String {
        if node == ONE {
            self.constant(coefficient)
        } else if *coefficient == Fraction::whole(1) {
            self.name(node).to_owned()
        } else {
            format!("{} * {}", self.constant(coefficient), self.name(node))
        }
    }

    fn sum(&self, sum: &Sum) -> String {
        let terms = sum.terms.iter().map(|(node, coefficient)| self.term(coefficient, *node));
        terms.collect::<Vec<_>>().join(" + ")
    }

    fn operation(&self, operation: &Operation) -> String {
        match operation {
            Operation::One => "1".to_owned(),
            Operation::Drive(name) => format!("drive {name}"),
            Operation::Integral { initial, rate } => {
                format!("integral({}) from {}", self.sum(rate), self.constant(initial))
            }
            Operation::Sum(sum) => self.sum(sum),
            Operation::Limited { sum, lower, upper } => {
                let [lower, upper] = [lower, upper].map(|bound| self.bound(bound.as_ref()));
                format!("limited({}, {lower}, {upper})", self.sum(sum))
            }
            Operation::Product([left, right]) => format!("{} times {}", self.name(*left), self.name(*right)),
            Operation::Quotient { dividend, divisor } => {
                format!("({}) over {}", self.sum(dividend), self.name(*divisor))
            }
            Operation::Root(sum) => format!("root({})", self.sum(sum)),
            Operation::Zero(sum) => format!("zero of {}", self.sum(sum)),
            Operation::Absolute(input) => format!("absolute({})", self.name(*input)),
            Operation::Lower([first, second]) | Operation::Higher([first, second]) => {
                let word = if matches!(operation, Operation::Lower(_)) { "lower" } else { "higher" };
                let [first, second] = [first, second].map(|term| self.term(&term.coefficient, term.node));
                format!("{word}({first}, {second})")
            }
            Operation::Switch { input, at_least_0, below_0 } => {
                let [above, below] = [at_least_0, below_0].map(|value| self.constant(value));
                format!("switch({}, {above}, {below})", self.name(*input))
            }
            Operation::DeadZone { input, width } => {
                format!("dead zone({}, {})", self.name(*input), self.term(&width.coefficient, width.node))
            }
            Operation::Function { kind, argument } => {
                let kind = match kind {
                    FunctionKind::Sin => "sin",
                    FunctionKind::Cos => "cos",
                    FunctionKind::Exp => "exp",
                    FunctionKind::Ln => "ln",
                };
                format!("{kind}({})", self.term(&argument.coefficient, argument.node))
            }
            Operation::Curve { table, input } => {
                format!("curve {table}({})", self.term(&input.coefficient, input.node))
            }
            Operation::Delay { input, time, initial } => {
                let [time, initial] = [time, initial].map(|value| self.constant(value));
                format!("delay({}, {time}) from {initial}", self.name(*input))
            }
        }
    }
}

#[test]
fn a_mass_with_spring_and_damper_is_two_integrals() {
    let plan = planned(
        r#""parameters": {
            "m": {"value": 2, "unit": "kg"}, "k": {"value": 8, "unit": "N/m"},
            "c": {"value": 1, "unit": "N s/m"}, "x0": {"value": 0.5, "unit": "m"}},
        "quantities": {"x": {"unit": "m", "initial": "x0"}, "x'": {"unit": "mm/s", "initial": 20}},
        "drives": {"F": {"kind": "step", "unit": "N", "height": 3}},
        "equations": ["m x'' = -k x - c x' + F"]"#,
    );
    let expected = [
        "x = integral(x') from x0",
        "x' = integral(-k/m * x + -c/m * x' + 1/m * F) from 0.02",
        "F = drive F",
    ];
    assert_eq!(lines(&plan), expected);
    let dimension = |name: &str| plan.node(node_of(&plan, name)).dimension;
    assert_eq!(dimension("x'"), Dimension::LENGTH.over(Dimension::TIME));
    let names: Vec<&str> = plan.quantities.iter().map(|planned| planned.name.as_str()).collect();
    assert_eq!(names, ["x", "x'"]);
}

#[test]
fn van_der_pol_has_two_multipliers() {
    let expected = [
        "x = integral(x') from x0",
        "x' = integral(-1 * x + mu * (1 - x^2) x') from 0",
        "x^2 = x times x",
        "1 - x^2 = 1 + -1 * x^2",
        "(1 - x^2) x' = x' times 1 - x^2",
    ];
    assert_eq!(lines(&planned_system("van-der-pol")), expected);
}

#[test]
fn lorenz_distributes_constants_over_sums() {
    let expected = [
        "x = integral(-sigma * x + sigma * y) from x0",
        "y = integral(rho * x + -1 * y + -1 * x z) from 1",
        "z = integral(-beta * z + x y) from 20",
        "x z = x times z",
        "x y = x times y",
    ];
    assert_eq!(lines(&planned_system("lorenz")), expected);
}

#[test]
fn the_slideway_has_limits_a_dead_zone_and_named_quantities() {
    let plan = planned_system("slideway");
    let expected = [
        "x_error = integral(-1 * v_o + v_i) from 0",
        "v_o = integral(-f/M * v_o + 1/M * dead_zone(spring, friction_level)) from 0",
        "memory = integral(-1/Tc * memory + 1/Tc * max(1 - abs(v_o)/VcL, 0)) from 1",
        "spring = K * x_error",
        "friction_level = Fs * max(memory, 0)^2",
        "v_i = drive v_i",
        "max(memory, 0) = limited(memory, 0, none)",
        "max(memory, 0)^2 = max(memory, 0) times max(memory, 0)",
        "dead_zone(spring, friction_level) = dead zone(spring, friction_level)",
        "abs(v_o) = absolute(v_o)",
        "max(1 - abs(v_o)/VcL, 0) = limited(1 + -1/VcL * abs(v_o), 0, none)",
    ];
    assert_eq!(lines(&plan), expected);
    assert_eq!(plan.node(node_of(&plan, "friction_level")).dimension, Dimension::FORCE);
}

#[test]
fn a_quotient_contains_its_constants() {
    let plan = planned(
        r#""parameters": {
            "a": {"value": 2, "unit": "1"}, "h": {"value": 0.5, "unit": "1"}, "r": {"value": 1, "unit": "1"}},
        "quantities": {"prey": {"unit": "1", "initial": 1}, "eaten": {"unit": "1"}},
        "equations": ["eaten = a prey^2 / (1 + a h prey)", "prey' = r prey - eaten"]"#,
    );
    let expected = [
        "prey = integral(r * prey + -1 * eaten) from 1",
        "eaten = (a * prey^2) over 1 + a h prey",
        "prey^2 = prey times prey",
        "1 + a h prey = 1 + a h * prey",
    ];
    assert_eq!(lines(&plan), expected);
}

#[test]
fn other_names_of_a_node_share_it() {
    let plan = planned(
        r#""parameters": {"k": {"value": 4, "unit": "1"}, "v0": {"value": 1, "unit": "1"}},
        "quantities": {"x": {"unit": "1", "initial": 0}, "v": {"unit": "1"}, "a": {"unit": "1"}},
        "equations": ["v = x'", "x'' = -k x - v", "x'(0) = v0", "a = x''"]"#,
    );
    let expected = ["x = integral(v) from 0", "v = integral(a) from v0", "a = -k * x + -1 * v"];
    assert_eq!(lines(&plan), expected);
    let quantities: Vec<(&str, u32)> =
        plan.quantities.iter().map(|planned| (planned.name.as_str(), planned.node.0)).collect();
    assert_eq!(quantities, [("x", 1), ("v", 2), ("a", 3), ("x'", 2)]);
}

#[test]
fn equal_sums_and_multiples_of_them_share_a_node() {
    let plan = planned(
        r#""quantities": {
            "x": {"unit": "1", "initial": 1}, "y": {"unit": "1", "initial": 2}, "d": {"unit": "1"}},
        "equations": ["x' = sin(x - y)", "y' = cos(2 y - 2 x) + d^2", "d = 3 (x - y)"]"#,
    );
    let expected = [
        "x = integral(sin(x - y)) from 1",
        "y = integral(cos(-2 (x - y)) + d^2) from 2",
        "d = 3 * x + -3 * y",
        "x - y = x + -1 * y",
        "sin(x - y) = sin(x - y)",
        "cos(-2 (x - y)) = cos(-2 * x - y)",
        "d^2 = d times d",
    ];
    assert_eq!(lines(&plan), expected);
}

#[test]
fn constant_quantities_become_coefficients() {
    let plan = planned(
        r#""parameters": {"k": {"value": 9, "unit": "N/m"}, "m": {"value": 1, "unit": "kg"}},
        "quantities": {
            "x": {"unit": "m", "initial": 1}, "x'": {"unit": "m/s", "initial": 0}, "b": {"unit": "1/s2"}},
        "equations": ["x'' = -w^2 x", "w = sqrt(b)", "b = k / m"]"#,
    );
    let expected = ["x = integral(x') from 1", "x' = integral(-k/m * x) from 0", "b = k/m"];
    assert_eq!(lines(&plan), expected);
}

#[test]
fn an_equation_gives_way_if_another_one_needs_its_first_unknown() {
    let plan = planned(
        r#""quantities": {
            "x": {"unit": "1", "initial": 0}, "v": {"unit": "1", "initial": 1}, "a": {"unit": "1"}},
        "equations": ["x' = v", "a = v'", "3 a = -x"]"#,
    );
    let expected = ["x = integral(v) from 0", "v = integral(a) from 1", "a = -1/3 * x"];
    assert_eq!(lines(&plan), expected);
}
