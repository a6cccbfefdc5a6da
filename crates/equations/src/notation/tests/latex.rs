//! Unit tests of the LaTeX text.

use super::{
    call, compare, equation, friction, limited_rate, lorenz, measured, memory, name, negative, number,
    oscillator, power, product, quotient, sum, van_der_pol, words,
};
use crate::notation::{Condition, Notation, Relation, document, equation_latex, latex};

/// Asserts the LaTeX text of each expression.
fn check(cases: impl IntoIterator<Item = (Notation, &'static str)>) {
    for (notation, expected) in cases {
        assert_eq!(latex(&notation), expected, "{notation:?}");
    }
}

/// a + b
fn a_plus_b() -> Notation {
    sum([name("a"), name("b")])
}

/// a b
fn a_times_b() -> Notation {
    product([name("a"), name("b")])
}

/// a/b
fn a_over_b() -> Notation {
    quotient(name("a"), name("b"))
}

#[test]
fn equations_read_as_in_a_textbook() {
    let cases = [
        (oscillator(), r"\dot{v} = -\frac{k}{m}\,x - \frac{c}{m}\,v"),
        (friction(), r"\mathrm{friction} = \mathrm{Fs}\,\max\left(u, 0\right)^{2}"),
        (lorenz(), r"\dot{x} = \sigma\,\left(y - x\right)"),
        (
            memory(),
            r"\dot{\mathrm{memory}} = \frac{\max\left(1 - \frac{\left|v_{\mathrm{o}}\right|}{\mathrm{VcL}}, 0\right) - \mathrm{memory}}{\mathrm{Tc}}",
        ),
        (van_der_pol(), r"\dot{v} = \mu\,\left(1 - x^{2}\right)\,v - x"),
        (
            equation(name("y'"), limited_rate()),
            r"\dot{y} = \begin{cases} 0 & \text{if } x \ge 100 \text{ and } v > 0 \\ v - x & \text{otherwise} \end{cases}",
        ),
    ];
    for (equation, expected) in cases {
        assert_eq!(equation_latex(&equation), expected);
    }
}

#[test]
fn a_document_has_an_equation_on_each_line() {
    let expected = r"\begin{align}
  \dot{x} &= \sigma\,\left(y - x\right) \\
  \dot{v} &= \mu\,\left(1 - x^{2}\right)\,v - x
\end{align}
";
    assert_eq!(document(&[lorenz(), van_der_pol()]), expected);
    assert_eq!(document(&[]), "");
}

#[test]
fn names_have_symbols_and_indices() {
    check([
        (name("x"), "x"),
        (name("x1"), "x_{1}"),
        (name("x_1"), "x_{1}"),
        (name("v_o"), r"v_{\mathrm{o}}"),
        (name("x1_a"), r"x_{1,\mathrm{a}}"),
        (name("VcL"), r"\mathrm{VcL}"),
        (name("PC5"), r"\mathrm{PC5}"),
        (name("spring_force"), r"\mathrm{spring}_{\mathrm{force}}"),
        (name("spring_force_max"), r"\mathrm{spring}_{\mathrm{force\_max}}"),
        (name("_x"), r"\mathrm{\_x}"),
        (name("x_"), r"\mathrm{x\_}"),
    ]);
}

#[test]
fn names_of_greek_letters_are_signs() {
    check([
        (name("alpha"), r"\alpha"),
        (name("Omega"), r"\Omega"),
        (name("mu_s"), r"\mu_{\mathrm{s}}"),
        (name("beta2"), r"\beta_{2}"),
        (name("x_theta"), r"x_{\theta}"),
        (name("Alpha"), r"\mathrm{A}"),
        (name("omicron"), "o"),
        (name("alphabet"), r"\mathrm{alphabet}"),
        (name("omega'"), r"\dot{\omega}"),
    ]);
}

#[test]
fn derivatives_have_dots_or_a_number() {
    check([
        (name("x'"), r"\dot{x}"),
        (name("x''"), r"\ddot{x}"),
        (name("x'''"), r"\dddot{x}"),
        (name("x''''"), "x^{(4)}"),
        (name("x_1'"), r"\dot{x}_{1}"),
        (name("x1'''''"), "x_{1}^{(5)}"),
        (power(name("x'"), number(2.0)), r"\dot{x}^{2}"),
        (power(name("x''''"), number(2.0)), r"\left(x^{(4)}\right)^{2}"),
    ]);
}

#[test]
fn special_characters_of_names_are_escaped() {
    check([
        (name("L1.v"), r"\mathrm{L1.v}"),
        (name("C+1"), r"\text{C+1}"),
        (name("PC-5"), r"\text{PC-5}"),
        (name("PC-5_a"), r"\text{PC-5}_{\mathrm{a}}"),
        (name("50%"), r"\text{50\%}"),
        (name("a&b#c$"), r"\text{a\&b\#c\$}"),
        (name(r"a\b{c}"), r"\text{a\textbackslash{}b\{c\}}"),
        (name("a^b~"), r"\text{a\textasciicircum{}b\textasciitilde{}}"),
        (name("größe"), r"\text{größe}"),
        (call("a-b", [name("x")]), r"\operatorname{\text{a-b}}\left(x\right)"),
    ]);
}

#[test]
fn functions_have_the_signs_of_mathematics() {
    let x = || [name("x")];
    check([
        (call("abs", x()), r"\left|x\right|"),
        (call("sqrt", [product([number(2.0), name("g"), name("h")])]), r"\sqrt{2\,g\,h}"),
        (call("floor", x()), r"\left\lfloor x\right\rfloor"),
        (call("exp10", x()), "10^{x}"),
        (call("power", [a_plus_b(), name("n")]), r"\left(a + b\right)^{n}"),
        (call("min", [name("x"), number(1.0)]), r"\min\left(x, 1\right)"),
        (call("sin", x()), r"\sin\left(x\right)"),
        (call("cos", x()), r"\cos\left(x\right)"),
        (call("tan", x()), r"\tan\left(x\right)"),
        (call("tanh", x()), r"\tanh\left(x\right)"),
        (call("atan", x()), r"\arctan\left(x\right)"),
        (call("exp", [negative(name("x"))]), r"\exp\left(-x\right)"),
        (call("ln", x()), r"\ln\left(x\right)"),
        (call("log10", x()), r"\log_{10}\left(x\right)"),
        (call("sign", x()), r"\operatorname{sign}\left(x\right)"),
        (
            call("dead_zone", [name("x"), measured(2.0, "mm")]),
            r"\operatorname{dead\_zone}\left(x, 2\,\mathrm{mm}\right)",
        ),
    ]);
}

#[test]
fn numbers_have_powers_of_ten_and_units() {
    check([
        (number(0.25), "0.25"),
        (number(45e6), r"4.5 \times 10^{7}"),
        (number(1e-5), "10^{-5}"),
        (measured(40.0, "1/s2"), r"40\,\mathrm{1/s^{2}}"),
        (measured(2e8, "N/m"), r"2 \times 10^{8}\,\mathrm{N/m}"),
        (measured(3.0, "N s/m"), r"3\,\mathrm{N\,s/m}"),
        (measured(3.0, "kg*m^-2"), r"3\,\mathrm{kg\,m^{-2}}"),
        (measured(3.0, "m s⁻²"), r"3\,\mathrm{m\,s^{-2}}"),
        (measured(3.0, "N/(m s)2"), r"3\,\mathrm{N/(m\,s)^{2}}"),
        (measured(3.0, "%"), r"3\,\mathrm{\%}"),
        (measured(3.0, "µm"), r"3\,\mathrm{{\mu}m}"),
        (measured(3.0, "kΩ"), r"3\,\mathrm{k{\Omega}}"),
        (measured(3.0, "Å"), r"3\,\mathrm{\text{Å}}"),
    ]);
}

#[test]
fn products_have_thin_spaces_or_a_dot() {
    check([
        (product([number(2.0), name("x"), name("y")]), r"2\,x\,y"),
        (product([number(2.0), number(3.0)]), r"2 \cdot 3"),
        (product([name("x"), number(3.0)]), r"x \cdot 3"),
        (product([number(2.0), call("exp10", [name("x")])]), r"2 \cdot 10^{x}"),
        (product([number(45e6), name("x")]), r"4.5 \times 10^{7}\,x"),
        (product([name("c"), a_times_b()]), r"c\,a\,b"),
        (product([name("c"), product([number(2.0), name("b")])]), r"c \cdot 2\,b"),
    ]);
}

#[test]
fn parentheses_are_only_where_they_are_needed() {
    let squared = |base: Notation| power(base, number(2.0));
    check([
        (negative(a_plus_b()), r"-\left(a + b\right)"),
        (negative(negative(name("a"))), r"-\left(-a\right)"),
        (negative(a_times_b()), r"-a\,b"),
        (negative(a_over_b()), r"-\frac{a}{b}"),
        (sum([name("c"), negative(a_plus_b())]), r"c - \left(a + b\right)"),
        (product([name("c"), a_over_b()]), r"c\,\frac{a}{b}"),
        (product([name("c"), negative(name("a"))]), r"c\,\left(-a\right)"),
        (product([measured(40.0, "1/s2"), name("x")]), r"\left(40\,\mathrm{1/s^{2}}\right)\,x"),
        (product([name("a"), number(-3.0)]), r"a\,\left(-3\right)"),
        (quotient(a_plus_b(), a_times_b()), r"\frac{a + b}{a\,b}"),
        (quotient(negative(name("a")), a_over_b()), r"\frac{-a}{\frac{a}{b}}"),
        (squared(a_plus_b()), r"\left(a + b\right)^{2}"),
        (squared(negative(name("a"))), r"\left(-a\right)^{2}"),
        (squared(a_times_b()), r"\left(a\,b\right)^{2}"),
        (squared(a_over_b()), r"\left(\frac{a}{b}\right)^{2}"),
        (squared(power(name("a"), name("b"))), r"\left(a^{b}\right)^{2}"),
        (squared(call("exp10", [name("a")])), r"\left(10^{a}\right)^{2}"),
        (squared(call("abs", [name("a")])), r"\left|a\right|^{2}"),
        (squared(number(45e6)), r"\left(4.5 \times 10^{7}\right)^{2}"),
        (power(name("c"), negative(a_over_b())), r"c^{-\frac{a}{b}}"),
        (product([sum([]), product([])]), r"0 \cdot 1"),
    ]);
}

#[test]
fn cases_have_an_open_brace() {
    let cases = |comparison| {
        let condition = Condition(vec![comparison]);
        Notation::Cases(vec![(number(1.0), Some(condition)), (number(0.0), None)])
    };
    let compared = |relation| cases(compare(name("x"), relation, number(2.0)));
    check([
        (compared(Relation::Less), r"\begin{cases} 1 & \text{if } x < 2 \\ 0 & \text{otherwise} \end{cases}"),
        (
            compared(Relation::AtMost),
            r"\begin{cases} 1 & \text{if } x \le 2 \\ 0 & \text{otherwise} \end{cases}",
        ),
        (
            compared(Relation::Equal),
            r"\begin{cases} 1 & \text{if } x = 2 \\ 0 & \text{otherwise} \end{cases}",
        ),
        (
            cases(words("R_1 is pulled in")),
            r"\begin{cases} 1 & \text{if } \text{R\_1 is pulled in} \\ 0 & \text{otherwise} \end{cases}",
        ),
        (
            product([name("c"), compared(Relation::Less)]),
            r"c\,\left(\begin{cases} 1 & \text{if } x < 2 \\ 0 & \text{otherwise} \end{cases}\right)",
        ),
    ]);
}
