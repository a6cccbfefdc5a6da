use proptest::prelude::*;

use super::*;
use crate::formula::Formula;
use crate::formula::expression::Operator;
use crate::units::{Dimension, Unit};

/// The tables of the tests.
const TABLES: [&str; 1] = ["friction"];

/// The names of the tests with their values and units. Names with primes are derived from them.
const NAMES: [(&str, Option<f64>, &str); 9] = [
    ("x", Some(0.5), "m"),
    ("v", Some(-2.0), "m/s"),
    ("m", Some(4.0), "kg"),
    ("k", Some(10.0), "N/m"),
    ("c", Some(3.0), "N s/m"),
    ("F", Some(7.0), "N"),
    ("u", Some(0.25), "1"),
    ("T", Some(0.2), "s"),
    ("t", None, "s"),
];

/// The scope of [`NAMES`]. The table `friction` gives a force for a velocity.
struct TestScope {
    /// The dimension of a time.
    time: Dimension,
}

impl Scope for TestScope {
    fn value(&self, name: &str) -> Option<f64> {
        NAMES.iter().find(|entry| entry.0 == name)?.1
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        let (base, order) = split_primes(name);
        let entry = NAMES.iter().find(|entry| entry.0 == base)?;
        let dimension = Unit::parse(entry.2).ok()?.dimension();
        Some(dimension.over(self.time.power(order as f64)))
    }

    fn declared_unit(&self, name: &str) -> Option<&str> {
        NAMES.iter().find(|entry| entry.0 == name).map(|entry| entry.2)
    }

    fn table(&self, name: &str) -> Option<(Dimension, Dimension)> {
        (name == "friction").then_some((Dimension::LENGTH.over(Dimension::TIME), Dimension::FORCE))
    }

    fn time(&self) -> Dimension {
        self.time
    }

    fn names(&self) -> Vec<&str> {
        NAMES.iter().map(|entry| entry.0).collect()
    }
}

const SCOPE: TestScope = TestScope { time: Dimension::TIME };

fn equation(text: &str) -> Equation {
    Equation::parse(text, &TABLES).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// The tree of a node, with parentheses around every operation.
fn shape(node: &Node) -> String {
    let list = |nodes: &[Node]| nodes.iter().map(shape).collect::<Vec<_>>().join(", ");
    match &node.expression {
        Expression::Number(value) => value.to_string(),
        Expression::Name(name) => name.clone(),
        Expression::Negate(inner) => format!("(-{})", shape(inner)),
        Expression::Binary(operator, left, right) => {
            let sign = match operator {
                Operator::Add => "+",
                Operator::Subtract => "-",
                Operator::Multiply => "*",
                Operator::Divide => "/",
                Operator::Power => "^",
            };
            format!("({} {sign} {})", shape(left), shape(right))
        }
        Expression::Call(callee, arguments) => format!("{}[{}]", callee.name(), list(arguments)),
        Expression::Apply(name, arguments) => format!("{name}<{}>", list(arguments)),
    }
}

/// The tree of the right side of `y = text`.
fn right(text: &str) -> String {
    shape(equation(&format!("y = {text}")).right())
}

/// The part of the text at fault, the message and the hint.
fn fault(result: Result<impl std::fmt::Debug, FormulaError>, text: &str) -> (String, String, String) {
    let error = result.expect_err(text);
    (text[error.range].to_owned(), error.message, error.hint.unwrap_or_default())
}

/// Asserts the part at fault, the message and the hint of texts that are not equations.
fn assert_faults(cases: &[(&str, &str, &str, &str)]) {
    for (text, part, message, hint) in cases {
        let expected = ((*part).to_owned(), (*message).to_owned(), (*hint).to_owned());
        assert_eq!(fault(Equation::parse(text, &TABLES), text), expected, "{text}");
    }
}

#[test]
fn the_sides_are_formulas() {
    let sides = equation("m x'' = -k x - c * x' + F");
    assert_eq!(shape(sides.left()), "(m * x'')");
    assert_eq!(shape(sides.right()), "((((-k) * x) - (c * x')) + F)");
    assert_eq!((sides.left().range.clone(), sides.right().range.clone()), (0..5, 8..25));
    assert_eq!(sides.text(), "m x'' = -k x - c * x' + F");
    assert_eq!(sides.to_string(), sides.text());
    let zero = equation("0=a+b");
    assert_eq!((shape(zero.left()), shape(zero.right())), ("0".to_owned(), "(a + b)".to_owned()));
}

#[test]
fn names_have_their_primes_and_are_listed_once() {
    assert_eq!(equation("m x'' + c x' + k x = pi m sin(x')").names(), ["m", "x''", "c", "x'", "k", "x"]);
    assert_eq!(equation("a = delay(b, T) + friction(a)").names(), ["a", "b", "T"]);
    assert_eq!(equation("q = x'''''''''").names(), ["q", "x'''''''''"]);
    let repeated = equation("x' = -x + 2 x'");
    assert_eq!(["x'", "x", "y"].map(|name| repeated.range_of(name)), [Some(0..2), Some(6..7), None]);
}

#[test]
fn a_name_directly_before_a_zero_in_parentheses_is_an_initial_value() {
    let stated = equation("x'(0) = v0 + 1");
    assert_eq!(stated.left().expression, Expression::Name("x'(0)".to_owned()));
    assert_eq!(stated.left().range, 0..5);
    assert_eq!(stated.names(), ["x'(0)", "v0"]);
    assert_eq!(stated.initial_quantity(), Some("x'"));
    let used = equation("x' = -x( 0.0 ) - x");
    assert_eq!(used.names(), ["x'", "x(0)", "x"]);
    assert_eq!(["x(0)", "x"].map(|name| used.range_of(name)), [Some(6..14), Some(17..18)]);
    assert_eq!(used.initial_quantity(), None);
    assert_eq!(equation("2 x(0) = 1").initial_quantity(), None);
    let cases = [
        ("2 x(0) y", "((2 * x(0)) * y)"),
        ("k x'(0)^2", "(k * (x'(0) ^ 2))"),
        ("x(0)(a)", "(x(0) * a)"),
        // The name of a quantity may resemble that of a function.
        ("tau(0)", "tau(0)"),
        ("round(0)", "round(0)"),
        // Names of functions and tables keep their meaning.
        ("cos(0)", "cos[0]"),
        ("step(0)", "step<0>"),
        ("friction(0)", "friction<0>"),
        // Other groups are factors.
        ("x(0 + 0)", "(x * (0 + 0))"),
        ("x(-0)", "(x * (-0))"),
        ("x (5)", "(x * 5)"),
        ("(x)(0)", "(x * 0)"),
    ];
    for (text, expected) in cases {
        assert_eq!(right(text), expected, "{text}");
    }
    assert_faults(&[
        (
            "x' (0) = v0",
            "x' (0)",
            "x' (0) is the product of x' and 0",
            "write x'(0) for the value at the start",
        ),
        ("x(0)' = v0", "'", "' is not allowed here", "a prime follows the name of a quantity"),
        ("x(0 = x0", "=", "= is not allowed inside parentheses", "close the parenthesis before the ="),
    ]);
}

#[test]
fn names_are_split_into_base_primes_and_initial_value() {
    assert_eq!(["x", "x''", "x(0)", "x''(0)"].map(split_primes), [("x", 0), ("x", 2), ("x", 0), ("x", 2)]);
    assert_eq!(["x", "x''", "x(0)", "x''(0)"].map(split_initial), [None, None, Some("x"), Some("x''")]);
}

#[test]
fn products_need_no_sign() {
    let cases = [
        ("m x''", "(m * x'')"),
        ("-k x", "((-k) * x)"),
        ("2 x", "(2 * x)"),
        ("2x", "(2 * x)"),
        ("2x'", "(2 * x')"),
        ("1.5e3x", "(1500 * x)"),
        ("2e", "(2 * e)"),
        ("k (a + b)", "(k * (a + b))"),
        ("k(a + b)", "(k * (a + b))"),
        ("(a + b) (c + d)", "((a + b) * (c + d))"),
        ("(a)(b)", "(a * b)"),
        ("k max(u, 0)^2", "(k * (max[u, 0] ^ 2))"),
        ("a b c", "((a * b) * c)"),
        ("x^2 y", "((x ^ 2) * y)"),
        ("x y^2", "(x * (y ^ 2))"),
        ("x^-2 y", "((x ^ (-2)) * y)"),
        ("-x^2 y", "((-(x ^ 2)) * y)"),
        ("a b + c d", "((a * b) + (c * d))"),
        ("a -b", "(a - b)"),
        ("a b / c", "((a * b) / c)"),
        ("a / b * c", "((a / b) * c)"),
        ("a / b * c d", "(((a / b) * c) * d)"),
        ("a * b c", "((a * b) * c)"),
        ("(a / b) c", "((a / b) * c)"),
        ("a / (b c)", "(a / (b * c))"),
        ("sin(a / b) c", "(sin[(a / b)] * c)"),
    ];
    for (text, expected) in cases {
        assert_eq!(right(text), expected, "{text}");
    }
    assert_eq!(right("2 pi f"), format!("((2 * {}) * f)", std::f64::consts::PI));
    // The range of a product without a sign extends over both factors.
    assert_eq!(equation("y = k (a + b)").right().range, 4..13);
}

#[test]
fn a_product_without_a_sign_after_a_division_is_ambiguous() {
    let message = "a product without a sign after a division is ambiguous";
    assert_faults(&[
        ("y = a / b c", "b c", message, "write (a / b) c or a / (b c)"),
        ("y = 1/2 x", "2 x", message, "write (1 / 2) x or 1 / (2 x)"),
        ("y = 1/2x", "2x", message, "write (1 / 2) x or 1 / (2 x)"),
        ("y = a b / c (d + e)", "c (d + e)", message, "write (a b / c) (d + e) or a b / (c (d + e))"),
        ("y = a / b * c / d e", "d e", message, "write (a / b * c / d) e or a / b * c / (d e)"),
        ("y = 1 + a / sin(b) c", "sin(b) c", message, "write (a / sin(b)) c or a / (sin(b) c)"),
    ]);
}

#[test]
fn names_before_parentheses_are_functions_tables_or_factors() {
    let cases = [
        ("sin(x)", "sin[x]"),
        ("sin (x)", "sin[x]"),
        ("sign(x')", "sign<x'>"),
        ("step (t - 1)", "step<(t - 1)>"),
        ("dead_zone(x, w)", "dead_zone<x, w>"),
        ("limit(x, -1, 1)", "limit<x, (-1), 1>"),
        ("delay(x, T)", "delay<x, T>"),
        ("friction(x')", "friction<x'>"),
        ("2 friction (x') k", "((2 * friction<x'>) * k)"),
        ("curve(x')", "(curve * x')"),
        ("x'(a)", "(x' * a)"),
        ("t(a)", "(t * a)"),
        // With a blank, a name that resembles a function is a factor.
        ("tau (a + b)", "(tau * (a + b))"),
        ("lb (a)", "(lb * a)"),
        // Without an argument, the name of a function of equations is one of a quantity.
        ("k step", "(k * step)"),
        ("limit - delay", "(limit - delay)"),
    ];
    for (text, expected) in cases {
        assert_eq!(right(text), expected, "{text}");
    }
}

#[test]
fn misspelt_and_foreign_functions_are_errors() {
    assert_faults(&[
        (
            "y = squrt(x)",
            "squrt",
            "squrt is not a function",
            "did you mean sqrt? A product is written squrt * ( ... )",
        ),
        (
            "y = tau(a)",
            "tau",
            "tau is not a function",
            "did you mean tan? A product is written tau * ( ... )",
        ),
        (
            "y = frction(v)",
            "frction",
            "frction is not a function",
            "did you mean friction? A product is written frction * ( ... )",
        ),
        ("y = pow(x, 2)", "pow", "pow is not a function", "a power is written with ^, such as x^2"),
        ("y = sgn(x)", "sgn", "sgn is not a function", "did you mean sign?"),
        ("y = clamp(x, 0, 1)", "clamp", "clamp is not a function", "did you mean limit?"),
        (
            "y = if(x, 0, 1)",
            "if",
            "if is not a function",
            "equations have no conditions: use step, limit, min and max",
        ),
        ("y = der(x)", "der", "der is not a function", "the derivative of x is written x'"),
        (
            "m x''(t) = F",
            "x''(t)",
            "x''(t) is the product of x'' and t",
            "write x'': a quantity depends on the time anyway; its value at the start is x''(0)",
        ),
        (
            "y = x'(5)",
            "x'(5)",
            "x'(5) is the product of x' and 5",
            "the product is 5 x'; the value at the start is x'(0)",
        ),
        ("y = sign(a, b)", "sign(a, b)", "sign takes 1 argument, not 2", ""),
        ("y = limit(a, b)", "limit(a, b)", "limit takes 3 arguments, not 2", ""),
        ("y = delay(a)", "delay(a)", "delay takes 2 arguments, not 1", ""),
        ("y = friction()", "friction()", "friction takes 1 argument, not 0", ""),
        ("y = min(a)", "min(a)", "min takes 2 arguments, not 1", ""),
    ]);
}

#[test]
fn functions_need_parentheses() {
    let hint = "the arguments of a function are in parentheses";
    assert_faults(&[
        ("y = sin x", "sin", "sin is a function: write sin( ... )", hint),
        ("y = 2 sqrt", "sqrt", "sqrt is a function: write sqrt( ... )", hint),
        ("y = sign x", "sign", "sign is a function: write sign( ... )", hint),
        ("y = friction 2", "friction", "friction is a function: write friction( ... )", hint),
    ]);
}

#[test]
fn an_equation_has_one_equals_sign() {
    assert_faults(&[
        ("", "", "the equation is empty", ""),
        ("x' - v", "x' - v", "the equation has no =", "write a left and a right side, such as x' = v"),
        ("x' = v = w", "=", "an equation has only one =", "write one equation for each ="),
        ("x' == v", "==", "== is not allowed in an equation", "write = instead"),
        ("y = (a = b)", "=", "= is not allowed inside parentheses", "close the parenthesis before the ="),
        (
            "= v",
            "=",
            "a number, a name or a parenthesis is missing here",
            "an equation has a left and a right side",
        ),
        ("x' =", "", "a number, a name or a parenthesis is missing here", ""),
        ("y = a)", ")", "this parenthesis has no opening parenthesis", ""),
        ("y = (a", "(", "this parenthesis is not closed", ""),
    ]);
    assert!(Equation::parse(&format!("y = {}1", "1+".repeat(2000)), &[]).is_err());
    let deep = format!("y = {}1{}", "k (".repeat(300), ")".repeat(300));
    assert_eq!(Equation::parse(&deep, &[]).unwrap_err().message, "the equation is nested too deeply");
    let flat = format!("y = {}x", "x ".repeat(990));
    assert_eq!(equation(&flat).names(), ["y", "x"]);
}

#[test]
fn a_prime_follows_the_name_of_a_quantity() {
    let hint = "a prime follows the name of a quantity";
    assert_faults(&[
        ("y = (a + b)'", "'", "' is not allowed here", hint),
        ("y = 2'", "'", "' is not allowed here", hint),
        ("y = x ''", "''", "'' is not allowed here", hint),
        ("y = pi'", "'", "pi is a number and has no derivative", hint),
        ("y = sin'(x)", "'", "sin is a function and has no derivative", hint),
        (
            "x'''''''''' = 0",
            "''''''''''",
            "a name has at most 9 primes",
            "name a lower derivative by a signal",
        ),
    ]);
}

#[test]
fn derivatives_are_written_with_primes() {
    assert_faults(&[
        ("dx/dt = v", "dx/dt", "dx/dt is not a derivative here", "write x'"),
        ("y = m dx_1 / dt", "dx_1 / dt", "dx_1 / dt is not a derivative here", "write x_1'"),
        ("y = -dx/dt c", "dx/dt", "dx/dt is not a derivative here", "write x'"),
        ("m d^2x/dt^2 = F", "d^2x/dt^2", "d^2x/dt^2 is not a derivative here", "write x''"),
        ("m d2x/dt2 = F", "d2x/dt2", "d2x/dt2 is not a derivative here", "write x''"),
        ("d x / dt = v", "d x / dt", "d x / dt is not a derivative here", "write x'"),
        ("d/dt x = v", "d/dt", "d/dt is not a derivative here", "the derivative of x is written x'"),
        ("dx(0)/dt = v", "dx(0)/dt", "dx(0)/dt is not a derivative here", "write x'(0)"),
        ("d x(0) / dt = v", "d x(0) / dt", "d x(0) / dt is not a derivative here", "write x'(0)"),
        ("dx/dt(0) = v", "dx/dt(0)", "dx/dt(0) is not a derivative here", "write x'(0)"),
        ("d2x/dt2(0) = v", "d2x/dt2(0)", "d2x/dt2(0) is not a derivative here", "write x''(0)"),
        ("ẋ = v", "ẋ", "ẋ is not allowed in an equation", "write x'"),
        ("m ẍ = F", "ẍ", "ẍ is not allowed in an equation", "write x''"),
        ("x′ = v", "′", "′ is not allowed in an equation", "write x'"),
    ]);
    for text in ["dx / T", "x / dt", "dx / dx", "d^2 / dt"] {
        assert!(Equation::parse(&format!("y = {text}"), &[]).is_ok(), "{text}");
    }
}

#[test]
fn signs_of_other_notations_get_a_hint() {
    assert_faults(&[
        ("y = a · b", "·", "· is not allowed in an equation", "write * instead"),
        ("y = −a", "−", "− is not allowed in an equation", "write - instead"),
        ("y = [a]", "[", "[ is not allowed in an equation", "write ( instead"),
        (
            "y = x 2",
            "2",
            "an operator is missing before 2",
            "a product of numbers is written with *, and a power with ^",
        ),
        (
            "y = 1,5 x",
            ",",
            "a comma is not allowed here",
            "a comma separates arguments; decimals are written with a point",
        ),
    ]);
}

#[test]
fn formulas_do_not_have_the_additions_of_equations() {
    for text in ["2 (a + b)", "2 a", "a (b)", "x'", "x(0)", "sign(a)", "delay(a, b)", "a = b"] {
        assert!(Formula::parse(text).is_err(), "{text}");
    }
    assert_eq!(Formula::parse("a = b").unwrap_err().message, "= is not allowed in a formula");
    assert_eq!(Formula::parse("dx / dt").unwrap().names(), ["dx", "dt"]);
}

/// The fault of the check of units.
fn mismatch(text: &str) -> (String, String, String) {
    fault(equation(text).dimension_check(&SCOPE), text)
}

#[test]
fn sides_agree_in_dimension() {
    for text in [
        "m x'' = -k x - c x' + F",
        "x' = v",
        "v = x'",
        "0 = m v' + k x",
        "m v' + k x = 0",
        "u = 0.5",
        "F = k dead_zone(x, 0)",
        "F = k dead_zone(x, x)",
        "x = limit(x, 0, x / 2)",
        "u = limit(u, -1, 1)",
        "u = limit(0, -1, 1)",
        "u = sign(x') + step(t - T)",
        "x = delay(x, 2 T)",
        "x = delay(x, 0)",
        "F = friction(x') + friction(0)",
        "T x' + x = 0",
        "x(0) = T v",
        "x'(0) = v / 2",
        "x''(0) = 0",
    ] {
        assert_eq!(equation(text).dimension_check(&SCOPE), Ok(()), "{text}");
    }
}

#[test]
fn disagreeing_sides_are_errors_with_their_units() {
    let none = String::new();
    let cases = [
        ("m x'' = -k x'", "m x'' = -k x'", "m x'' is in N but -k x' is in N/s", ""),
        ("x = 5", "x = 5", "x is in m but 5 is a pure number", "declare 5 as a parameter in m"),
        ("x'(0) = x", "x'(0) = x", "x'(0) is in m/s but x is in m", ""),
        ("x(0) = 5", "x(0) = 5", "x(0) is in m but 5 is a pure number", "declare 5 as a parameter in m"),
        ("m v' = u", "m v' = u", "m v' is in N but u is a pure number", "multiply u by a parameter in N"),
        ("x' = v + F", "v + F", "v is in m/s but F is in N", ""),
        ("u = sin(x)", "x", "sin takes a pure number, but x is in m", "divide it by a parameter in m"),
        (
            "x = limit(x, 0, u)",
            "limit(x, 0, u)",
            "x is in m but u is a pure number",
            "multiply u by a parameter in m",
        ),
        ("x = dead_zone(x, v)", "dead_zone(x, v)", "x is in m but v is in m/s", ""),
        ("x = delay(x, v)", "v", "delay takes a time, but v is in m/s", ""),
        (
            "x = delay(x, 2)",
            "2",
            "delay takes a time, but 2 is a pure number",
            "declare 2 as a parameter in s",
        ),
        ("F = friction(x)", "x", "friction takes a quantity in m/s, but x is in m", ""),
        (
            "F = friction(2)",
            "2",
            "friction takes a quantity in m/s, but 2 is a pure number",
            "declare 2 as a parameter in m/s",
        ),
        ("x' = w", "w", "w is not known here", ""),
    ];
    for (text, part, message, hint) in cases {
        assert_eq!(mismatch(text), (part.to_owned(), message.to_owned(), hint.to_owned()), "{text}");
    }
    let unknown = Equation::parse("F = curve(x)", &["curve"]).unwrap().dimension_check(&SCOPE);
    let expected = ("curve(x)".to_owned(), "the table curve is not known here".to_owned(), none);
    assert_eq!(fault(unknown, "F = curve(x)"), expected);
}

#[test]
fn nested_calls_take_no_exponential_time() {
    let nested = format!("x = {}x{}", "limit(".repeat(100), ", 0, x)".repeat(100));
    assert_eq!(equation(&nested).dimension_check(&SCOPE), Ok(()));
    assert_eq!(equation(&nested).evaluate(&SCOPE), Ok([0.5, 0.5]));
}

#[test]
fn time_can_count_as_a_pure_number() {
    let scope = TestScope { time: Dimension::NONE };
    for text in ["x' = -x", "x'' = x", "x = delay(x, 2)"] {
        assert!(equation(text).dimension_check(&SCOPE).is_err(), "{text}");
        assert_eq!(equation(text).dimension_check(&scope), Ok(()), "{text}");
    }
    let error = equation("x = delay(x, T)").dimension_check(&scope).unwrap_err();
    assert_eq!(error.message, "delay takes a pure number, but T is in s");
}

#[test]
fn the_right_side_has_a_dimension() {
    let dimension = |text: &str| equation(text).right_dimension(&SCOPE);
    assert_eq!(dimension("y = k x"), Ok(FormulaDimension::Of(Dimension::FORCE)));
    assert_eq!(dimension("y = 2"), Ok(FormulaDimension::Literal));
    assert!(dimension("y = k + x").is_err());
}

#[test]
fn both_sides_have_values() {
    let values = |text: &str| equation(text).evaluate(&SCOPE);
    assert_eq!(values("m v = -k x + 2 sign(v)"), Ok([-8.0, -7.0]));
    assert_eq!(values("x = limit(3 x, 0, 1) step(v) + dead_zone(v, 0.5)"), Ok([0.5, -1.5]));
    let cases = [
        ("x = delay(x, T)", "delay(x, T)", "delay(x, T) has no value here"),
        ("F = friction(v)", "friction(v)", "friction(v) has no value here"),
        ("x = sign(ln(v))", "ln(v)", "ln(v) has no finite value: v is -2"),
        ("x = limit(F, 0, 1 / u / 0)", "0", "the denominator is 0"),
    ];
    for (text, part, message) in cases {
        let (found, reason, _) = fault(values(text), text);
        assert_eq!((found.as_str(), reason.as_str()), (part, message), "{text}");
    }
}

#[test]
fn unknown_names_get_a_hint() {
    let unknown = |text: &str, name: &str| equation(text).unknown_name(name, &SCOPE).unwrap();
    let error = unknown("x' = 2 vx'", "vx'");
    assert_eq!((error.range, error.message.as_str()), (7..10, "vx is not known here"));
    assert_eq!(unknown("x' = V", "V").hint.as_deref(), Some("did you mean v?"));
    let error = unknown("V'(0) = 0", "V'(0)");
    assert_eq!((error.range, error.message.as_str()), (0..5, "V is not known here"));
    assert_eq!(error.hint.as_deref(), Some("did you mean v?"));
    assert_eq!(unknown("x' = step", "step").hint.as_deref(), Some("step is a function: write step( ... )"));
    let number = unknown("x = e^u", "e").hint.unwrap();
    assert_eq!(number, "the number e is exp(1), and e to the power of x is exp(x)");
    assert_eq!(equation("x' = v").unknown_name("w", &SCOPE), None);
}

proptest! {
    #[test]
    fn nothing_panics_on_any_text(text in "\\PC*") {
        if let Err(error) = Equation::parse(&text, &TABLES) {
            prop_assert!(text.get(error.range).is_some());
        }
    }

    #[test]
    fn nothing_panics_on_equation_like_text(
        text in "((x'{0,2}|dx|dt|k|friction|sign\\(|2|limit\\(|\\(|\\(0\\)|pi|ẋ|=)[-+*/^,) =]{0,2}){0,12}\\)?"
    ) {
        match Equation::parse(&text, &TABLES) {
            Err(error) => prop_assert!(text.get(error.range).is_some()),
            Ok(equation) => {
                let faults = [equation.evaluate(&SCOPE).err(), equation.dimension_check(&SCOPE).err()];
                for error in faults.into_iter().flatten() {
                    prop_assert!(text.get(error.range).is_some());
                }
            }
        }
    }

    #[test]
    fn an_equation_without_additions_has_the_trees_of_formulas(
        text in "((v|x|u|2)[-+*/^]){0,8}(v|u|3)"
    ) {
        let formula = Formula::parse(&text).unwrap();
        let equation = equation(&format!("{text} = 0"));
        prop_assert_eq!(formula.root(), equation.left());
    }
}
