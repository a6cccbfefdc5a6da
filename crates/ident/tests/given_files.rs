//! Experiments whose patch and data are in memory.

use std::fs;
use std::path::PathBuf;

use patchcord_core::patch::Patch;
use patchcord_ident::{Experiment, ExperimentError, GivenFiles};

/// The folder of the examples of docs/gap.md.
const FOLDER: &str = "../../examples/05_missing_effect";

/// The text of a file in the folder.
fn text(name: &str) -> String {
    fs::read_to_string(format!("{FOLDER}/{name}")).unwrap()
}

/// The patch in a file in the folder.
fn patch(name: &str) -> Patch {
    Patch::read(format!("{FOLDER}/{name}")).unwrap()
}

#[test]
fn given_files_make_the_same_experiment_as_the_files_of_a_folder() {
    for (name, patch_name, data_name) in
        [("spring", "spring.json", "measured.csv"), ("slide", "slide.json", "slide.csv")]
    {
        let file = format!("{FOLDER}/{name}.experiment.json");
        let read = Experiment::read(&file).unwrap_or_else(|error| panic!("{error}"));
        let (patch, data) = (patch(patch_name), text(data_name));
        let files = GivenFiles { patch: &patch, data: &[(data_name, data.as_str())] };
        let experiment = text(&format!("{name}.experiment.json"));
        let given =
            Experiment::parse_given(&files, &file, &experiment).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(read.files, [PathBuf::from(format!("{FOLDER}/{data_name}"))]);
        assert_eq!(given.files, [PathBuf::from(data_name)]);
        // Missing samples are NaN, which is not equal to itself. So the texts of all fields are compared.
        let without_folder = Experiment { files: given.files.clone(), ..read };
        assert_eq!(format!("{given:?}"), format!("{without_folder:?}"));
    }
}

#[test]
fn a_data_file_that_is_not_given_is_reported() {
    let (patch, data) = (patch("spring.json"), text("measured.csv"));
    let files = GivenFiles { patch: &patch, data: &[("measured.csv", data.as_str())] };
    let text = r#"{"patch": "spring.json", "data": "mesured.csv", "outputs": {"x": "x"}}"#;
    let error = Experiment::parse_given(&files, "e.json", text).unwrap_err().to_string();
    assert!(error.contains("there is no file mesured.csv"), "{error}");
    assert!(error.contains("did you mean \"measured.csv\"?"), "{error}");
}

/// The report is the same except for the folder in front of the names.
#[test]
fn faults_are_those_of_an_experiment_in_a_folder() {
    let (patch, data) = (patch("spring.json"), text("measured.csv"));
    let files = GivenFiles { patch: &patch, data: &[("measured.csv", data.as_str())] };
    let text = r#"{"patch": "spring.json", "data": "measured.csv", "outputs": {"y": "x"}, "train": [0, 1],
        "test": [0.5, 2]}"#;
    let report = |experiment: Result<Experiment, ExperimentError>| {
        experiment.unwrap_err().to_string().replace(&format!("{FOLDER}/"), "")
    };
    let given = report(Experiment::parse_given(&files, "e.json", text));
    assert!(given.contains("unknown-name") && given.contains("shared-samples"), "{given}");
    assert_eq!(given, report(Experiment::parse_in(FOLDER, "e.json", text)));
}
