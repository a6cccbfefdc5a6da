//! Removals from all shipped patches: what remains can be decoded, and runs if its open inputs are at ground.

use crate::common::{files, patch_of};
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Severity};
use patchcord_core::patch::{Patch, PatchEditor};

/// The patch after edits.
fn edited(patch: &Patch, edit: impl FnOnce(&mut PatchEditor)) -> Patch {
    let mut editor = patch.edit();
    edit(&mut editor);
    editor.finish(patch.file()).unwrap_or_else(|error| panic!("{}: {error}", patch.file()))
}

/// The names in a section of the document.
fn names(patch: &Patch, section: &str) -> Vec<String> {
    patch.value()[section].as_object().into_iter().flat_map(|entries| entries.keys().cloned()).collect()
}

/// The codes of the errors of the patch, or of its copy with grounded inputs if an input is open.
fn errors_of_grounded(patch: &Patch) -> Vec<Code> {
    let grounded = patch.with_grounded_inputs();
    let findings = match Circuit::new(grounded.as_ref().unwrap_or(patch)) {
        Ok(_) => Vec::new(),
        Err(report) => report.findings,
    };
    let errors = findings.into_iter().map(|finding| finding.code);
    errors.filter(|code| code.severity() == Severity::Error).collect()
}

/// Asserts that the patch is valid as soon as its open inputs are grounded. `context` says what was removed.
fn assert_valid_if_grounded(patch: &Patch, context: &str) {
    assert_eq!(errors_of_grounded(patch), [], "{} without {context}\n{}", patch.file(), patch.text());
}

#[test]
fn a_shipped_patch_without_one_of_its_elements_is_valid_if_its_open_inputs_are_grounded() {
    for file in files::shipped_files() {
        let patch = patch_of(&file);
        for section in ["elements", "drives"] {
            for name in names(&patch, section) {
                let rest = edited(&patch, |editor| editor.remove_element(&name).unwrap());
                assert!(!names(&rest, section).contains(&name));
                assert_valid_if_grounded(&rest, &name);
            }
        }
    }
}

#[test]
fn a_shipped_patch_loses_its_elements_one_after_the_other() {
    for file in files::representative_files() {
        let mut patch = patch_of(&file);
        let all: Vec<_> =
            ["elements", "drives"].into_iter().flat_map(|section| names(&patch, section)).collect();
        let (last, others) = all.split_last().unwrap();
        for name in others {
            patch = edited(&patch, |editor| editor.remove_element(name).unwrap());
            assert_valid_if_grounded(&patch, name);
        }
        // A patch needs an element or a drive.
        patch = edited(&patch, |editor| editor.remove_element(last).unwrap());
        assert_eq!(errors_of_grounded(&patch), [Code::MISSING_KEY], "{}", patch.text());
    }
}

#[test]
fn a_shipped_patch_without_one_of_its_cords_is_valid_if_its_open_inputs_are_grounded() {
    for file in files::shipped_files() {
        let patch = patch_of(&file);
        for name in names(&patch, "elements") {
            for (jack, from) in patch.written_cords(&name) {
                let rest = edited(&patch, |editor| editor.remove_cord(&name, jack, from).unwrap());
                assert_eq!(rest.written_cords(&name).count() + 1, patch.written_cords(&name).count());
                assert_valid_if_grounded(&rest, &format!("the cord from {from} into {jack} of {name}"));
                // The cord goes back into its jack. Its place among the other cords can differ.
                let back = edited(&rest, |editor| editor.add_cord(&name, jack, from).unwrap());
                let mut cords: [Vec<_>; 2] =
                    [&back, &patch].map(|patch| patch.written_cords(&name).collect());
                cords.iter_mut().for_each(|cords| cords.sort_unstable());
                assert_eq!(cords[0], cords[1]);
            }
        }
    }
}

#[test]
fn a_shipped_patch_without_cords_keeps_its_elements_and_is_valid_if_its_inputs_are_grounded() {
    for file in files::shipped_files() {
        let patch = patch_of(&file);
        let rest = edited(&patch, PatchEditor::remove_all_cords);
        assert_eq!(names(&rest, "elements"), names(&patch, "elements"));
        assert_eq!(rest.value()["signals"], patch.value()["signals"]);
        assert!(names(&rest, "elements").iter().all(|name| rest.written_cords(name).next().is_none()));
        assert_valid_if_grounded(&rest, "all cords");
    }
}
