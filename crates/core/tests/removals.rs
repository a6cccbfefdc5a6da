//! Removals from all shipped patches: what remains can be decoded, and runs if its open inputs are at ground.

use std::path::PathBuf;
use std::thread;

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

/// Checks the patches of some files, each in a thread of its own.
fn check_all(files: Vec<PathBuf>, check: fn(&Patch)) {
    thread::scope(|scope| {
        for file in files {
            scope.spawn(move || check(&patch_of(&file)));
        }
    });
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
    check_all(files::shipped_files(), |patch| {
        for section in ["elements", "drives"] {
            for name in names(patch, section) {
                let rest = edited(patch, |editor| editor.remove_element(&name).unwrap());
                assert!(!names(&rest, section).contains(&name));
                assert_valid_if_grounded(&rest, &name);
            }
        }
    });
}

#[test]
fn a_shipped_patch_can_lose_all_its_elements_one_after_the_other() {
    check_all(files::representative_files(), |patch| {
        let all: Vec<_> =
            ["elements", "drives"].into_iter().flat_map(|section| names(patch, section)).collect();
        let (last, others) = all.split_last().unwrap();
        let mut rest = patch.clone();
        for name in others {
            rest = edited(&rest, |editor| editor.remove_element(name).unwrap());
            assert_valid_if_grounded(&rest, name);
        }
        // A patch needs an element or a drive.
        rest = edited(&rest, |editor| editor.remove_element(last).unwrap());
        assert_eq!(errors_of_grounded(&rest), [Code::MISSING_KEY], "{}", rest.text());
    });
}

#[test]
fn a_shipped_patch_without_one_of_its_cords_is_valid_if_its_open_inputs_are_grounded() {
    check_all(files::shipped_files(), |patch| {
        for name in names(patch, "elements") {
            for (jack, from) in patch.written_cords(&name) {
                check_without_cord(patch, &name, jack, from);
            }
        }
    });
}

/// Removes a cord from a patch, and puts it back. Its place among the other cords of the element can then differ.
fn check_without_cord(patch: &Patch, name: &str, jack: &str, from: &str) {
    let rest = edited(patch, |editor| editor.remove_cord(name, jack, from).unwrap());
    assert_eq!(rest.written_cords(name).count() + 1, patch.written_cords(name).count());
    assert_valid_if_grounded(&rest, &format!("the cord from {from} into {jack} of {name}"));
    let back = edited(&rest, |editor| editor.add_cord(name, jack, from).unwrap());
    let mut cords: [Vec<_>; 2] = [&back, patch].map(|patch| patch.written_cords(name).collect());
    cords.iter_mut().for_each(|cords| cords.sort_unstable());
    assert_eq!(cords[0], cords[1]);
}

#[test]
fn a_shipped_patch_without_cords_keeps_its_elements_and_is_valid_if_its_inputs_are_grounded() {
    check_all(files::shipped_files(), |patch| {
        let rest = edited(patch, PatchEditor::remove_all_cords);
        assert_eq!(names(&rest, "elements"), names(patch, "elements"));
        assert_eq!(rest.value()["signals"], patch.value()["signals"]);
        assert!(names(&rest, "elements").iter().all(|name| rest.written_cords(name).next().is_none()));
        assert_valid_if_grounded(&rest, "all cords");
    });
}
