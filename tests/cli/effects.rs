//! `patchcord effects`

use super::{code, errors, json, out, patchcord};

#[test]
fn effects_are_listed_and_told() {
    let all = out(&patchcord(&["effects"]));
    for name in ["coulomb-friction", "friction-memory", "overflow", "time-delay"] {
        assert!(all.lines().any(|line| line.starts_with(name)), "{all}");
    }
    let one = out(&patchcord(&["effects", "viscous-friction"]));
    assert!(one.contains("F = c v") && one.contains("sum / own"), "{one}");
    let told = json(&patchcord(&["effects", "--json"]));
    assert_eq!(told.as_array().unwrap().len(), 22);
    let wrong = patchcord(&["effects", "viscous-fiction"]);
    assert_eq!(code(&wrong), 2);
    assert!(errors(&wrong).contains("viscous-friction"), "{}", errors(&wrong));
}

#[test]
fn effects_of_a_folder_join_and_wrong_ones_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let empty = patchcord(&["effects", "--effects", folder.path().to_str().unwrap()]);
    assert!(code(&empty) == 1 && errors(&empty).contains("there is no effect in "), "{}", errors(&empty));
    let own = std::fs::read_to_string("patches/effects/drift.json").unwrap();
    std::fs::write(folder.path().join("creep.json"), own).unwrap();
    let asked = ["effects", "creep", "--effects", folder.path().to_str().unwrap()];
    assert!(out(&patchcord(&asked)).starts_with("creep: "));
    std::fs::write(folder.path().join("wrong.json"), "{\"effect\": 1}").unwrap();
    std::fs::write(folder.path().join("worse.json"), "{").unwrap();
    let told = patchcord(&asked);
    assert_eq!(code(&told), 1);
    for wanted in ["an effect needs \"title\"", "wrong.json: ", "worse.json: 1 error"] {
        assert!(errors(&told).contains(wanted), "{}", errors(&told));
    }
}

#[test]
fn what_is_wrong_with_an_effect_is_told_of_its_own_file() {
    let own = std::fs::read_to_string("patches/effects/cubic-stiffness.json").unwrap();
    let told = |from: &str, to: &str| {
        let folder = tempfile::tempdir().unwrap();
        assert!(own.contains(from), "{from}");
        std::fs::write(folder.path().join("own.json"), own.replacen(from, to, 1)).unwrap();
        let told = patchcord(&["effects", "own", "--effects", folder.path().to_str().unwrap()]);
        assert_eq!(code(&told), 1);
        errors(&told)
    };
    let many = format!("[{}]", vec!["1"; 51].join(", "));
    for (from, to, wanted) in [
        (
            "\"kind\": \"inverter\"",
            "\"kind\": \"inverted\"",
            "this form cannot be wired: there is no kind \"inverted\"",
        ),
        ("0.5 + 5000 * k3 * position^3 / sum / G", "0.5 + k4 + k3", "this form cannot be wired"),
        ("0.5 + 5000 * k3 * position^3 / sum / G", "0.5", "no element and no drive of this form has k3 in"),
        ("10000 * abs(k3)", "10000 * abs(k4)", "worked out from k4, which the form has not"),
        (
            "\"at\": \"motion\",",
            "\"at\": \"motion\", \"parameters\": [\"k3\", \"k3\"],",
            "this form has the parameter k3 twice",
        ),
        ("\"k3\": {", "\"own\": {", "the parameter own has the name of a quantity of every form"),
        ("\"k3\": {", "\"G\": {", "the parameter G has the name of a gain or drive of this form"),
        ("\"none\": 0", "\"none\": 20", "no effect at 20, outside the range -10 ... 10"),
        ("[-1, -0.05, 0.3]", "\"hihgest\"", "\"hihgest\" is none of spectrum, highest, lowest"),
        ("[-1, -0.05, 0.3]", "\"spectrum\"", "gives frequencies, and the reach is sum / position^3"),
        ("\"at\": \"motion\",", "\"at\": \"motion\", \"times\": 0,", "a number of 1 ... 1000000"),
        ("\"at\": \"motion\",", "\"at\": \"motoin\",", "motion"),
        ("[-1, -0.05, 0.3]", "\"highest\"", "those of one name, and the reach is sum / position^3"),
        ("{\"add\": \"B2\"}", "{\"out\": \"B2\"}", "\"out\" is none of add, subtract, brake, add_to_next"),
        ("[\"position\"]", "[\"in\"]", "\"in\" is none of own, position, load, force"),
        ("{\"kind\": \"inverter\", \"in\": \"M2\"}", "\"inverter\"", "an object with \"kind\""),
        ("sum / position^3", "sum / positio^3", "measured in positio, which a form at \"motion\""),
        ("sum / position^3", "sum + position", "no product of powers"),
        ("[-1, -0.05, 0.3]", "[-1, 30]", "a fit begins at 30, outside the range -10 ... 10"),
        ("[-1, -0.05, 0.3]", "[]", "\"start\" lists no value"),
        ("[-1, -0.05, 0.3]", many.as_str(), "\"start\" lists 51 values, and takes 50 at most"),
        ("\"at\": \"motion\",", "\"at\": \"motion\", \"parameters\": [],", "a form has a parameter at least"),
        ("[-10, 10]", "[-1e300, 10]", "counts in reaches and goes to 1000000 at most"),
        ("[-10, 10]", "[-10, 1e300]", "counts in reaches and goes to 1000000 at most"),
        ("sum / position^3", "sum / position^3e9", "nothing can be measured in that"),
        (
            "\"title\": \"Cubic stiffness\"",
            "\"title\": \" \"",
            "\"title\" is empty: it tells what people call it",
        ),
    ] {
        let told = told(from, to);
        assert!(told.contains(wanted) && told.contains("own.json:"), "{told}");
    }
}

#[test]
fn what_cannot_be_wired_is_told_at_its_place() {
    let own = std::fs::read_to_string("patches/effects/viscous-friction.json").unwrap();
    for (from, to, wanted) in [
        ("\"kind\": \"pot\"", "\"kind\": \"pott\"", "own.json:22:24\n"),
        (
            "c * own / sum / G",
            "c * own / summ / G",
            "know its parameters, its gains, \"sum\" and what it reads",
        ),
        ("c * own / sum / G", "c * own / summ / G", "own.json:22:55\n"),
        ("\"xG\"", "\"xH\"", "own.json:23:47\n"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("own.json"), own.replacen(from, to, 1)).unwrap();
        let told = errors(&patchcord(&["effects", "own", "--effects", folder.path().to_str().unwrap()]));
        assert!(told.contains(wanted) && !told.contains("probe_"), "{told}");
    }
}

#[test]
fn what_is_no_folder_of_effects_is_told() {
    let told = |path: &str| {
        let told = patchcord(&["effects", "--effects", path]);
        assert_eq!(code(&told), 1);
        errors(&told)
    };
    let file = told("patches/effects/drift.json");
    assert!(file.contains("patches/effects/drift.json is a file: name the folder that it is in"), "{file}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy("crates/ident/tests/base.json", folder.path().join("base.json")).unwrap();
    std::fs::copy("crates/ident/tests/slide.json", folder.path().join("slide.json")).unwrap();
    let both = told(folder.path().to_str().unwrap());
    for wanted in
        ["this is a patch, where an effect is needed", "this is an experiment, where an effect is needed"]
    {
        assert!(both.contains(wanted), "{both}");
    }
}

#[test]
fn an_alias_that_is_no_effect_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let own = std::fs::read_to_string("patches/effects/drift.json").unwrap();
    let own = own.replacen("\"aliases\": {", "\"aliases\": {\"no-such\": \"ever\", ", 1);
    std::fs::write(folder.path().join("creep.json"), own).unwrap();
    let told = patchcord(&["effects", "--effects", folder.path().to_str().unwrap()]);
    assert_eq!(errors(&told), "note: creep has the alias no-such, which is no effect\n");
    assert_eq!(code(&told), 0);
}

#[test]
fn an_effect_that_takes_the_place_of_another_is_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy("patches/effects/drift.json", folder.path().join("leak.json")).unwrap();
    let told = patchcord(&["effects", "--effects", folder.path().to_str().unwrap()]);
    assert!(
        errors(&told).contains("leak.json takes the place of the effect of that name"),
        "{}",
        errors(&told)
    );
    assert_eq!(code(&told), 0);
}
