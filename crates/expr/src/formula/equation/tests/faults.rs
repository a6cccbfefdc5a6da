//! Texts that are not equations, with the part at fault and the hint.

use super::super::Equation;
use super::{assert_faults, equation};
use crate::formula::Formula;

#[test]
fn a_product_without_a_sign_after_a_division_is_ambiguous() {
    let message = "a product without a sign after a division is ambiguous";
    assert_faults(&[
        ("y = a / b c", "b c", message, "write (a / b) c or a / (b c)"),
        ("y = 1/2 x", "2 x", message, "write (1 / 2) x or 1 / (2 x)"),
        ("y = 1/2x", "2x", message, "write (1 / 2) x or 1 / (2 x)"),
        (
            "F = -40 N/m x",
            "m x",
            message,
            "numbers have no units in equations: declare -40 N/m as a parameter p and write p x; if N and m are \
             quantities, write (-40 N / m) x or -40 N / (m x)",
        ),
        (
            "p'' = 9.81 m/s2 / L sin(p)",
            "L sin(p)",
            message,
            "numbers have no units in equations: declare 9.81 m/s2 as a parameter q and write (q / L) sin(p) or \
             q / (L sin(p)); if m and s2 are quantities, write (9.81 m / s2 / L) sin(p) or 9.81 m / s2 / (L sin(p))",
        ),
        (
            "y = 5 N / k x",
            "k x",
            message,
            "write (5 N / k) x or 5 N / (k x); if 5 N is a number with a unit, declare it as a parameter",
        ),
        ("y = a / b c d", "b c", message, "write (a / b) c d or a / (b c d)"),
        ("y = a / b c / d e", "b c", message, "write ((a / b) c / d) e or a / (b c) / (d e)"),
        ("y = a b / c (d + e)", "c (d + e)", message, "write (a b / c) (d + e) or a b / (c (d + e))"),
        ("y = a / b * c / d e", "d e", message, "write (a / b * c / d) e or a / b * c / (d e)"),
        ("y = 1 + a / sin(b) c", "sin(b) c", message, "write (a / sin(b)) c or a / (sin(b) c)"),
    ]);
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
        (
            "y = int(x)",
            "int",
            "int is not a function",
            "the integral of x is a quantity y with the equation y' = x",
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
        ("y = sign(a, b)", "sign(a, b)", "sign takes 1 argument, not 2", "write sign( ... )"),
        (
            "y = limit(a, b)",
            "limit(a, b)",
            "limit takes 3 arguments, not 2",
            "write limit( ... , ... , ... )",
        ),
        ("y = delay(a)", "delay(a)", "delay takes 2 arguments, not 1", "write delay( ... , ... )"),
        ("y = friction()", "friction()", "friction takes 1 argument, not 0", "write friction( ... )"),
        ("y = min(a)", "min(a)", "min takes 2 arguments, not 1", "write min( ... , ... )"),
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
        (
            "x' = v; v' = -x",
            ";",
            "; is not allowed in an equation",
            "write a list with a text for each equation",
        ),
        ("y = |x|", "|", "| is not allowed in an equation", "write abs( ... ) for a magnitude"),
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
        ("x′ = v", "x′", "′ is not allowed in an equation", "write x'"),
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
