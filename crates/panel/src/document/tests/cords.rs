use super::*;

#[test]
fn a_full_jack_takes_no_second_cord_but_its_cord_can_be_moved() {
    let mut document = lesson();
    let refused = refusal(&mut document, &plug("P1", "in", "A1"));
    let start = "the jack in of P1 is full: pull out or move the cord from B1 first";
    assert!(refused.message.starts_with(start), "{}", refused.message);
    let place = refused.place.unwrap();
    assert_eq!((place.element.as_deref(), place.jack.as_deref()), (Some("P1"), Some("in")));
    refusal(&mut document, &move_cord(["M1", "a", "B1"], input("P1", "in")));
    document.apply(&move_cord(["P1", "in", "B1"], output("A1"))).unwrap();
    assert_eq!(cords(&document, "P1"), [("in", "A1")]);
    // Jacks with gains take any number of cords, also with a gain that the machine does not have.
    document.apply(&plug("B2", "x1", "P2")).unwrap();
    document.apply(&plug("B2", "x2.5", "P2")).unwrap();
    assert_eq!(cords(&document, "B2"), [("x1", "P2"), ("x1", "P2"), ("x10", "P3"), ("x2.5", "P2")]);
}

#[test]
fn cords_with_unknown_ends_are_refused() {
    let mut document = lesson();
    let cases = [
        (plug("A9", "x1", "B1"), "there is no element A9 with inputs: "),
        (plug("A1", "in", "B1"), "A1 has no jack in: choose one of its jacks"),
        (plug("A1", "x1", "C1"), "there is no output C1: "),
        (unplug("A1", "x1", "B1"), "there is no cord from B1 in the jack x1 of A1"),
        (Command::RemoveElement { name: "+100".to_owned() }, "there is no element +100 to remove: "),
        (Command::RemoveLoose { id: 7 }, "there is no loose cord 7"),
        (add("capacitor"), "there is no kind capacitor: "),
        (Command::Text, "this command does not edit the patch"),
    ];
    for (command, expected) in cases {
        let refused = refusal(&mut document, &command);
        assert!(refused.message.starts_with(expected), "{}", refused.message);
    }
}

#[test]
fn ports_of_instances_have_one_name_for_each_output() {
    let mut document = shipped("lessons/heat-rod.json");
    assert_eq!(cords(&document, "B7"), [("in", "C6")]);
    document.apply(&unplug("B7", "in", "C6.flow")).unwrap();
    assert!(cords(&document, "B7").is_empty());
    document.apply(&plug("B7", "in", "C6.u")).unwrap();
    assert_eq!(cords(&document, "B7"), [("in", "C6.u")]);
    refusal(&mut document, &plug("C1", "left", "B7"));
    refusal(&mut document, &plug("C1.A", "x1", "B7"));
    document.apply(&Command::RemoveElement { name: "C6".to_owned() }).unwrap();
    assert!(!document.patch().instances.contains_key("C6") && cords(&document, "B7").is_empty());
}

#[test]
fn a_dropped_cord_stays_on_the_panel_until_it_is_plugged_in() {
    let mut document = lesson();
    let dropped = drop_end(output("B1"), Some(["P1", "in", "B1"]));
    assert_eq!(document.apply(&dropped), Ok(Change::Patch));
    assert!(cords(&document, "P1").is_empty());
    assert_eq!(document.loose(), [Loose { id: 1, end: output("B1"), at: [12.5, 40.0] }]);
    let to_output = Command::PlugLoose { id: 1, to: output("A1") };
    let refused = refusal(&mut document, &to_output);
    assert!(refused.message.starts_with("a cord goes from an output to an input"));
    document.apply(&Command::PlugLoose { id: 1, to: input("P1", "in") }).unwrap();
    assert_eq!((cords(&document, "P1"), document.loose().len()), (vec![("in", "B1")], 0));
    assert_eq!(document.apply(&drop_end(input("A1", "x1"), None)), Ok(Change::Panel));
    assert_eq!(document.loose()[0].id, 2);
    let moved = Command::MoveLoose { id: 2, at: [50.0, 60.0] };
    assert_eq!(document.apply(&moved), Ok(Change::Panel));
    assert_eq!(document.loose(), [Loose { id: 2, end: input("A1", "x1"), at: [50.0, 60.0] }]);
    assert_eq!(document.undo_label(), Some("move a loose cord"));
    assert_eq!(document.undo(), Ok(Change::Panel));
    assert_eq!(document.loose()[0].at, [12.5, 40.0]);
    refusal(&mut document, &Command::MoveLoose { id: 2, at: [f64::INFINITY, 0.0] });
    refusal(&mut document, &Command::MoveLoose { id: 7, at: [0.0, 0.0] });
    assert_eq!(document.apply(&Command::RemoveLoose { id: 2 }), Ok(Change::Panel));
    assert_eq!(document.undo(), Ok(Change::Panel));
    assert_eq!(document.loose().len(), 1);
    document.apply(&Command::RemoveElement { name: "A1".to_owned() }).unwrap();
    assert!(document.loose().is_empty());
    // A jack that is full has no place for a loose cord, and a replaced cord keeps one end.
    let mut document = lesson();
    refusal(&mut document, &drop_end(input("P1", "in"), None));
    refusal(&mut document, &drop_end(output("A1"), Some(["P1", "in", "B1"])));
}
