//! Compares a patch with measurements and prints the effect that the patch lacks.

use std::error::Error;
use std::path::Path;

use patchcord::ident::Experiment;
use patchcord::ident::effects::Library;
use patchcord::ident::fit::problem::Problem;
use patchcord::ident::report::Report;
use patchcord::ident::report::values::assignment_text;
use patchcord::ident::search::{SearchSettings, search};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/05_missing_effect");
    let experiment = Experiment::read(folder.join("spring.experiment.json"))?;
    let problem = Problem::of(&experiment)?;
    let library = Library::shipped();

    let outcome = search(&experiment, &problem, &SearchSettings::new(&library), |_| ())?;
    let outcome = outcome.ok_or("the patch cannot be run from any start")?;
    println!("{}", Report::new(&experiment, &problem, &outcome).sentence());
    let model = outcome.reported_model();
    for index in 0..model.variant.fit.len() {
        let [low, high] = model.uncertainty(index).interval;
        println!("{} (95 %: {low:.4} ... {high:.4})", assignment_text(model, index));
    }
    Ok(())
}
