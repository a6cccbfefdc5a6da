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
    let own = std::fs::read_to_string("patches/effects/drift.json").unwrap();
    std::fs::write(folder.path().join("creep.json"), own).unwrap();
    let asked = ["effects", "creep", "--effects", folder.path().to_str().unwrap()];
    assert!(out(&patchcord(&asked)).starts_with("creep: "));
    std::fs::write(folder.path().join("wrong.json"), "{\"effect\": 1}").unwrap();
    let told = patchcord(&asked);
    assert_eq!(code(&told), 1);
    assert!(errors(&told).contains("an effect needs \"title\""), "{}", errors(&told));
}
