//! Tests of edits that remove parts: the text before and after each of them.

use crate::circuit::Circuit;
use crate::patch::{EditError, Patch, PatchEditor};

/// A patch that names its outputs in every place that can name them.
const TEXT: &str = r#"{
  "patchcord": 1,
  "time_scale": 10,
  "parameters": {"k": {"value": 2, "unit": "V", "range": [0, 9]}},
  "scales": {"volt": {"per_volt": 1, "unit": "V"}},
  "drives": {
    "u": {"kind": "step", "scale": "volt", "height": 5},
    "w": {"kind": "step", "scale": "volt", "height": "k"}
  },
  "macros": {
    "sum": {"inputs": {"in": "voltage"}, "outputs": {"out": "S", "minus": "I"}, "settings": {"top": {"unit": "V", "default": 90}}, "elements": {
      "S": {"kind": "summer", "in": {"x1": ["in", "w"]}, "limit": {"upper": "top"}},
      "I": {"kind": "inverter", "in": "S"}
    }}
  },
  "elements": {
    "A1": {"kind": "integrator", "in": {"x1": ["P1", "u", "P1"], "x10": "B.minus"}, "initial": 5},
    "B":  {"kind": "sum", "in": "A1", "top": 80},
    "P1": {"kind": "pot", "in": "B", "setting": 0.5},
    "L":  {"kind": "diode-lower-of", "in": ["A1", "P1"]},
    "K":  {"kind": "relay", "in": "L", "on": "u", "off": "ground", "pull_in": 60, "drop_out": -60},
    "S1": {"kind": "summer", "in": {"x1": ["K"]}, "limit": {"upper": 20}}
  },
  "signals": {
    "x": {"at": "A1", "scale": "volt"},
    "b": {"at": "B.minus", "scale": "volt"},
    "p": {"at": "P1", "scale": "volt"}
  },
  "equations": [
    "f = 2 p",
    "x' = -f * x' / x",
    "b = u"
  ],
  "run": {"step": 0.01, "phases": [
    {"operate": 1, "until": {"relay": "K", "becomes": "pulled-in"}},
    {"repeat": 2, "phases": [{"set": {"k": "k + x"}}]},
    {"operate": 1, "until": "K"}
  ]},
  "record": ["x", "B.minus", "L", "B.S"],
  "pictures": [
    {"x": "t", "y": ["x", "p"]},
    {"x": "x", "y": "d p / d k"}
  ]
}
"#;

/// The text after edits of a patch. Its spans must be positions in the text.
fn edited(text: &str, edit: impl FnOnce(&mut PatchEditor) -> Result<(), EditError>) -> String {
    let mut editor = Patch::parse("p.json", text).unwrap().edit();
    edit(&mut editor).unwrap();
    let patch = editor.finish("p.json").unwrap();
    for (name, element) in patch.elements.iter().filter(|(name, _)| !name.contains('.')) {
        assert_eq!(&patch.text()[element.span.start..element.span.end], format!("\"{name}\""));
    }
    patch.text().to_owned()
}

/// `TEXT` with replacements.
fn text_with(replacements: &[(&str, &str)]) -> String {
    replacements.iter().fold(TEXT.to_owned(), |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replace(old, new)
    })
}

#[test]
fn the_patch_of_the_tests_is_valid() {
    Circuit::new(&Patch::parse("p.json", TEXT).unwrap()).unwrap_or_else(|report| panic!("{report}"));
}

#[test]
fn a_removed_cord_is_cut_out_of_the_text() {
    let cases = [
        ("A1", "x1", "P1", r#""x1": ["P1", "u", "P1"]"#, r#""x1": ["u", "P1"]"#),
        ("A1", "x1", "u", r#""x1": ["P1", "u", "P1"]"#, r#""x1": ["P1", "P1"]"#),
        ("A1", "x10", "B.minus", r#", "x10": "B.minus""#, ""),
        ("B", "in", "A1", r#""in": "A1", "top""#, r#""top""#),
        ("P1", "in", "B", r#""in": "B", "#, ""),
        ("L", "in", "A1", r#"["A1", "P1"]"#, r#"["P1"]"#),
        ("L", "in", "P1", r#"["A1", "P1"]"#, r#"["A1"]"#),
        ("K", "on", "u", r#""on": "u", "#, ""),
        ("S1", "x1", "K", r#", "in": {"x1": ["K"]}"#, ""),
    ];
    for (element, jack, from, old, new) in cases {
        let actual = edited(TEXT, |editor| editor.remove_cord(element, jack, from));
        assert_eq!(actual, text_with(&[(old, new)]), "{from} into {jack} of {element}");
    }
}

#[test]
fn a_cord_that_is_added_and_removed_again_leaves_the_value_as_it_was() {
    let patch = Patch::parse("p.json", TEXT).unwrap();
    let cords =
        [("A1", "x100", "u"), ("A1", "x1", "u"), ("A1", "x10", "L"), ("L", "in", "u"), ("B", "in", "u")];
    for (element, jack, from) in cords {
        let mut editor = patch.edit();
        editor.add_cord(element, jack, from).unwrap();
        assert_ne!(editor.patch().written_cords(element).count(), patch.written_cords(element).count());
        editor.remove_cord(element, jack, from).unwrap();
        let edited = editor.finish("p.json").unwrap();
        let mut cords: [Vec<_>; 2] = [&edited, &patch].map(|patch| patch.written_cords(element).collect());
        cords.iter_mut().for_each(|cords| cords.sort_unstable());
        assert_eq!(cords[0], cords[1], "{from} into {jack} of {element}");
    }
    let mut editor = patch.edit();
    editor.remove_cord("S1", "x1", "K").unwrap();
    editor.add_cord("S1", "x1", "K").unwrap();
    assert_eq!(editor.finish("p.json").unwrap().value(), patch.value());
}

#[test]
fn unknown_cords_settings_and_elements_are_errors() {
    let mut editor = Patch::parse("p.json", TEXT).unwrap().edit();
    let message = |result: Result<(), EditError>| result.unwrap_err().to_string();
    let cord = editor.remove_cord("A1", "x10", "B");
    assert_eq!(message(cord), "there is no cord from B into x10 of A1 in the patch");
    assert_eq!(message(editor.remove_cord("A9", "x1", "B")), "there is no element A9 in the patch");
    assert_eq!(message(editor.remove_cord("B.S", "x1", "u")), "B.S is inside an instance: edit its macro");
    assert_eq!(message(editor.remove_setting("A1", "setting")), "there is no setting setting in the patch");
    assert_eq!(message(editor.remove_setting("B", "bottom")), "there is no setting bottom in the patch");
    assert_eq!(message(editor.remove_element("A9")), "there is no element A9 in the patch");
    assert_eq!(message(editor.remove_element("B.S")), "B.S is inside an instance: edit its macro");
    assert_eq!(editor.finish("p.json").unwrap().text(), TEXT);
}

#[test]
fn a_removed_setting_is_cut_out_with_its_empty_group() {
    let cases = [
        ("A1", "initial", r#", "initial": 5"#),
        ("B", "top", r#", "top": 80"#),
        ("S1", "limit.upper", r#", "limit": {"upper": 20}"#),
    ];
    for (element, setting, cut) in cases {
        assert_eq!(edited(TEXT, |editor| editor.remove_setting(element, setting)), text_with(&[(cut, "")]));
    }
    assert_eq!(edited(TEXT, |editor| editor.remove_setting("S1", "limit.lower")), TEXT);
    let two_limits = text_with(&[(r#"{"upper": 20}"#, r#"{"upper": 20, "lower": -20}"#)]);
    let expected = text_with(&[(r#"{"upper": 20}"#, r#"{"lower": -20}"#)]);
    assert_eq!(edited(&two_limits, |editor| editor.remove_setting("S1", "limit.upper")), expected);
}

#[test]
fn a_removed_relay_leaves_phases_that_last_for_their_whole_time() {
    let actual = edited(TEXT, |editor| editor.remove_element("K"));
    let expected = text_with(&[
        (
            "    \"K\":  {\"kind\": \"relay\", \"in\": \"L\", \"on\": \"u\", \"off\": \"ground\", \"pull_in\": 60, \"drop_out\": -60},\n",
            "",
        ),
        (r#", "in": {"x1": ["K"]}"#, ""),
        (r#", "until": {"relay": "K", "becomes": "pulled-in"}"#, ""),
        (r#", "until": "K""#, ""),
    ]);
    assert_eq!(actual, expected);
}

#[test]
fn a_removed_instance_takes_the_names_of_its_ports_and_elements_with_it() {
    let actual = edited(TEXT, |editor| editor.remove_element("B"));
    let expected = text_with(&[
        ("    \"B\":  {\"kind\": \"sum\", \"in\": \"A1\", \"top\": 80},\n", ""),
        (r#", "x10": "B.minus""#, ""),
        (r#""in": "B", "#, ""),
        ("    \"b\": {\"at\": \"B.minus\", \"scale\": \"volt\"},\n", ""),
        (",\n    \"b = u\"", ""),
        (r#", "B.minus", "L", "B.S"]"#, r#", "L"]"#),
    ]);
    assert_eq!(actual, expected);
}

#[test]
fn a_removed_signal_takes_its_equations_pictures_and_changes_of_parameters_with_it() {
    let actual = edited(TEXT, |editor| editor.remove_element("A1"));
    let expected = text_with(&[
        (
            "    \"A1\": {\"kind\": \"integrator\", \"in\": {\"x1\": [\"P1\", \"u\", \"P1\"], \"x10\": \"B.minus\"}, \"initial\": 5},\n",
            "",
        ),
        (r#""in": "A1", "top""#, r#""top""#),
        (r#"["A1", "P1"]"#, r#"["P1"]"#),
        ("    \"x\": {\"at\": \"A1\", \"scale\": \"volt\"},\n", ""),
        (",\n    \"x' = -f * x' / x\"", ""),
        ("    {\"repeat\": 2, \"phases\": [{\"set\": {\"k\": \"k + x\"}}]},\n", ""),
        (r#""record": ["x", "#, r#""record": ["#),
        (r#""y": ["x", "p"]"#, r#""y": ["p"]"#),
        (",\n    {\"x\": \"x\", \"y\": \"d p / d k\"}", ""),
    ]);
    assert_eq!(actual, expected);
    // The auxiliary quantity f has no meaning without p.
    let actual = edited(TEXT, |editor| editor.remove_element("P1"));
    assert!(actual.contains("\"equations\": [\n    \"b = u\"\n  ]"), "{actual}");
    assert!(actual.contains("\"pictures\": [\n    {\"x\": \"t\", \"y\": [\"x\"]}\n  ]"), "{actual}");
    assert!(
        actual.contains(r#""A1": {"kind": "integrator", "in": {"x1": ["u"], "x10": "B.minus"}"#),
        "{actual}"
    );
}

#[test]
fn a_removed_drive_is_unplugged_inside_macros_too() {
    let actual = edited(TEXT, |editor| editor.remove_element("w"));
    let expected = text_with(&[
        (",\n    \"w\": {\"kind\": \"step\", \"scale\": \"volt\", \"height\": \"k\"}", ""),
        (r#"["in", "w"]"#, r#"["in"]"#),
    ]);
    assert_eq!(actual, expected);
    // The input u of this macro is not the drive.
    let other_input =
        text_with(&[(r#"{"in": "voltage"}"#, r#"{"in": "", "z": ""}"#), ("\"in\", \"w\"", "\"in\", \"z\"")]);
    let other_input = other_input.replace("\"z\"", "\"u\"");
    let actual = edited(&other_input, |editor| editor.remove_element("u"));
    assert!(actual.contains(r#""S": {"kind": "summer", "in": {"x1": ["in", "u"]}"#), "{actual}");
    assert!(!actual.contains("b = u"), "{actual}");
}

#[test]
fn a_name_with_a_dot_belongs_to_the_longest_element_name() {
    let text = r#"{"patchcord": 1,
 "macros": {"half": {"inputs": {"in": ""}, "outputs": {"out": "P"}, "elements": {"P": {"kind": "pot", "in": "in", "setting": 0.5}}}},
 "elements": {
  "H": {"kind": "half", "in": "+100"},
  "H.2": {"kind": "half", "in": "H.out"},
  "S": {"kind": "summer", "in": {"x1": ["H", "H.out", "H.2", "H.2.out"]}}
 }, "record": ["H.P", "H.2.P"]}"#;
    let actual = edited(text, |editor| editor.remove_element("H"));
    assert!(actual.contains(r#""S": {"kind": "summer", "in": {"x1": ["H.2", "H.2.out"]}}"#), "{actual}");
    assert!(actual.contains(r#""record": ["H.2.P"]"#), "{actual}");
    assert!(actual.contains(r#""H.2": {"kind": "half"}"#), "{actual}");
}

#[test]
fn an_element_that_could_not_be_read_can_be_removed() {
    let text = text_with(&[(r#""kind": "pot""#, r#""kind": "pott""#)]);
    let actual = edited(&text, |editor| editor.remove_element("P1"));
    assert!(!actual.contains("P1"), "{actual}");
}

#[test]
fn all_cords_can_be_removed_while_elements_settings_and_signals_stay() {
    let actual = edited(TEXT, |editor| {
        editor.remove_all_cords();
        assert_eq!(
            editor.remove_cord("L", "in", "A1").unwrap_err().to_string(),
            "there is no cord from A1 into in of L in the patch"
        );
        Ok(())
    });
    let expected = text_with(&[
        (r#""in": {"x1": ["P1", "u", "P1"], "x10": "B.minus"}, "#, ""),
        (r#""in": "A1", "top""#, r#""top""#),
        (r#""in": "B", "#, ""),
        (r#", "in": ["A1", "P1"]"#, ""),
        (r#""in": "L", "on": "u", "off": "ground", "#, ""),
        (r#", "in": {"x1": ["K"]}"#, ""),
    ]);
    assert_eq!(actual, expected);
}

#[test]
fn edits_before_and_after_a_removal_are_rendered_in_their_order() {
    let actual = edited(TEXT, |editor| {
        editor.set_parameter("k", 3.0)?;
        editor.add_cord("S1", "x10", "A1")?;
        editor.remove_element("K")?;
        editor.add_cord("S1", "x1", "L")?;
        editor.remove_cord("S1", "x10", "A1")?;
        editor.set_time_scale(100.0);
        editor.set_title("shorter");
        Ok(())
    });
    assert!(
        actual.contains(r#""S1": {"kind": "summer", "in": {"x1": ["L"]}, "limit": {"upper": 20}}"#),
        "{actual}"
    );
    assert!(actual.contains(r#""k": {"value": 3.0, "#), "{actual}");
    assert!(
        actual.contains(r#""time_scale": 100.0,"#) && actual.contains(r#""title": "shorter""#),
        "{actual}"
    );
}

#[test]
fn a_wrong_time_scale_is_reported_at_its_position() {
    for (value, text) in [(0.0, "0.0"), (1e13, "10000000000000.0"), (f64::NAN, "null")] {
        let mut editor = Patch::parse("p.json", TEXT).unwrap().edit();
        editor.set_time_scale(value);
        let patch = editor.finish("p.json").unwrap();
        let report = Circuit::new(&patch).unwrap_err();
        let span = report.findings[0].span.unwrap();
        assert_eq!(&patch.text()[span.start..span.end], text);
    }
    let mut editor = Patch::parse("p.json", TEXT).unwrap().edit();
    editor.set_time_scale(2.5);
    assert_eq!(editor.finish("p.json").unwrap().time_scale, 2.5);
}
