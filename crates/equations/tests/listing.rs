//! The listing of equations, on patches with delays, limits and long chains.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_equations::{Agreement, Detail, EquationListing, compare_equations};
use serde_json::{Map, Value, json};

/// The circuit and the program of a patch.
pub(crate) fn compiled(patch: &Value) -> (Circuit, Program) {
    let patch = Patch::from_value("patch.json", patch).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    (circuit, program)
}

/// The equations of a patch as text.
fn equations(patch: &Value) -> Vec<String> {
    let (circuit, program) = compiled(patch);
    let listing = EquationListing::new(&circuit, &program, Detail::Signals);
    listing.equations.iter().map(|equation| equation.text()).collect()
}

/// The agreement of the only equation of a patch.
fn agreement(patch: &mut Value, equation: &str) -> Agreement {
    patch["equations"] = json!([equation]);
    let (circuit, program) = compiled(patch);
    compare_equations(&circuit, &program).remove(0).agreement
}

#[test]
fn an_integrator_with_a_limit_shows_it() {
    let patch = json!({
        "patchcord": 1,
        "scales": {"x": {"per_volt": 1, "unit": "1"}},
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["B2"]}, "initial": 5, "limit": {"upper": 10}},
            "A2": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50},
            "B2": {"kind": "inverter", "in": "A2"},
        },
        "signals": {"y": {"at": "A2", "scale": "x"}},
    });
    let expected = "y'' = 0             if y' <= -10 and y'' would be below 0\n      -y            otherwise";
    assert_eq!(equations(&patch), [expected]);
}

#[test]
fn a_brake_has_one_law_without_a_list_of_changes() {
    let cases = [
        (
            "problems/dry-friction",
            "v' = 0                  if v = 0 and abs(x) <= 5\n     -4 x - 20 sign(v)  otherwise",
        ),
        (
            "lessons/stick-slip",
            "sliding' = 0                                            \
             if sliding = 0 and k abs(x) <= max(friction, 0)\n           \
             -(k/m) x - max(friction, 0) sign(sliding)/m  otherwise",
        ),
    ];
    for (file, law) in cases {
        let patch = Patch::read(format!("../../patches/{file}.json")).unwrap();
        let circuit = Circuit::new(&patch).unwrap();
        let listing = EquationListing::new(&circuit, &Program::new(&circuit).unwrap(), Detail::Signals);
        assert_eq!(listing.equations[1].text(), law);
        assert!(!listing.text().contains("brake"), "{}", listing.text());
    }
}

/// A decay at the rate of a parameter m. The state is the output of the element `element`.
fn decay(element: &str, signals: &Value) -> Value {
    json!({
        "patchcord": 1,
        "parameters": {"m": {"value": 0.5, "unit": "1"}},
        "elements": {
            "P1": {"kind": "pot", "in": element, "setting": "m"},
            element: {"kind": "integrator", "in": {"x1": ["P1"]}, "initial": 50},
            "U1": {"kind": "absolute", "in": element},
        },
        "signals": signals,
    })
}

#[test]
fn a_quantity_with_the_name_of_a_parameter_gets_another_name() {
    let volts = json!({"at": "A1"});
    let cases = [
        (
            decay("A1", &json!({"m": volts})),
            "m_out' = -m m_out\n\nat t = 0: m_out = 50\n\nm_out is the signal m, because m is a parameter\n",
        ),
        (
            decay("A1", &json!({"m": volts, "m_out": volts})),
            "m_out_' = -m m_out_\nm_out = m_out_\n\nat t = 0: m_out_ = 50\n\n\
             m_out_ is the signal m, because m is a parameter\n",
        ),
        (
            decay("m", &json!({"y": {"at": "U1"}})),
            "y = abs(m_out)\nm_out' = -m m_out\n\nat t = 0: m_out = 50\n\n\
             m_out is the output of the element m, because m is a parameter\n",
        ),
    ];
    for (patch, expected) in cases {
        let (circuit, program) = compiled(&patch);
        assert_eq!(EquationListing::new(&circuit, &program, Detail::Signals).text(), expected);
    }
}

#[test]
fn delays_of_sums_and_constant_factors_agree() {
    let mut patch = json!({
        "patchcord": 1,
        "parameters": {"k": {"value": 0.5, "unit": "1"}},
        "scales": {"x": {"per_volt": 1, "unit": "1"}},
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["A2"]}, "initial": 50},
            "A2": {"kind": "integrator", "in": {"x1": ["B1"]}},
            "B1": {"kind": "inverter", "in": "A1"},
            "P1": {"kind": "pot", "in": "A1", "setting": "k"},
            "D1": {"kind": "delay", "in": "P1", "delay": 1},
        },
        "signals": {"x": {"at": "A1", "scale": "x"}, "y": {"at": "D1", "scale": "x"}},
    });
    for equation in ["y = delay(k x, 1)", "y = k delay(x, 1)", "y'' = -y", "y' = k delay(x', 1)"] {
        assert_eq!(agreement(&mut patch, equation), Agreement::Solved, "{equation}");
    }
    assert!(matches!(agreement(&mut patch, "y = delay(x, 1)"), Agreement::Different { .. }));
}

#[test]
fn an_equation_that_is_not_solved_for_a_quantity_is_compared_too() {
    let text = std::fs::read_to_string("../../patches/lessons/square-root-and-division.json").unwrap();
    let mut patch: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(agreement(&mut patch, "w^2 = 2 g h"), Agreement::Solved);
    assert!(matches!(agreement(&mut patch, "w^2 = 4 g h"), Agreement::Different { .. }));
    assert_eq!(agreement(&mut patch, "0 = A h' + a w"), Agreement::Solved);
    assert!(matches!(agreement(&mut patch, "0 = A h' + 2 a w"), Agreement::Different { .. }));
}

#[test]
fn equations_can_name_drives_or_write_out_their_laws() {
    let text = std::fs::read_to_string("../../patches/lessons/driven-oscillator.json").unwrap();
    let mut patch: Value = serde_json::from_str(&text).unwrap();
    for equation in
        ["m x'' = F sin(2 pi f t) - k x - d x'", "push = F sin(2 pi f t)", "m x'' = push - k x - d x'"]
    {
        assert_eq!(agreement(&mut patch, equation), Agreement::Solved, "{equation}");
    }
    for equation in ["push = 2 F sin(2 pi f t)", "m x'' = F sin(pi f t) - k x - d x'"] {
        assert!(matches!(agreement(&mut patch, equation), Agreement::Different { .. }), "{equation}");
    }
}

#[test]
fn a_division_by_zero_is_not_0() {
    let text = std::fs::read_to_string("../../patches/lessons/mass-and-spring.json").unwrap();
    let mut patch: Value = serde_json::from_str(&text).unwrap();
    for equation in ["x' = v + v/0", "x' = v + v^2/(v - v)", "x' = v + v^2/(x' - v)"] {
        assert_ne!(agreement(&mut patch, equation), Agreement::Solved, "{equation}");
    }
}

#[test]
fn initial_values_in_latex_keep_their_dots() {
    let patch = Patch::read("../../patches/lessons/projectile.json").unwrap();
    let circuit = Circuit::new(&patch).unwrap();
    let program = Program::new(&circuit).unwrap();
    let latex = EquationListing::new(&circuit, &program, Detail::Signals).latex();
    assert!(latex.contains("\n  \\dot{x}(0) &= "), "{latex}");
    assert!(latex.starts_with("\\begin{align}\n") && latex.contains("\n\\end{align}\n"), "{latex}");
}

/// The part of a listing in LaTeX after its equations.
fn latex_after_equations(patch: &Patch) -> String {
    let circuit = Circuit::new(patch).unwrap();
    let program = Program::new(&circuit).unwrap();
    let latex = EquationListing::new(&circuit, &program, Detail::Signals).latex();
    latex.split_once("\\end{align}\n").unwrap().1.to_owned()
}

#[test]
fn modes_tables_and_remarks_are_in_latex_too() {
    let shipped = |file: &str| Patch::read(format!("../../patches/{file}.json")).unwrap();
    let thermostat = r"
\noindent position of K1, at first released:
\begin{itemize}
  \item released $\to$ pulled in if $T \le T_{\mathrm{set}} - 0.5\,\mathrm{width}$
  \item pulled in $\to$ released if $T \ge T_{\mathrm{set}} + 0.5\,\mathrm{width}$
\end{itemize}
";
    assert_eq!(latex_after_equations(&shipped("lessons/relay-thermostat")), thermostat);
    let tanks = "\n\\noindent $\\operatorname{table\\_u}$ in (s, V): (0, 3) (600, 3) (800, 1.5) (1200, 1.5) \
                 (1400, 3.5) (2000, 3.5) (2200, 2) (3000, 2)\n";
    assert_eq!(latex_after_equations(&shipped("measured/cascaded-tanks")), tanks);
    let ball = latex_after_equations(&shipped("lessons/bouncing-ball"));
    let bounce = r"down if $y < 0 \text{ and } \mathrm{vy} > 0$, then $\mathrm{vy} = -e\,\mathrm{vy}$";
    assert!(ball.contains(bounce), "{ball}");
    let renamed = Patch::from_value("patch.json", &decay("A1", &json!({"m": {"at": "A1"}}))).unwrap();
    let remark = "\n\\noindent $m_{\\mathrm{out}}$ is the signal m, because m is a parameter\n";
    assert_eq!(latex_after_equations(&renamed), remark);
}

/// Limited summers in series, each of which contains the one before twice.
#[test]
fn long_chains_of_limited_amplifiers_are_listed() {
    let mut elements = Map::new();
    elements.insert("A0".into(), json!({"kind": "integrator", "in": {"x1": ["S30"]}, "initial": 50}));
    for index in 1..=30 {
        let input = if index == 1 { "A0".to_owned() } else { format!("S{}", index - 1) };
        let summer = json!({"kind": "summer", "in": {"x1": [input]}, "limit": {"upper": 10, "lower": -20}});
        elements.insert(format!("S{index}"), summer);
    }
    let patch = json!({"patchcord": 1, "elements": elements, "signals": {"y": {"at": "A0"}}});
    assert!(equations(&patch).iter().any(|equation| equation.starts_with("y' = ")));
}

#[test]
fn sums_of_quotients_and_high_powers_end() {
    let mut patch = json!({
        "patchcord": 1,
        "scales": {"x": {"per_volt": 1, "unit": "1"}},
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50},
            "A2": {"kind": "integrator", "in": {"x1": ["A2"]}, "initial": 20},
            "A3": {"kind": "integrator", "in": {"x1": ["A3"]}, "initial": 10},
        },
        "signals": {
            "x": {"at": "A1", "scale": "x"}, "y": {"at": "A2", "scale": "x"}, "z": {"at": "A3", "scale": "x"},
        },
    });
    let cases = [
        "x' + x/(x + 1.1) + y/(y + 1.2) + z/(z + 1.3) = -x + x/(x + 1.1) + y/(y + 1.2) + z/(z + 1.3)",
        "x' + (x + y + z + x y + y z + x z)^12 = (x + y + z + x y + y z + x z)^12 - x",
    ];
    for equation in cases {
        assert_eq!(agreement(&mut patch, equation), Agreement::Solved, "{equation}");
    }
}

/// x' = rate (t + T0) - x/tau, with an integrator A2 of 5 V per second for the time. `integrator` are further keys of A2,
/// and `signals` are further signals.
fn ramp(integrator: &Value, signals: &Value) -> Value {
    let mut patch = json!({
        "patchcord": 1,
        "parameters": {
            "rate": {"value": 3, "unit": "m/s2", "range": [1, 8]},
            "T0": {"value": 2, "unit": "s", "range": [1, 9]},
            "tau": {"value": 1, "unit": "s", "range": [0.5, 2]},
        },
        "scales": {"x": {"per_volt": 0.5, "unit": "m"}, "time": {"per_volt": 0.2, "unit": "s"}},
        "elements": {
            "P1": {"kind": "pot", "in": "A1", "setting": "1 / tau / 10"},
            "P2": {"kind": "pot", "in": "B2", "setting": "rate * time / x / 10"},
            "A1": {"kind": "integrator", "in": {"x10": ["P1", "P2"]}},
            "P3": {"kind": "pot", "in": "-100", "setting": "1 / time / 100"},
            "A2": {"kind": "integrator", "in": {"x1": ["P3"]}, "initial": "T0 / time"},
            "B2": {"kind": "inverter", "in": "A2"},
        },
        "signals": {"x": {"at": "A1", "scale": "x"}},
    });
    let add = |object: &mut Value, keys: &Value| {
        object.as_object_mut().unwrap().extend(keys.as_object().unwrap().clone());
    };
    add(&mut patch["elements"]["A2"], integrator);
    add(&mut patch["signals"], signals);
    patch
}

/// The signal at the integrator for the time.
fn clock() -> Value {
    json!({"clock": {"at": "A2", "scale": "time"}})
}

#[test]
fn an_unnamed_integrator_for_the_time_is_written_as_the_time() {
    assert_eq!(equations(&ramp(&json!({}), &json!({}))), ["x' = rate T0 - x/tau + rate t"]);
    assert_eq!(equations(&ramp(&json!({}), &clock())), ["x' = rate clock - x/tau", "clock' = 1"]);
    // At its limit and in reset, the integrator does not follow the time.
    let limited = ramp(&json!({"limit": {"upper": 90}}), &json!({}));
    assert_eq!(equations(&limited)[0], "x' = (0.2 s/V) rate A2 - x/tau");
    let mut reset = ramp(&json!({"in": {"x1": ["P3"], "reset": "K1"}, "initial": 0}), &json!({}));
    reset["elements"]["K1"] = json!({"kind": "comparator", "in": "A2", "threshold": 50});
    assert_eq!(equations(&reset)[0], "x' = (0.2 s/V) rate A2 - x/tau");
}

#[test]
fn an_integrator_for_the_time_is_compared_with_the_time() {
    let equation = "tau x' = rate tau (t + T0) - x";
    for signals in [json!({}), clock()] {
        let mut patch = ramp(&json!({}), &signals);
        for right in [equation, "x''' = -x''/tau", "x(0) = 0"] {
            assert_eq!(agreement(&mut patch, right), Agreement::Solved, "{right}");
        }
        let wrong = agreement(&mut patch, "tau x' = 2 rate tau t + rate tau T0 - x");
        let Agreement::Different { differences, wired } = wrong else { panic!("{wrong:?}") };
        assert_eq!(differences, ["the term 2 rate t is 2 times too small"]);
        assert_eq!(wired, "x' = rate T0 - x/tau + rate t");
        patch["elements"]["P2"]["setting"] = json!(0.12);
        let names = ["T0", "rate", "tau"].map(str::to_owned).to_vec();
        assert_eq!(agreement(&mut patch, equation), Agreement::SolvedAt(names));
    }
}

#[test]
fn a_signal_of_the_time_is_compared_with_the_time() {
    let mut named = ramp(&json!({}), &clock());
    for equation in ["clock = t + T0", "clock' = 1", "clock(0) = T0", "x' = rate clock - x/tau"] {
        assert_eq!(agreement(&mut named, equation), Agreement::Solved, "{equation}");
    }
    assert!(matches!(agreement(&mut named, "clock = t"), Agreement::Different { .. }));
    let mut limited = ramp(&json!({"limit": {"upper": 90}}), &clock());
    assert!(matches!(agreement(&mut limited, "clock = t + T0"), Agreement::Different { .. }));
    let within = Agreement::SolvedIf(vec!["clock < 18 s".to_owned()]);
    assert_eq!(agreement(&mut limited, "clock' = 1"), within);
}

/// A patch with an integrator A1 as x, and with a chain of elements from it back to its input. `element` makes the
/// element with a number from 2 to `last` from the name of the one in front of it.
fn chain(last: usize, element: impl Fn(usize, String) -> Value) -> Value {
    let name = |number: usize| format!("A{number}");
    let mut elements: Map<String, Value> =
        (2..=last).map(|number| (name(number), element(number, name(number - 1)))).collect();
    elements.insert(name(1), json!({"kind": "integrator", "in": {"x1": [name(last)]}, "initial": 50}));
    json!({
        "patchcord": 1,
        "scales": {"one": {"per_volt": 1, "unit": "1"}},
        "elements": elements,
        "signals": {"x": {"at": "A1", "scale": "one"}},
    })
}

#[test]
fn states_deep_in_a_chain_of_integrators_keep_the_names_of_their_elements() {
    let found = equations(&chain(300, |_, before| json!({"kind": "integrator", "in": {"x1": [before]}})));
    // x' = -A300, x'' = A299 and so on. The ninth derivative is the last one that an equation can name.
    assert_eq!(found.len(), 292);
    assert!(found.contains(&"x''''''''' = -A292".to_owned()), "{}", found[0]);
    assert!(found.contains(&"A292' = -A291".to_owned()) && found.contains(&"A2' = -x".to_owned()));
}

#[test]
fn a_long_chain_of_delay_lines_has_several_equations() {
    let mut patch = chain(301, |_, before| json!({"kind": "delay", "in": before, "delay": 0.01}));
    let found = equations(&patch);
    assert_eq!(found.len(), 6, "{found:?}");
    assert_eq!(found.iter().map(|text| text.matches("delay(").count()).sum::<usize>(), 300);
    let names: Vec<&str> = found.iter().filter_map(|text| text.split(' ').next()).collect();
    assert_eq!(names, ["x'", "A52", "A103", "A154", "A205", "A256"]);
    let Agreement::Undecided(text) = agreement(&mut patch, "x' = -x") else { panic!("it is too deep") };
    assert_eq!(text, "the formula of x' has more than 200 functions inside each other");
}

#[test]
fn a_long_chain_of_functions_is_not_compared() {
    let mut patch = chain(3001, |number, before| {
        let kind = if number % 2 == 0 { "absolute" } else { "sin" };
        json!({"kind": kind, "in": before})
    });
    let Agreement::Undecided(text) = agreement(&mut patch, "x' = -x") else { panic!("it is too deep") };
    assert_eq!(text, "the formula of x' has more than 200 functions inside each other");
    let mut inverters = chain(3001, |_, before| json!({"kind": "inverter", "in": before}));
    assert_eq!(agreement(&mut inverters, "x' = -x"), Agreement::Solved);
}
